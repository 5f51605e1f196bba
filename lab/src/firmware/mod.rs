//! `cargo xtask firmware`: runs driver, twin, correction and tracker on an emulated Cortex-M4F. It compares the
//! results with those on the host, counts instructions, and measures the size of driver and tracker.

mod emulator;
mod footprint;
pub mod image;
/// The computation that controller and host both run.
#[path = "../../../firmware/qemu/src/scenario.rs"]
mod scenario;
/// The time series that controller and host both track.
#[path = "../../../firmware/qemu/src/tracking.rs"]
mod tracking;

pub use emulator::run as emulate;

use crate::targets;
use crate::tools::available;
use crate::venv::printed;
use anyhow::{Context, Result, bail, ensure};
use emulator::Report;
use footprint::Figure;
use image::{Image, Memory};
use scenario::Reading;
use std::fmt::Debug;
use std::process::Command;
use tracking::TrackerState;
pub use xtask::images::QEMU;
use xtask::images::{TARGET, build};

#[derive(clap::Args)]
pub struct FirmwareArgs {
    /// The unit of the twin that both read
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the figures to docs/reference/footprint.md, even if they rose
    #[arg(long)]
    update: bool,
}

pub fn run(args: &FirmwareArgs) -> Result<()> {
    targets::add_missing([TARGET].into_iter())?;
    let mut figures = alone()?;
    let has_emulator = available(&[QEMU], "the run in the emulator")?;
    if has_emulator {
        let seed = args.seed;
        let report = Report::parse(&emulator::run(&build("release", "agreement")?, &[seed.to_string()])?)?;
        let (readings, means) = (compare(seed, &report.readings)?, compare_tracked(seed, &report.tracked)?);
        figures.splice(0..0, counted(&report)?);
        println!("seed {seed}: {readings} readings, corrected in four ways, are the same on controller and host");
        println!("seed {seed}: the tracker knows the same on controller and host after {means} means");
    }
    println!("no panic is linked into driver and tracker");
    for Figure { what, value, unit, goal } in &figures {
        let goal = goal.map_or(String::new(), |goal| format!("(goal: at most {goal})"));
        println!("{value:>6} {unit:13} {what} {goal}");
    }
    if args.update {
        ensure!(has_emulator, "without the emulator the figures are not complete");
        footprint::write(&figures, &rustc_version()?, &emulator::version()?)?;
    }
    judge(&figures)
}

/// The sizes of driver and tracker, from images with and without them. Returns an error if one of them can panic.
fn alone() -> Result<Vec<Figure>> {
    let small = difference("small", "driver")?;
    let fast = difference("release", "driver")?;
    let tracker = difference("small", "tracker")?;
    let control = Image::read(&build("release", "agreement")?)?.panic_symbols()?;
    ensure!(!control.is_empty(), "an image that can panic shows no sign of it: the check of the others is blind");
    let bytes = |what, value, goal| Figure { what, value, unit: "bytes", goal };
    Ok(vec![
        bytes("flash, driver with sampler, `opt-level = \"z\"`", small.flash, Some(4096)),
        bytes("flash, driver with sampler, `opt-level = 3`", fast.flash, None),
        bytes("flash, tracker, `opt-level = \"z\"`", tracker.flash, None),
        bytes("RAM, static variables", small.ram.max(fast.ram).max(tracker.ram), Some(0)),
    ])
}

/// The size of the image with the driver or the tracker, minus the size of the image without it.
fn difference(profile: &str, name: &str) -> Result<Memory> {
    let image = Image::read(&build(profile, name)?)?;
    let panics = image.panic_symbols()?;
    ensure!(panics.is_empty(), "the {name} links code that panics, with profile {profile}: {}", panics.join(", "));
    let (with, without) = (image.memory()?, Image::read(&build(profile, "empty")?)?.memory()?);
    Ok(Memory { flash: with.flash - without.flash, ram: with.ram - without.ram })
}

/// Compares the controller's readings with the host's. Returns their number, or an error if one differs.
fn compare(seed: u64, theirs: &[Reading]) -> Result<usize> {
    let mut ours = Vec::new();
    scenario::run(seed, |reading| ours.push(reading)).context("the twin gave no readings on the host")?;
    same("readings", theirs, &ours, |index| format!("reading {index} differs"))
}

