//! A column of a log, and what is known about it.

use crate::column_checks::ColumnFacts;
use crate::error::{Result, too_many};
use crate::series::{Series, missing_in, with_gaps};
use crate::setting::Names;
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::{Gap, Input};
use zerorate_input::Quantity;

/// A column, and what is known about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, or its number where columns have no names.
    pub name: String,
    /// The numbers in order. Missing samples are NaN among numbers.
    pub series: Series,
    /// Missing samples among codes.
    pub gaps: Vec<Gap>,
    /// Mean rate of the samples, those that are missing included.
    pub rate_hz: f64,
    /// Its quantity, if the file states its unit, or a unit or a scale was given.
    pub quantity: Option<Quantity>,
    /// The size of a step in the unit of that quantity's results; 1 if the unit is not known.
    pub scale: f64,
    /// The size of a step of 1 that the log states, in its unit; 1 unless the log states it beside the unit.
    pub step: f64,
    /// The warnings about the file: a tail that was torn off, a unit that is not known.
    pub warnings: Vec<LogWarning>,
    /// The findings in these samples; none where the samples were changed since they were checked.
    pub(crate) facts: Option<ColumnFacts>,
}

impl Column {
    /// A column of which nothing else is known. Its samples are not checked.
    pub fn new(name: &str, series: Series, rate_hz: f64) -> Self {
        let (name, gaps, warnings) = (name.to_owned(), Vec::new(), Vec::new());
        Self { name, series, gaps, rate_hz, quantity: None, scale: 1.0, step: 1.0, warnings, facts: None }
    }

    /// The number of missing samples.
    pub fn missing(&self) -> u64 {
        match &self.series {
            Series::Codes(_) => missing_in(&self.gaps),
            Series::Numbers(_) => self.facts().changes.missing() as u64,
        }
    }

    /// The samples as a rate, for deviations and models.
    pub fn input(&self) -> Input<'_> {
        self.series.input(&self.gaps)
    }

    /// The warning where the column stops changing.
    ///
    /// # Errors
    /// Refuses a column that never changes, as [`crate::stopped`].
    pub fn stopped(&self, path: &Path) -> Result<Option<LogWarning>> {
        self.facts().changes.stopped(&self.gaps, self.rate_hz, path, &self.name)
    }

    /// The findings in the samples, which are read again only if they were changed.
    pub fn facts(&self) -> ColumnFacts {
        self.facts.unwrap_or_else(|| ColumnFacts::of(&self.input()))
    }

    /// Puts other samples in the place of these, without gaps beside them.
    pub fn replace(&mut self, series: Series) {
        self.series = series;
        self.gaps.clear();
        self.facts = None;
    }

    /// Whether it is 0 in every row.
    pub fn is_blank(&self) -> bool {
        match &self.series {
            Series::Codes(codes) => codes.iter().all(|code| *code == 0),
            Series::Numbers(numbers) => numbers.iter().all(|number| *number == 0.0),
        }
    }

    /// A number for each sample of the log in the file `path`, NaN where it is missing.
    pub fn points(&self, path: &Path) -> Result<Vec<f64>> {
        match &self.series {
            Series::Numbers(numbers) => Ok(numbers.clone()),
            Series::Codes(codes) => {
                with_gaps(codes, &self.gaps).map_err(|missing| too_many(path, missing, Names::default()))
            }
        }
    }

    /// Leaves out the first so many samples, those that are missing counted.
    pub fn skip(&mut self, samples: u64) {
        self.facts = None;
        match &mut self.series {
            Series::Numbers(numbers) => drop(numbers.drain(..numbers.len().min(samples as usize))),
            Series::Codes(codes) => {
                let mut missing = 0;
                let before = self.gaps.iter().take_while(|gap| {
                    // the gap ends where this code is in the record
                    let inside = gap.at as u64 + missing + gap.missing <= samples;
                    missing += if inside { gap.missing } else { 0 };
                    inside
                });
                self.gaps.drain(..before.count());
                let skipped = codes.len().min((samples - missing) as usize);
                // one that the cut goes through leaves its codes behind it
                let skipped = self.gaps.first().map_or(skipped, |gap| skipped.min(gap.at));
                codes.drain(..skipped);
                self.gaps.iter_mut().for_each(|gap| gap.at -= skipped);
                self.gaps.retain(|gap| gap.at > 0);
            }
        }
    }

    /// Closes up all gaps, as if no time had passed in them.
    pub fn close_gaps(&mut self) {
        self.gaps.clear();
        self.facts = None;
        if let Series::Numbers(numbers) = &mut self.series {
            numbers.retain(|number| !number.is_nan());
        }
    }
}
