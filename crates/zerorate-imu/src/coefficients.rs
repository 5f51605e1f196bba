//! Noise coefficients in the units of data sheets, standards and users.

use zerorate_allan::{Coefficient, Estimate, FLOOR_PER_B, Fit, LONGEST_RECORD_S, span};
use zerorate_logs::{Quantity, STANDARD_GRAVITY};

/// A coefficient with its name and units.
pub struct Named<'a> {
    /// The letter of the coefficient in IEEE Std 952-1997.
    pub letter: char,
    /// The name of the coefficient in words.
    pub name: &'static str,
    /// Slope of the coefficient's line in the log-log plot of the Allan deviation.
    pub slope: f64,
    /// Allan deviation at an averaging time of 1 s, per unit of the coefficient.
    pub at_1s: f64,
    /// The value and its interval, in the unit of the fit.
    pub coefficient: &'a Coefficient,
    /// Units, the main one first, each with the factor from the unit of the fit.
    pub units: Vec<(String, f64)>,
}

/// Units of a coefficient for fits in °/s and in m/s², and the suffix that follows any other unit.
pub struct Units {
    rate: &'static [(&'static str, f64)],
    acceleration: &'static [(&'static str, f64)],
    other: &'static str,
}

const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// µg in 1 m/s².
const MICRO_G: f64 = 1e6 / STANDARD_GRAVITY;

/// Units of the angle or velocity random walk N: 1 °/√s = 60 °/√h. The one-sided density of the white noise is √2·N.
const N: Units = Units {
    rate: &[("°/√h", 60.0), ("°/√s", 1.0), ("°/s/√Hz, one-sided", SQRT_2)],
    acceleration: &[("m/s/√h", 60.0), ("m/s/√s", 1.0), ("µg/√Hz, one-sided", SQRT_2 * MICRO_G)],
    other: "·√s",
};
/// Units of the bias instability B, and of every other value in the unit of the rate.
pub const B: Units =
    Units { rate: &[("°/h", 3600.0), ("°/s", 1.0)], acceleration: &[("µg", MICRO_G), ("m/s²", 1.0)], other: "" };
const K: Units = Units {
    rate: &[("°/h/√h", 216_000.0), ("°/s/√s", 1.0)],
    acceleration: &[("µg/√h", 60.0 * MICRO_G), ("m/s²/√s", 1.0)],
    other: "/√s",
};
const Q: Units = Units { rate: &[("°", 1.0), ("″", 3600.0)], acceleration: &[("m/s", 1.0)], other: "·s" };
const R: Units = Units {
    rate: &[("°/h/h", 12_960_000.0), ("°/s/s", 1.0)],
    acceleration: &[("µg/h", 3600.0 * MICRO_G), ("m/s²/s", 1.0)],
    other: "/s",
};

impl Units {
    /// The units for a quantity, the usual one first, each with the factor from the unit of the fit.
    #[must_use]
    pub fn of(&self, quantity: Option<Quantity>) -> Vec<(String, f64)> {
        let known = match quantity {
            Some(Quantity::AngularRate) => self.rate,
            Some(Quantity::Acceleration) => self.acceleration,
            Some(Quantity::Temperature) => return vec![(format!("°C{}", self.other), 1.0)],
            None => return vec![(format!("unit{}", self.other), 1.0)],
        };
        known.iter().map(|(unit, factor)| ((*unit).to_owned(), *factor)).collect()
    }
}

/// The coefficients of a model of this quantity: N, B and K, then Q and R if the model has them.
#[must_use]
pub fn coefficients(fit: &Fit, quantity: Option<Quantity>) -> Vec<Named<'_>> {
    let named = |letter, name, slope, at_1s, coefficient, units: &Units| Named {
        letter,
        name,
        slope,
        at_1s,
        coefficient,
        units: units.of(quantity),
    };
    let names = match quantity {
        Some(Quantity::Acceleration) => ("velocity random walk", "acceleration random walk"),
        _ => ("angle random walk", "rate random walk"),
    };
    let always = [
        named('N', names.0, -0.5, 1.0, &fit.n, &N),
        named('B', "bias instability", 0.0, FLOOR_PER_B, &fit.b, &B),
        named('K', names.1, 0.5, 1.0 / 3f64.sqrt(), &fit.k, &K),
    ];
    let quantisation = fit.q.iter().map(|q| named('Q', "quantisation", -1.0, 3f64.sqrt(), q, &Q));
    let ramp = fit.r.iter().map(|r| named('R', "ramp", 1.0, 1.0 / SQRT_2, r, &R));
    always.into_iter().chain(quantisation).chain(ramp).collect()
}

impl Named<'_> {
    /// Value and limits in the unit at `index`.
    #[must_use]
    pub fn in_unit(&self, index: usize) -> Estimate {
        let factor = self.units[index].1;
        let Coefficient { value, lo, hi, .. } = self.coefficient;
        Estimate { value: value * factor, lo: lo * factor, hi: hi * factor }
    }

    /// The reason why the coefficient is not identified, in words; empty if it is identified.
    #[must_use]
    pub fn remark(&self) -> String {
        match (self.coefficient.identified, self.coefficient.needed_s) {
            (true, _) => String::new(),
            (false, Some(needed_s)) if needed_s > LONGEST_RECORD_S => {
                "not identified: no record of practical length would tell".to_owned()
            }
            (false, Some(needed_s)) => format!("not identified: a value of this order takes about {}", span(needed_s)),
            (false, None) => "not identified".to_owned(),
        }
    }
}
