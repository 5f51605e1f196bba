//! The slow processes (temperatures, bias, flicker, motion), with their own tick, which bus traffic cannot shift.

use super::motion::Platform;
use super::noise::{Flicker, RandomWalk};
use super::thermal::{TemperatureBias, Thermal};
use crate::facts;
use crate::normal::Layers;
use crate::spec::Spec;
use alloc::rc::Rc;

/// The tick of the slow processes of a [`Twin`](crate::Twin), in ps. Between two ticks they are interpolated linearly.
pub(crate) const TICK_PS: u64 = 4_000_000_000;

#[derive(Copy, Clone, Default)]
pub(crate) struct Point {
    /// The rate at the output without white noise, resonance and self-test, in °/s.
    pub(crate) rate_dps: f64,
    pub(crate) sensor_c: f64,
    pub(crate) element_c: f64,
    pub(crate) ambient_c: f64,
    /// Difference of the bias from the curve f(T) by hysteresis, before the sensitivity error, in °/s.
    pub(crate) branch_dps: f64,
    pub(crate) walk_dps: f64,
    pub(crate) flicker_dps: f64,
    pub(crate) supply_dps: f64,
}

/// The slow processes, with their values at the last tick and at the next one.
pub(crate) struct Slow {
    left: Point,
    right: Point,
    left_ps: u64,
    ticks: u64,
    tick_ps: u64,
    per_tick: f64,
    thermal: Thermal,
    temperature_bias: TemperatureBias,
    pub(crate) platform: Platform,
    noises: Option<(Flicker, RandomWalk)>,
    bias_dps: f64,
    supply_dps: f64,
    supply_step_dps: f64,
    supply_step_s: f64,
    gain: f64,
}

impl Slow {
    pub(crate) fn new(spec: &Spec, tick_ps: u64, layers: &Rc<Layers>) -> Self {
        let tick_s = seconds(tick_ps);
        let thermal = Thermal::new(spec, tick_s, layers);
        let mut slow = Self {
            left: Point::default(),
            right: Point::default(),
            left_ps: 0,
            ticks: 0,
            tick_ps,
            per_tick: 1.0 / tick_ps as f64,
            temperature_bias: TemperatureBias::new(spec, thermal.element_c),
            thermal,
            platform: Platform::new(spec),
            noises: spec.noise.then(|| (Flicker::new(spec, tick_s, layers), RandomWalk::new(spec, tick_s, layers))),
            bias_dps: spec.bias_dps,
            supply_dps: (spec.supply_mv - facts::SUPPLY_NOMINAL_MV) * facts::SUPPLY_DPS_PER_MV,
            supply_step_dps: spec.supply_step_mv * facts::SUPPLY_DPS_PER_MV,
            supply_step_s: spec.event_s(),
            gain: 1.0 + spec.sensitivity_error,
        };
        slow.right = slow.point(0.0);
        slow.step();
        slow
    }

    /// Advances to `t_ps`, which must not be before the last tick.
    #[inline]
    pub(crate) fn follow(&mut self, t_ps: u64) {
        while t_ps - self.left_ps >= self.tick_ps {
            self.step();
        }
    }

    /// The rate at `t_ps` without white noise, resonance and self-test, in °/s.
    #[inline]
    pub(crate) fn rate_dps(&mut self, t_ps: u64) -> f64 {
        self.follow(t_ps);
        between(self.left.rate_dps, self.right.rate_dps, self.share(t_ps))
    }

    #[inline]
    pub(crate) fn sensor_c(&mut self, t_ps: u64) -> f64 {
        self.follow(t_ps);
        between(self.left.sensor_c, self.right.sensor_c, self.share(t_ps))
    }

    pub(crate) fn at(&mut self, t_ps: u64) -> Point {
        self.follow(t_ps);
        let share = self.share(t_ps);
        let (l, r) = (&self.left, &self.right);
        Point {
            rate_dps: between(l.rate_dps, r.rate_dps, share),
            sensor_c: between(l.sensor_c, r.sensor_c, share),
            element_c: between(l.element_c, r.element_c, share),
            ambient_c: between(l.ambient_c, r.ambient_c, share),
            branch_dps: between(l.branch_dps, r.branch_dps, share),
            walk_dps: between(l.walk_dps, r.walk_dps, share),
            flicker_dps: between(l.flicker_dps, r.flicker_dps, share),
            supply_dps: between(l.supply_dps, r.supply_dps, share),
        }
    }

    /// Switches the supply on or off at `t_ps`. The heating follows at the next tick.
    pub(crate) fn set_powered(&mut self, powered: bool, t_ps: u64) {
        self.follow(t_ps);
        self.thermal.set_powered(powered);
    }

    /// Changes the ambient temperature to `to_c`, °C, within `over_s` seconds, from the next tick after `t_ps` on.
    pub(crate) fn set_ambient(&mut self, to_c: f64, over_s: f64, t_ps: u64) {
        self.follow(t_ps);
        self.thermal.set_ambient(to_c, over_s, self.ticks as f64 * seconds(self.tick_ps));
    }

    #[inline]
    fn share(&self, t_ps: u64) -> f64 {
        (t_ps - self.left_ps) as f64 * self.per_tick
    }

    #[cold]
    #[inline(never)]
    fn step(&mut self) {
        self.left_ps = self.ticks * self.tick_ps;
        self.ticks += 1;
        let t_s = self.ticks as f64 * seconds(self.tick_ps);
        self.thermal.step(t_s);
        if let Some((flicker, walk)) = &mut self.noises {
            flicker.step();
            walk.step();
        }
        self.left = self.right;
        self.right = self.point(t_s);
    }

    /// Evaluates all processes at `t_s`, to which they have advanced.
    fn point(&mut self, t_s: f64) -> Point {
        let (flicker_dps, walk_dps) = match &self.noises {
            Some((flicker, walk)) => (flicker.value(), walk.value),
            None => (0.0, 0.0),
        };
        let element_c = self.thermal.element_c;
        let (temperature_dps, branch_dps) = self.temperature_bias.step(element_c);
        let stepped = t_s >= self.supply_step_s;
        let supply_dps = self.supply_dps + if stepped { self.supply_step_dps } else { 0.0 };
        let bias_dps = self.bias_dps + supply_dps + temperature_dps + walk_dps;
        Point {
            rate_dps: self.gain * (self.platform.at(t_s) + bias_dps + flicker_dps),
            sensor_c: self.thermal.sensor_c,
            element_c,
            ambient_c: self.thermal.ambient_c,
            branch_dps,
            walk_dps,
            flicker_dps,
            supply_dps,
        }
    }
}

const fn seconds(ps: u64) -> f64 {
    ps as f64 * 1e-12
}

#[inline]
fn between(left: f64, right: f64, share: f64) -> f64 {
    left + (right - left) * share
}
