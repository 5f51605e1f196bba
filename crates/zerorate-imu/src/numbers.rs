//! Converts fitted models to the numbers that filters use.

use super::{Kind, Rejections};
use zerorate_allan::{Coefficient, Covering, FLOOR_PER_B, Fit, Term, Usage, hertz};
use zerorate_logs::{Names, Setting};

/// The rule that makes one value of several axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Combine {
    /// The largest value of the axes.
    Worst,
    /// The mean of the axes.
    Mean,
}

/// The rule that derives N and K from a noise model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// N and K cover the noise from 1 s to this horizon, s. For a batch estimate, only K is raised, and N is as in
    /// `AsFitted`. `None` takes a third of the record, but at most the limit for the use in the program that reads the
    /// noise file.
    Covers(Option<f64>),
    /// N and K come from the model, or are their upper limits if they are not identified.
    AsFitted,
}

/// An axis with its noise model.
pub struct Axis<'a> {
    /// The name of its column.
    pub name: &'a str,
    /// Gyroscope or accelerometer.
    pub kind: Kind,
    /// Samples per second.
    pub rate_hz: f64,
    /// The noise model of the column.
    pub fit: &'a Fit,
    /// Factor from the unit of the model to the unit of results, °/s or m/s².
    pub scale: f64,
}

/// The source of the numbers, and the rules by which they are chosen.
pub struct NoiseFileOptions {
    /// The log that was read.
    pub log: String,
    /// The topic, if the log is a bag.
    pub topic: Option<String>,
    /// The rule that makes one value of all axes of a kind.
    pub combine: Combine,
    /// The rule that derives N and K from a model.
    pub rule: Rule,
    /// Factor on all noise; 1 by default.
    pub inflate: f64,
    /// The names of the options, for the comments in the noise file.
    pub names: Names,
    /// The warnings that matter to the reader of the noise file, each `code: text`.
    pub warnings: Vec<String>,
}

impl Default for NoiseFileOptions {
    /// The worst axis of a kind, and numbers that cover the noise up to the default horizon.
    fn default() -> Self {
        Self {
            log: String::new(),
            topic: None,
            combine: Combine::Worst,
            rule: Rule::Covers(None),
            inflate: 1.0,
            names: Names::default(),
            warnings: Vec::new(),
        }
    }
}

impl NoiseFileOptions {
    /// The warnings that matter to the reader of a noise file: all but those with a code in `BESIDE`.
    pub fn mattering(warnings: impl IntoIterator<Item = String>) -> Vec<String> {
        // the name of an axis may stand before the code
        let matters = |line: &String| !line.split(": ").take(2).any(|word| BESIDE.contains(&word));
        warnings.into_iter().filter(matters).collect()
    }
}

/// Codes of warnings that do not concern the numbers in a noise file.
const BESIDE: [&str; 4] = ["columns-left-out", "kind-absent", "lines-skipped", "not-identified"];

/// The numbers of a noise file, in rad, m and s.
pub struct Numbers {
    pub choice: NoiseFileOptions,
    pub usage: Usage,
    /// The rejections of models that the user chose to accept.
    pub doubts: Vec<String>,
    /// Effects that the numbers leave out, per affected axis.
    pub left_out: Vec<String>,
    pub rate_hz: f64,
    pub gyroscope: Option<Sensor>,
    pub accelerometer: Option<Sensor>,
    /// The correlation time of the bias as a Gauss–Markov process.
    pub memory: SourcedNumber,
}

/// The axes of one kind.
pub struct Sensor {
    /// N for all axes of the kind, by [`Combine`].
    pub n: SourcedNumber,
    /// K for all axes of the kind, by [`Combine`].
    pub k: SourcedNumber,
    pub axes: Vec<AxisNumbers>,
}

#[derive(Clone)]
pub struct SourcedNumber {
    /// The number, in rad, m and s.
    pub value: f64,
    /// The source of the number, for a comment in the noise file: the axis or axes, and the rule.
    pub from: String,
}

