//! Checks of a measurement in a chamber, each second: missing readings, open door, time at a set point, rest.

use super::{AirApproach, ChamberProcedure, Present};
use crate::chamber::plan::{REACHED_C, StepEnd};
use crate::chamber::record::{Drift, Soak};
use crate::chamber::refusal::{ChamberRefusal, Disturbance};
use crate::chamber::states::{ChamberState, Until};
use crate::health::block_means::{BLOCK_S, adjacent};
use crate::health::stationarity::{self, Verdict};
use crate::temperature::gls::{dot, take_out};

use alloc::vec::Vec;

/// Number of successive air readings beyond the limits that ends the measurement. One may be a transmission error.
const BEYOND: u32 = 2;
/// Time in which the air must reach the set point, s, once the ramp has ended. A shorter `settle_timeout_s` counts
/// instead. Chambers take an hour for a hundred degrees.
const REACH_S: f64 = 5400.0;
/// Largest change of the temperature during an average, °C.
const AVERAGE_MOVES_C: f64 = 1.0;
/// Number of times that the average of a soak point may be repeated.
const MAX_DISTURBED: u32 = 3;
/// Number of seconds after which rest is judged, except during an average.
const REST_S: usize = 100;
/// Least and greatest amount by which the part's reading may exceed the first set point, °C, by self-heating and the
/// error of its sensor (M-03 with room for other parts).
const SELF_HEATING_C: (f64, f64) = (-5.0, 25.0);
/// Time without a reading after which the measurement ends, s.
const SILENT_S: u64 = 60;
/// Time within which each state must have a second with the part's temperature and the rates of all axes, s.
const TEMPERATURE_S: f64 = 30.0;

impl ChamberProcedure {
    /// Takes in the air temperature that the chamber reads, °C. This is optional: it only ends a measurement that
    /// cannot succeed or may harm the part.
    ///
    /// # Errors
    /// Returns a refusal if the air is beyond the plan or the part's limits, or does not reach the set point in time.
    pub fn air(&mut self, air_c: f64) -> Result<(), ChamberRefusal> {
        self.air_c = Some(air_c);
        let step = self.step + 1;
        let (low_c, high_c) = self.air_may_be_c(air_c);
        let part_c = self.part.operating_c.map(|(low_c, high_c)| (low_c - REACHED_C, high_c + REACHED_C));
        let harms = part_c.is_some_and(|(low_c, high_c)| !(low_c..=high_c).contains(&air_c));
        self.beyond = if !harms && (low_c..=high_c).contains(&air_c) { 0 } else { self.beyond + 1 };
        if self.beyond >= BEYOND {
            return Err(match self.part.operating_c.filter(|_| harms) {
                Some((low_c, high_c)) => ChamberRefusal::BeyondPart { step, air_c, low_c, high_c },
                None => ChamberRefusal::Overshoot { step, air_c, low_c, high_c },
            });
        }
        let (set_c, after_s) = (self.plan.course_c(self.step).1, self.now_s() - self.present.began_s);
        let waits = matches!(self.state, ChamberState::Settle | ChamberState::Hold);
        if waits && after_s > REACH_S.min(self.plan.settle_timeout_s) && (air_c - set_c).abs() > REACHED_C {
            return Err(ChamberRefusal::NotReached { step, set_c, air_c, after_s });
        }
        Ok(())
    }

    /// Returns the range in which the plan allows the air, °C: the set points and, because of an open door, the
    /// temperature after the measurement, each with the overshoot. The range also covers the first air temperature,
    /// until the air has come into the rest of the range or the step of the first reading is over.
    fn air_may_be_c(&mut self, air_c: f64) -> (f64, f64) {
        let ((low_c, high_c), safe_c) = (self.plan.span_c(), self.plan.safe_c);
        let (low_c, high_c) = (low_c.min(safe_c), high_c.max(safe_c));
        let (low_c, high_c) = (low_c - self.plan.overshoot_c, high_c + self.plan.overshoot_c);
        self.coming = match self.coming {
            _ if (low_c..=high_c).contains(&air_c) => AirApproach::Over,
            AirApproach::Unknown => AirApproach::From { air_c, step: self.step },
            AirApproach::From { step, .. } if step != self.step => AirApproach::Over,
            coming => coming,
        };
        match self.coming {
            AirApproach::From { air_c: first_c, .. } => {
                (low_c.min(first_c - self.plan.overshoot_c), high_c.max(first_c + self.plan.overshoot_c))
            }
            _ => (low_c, high_c),
        }
    }

