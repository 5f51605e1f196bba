//! The noise figures of a data sheet, and their comparison with a record at rest.

mod file;
mod unit;

use crate::{Analysis, Coefficient, Estimate, Fit, interval};
use alloc::string::String;
use alloc::vec::Vec;
use core::f64::consts::SQRT_2;
pub use file::DataSheetError;

/// The lines of a data sheet about noise at rest (`docs/formats/datasheet.md`).
#[derive(Clone, Debug, PartialEq)]
pub struct DataSheet {
    /// Name of the sensor.
    pub name: String,
    /// The document that prints the lines.
    pub source: Option<String>,
    /// Noise figures of the gyroscopes; empty if the data sheet states none.
    pub gyroscope: Vec<Line>,
    /// Noise figures of the accelerometers; empty if the data sheet states none.
    pub accelerometer: Vec<Line>,
}

/// A noise figure as printed in a data sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The quantity that is stated.
    pub figure: Figure,
    /// Whether the value is a maximum instead of a typical value.
    pub is_maximum: bool,
    /// The value, in `unit`.
    pub value: f64,
    /// Half a unit of the last printed digit, at most half of `value`: the largest rounding error, in `unit`.
    pub half_digit: f64,
    /// The unit as written.
    pub unit: String,
    /// Size of `unit` in the corresponding unit of °, m and s: 1/60 for °/√h, which corresponds to °/√s.
    pub factor: f64,
    /// The document that prints the figure, if it is not [`DataSheet::source`].
    pub source: Option<String>,
}

/// A quantity that a data sheet states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// One-sided density of the white noise, √2·N.
    NoiseDensity,
    /// Angle or velocity random walk N.
    RandomWalk,
    /// The lowest point of the Allan deviation, which data sheets call bias (in)stability in run.
    CurveMinimum,
    /// The coefficient B of IEEE Std 952-1997: the flat floor divided by 0.664.
    BiasInstability,
    /// Rate or acceleration random walk K.
    RateRandomWalk,
}

/// The comparison of a measured value with a line of a data sheet, in the line's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Value and 95 % interval. `None` if the model is missing or rejected. The curve minimum needs no model, but a
    /// point with enough degrees of freedom.
    pub measured: Option<Estimate>,
    /// The verdict on the sensor. [`Verdict::Open`] if nothing was measured.
    pub verdict: Verdict,
}

/// The verdict on a sensor, compared with a line of its data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As stated: the interval holds the typical value within its rounding, or does not exceed the maximum.
    Within,
    /// Less noise than is typical.
    Better,
    /// More noise than stated.
    Worse,
    /// The record is too short or the model unusable for a verdict.
    Open,
}

/// Least degrees of freedom of a point that counts as the minimum of the curve.
const FEWEST_EDF: f64 = 4.0;

impl Line {
    /// Compares a record with the line. The analysis must be of Allan deviations.
    #[must_use]
    pub fn compare(&self, fit: Option<&Fit>, analysis: &Analysis) -> Comparison {
        let of = |coefficient: &Coefficient, by: f64| {
            let &Coefficient { value, lo, hi, identified, .. } = coefficient;
            Estimate { value: by * value, lo: if identified { by * lo } else { 0.0 }, hi: by * hi }
        };
        let fit = fit.filter(|fit| !fit.is_rejected);
        let measured = match self.figure {
            Figure::NoiseDensity => fit.map(|fit| of(&fit.n, SQRT_2)),
            Figure::RandomWalk => fit.map(|fit| of(&fit.n, 1.0)),
            Figure::CurveMinimum => minimum(analysis),
            Figure::BiasInstability => fit.map(|fit| of(&fit.b, 1.0)),
            Figure::RateRandomWalk => fit.map(|fit| of(&fit.k, 1.0)),
        };
        let measured = measured.map(|measured| measured.map(|value| value / self.factor));
        Comparison { measured, verdict: measured.map_or(Verdict::Open, |measured| self.verdict(&measured)) }
    }

