//! Compares the errors of simulated filters with the variances that they claim. Each filter has the numbers of its
//! noise file.

use super::{Axis, Format, Kind, NoiseFileOptions, Rejections, Rule};
use std::f64::consts::PI;
use zerorate_allan::{Fit, FitOptions, Input, fit};

const RATE_HZ: f64 = 100.0;
const HOUR: usize = 360_000;
/// The filters use means of the rate over this time, s.
const STEP_S: f64 = 0.1;

/// The noise of a gyroscope: white noise, °/√s, flicker, °/s, a random walk, °/s/√s, and a Gauss–Markov process, °/s.
#[derive(Clone, Copy, Default)]
struct Truth {
    n: f64,
    b: f64,
    k: f64,
    sigma: f64,
    tau_s: f64,
}

fn normal(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (2.0 * PI * uniform()).cos()
}

impl Truth {
    /// An hour of noise. Its flicker is a sum of Gauss–Markov processes with correlation times a factor r apart, each
    /// of variance B² ln r/π. The two-sided density of the sum is B²/(2πf).
    fn noise(&self, seed: u64) -> Vec<f64> {
        const APART: f64 = 4.0;
        let mut normal = normal(seed);
        let flicker = (0..10).map(|i| (self.b * (APART.ln() / PI).sqrt(), 0.03 * APART.powi(i)));
        let all = flicker.chain([(self.sigma, self.tau_s)]).filter(|(sigma, _)| *sigma > 0.0);
        let mut markovs: Vec<(f64, f64, f64)> = Vec::new();
        for (sigma, tau_s) in all {
            let phi = (-1.0 / (RATE_HZ * tau_s)).exp();
            markovs.push((sigma * normal(), phi, sigma * (1.0 - phi * phi).sqrt()));
        }
        let mut walk = 0.0;
        let sample = |_| {
            walk += self.k / RATE_HZ.sqrt() * normal();
            markovs.iter_mut().for_each(|(now, phi, drive)| *now = *phi * *now + *drive * normal());
            walk + self.n * RATE_HZ.sqrt() * normal() + markovs.iter().map(|(now, ..)| now).sum::<f64>()
        };
        (0..HOUR).map(sample).collect()
    }
}

/// The noise model of a filter: white noise, and a Gauss–Markov bias with a driving noise and a correlation time.
#[derive(Clone, Copy, Debug)]
struct Belief {
    n: f64,
    drive: f64,
    tau_s: f64,
}

impl Belief {
    /// The model that a program builds from its noise file, according to the documentation of the program.
    fn of(format: Format, rule: Rule, model: &Fit) -> Self {
        let axis = |name| Axis { name, kind: Kind::Gyroscope, rate_hz: RATE_HZ, fit: model, scale: 1.0 };
        let choice = NoiseFileOptions { rule, ..NoiseFileOptions::default() };
        let text = format.file(choice, &["x", "y", "z"].map(axis), &Rejections::default(), false).unwrap();
        let number = |key: &str| -> f64 {
            let line = text.lines().find_map(|line| line.trim_start().strip_prefix(key)?.strip_prefix(": ")).unwrap();
            let end = |c: char| c == ',' || c.is_whitespace();
            line.trim_start_matches('[').split(end).next().unwrap().parse().unwrap()
        };
        let walk = |n: f64, k: f64| Self { n: n.to_degrees(), drive: k.to_degrees(), tau_s: f64::INFINITY };
        match format {
            Format::Kalibr | Format::Openvins => {
                walk(number("gyroscope_noise_density"), number("gyroscope_random_walk"))
            }
            Format::Vins => walk(number("gyr_n") / RATE_HZ.sqrt(), number("gyr_w") / RATE_HZ.sqrt()),
            Format::Orbslam3 => walk(number("IMU.NoiseGyro"), number("IMU.GyroWalk")),
            Format::Ros => walk((number("angular_velocity_covariance") / RATE_HZ).sqrt(), 0.0),
            Format::KfGins => {
                let (sigma, tau_s) = (number("gbstd") / 3600.0, number("corrtime") * 3600.0);
                Self { n: number("arw") / 60.0, drive: sigma * (2.0 / tau_s).sqrt(), tau_s }
            }
        }
    }
}

