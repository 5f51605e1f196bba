//! Several hypotheses about the bias, each with its probability: which of the quiet periods so far were rest, and
//! which were slow rotation.
//!
//! A quiet period splits each hypothesis in two. If the period was rest, its mean updates the bias. If it was
//! rotation, the bias stays. After the period, the closest hypotheses are merged until few are left. Later rests
//! lower the probability of a wrong hypothesis until it is dropped.

use super::filter::{Drift, Filter, Innovation};
use super::level::{self, RestPrior};
use libm::{expf, logf};

/// Number of hypotheses that are kept between two quiet periods.
const KEPT: usize = 4;
/// Probability below which a hypothesis is dropped.
const LEAST: f32 = 1e-4;
/// Information loss below which two hypotheses are merged even if there is room for both.
const SAME: f32 = 1e-3;
/// Exponent of the probabilities after each quiet period. It lets old evidence fade, because the rotations of a
/// platform need not be independent of each other.
const FADING: f32 = 0.97;

/// A mean over some windows of a quiet period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean {
    pub(super) rate_dps: f32,
    pub(super) d_c: f32,
    pub(super) length_s: f32,
}

/// The filter after a quiet period, if the period is rest.
#[derive(Clone, Copy, Debug)]
struct RestUpdate {
    filter: Filter,
    /// Sum over the seconds of the quiet period: the means less their expected values.
    innovation_dps_s: f32,
}

impl RestUpdate {
    fn take(&mut self, mean: &Mean, before: &Filter, drift: &Drift) {
        let &Mean { rate_dps, d_c, length_s } = mean;
        self.innovation_dps_s += before.innovation(rate_dps, length_s, d_c, drift).dps * length_s;
        self.filter.learn(rate_dps, length_s, d_c, drift);
    }
}

#[derive(Clone, Copy, Debug)]
struct Hypothesis {
    /// Probability before the quiet period. It is zero if the hypothesis is not used.
    weight: f32,
    before: Filter,
    /// The update without the newest windows, in which a rotation may have begun.
    sure: RestUpdate,
    now: RestUpdate,
    /// Joint probability of this hypothesis and of rest in the quiet period. `rotation` is the same for a rotation.
    rest: f32,
    rotation: f32,
}

impl Hypothesis {
    fn new(weight: f32, filter: &Filter) -> Self {
        let lesson = RestUpdate { filter: *filter, innovation_dps_s: 0.0 };
        Self { weight, before: *filter, sure: lesson, now: lesson, rest: 0.0, rotation: weight }
    }
}

/// A filter with its probability.
type Candidate = (f32, Filter);

/// The hypotheses, and the quiet period that they are about to explain.
#[derive(Clone, Copy, Debug)]
pub(super) struct HypothesisBank {
    hypotheses: [Hypothesis; KEPT],
    pub(super) rest_prior: RestPrior,
    /// Length of the quiet period as far as it was taken in, s.
    pub(super) seconds: f32,
    sure_s: f32,
    d_c: f32,
}

impl HypothesisBank {
    pub(super) fn new(filter: &Filter, rest_prior: RestPrior) -> Self {
        let mut hypotheses = [Hypothesis::new(0.0, filter); KEPT];
        hypotheses[0] = Hypothesis::new(1.0, filter);
        Self { hypotheses, rest_prior, seconds: 0.0, sure_s: 0.0, d_c: filter.at_c }
    }

    fn used(&mut self) -> impl Iterator<Item = &mut Hypothesis> {
        self.hypotheses.iter_mut().filter(|hypothesis| hypothesis.weight > 0.0)
    }

    fn filters(&mut self) -> impl Iterator<Item = &mut Filter> {
        self.used().flat_map(|it| [&mut it.before, &mut it.sure.filter, &mut it.now.filter])
    }

    pub(super) fn wait(&mut self, seconds: f64, drift: &Drift) {
        let passing = drift.over(seconds);
        self.filters().for_each(|filter| filter.wait(&passing));
    }

    pub(super) fn inflate_bias_variance(&mut self, u_dps: f64) {
        self.filters().for_each(|filter| filter.inflate_bias_variance(u_dps));
    }

    pub(super) fn take(&mut self, mean: &Mean, drift: &Drift) {
        self.used().for_each(|it| it.now.take(mean, &it.before, drift));
        self.seconds += mean.length_s;
        self.d_c = mean.d_c;
    }

    /// Takes in a mean that is old enough that no rotation can have begun in it.
    pub(super) fn make_sure(&mut self, mean: &Mean, drift: &Drift) {
        self.used().for_each(|it| it.sure.take(mean, &it.before, drift));
        self.sure_s += mean.length_s;
    }

    /// Drops what was learned from the newest windows, in which a rotation may have begun.
    pub(super) fn go_back(&mut self) {
        self.used().for_each(|it| it.now = it.sure);
        self.seconds = self.sure_s;
    }

