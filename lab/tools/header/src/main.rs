//! Prints the C interface's header, which cbindgen makes from the Rust sources. `cargo xtask codegen` calls it.

use anyhow::{Result, anyhow};
use std::path::Path;

const PROJECT: &str = "bindings/c";

fn main() -> Result<()> {
    let project = Path::new(PROJECT);
    let config = cbindgen::Config::from_file(project.join("cbindgen.toml")).map_err(|error| anyhow!(error))?;
    let mut text = Vec::new();
    cbindgen::generate_with_config(project, config)?.write(&mut text);
    // the "Safety" sections of the Rust sources state what a caller in C must ensure
    print!("{}", String::from_utf8(text)?.replace(" * # Safety\n * ", " * Required: "));
    Ok(())
}
