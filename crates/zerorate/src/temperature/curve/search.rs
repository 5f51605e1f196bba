//! The search for the relevant models: strength of the noises, lag and play, and the shape of the series.

use super::LogMeans;
use super::evidence::{Columns, Model, PriorSpreads, Products, Record, SlowNoise, Solved};
use super::lag::{LagLikelihood, LagPrior};
use crate::temperature::filter::Filter;
use crate::temperature::follow::LagAndPlay;
use crate::temperature::model_averaging::log_sum;
use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

/// A model is relevant if its log evidence, with its prior, is lower than the best by less than this.
const NEGLIGIBLE: f64 = 6.0;
/// Number of lattice steps in a decade of noise.
const PER_DECADE: f64 = 4.0;
/// First and last lattice step of the bias instability B. At step 0, B equals the white noise of a mean.
const B_STEPS: (i32, i32) = (-4, 12);
/// First and last lattice step of the random walk K. At step 0, the walk over a log equals the white noise of a mean.
const K_STEPS: (i32, i32) = (-4, 16);
const SHORTEST_LAG_S: f64 = 3.0;
/// Longest lag that is tried: the smaller of a time, s, and a share of the longest log. It is at least 6 s.
const LONGEST_LAG: (f64, f64) = (600.0, 1.0 / 6.0);
const LEAST_PLAY_C: f64 = 0.05;
/// Largest play, as a share of the span. It is at least twice [`LEAST_PLAY_C`].
const MOST_PLAY: f64 = 0.125;
/// Largest ratio of each lag, or play, to the one before, until refinement.
const RATIO: f64 = 1.4;
/// Difference of the log evidence of two neighbours above which a value between them is tried.
const TOO_COARSE: f64 = 0.7;
/// Difference to the best log evidence within which values are refined.
const NEAR_BEST: f64 = 3.0;
/// Largest number of rounds of refinement.
const FINER_ROUNDS: usize = 6;
/// Number of rounds of the search. Each is over lag and play, and then over the noises.
const ROUNDS: usize = 2;

/// A point in the lattice of noises: the steps of B and of K.
type Place = (i32, i32);

/// The lags, plays and noises that the search has found.
struct Refined {
    lags: Vec<f64>,
    plays: Vec<f64>,
    /// The relevant noises, the best first.
    places: Vec<Place>,
    /// The best lag and play.
    following: LagAndPlay,
}

struct Search<'a> {
    record: &'a Record,
    lag: LagPrior<'a>,
    shapes: Vec<PriorSpreads>,
    /// B and K at step 0 of the lattice.
    units: SlowNoise,
    filters: BTreeMap<Place, Vec<Filter>>,
    /// The columns that were computed so far. Their key is the bits of lag and play.
    columns: BTreeMap<(u64, u64), Vec<Columns>>,
}

/// Returns the best model. `None` if none can be computed.
pub(super) fn best(record: &Record) -> Option<Model> {
    let mut search = Search::new(record, &[]);
    let Refined { places, following, .. } = search.refined()?;
    let models = search.models(*places.first()?, &following, 0.0);
    models.into_iter().max_by(|one, other| one.log_score.total_cmp(&other.log_score))
}

/// Returns the log evidence of a record under the noise of a model. It is the larger of two: with the lag and play of
/// the model, and without.
pub(super) fn log_evidence_like(record: &Record, model: &Model) -> f64 {
    let mut search = Search::new(record, &[]);
    let place = search.place(&model.noise);
    search.score(place, &model.following).max(search.score(place, &LagAndPlay::default()))
}

/// Returns the likelihood of the lag under the noise and the play of the best model.
pub(super) fn lag_likelihood(record: &Record, best: &Model) -> LagLikelihood {
    let mut search = Search::new(record, &[]);
    let (lags, _) = search.coarse();
    let place = search.place(&best.noise);
    LagLikelihood::new(search.finer(place, &best.following, lags, with_lag))
}

/// Returns all relevant models, without weights. The list is empty if no model can be computed.
pub(super) fn all(record: &Record, others: &[&LagLikelihood]) -> Vec<Model> {
    let mut search = Search::new(record, others);
    let Some(Refined { lags, plays, places, .. }) = search.refined() else { return Vec::new() };
    let shares = [shares(&lags, lag_ends_s(record)), shares(&plays, search.ends_c())];
    let followings = search.relevant(places[0], (&lags, &plays), &shares);
    let mut models: Vec<Model> = Vec::new();
    for place in places {
        for (following, log_prior) in &followings {
            models.extend(search.models(place, following, *log_prior));
        }
    }
    let without = search.log_evidence_without();
    models.iter_mut().for_each(|model| model.log_odds = model.log_score - without);
    models
}

