//! Step size and span of an exported table.

use super::InvalidOptions;
use super::warning::ExportWarning;
use anyhow::Result;
use zerorate::{Calibration, Correction, TableRow, Validity};

/// The step sizes that can be chosen automatically, millionths of a °C. The finest is that of F-52.
const STEPS_UC: [u32; 8] = [20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000, 2_000_000, 5_000_000];

/// Largest number of steps on each side of T3 in a table of default size: 1025 rows, 4.1 kB of flash.
const MOST_STEPS: u32 = 512;

/// Half of the temperature range that is assumed if a calibration states none, °C. The sensor warms by 8 ± 1 °C
/// (M-03), and T3 is the temperature at the end of the warm-up.
const ASSUMED_C: f64 = 9.0;

/// Step size and span of a table, and the temperature range that the table should cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) step_c: f64,
    /// The distance from T3 to either end of the table, °C.
    pub(super) span_c: f64,
    pub(super) valid: Validity,
    /// True if the calibration states the range; otherwise it is assumed.
    pub(super) stated: bool,
}

impl Layout {
    /// Uses the given step and span. A missing span is chosen so that the table of every axis covers the valid range.
    /// A missing step is at least one temperature code, but at most 5 °C.
    pub(super) fn new(calibration: &Calibration, step_c: Option<f64>, span_c: Option<f64>) -> Self {
        let valid = valid_range(calibration);
        let reach_c = calibration.axes.iter().map(|axis| reach(&valid, axis.correction.t3_c)).fold(0.0, f64::max);
        let code_c = calibration.temp.map_or(0.0, |temp| 1.0 / temp.lsb_per_unit);
        let (step_c, span_c) = match (step_c, span_c) {
            (step_c, Some(span_c)) => (step_c.unwrap_or_else(|| finest(code_c)), span_c),
            (Some(step_c), None) => (step_c, covering(reach_c, step_c)),
            (None, None) => {
                let step_c = finest(code_c.max(reach_c / f64::from(MOST_STEPS)));
                (step_c, covering(reach_c, step_c))
            }
        };
        Self { step_c, span_c, valid, stated: calibration.validity.is_some() }
    }

    pub(super) fn rows(&self, correction: &Correction) -> Result<Vec<TableRow>> {
        Ok(correction.table(self.step_c, self.span_c).map_err(|error| InvalidOptions(error.to_string()))?)
    }

    /// Warnings about an assumed range and about tables that are too short.
    pub(super) fn warnings(&self, calibration: &Calibration) -> Vec<ExportWarning> {
        let Validity { temp_min_c, temp_max_c, .. } = self.valid;
        let unstated = ExportWarning::NoValidity { temp_min_c, temp_max_c, assumed_c: ASSUMED_C };
        let is_one_of_several = calibration.axes.len() > 1;
        let short = calibration.axes.iter().filter_map(|axis| {
            let wrong_dps = self.wrong_dps(&axis.correction)?;
            let axis = is_one_of_several.then(|| axis.name.clone());
            Some(ExportWarning::TableShort { axis, span_c: self.span_c, temp_min_c, temp_max_c, wrong_dps })
        });
        (!self.stated).then_some(unstated).into_iter().chain(short).collect()
    }

    /// The largest error, °/s, if the calibrated range extends beyond the table; `None` if the table is long enough.
    fn wrong_dps(&self, correction: &Correction) -> Option<f64> {
        let reach_c = reach(&self.valid, correction.t3_c);
        let beyond_c = reach_c - self.span_c - self.step_c / 2.0;
        (beyond_c > 0.0).then(|| beyond_c * correction.steepest_dps_per_c(reach_c))
    }
}

/// The finest step of at least this size, °C; the coarsest step if none is large enough.
fn finest(least_c: f64) -> f64 {
    uc(*STEPS_UC.iter().find(|step| uc(**step) >= least_c).unwrap_or(&STEPS_UC[STEPS_UC.len() - 1]))
}

