//! A simulated chamber.

use super::{Chamber, SafeEnd};
use crate::Result;

/// A simulated chamber: its air follows the set point as a damped oscillator, and its door can open once.
///
/// The air temperature a follows the set point s by a″ = ω²(s − a) − 2ζω a′, where ω = 1/`lag_s`. With the damping ζ,
/// a step overshoots by `overshoot`: ln(overshoot) = −πζ/√(1 − ζ²). With a lag below 1 s, the air is at the set
/// point. While the door is open, the air approaches the room temperature with a time constant of 60 s instead.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedChamber {
    lag_s: f64,
    damping: f64,
    room_c: f64,
    door_at_s: f64,
    door_for_s: f64,
    set_c: f64,
    air_c: f64,
    c_per_s: f64,
    now_s: f64,
}

/// Longest time step of the simulation, s.
const STEP_S: f64 = 0.5;
/// Time constant of the air while the door is open, s.
const DOOR_S: f64 = 60.0;

const KEYS: &str = "lag_s, overshoot, door_at_s, door_for_s, room_c, start_c";

impl Default for SimulatedChamber {
    fn default() -> Self {
        let (room_c, start_c) = (22.0, 25.0);
        Self {
            lag_s: 60.0,
            damping: 1.0,
            room_c,
            door_at_s: 0.0,
            door_for_s: 0.0,
            set_c: start_c,
            air_c: start_c,
            c_per_s: 0.0,
            now_s: 0.0,
        }
    }
}

impl SimulatedChamber {
    /// Parses `key=value` pairs, separated by commas.
    pub fn parse(keys: &str) -> Result<Self, String> {
        let mut chamber = Self::default();
        for item in keys.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let (key, text) =
                item.split_once('=').ok_or_else(|| format!("`{item}`: write KEY=VALUE; keys are {KEYS}"))?;
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            let value = value.ok_or_else(|| format!("`{item}`: {text:?} is not a number"))?;
            chamber.set_key(key, value).map_err(|why| format!("`{item}`: {why}"))?;
        }
        Ok(chamber)
    }

    fn set_key(&mut self, key: &str, value: f64) -> Result<(), String> {
        let within = |least: f64, most: f64| match (least..=most).contains(&value) {
            true => Ok(value),
            false => Err(format!("give a number from {least} to {most}")),
        };
        match key {
            "lag_s" => self.lag_s = within(0.0, 3600.0)?,
            "overshoot" => self.damping = damping(within(0.0, 0.5)?),
            "door_at_s" => self.door_at_s = within(0.0, 1e7)?,
            "door_for_s" => self.door_for_s = within(0.0, 1e7)?,
            "room_c" => self.room_c = within(-40.0, 60.0)?,
            "start_c" => (self.air_c, self.set_c) = (within(-100.0, 200.0)?, value),
            _ => return Err(format!("keys are {KEYS}")),
        }
        Ok(())
    }

    /// Temperature of the air, °C.
    #[must_use]
    pub fn air_c(&self) -> f64 {
        self.air_c
    }

    fn step(&mut self, step_s: f64) {
        self.now_s += step_s;
        let open_s = self.now_s - self.door_at_s;
        if open_s > 0.0 && open_s <= self.door_for_s {
            self.c_per_s = 0.0;
            self.air_c += (self.room_c - self.air_c) * (step_s / DOOR_S).min(1.0);
        } else if self.lag_s < 2.0 * STEP_S {
            (self.air_c, self.c_per_s) = (self.set_c, 0.0);
        } else {
            let rate = 1.0 / self.lag_s;
            let pull = rate * rate * (self.set_c - self.air_c) - 2.0 * self.damping * rate * self.c_per_s;
            self.c_per_s += pull * step_s;
            self.air_c += self.c_per_s * step_s;
        }
    }
}

/// The damping ratio ζ of an oscillator whose step response overshoots by the share `overshoot` of the step. Without
/// an overshoot, ζ is 1 (critical damping).
fn damping(overshoot: f64) -> f64 {
    if overshoot <= 0.0 {
        return 1.0;
    }
    let log = overshoot.ln();
    -log / std::f64::consts::PI.hypot(log)
}

impl Chamber for SimulatedChamber {
    fn set(&mut self, temp_c: f64) -> Result<()> {
        self.set_c = temp_c;
        Ok(())
    }

    fn read_c(&mut self) -> Result<Option<f64>> {
        Ok(Some(self.air_c))
    }

    fn pass(&mut self, seconds: f64) {
        let mut left_s = seconds;
        while left_s > 0.0 {
            self.step(left_s.min(STEP_S));
            left_s -= STEP_S;
        }
    }

    fn end(&mut self, safe_c: f64) -> Option<SafeEnd> {
        self.set_c = safe_c;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn highest(keys: &str) -> f64 {
        let mut chamber = SimulatedChamber::parse(keys).expect("keys");
        chamber.set(125.0).expect("it always can");
        let mut highest_c = 0.0_f64;
        for _ in 0..3600 {
            chamber.pass(1.0);
            highest_c = highest_c.max(chamber.air_c());
        }
        assert!((chamber.air_c() - 125.0).abs() < 0.01, "{}", chamber.air_c());
        highest_c
    }

    #[test]
    fn the_air_lags_and_overshoots_as_stated() {
        assert!((highest("lag_s=60,overshoot=0.1") - 135.0).abs() < 0.5);
        assert!(highest("lag_s=60") < 125.001);
        assert_eq!(highest("lag_s=0"), 125.0);
    }

    #[test]
    fn an_open_door_lets_the_room_in() {
        let mut chamber =
            SimulatedChamber::parse("lag_s=0,start_c=80,room_c=20,door_at_s=10,door_for_s=60").expect("keys");
        chamber.pass(10.0);
        assert_eq!(chamber.air_c(), 80.0);
        chamber.pass(60.0);
        assert!((chamber.air_c() - (20.0 + 60.0 / std::f64::consts::E)).abs() < 0.5, "{}", chamber.air_c());
        chamber.pass(1.0);
        assert_eq!(chamber.air_c(), 80.0);
    }

    #[test]
    fn keys_that_make_no_sense_are_named() {
        for (keys, why) in [("lag=3", "keys are lag_s"), ("lag_s=x", "not a number"), ("overshoot=2", "from 0 to 0.5")]
        {
            let error = SimulatedChamber::parse(keys).expect_err("no such key");
            assert!(error.contains(why) && error.starts_with(&format!("`{keys}`")), "{error}");
        }
    }
}
