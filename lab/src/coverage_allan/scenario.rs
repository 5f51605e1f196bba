//! The simulated records, with the bounds on the results for each.

use std::f64::consts::{LN_2, PI};
use zerorate_allan::FLOOR_PER_B;

/// A record to simulate, with its true noise coefficients N, B, K and Q, with ° and s as units.
#[derive(Clone, Copy)]
pub struct Scenario {
    pub name: &'static str,
    pub length_s: f64,
    pub n: f64,
    pub b: f64,
    pub k: f64,
    pub q: f64,
    /// The filter of the sensor. All noise except the quantisation noise passes through it.
    pub filter: Filter,
    /// σ, °/s, and T, s, of a Gauss–Markov process.
    pub gauss_markov: Option<(f64, f64)>,
    pub disturbance: Disturbance,
    pub bounds: Bounds,
}

/// A filter with gain 1 at zero frequency.
#[derive(Clone, Copy)]
pub enum Filter {
    None,
    /// A first-order low-pass with this time constant, s.
    LowPass(f64),
    /// A second-order Butterworth low-pass with this cut-off frequency, Hz, by the bilinear transform.
    Butterworth(f64),
    /// A moving average over this many samples.
    Mean(usize),
}

/// A disturbance in addition to the noise.
#[derive(Clone, Copy)]
pub enum Disturbance {
    Nothing,
    /// Amplitude, °/s, and frequency, Hz.
    Sine(f64, f64),
    /// Frequency, Hz, half width, Hz, and power relative to the white noise.
    Resonance(f64, f64, f64),
    /// Share of the samples that are outliers by ±50 °/s.
    Outliers(f64),
    /// Size of a step, °/s, at a random time.
    Step(f64),
    /// Share of the samples that are missing, each independently of the others.
    Loss(f64),
    /// Longest burst of missing samples, s, and number of bursts.
    Bursts(f64, u32),
    /// Length of a single gap at a random time, s.
    Gap(f64),
    /// Size of one code in standard deviations of a sample.
    Coarse(f64),
    /// Size, °/s, and time constant, s, of a warm-up drift.
    WarmUp(f64, f64),
}

#[derive(Clone, Copy)]
pub struct Bounds {
    pub coverage: (f64, f64),
    /// Upper bounds on the relative rms errors of N, B and K, %.
    pub rms: [f64; 3],
    /// Smallest share of records in which N and B are identified, %.
    pub identified: [f64; 2],
    /// Smallest share of records in which an existing Gauss–Markov term is found, and, as `false_terms`, largest share
    /// in which such a term is found but does not exist, %.
    pub found: f64,
    pub false_terms: f64,
    /// Smallest and largest share of records in which a step is found, %.
    pub steps: (f64, f64),
}

/// Bounds of scenarios without their own bounds. The checks widen them, except `identified`, by what chance allows.
const OTHER: Bounds = Bounds {
    coverage: (93.0, 97.0),
    rms: [f64::INFINITY; 3],
    identified: [0.0; 2],
    found: 0.0,
    false_terms: 2.0,
    steps: (0.0, 2.0),
};
/// Bounds of scenarios in which the fit widens the intervals with a warning, so that more than 97 % may cover the
/// truth.
const WIDENED: Bounds = Bounds { coverage: (93.0, 100.0), ..OTHER };
/// Bounds of scenarios in which flicker or random walk may be mistaken for something else, if there is a warning.
const NOT_SILENT: Bounds = Bounds { coverage: (0.0, 100.0), ..OTHER };

const fn floor(deg_per_h: f64) -> f64 {
    deg_per_h / 3600.0 / FLOOR_PER_B
}

/// A record of one hour, for which the project's goals are stated.
const HOUR: Scenario = Scenario {
    name: "hour",
    length_s: 3600.0,
    n: 0.56 / 60.0,
    b: floor(6.25),
    k: 2e-4,
    q: 0.0,
    filter: Filter::None,
    gauss_markov: None,
    disturbance: Disturbance::Nothing,
    bounds: OTHER,
};

pub fn scenarios() -> Vec<Scenario> {
    [terms(), filtered(), disturbed()].concat()
}

/// Records whose noise consists of terms of the fitted model, alone and combined.
fn terms() -> Vec<Scenario> {
    let goal = Bounds { rms: [0.13, 9.8, 38.0], identified: [99.0, 95.0], ..OTHER };
    let white = Scenario { b: 0.0, k: 0.0, ..HOUR };
    let memory = |name, sigma, tau_s, found| Scenario {
        name,
        gauss_markov: Some((sigma, tau_s)),
        bounds: Bounds { found, false_terms: 100.0, ..OTHER },
        ..white
    };
    vec![
        Scenario { bounds: goal, ..HOUR },
        Scenario { name: "no flicker", b: 0.0, ..HOUR },
        Scenario { name: "no random walk", k: 0.0, ..HOUR },
        Scenario { name: "white alone", ..white },
        Scenario { name: "noisy MEMS", n: 3.0 / 60.0, b: floor(20.0), k: 1e-3, ..HOUR },
        Scenario { name: "10 minutes", length_s: 600.0, ..HOUR },
        Scenario { name: "six hours", length_s: 21_600.0, ..HOUR },
        Scenario { name: "quantised", q: 2e-4, ..HOUR },
        memory("Gauss–Markov of 0.5 s", 0.02, 0.5, 99.0),
        memory("Gauss–Markov of 5 s", 0.01, 5.0, 99.0),
        memory("Gauss–Markov of 50 s", 0.01, 50.0, 90.0),
    ]
}

