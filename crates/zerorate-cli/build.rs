//! Packs the live page into the program.

#[cfg(feature = "serve")]
#[path = "build_page.rs"]
mod page;

fn main() -> std::io::Result<()> {
    // without this line, cargo would run the script again after every change
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "serve")]
    page::pack()?;
    Ok(())
}
