//! How far an exported table reaches, and in which steps.

use crate::exit::Usage;
use anyhow::Result;
use zerorate::{Calibration, Correction, TableRow, Validity};

/// The steps to choose from, millionths of a °C: that of F-52 and coarser ones.
const STEPS_UC: [u32; 8] = [20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000, 2_000_000, 5_000_000];

/// Most steps on each side of T3 of a table whose size nobody asked for: 1025 rows, 4.1 kB of flash.
const MOST_STEPS: u32 = 512;

/// Half the range that a calibration without one is taken to hold in, °C: the warm-up at whose end T3 lies, 8 ± 1 °C
/// (M-03).
const ASSUMED_C: f64 = 9.0;

/// The temperatures that 24-bit codes can express, °C (F-41).
const SENSOR_C: (f64, f64) = (-570.0, 620.0);

/// Step and reach of a table, and the range that it is to cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    pub step_c: f64,
    /// From T3 to both sides.
    pub span_c: f64,
    pub valid: Validity,
    /// Whether the calibration states that range.
    pub stated: bool,
}

impl Layout {
    /// As asked for; what is not asked for, so that the table covers the range of the calibration.
    pub fn new(calibration: &Calibration, step_c: Option<f64>, span_c: Option<f64>) -> Self {
        let t3_c = calibration.axes[0].correction.t3_c;
        let valid = valid_range(calibration);
        let reach_c = reach(&valid, t3_c);
        let (step_c, span_c) = match (step_c, span_c) {
            (step_c, Some(span_c)) => (step_c.unwrap_or(uc(STEPS_UC[0])), span_c),
            (Some(step_c), None) => (step_c, covering(reach_c, step_c)),
            (None, None) => {
                let fits = |step: &&u32| reach_c <= uc(**step) * f64::from(MOST_STEPS);
                let step_c = uc(*STEPS_UC.iter().find(fits).unwrap_or(&STEPS_UC[STEPS_UC.len() - 1]));
                (step_c, covering(reach_c, step_c))
            }
        };
        Self { step_c, span_c, valid, stated: calibration.validity.is_some() }
    }

    /// The table.
    pub fn rows(&self, correction: &Correction) -> Result<Vec<TableRow>> {
        Ok(correction.table(self.step_c, self.span_c).map_err(|error| Usage(error.to_string()))?)
    }

    /// What to say of it.
    pub fn warnings(&self, correction: &Correction) -> Vec<String> {
        let Self { step_c, span_c, valid, stated } = *self;
        let Validity { temp_min_c, temp_max_c, .. } = valid;
        let mut warnings = Vec::new();
        if !stated {
            warnings.push(format!(
                "the calibration states no [validity], so nothing says where it holds: the export takes \
                 {temp_min_c:.1} … {temp_max_c:.1} °C, T3 ± {ASSUMED_C} °C, as valid; state temp_min_c and temp_max_c \
                 in the file"
            ));
        }
        let beyond_c = reach(&valid, correction.t3_c) - span_c - step_c / 2.0;
        if beyond_c > 0.0 {
            warnings.push(format!(
                "the table ends {span_c} °C from T3, the calibration holds for {temp_min_c:.1} … {temp_max_c:.1} °C: \
                 beyond the table the row at its end is wrong by up to {:.2} °/s, and the look-up says that it is \
                 outside; leave --span-c out to cover the range",
                beyond_c * correction.btc_dps_per_c.abs()
            ));
        }
        warnings
    }
}

fn valid_range(calibration: &Calibration) -> Validity {
    let t3_c = calibration.axes[0].correction.t3_c;
    let margin_c = Validity::MARGIN_C;
    let assumed = Validity { temp_min_c: t3_c - ASSUMED_C, temp_max_c: t3_c + ASSUMED_C, margin_c };
    let valid = calibration.validity.unwrap_or(assumed);
    let (low, high) = SENSOR_C;
    Validity { temp_min_c: valid.temp_min_c.clamp(low, high), temp_max_c: valid.temp_max_c.clamp(low, high), ..valid }
}

/// From T3 to the farthest temperature at which the correction holds, °C.
fn reach(valid: &Validity, t3_c: f64) -> f64 {
    (t3_c - valid.temp_min_c).max(valid.temp_max_c - t3_c) + Validity::MARGIN_C
}

/// Whole steps that reach so far; what is no step comes back unchanged, to be refused.
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

    /// Every range is covered by at most 1025 rows, in the step of F-52 where that is enough.
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
            assert_eq!(layout.warnings(&calibration(t3_c, None).axes[0].correction), [""; 0]);
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
    fn what_is_assumed_or_left_out_is_said() {
        let by_hand = calibration(31.5, None);
        let layout = Layout::new(&by_hand, None, None);
        assert_eq!((layout.step_c, layout.span_c, layout.stated), (0.02, 9.5, false));
        assert!(layout.warnings(&by_hand.axes[0].correction)[0].contains("22.5 … 40.5 °C"));
        let measured = calibration(32.5, Some((25.0, 32.5)));
        let layout = Layout::new(&measured, None, Some(0.12));
        assert_eq!(layout.step_c, 0.02);
        // 8 °C to the far end, 0.13 °C of them in the table
        assert!(layout.warnings(&measured.axes[0].correction)[0].contains("wrong by up to 0.31 °/s"));
    }
}
