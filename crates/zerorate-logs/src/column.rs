//! The type of a column that was read from a log.

use crate::column_checks::ColumnFacts;
use crate::error::{Result, too_many};
use crate::series::{Series, missing_in, with_gaps};
use crate::setting::Names;
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::{Gap, Input};
use zerorate_input::Quantity;

/// A column of a log, with its rate, gaps, quantity and warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The name of the column, or its number if columns have no names.
    pub name: String,
    /// The samples in order. A missing sample among floating-point numbers is NaN.
    pub series: Series,
    /// The places of missing samples among integer codes; empty if `series` holds other numbers.
    pub gaps: Vec<Gap>,
    /// Time that was skipped at the start of the log, s.
    pub skipped_s: f64,
    /// The time of the first sample on the clock of the log, s; `None` if the rate does not come from a clock.
    pub start_s: Option<f64>,
    /// Mean sampling rate in Hz; missing samples count.
    pub rate_hz: f64,
    /// The quantity of the column, if the file states its unit, or a unit or a scale was given.
    pub quantity: Option<Quantity>,
    /// Factor from a sample to the unit in which results of the quantity are given; 1 if the unit is not known.
    pub scale: f64,
    /// Factor from a sample to the unit of the log, if a line above the data states it, as in Gyroflow's logs; else 1.
    pub step: f64,
    /// True if the file states the scale of the codes, as a capture does.
    pub is_scaled: bool,
    /// The warnings about the column, such as an unknown unit. The first column has those about the file too.
    pub warnings: Vec<LogWarning>,
    /// The results of the checks of the samples; `None` without checks, or if the samples were changed since.
    pub(crate) facts: Option<ColumnFacts>,
}

impl Column {
    /// Creates a column with neither gaps nor a unit. Its samples are not checked.
    pub fn new(name: &str, series: Series, rate_hz: f64) -> Self {
        Self {
            name: name.to_owned(),
            series,
            gaps: Vec::new(),
            skipped_s: 0.0,
            start_s: None,
            rate_hz,
            quantity: None,
            scale: 1.0,
            step: 1.0,
            is_scaled: false,
            warnings: Vec::new(),
            facts: None,
        }
    }

    /// The number of missing samples: in gaps among codes, or as NaN among numbers.
    pub fn missing(&self) -> u64 {
        match &self.series {
            Series::Codes(_) => missing_in(&self.gaps),
            Series::Numbers(_) => self.facts().changes.missing() as u64,
        }
    }

    /// The samples and the gaps as input of the Allan analysis.
    pub fn input(&self) -> Input<'_> {
        self.series.input(&self.gaps)
    }

    /// The warning if the column stops changing.
    ///
    /// # Errors
    /// Returns `LogError::Refused` if the column never changes, as [`crate::stopped`] does.
    pub fn stopped(&self, path: &Path) -> Result<Option<LogWarning>> {
        self.facts().changes.stopped(&self.gaps, self.rate_hz, path, &self.name)
    }

    /// The results of the checks of the samples. The samples are read again only if they were changed.
    pub fn facts(&self) -> ColumnFacts {
        self.facts.unwrap_or_else(|| ColumnFacts::of(&self.input()))
    }

    /// Replaces the samples, and removes the gaps.
    pub fn replace(&mut self, series: Series) {
        self.series = series;
        self.gaps.clear();
        self.facts = None;
    }

    /// True if all values of the column are 0. A column of floating-point numbers must have a value.
    pub fn is_blank(&self) -> bool {
        match &self.series {
            Series::Codes(codes) => codes.iter().all(|code| *code == 0),
            Series::Numbers(numbers) => {
                let is_there = |number: &&f64| !number.is_nan();
                numbers.contains(&0.0) && numbers.iter().filter(is_there).all(|number| *number == 0.0)
            }
        }
    }

    /// One number for each sample, NaN where a sample is missing. `path` names the file in messages.
    pub fn points(&self, path: &Path) -> Result<Vec<f64>> {
        match &self.series {
            Series::Numbers(numbers) => Ok(numbers.clone()),
            Series::Codes(codes) => {
                with_gaps(codes, &self.gaps).map_err(|missing| too_many(path, missing, Names::default()))
            }
        }
    }

    /// Removes this many samples from the start; missing samples count.
    pub fn skip(&mut self, samples: u64) {
        self.facts = None;
        match &mut self.series {
            Series::Numbers(numbers) => drop(numbers.drain(..numbers.len().min(samples as usize))),
            Series::Codes(codes) => {
                let mut missing = 0;
                let before = self.gaps.iter().take_while(|gap| {
                    // true if the gap ends within the skipped samples
                    let inside = gap.at as u64 + missing + gap.missing <= samples;
                    missing += if inside { gap.missing } else { 0 };
                    inside
                });
                self.gaps.drain(..before.count());
                let skipped = codes.len().min((samples - missing) as usize);
                // if the cut is inside a gap, the codes behind the gap stay
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
