//! `codegen` writes the files that are generated from the sources and from `docs/facts.md`. `codegen --check` fails if
//! one is out of date. `cargo xtask codegen` calls this program. `codegen protocol` writes the TypeScript types of
//! the page's messages, which `cargo xtask web` needs and git does not keep.

mod bandwidth;
mod protocol;
mod spectrum;

use anyhow::{Context, Result, bail, ensure};
use std::fs;
use zerorate::Calibration;
use zerorate_view::export::{Export, ExportForm, Options};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => write(),
        ["--check"] => check(),
        ["protocol"] => Ok(fs::write("web/src/protocol.ts", protocol::text()?)?),
        _ => bail!("usage: codegen [--check | protocol]"),
    }
}

fn write() -> Result<()> {
    for (path, text) in old()? {
        fs::write(path, text).with_context(|| path.to_owned())?;
        println!("{path}: written");
    }
    Ok(())
}

fn check() -> Result<()> {
    let old: Vec<&str> = old()?.into_iter().map(|(path, _)| path).collect();
    ensure!(old.is_empty(), "out of date: {}; `cargo xtask codegen` writes them", old.join(", "));
    Ok(())
}

/// The files that are out of date, each with its new text.
fn old() -> Result<Vec<(&'static str, String)>> {
    let facts = fs::read_to_string("docs/facts.md").context("docs/facts.md: run this in the project's folder")?;
    let mut made = vec![
        ("docs/pictures/bandwidth.svg", bandwidth::draw(&facts)?),
        ("docs/pictures/spectrum.svg", spectrum::draw()?),
        ("firmware/examples/src/unit.rs", unit()?),
    ];
    made.retain(|(path, text)| fs::read_to_string(path).map_or(true, |there| there != *text));
    Ok(made)
}

/// The calibration of the firmware's examples, as `zerorate export --format rust` writes it.
fn unit() -> Result<String> {
    const CALIBRATION: &str = "firmware/examples/unit.toml";
    let text = fs::read_to_string(CALIBRATION).context(CALIBRATION)?;
    let (calibration, _) = Calibration::parse(&text).context(CALIBRATION)?;
    Export::new(calibration, Options::default())?.text(ExportForm::Rust)
}
