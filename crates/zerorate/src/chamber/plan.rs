//! The plan of a measurement in a chamber, with the averaging time and the drift limit of its soak points.

use crate::part::{NamedAxis, Part};
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

/// Largest distance of the air from a set point at which this point counts as reached, °C.
pub(super) const REACHED_C: f64 = 3.0;

/// The steps of a measurement in a chamber. `docs/formats/plan.md` specifies the file format.
///
/// ```
/// # #[cfg(feature = "file")] {
/// let plan = zerorate::chamber::ChamberPlan::parse(r#"
///     schema = 1
///     [[step]]
///     to_c = 15
///     [[step]]
///     to_c = 55
///     c_per_min = 2
/// "#)?;
/// assert_eq!((plan.steps.len(), plan.steps[1].ramp_s(15.0)), (2, 1200.0));
/// # }
/// # Ok::<(), zerorate::chamber::ChamberPlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ChamberPlan {
    /// Name of the plan. It is empty if the file gives none.
    pub name: String,
    /// All steps in their order. A file with several cycles gives its steps once for each cycle.
    pub steps: Vec<Step>,
    /// Largest drift of the part's own temperature at a soak point, °C/min. `None` allows a drift whose effect
    /// stays below the noise of the average ([`ChamberPlan::drift_c_per_s`]).
    pub drift_c_per_min: Option<f64>,
    /// Time over which the drift is measured, s.
    pub window_s: f64,
    /// Time limit for settling, s, from the end of the ramp or of a disturbed average.
    pub settle_timeout_s: f64,
    /// How far the air may go beyond the temperatures of the plan, °C.
    pub overshoot_c: f64,
    /// Temperature of the chamber after the measurement, °C.
    pub safe_c: f64,
}

/// One step: the air goes to a temperature, and stays there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Set point, °C.
    pub to_c: f64,
    /// Speed of the set point, °C/min. `None` lets the set point jump.
    pub c_per_min: Option<f64>,
    /// The condition that ends the step.
    pub end: StepEnd,
}

/// The condition that ends a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepEnd {
    /// The step ends this long after its ramp has ended, s.
    Hold(f64),
    /// The step ends when the part has settled and was averaged for this long, s. `None` takes the time at which
    /// the Allan deviation is lowest.
    Average(Option<f64>),
}

impl Default for ChamberPlan {
    /// A plan without a name and steps, with the defaults of the values that a file may leave out.
    fn default() -> Self {
        Self {
            name: String::new(),
            steps: Vec::new(),
            drift_c_per_min: None,
            window_s: 120.0,
            settle_timeout_s: 7200.0,
            overshoot_c: 5.0,
            safe_c: 25.0,
        }
    }
}

impl Step {
    /// Duration of the ramp from another temperature to the set point, s. It is 0 if the set point jumps.
    #[must_use]
    pub fn ramp_s(&self, from_c: f64) -> f64 {
        self.c_per_min.map_or(0.0, |c_per_min| (self.to_c - from_c).abs() / c_per_min * 60.0)
    }
}

/// Shortest and longest averaging time that `auto` chooses, s.
const AVERAGE_S: (f64, f64) = (30.0, 3600.0);
/// Allowed drift, °C/min, if no axis has both a known noise and a known temperature coefficient other than zero.
const DRIFT_C_PER_MIN: f64 = 0.05;

impl ChamberPlan {
    /// Makes a plan of timed steps from the temperatures that a chamber went through: times, s, and temperatures,
    /// °C, in order. Each stretch where the temperature stayed within 1 °C for at least five minutes becomes the hold
    /// of a step, and the time before the stretch its ramp. The time after the last stretch becomes a ramp alone.
    ///
    /// # Errors
    /// Returns an error for fewer than two rows, times that do not rise, or more than 1000 steps.
    pub fn of_course(course: &[(f64, f64)]) -> Result<Self, ChamberPlanError> {
        let row = |index: usize| alloc::format!("row {}", index + 1);
        if let Some(index) = course.windows(2).position(|pair| pair[0].0.partial_cmp(&pair[1].0) != Some(LESS)) {
            return Err(ChamberPlanError::new(row(index + 1) + ": its t_s is not after the one before"));
        }
        let (Some(first), Some(last)) = (course.first(), course.last().filter(|_| course.len() > 1)) else {
            return Err(ChamberPlanError::new("it has fewer than two rows; give time and temperature"));
        };
        let mut steps = Vec::new();
        let mut begun = (first.0.min(0.0), first.1);
        for (from, to) in stays(course) {
            let mean_c = course[from..=to].iter().map(|(_, c)| c).sum::<f64>() / (to - from + 1) as f64;
            steps.extend(timed(begun, (course[from].0, mean_c), course[to].0 - course[from].0));
            begun = (course[to].0, mean_c);
        }
        steps.extend(timed(begun, *last, 0.0));
        if steps.len() > MAX_STRETCHES {
            return Err(ChamberPlanError::new("it has more than 1000 stretches at rest; is that its air?"));
        }
        Ok(Self { name: String::from("what the chamber did"), steps, ..Self::default() })
    }

