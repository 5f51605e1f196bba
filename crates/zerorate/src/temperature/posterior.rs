//! One model of a recording: its bias, and how well it explains the rates.

use super::basis::Basis;
use super::filter::{Filter, Filtered, White, Whites};
use super::follow::Held;
use super::gls::whitener;
use super::{Block, LagAndPlay, TERMS};
use alloc::vec::Vec;
use core::f64::consts::PI;
use zerorate_allan::linear::Cholesky;

/// Coefficients in powers of T − T3.
pub(super) type Powers = [f64; TERMS];

/// The bias at the end of the recording over temperature, by one model.
#[derive(Clone, Debug)]
pub(super) struct Posterior {
    pub(super) order: usize,
    /// Logarithm of the evidence: the density of the rates under this model.
    pub(super) log_evidence: f64,
    pub(super) bias: Powers,
    pub(super) covariance: [Powers; TERMS],
    /// Size of each step, °/s, and its variance, (°/s)².
    pub(super) steps: Vec<(f64, f64)>,
    /// Sine and cosine of the base motion, °/s. They are zero if the model has none.
    pub(super) motion_dps: [f64; 2],
    /// Part of the variance of each coefficient that would vanish if the base motion were known.
    pub(super) from_motion: Powers,
}

/// The whitened columns of a model without base motion: the rates, the polynomials and the steps.
pub(super) struct Columns {
    whites: Whites,
    held: Held,
    steps: usize,
}

/// The blocks of a recording, and the assumptions that all models of it share.
pub(super) struct Record<'a> {
    pub(super) blocks: &'a [Block],
    pub(super) basis: &'a Basis,
    /// Times of the suspected steps, s.
    pub(super) steps_s: &'a [f64],
    pub(super) t3_c: f64,
    /// Prior standard deviations of the coefficients of the basis, °/s, by degree. Degree 0 has no prior.
    pub(super) prior_dps: [f64; TERMS],
    pub(super) max_order: usize,
}

/// Prior spread of a step, °/s: the effect of a supply that changes by some tenths of a volt (F-01).
const STEP_DPS: f64 = 0.05;
#[derive(Clone, Copy)]
struct Spread {
    /// The bend of the bias over temperature, as a ratio of the typical one.
    bend: f64,
    /// The sine and the cosine of a base motion, °/s.
    motion_dps: f64,
    /// Logarithm of the probability of this spread.
    log_share: f64,
}

/// Bends, as ratios of the typical one, and the shares of units with such a bend, the typical one last. Without
/// the strong bends as a prior, a slow base motion would explain them better.
const BENDS: [(f64, f64); 2] = [(8.0, 0.1), (1.0, 0.9)];
/// Sizes of a base motion, °/s. Small and large ones are equally likely. Without the small ones as a prior, the
/// random walk of the part would explain small motions better.
const BASE_MOTIONS_DPS: [f64; 3] = [0.01, 0.03, 0.1];

/// The spreads that are tried for the columns of an order, with a base motion or without.
fn spreads(order: usize, has_motion: bool) -> impl Iterator<Item = Spread> {
    let bends = if order < 2 { &[(1.0, 1.0)][..] } else { &BENDS };
    let motions_dps = if has_motion { &BASE_MOTIONS_DPS[..] } else { &[1.0] };
    let count = motions_dps.len() as f64;
    let spread = move |&(bend, share): &(f64, f64), motion_dps: f64| Spread {
        bend,
        motion_dps,
        log_share: libm::log(share / count),
    };
    bends.iter().flat_map(move |bend| motions_dps.iter().map(move |motion_dps| spread(bend, *motion_dps)))
}

