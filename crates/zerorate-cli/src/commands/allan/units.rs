//! Noise coefficients in the units that data sheets, standards and users have them in.

use super::record::Record;
use zerorate::allan::Coefficient;
use zerorate::noise::FLOOR_PER_B;

/// A coefficient by name and units, its main unit first.
pub struct Named<'a> {
    /// Its letter in IEEE Std 952-1997.
    pub letter: char,
    /// Its name.
    pub name: &'static str,
    /// Slope of its line in the plot.
    pub slope: f64,
    /// Deviation at 1 s per unit of the coefficient.
    pub at_1s: f64,
    /// The values.
    pub coefficient: &'a Coefficient,
    /// Unit, and how many of it are one of the fit's.
    pub units: Vec<(String, f64)>,
}

/// Units of a coefficient, given as those of a fit in °/s and as those of a fit in no known unit.
struct Units {
    dps: &'static [(&'static str, f64)],
    unknown: &'static str,
}

const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// 1 °/√s = 60 °/√h; a one-sided density is √2 N. 1 °/s/√s = 3600 · 60 °/h/√h.
const N: Units =
    Units { dps: &[("°/√h", 60.0), ("°/√s", 1.0), ("°/s/√Hz, one-sided", SQRT_2)], unknown: "·√s" };
const B: Units = Units { dps: &[("°/h", 3600.0), ("°/s", 1.0)], unknown: "" };
const K: Units = Units { dps: &[("°/h/√h", 216_000.0), ("°/s/√s", 1.0)], unknown: "/√s" };
const Q: Units = Units { dps: &[("°", 1.0), ("″", 3600.0)], unknown: "·s" };
const R: Units = Units { dps: &[("°/h/h", 12_960_000.0), ("°/s/s", 1.0)], unknown: "/s" };

impl Units {
    fn of(&self, record: &Record) -> Vec<(String, f64)> {
        if record.unit_known {
            self.dps.iter().map(|(unit, factor)| ((*unit).to_owned(), *factor)).collect()
        } else {
            vec![(format!("unit{}", self.unknown), 1.0)]
        }
    }
}

/// The coefficients of a record, those that every fit has first.
pub fn coefficients(record: &Record) -> Vec<Named<'_>> {
    let Ok(fit) = &record.fit else { return Vec::new() };
    let named = |letter, name, slope, at_1s, coefficient, units: &Units| Named {
        letter,
        name,
        slope,
        at_1s,
        coefficient,
        units: units.of(record),
    };
    let always = [
        named('N', "angle random walk", -0.5, 1.0, &fit.n, &N),
        named('B', "bias instability", 0.0, FLOOR_PER_B, &fit.b, &B),
        named('K', "rate random walk", 0.5, 1.0 / 3f64.sqrt(), &fit.k, &K),
    ];
    let quantisation = fit.q.iter().map(|q| named('Q', "quantisation", -1.0, 3f64.sqrt(), q, &Q));
    let ramp = fit.r.iter().map(|r| named('R', "rate ramp", 1.0, 1.0 / SQRT_2, r, &R));
    always.into_iter().chain(quantisation).chain(ramp).collect()
}

impl Named<'_> {
    /// Value and limits in the unit at `index`.
    pub fn in_unit(&self, index: usize) -> (f64, f64, f64) {
        let factor = self.units[index].1;
        let Coefficient { value, lo, hi, .. } = self.coefficient;
        (value * factor, lo * factor, hi * factor)
    }

    /// What is to be said of a coefficient that is not identified.
    pub fn remark(&self) -> String {
        match (self.coefficient.identified, self.coefficient.needed_s) {
            (true, _) => String::new(),
            (false, Some(needed_s)) => format!("not identified: record about {}", span(needed_s)),
            (false, None) => "not identified".to_owned(),
        }
    }
}

/// What the limits of a deviation are: `68.3 % intervals`.
pub fn interval(confidence: f64) -> String {
    format!("{} % intervals", (confidence * 1e6).round() / 1e4)
}

/// A time as one says it: `40 min`, `3.5 h`, `12 d`.
pub fn span(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.0} d", s / 86_400.0),
    }
}

/// The unit of the deviations of a record, for people; none if nobody stated it.
pub fn deviation_unit(record: &Record) -> Option<&'static str> {
    record.unit_known.then_some(if record.analysis.stat.is_times_s() { "°" } else { "°/s" })
}

/// The noise with the exponent α of the rate's density, as gyroscope people call it.
pub fn noise(alpha: i32) -> &'static str {
    match alpha {
        2 => "white angle",
        1 => "flicker angle",
        0 => "angle random walk",
        -1 => "bias instability",
        -2 => "rate random walk",
        _ => "ramp or drift",
    }
}
