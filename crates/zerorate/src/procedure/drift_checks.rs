//! Compares a whole measurement with one line over temperature. Finds other changes of the rate, such as steps or
//! a lag, and the errors of PBC and BTC that they cause.
//!
//! The means over seconds are averaged into some 300 bins and whitened by the part's noise (`gls.rs`). The shape
//! (`shape.rs`) that explains most of the rate is added to the model. This repeats until noise alone could explain
//! the rest.

use super::blocks::Second;
use super::shape::{self, Shape};
use crate::noise::{NoiseModel, WeightedMean, Window};
use crate::notice::{Deviation, Finding};
use crate::temperature::gls::{self, Fit, dot};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use zerorate_allan::linear::Cholesky;

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Findings {
    /// The deviations that are beyond doubt, the strongest first.
    pub(crate) found: Vec<Finding>,
    /// Whether the rate deviates even after [`MOST`] deviations were found.
    pub(crate) unexplained: bool,
    /// Contribution of certain and suspected deviations to the uncertainty of PBC, °/s.
    pub(crate) u_pbc_dps: f64,
    /// Contribution of certain and suspected deviations to the uncertainty of BTC, °/s/°C.
    pub(crate) u_btc_dps_per_c: f64,
    /// Rms error of BTC by the curvature that is possible after this measurement, °/s/°C.
    pub(crate) u_curvature_dps_per_c: f64,
    taken: Vec<(Shape, f64)>,
}

impl Findings {
    /// Returns all steps, and the strongest deviation of each other kind. An oscillation whose frequency wanders is
    /// found more than once.
    pub(crate) fn distinct(&self) -> impl Iterator<Item = Finding> + '_ {
        let kind = |finding: &Finding| core::mem::discriminant(&finding.deviation);
        let found = &self.found;
        let is_step = |finding: &Finding| matches!(finding.deviation, Deviation::Step { .. });
        let repeats = move |k: usize| !is_step(&found[k]) && found[..k].iter().any(|one| kind(one) == kind(&found[k]));
        (0..found.len()).filter(move |k| !repeats(*k)).map(|k| found[k])
    }

    pub(crate) fn worst_of_btc(&self) -> Option<Finding> {
        self.found.iter().copied().max_by(|a, b| a.btc_dps_per_c.abs().total_cmp(&b.btc_dps_per_c.abs()))
    }

    /// Mean of the steps and the base motion that were found, between two times, °/s.
    pub(crate) fn disturbance_dps(&self, start_s: f64, end_s: f64) -> f64 {
        let disturbs = |(shape, _): &&(Shape, f64)| matches!(shape, Shape::Step { .. } | Shape::Oscillation { .. });
        self.taken.iter().filter(disturbs).map(|(shape, size)| size * shape.mean(start_s, end_s)).sum()
    }
}

/// The input of the search: the averages of the procedure, and the assumptions about the unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchInput {
    /// The averages of steps 4, 6 and 8, or three windows of a recording without steps, each a tenth of its length.
    pub(crate) averages: [WeightedMean; 3],
    /// T2 − T1, or the temperature span of a recording that has no steps, °C.
    pub(crate) span_c: f64,
    pub(crate) t3_c: f64,
    pub(crate) noise: NoiseModel,
    /// Spread of the curvature over units, °/s/°C². Zero if not known, and in AN-1042 for a unit assumed linear.
    pub(crate) curvature_dps_per_c2: f64,
    /// Largest change of the bias with the supply, °/s/mV.
    pub(crate) supply_dps_per_mv: Option<f64>,
}

/// Largest number of deviations that the search tells apart.
const MOST: usize = 4;
/// Smallest number of bins for a search.
const FEWEST: usize = 40;
/// Number of standard deviations from which a deviation is suspected, and widens the uncertainty.
const SUSPECT: f64 = 3.0;

/// Looks for deviations. `None` if the record is too short, has too many gaps, or cannot be fitted.
pub(crate) fn findings(seconds: &[Second], question: &SearchInput) -> Option<Findings> {
    let bins = bins(seconds);
    if bins.len() < FEWEST {
        return None;
    }
    Search::new(seconds, &bins, question)?.run()
}

struct Bin {
    window: Window,
    rate_dps: f64,
    temp_c: f64,
}

/// The longest bins last 1/280 of the record, rounded up to whole seconds.
const BINS: u32 = 280;

