//! MCAP's conformance files, and captures in this form for its own tools.

use super::reader::{self, Reader};
use super::tally::{Outcome, Tally};
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const FILES: &str = "tests/conformance/data";
/// Samples of the capture that other tools check.
const SAMPLES: u64 = 20_000;

pub fn run(program: &Path, folder: &Path) -> Result<Option<Tally>> {
    let Some(python) = reader::python() else { return Ok(None) };
    let (reader, written) = (Reader::new(program)?, tempfile::tempdir()?);
    let mut command = Command::new(&python);
    command.arg("lab/src/attacks/conformance.py").arg(folder.join(FILES)).arg(written.path());
    let names = printed(&mut command)?;
    ensure!(!names.is_empty(), "{}: no file", folder.join(FILES).display());
    let mut tally = Tally::default();
    for file in names.lines().map(PathBuf::from) {
        let name = file.file_stem().context("a name")?.to_string_lossy().into_owned();
        let (kind, _) = name.split_once('-').unwrap_or((&name, ""));
        let described = fs::read_to_string(folder.join(FILES).join(kind).join(format!("{name}.json")))?;
        let topics = topics(&serde_json::from_str(&described)?)?;
        let outcome = reader.refusal(&file).map(|why| judge(why, &topics));
        tally.note(name, outcome.unwrap_or_else(|why| Outcome::Wrong(format!("{why:#}"))));
    }
    own_capture(program, &python, written.path(), &mut tally)?;
    Ok(Some(tally))
}

/// The topics that have messages, each with its type.
fn topics(described: &Value) -> Result<Vec<String>> {
    let records = described["records"].as_array().context("no records")?;
    let of = |kind: &'static str| records.iter().filter(move |record| record["type"] == kind);
    let field = |record: &Value, name: &str| {
        let fields = record["fields"].as_array()?;
        fields.iter().find(|field| field[0] == name)?[1].as_str().map(str::to_owned)
    };
    let channel = |message| {
        let id = field(message, "channel_id");
        let channel = of("Channel").find(|channel| field(channel, "id") == id).context("no channel")?;
        let schema = of("Schema").find(|schema| field(schema, "id") == field(channel, "schema_id"));
        let kind = schema.and_then(|schema| field(schema, "name")).unwrap_or_else(|| "no type".to_owned());
        Ok(format!("{} ({kind})", field(channel, "topic").context("no topic")?))
    };
    of("Message").map(channel).collect()
}

/// The program has read the records where it names the topics with their types: none is of an IMU.
fn judge(why: String, topics: &[String]) -> Outcome {
    let is_read = if topics.is_empty() {
        why.contains("it has no messages")
    } else {
        why.contains("without a topic of type sensor_msgs/msg/Imu") && topics.iter().all(|topic| why.contains(topic))
    };
    if is_read { Outcome::Refused(why) } else { Outcome::Wrong(format!("not {topics:?}: {why}")) }
}

/// A capture of the program, read by MCAP's library for Python with all sums, and by `mcap doctor` where it is there.
fn own_capture(program: &Path, python: &Path, folder: &Path, tally: &mut Tally) -> Result<()> {
    let capture = folder.join("capture.mcap");
    let mut record = Command::new(program);
    record.args(["capture", "--device", "twin:seed=2", "--samples", &SAMPLES.to_string(), "-o"]).arg(&capture);
    done(record.stdout(Stdio::null()))?;
    let found = printed(Command::new(python).arg("lab/src/attacks/mcap_count.py").arg(&capture))?;
    let counts: Vec<u64> = found.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    let is_whole = matches!(counts[..], [found, stated] if found == stated && found >= SAMPLES);
    tally.note("own capture, by MCAP's library", verdict(is_whole, &found));
    match Command::new("mcap").arg("doctor").arg(&capture).output() {
        Ok(output) => {
            let text = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
            let is_right = output.status.success() && !text.contains("Warning") && !text.contains("Error");
            tally.note("own capture, by mcap doctor", verdict(is_right, &text));
        }
        Err(_) => println!("SKIPPED: mcap doctor: MCAP's program `mcap` is not there"),
    }
    Ok(())
}

fn verdict(is_right: bool, found: &str) -> Outcome {
    if is_right { Outcome::Right } else { Outcome::Wrong(found.to_owned()) }
}
