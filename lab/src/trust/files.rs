//! Damaged files: a bit is flipped, the end is missing, a range is removed or repeated, or a digit is edited.

use super::bench::{Bench, Folder, random};
use super::chamber::with_another_digit;
use super::process::hash;
use super::{Class, Verdict};
use anyhow::{Result, ensure};
use rand::RngExt;
use rand::rngs::StdRng;
use std::fs;
use std::ops::Range;

const fn class(name: &'static str, what: &'static str) -> Class {
    Class { name, what, quick: 10, run: damaged }
}

pub const CLASSES: &[Class] = &[
    class("flip arrows", "one bit of a capture flips"),
    class("flip parquet", "one bit of a capture flips"),
    class("flip csv", "one bit of a capture flips"),
    class("flip toml", "one bit of a calibration flips"),
    class("cut arrows", "a capture ends early"),
    class("cut parquet", "a capture ends early"),
    class("cut csv", "a capture ends early"),
    class("cut toml", "a calibration ends early"),
    class("hole arrows", "a stretch of bytes is gone"),
    class("hole parquet", "a stretch of bytes is gone"),
    class("hole csv", "some lines are gone"),
    class("twice csv", "some lines come twice"),
    Class::new("edit track state", "a digit of the state of `stream --track` is another one", 4, edited_state),
];

fn damaged(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let (how, form) = class.split_once(' ').unwrap_or((class, ""));
    let source = bench.file(&format!("{}.{form}", if form == "toml" { "unit" } else { "rest" }));
    let whole = fs::read(&source)?;
    let mut random = random(class, seed);
    let bytes = match how {
        "flip" => flipped(&whole, &mut random),
        "cut" => whole[..random.random_range(0..whole.len())].to_vec(),
        "hole" => without(&whole, stretch(&whole, form, &mut random)),
        _ => twice(&whole, stretch(&whole, form, &mut random)),
    };
    let folder = Folder::new(&format!("{how}-{form}-{seed}"))?;
    let file = folder.file(&format!("damaged.{form}"));
    fs::write(&file, &bytes)?;
    let verdict = if form == "toml" { calibration(bench, &file, &source)? } else { recording(bench, &file, &source)? };
    Ok(if bytes == whole { Verdict::Right } else { verdict })
}

fn flipped(whole: &[u8], random: &mut StdRng) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    bytes[random.random_range(0..whole.len())] ^= 1 << random.random_range(0..8);
    bytes
}

fn without(whole: &[u8], gone: Range<usize>) -> Vec<u8> {
    [&whole[..gone.start], &whole[gone.end..]].concat()
}

fn twice(whole: &[u8], again: Range<usize>) -> Vec<u8> {
    [&whole[..again.end], &whole[again.start..]].concat()
}

/// A random range of bytes, or of whole lines in a CSV file.
fn stretch(whole: &[u8], form: &str, random: &mut StdRng) -> Range<usize> {
    let (a, b) = (random.random_range(0..whole.len()), random.random_range(0..whole.len()));
    let line = |at: usize| whole[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let [a, b] = if form == "csv" { [line(a), line(b)] } else { [a, b] };
    a.min(b)..a.max(b)
}

/// The verdict on a damaged capture, which may be read unchanged, refused, or read partially with a warning.
fn recording(bench: &Bench, file: &str, source: &str) -> Result<Verdict> {
    let verify = bench.run(&["verify", file])?;
    if let Some(wrong) = believed(bench, file)? {
        return Ok(Verdict::Silent(wrong));
    }
    Ok(match verify.code {
        Some(1) => Verdict::Refused,
        Some(0) if hash(bench, file)? == hash(bench, source)? => Verdict::Right,
        code => Verdict::Silent(format!("verify ends with {code:?}: {}{}", verify.stdout, verify.stderr)),
    })
}

/// An error text if `correct` accepts the file without a warning, but with other output than for the undamaged file.
fn believed(bench: &Bench, file: &str) -> Result<Option<String>> {
    let (run, rows) = bench.corrected(file, &format!("{file}.corrected.csv"))?;
    let silent = run.code == Some(0) && rows != bench.rest_rows && run.stderr.lines().count() <= bench.rest_words;
    Ok(silent.then(|| format!("correct believes it: {}", run.stderr)))
}

/// The verdict on a damaged calibration. The file must have its old meaning, be refused, or cause a warning.
fn calibration(bench: &Bench, file: &str, source: &str) -> Result<Verdict> {
    let [damaged, whole] = [file, source].map(|file| bench.run(&["export", file, "--format", "csv"]));
    let (damaged, whole) = (damaged?, whole?);
    Ok(match damaged.code {
        Some(1 | 2) => Verdict::Refused,
        Some(0) if damaged.stdout == whole.stdout => Verdict::Right,
        Some(0) if !damaged.stderr.is_empty() && damaged.stderr != whole.stderr => Verdict::Warned,
        code => Verdict::Silent(format!("export ends with {code:?}: {}{}", damaged.stdout, damaged.stderr)),
    })
}

/// Edits the saved state of a tracker. The program must use the state as if it were not edited, or refuse and keep it.
fn edited_state(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("state-{seed}"))?;
    let state = folder.file("state.toml");
    let (device, cal) = (format!("twin:seed={seed}"), bench.file("unit.toml"));
    let stream = |duration: &str| {
        let line = ["stream", "--device", &device, "--cal", &cal, "--rate", "1", "--duration", duration, "--track"];
        bench.run(&[&line[..], &["--state", &state]].concat())
    };
    stream("30s")?;
    let whole = fs::read_to_string(&state)?;
    let expected = stream("5s")?;
    ensure!(expected.code == Some(0), "{}", expected.stderr);
    let edited = with_another_digit(&whole, &mut random(class, seed));
    fs::write(&state, &edited)?;
    let run = stream("5s")?;
    Ok(match run.code {
        Some(0) if run.stdout == expected.stdout => Verdict::Right,
        Some(0) => Verdict::Silent(format!("the edited state was believed: {}\n{edited}", run.stderr)),
        Some(1) if fs::read_to_string(&state)? != edited => Verdict::Silent("the refused state is gone".to_owned()),
        _ => run.refusal(&["not a usable state"]),
    })
}
