//! Reads a capture and checks it: its description, each block, its end, and the consistency of successive rows.

use super::CaptureError;
use super::chain::{self, Chain, End};
use super::columns::Rows;
use super::info::CaptureInfo;
use super::layout::AXES;
use super::succession::{Break, Continuity};
use super::warning::CaptureWarning;
use arrow_array::RecordBatch;
use arrow_schema::{Metadata, SchemaRef};
use std::path::{Path, PathBuf};
use zerorate_input::InputWarning;
use zerorate_input::table::{BatchSource, END};

/// Reads a table that describes itself as a capture, and checks it.
pub struct Checked {
    path: PathBuf,
    info: CaptureInfo,
    source: Box<dyn BatchSource>,
    checks: Checks,
    succession: Continuity,
    found: Found,
    ended: bool,
}

enum Checks {
    /// Schema 1: the file has no checks.
    Absent,
    /// Schema 2: each block is checked.
    Chained(Box<Chain>),
    /// Schema 2, rewritten by other software, which keeps description and columns but drops the checks of the rows.
    Stripped,
}

/// Totals of the rows that were read so far.
#[derive(Clone, Debug, Default)]
pub struct Found {
    pub rows: u64,
    /// Sum of the rows' losses.
    pub lost: u64,
    /// `t_ns` of the first and of the last row; `None` before the first.
    pub span_ns: Option<(u64, u64)>,
    /// Number of rows whose `edge_seq` contradicts the time, in an otherwise valid file.
    edges_out_of_place: u64,
}

impl Checked {
    /// Opens a table and checks its description.
    pub fn new(path: &Path, source: Box<dyn BatchSource>) -> Result<Self, CaptureError> {
        let schema = source.stated().schema.clone();
        let info = CaptureInfo::from_metadata(path, schema.metadata())?;
        let stated = schema.metadata().get(chain::HEAD);
        let damaged = |what: &str| Err(CaptureError::damaged(path, "metadata", what));
        let checks = match (info.schema, stated) {
            (1, None) if !schema.metadata().contains_key(AXES) => Checks::Absent,
            (1, _) => return damaged("it calls itself version 1, which has neither checks nor axes"),
            (_, None) => return damaged(&format!("`{}` is missing", chain::HEAD)),
            (_, Some(stated)) if *stated != chain::head(&schema) => {
                return damaged(
                    "the description or the columns are not those that were recorded (their check differs)",
                );
            }
            _ => Checks::Chained(Box::new(Chain::new(&schema, &info.layout))),
        };
        Rows::from_batch(path, "columns", &RecordBatch::new_empty(schema), &info.layout)?;
        Ok(Self {
            path: path.to_owned(),
            info,
            source,
            checks,
            succession: Continuity::default(),
            found: Found::default(),
            ended: false,
        })
    }

    /// The description of the capture.
    pub fn info(&self) -> &CaptureInfo {
        &self.info
    }

    /// The Arrow schema of the file: its columns, and all its metadata.
    pub fn schema(&self) -> SchemaRef {
        self.source.stated().schema.clone()
    }

    /// The metadata entries that describe the capture. Checks, and entries of other software, are left out.
    pub fn description(&self) -> Metadata {
        let schema = self.schema();
        let entries = schema.metadata().iter().filter(|(key, _)| chain::describes(key));
        entries.map(|(key, value)| (key.clone(), value.clone())).collect()
    }

    /// Totals of the rows read so far.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// True if checks cover every row read so far.
    pub fn is_checked(&self) -> bool {
        matches!(self.checks, Checks::Chained(_))
    }

    /// True if the file ends before the end of the capture, as after a power cut. Known once all rows were read.
    pub fn is_torn(&self) -> bool {
        self.source.stated().torn
    }

    /// The warning about bytes after the end, if there are any. Known once all rows were read.
    pub fn behind_end(&self) -> Option<&InputWarning> {
        let warning = self.source.stated().warning.as_ref();
        warning.filter(|warning| matches!(warning, InputWarning::BytesBehindEnd { .. }))
    }

    /// The warnings. Complete once all rows were read.
    pub fn warnings(&self) -> Vec<CaptureWarning> {
        let path = || self.path.display().to_string();
        let unchecked = match self.checks {
            Checks::Absent => Some(CaptureWarning::Unchecked { path: path() }),
            Checks::Stripped => Some(CaptureWarning::Rewritten { path: path() }),
            Checks::Chained(_) => None,
        };
        let rows = self.found.edges_out_of_place;
        let edges = (rows > 0).then(|| CaptureWarning::EdgesMisplaced { path: path(), rows });
        let of_file = self.source.stated().warning.clone().map(CaptureWarning::File);
        of_file.into_iter().chain(unchecked).chain(edges).collect()
    }

