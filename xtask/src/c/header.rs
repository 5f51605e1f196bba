//! The header, made from the Rust sources.

use anyhow::{Context, Result, anyhow, ensure};
use std::fs;
use std::path::Path;

/// Whether the header that is checked in is the one that the sources make; writes it if `update`.
pub fn check(project: &Path, update: bool) -> Result<()> {
    let path = project.join("include/zerorate.h");
    let text = generate(project)?;
    if update {
        fs::create_dir_all(project.join("include"))?;
        return fs::write(&path, text).with_context(|| path.display().to_string());
    }
    let committed = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    ensure!(committed == text, "{} is not what the sources make: run `cargo xtask c --update`", path.display());
    println!("{} is what the sources make", path.display());
    Ok(())
}

fn generate(project: &Path) -> Result<String> {
    let config = cbindgen::Config::from_file(project.join("cbindgen.toml")).map_err(|error| anyhow!(error))?;
    let mut text = Vec::new();
    cbindgen::generate_with_config(project, config)?.write(&mut text);
    // what Rust calls safety is what C's callers have to keep
    Ok(String::from_utf8(text)?.replace(" * # Safety\n * ", " * Required: "))
}