    /// Returns the set points at the beginning and the end of a step, °C. The first step begins and ends at its own
    /// set point. After the last step, the end is `safe_c`.
    #[must_use]
    pub fn course_c(&self, step: usize) -> (f64, f64) {
        let to_c = |index: usize| self.steps.get(index).map_or(self.safe_c, |step| step.to_c);
        (to_c(step.saturating_sub(1)), to_c(step))
    }

    /// Returns the coldest and the warmest set point, °C.
    #[must_use]
    pub fn span_c(&self) -> (f64, f64) {
        let temps = self.steps.iter().map(|step| step.to_c);
        temps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
    }

    /// Returns the length of an average, s: the planned one, or the time at which the Allan deviation of this part
    /// is lowest ([`NoiseModel::best_averaging_s`](crate::noise::NoiseModel::best_averaging_s)), within 30 … 3600 s.
    /// The white noise of each axis is the measured one, or the typical one. The axis with the longest time decides.
    #[must_use]
    pub fn average_s(&self, planned_s: Option<f64>, part: &Part, white_dps_per_rt_hz: &[Option<f64>]) -> f64 {
        let best_s = |(axis, white): (&NamedAxis, &Option<f64>)| {
            let mut noise = axis.axis.typical_noise();
            noise.white_dps_per_rt_hz = white.unwrap_or(noise.white_dps_per_rt_hz);
            noise.best_averaging_s()
        };
        let best_s = || part.axes.iter().zip(white_dps_per_rt_hz).map(best_s).fold(0.0, f64::max);
        planned_s.unwrap_or_else(|| libm::ceil(best_s().clamp(AVERAGE_S.0, AVERAGE_S.1)))
    }

    /// Returns the largest allowed drift of the part's own temperature at a soak point, °C/s: the planned limit, or
    /// the drift that changes the bias during an average by as much as its noise, σ(τ)/(|tempco| τ), with the typical
    /// values of the most sensitive axis. If these values are not known, the limit is 0.05 °C/min.
    #[must_use]
    pub fn drift_c_per_s(&self, average_s: f64, part: &Part) -> f64 {
        if let Some(c_per_min) = self.drift_c_per_min {
            return c_per_min / 60.0;
        }
        let least = part.axes.iter().filter_map(|axis| {
            let (noise, tempco) = (axis.axis.noise?.model(), axis.axis.bias.tempco_dps_per_c?.abs());
            (tempco > 0.0).then(|| libm::sqrt(noise.allan_variance(average_s)) / (tempco * average_s))
        });
        least.reduce(f64::min).unwrap_or(DRIFT_C_PER_MIN / 60.0)
    }

    /// Returns the least time from the beginning of a step to the end of the plan, s. It assumes that a soak point
    /// settles within one window and is averaged for the planned time, or for as long as a typical part needs.
    #[must_use]
    pub fn least_s(&self, from_step: usize, part: &Part) -> f64 {
        let typical: Vec<Option<f64>> = part.axes.iter().map(|_| None).collect();
        let of_step = |index: usize| {
            let (from_c, _) = self.course_c(index);
            let step = &self.steps[index];
            step.ramp_s(from_c)
                + match step.end {
                    StepEnd::Hold(hold_s) => hold_s,
                    StepEnd::Average(planned_s) => self.window_s + self.average_s(planned_s, part, &typical),
                }
        };
        (from_step..self.steps.len()).map(of_step).sum()
    }

    /// Checks that a part can be measured by this plan.
    ///
    /// # Errors
    /// Returns an error if an average is `auto` and the noise of the part is not known.
    pub fn fits(&self, part: &Part) -> Result<(), ChamberPlanError> {
        let auto = self.steps.iter().any(|step| step.end == StepEnd::Average(None));
        match part.axes.iter().find(|axis| axis.axis.noise.is_none()) {
            Some(axis) if auto => Err(ChamberPlanError::new(alloc::format!(
                "average_s = \"auto\" needs the noise of the part, and axis {} of {} states none: give average_s as a \
                 number of seconds, or [noise] in the file of the part (docs/formats/part.md)",
                axis.name,
                part.name
            ))),
            _ => Ok(()),
        }
    }

