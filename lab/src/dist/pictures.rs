//! Two plots of the book, as SVG and PNG, drawn by the program itself.

use super::machine::MACHINES;
use super::{Folder, program};
use crate::venv::done;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

const COMMITTED: &str = "docs/pictures";
/// Records a unit at constant temperature and at its full rate, so that only its noise and its filter appear.
const RECORD: &str = "capture --device twin:seed=4,warmup_c=0 --duration 3h --force -o rest.parquet";
const ALLAN: &str = "allan rest.parquet --fit --force --plot";
const CALIBRATION: &str = "calibrate --device twin:seed=4 --serial SN17 --force -o unit.toml";
const CORRECTION: &str = "report unit.toml --force -o";

pub fn make(folder: &Folder) -> Result<()> {
    let (program, work) = (folder.of(program::name(&MACHINES[0])), folder.empty("pictures")?);
    let zerorate = |line: &str, picture: Option<&str>| {
        let mut command = Command::new(&program);
        command.current_dir(&work).args(line.split(' ')).args(picture.map(|name| folder.of(name)));
        done(command.stdout(Stdio::null()).stderr(Stdio::null()))
    };
    zerorate(RECORD, None)?;
    zerorate(CALIBRATION, None)?;
    for form in ["svg", "png"] {
        zerorate(ALLAN, Some(&format!("allan.{form}")))?;
        zerorate(CORRECTION, Some(&format!("correction.{form}")))?;
    }
    Ok(())
}

/// Checks that each file is a plot, and that the committed SVG plots equal these files.
pub fn check(folder: &Folder) -> Result<()> {
    for name in ["allan", "correction"] {
        let svg = fs::read_to_string(folder.of(format!("{name}.svg"))).context("make the part pictures first")?;
        ensure!(svg.trim_start().starts_with("<svg"), "{name}.svg is no SVG");
        let png = fs::read(folder.of(format!("{name}.png")))?;
        ensure!(png.starts_with(b"\x89PNG"), "{name}.png is no PNG");
        let committed = Path::new(COMMITTED).join(name).with_extension("svg");
        ensure!(
            fs::read_to_string(&committed)? == svg,
            "{} is not what the program draws: copy {} over it",
            committed.display(),
            folder.of(format!("{name}.svg")).display()
        );
        println!("{name}: SVG and PNG, and the book shows the same");
    }
    Ok(())
}
