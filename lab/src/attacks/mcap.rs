//! Has the program read MCAP's conformance files, and checks that the program finds all their topics.

use super::reader::{self, Reader};
use super::tally::{Outcome, Tally};
use crate::venv::printed;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const FILES: &str = "tests/conformance/data";

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

/// No topic is an IMU, so the program must refuse the file. If its error names all topics with their types, it has
/// read the records.
fn judge(why: String, topics: &[String]) -> Outcome {
    let is_read = if topics.is_empty() {
        why.contains("it has no messages")
    } else {
        why.contains("without a topic of type sensor_msgs/msg/Imu") && topics.iter().all(|topic| why.contains(topic))
    };
    if is_read { Outcome::Refused(why) } else { Outcome::Wrong(format!("not {topics:?}: {why}")) }
}
