//! Temperatures (ambient, self-heating, the sensing element's lag) and the temperature part of the bias.

use super::noise::OrnsteinUhlenbeck;
use crate::facts;
use crate::normal::{Layers, Normal, Process};
use crate::spec::{Profile, Spec};
use alloc::rc::Rc;

pub(crate) struct Thermal {
    ambient: Ambient,
    wander: OrnsteinUhlenbeck,
    normal: Normal,
    heating: [Heating; 2],
    lag_gain: f64,
    powered: bool,
    pub(crate) ambient_c: f64,
    pub(crate) sensor_c: f64,
    pub(crate) element_c: f64,
}

impl Thermal {
    pub(crate) fn new(spec: &Spec, tick_s: f64, layers: &Rc<Layers>) -> Self {
        let mut normal = Normal::with_layers(spec.seed, Process::Ambient, layers);
        let wander_c = if spec.noise { spec.ambient_wander_c } else { 0.0 };
        let wander = OrnsteinUhlenbeck::stationary(wander_c, tick_s / facts::WANDER_S, &mut normal);
        let ambient = Ambient::new(spec);
        let start_c = ambient.at(0.0) + wander.value;
        let fast_s = spec.warmup_s * (facts::WARMUP_FAST_S / facts::WARMUP_SLOW_S);
        let fast_c = spec.warmup_c * facts::WARMUP_FAST_SHARE;
        Self {
            ambient,
            wander,
            normal,
            heating: [
                Heating::new(fast_c, tick_s / fast_s),
                Heating::new(spec.warmup_c - fast_c, tick_s / spec.warmup_s),
            ],
            lag_gain: if spec.lag_s > 0.0 { -libm::expm1(-tick_s / spec.lag_s) } else { 1.0 },
            powered: true,
            ambient_c: start_c,
            sensor_c: start_c,
            element_c: start_c,
        }
    }

    pub(crate) fn set_powered(&mut self, powered: bool) {
        self.powered = powered;
    }

    /// Changes the ambient temperature linearly to `to_c`, °C, within `over_s` seconds from `t_s` on, and holds it
    /// there instead of the profile.
    pub(crate) fn set_ambient(&mut self, to_c: f64, over_s: f64, t_s: f64) {
        let from_c = self.ambient.at(t_s);
        self.ambient.outside = Some(Outside { from_c, to_c, from_s: t_s, over_s: over_s.max(0.0) });
    }

    pub(crate) fn step(&mut self, t_s: f64) {
        self.ambient_c = self.ambient.at(t_s) + self.wander.step(&mut self.normal);
        let powered = self.powered;
        let heat_c: f64 = self.heating.iter_mut().map(|part| part.step(powered)).sum();
        self.sensor_c = self.ambient_c + heat_c;
        self.element_c += self.lag_gain * (self.sensor_c - self.element_c);
    }
}

/// One exponential share of the self-heating (M-03). It warms and cools with the same time constant.
struct Heating {
    full_c: f64,
    now_c: f64,
    gain: f64,
}

impl Heating {
    fn new(full_c: f64, ticks: f64) -> Self {
        Self { full_c, now_c: 0.0, gain: -libm::expm1(-ticks) }
    }

    fn step(&mut self, powered: bool) -> f64 {
        let target_c = if powered { self.full_c } else { 0.0 };
        self.now_c += self.gain * (target_c - self.now_c);
        self.now_c
    }
}

/// The ambient profile without wander.
struct Ambient {
    profile: Profile,
    start_c: f64,
    ramp_c_per_s: f64,
    /// A temperature set by [`Thermal::set_ambient`], in place of the profile.
    outside: Option<Outside>,
}

/// A linear change to a temperature, which stays constant afterwards.
struct Outside {
    from_c: f64,
    to_c: f64,
    from_s: f64,
    over_s: f64,
}

impl Outside {
    fn at(&self, t_s: f64) -> f64 {
        let since_s = t_s - self.from_s;
        if since_s >= self.over_s {
            return self.to_c;
        }
        self.from_c + (self.to_c - self.from_c) * (since_s / self.over_s).max(0.0)
    }
}

impl Ambient {
    fn new(spec: &Spec) -> Self {
        let ramp_c_per_s = spec.ramp_c_per_min / 60.0;
        Self { profile: spec.profile, start_c: spec.ambient_c, ramp_c_per_s, outside: None }
    }

    fn at(&self, t_s: f64) -> f64 {
        if let Some(outside) = &self.outside {
            return outside.at(t_s);
        }
        match self.profile {
            Profile::Constant => self.start_c,
            // The ramp stops at the end of the range of F-08. If the ramp starts beyond this end, it stays constant.
            Profile::Ramp if self.ramp_c_per_s > 0.0 => {
                (self.start_c + self.ramp_c_per_s * t_s).min(self.start_c.max(85.0))
            }
            Profile::Ramp => (self.start_c + self.ramp_c_per_s * t_s).max(self.start_c.min(-40.0)),
            Profile::Oven => oven_c(t_s / 60.0),
        }
    }
}

/// Temperature of the profile F-57 at `minutes` from the start, in °C.
fn oven_c(minutes: f64) -> f64 {
    let mut before = facts::OVEN_MIN_C[0];
    for point in facts::OVEN_MIN_C {
        if minutes < point.0 {
            let share = (minutes - before.0) / (point.0 - before.0);
            return before.1 + share * (point.1 - before.1);
        }
        before = point;
    }
    before.1
}

/// The temperature part of the bias, f(T) = tempco·(T − 25) + curvature·(T − 25)², with hysteresis by play.
///
/// The bias p stays constant while its distance from f(T) is at most h = `hysteresis_dps`. Otherwise it follows f(T)
/// at that distance. So a temperature cycle traces a loop of half width h with any coefficients. The *branch offset* p
/// − f(T) is −h after warming and +h after cooling where f rises. It starts at 0.
pub(crate) struct TemperatureBias {
    tempco: f64,
    curvature: f64,
    half_width: f64,
    play: f64,
}

impl TemperatureBias {
    pub(crate) fn new(spec: &Spec, start_c: f64) -> Self {
        let mut bias = Self {
            tempco: spec.tempco_dps_per_c,
            curvature: spec.curvature_dps_per_c2,
            half_width: spec.hysteresis_dps.max(0.0),
            play: 0.0,
        };
        bias.play = bias.curve(start_c);
        bias
    }

    /// Moves to `element_c`. Returns the temperature part of the bias and the branch offset, in °/s.
    pub(crate) fn step(&mut self, element_c: f64) -> (f64, f64) {
        let curve = self.curve(element_c);
        self.play = self.play.max(curve - self.half_width).min(curve + self.half_width);
        (self.play, self.play - curve)
    }

    fn curve(&self, temp_c: f64) -> f64 {
        let d = temp_c - facts::TEMP_AT_ZERO_CODE_C;
        (self.tempco + self.curvature * d) * d
    }
}