/// Averages the record into bins, shorter ones at its ends. Bins with at most half of their seconds are left out.
fn bins(seconds: &[Second]) -> Vec<Bin> {
    let total_s = seconds.last().map_or(0, |second| second.at_s as u32 + 1);
    let longest = total_s.div_ceil(BINS).max(1);
    let mut bins = Vec::new();
    let (mut rest, mut start_s) = (seconds, 0);
    while start_s < total_s {
        let from_end_s = start_s.min(total_s - start_s);
        let end_s = (start_s + (from_end_s / 8).clamp(1, longest)).min(total_s);
        let inside;
        (inside, rest) = rest.split_at(rest.partition_point(|second| second.at_s < f64::from(end_s)));
        let window = Window { start_s, end_s };
        if 2.0 * inside.len() as f64 > window.length_s() {
            let mean = |of: fn(&Second) -> f64| inside.iter().map(of).sum::<f64>() / inside.len() as f64;
            bins.push(Bin { window, rate_dps: mean(|s| s.rate_dps), temp_c: mean(|s| s.temp_c) });
        }
        start_s = end_s;
    }
    bins
}

struct Search<'a> {
    question: &'a SearchInput,
    windows: Vec<Window>,
    whitener: Cholesky,
    rates: Vec<f64>,
    /// Columns of the model, whitened: level, temperature, then the shapes.
    columns: Vec<Vec<f64>>,
    shapes: Vec<Shape>,
    /// The columns of the model, made orthogonal to each other and of unit length.
    units: Vec<Vec<f64>>,
    /// The rates less the model.
    residual: Vec<f64>,
    candidates: Vec<Candidate>,
}

impl<'a> Search<'a> {
    fn new(seconds: &[Second], bins: &[Bin], question: &'a SearchInput) -> Option<Self> {
        let windows: Vec<Window> = bins.iter().map(|bin| bin.window).collect();
        let mut covariances = question.noise.covariances(&windows);
        let bend: Vec<f64> = shape::means(&Shape::curved(seconds, question.t3_c), &windows).collect();
        add_square(&mut covariances, &bend, question.curvature_dps_per_c2);
        let whitener = gls::whitener(covariances)?;
        let rates = whitener.whiten(bins.iter().map(|bin| bin.rate_dps));
        let level = whitener.whiten(bins.iter().map(|_| 1.0));
        let temps = whitener.whiten(bins.iter().map(|bin| bin.temp_c - question.t3_c));
        let shapes = shape::all(seconds, &windows, question.t3_c).into_iter();
        let candidates = shapes.map(|shape| Candidate::new(shape, &windows, &whitener)).collect();
        let (columns, shapes, units, residual) = (Vec::new(), Vec::new(), Vec::new(), rates.clone());
        let mut search = Self { question, windows, whitener, rates, columns, shapes, units, residual, candidates };
        search.add(level);
        search.add(temps);
        Some(search)
    }

    fn run(mut self) -> Option<Findings> {
        while self.shapes.len() < MOST {
            let Some(strongest) = self.strongest() else { break };
            let shape = self.refined(strongest);
            self.add(self.whitener.whiten(shape::means(&shape, &self.windows)));
            self.shapes.push(shape);
        }
        let unexplained = self.shapes.len() == MOST && self.strongest().is_some();
        self.summary(unexplained)
    }

    /// The candidate that explains most beyond its [`freedom`], of those that explain more than noise could.
    fn strongest(&self) -> Option<&Candidate> {
        let gains = self.candidates.iter().map(|candidate| (candidate.gain(&self.residual), candidate));
        let beyond_doubt = gains.filter(|(gain, candidate)| *gain > alarm(&candidate.shape));
        let rank = |(gain, candidate): &(f64, &Candidate)| gain - freedom(&candidate.shape);
        beyond_doubt.max_by(|a, b| rank(a).total_cmp(&rank(b))).map(|(_, candidate)| candidate)
    }

    /// Adds a column to the model, and removes it from the residual and the candidates.
    fn add(&mut self, column: Vec<f64>) {
        let mut left = column.clone();
        self.units.iter().for_each(|unit| gls::take_out(&mut left, unit));
        let length = libm::sqrt(dot(&left, &left));
        if length > 0.0 {
            left.iter_mut().for_each(|value| *value /= length);
            gls::take_out(&mut self.residual, &left);
            self.candidates.iter_mut().for_each(|candidate| candidate.take_out(&left));
            self.units.push(left);
        }
        self.columns.push(column);
    }