/// Compares the tracker's state after each mean with the host's. Returns the number of means, or an error if one
/// differs.
fn compare_tracked(seed: u64, theirs: &[TrackerState]) -> Result<usize> {
    let mut ours = Vec::new();
    let counts = tracking::run(seed, |known| ours.push(known)).context("the tracker refuses its own state")?;
    ensure!(counts.learned_s > 0 && counts.rolled_back > 0, "the series shows too little of the tracker: {counts:?}");
    same("means", theirs, &ours, |index| format!("after mean {index}"))
}

fn same<T: Debug + PartialEq>(what: &str, theirs: &[T], ours: &[T], place: fn(usize) -> String) -> Result<usize> {
    let counts = (theirs.len(), ours.len());
    ensure!(counts.0 == counts.1, "{} {what} on the controller, {} on the host", counts.0, counts.1);
    for (index, (theirs, ours)) in theirs.iter().zip(ours).enumerate() {
        ensure!(theirs == ours, "{}: {theirs:?} on the controller, {ours:?} on the host", place(index));
    }
    Ok(ours.len())
}

fn counted(report: &Report) -> Result<Vec<Figure>> {
    let instructions = |what, name: &str, goal| -> Result<Figure> {
        let (_, most) = report.instructions.get(name).with_context(|| format!("the image did not count {name}"))?;
        Ok(Figure { what, value: *most, unit: "instructions", goal })
    };
    let bytes = |what, name: &str, goal| -> Result<Figure> {
        let value = *report.bytes.get(name).with_context(|| format!("the image did not say the size of {name}"))?;
        Ok(Figure { what, value, unit: "bytes", goal })
    };
    let least = |what, name: &str| -> Result<Figure> {
        let (least, _) = report.instructions.get(name).with_context(|| format!("the image did not count {name}"))?;
        Ok(Figure { what, value: *least, unit: "instructions", goal: None })
    };
    Ok(vec![
        instructions("integer correction, code to code", "integer_correction", Some(40))?,
        instructions("integer correction by a curve of order 3, code to code", "integer_curve", Some(60))?,
        instructions("table look-up, code to µ°/s", "table_look_up", Some(40))?,
        instructions("f32 correction, °/s to °/s", "f32_correction", None)?,
        instructions("f32 correction with conversion, codes to °/s", "f32_correction_of_codes", None)?,
        least("`read_rate`, code not in doubt", "read_rate")?,
        instructions("`read_rate`", "read_rate", None)?,
        least("`read_both`, neither code in doubt", "read_both")?,
        instructions("`read_both`: rate and temperature", "read_both", Some(150))?,
        least("`sample`: three reads and the count of losses, least", "sample")?,
        instructions("`sample`, most", "sample", None)?,
        instructions("`Tracker::push`, 9 of 10: a mean within a second", "tracker_within_second", None)?,
        instructions("`Tracker::push`, a mean that ends a second", "tracker_second", None)?,
        instructions("`Tracker::push`, once in 16 s: a mean that it learns from", "tracker_learned", None)?,
        instructions("`Tracker::push`, a mean that shows a motion or a step", "tracker_motion", None)?,
        instructions("`Tracker::tracked`: bias and u", "tracker_bias", None)?,
        bytes("RAM, the driver's object (on a bus and a pin of 0 bytes)", "driver", Some(64))?,
        bytes("RAM, the sampler's object", "sampler", None)?,
        bytes("RAM, the tracker's object", "tracker", None)?,
        bytes("what the tracker keeps over a power-down", "tracker_saved", None)?,
    ])
}

/// Compares the figures with page and goals. Fails if one rose by more than 5 %, unless `--update` wrote the page.
fn judge(figures: &[Figure]) -> Result<()> {
    for missed in footprint::missed_goals(figures) {
        eprintln!("GOAL MISSED: {missed}");
    }
    let page = footprint::read()?;
    let risen = footprint::risen(figures, &page);
    if !risen.is_empty() {
        bail!("figures rose by more than 5 %: {}; if that is meant, add --update", risen.join("; "));
    }
    for change in footprint::changed(figures, &page) {
        eprintln!("{}: {change}; --update writes it there", footprint::PAGE);
    }
    Ok(())
}

fn rustc_version() -> Result<String> {
    let text = printed(Command::new("rustc").arg("--version"))?;
    Ok(text.split_whitespace().nth(1).unwrap_or("unknown").to_owned())
}