    /// Checks that the part withstands every temperature of this plan. Call this before anything is heated or
    /// cooled. A plan for a recording needs no such check, because the part was at these temperatures already.
    ///
    /// # Errors
    /// Returns an error if a set point, or the temperature after the measurement, is beyond [`Part::operating_c`].
    pub fn spares(&self, part: &Part) -> Result<(), ChamberPlanError> {
        let Some((low_c, high_c)) = part.operating_c else { return Ok(()) };
        let set_points = self.steps.iter().enumerate().map(|(index, step)| (Some(index + 1), step.to_c));
        let beyond = |(_, to_c): &(Option<usize>, f64)| !(low_c..=high_c).contains(to_c);
        let Some((step, to_c)) = set_points.chain([(None, self.safe_c)]).find(beyond) else { return Ok(()) };
        let what = step.map_or("safe_c".into(), |step| alloc::format!("to_c of step {step}"));
        Err(ChamberPlanError::new(alloc::format!(
            "{what} is {to_c} °C, and the {} may be at {low_c} to {high_c} °C only (operating_c of the part); give a \
             temperature between these",
            part.name
        )))
    }
}

const LESS: core::cmp::Ordering = core::cmp::Ordering::Less;
/// The air is at rest if it stays within `STAYS_C`, °C, for `STAYS_S`, s.
const STAYS_C: f64 = 1.0;
const STAYS_S: f64 = 300.0;
const MAX_STRETCHES: usize = 1000;

/// Returns the first and last row of each stretch in which the air was at rest.
fn stays(course: &[(f64, f64)]) -> Vec<(usize, usize)> {
    let (mut stays, mut from) = (Vec::new(), 0);
    while from < course.len() {
        let (mut low, mut high, mut to) = (course[from].1, course[from].1, from);
        while let Some((_, c)) = course.get(to + 1) {
            (low, high) = (low.min(*c), high.max(*c));
            if high - low > STAYS_C {
                break;
            }
            to += 1;
        }
        let is_long = course[to].0 - course[from].0 >= STAYS_S;
        stays.extend(is_long.then_some((from, to)));
        from = if is_long { to + 1 } else { from + 1 };
    }
    stays
}

/// Makes a step with a ramp that arrives at a time and a temperature, and a hold after it. If the temperature does not
/// change, the step holds for the time of the ramp as well. `None` if neither ramp nor hold takes time.
fn timed((from_s, from_c): (f64, f64), (to_s, to_c): (f64, f64), hold_s: f64) -> Option<Step> {
    let (ramp_s, way_c) = (to_s - from_s, (to_c - from_c).abs());
    let is_ramp = ramp_s > 0.0 && way_c > 0.0;
    let c_per_min = is_ramp.then(|| way_c / ramp_s * 60.0);
    let hold_s = if is_ramp { hold_s } else { hold_s + ramp_s.max(0.0) };
    (is_ramp || hold_s > 0.0).then_some(Step { to_c, c_per_min, end: StepEnd::Hold(hold_s) })
}

/// The error of a plan that cannot be read or carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChamberPlanError(String);

impl ChamberPlanError {
    fn new(what: impl Into<String>) -> Self {
        Self(what.into())
    }
}

#[cfg(feature = "file")]
impl From<zerorate_allan::entry::EntryError> for ChamberPlanError {
    fn from(error: zerorate_allan::entry::EntryError) -> Self {
        Self(alloc::string::ToString::to_string(&error))
    }
}