fn with_lag(lag_s: f64, other: &LagAndPlay) -> LagAndPlay {
    LagAndPlay { lag_s, ..*other }
}

fn with_play(play_c: f64, other: &LagAndPlay) -> LagAndPlay {
    LagAndPlay { play_c, ..*other }
}

/// Gives each model its weight, and drops the models whose score is below the best by twice [`NEGLIGIBLE`] or more.
pub(super) fn weigh(models: &mut Vec<Model>) {
    let best = models.iter().map(|model| model.log_score).fold(f64::NEG_INFINITY, f64::max);
    models.retain(|model| model.log_score > best - 2.0 * NEGLIGIBLE);
    models.iter_mut().for_each(|model| model.weight = libm::exp(model.log_score - best));
    let total: f64 = models.iter().map(|model| model.weight).sum();
    models.iter_mut().for_each(|model| model.weight /= total);
}

/// Logarithms of the prior probabilities of the values: ½ for 0, and ½ spread evenly over the logarithm of the others.
/// A single value has the probability 1.
fn shares(values: &[f64], (least, most): (f64, f64)) -> Vec<f64> {
    if values.len() == 1 {
        return vec![0.0];
    }
    let middle = |k: usize| libm::sqrt(values[k] * values[k + 1]);
    let share = |k: usize| {
        let low = if k == 1 { least } else { middle(k - 1) };
        let high = if k + 1 == values.len() { most } else { middle(k) };
        libm::log(0.5 * (libm::log(high / low) / libm::log(most / least)).max(1e-9))
    };
    (0..values.len()).map(|k| if k == 0 { libm::log(0.5) } else { share(k) }).collect()
}

/// Returns 0, and values from `least` to `most` in about equal ratios.
fn spread((least, most): (f64, f64)) -> Vec<f64> {
    let count = libm::ceil(libm::log((most / least).max(1.0)) / libm::log(RATIO));
    let ratio = libm::pow(most / least, 1.0 / count.max(1.0));
    [0.0].into_iter().chain((0..=count as i32).map(|k| least * libm::pow(ratio, f64::from(k)))).collect()
}

/// The shortest and the longest lag that are tried, s.
fn lag_ends_s(record: &Record) -> (f64, f64) {
    (SHORTEST_LAG_S, longest_lag_s(&record.logs))
}

pub(super) fn longest_lag_s(logs: &[LogMeans]) -> f64 {
    let length_s = logs.iter().map(LogMeans::length_of_log_s).fold(0.0, f64::max);
    (length_s * LONGEST_LAG.1).clamp(2.0 * SHORTEST_LAG_S, LONGEST_LAG.0)
}

fn values(scored: Vec<(f64, f64)>) -> Vec<f64> {
    scored.into_iter().map(|(value, _)| value).collect()
}

