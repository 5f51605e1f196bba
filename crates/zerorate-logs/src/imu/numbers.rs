//! From fitted models to the numbers that filters take.

use super::{Doubts, Kind};
use crate::{Names, Setting};
use zerorate_allan::{Coefficient, FLOOR_PER_B, Fit, Term};

/// The rule that makes one value of several axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Combine {
    /// The largest.
    Worst,
    /// Their mean.
    Mean,
}

/// An axis with its noise model.
pub struct Axis<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its kind.
    pub kind: Kind,
    /// Samples per second.
    pub rate_hz: f64,
    /// The model.
    pub fit: &'a Fit,
    /// The unit of the model in the unit of results, °/s or m/s².
    pub scale: f64,
}

/// The source of the numbers, and the rules by which they are chosen.
pub struct Choice {
    /// The log that was read.
    pub log: String,
    /// The topic of a bag.
    pub topic: Option<String>,
    /// The rule that makes one value of all axes of a kind.
    pub combine: Combine,
    /// Factor on all noise, 1 unless it was asked for.
    pub inflate: f64,
    /// The names of the options in the file.
    pub names: Names,
}

/// The numbers of the file, in rad/s and m/s².
pub struct Numbers {
    /// The source of the numbers.
    pub choice: Choice,
    /// The doubts that were overruled.
    pub doubts: Vec<String>,
    /// Samples per second.
    pub rate_hz: f64,
    /// None where there is no such axis.
    pub gyroscope: Option<Sensor>,
    /// None where there is no such axis.
    pub accelerometer: Option<Sensor>,
    /// The bias as a Gauss–Markov process.
    pub memory: Memory,
}

/// The axes of one kind.
pub struct Sensor {
    /// N of all axes together.
    pub n: Chosen,
    /// K of all axes together.
    pub k: Chosen,
    /// Each by itself.
    pub axes: Vec<AxisNumbers>,
}

/// A number, and which it is.
#[derive(Clone)]
pub struct Chosen {
    /// The number.
    pub value: f64,
    /// The axis or axes that it comes from.
    pub from: String,
}

impl Chosen {
    /// Multiplies the number by a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { value: self.value * factor, from: self.from.clone() }
    }
}

/// One axis.
pub struct AxisNumbers {
    /// White noise.
    pub n: Chosen,
    /// Random walk.
    pub k: Chosen,
    /// Standard deviation of the Gauss–Markov process that stands for the wander of its bias.
    pub sigma: f64,
}

/// One correlation time for all.
pub struct Memory {
    /// The time.
    pub tau_s: f64,
    /// The axis or axes that it and the σ come from.
    pub from: String,
}

impl Sensor {
    /// A number of each.
    pub fn by_axis(&self, of: impl Fn(&AxisNumbers) -> f64) -> Vec<f64> {
        self.axes.iter().map(of).collect()
    }
}

impl Axis<'_> {
    /// rad/s or m/s² in a unit of the model.
    fn si(&self) -> f64 {
        match self.kind {
            Kind::Gyroscope => self.scale.to_radians(),
            Kind::Accelerometer => self.scale,
        }
    }

    fn n(&self) -> Chosen {
        self.chosen("N", &self.fit.n)
    }

    fn k(&self) -> Chosen {
        self.chosen("K", &self.fit.k)
    }

    /// A coefficient, or its upper limit where it is not identified: too small a number makes a filter trust its
    /// state too much, too large a number only makes the filter learn more slowly.
    fn chosen(&self, letter: &str, coefficient: &Coefficient) -> Chosen {
        let axis = self.name;
        let (value, from) = match coefficient.identified {
            true => (coefficient.value, format!("{letter} of {axis}")),
            false => (coefficient.hi, format!("upper 95 % limit of {letter} of {axis}, which is not identified")),
        };
        Chosen { value: value * self.si(), from }
    }

    /// Standard deviation and correlation time of its largest Gauss–Markov term.
    fn memory(&self) -> Option<(f64, f64)> {
        let of_term = |term: &Term| match term {
            Term::GaussMarkov { sigma, tau_s } => Some((sigma.value * self.si(), tau_s.value)),
            _ => None,
        };
        self.fit.terms.iter().filter_map(of_term).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// σ of a process whose Allan deviation has its peak where and as high as the model's without N.
    fn sigma_at(&self, tau_s: f64) -> f64 {
        let peak_s = PEAK_AT * tau_s;
        let m = (peak_s * self.rate_hz).round().max(1.0);
        let all = self.fit.deviation(m as u64);
        let without_n = all * all - self.fit.n.value * self.fit.n.value / peak_s;
        let (b, k) = (FLOOR_PER_B * self.fit.b.hi, self.fit.k.hi);
        let most = b * b + k * k * peak_s / 3.0;
        let variance = if without_n > 0.0 { without_n } else { most };
        variance.sqrt() / PEAK * self.si()
    }
}