    /// Closes the seconds before `second`, and leaves the states that end with them.
    pub(super) fn close_seconds(&mut self, second: u64) -> Result<(), ChamberRefusal> {
        if second - self.second > SILENT_S {
            return Err(ChamberRefusal::Silent { step: self.step + 1, for_s: (second - self.second) as f64 });
        }
        while self.second < second && self.state != ChamberState::Done {
            self.close_second();
            self.second += 1;
            self.look()?;
        }
        Ok(())
    }

    /// Checks whether the present state is over or disturbed, or the measurement must end.
    fn look(&mut self) -> Result<(), ChamberRefusal> {
        if let Some(frozen) = self.axes.iter().find_map(|axis| axis.health.frozen()) {
            let since_ns = frozen.since_ns.saturating_sub(self.started_ns);
            let at_s = self.second as f64;
            return Err(ChamberRefusal::Frozen { at_s, for_s: at_s - since_ns as f64 * 1e-9 });
        }
        let here_s = self.now_s() - self.present.began_s;
        if self.record.len() == self.present.first && here_s > TEMPERATURE_S {
            let (step, after_s) = (self.step + 1, here_s);
            if self.present.has_temp && self.present.out_of_range {
                return Err(ChamberRefusal::OutOfRange { step, after_s });
            }
            let wrong_edge = self.tally.hears_wrong_edge();
            return Err(ChamberRefusal::NoTemperature { step, after_s, wrong_edge });
        }
        if self.record.len() - self.blocks_from >= REST_S && self.state != ChamberState::Average {
            self.judge_rest();
        }
        match self.state.row().until {
            Until::Initialised | Until::Never => {}
            Until::Arrived => self.arrived(here_s),
            Until::Held => self.held(here_s),
            Until::Settled => return self.settled(here_s),
            Until::Averaged => return self.averaged(here_s),
        }
        Ok(())
    }

    pub(super) fn arrived(&mut self, here_s: f64) {
        let (from_c, _) = self.plan.course_c(self.step);
        if here_s >= self.plan.steps[self.step].ramp_s(from_c) {
            self.leave(false);
        }
    }

    fn held(&mut self, here_s: f64) {
        let StepEnd::Hold(hold_s) = self.plan.steps[self.step].end else { return };
        if here_s >= hold_s {
            let average_s = self.average_s(None).min(hold_s);
            self.keep_soak(self.now_s() - average_s, average_s);
            self.leave(false);
        }
    }

    fn settled(&mut self, here_s: f64) -> Result<(), ChamberRefusal> {
        let StepEnd::Average(planned_s) = self.plan.steps[self.step].end else { return Ok(()) };
        let (window_s, timeout_s) = (self.plan.window_s, self.plan.settle_timeout_s);
        let average_s = self.average_s(planned_s);
        let limit_c_per_s = self.plan.drift_c_per_s(average_s, &self.part);
        let from = self.record.index_of(self.now_s() - window_s);
        let Some(drift) = self.record.drift(from) else { return Ok(()) };
        if here_s >= window_s && self.record.is_settled(from, limit_c_per_s) && self.is_near(&drift) {
            self.leave(false);
            self.present.average_s = average_s;
            return Ok(());
        }
        if here_s > timeout_s {
            return Err(ChamberRefusal::NotSettled {
                step: self.step + 1,
                set_c: self.plan.course_c(self.step).1,
                temp_c: drift.mean_c,
                drift_c_per_min: drift.c_per_s * 60.0,
                most_c_per_min: limit_c_per_s * 60.0,
                air_c: self.air_c,
            });
        }
        Ok(())
    }

    /// Whether a part of steady temperature is near this set point, given the self-heating at the last set point. At
    /// the first set point, any self-heating of real parts is allowed.
    fn is_near(&self, drift: &Drift) -> bool {
        let set_c = self.plan.course_c(self.step).1;
        match self.settled_at_c {
            None => (SELF_HEATING_C.0..=SELF_HEATING_C.1).contains(&(drift.mean_c - set_c)),
            Some((last_set_c, last_c)) => {
                let (wanted_c, moved_c) = (set_c - last_set_c, drift.mean_c - last_c);
                (moved_c - wanted_c).abs() <= REACHED_C.min(0.5 * wanted_c.abs()).max(AVERAGE_MOVES_C)
            }
        }
    }