    /// Computes the probabilities of rest and rotation under each hypothesis, from the mean rate of the whole quiet
    /// period.
    pub(super) fn judge(&mut self, least_turn_dps: f32, drift: &Drift) {
        let (length_s, d_c, prior) = (self.seconds, self.d_c, self.rest_prior.probability());
        let mut sum = 0.0;
        for it in self.used().filter(|_| length_s > 0.0) {
            let expected = it.before.innovation(0.0, length_s, d_c, drift);
            let seen = Innovation { dps: it.now.innovation_dps_s / length_s, ..expected };
            let (rest, rotation) = level::densities(&seen, least_turn_dps);
            (it.rest, it.rotation) = (it.weight * prior * rest, it.weight * (1.0 - prior) * rotation);
            sum += it.rest + it.rotation;
        }
        for it in self.used() {
            (it.rest, it.rotation) = if sum > 0.0 { (it.rest / sum, it.rotation / sum) } else { (0.0, it.weight) };
        }
    }

    /// Probability that the quiet period is rest. `None` without a mean of the period.
    pub(super) fn rest(&self) -> Option<f32> {
        (self.seconds > 0.0).then(|| self.hypotheses.iter().map(|it| it.rest).sum())
    }

    /// Merges all hypotheses into one filter.
    pub(super) fn known(&self) -> Filter {
        let (_, known) = self.candidates().into_iter().fold((0.0, self.hypotheses[0].before), united);
        known
    }

    /// Ends the quiet period. Splits each hypothesis into rest and rotation, and merges the closest ones.
    pub(super) fn close(&mut self, drift: &Drift) {
        if let Some(rest) = self.rest() {
            self.rest_prior.count(rest);
            let mut candidates = self.candidates().map(|(weight, filter)| (faded(weight), filter));
            let sum: f32 = candidates.iter().map(|(weight, _)| weight).sum();
            candidates.iter_mut().for_each(|(weight, _)| *weight /= sum);
            reduce(&mut candidates, self.d_c, drift);
            let mut left = candidates.iter().filter(|(weight, _)| *weight > 0.0);
            let unused = self.hypotheses[0].before;
            self.hypotheses = core::array::from_fn(|_| match left.next() {
                Some((weight, filter)) => Hypothesis::new(*weight, filter),
                None => Hypothesis::new(0.0, &unused),
            });
        }
        (self.seconds, self.sure_s) = (0.0, 0.0);
    }

    fn candidates(&self) -> [Candidate; 2 * KEPT] {
        core::array::from_fn(|at| {
            let it = &self.hypotheses[at % KEPT];
            if at < KEPT { (it.rotation, it.before) } else { (it.rest, it.now.filter) }
        })
    }
}

fn faded(weight: f32) -> f32 {
    if weight > LEAST { expf(FADING * logf(weight)) } else { 0.0 }
}

/// Merges two hypotheses into one with their mean and covariance.
fn united((weight, filter): Candidate, (more, other): Candidate) -> Candidate {
    let sum = weight + more;
    if more > 0.0 { (sum, filter.mixed(weight / sum, &other)) } else { (weight, filter) }
}

/// Merges the closest candidates until at most [`KEPT`] are left and a further merger would lose more than [`SAME`].
fn reduce(candidates: &mut [Candidate; 2 * KEPT], d_c: f32, drift: &Drift) {
    // each pass has one candidate less
    for _ in 0..candidates.len() {
        let used = candidates.iter().filter(|(weight, _)| *weight > 0.0).count();
        let Some((first, second, loss)) = closest(candidates, d_c, drift) else { return };
        if used <= KEPT && loss > SAME {
            return;
        }
        let [Some(one), Some(other)] = [first, second].map(|at| candidates.get(at).copied()) else { return };
        if let Some(place) = candidates.get_mut(first) {
            *place = united(one, other);
        }
        if let Some((weight, _)) = candidates.get_mut(second) {
            *weight = 0.0;
        }
    }
}

/// The pair whose merger loses the least information about the bias (Runnalls 2007, in one dimension), and the loss.
fn closest(candidates: &[Candidate; 2 * KEPT], d_c: f32, drift: &Drift) -> Option<(usize, usize, f32)> {
    let levels = candidates.map(|(weight, filter)| {
        let (dps, dps2) = filter.change(d_c, drift);
        (weight, dps, dps2, logf(dps2))
    });
    let used = || levels.iter().enumerate().filter(|(_, (weight, ..))| *weight > 0.0);
    let mut best = None;
    for (first, (a, a_dps, a_dps2, a_log)) in used() {
        for (second, (b, b_dps, b_dps2, b_log)) in used().skip_while(|(second, _)| *second <= first) {
            let (sum, apart_dps) = (a + b, a_dps - b_dps);
            let dps2 = (a * a_dps2 + b * b_dps2 + a * b / sum * apart_dps * apart_dps) / sum;
            let loss = 0.5 * (sum * logf(dps2) - a * a_log - b * b_log);
            if best.is_none_or(|(_, _, least)| loss < least) {
                best = Some((first, second, loss));
            }
        }
    }
    best
}