impl SourcedNumber {
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { value: self.value * factor, from: self.from.clone() }
    }
}

pub struct AxisNumbers {
    /// White noise N by the [`Rule`], rad/√s or m/s/√s.
    pub n: SourcedNumber,
    /// N as it was fitted, or its upper limit if it is not identified, for programs whose noise model has no random
    /// walk K.
    pub fitted_n: SourcedNumber,
    /// Random walk K of the bias by the [`Rule`], rad/s/√s or m/s²/√s.
    pub k: SourcedNumber,
    /// Standard deviation of the bias as a Gauss–Markov process, rad/s or m/s².
    pub sigma: f64,
}

impl Axis<'_> {
    /// Factor from the unit of the model to rad/s or m/s².
    fn si(&self) -> f64 {
        match self.kind {
            Kind::Gyroscope => self.scale.to_radians(),
            Kind::Accelerometer => self.scale,
        }
    }

    fn n_and_k(&self, rule: Rule, usage: Usage) -> (SourcedNumber, SourcedNumber) {
        let (n, k) = (self.chosen("N", &self.fit.n), self.chosen("K", &self.fit.k));
        let covering = match rule {
            Rule::Covers(horizon_s) => self.fit.covering(usage, horizon_s),
            Rule::AsFitted => None,
        };
        let Some(Covering { n: n_covers, k: k_covers, horizon_s, .. }) = covering else { return (n, k) };
        let axis = self.name;
        let covers = |letter: &str, value: f64, fitted: &Coefficient| {
            let fitted = match fitted.identified {
                true => format!("fitted: {:.3e}", fitted.value * self.si()),
                false => format!("fitted: below {:.3e}", fitted.hi * self.si()),
            };
            let from = format!("{letter} of {axis}, covers the noise up to {horizon_s:.0} s; {fitted}");
            SourcedNumber { value: value * self.si(), from }
        };
        // if N alone covers the noise, K comes from the fit
        let of_n = n_covers * n_covers / horizon_s;
        let is_seen = k_covers * k_covers * horizon_s / 3.0 > SEEN * of_n;
        let k = if is_seen { covers("K", k_covers, &self.fit.k) } else { k };
        match usage {
            Usage::Filter => (covers("N", n_covers, &self.fit.n), k),
            Usage::Batch => (n, k),
        }
    }

    /// A coefficient, or its upper limit if it is not identified. Too small a number makes a filter trust its state
    /// too much. Too large a number only makes it learn more slowly.
    fn chosen(&self, letter: &str, coefficient: &Coefficient) -> SourcedNumber {
        let axis = self.name;
        let (value, from) = match coefficient.identified {
            true => (coefficient.value, format!("{letter} of {axis}")),
            false => (coefficient.hi, format!("upper 95 % limit of {letter} of {axis}, which is not identified")),
        };
        SourcedNumber { value: value * self.si(), from }
    }

    /// The name of the axis, and the effects in its record that are not noise: lines, drift, warm-up, steps, glitches.
    fn left_out(&self) -> Option<String> {
        let (fit, unit) = (self.fit, if self.kind == Kind::Gyroscope { "rad/s" } else { "m/s²" });
        let size = |value: f64| format!("{:.1e} {unit}", value.abs() * self.si());
        let strongest = fit.lines().max_by(|a, b| a.rms.total_cmp(&b.rms));
        let strongest = strongest.map(|line| (line.frequency_hz, size(line.rms)));
        let lines = strongest.map(|(hz, rms)| match fit.lines().count() {
            1 => format!("a line at {} ({rms} rms)", hertz(hz)),
            count => format!("{count} lines, the strongest at {} ({rms} rms)", hertz(hz)),
        });
        let drift = fit.r.map(|r| format!("a drift of {} over the record", size(2.0 * fit.span_s.1 * r.value)));
        let warm_up = fit.terms.iter().find_map(|term| match term {
            Term::WarmUp { size: estimate, .. } => Some(format!("a warm-up of {}", size(estimate.value))),
            _ => None,
        });
        let counted = |count: u64, what: &str| match count {
            0 => None,
            1 => Some(format!("1 {what}")),
            count => Some(format!("{count} {what}{}", if what.ends_with('h') { "es" } else { "s" })),
        };
        let (steps, glitches) = (counted(fit.cleaned.steps.len() as u64, "step"), fit.cleaned.glitches);
        let all: Vec<String> =
            [lines, drift, warm_up, steps, counted(glitches, "glitch")].into_iter().flatten().collect();
        (!all.is_empty()).then(|| format!("{}: {}", self.name, all.join(", ")))
    }

    /// Correlation time of the largest Gauss–Markov term, s.
    fn memory_s(&self) -> Option<f64> {
        let of_term = |term: &Term| match term {
            Term::GaussMarkov { sigma, tau_s } => Some((sigma.value, tau_s.value)),
            _ => None,
        };
        let largest = self.fit.terms.iter().filter_map(of_term).max_by(|a, b| a.0.total_cmp(&b.0));
        largest.map(|(_, tau_s)| tau_s)
    }

    /// σ, rad/s or m/s², of a Gauss–Markov process with correlation time `tau_s`. At its peak, its Allan deviation is
    /// that of the model without N. If the model has nothing but N there, it is that of the upper limits of B and K.
    fn sigma_at(&self, tau_s: f64) -> f64 {
        let peak_s = PEAK_AT * tau_s;
        let m = (peak_s * self.rate_hz).round().max(1.0);
        let without_n = self.fit.model.noise_variance(m as u64) - self.fit.n.value * self.fit.n.value / peak_s;
        let (b, k) = (FLOOR_PER_B * self.fit.b.hi, self.fit.k.hi);
        let most = b * b + k * k * peak_s / 3.0;
        let variance = if without_n > 0.0 { without_n } else { most };
        variance.sqrt() / PEAK * self.si()
    }
}

