//! Averaging over all combinations of unknowns that are not coefficients: the strength of the slow noises, the lag and
//! the play of the bias, and which steps and base motion are real. Only relevant combinations are kept.

use super::base_motion::{self, Candidate};
use super::filter::{Filter, White};
use super::posterior::{Columns, Posterior, Record};
use super::{Assumed, LagAndPlay, Noise};
use crate::noise::NoiseModel;
use crate::part::Axis;
use alloc::vec::Vec;

/// A combination is relevant if its log evidence, with its prior, is lower than the best by less than this.
const NEGLIGIBLE: f64 = 5.0;
/// Ratio of each lag that is tried to the one before.
const LAG_RATIO: f64 = 1.25;
const SHORTEST_LAG_S: f64 = 2.0;
/// Ratio of each play that is tried to the one before.
const PLAY_RATIO: f64 = 2.0;
/// Smallest half width of play that is tried, °C.
const LEAST_PLAY_C: f64 = 0.0125;
/// Ratio of each bias instability B that is tried to the one before.
const B_RATIO: f64 = core::f64::consts::SQRT_2;
/// Ratio of each random walk K that is tried to the one before. A recording determines K less well than B.
const K_RATIO: f64 = 2.0;
/// Number of finer lattice steps that replace a step between two plays.
const FINER_PLAYS: i32 = 8;
/// Largest number of times that plays are made finer.
const FINER_ROUNDS: i32 = 2;
/// Largest number of lattice steps of noise, up and down, that are tried.
const NOISE_REACH: i32 = 20;
/// Prior standard deviation of ln B and ln K from one specimen of the part to another, if the part states typical
/// values.
const TYPICAL_SPREAD: [f64; 2] = [0.35, 0.5];
/// Prior standard deviation of ln B and ln K, if the part states no typical values.
const UNKNOWN_SPREAD: [f64; 2] = [1.0, 1.5];
/// Prior probability of a step in a recording.
const STEP_PROBABILITY: f64 = 0.02;

/// One combination of the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hypothesis {
    pub(super) noise: Noise,
    pub(super) following: LagAndPlay,
    /// Number of steps in the model: the strongest of the suspected steps.
    pub(super) steps: usize,
    /// Frequency of the base motion, Hz, if there is one.
    pub(super) motion_hz: Option<f64>,
    log_prior: f64,
}

/// A model with its weight, which is its posterior probability. The weights of all models add up to 1.
pub(super) struct Weighed {
    pub(super) weight: f64,
    pub(super) hypothesis: Hypothesis,
    pub(super) posterior: Posterior,
}

/// Returns all relevant models with their weights. The list is empty if no model can be computed.
pub(super) fn weigh(record: &Record<'_>, assumed: &Assumed<'_>) -> Vec<Weighed> {
    let lattice = Lattice::new(record, assumed);
    let (mut noises, mut paths) = (Vec::from([(0, 0)]), Vec::from([Path::default()]));
    for _ in 0..ROUNDS {
        paths = lattice.relevant_paths(noises[0]);
        let Some(best) = paths.first() else { return Vec::new() };
        noises = lattice.relevant_noises(best);
    }
    let mut models = Vec::new();
    for noise in &noises {
        let filter = lattice.filter(*noise);
        models.extend(paths.iter().flat_map(|path| lattice.models(&filter, *noise, path)));
    }
    let best = models.iter().map(score).fold(f64::NEG_INFINITY, f64::max);
    models.iter_mut().for_each(|model| model.weight = libm::exp(score(model) - best));
    let total: f64 = models.iter().map(|model| model.weight).sum();
    models.iter_mut().for_each(|model| model.weight /= total);
    models
}

/// The model of the highest order under the typical noise, for a bias that follows without lag.
pub(super) fn typical(record: &Record<'_>, assumed: &Assumed<'_>) -> Option<Weighed> {
    let lattice = Lattice::new(record, assumed);
    let model = lattice.models(&lattice.filter((0, 0)), (0, 0), &Path::default()).last()?;
    Some(Weighed { weight: 1.0, ..model })
}

/// Prior spread over units of the logarithms of B and K.
pub(super) fn spread(axis: &Axis) -> [f64; 2] {
    if axis.noise.is_some() { TYPICAL_SPREAD } else { UNKNOWN_SPREAD }
}

/// Rounds of the search. Each chooses the paths under the noise, and then the noise on the best path. After these
/// rounds nothing changes.
const ROUNDS: usize = 2;