    fn verdict(&self, measured: &Estimate) -> Verdict {
        // a maximum is taken as printed
        let rounding = if self.is_maximum { 0.0 } else { self.half_digit };
        let (below, above) = (self.value - rounding, self.value + rounding);
        match measured {
            // no verdict on a coefficient without a finite, positive upper limit
            Estimate { hi, .. } if !(*hi > 0.0 && hi.is_finite()) => Verdict::Open,
            Estimate { lo, .. } if *lo > above => Verdict::Worse,
            Estimate { hi, .. } if self.is_maximum && *hi <= above => Verdict::Within,
            _ if self.is_maximum => Verdict::Open,
            Estimate { hi, .. } if *hi < below => Verdict::Better,
            Estimate { lo, .. } if *lo > 0.0 => Verdict::Within,
            _ => Verdict::Open,
        }
    }
}

/// The lowest deviation with its 95 % interval. Unless the curve clearly rises again, only the upper limit is known,
/// and the lower one is 0.
fn minimum(analysis: &Analysis) -> Option<Estimate> {
    let points = || analysis.points.iter().filter(|point| point.edf >= FEWEST_EDF);
    let least = points().min_by(|a, b| a.dev.total_cmp(&b.dev))?;
    let (lo, hi) = interval(least.dev, least.edf, 0.95);
    let has_turned = points().next_back().is_some_and(|last| last.lo > least.dev);
    Some(Estimate { value: least.dev, lo: if has_turned { lo } else { 0.0 }, hi })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FitOptions, Input, Options, analyse, fit};

    /// White noise of N = 0.1 °/√s and nothing else.
    fn white() -> (Fit, Analysis) {
        let rate = crate::kernels::tests::white(1, 20_000);
        let input = Input::Rate(&rate);
        let fit = fit(&input, 100.0, &FitOptions::default()).unwrap();
        (fit, analyse(&input, 100.0, &Options::default()).unwrap())
    }

    fn sheet(line: &str) -> DataSheet {
        DataSheet::parse(&alloc::format!("schema = 1\nname = \"x\"\n[gyroscope]\n{line}\n")).unwrap()
    }

    #[test]
    fn a_sensor_is_as_stated_better_worse_or_not_told() {
        let (fit, analysis) = white();
        // 0.1 °/√s is 6 °/√h, and a one-sided density of 0.1414 °/s/√Hz
        for (line, verdict) in [
            ("angle_random_walk = { typical = 6.0, unit = \"°/√h\" }", Verdict::Within),
            ("angle_random_walk = { typical = 5, unit = \"°/√h\" }", Verdict::Worse),
            ("angle_random_walk = { typical = 7.0, unit = \"°/√h\" }", Verdict::Better),
            ("angle_random_walk = { maximum = 7.0, unit = \"°/√h\" }", Verdict::Within),
            ("angle_random_walk = { maximum = 5.0, unit = \"deg/rt(hr)\" }", Verdict::Worse),
            ("noise_density = { typical = 0.141, unit = \"°/s/√Hz\" }", Verdict::Within),
            ("noise_density = { typical = 0.100, unit = \"°/s/√Hz\" }", Verdict::Worse),
            ("noise_density = { typical = 508, unit = \"deg/h/sqrt(Hz)\" }", Verdict::Within),
            // white noise has neither flicker nor a minimum, so a value below the record's upper limit stays open
            ("bias_instability = { typical = 0.1, unit = \"°/h\" }", Verdict::Open),
            ("bias_instability = { typical = 0.1, unit = \"°/h\", means = \"B\" }", Verdict::Open),
            ("bias_instability = { typical = 5, unit = \"°/s\" }", Verdict::Better),
            ("rate_random_walk = { maximum = 0.001, unit = \"°/s/√h\" }", Verdict::Open),
            ("rate_random_walk = { maximum = 100, unit = \"°/s/√s\" }", Verdict::Within),
        ] {
            let sheet = sheet(line);
            let compared = sheet.gyroscope[0].compare(Some(&fit), &analysis);
            assert_eq!(compared.verdict, verdict, "{line}: {compared:?}");
        }
        let line = &sheet("angle_random_walk = { typical = 6.0, unit = \"°/√h\" }").gyroscope[0];
        let rejected = Fit { is_rejected: true, ..fit };
        assert_eq!(line.compare(Some(&rejected), &analysis), Comparison { measured: None, verdict: Verdict::Open });
        assert_eq!((line.half_digit * 100.0).round(), 5.0, "6.0 is 5.95 to 6.05");
    }
}