impl Record<'_> {
    pub(super) fn length_s(&self) -> f64 {
        self.blocks.first().zip(self.blocks.last()).map_or(0.0, |(first, last)| last.end_s() - first.start_s)
    }

    pub(super) fn span_c(&self) -> (f64, f64) {
        let temps = self.blocks.iter().map(|block| block.temp_c);
        temps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), temp_c| (low.min(temp_c), high.max(temp_c)))
    }

    /// The whitened columns of a bias with this lag and play, and with this number of steps.
    pub(super) fn columns(&self, filter: &Filter, following: LagAndPlay, steps: usize) -> Columns {
        let (followed, held) = following.temps_c(self.blocks);
        let rates = self.blocks.iter().map(|block| block.rate_dps).collect();
        let polynomial = |degree| followed.iter().map(|temp_c| self.basis.at(degree, *temp_c)).collect();
        let step = |at_s: &f64| self.blocks.iter().map(|block| block.share_after(*at_s)).collect();
        let degrees = (0..=self.max_order).map(polynomial);
        let steps_s = self.steps_s[..steps].iter().map(step);
        let series: Vec<Vec<f64>> = core::iter::once(rates).chain(degrees).chain(steps_s).collect();
        Columns { whites: filter.whites(&series), held, steps }
    }

    /// The columns of a base motion: its sine and its cosine.
    pub(super) fn motion(&self, filter: &Filter, hz: f64) -> Vec<White> {
        let phases = || self.blocks.iter().map(|block| 2.0 * PI * hz * block.middle_s());
        filter.whiten(&[phases().map(libm::sin).collect(), phases().map(libm::cos).collect()])
    }

    /// The posteriors of all orders, with these columns of a base motion.
    pub(super) fn posteriors(&self, filter: &Filter, columns: &Columns, motion: &[White]) -> Vec<Posterior> {
        let Some(filtered) = filter.filtered(&columns.whites, motion) else { return Vec::new() };
        let constants = self.constants(&filtered, columns.steps, columns.held);
        self.all_solved(&filtered, columns.steps).map(|solved| solved.posterior(&filtered, &constants)).collect()
    }

    /// Returns only the log evidence of each order, which takes less time than the posteriors.
    pub(super) fn log_evidences(&self, filter: &Filter, columns: &Columns, motion: &[White]) -> Vec<f64> {
        let Some(filtered) = filter.filtered(&columns.whites, motion) else { return Vec::new() };
        self.all_solved(&filtered, columns.steps).map(|solved| solved.log_evidence).collect()
    }

    fn all_solved(&self, filtered: &Filtered, steps: usize) -> impl Iterator<Item = Solved> {
        let has_motion = filtered.gram.len() > self.max_order + 2 + steps;
        let all =
            (0..=self.max_order).flat_map(move |order| spreads(order, has_motion).map(move |spread| (order, spread)));
        all.filter_map(move |(order, spread)| self.solved(order, spread, filtered, steps))
    }

    /// Contribution of one unit of each column to the bias at the end, in powers of T − T3. The column's share of
    /// the random walk is subtracted, and the effect of the play at the end is included.
    fn constants(&self, filtered: &Filtered, steps: usize, held: Held) -> Vec<Powers> {
        let polynomial = |degree| {
            let mut powers = self.basis.about(degree, self.t3_c);
            powers[0] += self.basis.at(degree, held.at_c) - self.basis.at(degree, held.of_c);
            powers
        };
        let steps = (0..steps).map(|_| [1.0, 0.0, 0.0, 0.0]);
        // base motion does not belong to the bias
        let columns = (0..=self.max_order).map(polynomial).chain(steps).chain(core::iter::repeat([0.0; TERMS]));
        let less_walk = |(mut powers, walk): (Powers, &f64)| {
            powers[0] -= walk;
            powers
        };
        columns.zip(&filtered.walk[1..]).map(less_walk).collect()
    }

    fn solved(&self, order: usize, spread: Spread, filtered: &Filtered, steps: usize) -> Option<Solved> {
        let columns: Vec<usize> = (0..=order).chain(self.max_order + 1..filtered.gram.len() - 1).collect();
        let precision = |column: usize| match column {
            0 => 0.0,
            degree if degree <= order => {
                let prior_dps = self.prior_dps[degree] * if degree < 2 { 1.0 } else { spread.bend };
                1.0 / (prior_dps * prior_dps)
            }
            column if column <= self.max_order + steps => 1.0 / (STEP_DPS * STEP_DPS),
            _ => 1.0 / (spread.motion_dps * spread.motion_dps),
        };
        let gram = |row: usize, column: usize| filtered.gram[row.max(column)][row.min(column)];
        let information = |(i, row): (usize, &usize)| {
            let mut products: Vec<f64> = columns[..=i].iter().map(|column| gram(row + 1, column + 1)).collect();
            products[i] += precision(*row);
            products
        };
        let information = whitener(columns.iter().enumerate().map(information).collect())?;
        let right: Vec<f64> = columns.iter().map(|column| gram(column + 1, 0)).collect();
        let sizes = information.solve(right.iter().copied());
        let explained: f64 = sizes.iter().zip(&right).map(|(size, product)| size * product).sum();
        let log_prior: f64 = columns[1..].iter().map(|column| libm::log(precision(*column))).sum();
        let deviance = gram(0, 0) - explained + filtered.log_determinant + information.ln_determinant() - log_prior;
        Some(Solved { order, steps, columns, information, sizes, log_evidence: spread.log_share - 0.5 * deviance })
    }
}

