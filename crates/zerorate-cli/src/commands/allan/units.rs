//! Noise coefficients in the units that data sheets, standards and users have them in.

use super::record::Record;
use zerorate::allan::{Coefficient, Estimate, LONGEST_RECORD_S, Line, Term};
use zerorate::noise::FLOOR_PER_B;
use zerorate_data::column::{Quantity, STANDARD_GRAVITY};
use zerorate_view::plot::number;

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

/// Units of a coefficient, given as those of fits in °/s and in m/s², and as what follows any other unit.
pub struct Units {
    rate: &'static [(&'static str, f64)],
    acceleration: &'static [(&'static str, f64)],
    other: &'static str,
}

const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// µg in 1 m/s².
const MICRO_G: f64 = 1e6 / STANDARD_GRAVITY;

/// 1 °/√s = 60 °/√h; a one-sided density is √2 N. 1 °/s/√s = 3600 · 60 °/h/√h.
const N: Units = Units {
    rate: &[("°/√h", 60.0), ("°/√s", 1.0), ("°/s/√Hz, one-sided", SQRT_2)],
    acceleration: &[("m/s/√h", 60.0), ("m/s/√s", 1.0), ("µg/√Hz, one-sided", SQRT_2 * MICRO_G)],
    other: "·√s",
};
pub const B: Units = Units {
    rate: &[("°/h", 3600.0), ("°/s", 1.0)],
    acceleration: &[("µg", MICRO_G), ("mg", MICRO_G / 1e3), ("m/s²", 1.0)],
    other: "",
};
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
    pub fn of(&self, record: &Record) -> Vec<(String, f64)> {
        let known = match record.quantity {
            Some(Quantity::AngularRate) => self.rate,
            Some(Quantity::Acceleration) => self.acceleration,
            Some(Quantity::Temperature) => return vec![(format!("°C{}", self.other), 1.0)],
            None => return vec![(format!("unit{}", self.other), 1.0)],
        };
        known.iter().map(|(unit, factor)| ((*unit).to_owned(), *factor)).collect()
    }
}

/// The coefficients of a record, those that every fit has first.
pub fn coefficients(record: &Record) -> Vec<Named<'_>> {
    let Some(fit) = record.model() else { return Vec::new() };
    let named = |letter, name, slope, at_1s, coefficient, units: &Units| Named {
        letter,
        name,
        slope,
        at_1s,
        coefficient,
        units: units.of(record),
    };
    let names = match record.quantity {
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

/// What a table says of a coefficient or another term: in each unit value, limits and the unit.
pub struct Row {
    pub name: String,
    pub values: Vec<(Estimate, String)>,
    pub remark: String,
}

/// All that the model of a record has, the coefficients first.
pub fn rows(record: &Record) -> Vec<Row> {
    let Some(fit) = record.model() else { return Vec::new() };
    let coefficient = |named: Named<'_>| Row {
        name: format!("{}  {}", named.letter, named.name),
        values: (0..named.units.len()).map(|index| (named.in_unit(index), named.units[index].0.clone())).collect(),
        remark: if fit.is_rejected { "model rejected".to_owned() } else { named.remark() },
    };
    coefficients(record)
        .into_iter()
        .map(coefficient)
        .chain(fit.terms.iter().map(|term| of_term(record, term)))
        .collect()
}

fn of_term(record: &Record, term: &Term) -> Row {
    let rate = B.of(record);
    let in_rate = |estimate: &Estimate| {
        let scaled = |(unit, factor): &(String, f64)| {
            let &Estimate { value, lo, hi } = estimate;
            (Estimate { value: value * factor, lo: lo * factor, hi: hi * factor }, unit.clone())
        };
        scaled(&rate[0])
    };
    let exact = |value: f64| Estimate { value, lo: value, hi: value };
    match term {
        Term::GaussMarkov { sigma, tau_s } => Row {
            name: "Gauss–Markov σ, T".to_owned(),
            values: vec![in_rate(sigma), (*tau_s, "s".to_owned())],
            remark: String::new(),
        },
        Term::BandShape { cosines, pole } => Row {
            name: "band shape".to_owned(),
            values: Vec::new(),
            remark: format!(
                "of order {}: the white noise has a filter behind it",
                cosines.len() + usize::from(pole.is_some())
            ),
        },
        Term::Line(Line { frequency_hz, width_hz, rms }) => Row {
            name: "line, left out".to_owned(),
            values: vec![in_rate(&exact(*rms))],
            remark: format!("at {frequency_hz:.4} Hz, {width_hz:.4} Hz wide"),
        },
        Term::WarmUp { size, tau_s } => Row {
            name: "warm-up".to_owned(),
            values: vec![in_rate(size)],
            remark: format!("with a time constant of {}", span(*tau_s)),
        },
    }
}

/// The Gauss–Markov terms of a model, as one says them: `328 µg, 25.9 s`.
pub fn gauss_markov(record: &Record) -> Vec<String> {
    let (unit, factor) = &B.of(record)[0];
    let terms = record.model().map_or(&[][..], |fit| &fit.terms);
    let said = |term: &Term| match term {
        Term::GaussMarkov { sigma, tau_s } => {
            Some(format!("{} {unit}, {} s", number(sigma.value * factor), number(tau_s.value)))
        }
        _ => None,
    };
    terms.iter().filter_map(said).collect()
}

impl Named<'_> {
    /// Value and limits in the unit at `index`.
    pub fn in_unit(&self, index: usize) -> Estimate {
        let factor = self.units[index].1;
        let Coefficient { value, lo, hi, .. } = self.coefficient;
        Estimate { value: value * factor, lo: lo * factor, hi: hi * factor }
    }

    /// What is to be said of a coefficient that is not identified.
    pub fn remark(&self) -> String {
        match (self.coefficient.identified, self.coefficient.needed_s) {
            (true, _) => String::new(),
            (false, Some(needed_s)) if needed_s > LONGEST_RECORD_S => {
                "not identified: no record of practical length would tell".to_owned()
            }
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
    let quantity = record.quantity?;
    if !record.analysis.stat.is_times_s() {
        return Some(quantity.unit());
    }
    Some(match quantity {
        Quantity::AngularRate => "°",
        Quantity::Acceleration => "m/s",
        Quantity::Temperature => "°C·s",
    })
}

/// The noise with the exponent α of the density of what is measured, as people call it there.
pub fn noise(alpha: i32, quantity: Option<Quantity>) -> &'static str {
    match alpha {
        2 if quantity == Some(Quantity::Acceleration) => "white velocity",
        1 if quantity == Some(Quantity::Acceleration) => "flicker velocity",
        0 if quantity == Some(Quantity::Acceleration) => "velocity random walk",
        -2 if quantity == Some(Quantity::Acceleration) => "acceleration random walk",
        2 => "white angle",
        1 => "flicker angle",
        0 => "angle random walk",
        -1 => "bias instability",
        -2 => "rate random walk",
        _ => "ramp or drift",
    }
}