/// A Kalman filter of the bias, of a constant that couples a known motion into the rate, and of an angle.
struct Kalman {
    belief: Belief,
    state: [f64; 3],
    covariance: [[f64; 3]; 3],
}

const BIAS: usize = 0;
const COUPLING: usize = 1;
const ANGLE: usize = 2;

impl Kalman {
    fn new(belief: Belief) -> Self {
        let mut covariance = [[0.0; 3]; 3];
        (covariance[BIAS][BIAS], covariance[COUPLING][COUPLING]) = (1.0, 1.0);
        Self { belief, state: [0.0; 3], covariance }
    }

    /// Predicts the state after [`STEP_S`]. Without a measurement, the angle integrates the bias.
    fn go_on(&mut self, is_measured: bool) {
        let Belief { n, drive, tau_s } = self.belief;
        let [phi, angle] = [(-STEP_S / tau_s).exp(), if is_measured { 0.0 } else { STEP_S }];
        self.state[ANGLE] += angle * self.state[BIAS];
        self.state[BIAS] *= phi;
        let p = &mut self.covariance;
        let bias = p[BIAS];
        p[ANGLE].iter_mut().zip(bias).for_each(|(to, of)| *to += angle * of);
        p[BIAS].iter_mut().for_each(|of| *of *= phi);
        for row in p.iter_mut() {
            row[ANGLE] += angle * row[BIAS];
            row[BIAS] *= phi;
        }
        let power = drive * drive;
        p[BIAS][BIAS] += power * STEP_S;
        p[BIAS][ANGLE] += power * STEP_S * angle / 2.0;
        p[ANGLE][BIAS] = p[BIAS][ANGLE];
        p[ANGLE][ANGLE] += angle * (n * n + power * STEP_S * angle / 3.0);
    }

    /// Updates the state with a mean rate, which is the bias plus the coupling constant times `motion`.
    fn measure(&mut self, rate: f64, motion: f64) {
        let p = self.covariance;
        let seen: [f64; 3] = std::array::from_fn(|i| p[i][BIAS] + motion * p[i][COUPLING]);
        let variance = seen[BIAS] + motion * seen[COUPLING] + self.belief.n * self.belief.n / STEP_S;
        let off = rate - self.state[BIAS] - motion * self.state[COUPLING];
        for (i, of) in seen.iter().enumerate() {
            self.state[i] += of / variance * off;
            (0..3).for_each(|j| self.covariance[i][j] -= of * seen[j] / variance);
        }
    }
}

/// The mean of squared errors, each divided by the variance that the filter claims.
#[derive(Clone, Copy, Debug, Default)]
struct Ratio {
    sum: f64,
    count: f64,
}

impl Ratio {
    fn add(&mut self, error: f64, variance: f64) {
        self.sum += error * error / variance;
        self.count += 1.0;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }
}

/// Runs a filter on a record at rest. After the first ten minutes, a copy of the filter integrates the rate for 10, 60
/// and 300 s without a reference, every two minutes.
fn as_filter(found: &mut [Ratio], rate: &[f64], belief: Belief) {
    const SPANS_S: [f64; 3] = [10.0, 60.0, 300.0];
    let steps = |time_s: f64| (time_s / STEP_S).round() as usize;
    let mut standing = Kalman::new(belief);
    for (step, &mean) in rate.iter().enumerate() {
        if step >= steps(600.0) && step.is_multiple_of(steps(120.0)) && step + steps(300.0) <= rate.len() {
            let mut alone = Kalman { state: standing.state, ..standing };
            let mut angle = 0.0;
            for (ahead, &mean) in (1..).zip(&rate[step..step + steps(300.0)]) {
                alone.go_on(false);
                angle += mean * STEP_S;
                if let Some(span) = SPANS_S.iter().position(|span_s| steps(*span_s) == ahead) {
                    found[span].add(angle - alone.state[ANGLE], alone.covariance[ANGLE][ANGLE]);
                }
            }
        }
        standing.go_on(true);
        standing.measure(mean, 0.0);
    }
}