    fn averaged(&mut self, here_s: f64) -> Result<(), ChamberRefusal> {
        let Present { first, average_s, .. } = self.present;
        let moved = self.moved_c(first).filter(|moved_c| moved_c.abs() > AVERAGE_MOVES_C);
        if let Some(moved_c) = moved {
            return self.disturb(Disturbance::Temperature { moved_c, limit_c: AVERAGE_MOVES_C });
        }
        if here_s < average_s {
            return Ok(());
        }
        let seconds = self.record.len() - first;
        if self.present.out_of_range {
            return self.disturb(Disturbance::OutOfRange);
        }
        if (seconds as f64) < 0.8 * average_s {
            return self.disturb(Disturbance::Gaps);
        }
        if let Some(axis) = self.judge_rest() {
            return self.disturb(Disturbance::Motion { axis });
        }
        self.keep_soak(self.now_s() - average_s, average_s);
        let last = self.record.soaks.last();
        self.settled_at_c = last.map(|soak| (soak.set_c, soak.temp_c));
        self.leave(false);
        Ok(())
    }

    fn moved_c(&self, first: usize) -> Option<f64> {
        Some(self.record.temp_c.last()? - self.record.temp_c.get(first)?)
    }

    fn disturb(&mut self, why: Disturbance) -> Result<(), ChamberRefusal> {
        self.disturbed += 1;
        if self.disturbed > MAX_DISTURBED {
            return Err(ChamberRefusal::Disturbed { step: self.step + 1, times: self.disturbed, why });
        }
        self.leave(true);
        Ok(())
    }

    fn average_s(&self, planned_s: Option<f64>) -> f64 {
        let white: Vec<Option<f64>> = self.axes.iter().map(|axis| axis.white_dps_per_rt_hz).collect();
        self.plan.average_s(planned_s, &self.part, &white)
    }

    fn keep_soak(&mut self, from_s: f64, average_s: f64) {
        let from = self.record.index_of(from_s);
        let Some(drift) = self.record.drift(from) else { return };
        let limit_c_per_s = self.plan.drift_c_per_s(average_s, &self.part);
        let mean = |values: &Vec<f64>| values[from..].iter().sum::<f64>() / (values.len() - from) as f64;
        let soak = Soak {
            step: self.step,
            set_c: self.plan.course_c(self.step).1,
            start_s: self.record.start_s[from],
            end_s: self.now_s(),
            temp_c: mean(&self.record.temp_c),
            drift_c_per_min: drift.c_per_s * 60.0,
            settled: self.record.is_settled(from, limit_c_per_s),
            rates_dps: self.record.rates_dps.iter().map(mean).collect(),
        };
        self.record.soaks.push(soak);
    }

    /// Judges whether the part was at rest since the last call, and returns the index of the first axis that was not.
    /// If an axis moved, all these seconds are marked as not at rest. An axis at rest for [`WHITE_S`] gives its noise.
    pub(super) fn judge_rest(&mut self) -> Option<usize> {
        let (from, len) = (self.blocks_from, self.record.len());
        let mut moving = None;
        for (index, state) in self.axes.iter_mut().enumerate() {
            let rates_dps = without_temperature(&core::mem::take(&mut state.blocks));
            match stationarity::judge(&state.axis, &rates_dps, 0.0) {
                Verdict::AtRest | Verdict::Step { .. } => {
                    let white = stationarity::white_density(adjacent(&rates_dps, 1));
                    state.white_dps_per_rt_hz = (rates_dps.len() as f64 * BLOCK_S >= WHITE_S).then_some(white);
                }
                Verdict::Moving { .. } | Verdict::Noisy { .. } => moving = moving.or(Some(index)),
            }
        }
        if moving.is_some() {
            self.record.at_rest[from.min(len)..].fill(false);
        }
        self.blocks_from = len;
        moving
    }
}

/// Shortest time at rest that gives the white noise, s.
const WHITE_S: f64 = 20.0;

/// Returns the rates less their best parabola over temperature. A bias that follows the temperature is not motion,
/// and a chamber can change its temperature much within [`REST_S`].
fn without_temperature(blocks: &[(f64, f64)]) -> Vec<f64> {
    let mean_c = blocks.iter().map(|(_, c)| c).sum::<f64>() / blocks.len().max(1) as f64;
    let mut rates_dps: Vec<f64> = blocks.iter().map(|(dps, _)| *dps).collect();
    let mut units: Vec<Vec<f64>> = Vec::with_capacity(3);
    for power in 0..3 {
        let mut unit: Vec<f64> = blocks.iter().map(|(_, c)| libm::pow(c - mean_c, f64::from(power))).collect();
        units.iter().for_each(|before| take_out(&mut unit, before));
        let length = libm::sqrt(dot(&unit, &unit));
        if length > 0.0 {
            unit.iter_mut().for_each(|value| *value /= length);
            take_out(&mut rates_dps, &unit);
            units.push(unit);
        }
    }
    rates_dps
}
