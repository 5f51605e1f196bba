//! `zerorate verify`: checks files for damage and contradictions.

use crate::output::{print, print_json};
use anyhow::{Result, ensure};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};
use zerorate::Calibration;
use zerorate_host::files;
use zerorate_input::Opened;
use zerorate_input::delimited::is_table;
use zerorate_input::table::BatchSource;
use zerorate_input::{Input, InputError};
use zerorate_jobs::output::is_being_recorded;
use zerorate_record::table;
use zerorate_record::{CaptureError, CaptureInfo, Checked};
use zerorate_view::duration::Seconds;

/// Largest number of bytes that are read of a calibration file, to limit the memory for a file that is something else.
const CALIBRATION_BYTES: u64 = 1 << 20;

/// The kind that a report states for a file that is neither a capture nor a calibration.
const OTHER: &str = "other";

/// Check captures and calibration files for damage
///
/// The exit code is 0 if all files are undamaged, and 1 if not. Every checksum in a file is computed again, and time,
/// edges and losses of the rows are compared. For a torn file (a power cut, a killed process) or a damaged one the
/// command names the place and the remedy: `zerorate repair` writes the undamaged blocks before that place to a new
/// file. A file that is being recorded is not whole yet; verify it again later.
#[derive(Args, Debug)]
pub struct VerifyArgs {
    /// Captures in any form, and calibrations.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    whole: bool,
    files: Vec<Verdict>,
}

#[derive(Default, Serialize)]
struct Verdict {
    file: String,
    whole: bool,
    /// The kind of file. [`OTHER`] if it is neither a capture nor a calibration; empty if the kind is not known,
    /// because the file cannot be read or its head is damaged.
    form: &'static str,
    schema: Option<u32>,
    #[serde(flatten)]
    stated: Option<CaptureFacts>,
    /// True if the file's own checks cover everything that was read, and nothing is damaged.
    checked: bool,
    rows: u64,
    lost: u64,
    first_ns: Option<u64>,
    last_ns: Option<u64>,
    samples_sha256: Option<String>,
    torn: bool,
    /// The damage and its place in the file, or why the file cannot be checked; `None` if there is neither.
    damage: Option<String>,
    /// The advice for a file that is torn, damaged or of another kind; `None` for a whole or unreadable file.
    remedy: Option<String>,
    notes: Vec<String>,
    /// True if the content is unknown, because the file does not exist or this program cannot read it.
    #[serde(skip)]
    unread: bool,
    /// True if the file has no end because a running process records into it.
    #[serde(skip)]
    being_recorded: bool,
}

#[derive(Serialize)]
struct CaptureFacts {
    part: String,
    serial: Option<String>,
    device: String,
    simulated: bool,
    /// Time of recording, RFC 3339; empty if simulated.
    created: String,
}

impl CaptureFacts {
    fn of(info: &CaptureInfo) -> Self {
        let CaptureInfo { serial, device, created, .. } = info.clone();
        Self { part: info.part().name.to_string(), serial, device, simulated: info.is_simulated(), created }
    }
}

pub fn run(args: &VerifyArgs) -> Result<()> {
    let files: Vec<Verdict> = args.files.iter().map(|path| verdict(path)).collect();
    let broken = files.iter().filter(|verdict| !verdict.whole).count();
    let count = files.len();
    if args.json {
        print_json(&Report { whole: broken == 0, files })?;
    } else {
        print(&files.iter().map(Verdict::to_text).collect::<String>())?;
    }
    ensure!(broken == 0, "{broken} of {count} files not whole");
    Ok(())
}

/// The advice about a file that a running process records into.
const AGAIN: &str = "verify it again when its recording has ended";

fn verdict(path: &Path) -> Verdict {
    let file = path.display().to_string();
    let opened = files::open(path).map_err(CaptureError::from);
    let found = match opened.and_then(|input| table::recognise(path, input)) {
        Ok(Opened::Table(source)) => capture(path, source),
        Ok(Opened::Other(text)) => calibration(path, text),
        Err(error) => Err(error),
    };
    let verdict = found.unwrap_or_else(|error| {
        // nothing can be read of a Parquet file before its end, and of a CSV in its first second
        if is_being_recorded(path) {
            let remedy = Some(AGAIN.to_owned());
            return Verdict { torn: true, being_recorded: true, remedy, ..Verdict::default() };
        }
        let other = "verify checks captures and calibrations; `zerorate allan` reads other logs. If this was a \
                     capture, take another copy";
        let (remedy, form) = match error {
            CaptureError::Input(InputError::Damaged { .. } | InputError::Table { .. }) => (Some(remedy(path, 0)), ""),
            CaptureError::NotACapture { .. } => (Some(other.to_owned()), OTHER),
            _ => (None, ""),
        };
        Verdict { unread: remedy.is_none(), damage: Some(reason(error)), remedy, form, ..Verdict::default() }
    });
    Verdict { whole: !verdict.torn && verdict.damage.is_none(), file, ..verdict }
}