struct Solved {
    order: usize,
    steps: usize,
    columns: Vec<usize>,
    information: Cholesky,
    sizes: Vec<f64>,
    log_evidence: f64,
}

impl Solved {
    fn posterior(self, filtered: &Filtered, constants: &[Powers]) -> Posterior {
        let Self { order, steps, columns, information, sizes, log_evidence } = self;
        let count = columns.len();
        let unit = |k: usize| (0..count).map(move |other| f64::from(u8::from(other == k)));
        let inverse: Vec<Vec<f64>> = (0..count).map(|k| information.solve(unit(k))).collect();
        let mut bias = [0.0; TERMS];
        bias[0] = filtered.walk[0];
        let mut covariance = [[0.0; TERMS]; TERMS];
        covariance[0][0] = filtered.walk_variance;
        for (i, column) in columns.iter().enumerate() {
            (0..TERMS).for_each(|k| bias[k] += sizes[i] * constants[*column][k]);
            for (j, other) in columns.iter().enumerate() {
                for (row, a) in covariance.iter_mut().zip(&constants[*column]) {
                    row.iter_mut().zip(&constants[*other]).for_each(|(value, b)| *value += inverse[i][j] * a * b);
                }
            }
        }
        let (motions, steps) = (order + 1 + steps, (order + 1..order + 1 + steps).map(|k| (sizes[k], inverse[k][k])));
        let motion_dps = core::array::from_fn(|k| sizes.get(motions + k).copied().unwrap_or(0.0));
        let from_motion = from_motion(&inverse, motions, |column| constants[columns[column]]);
        Posterior { order, log_evidence, bias, covariance, steps: steps.collect(), motion_dps, from_motion }
    }
}

/// Variances that the columns from `motions` on explain: c · S⁻¹ · c. S is the covariance of these columns, and c is
/// the covariance of a coefficient with them.
fn from_motion(inverse: &[Vec<f64>], motions: usize, constants: impl Fn(usize) -> Powers) -> Powers {
    let own = (motions..inverse.len()).map(|row| inverse[row][motions..=row].to_vec()).collect();
    let Some(own) = whitener(own) else { return [0.0; TERMS] };
    let with = |k: usize, motion: usize| {
        inverse.iter().enumerate().map(|(column, row)| constants(column)[k] * row[motion]).sum::<f64>()
    };
    core::array::from_fn(|k| own.whiten((motions..inverse.len()).map(|row| with(k, row))).iter().map(|x| x * x).sum())
}