/// Batch estimates over one minute and over two. Each estimates the coupling constant from a motion of 0.3 Hz, and the
/// angle over 10 s without a reference in the middle of the batch.
fn as_batch(found: &mut [Ratio], rate: &[f64], belief: Belief) {
    for batch_s in [60.0, 120.0] {
        let steps = |time_s: f64| (time_s / STEP_S).round() as usize;
        let gap = steps(batch_s / 2.0 - 5.0)..steps(batch_s / 2.0 + 5.0);
        for batch in rate.chunks_exact(steps(batch_s)) {
            let (mut moving, mut gapped, mut angle) = (Kalman::new(belief), Kalman::new(belief), 0.0);
            for (step, &mean) in batch.iter().enumerate() {
                moving.go_on(true);
                moving.measure(mean, (2.0 * PI * 0.3 * STEP_S * step as f64).sin());
                gapped.go_on(!gap.contains(&step));
                if gap.contains(&step) { angle += mean * STEP_S } else { gapped.measure(mean, 0.0) }
            }
            found[0].add(moving.state[COUPLING], moving.covariance[COUPLING][COUPLING]);
            found[1].add(angle - gapped.state[ANGLE], gapped.covariance[ANGLE][ANGLE]);
        }
    }
}

/// Five ratios for each noise file of a sensor: of the coupling constant and of the angle in a batch, then of the
/// angle after each of the three spans of a filter. Each ratio is a mean over four pairs of records: the noise file
/// comes from one, and the estimators run on the other.
fn ratios(truth: Truth, all: &[(Format, Rule)]) -> Vec<[f64; 5]> {
    let mut found = vec![[Ratio::default(); 5]; all.len()];
    for seed in 0..4 {
        let model = fit(&Input::Rate(&truth.noise(900 + 2 * seed)), RATE_HZ, &FitOptions::default()).unwrap();
        let per_step = (STEP_S * RATE_HZ) as usize;
        let other = truth.noise(901 + 2 * seed);
        let means: Vec<f64> =
            other.chunks_exact(per_step).map(|part| part.iter().sum::<f64>() / per_step as f64).collect();
        for (ratios, &(format, rule)) in found.iter_mut().zip(all) {
            let belief = Belief::of(format, rule, &model);
            as_batch(&mut ratios[..2], &means, belief);
            as_filter(&mut ratios[2..], &means, belief);
        }
    }
    found.iter().map(|ratios| ratios.map(|ratio| ratio.mean())).collect()
}

/// docs/imu.md quotes the output of this test (`--nocapture`).
#[test]
fn filters_claim_their_true_error_with_the_numbers_of_their_files() {
    const USUAL: Truth = Truth { n: 0.56 / 60.0, b: 6.25 / 3600.0 / 0.664, k: 2e-4, sigma: 0.0, tau_s: 1.0 };
    let sensors = [
        ("N, B and K", USUAL),
        ("ten times the floor", Truth { b: 10.0 * USUAL.b, ..USUAL }),
        ("a memory of 50 s", Truth { sigma: 0.01, tau_s: 50.0, b: 0.0, k: 0.0, ..USUAL }),
        ("a memory of 5 s", Truth { sigma: 0.02, tau_s: 5.0, b: 0.0, k: 0.0, ..USUAL }),
    ];
    let covers = Rule::Covers(None);
    let fitted = [(Format::Kalibr, Rule::AsFitted)];
    let all: Vec<(Format, Rule)> = fitted.into_iter().chain(Format::ALL.map(|format| (format, covers))).collect();
    for (name, truth) in sensors {
        let found = ratios(truth, &all);
        for ((format, rule), ratios) in all.iter().zip(&found) {
            println!("{name}, {} {rule:?}: batch {:.2?}, filter {:.2?}", format.name(), &ratios[..2], &ratios[2..]);
        }
        let of = |format: Format| found[all.iter().position(|one| *one == (format, covers)).unwrap()];
        // with ten times the usual B, four fifths of the noise power at 0.3 Hz is flicker
        let kalibr = of(Format::Kalibr);
        assert!(kalibr[..2].iter().all(|ratio| (0.5..2.5).contains(ratio)), "{name}: {kalibr:?}");
        for format in [Format::Openvins, Format::Vins, Format::Orbslam3] {
            let long = of(format);
            assert!(long[2] > 0.5 && long[2..].iter().all(|ratio| *ratio < 1.3), "{name}: {long:?}");
        }
    }
}