/// The advice about a damaged capture with `rows` rows before its first damaged block.
fn remedy(path: &Path, rows: u64) -> String {
    match rows {
        0 => "no row of it can be kept: take another copy".to_owned(),
        rows => format!("`zerorate repair {} -o NEW.arrows` keeps the {rows} rows before", path.display()),
    }
}

fn reason(error: CaptureError) -> String {
    // the error of Arrow has several lines
    format!("{:#}", anyhow::Error::from(error)).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn capture(path: &Path, source: Box<dyn BatchSource>) -> Result<Verdict, CaptureError> {
    let form = source.form();
    let mut table = Checked::new(path, source)?;
    let mut whole_rows = 0;
    let damage = loop {
        match table.next() {
            Some(Ok(_)) => whole_rows = table.found().rows,
            Some(Err(error)) => break Some(reason(error)),
            None => break None,
        }
    };
    let behind = table.behind_end().map(ToString::to_string);
    let mut notes: Vec<String> = table.warnings().iter().map(ToString::to_string).collect();
    notes.retain(|note| Some(note) != behind.as_ref());
    let damage = damage.or(behind);
    let being_recorded = table.is_torn() && damage.is_none() && is_being_recorded(path);
    if being_recorded {
        // it is not closed yet, and nothing of it is dropped
        notes.clear();
    }
    let remedy = match being_recorded {
        true => Some(AGAIN.to_owned()),
        false => (table.is_torn() || damage.is_some()).then(|| remedy(path, whole_rows)),
    };
    let found = table.found();
    Ok(Verdict {
        form,
        schema: Some(table.info().schema),
        stated: Some(CaptureFacts::of(table.info())),
        checked: table.is_checked() && damage.is_none(),
        rows: found.rows,
        lost: found.lost,
        first_ns: found.span_ns.map(|(first, _)| first),
        last_ns: found.span_ns.map(|(_, last)| last),
        samples_sha256: table.samples_sha256().filter(|_| damage.is_none()),
        torn: table.is_torn(),
        damage,
        remedy,
        notes,
        being_recorded,
        ..Verdict::default()
    })
}

fn calibration(path: &Path, file: Input) -> Result<Verdict, CaptureError> {
    let mut text = String::new();
    let read = file.take(CALIBRATION_BYTES).read_to_string(&mut text);
    let (one, several) = (text.contains("[correction]"), text.contains("axis") && text.contains("correction"));
    if read.is_err() || !(one || several || Calibration::is_begun_by(&text)) {
        let why = match is_table(&text) && !text.contains("zerorate.") {
            true => "it is a CSV of other software, which has no check lines, so it cannot be verified",
            false => "it is not a calibration file either",
        };
        return Err(CaptureError::not_a_capture(path, why));
    }
    let parsed = Calibration::parse(&text);
    Ok(Verdict {
        form: "calibration",
        schema: Some(parsed.as_ref().map_or(if one { 1 } else { 2 }, |(calibration, _)| calibration.schema())),
        checked: parsed.as_ref().is_ok_and(|(_, warnings)| warnings.is_empty()),
        notes: parsed.iter().flat_map(|(_, warnings)| warnings).map(ToString::to_string).collect(),
        remedy: parsed.is_err().then(|| "take another copy, or calibrate again".to_owned()),
        damage: parsed.err().map(|error| format!("{}: {error}", path.display())),
        ..Verdict::default()
    })
}

impl Verdict {
    fn to_text(&self) -> String {
        let state = match (&self.damage, self.torn) {
            (Some(_), _) if self.form == OTHER => "NOT A CAPTURE",
            (Some(_), _) if self.unread => "NOT READ",
            (Some(_), _) => "DAMAGED",
            (None, true) if self.being_recorded => "BEING RECORDED",
            (None, true) => "TORN",
            (None, false) if self.checked => "whole",
            (None, false) => "readable, unchecked",
        };
        let mut text = format!("{}: {state}", self.file);
        if let (Some(schema), form) = (self.schema, self.form) {
            text += &format!(", {form}, version {schema}");
        }
        if let (Some(first), Some(last)) = (self.first_ns, self.last_ns) {
            let span = Seconds((last - first) as f64 * 1e-9);
            text += &format!(", {} rows over {span}, {} lost", self.rows, self.lost);
        }
        if let Some(hash) = &self.samples_sha256 {
            text += &format!(", sample hash {hash}");
        }
        for note in self.damage.iter().chain(&self.notes).chain(&self.remedy) {
            // writing to a string cannot fail
            let _ = write!(text, "\n  {note}");
        }
        text + "\n"
    }
}