impl<'a> Search<'a> {
    fn new(record: &'a Record, others: &'a [&'a LagLikelihood]) -> Self {
        let (white, length_s) = record.white_of_mean();
        let units = [white, white / libm::sqrt(length_s.max(1.0))];
        let lag = LagPrior::new(others, lag_ends_s(record));
        Self { record, lag, shapes: record.shapes(), units, filters: BTreeMap::new(), columns: BTreeMap::new() }
    }

    /// Returns the lattice point nearest to a noise.
    fn place(&self, noise: &SlowNoise) -> Place {
        let step = |k: usize| libm::round(PER_DECADE * libm::log10(noise[k] / self.units[k])) as i32;
        (step(0), step(1))
    }

    fn noise(&self, (b, k): Place) -> SlowNoise {
        let level = |unit: f64, step: i32| unit * libm::pow(10.0, f64::from(step) / PER_DECADE);
        [level(self.units[0], b), level(self.units[1], k)]
    }

    fn ends_c(&self) -> (f64, f64) {
        let (low_c, high_c) = self.record.series.span_c();
        (LEAST_PLAY_C, (MOST_PLAY * (high_c - low_c)).max(2.0 * LEAST_PLAY_C))
    }

    /// Returns the lags and plays with which the search begins.
    fn coarse(&self) -> (Vec<f64>, Vec<f64>) {
        let plays = if self.record.two_directions { spread(self.ends_c()) } else { vec![0.0] };
        let lags = if self.record.without_lag { vec![0.0] } else { spread(lag_ends_s(self.record)) };
        (lags, plays)
    }

    /// Refines lags and plays, and finds the relevant noises.
    fn refined(&mut self) -> Option<Refined> {
        let (mut lags, mut plays) = self.coarse();
        let (mut place, mut following) = self.coarse_best(&lags, &plays)?;
        let mut places = vec![place];
        for _ in 0..ROUNDS {
            lags = values(self.finer(place, &following, lags, with_lag));
            plays = values(self.finer(place, &following, plays, with_play));
            let each =
                lags.iter().flat_map(|lag_s| plays.iter().map(|play_c| LagAndPlay { lag_s: *lag_s, play_c: *play_c }));
            following = self.best_pair(&[place], &each.collect::<Vec<_>>())?.1;
            places = self.noises(place, &following);
            place = places[0];
        }
        Some(Refined { lags, plays, places, following })
    }

    /// Searches coarsely for the best noise, lag and play. A wrong lag looks like a strong random walk, so each
    /// lag is tried under weak walks too.
    fn coarse_best(&mut self, lags: &[f64], plays: &[f64]) -> Option<(Place, LagAndPlay)> {
        let decades = |(first, last): (i32, i32)| (first..=last).step_by(PER_DECADE as usize);
        let at_once = [LagAndPlay::default()];
        let all: Vec<Place> = decades(B_STEPS).flat_map(|b| decades(K_STEPS).map(move |k| (b, k))).collect();
        let ((b, _), _) = self.best_pair(&all, &at_once)?;
        let walks: Vec<Place> = decades(K_STEPS).map(|k| (b, k)).collect();
        let late: Vec<LagAndPlay> = lags.iter().map(|lag_s| LagAndPlay { lag_s: *lag_s, play_c: 0.0 }).collect();
        let (place, following) = self.best_pair(&walks, &late)?;
        let with_plays: Vec<LagAndPlay> = plays.iter().map(|play_c| with_play(*play_c, &following)).collect();
        let (_, following) = self.best_pair(&[place], &with_plays)?;
        self.best_pair(&all, &[following])
    }

    /// The noise, and the lag and play, with the highest score. `None` if no score can be computed.
    fn best_pair(&mut self, places: &[Place], followings: &[LagAndPlay]) -> Option<(Place, LagAndPlay)> {
        let mut best = (f64::NEG_INFINITY, None);
        for pair in places.iter().flat_map(|place| followings.iter().map(move |following| (*place, *following))) {
            let score = self.score(pair.0, &pair.1);
            if score > best.0 {
                best = (score, Some(pair));
            }
        }
        best.1
    }

    fn products(&mut self, place: Place, following: &LagAndPlay) -> Option<Products> {
        let noise = self.noise(place);
        let record = self.record;
        let filters = self.filters.entry(place).or_insert_with(|| record.filters(&noise));
        let key = (following.lag_s.to_bits(), following.play_c.to_bits());
        let columns = self.columns.entry(key).or_insert_with(|| record.all_columns(following));
        Record::products(filters, columns)
    }

    /// Log evidence over all prior spreads, with the factor of the other axes for the lag.
    fn score(&mut self, place: Place, following: &LagAndPlay) -> f64 {
        let Some(products) = self.products(place, following) else { return f64::NEG_INFINITY };
        let score = |shape: &PriorSpreads| {
            let log_prior = self.record.log_prior(shape, following)?;
            Some(log_prior + self.record.solve_shape(&products, shape)?.log_evidence)
        };
        let scores: Vec<f64> = self.shapes.iter().filter_map(score).collect();
        log_sum(&scores) + self.lag.log_factor(following.lag_s)
    }

    /// Adds values near the best one, between neighbours whose evidence differs too much. Returns each value with its
    /// score.
    fn finer(
        &mut self,
        place: Place,
        best: &LagAndPlay,
        values: Vec<f64>,
        with: impl Fn(f64, &LagAndPlay) -> LagAndPlay,
    ) -> Vec<(f64, f64)> {
        let mut scored: Vec<(f64, f64)> =
            values.into_iter().map(|value| (value, self.score(place, &with(value, best)))).collect();
        for _ in 0..FINER_ROUNDS {
            let top = scored.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
            let is_coarse = |pair: &&[(f64, f64)]| {
                let matters = pair[0].1.max(pair[1].1) > top - NEAR_BEST;
                // no value is tried between 0 and the least one
                matters && (pair[0].1 - pair[1].1).abs() > TOO_COARSE && pair[0].0 > 0.0
            };
            let middles: Vec<f64> =
                scored.windows(2).filter(is_coarse).map(|pair| libm::sqrt(pair[0].0 * pair[1].0)).collect();
            if middles.is_empty() {
                break;
            }
            scored.extend(middles.into_iter().map(|value| (value, self.score(place, &with(value, best)))));
            scored.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        }
        scored
    }

    /// Returns the relevant noises, the best first, or `start` if there are none. The search goes from `start` to the
    /// neighbours of relevant noises.
    fn noises(&mut self, start: Place, following: &LagAndPlay) -> Vec<Place> {
        let mut scores: BTreeMap<Place, f64> = BTreeMap::new();
        let mut open = vec![start];
        let mut best = f64::NEG_INFINITY;
        while let Some(place) = open.pop() {
            let (b, k) = place;
            let is_inside = (B_STEPS.0..=B_STEPS.1).contains(&b) && (K_STEPS.0..=K_STEPS.1).contains(&k);
            if !is_inside || scores.contains_key(&place) {
                continue;
            }
            let score = self.score(place, following);
            scores.insert(place, score);
            best = best.max(score);
            if score > best - NEGLIGIBLE {
                open.extend([(b - 1, k), (b + 1, k), (b, k - 1), (b, k + 1)]);
            }
        }
        let mut all: Vec<(Place, f64)> = scores.into_iter().filter(|(_, score)| *score > best - NEGLIGIBLE).collect();
        all.sort_unstable_by(|one, other| other.1.total_cmp(&one.1));
        if all.is_empty() { vec![start] } else { all.into_iter().map(|(place, _)| place).collect() }
    }

    /// The relevant pairs of lag and play under a noise, with the logarithms of their prior probabilities.
    fn relevant(
        &mut self,
        place: Place,
        (lags, plays): (&[f64], &[f64]),
        shares: &[Vec<f64>; 2],
    ) -> Vec<(LagAndPlay, f64)> {
        let mut all = Vec::new();
        for (lag_s, of_lag) in lags.iter().zip(&shares[0]) {
            for (play_c, of_play) in plays.iter().zip(&shares[1]) {
                let following = LagAndPlay { lag_s: *lag_s, play_c: *play_c };
                all.push((following, of_lag + of_play, self.score(place, &following)));
            }
        }
        let best = all.iter().map(|(_, prior, score)| prior + score).fold(f64::NEG_INFINITY, f64::max);
        all.retain(|(_, prior, score)| prior + score > best - NEGLIGIBLE);
        all.into_iter().map(|(following, prior, _)| (following, prior)).collect()
    }

    /// Returns a model for each relevant set of prior spreads.
    fn models(&mut self, place: Place, following: &LagAndPlay, log_prior: f64) -> Vec<Model> {
        let Some(products) = self.products(place, following) else { return Vec::new() };
        let noise = self.noise(place);
        let solve = |shape: &PriorSpreads| {
            let of_shape = self.record.log_prior(shape, following)?;
            let solved = self.record.solve_shape(&products, shape)?;
            Some((*shape, solved.log_evidence + of_shape, solved))
        };
        let solved: Vec<_> = self.shapes.iter().filter_map(solve).collect();
        let best = solved.iter().map(|(_, score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
        let relevant = solved.iter().filter(|(_, score, _)| *score > best - NEGLIGIBLE);
        let model = |(shape, score, solved): &(PriorSpreads, f64, Solved)| {
            let mut model = self.record.model(solved, (noise, *following, *shape));
            model.log_score = score + log_prior + self.lag.log_factor(following.lag_s);
            model
        };
        relevant.map(model).collect()
    }

    /// Largest log evidence of a bias that does not depend on the temperature, over a coarse lattice of noises and the
    /// fine lattice around the best coarse point.
    fn log_evidence_without(&mut self) -> f64 {
        let (bs, ks) = ((B_STEPS.0..=B_STEPS.1).step_by(4), (K_STEPS.0..=K_STEPS.1).step_by(2));
        let mut best = (f64::NEG_INFINITY, (0, 0));
        for place in bs.flat_map(|b| ks.clone().map(move |k| (b, k))) {
            best = self.better_without(best, place);
        }
        let (b, k) = best.1;
        for place in (b - 2..=b + 2).flat_map(|b| (k - 1..=k + 1).map(move |k| (b, k))) {
            best = self.better_without(best, place);
        }
        best.0
    }

    /// The better one of `best` and the place, by the evidence of a bias that does not depend on the temperature.
    fn better_without(&mut self, best: (f64, Place), place: Place) -> (f64, Place) {
        let Some(products) = self.products(place, &LagAndPlay::default()) else { return best };
        let of = |shape: &PriorSpreads| self.record.log_evidence_without(&products, shape);
        let score = self.shapes.first().and_then(of);
        score.filter(|score| *score > best.0).map_or(best, |score| (score, place))
    }
}