/// The averaging time at which the Allan deviation of a Gauss–Markov process peaks, in correlation times.
const PEAK_AT: f64 = 1.89;
/// The Allan deviation at that peak, in standard deviations.
const PEAK: f64 = 0.617;

impl Numbers {
    /// Makes the numbers of these axes.
    pub fn new(choice: Choice, doubts: &Doubts, axes: &[Axis<'_>]) -> Self {
        let memory = Memory::of(axes);
        let sensor = |kind| Sensor::new(&choice, axes.iter().filter(|axis| axis.kind == kind), memory.tau_s);
        let (gyroscope, accelerometer) = (sensor(Kind::Gyroscope), sensor(Kind::Accelerometer));
        let rate_hz = axes.iter().map(|axis| axis.rate_hz).fold(0.0, f64::max);
        Self { choice, doubts: doubts.texts(), rate_hz, gyroscope, accelerometer, memory }
    }
}

impl Memory {
    /// The correlation time of the Gauss–Markov terms, their geometric mean. Without one, of a process whose Allan
    /// deviation peaks at the longest averaging time that all models speak of.
    fn of(axes: &[Axis<'_>]) -> Self {
        let times: Vec<f64> = axes.iter().filter_map(|axis| Some(axis.memory()?.1)).collect();
        if !times.is_empty() {
            let mean = times.iter().map(|time| time.ln()).sum::<f64>() / times.len() as f64;
            let from = "of the Gauss–Markov term of the axis, or else of a process that peaks as high as its model \
                        does without N"
                .to_owned();
            return Self { tau_s: mean.exp(), from };
        }
        let longest = axes.iter().map(|axis| axis.fit.span_s.1).fold(f64::INFINITY, f64::min);
        let from = format!(
            "no Gauss–Markov term was found: of a process whose Allan deviation peaks at {longest:.0} s, the longest \
             that the models speak of, as high as they are without N"
        );
        Self { tau_s: longest / PEAK_AT, from }
    }
}

impl Sensor {
    fn new<'a>(choice: &Choice, axes: impl Iterator<Item = &'a Axis<'a>>, tau_s: f64) -> Option<Self> {
        let inflate = choice.inflate;
        let of = |axis: &Axis<'_>| AxisNumbers {
            n: axis.n().times(inflate),
            k: axis.k().times(inflate),
            sigma: inflate * axis.memory().map_or_else(|| axis.sigma_at(tau_s), |(sigma, _)| sigma),
        };
        let axes: Vec<AxisNumbers> = axes.map(of).collect();
        let n = choice.combine.choose(axes.iter().map(|axis| &axis.n))?;
        let k = choice.combine.choose(axes.iter().map(|axis| &axis.k))?;
        Some(Self { n, k, axes })
    }
}

impl Combine {
    /// One of several.
    fn choose<'a>(self, all: impl Iterator<Item = &'a Chosen>) -> Option<Chosen> {
        let all: Vec<&Chosen> = all.collect();
        match self {
            Self::Worst => all.into_iter().max_by(|a, b| a.value.total_cmp(&b.value)).cloned(),
            Self::Mean => {
                let from: Vec<&str> = all.iter().map(|one| one.from.as_str()).collect();
                let from =
                    if let [only] = from[..] { only.to_owned() } else { format!("mean of {}", from.join(", ")) };
                let mean = all.iter().map(|one| one.value).sum::<f64>() / all.len() as f64;
                (!all.is_empty()).then_some(Chosen { value: mean, from })
            }
        }
    }

    /// The description of the rule, for the file.
    #[must_use]
    pub fn words(self, names: Names) -> String {
        let taken = self.name();
        format!("the {taken} was taken ({} {taken})", names.of(Setting::Combine))
    }

    /// Its name as an option.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Worst => "worst",
            Self::Mean => "mean",
        }
    }
}