    /// Returns the shape of a candidate with its missing detail: the second of a step, the phase of an oscillation.
    fn refined(&self, candidate: &Candidate) -> Shape {
        match candidate.shape {
            Shape::Step { at_s, .. } => self.located(at_s),
            Shape::Oscillation { hz, .. } => Shape::Oscillation { hz, phase: candidate.phase(&self.residual) },
            ref shape => shape.clone(),
        }
    }

    /// Returns the best step near `near_s`, with the first and the last second that fit nearly as well.
    fn located(&self, near_s: f64) -> Shape {
        let reach = self.windows.iter().map(Window::length_s).fold(1.0, f64::max) as i32;
        let gain = |at_s: f64| {
            let mut candidate = Candidate::new(Shape::step(at_s), &self.windows, &self.whitener);
            self.units.iter().for_each(|unit| candidate.take_out(unit));
            (at_s, candidate.gain(&self.residual))
        };
        let tried: Vec<(f64, f64)> = (-reach..=reach).map(|off| gain(near_s + f64::from(off))).collect();
        let (at_s, best) =
            tried.iter().copied().fold((near_s, 0.0), |best, one| if one.1 > best.1 { one } else { best });
        let mut as_well = tried.iter().filter(|(_, gain)| *gain > best - NEARLY).map(|(at_s, _)| *at_s);
        let from_s = as_well.next().unwrap_or(at_s);
        Shape::Step { at_s, from_s, to_s: as_well.next_back().unwrap_or(at_s) }
    }

    fn summary(&self, unexplained: bool) -> Option<Findings> {
        let fit = Fit::new(&self.columns, &self.rates)?;
        let sizes = &fit.coefficients[self.columns.len() - self.shapes.len()..];
        let found: Vec<Finding> =
            self.shapes.iter().zip(sizes).map(|(shape, size)| self.finding(shape, *size)).collect();
        let (maybe_pbc, maybe_btc) = self.suspects();
        let together = |of: fn(&Finding) -> f64, maybe: f64| {
            let sum: f64 = found.iter().map(of).sum();
            let known: f64 = self.u(&fit, of);
            libm::hypot(libm::hypot(sum, known), maybe)
        };
        Some(Findings {
            u_pbc_dps: together(|finding| finding.pbc_dps, maybe_pbc),
            u_btc_dps_per_c: together(|finding| finding.btc_dps_per_c, maybe_btc),
            u_curvature_dps_per_c: self.curvature_error(),
            found,
            unexplained,
            taken: self.shapes.iter().cloned().zip(sizes.iter().copied()).collect(),
        })
    }

    /// Standard uncertainty of the error that all findings together cause.
    fn u(&self, fit: &Fit, of: fn(&Finding) -> f64) -> f64 {
        let shapes = self.shapes.iter().map(|shape| of(&self.finding(shape, 1.0)));
        let weights: Vec<f64> = vec![0.0; self.columns.len() - self.shapes.len()].into_iter().chain(shapes).collect();
        libm::sqrt(fit.variance(&weights))
    }

    /// The finding for a shape of a given size. The errors by a step are the largest over its possible times.
    fn finding(&self, shape: &Shape, size: f64) -> Finding {
        let worst = |error: fn(&SearchInput, &Shape) -> f64| match *shape {
            Shape::Step { at_s, from_s, to_s } => {
                let errors = [at_s, from_s, to_s].map(|at_s| error(self.question, &Shape::step(at_s)));
                errors.into_iter().fold(0.0, |worst: f64, error| if error.abs() > worst.abs() { error } else { worst })
            }
            _ => error(self.question, shape),
        };
        Finding {
            deviation: self.question.deviation(shape, size),
            pbc_dps: size * worst(SearchInput::pbc_error),
            btc_dps_per_c: size * worst(SearchInput::btc_error),
        }
    }

    /// Returns the largest errors of PBC and BTC by deviations that are only suspected.
    fn suspects(&self) -> (f64, f64) {
        let doubtful = |candidate: &&Candidate| {
            matches!(candidate.shape, Shape::Step { .. } | Shape::Lagged { .. } | Shape::Held { .. })
                && candidate.gain(&self.residual) > SUSPECT * SUSPECT
        };
        let errors = self.candidates.iter().filter(doubtful).map(|candidate| {
            let finding = self.finding(&candidate.shape, candidate.sizes(&self.residual)[0]);
            (finding.pbc_dps.abs(), finding.btc_dps_per_c.abs())
        });
        errors.fold((0.0, 0.0), |worst: (f64, f64), error| (worst.0.max(error.0), worst.1.max(error.1)))
    }