    /// Reads and checks the next record batch. Returns it with its raw rows; `None` after the last batch.
    pub fn next_rows(&mut self) -> Result<Option<(RecordBatch, Rows)>, CaptureError> {
        if self.ended {
            return Ok(None);
        }
        let place = format!("batch at row {}", self.found.rows);
        let batch = self.source.read_batch();
        self.ended = !matches!(batch, Ok(Some(_)));
        let Some(batch) = batch? else {
            self.check_end()?;
            return Ok(None);
        };
        let rows = Rows::from_batch(&self.path, &place, &batch, &self.info.layout)?;
        self.check_block(&place, &batch, &rows)?;
        self.count(&place, &rows)?;
        Ok(Some((batch, rows)))
    }

    fn check_block(&mut self, place: &str, batch: &RecordBatch, rows: &Rows) -> Result<(), CaptureError> {
        let stated = self.source.stated().check.as_deref();
        let may_be_stripped = self.found.rows == 0 && self.source.may_be_stripped();
        let what = match (&mut self.checks, stated) {
            (Checks::Absent, _) | (Checks::Stripped, None) => return Ok(()),
            (Checks::Chained(_), None) if may_be_stripped => {
                self.checks = Checks::Stripped;
                return Ok(());
            }
            (Checks::Stripped, Some(_)) => "it has a check, and those before have none",
            (Checks::Chained(_), None) => "it has no check, though it should",
            (Checks::Chained(chain), Some(stated)) => {
                chain.take(rows, batch);
                if *stated == chain.seal() {
                    return Ok(());
                }
                "its check differs: values were changed, or batches removed, repeated or moved"
            }
        };
        Err(CaptureError::damaged(&self.path, place, what))
    }

    fn check_end(&mut self) -> Result<(), CaptureError> {
        if self.info.schema == 1 {
            return self.succession.review().map_err(|what| self.contradiction("the first rows", &what));
        }
        let (chain, end) = match (&self.checks, self.end()?) {
            (Checks::Chained(chain), Some(end)) => (chain, end),
            (Checks::Stripped, None) if !self.source.stated().torn => return Ok(()),
            (Checks::Chained(_), None) if self.source.stated().torn => return Ok(()),
            _ => {
                return Err(self.wrong_end(
                    "it was closed, and what stands at the end of a closed capture is missing: \
                    rows may be missing as well"
                        .to_owned(),
                ));
            }
        };
        let computed = chain.end();
        if end != computed {
            return Err(self.wrong_end(format!(
                "it ends after {} rows with the sample hash {}, its end states {} and {}",
                computed.rows, computed.samples_sha256, end.rows, end.samples_sha256
            )));
        }
        Ok(())
    }

    fn wrong_end(&self, what: String) -> CaptureError {
        CaptureError::damaged(&self.path, format!("end, after row {}", self.found.rows), what)
    }

    /// Checks that successive rows are consistent, and counts them.
    fn count(&mut self, place: &str, rows: &Rows) -> Result<(), CaptureError> {
        let strict = self.info.schema == 1;
        for mark in rows.marks() {
            let was_learning = self.succession.is_learning();
            match self.succession.follow(mark) {
                Err(Break::EdgesJump { .. }) if !strict => self.found.edges_out_of_place += 1,
                Err(what) => return Err(self.contradiction(&format!("{place}, row {}", self.found.rows), &what)),
                Ok(()) => {}
            }
            if strict && was_learning && !self.succession.is_learning() {
                self.succession.review().map_err(|what| self.contradiction("the first rows", &what))?;
            }
            self.found.rows += 1;
            self.found.lost += u64::from(mark.lost);
            let start = self.found.span_ns.map_or(mark.t_ns, |(start, _)| start);
            self.found.span_ns = Some((start, mark.t_ns));
        }
        Ok(())
    }

    fn contradiction(&self, place: &str, what: &Break) -> CaptureError {
        CaptureError::damaged(&self.path, place, what.to_string())
    }

    /// The sample hash of the rows read so far; `None` for a file without checks.
    pub fn samples_sha256(&self) -> Option<String> {
        match &self.checks {
            Checks::Chained(chain) => Some(chain.samples_sha256()),
            Checks::Absent | Checks::Stripped => None,
        }
    }

    /// The statement at the end of the file; `None` if there is none or, except in Parquet, before all rows were read.
    ///
    /// # Errors
    /// Returns an error if the statement is malformed.
    pub fn end(&self) -> Result<Option<End>, CaptureError> {
        let Some(stated) = &self.source.stated().end else { return Ok(None) };
        let malformed = || CaptureError::damaged(&self.path, "metadata", format!("`{END}` is malformed: {stated}"));
        End::parse(stated).map(Some).ok_or_else(malformed)
    }
}

impl Iterator for Checked {
    type Item = Result<RecordBatch, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_rows().transpose();
        self.ended |= !matches!(next, Some(Ok(_)));
        next.map(|rows| rows.map(|(batch, _)| batch))
    }
}
