//! Shapes over time that a rate may follow in addition to the temperature, each of size 1.

use super::blocks::Second;
use crate::noise::Window;
use crate::temperature::geometric;
use alloc::vec::Vec;
use core::f64::consts::PI;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A step from 0 to 1, most likely at `at_s`, and no earlier than `from_s` or later than `to_s`.
    Step { at_s: f64, from_s: f64, to_s: f64 },
    /// The square of the difference between temperature and T3, °C².
    Curved(Series),
    /// The temperature less its low-pass filtered value with the time constant `lag_s`, °C.
    Lagged { lag_s: f64, ahead: Series },
    /// The temperature less a value that follows it with a play of ±`width_c`, °C.
    Held { width_c: f64, ahead: Series },
    /// A sine of amplitude 1, with its phase at time 0, rad.
    Oscillation { hz: f64, phase: f64 },
}

/// A value for each second of the record, as time, s, and value.
pub(crate) type Series = Vec<(f64, f64)>;

impl Shape {
    pub(crate) fn step(at_s: f64) -> Self {
        Self::Step { at_s, from_s: at_s, to_s: at_s }
    }

    pub(crate) fn curved(seconds: &[Second], t3_c: f64) -> Self {
        let square = |second: &Second| (second.temp_c - t3_c) * (second.temp_c - t3_c);
        Self::Curved(seconds.iter().map(|second| (second.at_s, square(second))).collect())
    }

    fn lagged(seconds: &[Second], lag_s: f64) -> Self {
        let ahead = followed(seconds, |follower_c, temp_c, passed_s| {
            follower_c - libm::expm1(-passed_s / lag_s) * (temp_c - follower_c)
        });
        Self::Lagged { lag_s, ahead }
    }

    fn held(seconds: &[Second], width_c: f64) -> Self {
        let ahead = followed(seconds, |follower_c, temp_c, _| follower_c.clamp(temp_c - width_c, temp_c + width_c));
        Self::Held { width_c, ahead }
    }

    pub(crate) fn mean(&self, start_s: f64, end_s: f64) -> f64 {
        let length_s = end_s - start_s;
        match self {
            Self::Step { at_s, .. } => ((end_s - at_s) / length_s).clamp(0.0, 1.0),
            Self::Oscillation { hz, phase } => {
                let turn = 2.0 * PI * hz;
                (libm::cos(turn * start_s + phase) - libm::cos(turn * end_s + phase)) / (turn * length_s)
            }
            Self::Curved(series) | Self::Lagged { ahead: series, .. } | Self::Held { ahead: series, .. } => {
                mean(within(series, start_s, end_s))
            }
        }
    }

    /// Value of the shape at a time, s, as far as it belongs to the steady bias at T3. A level and a hysteresis belong
    /// to this bias, motion and lag do not, and a curvature is zero at T3.
    pub(crate) fn bias_at(&self, time_s: f64) -> f64 {
        match self {
            Self::Step { at_s, .. } => f64::from(u8::from(*at_s < time_s)),
            Self::Held { ahead, .. } => within(ahead, 0.0, time_s).last().map_or(0.0, |(_, value)| *value),
            Self::Curved(_) | Self::Lagged { .. } | Self::Oscillation { .. } => 0.0,
        }
    }
}

pub(crate) fn means<'a>(shape: &'a Shape, windows: &'a [Window]) -> impl Iterator<Item = f64> + 'a {
    windows.iter().map(|window| shape.mean(f64::from(window.start_s), f64::from(window.end_s)))
}

/// All shapes that are looked for in a record of these windows: a step at the beginning of each window but the first,
/// and the other shapes over the scales that the record can show.
pub(crate) fn all(seconds: &[Second], windows: &[Window], t3_c: f64) -> Vec<Shape> {
    let total_s = windows.last().map_or(0.0, |window| f64::from(window.end_s));
    let longest_s = windows.iter().map(Window::length_s).fold(1.0, f64::max);
    let temps = || seconds.iter().map(|second| second.temp_c);
    let span_c = temps().fold(f64::MIN, f64::max) - temps().fold(f64::MAX, f64::min);
    let steps = windows.iter().skip(1).map(|window| Shape::step(f64::from(window.start_s)));
    let lags = geometric(2.0, total_s, 1.5).map(|lag_s| Shape::lagged(seconds, lag_s));
    let plays = geometric(0.02 * span_c, span_c, 1.3).map(|width_c| Shape::held(seconds, width_c));
    let base_motions = (1..).map(|half| f64::from(half) / (2.0 * total_s)).take_while(|hz| hz * longest_s < 0.5);
    let base_motions = base_motions.map(|hz| Shape::Oscillation { hz, phase: 0.0 });
    steps.chain([Shape::curved(seconds, t3_c)]).chain(lags).chain(plays).chain(base_motions).collect()
}

/// Returns the temperature less a follower, °C. `next` gets the last value of the follower, the temperature and the
/// time since the last value, s, and returns the next value.
fn followed(seconds: &[Second], next: impl Fn(f64, f64, f64) -> f64) -> Series {
    let (mut follower_c, mut last_s) = seconds.first().map_or((0.0, 0.0), |second| (second.temp_c, second.at_s));
    let ahead = |second: &Second| {
        follower_c = next(follower_c, second.temp_c, second.at_s - last_s);
        last_s = second.at_s;
        (second.at_s, second.temp_c - follower_c)
    };
    seconds.iter().map(ahead).collect()
}

fn within(series: &Series, start_s: f64, end_s: f64) -> &[(f64, f64)] {
    let index = |time_s: f64| series.partition_point(|(at_s, _)| *at_s < time_s);
    let (start, end) = (index(start_s), index(end_s));
    &series[start..end.max(start)]
}

fn mean(values: &[(f64, f64)]) -> f64 {
    values.iter().map(|(_, value)| value).sum::<f64>() / values.len().max(1) as f64
}
