//! Packs the page into a program that serves it.

#[cfg(feature = "serve")]
#[path = "build_page.rs"]
mod page;

fn main() -> std::io::Result<()> {
    // without such a line cargo would run this script after every change
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "serve")]
    page::pack()?;
    Ok(())
}
