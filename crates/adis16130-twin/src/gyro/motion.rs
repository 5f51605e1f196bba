//! The real rotation of the part: a constant rate, and an oscillation or bumps.

use crate::spec::{Motion, Spec};
use core::f64::consts::PI;

const BUMP_S: f64 = 0.2;
const BUMP_EVERY_S: f64 = 60.0;

pub(crate) struct Platform {
    rotation_dps: f64,
    motion: Motion,
    sway_dps: f64,
    sway_hz: f64,
    bump_dps: f64,
    first_bump_s: f64,
}

impl Platform {
    pub(crate) fn new(spec: &Spec) -> Self {
        Self {
            rotation_dps: spec.rotation_dps,
            motion: spec.motion,
            sway_dps: spec.sway_dps,
            sway_hz: spec.sway_hz,
            bump_dps: spec.bump_dps,
            first_bump_s: spec.event_s(),
        }
    }

    /// Sets the motion from now on. With [`Motion::Bump`] the first bump begins at `now_s`.
    pub(crate) fn set_motion(&mut self, motion: Motion, now_s: f64) {
        self.motion = motion;
        self.first_bump_s = now_s;
    }

    /// The rotation at `t_s`, in °/s.
    pub(crate) fn at(&self, t_s: f64) -> f64 {
        let motion_dps = match self.motion {
            Motion::None => 0.0,
            Motion::Sway => self.sway_dps * libm::sin(2.0 * PI * self.sway_hz * t_s),
            Motion::Bump => self.bump_dps * half_sine(t_s - self.first_bump_s),
        };
        self.rotation_dps + motion_dps
    }
}

/// Periodic half-sine bumps with a peak of 1, at the time `since_first_s` after the first bump began.
fn half_sine(since_first_s: f64) -> f64 {
    let since_s = libm::fmod(since_first_s, BUMP_EVERY_S);
    if since_first_s < 0.0 || since_s > BUMP_S {
        return 0.0;
    }
    libm::sin(PI * since_s / BUMP_S)
}