    /// Rms error of BTC by the curvature that is possible after this measurement. The curvature is a normal variable
    /// with the typical spread as its prior, and the error follows from its posterior mean and variance.
    fn curvature_error(&self) -> f64 {
        let Some(bent) = self.candidates.iter().find(|candidate| matches!(candidate.shape, Shape::Curved(_))) else {
            return 0.0;
        };
        let prior = self.question.curvature_dps_per_c2 * self.question.curvature_dps_per_c2;
        let column = &bent.columns[0];
        let mean = prior * dot(column, &self.residual);
        let variance = (prior - prior * prior * dot(column, column)).max(0.0);
        self.question.btc_error(&bent.shape).abs() * libm::sqrt(mean * mean + variance)
    }
}

/// A time of a step fits nearly as well as the best one if its gain is lower by less than this: the 95 % point of χ²
/// with one degree of freedom.
const NEARLY: f64 = 3.84;

/// The gain (decrease of χ²) from which a shape is beyond doubt, as measured on ordinary units
/// (docs/reference/accuracy.md).
fn alarm(shape: &Shape) -> f64 {
    match shape {
        Shape::Step { .. } => 22.0,
        Shape::Curved(_) => 12.0,
        Shape::Lagged { .. } | Shape::Held { .. } => 20.0,
        Shape::Oscillation { .. } => 28.0,
    }
}

/// The extra gain of a shape by its freedom alone: an oscillation may have any frequency and phase.
fn freedom(shape: &Shape) -> f64 {
    if matches!(shape, Shape::Oscillation { .. }) { alarm(shape) - alarm(&Shape::step(0.0)) } else { 0.0 }
}

impl SearchInput {
    fn deviation(&self, shape: &Shape, size: f64) -> Deviation {
        match *shape {
            Shape::Step { at_s, .. } => {
                let supply_mv = self.supply_dps_per_mv.map(|dps_per_mv| size.abs() / dps_per_mv);
                Deviation::Step { at_s, size_dps: size, supply_mv }
            }
            Shape::Curved(_) => Deviation::Curvature { dps_per_c2: size },
            Shape::Lagged { lag_s, .. } => Deviation::Lag { lag_s },
            Shape::Held { width_c, .. } => Deviation::Hysteresis { width_c },
            Shape::Oscillation { hz, .. } => Deviation::BaseMotion { hz, size_dps: size.abs() },
        }
    }

    /// Error of PBC by a shape of size 1.
    fn pbc_error(&self, shape: &Shape) -> f64 {
        let offset = &self.averages[2];
        shape.bias_at(offset.end_s) - shape.mean(offset.start_s, offset.end_s)
    }

    /// Error of BTC by a shape of size 1, per °C.
    fn btc_error(&self, shape: &Shape) -> f64 {
        let [first, second, _] = &self.averages;
        (shape.mean(first.start_s, first.end_s) - shape.mean(second.start_s, second.end_s)) / self.span_c
    }
}

/// A whitened shape that the rates may contain, made orthogonal to the columns of the model.
struct Candidate {
    shape: Shape,
    /// One column, or two for an oscillation, a quarter of a period apart.
    columns: Vec<Vec<f64>>,
    /// Sum of squares of the columns before anything was removed from them.
    full: f64,
}

impl Candidate {
    fn new(shape: Shape, windows: &[Window], whitener: &Cholesky) -> Self {
        let quarter = match shape {
            Shape::Oscillation { hz, phase } => Some(Shape::Oscillation { hz, phase: phase + PI / 2.0 }),
            _ => None,
        };
        let shapes = core::iter::once(&shape).chain(&quarter);
        let columns: Vec<Vec<f64>> = shapes.map(|shape| whitener.whiten(shape::means(shape, windows))).collect();
        let full = columns.iter().map(|column| dot(column, column)).sum();
        Self { shape, columns, full }
    }

    fn take_out(&mut self, unit: &[f64]) {
        self.columns.iter_mut().for_each(|column| gls::take_out(column, unit));
    }

    /// Decrease of the sum of squares by this shape. The decrease has a χ² distribution if the shape is absent.
    fn gain(&self, residual: &[f64]) -> f64 {
        let sizes = self.sizes(residual);
        self.columns.iter().zip(sizes).map(|(column, size)| size * dot(column, residual)).sum()
    }

    fn phase(&self, residual: &[f64]) -> f64 {
        let [sine, cosine] = self.sizes(residual);
        libm::atan2(cosine, sine)
    }

