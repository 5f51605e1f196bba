//! Builds a calibration from a measurement in a chamber.

use super::{CalibratedAxis, Calibration, CurveRecord, Origin, Run, noise_record, one_line, said};
use crate::chamber::{ChamberOutcome, Record};
use crate::correction::Validity;
use crate::health::Tally;
use crate::notice::Warning;
use crate::part::{NamedAxis, Part};
use crate::plan::Plan;
use crate::procedure::Noise;
use alloc::string::ToString;

/// Facts about a chamber run that its `Record` does not hold.
#[derive(Clone, Debug)]
pub struct ChamberRun<'a> {
    /// Sample counts of this run, which give its data rates.
    pub tally: &'a Tally,
    /// Largest allowed share of lost samples, 0 … 1.
    pub max_lost: f64,
    /// Component of the Earth's rotation that was subtracted, °/s. `None` if it is part of PBC.
    pub earth_dps: Option<f64>,
    /// Warnings that concern all axes.
    pub warnings: &'a [Warning],
}

impl Calibration {
    /// Builds the calibration of a part from its record and one outcome for each axis, in the order of the axes.
    #[must_use]
    pub fn of_chamber(
        part: &Part,
        record: &Record,
        outcomes: &[ChamberOutcome],
        run: &ChamberRun<'_>,
        origin: Origin,
    ) -> Self {
        let is_only = outcomes.len() == 1;
        let axes = part.axes.iter().zip(outcomes);
        let of_only = axes.filter(|_| is_only).flat_map(|(axis, outcome)| outcome.warnings(&axis.axis));
        let warnings = run.warnings.iter().copied().chain(of_only).map(|warning| said(&warning)).collect();
        Self {
            part: part.name.to_string(),
            serial: origin.serial.as_deref().map(one_line),
            created: origin.created.as_deref().map(one_line),
            method: Some("chamber".to_string()),
            software: Some(one_line(&origin.software)),
            device: Some(one_line(&origin.device)),
            config: Some(one_line(&origin.config)),
            capture_sha256: Some(origin.capture_sha256).filter(|hash| !hash.is_empty()),
            notes: origin.notes.one_line(),
            warnings,
            temp: part.axes.first().map(|first| first.axis.temp),
            axes: part.axes.iter().zip(outcomes).map(|(axis, outcome)| calibrated(axis, outcome, is_only)).collect(),
            validity: validity(part, record),
            run: Some(of_run(record, run)),
        }
    }
}

/// Builds one axis. If it is the only axis, its list of warnings is empty, because the calibration carries them.
fn calibrated(axis: &NamedAxis, outcome: &ChamberOutcome, is_only: bool) -> CalibratedAxis {
    CalibratedAxis {
        name: axis.name.to_string(),
        warnings: outcome.warnings(&axis.axis).filter(|_| !is_only).map(|warning| said(&warning)).collect(),
        rate: Some(axis.axis.rate),
        correction: outcome.curve.correction,
        measured: None,
        uncertainty: None,
        curve: Some(CurveRecord::from(&outcome.curve)),
        noise: Some(noise_record(axis, &Noise::of_curve(&outcome.curve))),
    }
}

fn validity(part: &Part, record: &Record) -> Option<Validity> {
    let (temp_min_c, temp_max_c) = record.span_c()?;
    Some(Validity { temp_min_c, temp_max_c, margin_c: part.axes.first()?.axis.temp_margin_c() })
}

/// Facts about the run. The times of the steps of F-51 are 0, because a chamber run does not have these steps.
fn of_run(record: &Record, run: &ChamberRun<'_>) -> Run {
    let &ChamberRun { tally, max_lost, earth_dps, .. } = run;
    let ends = record.start_s.first().zip(record.start_s.last());
    Run {
        duration_s: ends.map_or(0.0, |(first_s, last_s)| last_s - first_s + 1.0),
        rate_hz: tally.rate_hz(),
        rdy_hz: tally.rdy_hz(),
        samples: record.samples,
        lost_samples: record.lost,
        max_lost,
        max_u_btc_dps_per_c: Plan::default().max_u_btc_dps_per_c,
        earth_dps,
        ..Run::default()
    }
}
