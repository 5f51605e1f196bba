//! Checks part and connection with the first seconds of samples, as `zerorate probe` does.

use super::axis::AxisState;
use crate::message::CheckResult;
use zerorate::health::Judged;
use zerorate::{Checkup, Tally};
use zerorate_record::{CaptureWarning, valid};

const DURATION_S: f64 = 5.0;

/// The check of the first `DURATION_S` seconds of samples.
#[derive(Debug)]
pub struct Examination {
    checkups: Vec<Checkup>,
    nominal_hz: Option<f64>,
}

impl Examination {
    pub fn new(axes: usize, nominal_hz: Option<f64>) -> Self {
        Self { checkups: vec![Checkup::default(); axes], nominal_hz }
    }

    #[inline]
    pub fn push(&mut self, axis: usize, judged: &Judged) {
        self.checkups[axis].push(judged);
    }

    /// The results, once `DURATION_S` is reached; `None` before.
    pub fn ended(&self, axes: &[AxisState], tally: &Tally, start_ns: u64) -> Option<Vec<CheckResult>> {
        if tally.duration_s() < DURATION_S {
            return None;
        }
        let of_axes = axes.iter().zip(&self.checkups);
        let noise = of_axes.filter_map(|(axis, checkup)| noise(axis, checkup, axes.len() > 1, tally));
        Some([self.samples(axes, tally, start_ns)].into_iter().chain(noise).collect())
    }

    fn samples(&self, axes: &[AxisState], tally: &Tally, start_ns: u64) -> CheckResult {
        let first = self.checkups.first();
        let of_the_part = first.map(|first| first.warnings(tally, self.nominal_hz));
        let coded = of_the_part.iter().flatten().map(|warning| format!("{}: {warning}", warning.code()));
        let healths = axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
        let wrong: Vec<String> =
            coded.chain(valid::of_axes(healths, tally, start_ns).iter().map(CaptureWarning::coded)).collect();
        let counted =
            format!("{:.1} a second, {} lost; data ready {:.1} Hz", tally.rate_hz(), tally.lost, tally.rdy_hz());
        let ok = wrong.is_empty();
        CheckResult { what: "samples".to_owned(), ok, text: [vec![counted], wrong].concat().join("; ") }
    }
}

/// The result about the noise of an axis; `None` if its readings are frozen or too few.
fn noise(axis: &AxisState, checkup: &Checkup, several: bool, tally: &Tally) -> Option<CheckResult> {
    if axis.health.frozen().is_some() {
        return None;
    }
    let white = checkup.white_dps_per_rt_hz(&axis.axis, tally.rate_hz())?;
    let typical = axis.axis.noise.map(|noise| noise.white_dps_per_rt_hz);
    let typical = typical.map_or(String::new(), |typical| format!(" (typical {typical})"));
    let measured = format!("{white:.4} °/s/√Hz{typical}");
    let warning = Checkup::noise_warning(&axis.axis, white);
    let text = warning.map_or(measured.clone(), |warning| format!("{measured}; {}: {warning}", warning.code()));
    let what = if several { format!("noise of {}", axis.name) } else { "noise".to_owned() };
    Some(CheckResult { what, ok: warning.is_none(), text })
}
