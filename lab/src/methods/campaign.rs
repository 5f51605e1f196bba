//! The methods to compare, and the simulated units for the comparison.

use super::comparison::{Comparison, MethodResult, Summary};
use super::unit::{Kind, Recording, TEMPS};
use super::{an1042, ardupilot, bound, chamber, gls, px4};
use crate::seeds::for_each_seed;
use crate::trial::HOUR_S;
use adis16130_twin::Spec;
use anyhow::Context;
use std::ops::RangeInclusive;
use zerorate::{Axis, Correction};

/// A method that computes the bias over temperature from a recording.
pub struct Method {
    pub name: &'static str,
    recording: RecordingKind,
    fit: fn(&Recording) -> Option<MethodResult>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum RecordingKind {
    Hour,
    /// A warm-up, after which the air is cooled and warmed again.
    Cycle,
    /// The profile of F-57.
    Chamber,
}

impl RecordingKind {
    const ALL: [Self; 3] = [Self::Hour, Self::Cycle, Self::Chamber];

    fn of(self, spec: &Spec) -> Recording {
        match self {
            Self::Hour => hour(spec),
            Self::Cycle => Recording::cycle(spec),
            Self::Chamber => Recording::chamber(spec),
        }
    }
}

/// All methods, in the order of docs/reference/methods.md.
pub const METHODS: [Method; 7] = [
    Method { name: RAW, recording: RecordingKind::Hour, fit: |recording| Some(raw(recording).into()) },
    Method { name: AN1042, recording: RecordingKind::Hour, fit: |recording| Some(an1042::fit(recording).into()) },
    Method { name: "PX4-style", recording: RecordingKind::Hour, fit: px4::fit },
    Method { name: "ArduPilot-style", recording: RecordingKind::Hour, fit: ardupilot::fit },
    Method { name: WARMUP, recording: RecordingKind::Hour, fit: gls::fit },
    Method { name: CYCLE, recording: RecordingKind::Cycle, fit: gls::fit },
    Method { name: CHAMBER, recording: RecordingKind::Chamber, fit: chamber::fit },
];
pub const RAW: &str = "raw";
pub const AN1042: &str = "an1042";
pub const WARMUP: &str = "warmup";
pub const CYCLE: &str = "cycle";
pub const CHAMBER: &str = "chamber";

fn hour(spec: &Spec) -> Recording {
    Recording::warm_up(spec, HOUR_S)
}

/// The reference without temperature correction: the bias at the middle temperature is known exactly.
fn raw(recording: &Recording) -> Correction {
    let middle_c = recording.temps_c()[TEMPS / 2];
    Correction::line(-recording.truth.bias_dps(middle_c), 0.0, middle_c)
}

/// The seeds of the simulated units, and the lag of the lagging units.
#[derive(Clone, Copy)]
pub struct Units<'a> {
    pub seeds: &'a RangeInclusive<u64>,
    pub lag_s: f64,
}

impl Units<'_> {
    /// Runs every method on every kind of unit. Returns a row for each kind, with a summary for each method.
    pub fn by_method(&self) -> anyhow::Result<Vec<Vec<Summary>>> {
        let of_kind = |kind: Kind| {
            let one = |seed| {
                let spec = kind.spec(seed, self.lag_s);
                let recordings = RecordingKind::ALL.map(|kind| kind.of(&spec));
                let judge = |method: &Method| {
                    Comparison::of(&recordings[method.recording as usize], method.fit)
                        .with_context(|| format!("{} gave nothing", method.name))
                };
                METHODS.iter().map(judge).collect()
            };
            self.summaries(one)
        };
        Kind::ALL.into_iter().map(of_kind).collect()
    }

    /// Runs the warm-up method with these lengths, s. Returns a row for each kind, with a summary for each length.
    pub fn by_length(&self, lengths_s: &[f64]) -> anyhow::Result<Vec<Vec<Summary>>> {
        let of_kind = |kind: Kind| {
            self.summaries(|seed| {
                let recordings = Recording::warm_ups(&kind.spec(seed, self.lag_s), lengths_s);
                recordings.iter().map(judged_warm_up).collect()
            })
        };
        Kind::ALL.into_iter().map(of_kind).collect()
    }

    /// Runs the warm-up method on linear units. Returns a summary for each rate random walk, whose size is given in
    /// `factors` as multiples of M-04.
    pub fn by_walk(&self, factors: &[f64]) -> anyhow::Result<Vec<Summary>> {
        self.summaries(|seed| {
            let linear = Kind::Linear.spec(seed, self.lag_s);
            let walking = |factor: &f64| Spec { rrw_dps_per_rt_s: factor * linear.rrw_dps_per_rt_s, ..linear.clone() };
            factors.iter().map(|factor| judged_warm_up(&hour(&walking(factor)))).collect()
        })
    }

    /// Runs `one` for all units. Returns a summary for each entry of its results.
    fn summaries(&self, one: impl Fn(u64) -> anyhow::Result<Vec<Comparison>> + Sync) -> anyhow::Result<Vec<Summary>> {
        let units = for_each_seed(self.seeds.clone(), one)?;
        let columns = units.first().map_or(0, Vec::len);
        let column = |index: usize| units.iter().map(|unit| &unit[index]).collect::<Vec<_>>();
        Ok((0..columns).map(|index| Summary::of(&column(index))).collect())
    }
}

fn judged_warm_up(recording: &Recording) -> anyhow::Result<Comparison> {
    Comparison::of(recording, gls::fit).context("the warm-up gave nothing")
}

/// The smallest residual bias, °/h, that any method can reach for a unit whose bias is known to be a polynomial of
/// this order. `factor` is the rate random walk as a multiple of M-04.
pub fn bound_dph(order: usize, factor: f64) -> anyhow::Result<f64> {
    let typical = Axis::ADIS16130.typical_noise();
    let walk = factor * typical.rate_random_walk_dps_per_rt_s;
    let noise = zerorate::noise::NoiseModel { rate_random_walk_dps_per_rt_s: walk, ..typical };
    let quiet = Spec { noise: false, ..Kind::Linear.spec(1, 0.0) };
    Ok(3600.0 * bound::u_dps(&hour(&quiet), &noise, order).context("no bound")?)
}