/// K counts if its Allan variance at the horizon is above this share of the Allan variance of N. A fit hardly knows
/// the variance of N to better than 10 %.
const SEEN: f64 = 0.1;

/// The averaging time at which the Allan deviation of a Gauss–Markov process peaks, in correlation times.
const PEAK_AT: f64 = 1.89;
/// The highest Allan deviation of a Gauss–Markov process, in standard deviations of the process.
const PEAK: f64 = 0.617;

impl Numbers {
    pub fn new(choice: NoiseFileOptions, usage: Usage, doubts: &Rejections, axes: &[Axis<'_>]) -> Self {
        let memory = correlation_time(axes);
        let of_kind = |kind| axes.iter().filter(move |axis| axis.kind == kind);
        let sensor = |kind| Sensor::new((&choice, usage), of_kind(kind), memory.value);
        let (gyroscope, accelerometer) = (sensor(Kind::Gyroscope), sensor(Kind::Accelerometer));
        // the two kinds may be of topics with different rates
        let of_gyroscope = axes.iter().find(|axis| axis.kind == Kind::Gyroscope);
        let rate_hz = of_gyroscope.or(axes.first()).map_or(0.0, |axis| axis.rate_hz);
        let left_out = axes.iter().filter_map(Axis::left_out).collect();
        Self { choice, usage, doubts: doubts.texts(), left_out, rate_hz, gyroscope, accelerometer, memory }
    }
}

/// The correlation time that all axes share, s: the geometric mean over the largest Gauss–Markov term of each axis.
/// Without such terms, a process has it whose Allan deviation peaks at the longest averaging time that all models
/// cover. If there are gyroscopes, only they count: accelerometers often have other correlation times.
fn correlation_time(axes: &[Axis<'_>]) -> SourcedNumber {
    let kind = axes.iter().map(|axis| axis.kind).find(|kind| *kind == Kind::Gyroscope);
    let of_kind = || axes.iter().filter(|axis| kind.is_none_or(|kind| axis.kind == kind));
    let times: Vec<f64> = of_kind().filter_map(Axis::memory_s).collect();
    let whose = if kind.is_some() { "the gyroscopes" } else { "the accelerometers" };
    if !times.is_empty() {
        let mean = times.iter().map(|time| time.ln()).sum::<f64>() / times.len() as f64;
        return SourcedNumber { value: mean.exp(), from: format!("of the Gauss–Markov terms of {whose}") };
    }
    let longest = of_kind().map(|axis| axis.fit.span_s.1).fold(f64::INFINITY, f64::min);
    let from = format!("{whose} have no Gauss–Markov term: its Allan deviation peaks at {longest:.0} s");
    SourcedNumber { value: longest / PEAK_AT, from }
}

impl Sensor {
    fn new<'a>(
        (choice, usage): (&NoiseFileOptions, Usage),
        axes: impl Iterator<Item = &'a Axis<'a>>,
        tau_s: f64,
    ) -> Option<Self> {
        let inflate = choice.inflate;
        let of = |axis: &Axis<'_>| {
            let (n, k) = axis.n_and_k(choice.rule, usage);
            let fitted_n = axis.chosen("N", &axis.fit.n).times(inflate);
            AxisNumbers { n: n.times(inflate), fitted_n, k: k.times(inflate), sigma: inflate * axis.sigma_at(tau_s) }
        };
        let axes: Vec<AxisNumbers> = axes.map(of).collect();
        let n = choice.combine.choose(axes.iter().map(|axis| &axis.n))?;
        let k = choice.combine.choose(axes.iter().map(|axis| &axis.k))?;
        Some(Self { n, k, axes })
    }
}