    /// Sizes of the columns. They are zero if the model explains nearly all of the columns.
    fn sizes(&self, residual: &[f64]) -> [f64; 2] {
        let a = &self.columns[0];
        let b = self.columns.get(1).unwrap_or(a);
        let (aa, ar) = (dot(a, a), dot(a, residual));
        if self.columns.len() == 1 {
            return if aa > 1e-9 * self.full { [ar / aa, 0.0] } else { [0.0; 2] };
        }
        let (bb, ab, br) = (dot(b, b), dot(a, b), dot(b, residual));
        let determinant = aa * bb - ab * ab;
        if determinant <= 1e-12 * self.full * self.full {
            return [0.0; 2];
        }
        [(ar * bb - br * ab) / determinant, (br * aa - ar * ab) / determinant]
    }
}

/// Adds the covariance of a shape whose size has the standard deviation `sd`.
fn add_square(covariances: &mut [Vec<f64>], column: &[f64], sd: f64) {
    for (row, a) in covariances.iter_mut().zip(column) {
        row.iter_mut().zip(column).for_each(|(covariance, b)| *covariance += sd * sd * a * b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::tests::Normal;

    /// A short version of the hour of F-51: 1000 s in which the part warms by 8 °C, with the white noise of F-02 and
    /// the rate that `add` gives for each second.
    fn record(seed: u32, add: impl Fn(f64) -> f64) -> Vec<Second> {
        let mut random = Normal(u64::from(seed) * 2 + 1);
        let second = |k: u32| {
            let at_s = f64::from(k);
            let temp_c = 33.0 - 8.0 * libm::exp(-at_s / 200.0);
            Second { at_s, rate_dps: 0.04 * temp_c + 0.0088 * random.next() + add(at_s), temp_c }
        };
        (0..1000).map(second).collect()
    }

    fn asked() -> SearchInput {
        let average = |start_s, end_s| WeightedMean { start_s, end_s, weight: 1.0 };
        SearchInput {
            averages: [average(0.0, 10.0), average(200.0, 210.0), average(850.0, 999.0)],
            span_c: 5.0,
            t3_c: 33.0,
            noise: crate::part::Axis::ADIS16130.typical_noise(),
            curvature_dps_per_c2: 0.0005,
            supply_dps_per_mv: Some(0.0002),
        }
    }

    fn strongest(add: impl Fn(f64) -> f64) -> Finding {
        findings(&record(7, add), &asked()).unwrap().found[0]
    }

    #[test]
    fn noise_alone_gives_no_finding() {
        for seed in 1..30 {
            let seen = findings(&record(seed, |_| 0.0), &asked()).unwrap();
            assert!(seen.found.is_empty() && !seen.unexplained, "seed {seed}: {seen:?}");
        }
        assert_eq!(findings(&record(1, |_| 0.0)[..30], &asked()), None);
    }

    /// A step of 0.04 °/s (200 mV of supply) shortly before the end of step 8 shifts PBC by its whole size. In the
    /// middle of step 8 it shifts PBC by half of its size, and before step 8 it does not shift PBC.
    #[test]
    fn a_step_is_found_up_to_the_end() {
        for (at, share) in [(997.0, 1.0), (925.0, 0.5), (300.0, 0.0)] {
            let finding = strongest(|at_s| if at_s >= at { 0.04 } else { 0.0 });
            let Deviation::Step { at_s, size_dps, .. } = finding.deviation else { panic!("{finding:?}") };
            assert!((at_s - at).abs() <= 3.0 && (size_dps - 0.04).abs() < 0.012, "{finding:?}");
            assert!((finding.pbc_dps / size_dps - share).abs() < 0.06, "{finding:?}");
        }
    }

    #[test]
    fn a_base_motion_is_found_with_its_period_and_size() {
        let finding = strongest(|at_s| 0.02 * libm::sin(2.0 * PI * 0.006 * at_s));
        let Deviation::BaseMotion { hz, size_dps } = finding.deviation else { panic!("{finding:?}") };
        assert!((hz - 0.006).abs() < 3e-4 && (size_dps - 0.02).abs() < 0.003, "{finding:?}");
    }

    #[test]
    fn a_gap_in_the_record_is_not_a_step() {
        let mut seconds = record(3, |_| 0.0);
        seconds.drain(400..520);
        assert_eq!(findings(&seconds, &asked()).unwrap().found, []);
    }
}