impl fmt::Display for ChamberPlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for ChamberPlanError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::Axis;
    use alloc::vec;

    #[test]
    fn a_timed_step_ramps_if_temperature_and_time_change_and_otherwise_holds() {
        let step = |c_per_min, hold_s| Some(Step { to_c: 50.0, c_per_min, end: StepEnd::Hold(hold_s) });
        let to_half = |from: (f64, f64)| timed(from, (600.0, 50.0), 60.0);
        assert_eq!(to_half((0.0, 20.0)), step(Some(3.0), 60.0));
        assert_eq!(to_half((0.0, 50.0)), step(None, 660.0), "no way");
        assert_eq!(to_half((700.0, 20.0)), step(None, 60.0), "no time");
        assert_eq!(timed((600.0, 50.0), (600.0, 50.0), 0.0), None);
    }

    fn plan() -> ChamberPlan {
        let soak = |to_c| Step { to_c, c_per_min: Some(2.0), end: StepEnd::Average(None) };
        ChamberPlan { steps: vec![soak(15.0), soak(55.0)], ..ChamberPlan::default() }
    }

    /// The best averaging time is √1.5 · 0.0125/10⁻⁴ = 153.1 s (F-02, M-04). There the Allan deviation is √(d²/(2τ) +
    /// floor² + K²τ/3) = 0.00189 °/s, d = 0.0125. With 0.04 °/s/°C (F-05), a drift of 0.0184 °C/min changes the bias
    /// by as much in 154 s.
    #[test]
    fn averages_last_to_the_lowest_allan_deviation_and_the_drift_stays_below_it() {
        let (plan, part) = (plan(), Part::ADIS16130);
        assert_eq!(plan.average_s(None, &part, &[None]), 154.0);
        assert_eq!(plan.average_s(None, &part, &[Some(0.025)]), 307.0);
        assert_eq!(plan.average_s(Some(20.0), &part, &[None]), 20.0);
        let drift_c_per_min = plan.drift_c_per_s(154.0, &part) * 60.0;
        assert!((drift_c_per_min - 0.0184).abs() < 1e-4, "{drift_c_per_min}");
        let wide = ChamberPlan { drift_c_per_min: Some(0.3), ..plan };
        assert_eq!(wide.drift_c_per_s(154.0, &part), 0.3 / 60.0);
        let mut steady = part;
        steady.axes.to_mut()[0].axis.bias.tempco_dps_per_c = Some(0.0);
        let default = ChamberPlan { drift_c_per_min: None, ..wide };
        assert_eq!(default.drift_c_per_s(154.0, &steady), DRIFT_C_PER_MIN / 60.0, "no drift shows in its rate");
    }

    /// The air stays at 25 °C for 300 s, rises for 600 s and stays at 45 °C for 900 s. It is read every 10 s, with
    /// errors of up to 0.1 °C.
    #[test]
    fn the_steps_of_a_chamber_become_a_plan_by_the_clock() {
        let air_c = |s: f64| 25.0 + ((s - 300.0) / 30.0).clamp(0.0, 20.0);
        let noise_c = |k: u32| if k.is_multiple_of(3) { 0.1 } else { -0.05 };
        let course: Vec<(f64, f64)> =
            (0..=180).map(|k| (f64::from(k) * 10.0, air_c(f64::from(k) * 10.0) + noise_c(k))).collect();
        let plan = ChamberPlan::of_course(&course).unwrap();
        let mut at_s = 0.0;
        let ends: Vec<(f64, f64)> = (0..plan.steps.len())
            .map(|index| {
                let StepEnd::Hold(hold_s) = plan.steps[index].end else { panic!("by the clock") };
                at_s += plan.steps[index].ramp_s(plan.course_c(index).0) + hold_s;
                (at_s, plan.steps[index].to_c)
            })
            .collect();
        assert_eq!(ends.len(), 2, "{plan:?}");
        assert!((ends[0].0 - 320.0).abs() < 30.0 && (ends[0].1 - 25.0).abs() < 0.1, "{ends:?}");
        assert!((ends[1].0 - 1800.0).abs() < 1e-6 && (ends[1].1 - 45.0).abs() < 0.1, "{ends:?}");
        let text = alloc::format!("{}", ChamberPlan::of_course(&[(0.0, 1.0), (0.0, 2.0)]).unwrap_err());
        assert!(text.contains("row 2"), "{text}");
        assert!(ChamberPlan::of_course(&course[..1]).is_err());
    }

    /// By F-08, the part operates from −40 to +85 °C.
    #[test]
    fn a_plan_beyond_the_limits_of_the_part_is_not_carried_out() {
        let at = |to_c, safe_c| ChamberPlan {
            steps: vec![
                Step { to_c: 25.0, c_per_min: None, end: StepEnd::Hold(60.0) },
                Step { to_c, ..plan().steps[0] },
            ],
            safe_c,
            ..plan()
        };
        for (to_c, safe_c, why) in [
            (250.0, 25.0, "to_c of step 2 is 250 °C, and the ADIS16130 may be at -40 to 85 °C"),
            (-40.1, 25.0, "to_c of step 2 is -40.1 °C"),
            (f64::NAN, 25.0, "to_c of step 2 is NaN °C"),
            (30.0, 90.0, "safe_c is 90 °C"),
        ] {
            let text = alloc::format!("{}", at(to_c, safe_c).spares(&Part::ADIS16130).unwrap_err());
            assert!(text.contains(why), "{text}");
        }
        assert!(at(-40.0, 85.0).spares(&Part::ADIS16130).is_ok());
        let unknown = Part { operating_c: None, ..Part::ADIS16130 };
        assert!(at(250.0, 25.0).spares(&unknown).is_ok(), "nobody knows its limits");
    }

    #[test]
    fn a_part_without_noise_needs_its_averages_stated() {
        let axis = NamedAxis { axis: Axis { noise: None, ..Axis::ADIS16130 }, ..Part::ADIS16130.axes[0].clone() };
        let part = Part { axes: vec![axis].into(), ..Part::ADIS16130 };
        let text = alloc::format!("{}", plan().fits(&part).unwrap_err());
        assert!(text.contains("give average_s as a number of seconds"), "{text}");
        assert!(plan().fits(&Part::ADIS16130).is_ok());
    }
}