fn score(model: &Weighed) -> f64 {
    model.posterior.log_evidence + model.hypothesis.log_prior
}

/// A hypothesis about the temperature that the bias follows, the number of steps, and the base motion.
#[derive(Clone, Copy, Debug, Default)]
struct Path {
    following: LagAndPlay,
    steps: usize,
    motion: Option<Candidate>,
    /// Logarithm of the number of finer plays that share the prior probability of one play of the lattice.
    log_finer: f64,
}

struct Lattice<'a> {
    record: &'a Record<'a>,
    /// The noise at the middle of the lattice.
    noise: NoiseModel,
    spread: [f64; 2],
    gauss_markov: &'a [(f64, f64)],
    paths: Vec<Path>,
    lags: usize,
    motions_hz: &'a [f64],
}

impl<'a> Lattice<'a> {
    fn new(record: &'a Record<'a>, assumed: &Assumed<'a>) -> Self {
        let white_dps_per_rt_hz = assumed.white_dps_per_rt_hz;
        let spread = spread(assumed.axis);
        let typical = assumed.axis.noise.map_or(unknown(white_dps_per_rt_hz), |noise| noise.model());
        let lags = lags(record);
        let plays = plays(record);
        let followings = lags
            .iter()
            .flat_map(|lag_s| plays.iter().map(move |play_c| LagAndPlay { lag_s: *lag_s, play_c: *play_c }));
        let steps = record.steps_s.len();
        Self {
            record,
            noise: NoiseModel { white_dps_per_rt_hz, ..typical },
            spread,
            gauss_markov: assumed.gauss_markov,
            paths: followings
                .flat_map(|following| (0..=steps).map(move |steps| Path { following, steps, ..Path::default() }))
                .collect(),
            lags: lags.len(),
            motions_hz: assumed.motions_hz,
        }
    }

    /// The relevant paths under a noise, the best first.
    fn relevant_paths(&self, noise: (i32, i32)) -> Vec<Path> {
        let filter = self.filter(noise);
        let still: Vec<(f64, Path)> =
            self.paths.iter().map(|path| (self.score(&filter, noise, path), *path)).collect();
        let still = self.finer_plays(&filter, noise, still);
        let with_motion = self.paths_with_motion(&filter, noise, &still);
        relevant_families(still, with_motion)
    }

    /// Adds finer plays about the best path if its neighbours explain much less. A wide play that lies between two
    /// plays of the lattice looks like a lag.
    fn finer_plays(&self, filter: &Filter, noise: (i32, i32), mut scored: Vec<(f64, Path)>) -> Vec<(f64, Path)> {
        let mut ratio = PLAY_RATIO;
        for round in 1..=FINER_ROUNDS {
            let Some(&(best, path)) = scored.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            let play_c = path.following.play_c;
            let with = |one: &Path, play_c: f64, log_finer: f64| {
                let path = Path { following: LagAndPlay { play_c, ..one.following }, log_finer, ..*one };
                (self.score(filter, noise, &path), path)
            };
            let is_worse = |play_c: f64| with(&path, play_c, path.log_finer).0 < best - NEGLIGIBLE;
            if play_c <= 0.0 || !is_worse(play_c * ratio) || !is_worse(play_c / ratio) {
                break;
            }
            ratio = libm::pow(ratio, 1.0 / f64::from(FINER_PLAYS));
            let log_finer = f64::from(round) * libm::log(f64::from(FINER_PLAYS));
            let finer = (1 - FINER_PLAYS..FINER_PLAYS).filter(|k| *k != 0);
            let plays: Vec<f64> = finer.map(|k| play_c * libm::pow(ratio, f64::from(k))).collect();
            // for every lag, since the best one may change with the play
            let lags = self.paths.iter().filter(|one| one.steps == path.steps && one.following.play_c == 0.0);
            scored.extend(lags.flat_map(|one| plays.iter().map(|play_c| with(one, *play_c, log_finer))));
        }
        scored
    }

