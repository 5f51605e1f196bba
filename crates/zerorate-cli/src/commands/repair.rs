//! `zerorate repair`: copies the undamaged part of a capture to a new file.

use crate::interrupt;
use crate::output::{Outputs, print, warn};
use crate::wording::form;
use anyhow::{Result, bail, ensure};
use arrow_array::RecordBatch;
use arrow_schema::{Field, Metadata, SchemaRef};
use clap::Args;
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_input::Opened;
use zerorate_record::columns::Rows;
use zerorate_record::table;
use zerorate_record::{CaptureError, CaptureWarning, Checked, Format, Layout, checked_schema};

/// The metadata key that states what is missing from a repaired capture.
const REPAIRED: &str = "zerorate.repaired";

/// Copy the undamaged part of a capture to a new file
///
/// A block is a second of samples, or 65536 rows of Parquet. All blocks before the first torn or damaged one are kept,
/// bit for bit, and the command says what is missing. The original file is never changed. A capture of version 1
/// becomes one of version 2, which has checks.
#[derive(Args, Debug)]
pub struct RepairArgs {
    /// The capture.
    #[arg(value_name = "FILE")]
    pub capture: PathBuf,

    /// The file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The form of the file [default: as its ending states, or arrows without an ending].
    #[arg(long, value_enum)]
    format: Option<Format>,

    /// Overwrite an existing file.
    #[arg(long)]
    force: bool,
}

pub fn run(args: &RepairArgs) -> Result<()> {
    let format = form(args.format, &args.output)?;
    let mut outputs = Outputs::new(args.force).reading([&*args.capture])?;
    let intact = IntactPart::of(&args.capture)?;
    interrupt::listen();
    let output = outputs.derived(&args.output)?;
    let mut table = open(&args.capture)?;
    let schema = schema(&table, intact.missing.as_deref());
    let mut sink = table::create(&args.output, Box::new(output.file()?), format, &schema)?;
    while table.found().rows < intact.rows {
        ensure!(!interrupt::stop().asked(), "interrupted; nothing written");
        let Some((batch, rows)) = table.next_rows()? else { break };
        sink.write(&rewritten(&schema, &table.info().layout, &batch, &rows)?)?;
    }
    sink.finish()?;
    output.publish()?;
    warn(&table.warnings().iter().map(CaptureWarning::coded).collect::<Vec<_>>());
    let name = args.output.display();
    let what = intact.missing.map_or_else(|| "nothing was missing".to_owned(), |what| format!("missing: {what}"));
    print(&format!("{name}: {} rows kept; {what}\n", intact.rows))
}

/// The number of undamaged rows at the start of a capture, and the damage after them.
struct IntactPart {
    rows: u64,
    /// Describes what is missing or damaged after these rows; `None` if the capture is complete.
    missing: Option<String>,
}

impl IntactPart {
    fn of(path: &Path) -> Result<Self> {
        let mut table = open(path)?;
        let mut rows = 0;
        let damage = loop {
            match table.next_rows() {
                Ok(Some(_)) => rows = table.found().rows,
                Ok(None) => break None,
                Err(error) => break Some(error),
            }
        };
        let stated =
            table.end().ok().flatten().map(|end| format!("{} of {} rows; ", end.rows.saturating_sub(rows), end.rows));
        let missing = match damage {
            Some(error) if rows == 0 => return Err(error.into()),
            Some(error) => Some(format!("{}{error}", stated.unwrap_or_default())),
            None if rows == 0 && table.is_torn() => {
                bail!("{}: no row of it can be kept: take another copy", path.display())
            }
            None if table.is_torn() || table.behind_end().is_some() => {
                let texts: Vec<String> = table.warnings().iter().map(CaptureWarning::to_string).collect();
                Some(texts.join("; "))
            }
            None => None,
        };
        Ok(Self { rows, missing })
    }
}

fn open(path: &Path) -> Result<Checked, CaptureError> {
    match table::recognise(path, files::open(path)?)? {
        Opened::Table(source) => Checked::new(path, source),
        Opened::Other(_) => Err(CaptureError::not_a_capture(path, "repair takes captures only")),
    }
}

/// The schema of the repaired capture: the columns of the file, and its description in the current format.
fn schema(table: &Checked, missing: Option<&str>) -> SchemaRef {
    let found = table.schema();
    let mut metadata: Metadata = table.description().into_iter().chain(table.info().to_metadata()).collect();
    if let Some(missing) = missing {
        metadata.insert(REPAIRED, missing.replace(['\r', '\n'], " ").trim());
    }
    let raw = table.info().layout.raw_fields();
    let others = found.fields().iter().filter(|field| !is_in(&raw, field)).map(|field| (**field).clone());
    checked_schema(raw.iter().cloned().chain(others).collect(), metadata)
}

fn is_in(fields: &[Field], wanted: &Field) -> bool {
    fields.iter().any(|field| field.name() == wanted.name())
}

fn rewritten(schema: &SchemaRef, layout: &Layout, batch: &RecordBatch, rows: &Rows) -> Result<RecordBatch> {
    let (names, raw) = (batch.schema(), layout.raw_fields());
    let others = names.fields().iter().zip(batch.columns()).filter(|(field, _)| !is_in(&raw, field));
    let columns = rows.columns()?.into_iter().chain(others.map(|(_, column)| column.clone())).collect();
    Ok(RecordBatch::try_new(schema.clone(), columns)?)
}