/// The valid temperature range of the calibration, limited to what the temperature codes can express.
fn valid_range(calibration: &Calibration) -> Validity {
    let t3_c = calibration.axes.first().map_or(0.0, |axis| axis.correction.t3_c);
    let margin_c = Validity::MARGIN_C;
    let assumed = Validity { temp_min_c: t3_c - ASSUMED_C, temp_max_c: t3_c + ASSUMED_C, margin_c };
    let valid = calibration.validity.unwrap_or(assumed);
    let (low, high) = calibration.temp.map_or((f64::MIN, f64::MAX), |temp| {
        let (first, last) = temp.codes();
        (temp.value(first - temp.zero_code), temp.value(last - temp.zero_code))
    });
    Validity { temp_min_c: valid.temp_min_c.clamp(low, high), temp_max_c: valid.temp_max_c.clamp(low, high), ..valid }
}

/// The distance from T3 to the farthest valid temperature, margin included, °C.
fn reach(valid: &Validity, t3_c: f64) -> f64 {
    (t3_c - valid.temp_min_c).max(valid.temp_max_c - t3_c) + valid.margin_c
}

/// Rounds the distance `reach_c` up to a whole number of steps, °C. With an invalid step, which is refused later, the
/// distance is returned unchanged.
fn covering(reach_c: f64, step_c: f64) -> f64 {
    let span_c = (reach_c / step_c - 1e-9).ceil() * step_c;
    super::tidy(if span_c.is_finite() { span_c } else { reach_c })
}

fn uc(millionths: u32) -> f64 {
    f64::from(millionths) / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calibration(t3_c: f64, validity: Option<(f64, f64)>) -> Calibration {
        let text = format!(
            "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = 0\nbtc_dps_per_c = -0.04\nt3_c = {t3_c:?}\n"
        );
        let (mut calibration, _) = Calibration::parse(&text).unwrap();
        calibration.validity =
            validity.map(|(temp_min_c, temp_max_c)| Validity { temp_min_c, temp_max_c, margin_c: 0.5 });
        calibration
    }

    /// Every range is covered by at most 1025 rows, with the step of F-52 if 1025 rows of it suffice.
    #[test]
    fn the_default_covers_the_range_in_bounded_room() {
        for (t3_c, low, high) in
            [(32.4, 25.0, 32.5), (24.0, 23.9, 33.0), (25.0, -40.0, 85.0), (31.5, 31.5, 31.5), (31.5, 50.0, 60.0)]
        {
            let layout = Layout::new(&calibration(t3_c, Some((low, high))), None, None);
            let rows = layout.rows(&calibration(t3_c, None).axes[0].correction).unwrap();
            assert!(rows.len() <= 1025, "{layout:?}");
            assert!(t3_c + rows[0].delta_c >= high + 0.5 && t3_c - rows[0].delta_c <= low - 0.5, "{layout:?}");
            assert_eq!(layout.step_c == 0.02, layout.span_c <= 512.0 * 0.02, "{layout:?}");
            assert_eq!(layout.warnings(&calibration(t3_c, None)), []);
        }
    }

    #[test]
    fn hostile_ranges_lay_out_a_table_or_are_refused() {
        for (low, high) in [(f64::NEG_INFINITY, f64::INFINITY), (-1e300, 1e300), (1e9, 1e9)] {
            let layout = Layout::new(&calibration(31.5, Some((low, high))), None, None);
            assert!(layout.rows(&calibration(31.5, None).axes[0].correction).unwrap().len() <= 1025, "{layout:?}");
        }
        for step_c in [0.0, -1.0, f64::NAN, 1e-300, f64::INFINITY] {
            let layout = Layout::new(&calibration(31.5, Some((25.0, 33.0))), Some(step_c), None);
            assert!(layout.rows(&calibration(31.5, None).axes[0].correction).is_err(), "{layout:?}");
        }
    }

    #[test]
    fn assumptions_and_omissions_are_reported() {
        let by_hand = calibration(31.5, None);
        let layout = Layout::new(&by_hand, None, None);
        assert_eq!((layout.step_c, layout.span_c, layout.stated), (0.02, 9.5, false));
        assert!(layout.warnings(&by_hand)[0].to_string().contains("22.5 … 40.5 °C"));
        let measured = calibration(32.5, Some((25.0, 32.5)));
        let layout = Layout::new(&measured, None, Some(0.12));
        assert_eq!(layout.step_c, 0.02);
        // the range reaches 8 °C from T3, and the table 0.13 °C: its span and half a step
        assert!(layout.warnings(&measured)[0].to_string().contains("wrong by up to 0.31 °/s"));
    }
}