impl Rule {
    /// Describes how N and K follow from the noise model, for the head of the noise file.
    #[must_use]
    pub fn words(self, usage: Usage, names: Names) -> String {
        let (horizon, as_fitted) = (names.of(Setting::Horizon), names.of(Setting::AsFitted));
        match (self, usage) {
            (Self::Covers(_), Usage::Filter) => {
                format!("N²/τ + K²τ/3 covers the noise ({horizon}); {as_fitted} gives N and K as they were fitted")
            }
            (Self::Covers(_), Usage::Batch) => format!(
                "N is as it was fitted, and K is lifted to cover the noise within a batch ({horizon}); {as_fitted} \
                 gives both as fitted"
            ),
            (Self::AsFitted, _) => format!("N and K are as they were fitted ({as_fitted})"),
        }
    }
}

impl Combine {
    /// Combines several numbers into one; `None` if there are none.
    fn choose<'a>(self, all: impl Iterator<Item = &'a SourcedNumber>) -> Option<SourcedNumber> {
        let all: Vec<&SourcedNumber> = all.collect();
        match self {
            Self::Worst => all.into_iter().max_by(|a, b| a.value.total_cmp(&b.value)).cloned(),
            Self::Mean => {
                let from: Vec<&str> = all.iter().map(|one| one.from.as_str()).collect();
                let from =
                    if let [only] = from[..] { only.to_owned() } else { format!("mean of {}", from.join(", ")) };
                let mean = all.iter().map(|one| one.value).sum::<f64>() / all.len() as f64;
                (!all.is_empty()).then_some(SourcedNumber { value: mean, from })
            }
        }
    }

    /// Describes how the numbers of several axes were combined, for the head of the noise file.
    #[must_use]
    pub fn words(self, names: Names) -> String {
        let taken = self.name();
        format!("the {taken} was taken ({} {taken})", names.of(Setting::Combine))
    }

    /// The name of the rule as an option value.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Worst => "worst",
            Self::Mean => "mean",
        }
    }
}
