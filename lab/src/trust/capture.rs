//! The part fails at a random moment of a recording. A recording of the same unit without the fault is the reference.

use super::bench::{Bench, Folder, Run, random};
use super::faults::{Fault, fault_of};
use super::{Class, Verdict};
use anyhow::{Context, Result};
use rand::RngExt;
use std::collections::BTreeMap;
use std::fs;

const fn class(name: &'static str, what: &'static str) -> Class {
    Class { name, what, quick: 4, run: capture }
}

pub const CLASSES: &[Class] = &[
    class("capture sdo_low", "SDO falls to 0"),
    class("capture sdo_high", "SDO rises to 1"),
    class("capture frozen", "the data registers stop"),
    class("capture rdy_lost", "the RDY line breaks"),
    class("capture rdy_stutter", "edges of RDY are missing"),
    class("capture bit_errors", "one bit in 100 000 flips: rows wrong by 5 °/s must be flagged by `correct`"),
    class("capture brownout", "the supply dips, and the registers reset"),
    class("capture unplug", "the cable is pulled"),
];

/// Duration of the recording in the part's time, s.
const LENGTH_S: f64 = 6.0;
/// Largest error of a rate that need not be flagged, codes: 5 °/s (F-40).
const WRONG_CODES: i64 = 5 * 23_488;

/// A row of a capture, before or after correction.
struct CheckedRow {
    rate_code: i64,
    lost: u64,
    flagged: bool,
}

fn capture(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let fault = fault_of(class)?;
    let at_s = random(class, seed).random_range(0.0..LENGTH_S);
    let Fault { name, keys, causes } = fault;
    let folder = Folder::new(&format!("capture-{name}-{seed}"))?;
    let (clean, file, corrected) = (folder.file("clean.csv"), folder.file("log.csv"), folder.file("corrected.csv"));
    let length = format!("{LENGTH_S}s");
    bench.must(&["capture", "--device", &format!("twin:seed={seed}"), "--duration", &length, "-o", &clean])?;
    let device = format!("twin:seed={seed},fault={name},fault_at_s={at_s:.3}{keys}");
    let run = bench.run(&["capture", "--device", &device, "--duration", &length, "-o", &file, "--json"])?;
    if !fs::exists(&file)? {
        return Ok(run.refusal(causes));
    }
    let correct = bench.run(&["correct", &file, "--cal", &bench.file("unit.toml"), "-o", &corrected])?;
    let heard = run.code != Some(0) || telling(&run) || correct.code != Some(0);
    let rows = rows(if correct.code == Some(0) { &corrected } else { &file })?;
    Ok(match compare(&rows, &self::rows(&clean)?) {
        Some(_) if heard => Verdict::Warned,
        Some(wrong) => Verdict::Silent(wrong),
        None if run.code == Some(0) => Verdict::Right,
        None => run.refusal(causes),
    })
}

fn telling(run: &Run) -> bool {
    run.json().is_ok_and(|summary| summary["warnings"].as_array().is_some_and(|warnings| !warnings.is_empty()))
}

/// The first error in `rows`, if any: a rate that is off by more than 5 °/s and not flagged, or a loss that was not
/// counted.
fn compare(rows: &BTreeMap<u64, CheckedRow>, clean: &BTreeMap<u64, CheckedRow>) -> Option<String> {
    for (t_ns, row) in rows {
        let Some(true_row) = clean.get(t_ns) else { continue };
        let off = row.rate_code - true_row.rate_code;
        if off.abs() > WRONG_CODES && !row.flagged {
            return Some(format!("at {t_ns} ns the rate is {:.2} °/s off", off as f64 / 23_488.0));
        }
    }
    let (first, last) = (rows.keys().next()?, rows.keys().next_back()?);
    let known = clean.range(first..=last).count() as u64;
    let told = rows.len() as u64 + rows.values().skip(1).map(|row| row.lost).sum::<u64>();
    (told < known)
        .then(|| format!("{known} samples were converted, {} recorded, and the others not counted", rows.len()))
}

/// The rows of a CSV capture, by their time.
fn rows(file: &str) -> Result<BTreeMap<u64, CheckedRow>> {
    let text = fs::read_to_string(file).with_context(|| file.to_owned())?;
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().context("no header")?.split(',').collect();
    let column = |name: &str| header.iter().position(|title| *title == name);
    let needed = |name: &str| column(name).with_context(|| format!("{file}: no column {name}"));
    let (t_ns, rate_code, lost) = (needed("t_ns")?, needed("rate_code")?, needed("lost")?);
    let flags = column("flags");
    let parse = |line: &str| -> Result<(u64, CheckedRow)> {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |index: usize| cells.get(index).copied().with_context(|| format!("{file}: {line}"));
        let flagged = flags.is_some_and(|index| cells.get(index).is_some_and(|cell| !matches!(*cell, "" | "0")));
        let row = CheckedRow { rate_code: cell(rate_code)?.parse()?, lost: cell(lost)?.parse()?, flagged };
        Ok((cell(t_ns)?.parse()?, row))
    };
    lines.map(parse).collect()
}