/// The hour with filters. The fitted shape has one cosine more than the data require, which makes N less certain than
/// necessary.
fn filtered() -> Vec<Scenario> {
    let behind = |name, filter| Scenario { name, filter, bounds: WIDENED, ..HOUR };
    vec![
        behind("behind a low-pass", Filter::LowPass(0.03)),
        behind("behind a slow low-pass", Filter::LowPass(0.5)),
        behind("behind a Butterworth of 0.3 Hz", Filter::Butterworth(0.3)),
        behind("behind a Butterworth of 2.5 Hz", Filter::Butterworth(2.5)),
        behind("behind a Butterworth of 10 Hz", Filter::Butterworth(10.0)),
        behind("behind a mean of 2", Filter::Mean(2)),
        behind("behind a mean of 8", Filter::Mean(8)),
    ]
}

/// The hour with a disturbance, or with lost samples.
fn disturbed() -> Vec<Scenario> {
    let with = |name, disturbance| Scenario { name, disturbance, ..HOUR };
    let widened = |name, disturbance| Scenario { bounds: WIDENED, ..with(name, disturbance) };
    let jump = |name, size, least| Scenario {
        bounds: Bounds { steps: (least, 100.0), ..OTHER },
        ..with(name, Disturbance::Step(size))
    };
    vec![
        with("with a sine", Disturbance::Sine(0.02, 0.5)),
        with("with a slow sine", Disturbance::Sine(0.1, 0.01)),
        widened("with a resonance", Disturbance::Resonance(20.0, 1.0, 0.25)),
        with("outliers 1e-6", Disturbance::Outliers(1e-6)),
        with("outliers 1e-5", Disturbance::Outliers(1e-5)),
        with("outliers 1e-4", Disturbance::Outliers(1e-4)),
        with("outliers 1e-3", Disturbance::Outliers(1e-3)),
        Scenario { bounds: Bounds { steps: (75.0, 100.0), ..NOT_SILENT }, ..jump("step of 0.02", 0.02, 75.0) },
        jump("step of 0.03", 0.03, 95.0),
        jump("step of 0.05", 0.05, 99.0),
        widened("40 % lost", Disturbance::Loss(0.4)),
        widened("lost in bursts", Disturbance::Bursts(7.0, 60)),
        widened("lost in short bursts", Disturbance::Bursts(0.1, 20_000)),
        widened("lost in long bursts", Disturbance::Bursts(60.0, 30)),
        widened("lost at once", Disturbance::Gap(100.0)),
        with("coarse codes", Disturbance::Coarse(1.2)),
        Scenario { bounds: NOT_SILENT, k: 0.0, ..with("warm-up", Disturbance::WarmUp(0.05, 600.0)) },
        with("warm-up beside a walk", Disturbance::WarmUp(1.0, 120.0)),
    ]
}

impl Scenario {
    /// The true Allan variance σ²(τ) without filter and disturbance, by the formulas in IEEE Std 952-1997 C.1.
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        let memory = self.gauss_markov.map_or(0.0, |(sigma, t)| {
            let bend = 3.0 - 4.0 * (-tau_s / t).exp() + (-2.0 * tau_s / t).exp();
            2.0 * sigma * sigma * t / tau_s * (1.0 - t / (2.0 * tau_s) * bend)
        });
        3.0 * (self.q / tau_s).powi(2)
            + self.n.powi(2) / tau_s
            + 2.0 * LN_2 / PI * self.b.powi(2)
            + self.k.powi(2) * tau_s / 3.0
            + memory
    }

    /// The N, B and K that a measurement finds, with ° and s as units. N includes the white noise of rounding to
    /// codes, and the tail of a resonance.
    pub fn truth(&self, rate_hz: f64) -> [f64; 3] {
        if let Disturbance::Resonance(frequency_hz, half_width_hz, part) = self.disturbance {
            let (r, angle) = ((-2.0 * PI * half_width_hz / rate_hz).exp(), 2.0 * PI * frequency_hz / rate_hz);
            let (r2, at_zero) = (r * r, 1.0 - 2.0 * r * angle.cos() + r * r);
            // variance of the filter's output for white noise of variance 1
            let variance = (1.0 + r2) / ((1.0 - r2) * (1.0 - 2.0 * r2 * (2.0 * angle).cos() + r2 * r2));
            return [self.n * (1.0 + part / (variance * at_zero * at_zero)).sqrt(), self.b, self.k];
        }
        let step = match self.disturbance {
            Disturbance::Coarse(steps) => steps * self.n * rate_hz.sqrt(),
            _ => 0.0,
        };
        [(self.n * self.n + step * step / 12.0 / rate_hz).sqrt(), self.b, self.k]
    }
}
