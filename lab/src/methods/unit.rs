//! Simulated units of four kinds, and their recordings.

use adis16130_twin::{Mean, Means, Spec, Truth, facts};
use zerorate::temperature::Block;

/// How the bias of a unit depends on temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Linear,
    Curved,
    Lagging,
    Hysteretic,
}

impl Kind {
    pub const ALL: [Self; 4] = [Self::Linear, Self::Curved, Self::Lagging, Self::Hysteretic];

    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Curved => "curved",
            Self::Lagging => "lagging",
            Self::Hysteretic => "hysteretic",
        }
    }

    /// The unit with this seed. All units have a tempco of 0.04 °/s/°C (F-05) and self-heating of 8 °C (M-03).
    pub fn spec(self, seed: u64, lag_s: f64) -> Spec {
        let unit = Spec::from_seed(seed);
        let linear = Spec {
            tempco_dps_per_c: facts::TEMPCO_DPS_PER_C,
            warmup_c: facts::WARMUP_C,
            curvature_dps_per_c2: 0.0,
            hysteresis_dps: 0.0,
            lag_s: 0.0,
            ..unit
        };
        match self {
            Self::Linear => linear,
            Self::Curved => Spec { curvature_dps_per_c2: unit.curvature_dps_per_c2, ..linear },
            Self::Lagging => Spec { lag_s, ..linear },
            Self::Hysteretic => Spec { hysteresis_dps: unit.hysteresis_dps, ..linear },
        }
    }
}

/// Number of temperatures at which methods are compared, evenly over the measured span.
pub const TEMPS: usize = 9;
/// Averaging time of a recording's means, s.
pub const MEAN_S: f64 = 0.1;
/// Smallest number of means in a block of a fit: 2 s.
const LEAST_MEANS: usize = 20;
/// Largest number of blocks of a fit, as in `calibrate`.
const MOST_BLOCKS: usize = 1600;

/// A recording from power-on, and the unit's true state at its end.
#[derive(Clone)]
pub struct Recording {
    /// Means over 0.1 s, without gaps.
    pub means: Vec<Mean>,
    pub truth: Truth,
}

impl Recording {
    pub fn warm_up(spec: &Spec, length_s: f64) -> Self {
        let mut unit = Unit::new(spec);
        unit.record(length_s);
        unit.recording()
    }

    /// Warm-ups of one unit with these lengths, ascending.
    pub fn warm_ups(spec: &Spec, lengths_s: &[f64]) -> Vec<Self> {
        let mut unit = Unit::new(spec);
        let until = |length_s: &f64| {
            unit.record(length_s - unit.length_s());
            unit.recording()
        };
        lengths_s.iter().map(until).collect()
    }

    /// A warm-up of 20 min, after which the air cools by 8 °C and later warms again, each in 8 min. The air stays cool
    /// for 12 min, and the recording ends 22 min after the air is warm again.
    pub fn cycle(spec: &Spec) -> Self {
        const SWING_C: f64 = 8.0;
        const SLOPE_S: f64 = 480.0;
        let mut unit = Unit::new(spec);
        unit.record(1200.0);
        unit.means.set_ambient(spec.ambient_c - SWING_C, SLOPE_S);
        unit.record(SLOPE_S + 720.0);
        unit.means.set_ambient(spec.ambient_c, SLOPE_S);
        unit.record(SLOPE_S + 1320.0);
        unit.recording()
    }

    /// The profile of F-57 in a chamber: 210 min between −40 and +85 °C.
    pub fn chamber(spec: &Spec) -> Self {
        // temperature, °C; duration of the ramp to this temperature, min; time at this temperature, min
        const STEPS: [(f64, f64, f64); 4] =
            [(25.0, 0.0, 5.0), (-40.0, 32.5, 30.0), (85.0, 62.5, 15.0), (25.0, 30.0, 35.0)];
        let mut unit = Unit::new(spec);
        for (to_c, ramp_min, hold_min) in STEPS {
            unit.means.set_ambient(to_c, 60.0 * ramp_min);
            unit.record(60.0 * (ramp_min + hold_min));
        }
        unit.recording()
    }

    pub fn blocks(&self) -> Vec<Block> {
        self.averages(self.means.len().div_ceil(MOST_BLOCKS).max(LEAST_MEANS)).collect()
    }

    /// Averages each `count` successive means.
    pub fn averages(&self, count: usize) -> impl Iterator<Item = Block> {
        self.means.chunks_exact(count).map(block)
    }

    /// Temperatures from the lowest to the highest of the blocks, °C.
    pub fn temps_c(&self) -> [f64; TEMPS] {
        let temps = self.blocks().into_iter().map(|block| block.temp_c);
        let (low_c, high_c) =
            temps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), temp_c| (low.min(temp_c), high.max(temp_c)));
        std::array::from_fn(|k| low_c + (high_c - low_c) * k as f64 / (TEMPS - 1) as f64)
    }

    pub fn window(&self, from_s: f64, to_s: f64) -> Block {
        let index = |at_s: f64| ((at_s / MEAN_S).round() as usize).min(self.means.len());
        block(&self.means[index(from_s)..index(to_s)])
    }
}

struct Unit {
    means: Means,
    seen: Vec<Mean>,
}

impl Unit {
    fn new(spec: &Spec) -> Self {
        Self { means: Means::new(spec, 1), seen: Vec::new() }
    }

    fn length_s(&self) -> f64 {
        self.seen.len() as f64 * MEAN_S
    }

    fn record(&mut self, length_s: f64) {
        let count = (length_s / MEAN_S).round() as usize;
        self.seen.extend(std::iter::repeat_with(|| self.means.next_mean()).take(count));
    }

    fn recording(&mut self) -> Recording {
        Recording { means: self.seen.clone(), truth: self.means.truth() }
    }
}

fn block(means: &[Mean]) -> Block {
    let mean = |of: fn(&Mean) -> f64| means.iter().map(of).sum::<f64>() / means.len() as f64;
    Block {
        start_s: means.first().map_or(0.0, |mean| mean.start_s),
        length_s: means.len() as f64 * MEAN_S,
        rate_dps: mean(|mean| mean.rate_dps),
        temp_c: mean(|mean| mean.temp_c),
    }
}