    /// Scores the paths with a base motion: refines the frequencies on the best path, drops negligible ones, and pairs
    /// each relevant path with each frequency that is left. Returns nothing if base motion explains too little.
    fn paths_with_motion(&self, filter: &Filter, noise: (i32, i32), still: &[(f64, Path)]) -> Vec<(f64, Path)> {
        let coarse = self.paired(filter, noise, &self.paths, &base_motion::of(self.motions_hz));
        let Some(best) = coarse.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)) else { return Vec::new() };
        if evidence(&coarse) < evidence(still) - NEGLIGIBLE {
            return Vec::new();
        }
        let on_best = |hz: &[f64]| -> Vec<f64> {
            let motions: Vec<Candidate> = hz.iter().map(|hz| Candidate { hz: *hz, log_prior: 0.0 }).collect();
            self.paired(filter, noise, &[best.1], &motions).into_iter().map(|(score, _)| score).collect()
        };
        let refined = base_motion::of(&base_motion::refined(self.motions_hz, on_best));
        let finer = relevant(self.paired(filter, noise, &[best.1], &refined));
        let motions: Vec<Candidate> = finer.iter().filter_map(|path| path.motion).collect();
        let paths = relevant(self.paired(filter, noise, &self.paths, &motions[..motions.len().min(1)]));
        self.paired(filter, noise, &paths, &motions)
    }

    fn paired(&self, filter: &Filter, noise: (i32, i32), paths: &[Path], motions: &[Candidate]) -> Vec<(f64, Path)> {
        let whites: Vec<Vec<White>> = motions.iter().map(|motion| self.record.motion(filter, motion.hz)).collect();
        let with = |path: &Path| -> Vec<(f64, Path)> {
            let columns = self.record.columns(filter, path.following, path.steps);
            let one = |(motion, white): (&Candidate, &Vec<White>)| {
                let path = Path { motion: Some(*motion), ..*path };
                (self.score_of(filter, noise, &path, &columns, white), path)
            };
            motions.iter().zip(&whites).map(one).collect()
        };
        if motions.is_empty() { Vec::new() } else { paths.iter().flat_map(with).collect() }
    }

    /// The relevant noises on a path, the best first. The search begins at the middle of the lattice, and tries the
    /// neighbours of each relevant noise.
    fn relevant_noises(&self, path: &Path) -> Vec<(i32, i32)> {
        let score = |noise| self.score(&self.filter(noise), noise, path);
        let mut known: Vec<(f64, (i32, i32))> = Vec::from([(score((0, 0)), (0, 0))]);
        let mut open = 0;
        while open < known.len() {
            let (here, (b, k)) = known[open];
            let best = known.iter().map(|(score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
            open += 1;
            if here < best - NEGLIGIBLE {
                continue;
            }
            for next in [(b - 1, k), (b + 1, k), (b, k - 1), (b, k + 1)] {
                let inside = next.0.abs() <= NOISE_REACH && next.1.abs() <= NOISE_REACH;
                if inside && known.iter().all(|(_, seen)| *seen != next) {
                    known.push((score(next), next));
                }
            }
        }
        relevant(known)
    }

    fn filter(&self, noise: (i32, i32)) -> Filter {
        Filter::new(&self.noise(noise), self.record.blocks)
    }

    fn score(&self, filter: &Filter, noise: (i32, i32), path: &Path) -> f64 {
        let columns = self.record.columns(filter, path.following, path.steps);
        let motion = path.motion.map(|motion| self.record.motion(filter, motion.hz)).unwrap_or_default();
        self.score_of(filter, noise, path, &columns, &motion)
    }

    fn score_of(&self, filter: &Filter, noise: (i32, i32), path: &Path, columns: &Columns, motion: &[White]) -> f64 {
        let log_prior = self.log_prior(noise, path);
        let evidences = self.record.log_evidences(filter, columns, motion).into_iter();
        log_sum(&evidences.map(|log_evidence| log_evidence + log_prior).collect::<Vec<f64>>())
    }

    /// Computes a model for each order of the polynomial. They have no weights yet.
    fn models(&self, filter: &Filter, noise: (i32, i32), path: &Path) -> impl Iterator<Item = Weighed> + use<> {
        let columns = self.record.columns(filter, path.following, path.steps);
        let motion = path.motion.map(|motion| self.record.motion(filter, motion.hz)).unwrap_or_default();
        let hypothesis = self.hypothesis(noise, path);
        let posteriors = self.record.posteriors(filter, &columns, &motion).into_iter();
        posteriors.map(move |posterior| Weighed { weight: 0.0, hypothesis: hypothesis.clone(), posterior })
    }

    fn noise(&self, (b, k): (i32, i32)) -> Noise {
        Noise {
            white_dps_per_rt_hz: self.noise.white_dps_per_rt_hz,
            bias_instability_dps: self.noise.bias_instability_dps * libm::pow(B_RATIO, f64::from(b)),
            rate_random_walk_dps_per_rt_s: self.noise.rate_random_walk_dps_per_rt_s * libm::pow(K_RATIO, f64::from(k)),
            gauss_markov: self.gauss_markov.to_vec(),
        }
    }

    fn hypothesis(&self, noise: (i32, i32), path: &Path) -> Hypothesis {
        let (motion_hz, log_prior) = (path.motion.map(|motion| motion.hz), self.log_prior(noise, path));
        Hypothesis { noise: self.noise(noise), following: path.following, steps: path.steps, motion_hz, log_prior }
    }

    fn log_prior(&self, (b, k): (i32, i32), path: &Path) -> f64 {
        let off = |index: i32, ratio: f64, spread: f64| {
            let sds = f64::from(index) * libm::log(ratio) / spread;
            -0.5 * sds * sds
        };
        let late = if path.following.lag_s > 0.0 { 0.5 / (self.lags - 1) as f64 } else { 0.5 };
        let step = libm::log(STEP_PROBABILITY / self.record.blocks.len() as f64);
        let noise = off(b, B_RATIO, self.spread[0]) + off(k, K_RATIO, self.spread[1]);
        let moving = path.motion.map_or(0.0, |motion| motion.log_prior);
        noise + libm::log(late) + step * path.steps as f64 + moving - path.log_finer
    }
}

/// Slow noises of usual MEMS gyroscopes, if the part states none. In the Allan deviation, the flicker equals the white
/// noise at some 50 s, and the random walk at some 300 s.
fn unknown(white_dps_per_rt_hz: f64) -> NoiseModel {
    NoiseModel {
        white_dps_per_rt_hz,
        bias_instability_dps: 0.15 * white_dps_per_rt_hz,
        rate_random_walk_dps_per_rt_s: 4e-3 * white_dps_per_rt_hz,
    }
}

/// Returns the lags to try: 0, and from 2 s to a quarter of the recording.
fn lags(record: &Record<'_>) -> Vec<f64> {
    core::iter::once(0.0).chain(geometric(SHORTEST_LAG_S, record.length_s() / 4.0, LAG_RATIO)).collect()
}

/// Returns the plays to try: 0, and up to half of the span, at which the bias hardly follows.
fn plays(record: &Record<'_>) -> Vec<f64> {
    core::iter::once(0.0).chain(geometric(LEAST_PLAY_C, record.basis.half_span_c, PLAY_RATIO)).collect()
}

/// Values from `first` to below `end`, each `ratio` times the one before.
pub(crate) fn geometric(first: f64, end: f64, ratio: f64) -> impl Iterator<Item = f64> {
    core::iter::successors(Some(first), move |value| Some(value * ratio)).take_while(move |value| *value < end)
}

/// Keeps the items whose score is not negligible, the best first.
fn relevant<T>(mut scored: Vec<(f64, T)>) -> Vec<T> {
    scored.retain(|(score, _)| score.is_finite());
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = scored.first().map_or(0.0, |(score, _)| *score);
    scored.into_iter().take_while(|(score, _)| *score > best - NEGLIGIBLE).map(|(_, value)| value).collect()
}

/// Keeps the items of two families that are not negligible in their own family, the best first. A family is left
/// out only as a whole, since many small items may add up.
fn relevant_families<T>(one: Vec<(f64, T)>, other: Vec<(f64, T)>) -> Vec<T> {
    let evidences = [evidence(&one), evidence(&other)];
    let best = evidences[0].max(evidences[1]);
    let family = |items: Vec<(f64, T)>, evidence: f64| {
        let most = items.iter().map(|(score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
        items.into_iter().filter(move |(score, _)| evidence >= best - NEGLIGIBLE && *score > most - NEGLIGIBLE)
    };
    let mut all: Vec<(f64, T)> = family(one, evidences[0]).chain(family(other, evidences[1])).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, item)| item).collect()
}

/// ln Σ exp of the scores.
fn evidence<T>(scored: &[(f64, T)]) -> f64 {
    log_sum(&scored.iter().map(|(score, _)| *score).collect::<Vec<f64>>())
}

/// Returns ln Σ exp of the values: −∞ if there are none.
pub(super) fn log_sum(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + libm::log(values.iter().map(|value| libm::exp(value - most)).sum())
}
