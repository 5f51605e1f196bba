//! Tests the measurement in a chamber. The unit is a twin that gives means of 0.1 s, and this file simulates the
//! chamber.

use adis16130_twin::{Means, Motion, Spec};
use zerorate::chamber::{
    ChamberAction, ChamberPlan, ChamberProcedure, ChamberRefusal, ChamberState, Disturbance, Record, Step, StepEnd,
};
use zerorate::{Axis, NamedAxis, Part, Scan, Warning};

const PART: Part = Part::ADIS16130;

/// A unit that warms itself with a time constant of 30 s, in air whose temperature does not wander.
fn quick(seed: u64) -> Spec {
    Spec { warmup_s: 30.0, ambient_wander_c: 0.0, ..Spec::from_seed(seed) }
}

fn soak(to_c: f64) -> Step {
    Step { to_c, c_per_min: None, end: StepEnd::Average(Some(60.0)) }
}

fn plan(steps: &[Step]) -> ChamberPlan {
    ChamberPlan { steps: steps.into(), window_s: 30.0, settle_timeout_s: 1800.0, ..ChamberPlan::default() }
}

/// A unit in a chamber. The air follows the set point with a time constant of 30 s.
struct Bench {
    unit: Means,
    air_c: f64,
    /// Start and end of the time during which the door of the chamber is open, s.
    door_s: (f64, f64),
    now_s: f64,
    readings: u32,
}

impl Bench {
    fn new(spec: &Spec) -> Self {
        Self { unit: Means::new(spec, 1), air_c: spec.ambient_c, door_s: (0.0, 0.0), now_s: 0.0, readings: 0 }
    }

    /// Lets 0.1 s pass, and returns the reading of the part.
    fn scan(&mut self, set_c: f64) -> Scan {
        let is_open = self.now_s >= self.door_s.0 && self.now_s < self.door_s.1;
        let to_c = if is_open { 22.0 } else { set_c };
        self.air_c += (to_c - self.air_c) * 0.1 / 30.0;
        self.unit.set_ambient(self.air_c, 0.1);
        let mean = self.unit.next_mean();
        let from_zero =
            |value: f64, scale: zerorate::Scale| (scale.code(value).round() as i64 - scale.zero_code) as i32;
        let Axis { rate, temp, .. } = Axis::ADIS16130;
        self.now_s += 0.1;
        self.readings += 1;
        let t_ns = u64::from(self.readings) * 100_000_000 + 50_000_000;
        let scan = Scan::new(t_ns, self.readings, &[from_zero(mean.rate_dps, rate)]).expect("one axis");
        scan.with_temp(Some(from_zero(mean.temp_c, temp)))
    }

    fn run(
        &mut self,
        procedure: &mut ChamberProcedure,
        while_in: impl Fn(&ChamberProcedure) -> bool,
    ) -> Result<(), ChamberRefusal> {
        while procedure.next() != ChamberAction::Done && while_in(procedure) {
            let scan = self.scan(procedure.set_point_c());
            procedure.begin(scan.t_ns);
            procedure.take(&scan)?;
            if self.readings.is_multiple_of(10) {
                procedure.air(self.air_c)?;
            }
        }
        Ok(())
    }
}

fn procedure(steps: &[Step]) -> ChamberProcedure {
    ChamberProcedure::new(&PART, plan(steps), 0.001).expect("a plan that fits")
}

fn measured(bench: &mut Bench, steps: &[Step]) -> Result<Record, ChamberRefusal> {
    let mut procedure = procedure(steps);
    bench.run(&mut procedure, |_| true)?;
    procedure.finish()
}

#[test]
fn soak_points_are_taken_where_the_part_has_settled() {
    let mut bench = Bench::new(&quick(3));
    let record = measured(&mut bench, &[soak(10.0), soak(45.0), soak(10.0)]).expect("a good unit");
    assert_eq!(record.soaks.len(), 3);
    for soak in &record.soaks {
        let off_c = soak.temp_c - soak.set_c;
        assert!((off_c - bench.unit.truth().sensor_c + bench.air_c).abs() < 0.1, "own warmth: {soak:?}");
        assert!(soak.settled && soak.drift_c_per_min.abs() < 0.1 && soak.end_s - soak.start_s == 60.0, "{soak:?}");
        let truth_dps = bench.unit.truth().bias_dps(soak.temp_c);
        assert!((soak.rates_dps[0] - truth_dps).abs() < 0.015, "{soak:?} {truth_dps}");
    }
    assert_eq!((record.lost, record.restless()), (0, 0.0));
}

#[test]
fn ramps_and_holds_go_by_the_clock() {
    let ramp = Step { to_c: 31.0, c_per_min: Some(6.0), end: StepEnd::Hold(90.0) };
    let hold = Step { to_c: 25.0, c_per_min: None, end: StepEnd::Hold(30.0) };
    let mut bench = Bench::new(&quick(4));
    let mut procedure = procedure(&[hold, ramp]);
    bench.run(&mut procedure, |p| p.progress().elapsed_s < 60.0).expect("a good unit");
    assert_eq!((procedure.progress().state, procedure.set_point_c()), (ChamberState::Approach, 28.0));
    bench.run(&mut procedure, |_| true).expect("a good unit");
    assert_eq!(procedure.set_point_c(), 25.0, "the safe set point");
    assert_eq!(procedure.finish().expect("a record").len(), 30 + 60 + 90);
}

#[test]
fn a_measurement_goes_on_after_the_last_finished_step() {
    let steps = [soak(15.0), soak(40.0)];
    let mut bench = Bench::new(&quick(5));
    let mut first = procedure(&steps);
    bench.run(&mut first, |p| p.steps_done() == 0).expect("a good unit");
    let (record, done) = first.finished_steps();
    assert_eq!((record.soaks.len(), done), (1, 1));
    let mut second = procedure(&steps).resumed(record.clone(), done, 600.0);
    assert_eq!(second.set_point_c(), 40.0);
    Bench::new(&quick(5)).run(&mut second, |_| true).expect("a good unit");
    let whole = second.finish().expect("a record");
    assert_eq!((whole.soaks.len(), &whole.soaks[0]), (2, &record.soaks[0]));
    let last_s = record.start_s[record.len() - 1];
    assert_eq!(whole.start_s[record.len()], last_s + 601.0);
    assert!(whole.samples > record.samples);
}

#[test]
fn a_door_that_stays_open_is_named() {
    let mut bench = Bench { door_s: (0.0, 1e9), ..Bench::new(&quick(6)) };
    let refusal = measured(&mut bench, &[soak(60.0)]).expect_err("it is at 22 °C");
    assert!(matches!(refusal, ChamberRefusal::NotReached { step: 1, .. } | ChamberRefusal::NotSettled { .. }));
    assert!(refusal.to_string().to_lowercase().contains("close its door"), "{refusal}");
}

#[test]
fn a_door_opened_in_between_costs_an_average() {
    let steps = [soak(60.0)];
    let mut bench = Bench::new(&quick(7));
    let mut procedure = procedure(&steps);
    bench.run(&mut procedure, |p| p.progress().state != ChamberState::Average).expect("a good unit");
    bench.door_s = (bench.now_s + 10.0, bench.now_s + 40.0);
    bench.run(&mut procedure, |p| p.progress().state == ChamberState::Average).expect("not yet");
    assert_eq!(procedure.progress().state, ChamberState::Settle);
    bench.run(&mut procedure, |_| true).expect("it settles again");
    let record = procedure.finish().expect("a record");
    assert!((record.soaks[0].temp_c - 60.0 - 8.0).abs() < 4.0 && record.soaks[0].settled, "{:?}", record.soaks);
}

#[test]
fn a_part_that_is_shaken_is_refused() {
    let mut bench = Bench::new(&Spec { sway_dps: 0.05, ..quick(8) });
    bench.unit.set_motion(Motion::Sway);
    let refusal = measured(&mut bench, &[soak(30.0)]).expect_err("it sways");
    assert!(matches!(refusal, ChamberRefusal::Disturbed { why: Disturbance::Motion { axis: 0 }, .. }), "{refusal}");
}

#[test]
fn a_part_that_turns_too_fast_is_refused_for_its_rate() {
    let (mut bench, mut procedure) = (Bench::new(&quick(9)), procedure(&[soak(25.0)]));
    let refusal = loop {
        let scan = bench.scan(25.0).with_out_of_range(0);
        procedure.begin(scan.t_ns);
        if let Err(refusal) = procedure.take(&scan) {
            break refusal;
        }
    };
    assert!(matches!(refusal, ChamberRefusal::OutOfRange { step: 1, .. }), "{refusal}");
}

/// A rate of 2¹⁸ codes, 11 °/s, for one reading at the full rate is a bit error. The axes y and z have one each.
#[test]
fn impossible_readings_are_counted_on_the_worst_axis() {
    let axis = |name: &'static str| NamedAxis { name: name.into(), ..PART.axes[0].clone() };
    let part = Part { axes: ["x", "y", "z"].map(axis).to_vec().into(), ..PART };
    let mut procedure = ChamberProcedure::new(&part, plan(&[soak(25.0)]), 0.001).expect("a plan that fits");
    procedure.begin(0);
    for k in 0..20_u32 {
        let rate = if k == 10 { 1 << 18 } else { k as i32 % 3 };
        let scan = Scan::new(u64::from(k) * 175_667, k, &[k as i32 % 3, rate, rate]).expect("three axes");
        procedure.take(&scan).expect("the first second is not over");
    }
    assert_eq!(procedure.finished_steps().0.impossible, 1);
}

#[test]
fn air_beyond_the_plan_and_silence_end_the_measurement() {
    let mut bench = Bench::new(&quick(9));
    let mut procedure = procedure(&[soak(25.0), soak(30.0)]);
    bench.run(&mut procedure, |p| p.steps_done() == 0).expect("a good unit");
    assert!(procedure.air(36.0).is_ok(), "once may be a slip of the wire");
    let refusal = procedure.air(36.0).expect_err("5 °C above 30 °C is the most");
    assert!(matches!(refusal, ChamberRefusal::Overshoot { step: 2, high_c: 35.0, .. }), "{refusal}");

    let mut late = bench.scan(30.0);
    late.t_ns += 120_000_000_000;
    let refusal = (0..3).find_map(|_| {
        (late.t_ns, late.seq) = (late.t_ns + 100_000_000, late.seq + 1);
        procedure.take(&late).err()
    });
    assert!(matches!(refusal, Some(ChamberRefusal::Silent { step: 2, .. })), "{refusal:?}");
}

/// The part may be used from −40 to +85 °C (F-08), and a chamber may overshoot these limits by 3 °C. A first reading
/// beyond them does not widen them.
#[test]
fn air_that_harms_the_part_ends_the_measurement_from_the_first_reading_on() {
    for air_c in [500.0, 120.0, 88.1, -43.1] {
        let mut procedure = procedure(&[soak(25.0), soak(60.0)]);
        assert!(procedure.air(air_c).is_ok(), "once may be a slip of the wire");
        let refusal = procedure.air(air_c).expect_err("no part may be there");
        let expected = ChamberRefusal::BeyondPart { step: 1, air_c, low_c: -40.0, high_c: 85.0 };
        assert_eq!(refusal, expected);
    }
}

/// The air may start at 80 °C. Once below 65 °C, the limit of the plan, the air may not exceed this limit again.
#[test]
fn a_first_reading_counts_only_until_the_air_has_come_to_the_plan() {
    let mut procedure = procedure(&[soak(25.0), soak(60.0)]);
    for air_c in [80.0, 84.0, 70.0, 66.0] {
        assert!(procedure.air(air_c).is_ok(), "{air_c}: it comes");
    }
    assert!(procedure.air(64.0).is_ok() && procedure.air(66.0).is_ok(), "it has come");
    let refusal = procedure.air(66.0).expect_err("60 and 5 °C are the most");
    assert!(matches!(refusal, ChamberRefusal::Overshoot { step: 1, high_c: 65.0, .. }), "{refusal}");
}

/// Air that starts outside of the plan may overshoot its start by as much as it may overshoot the plan: 5 °C.
#[test]
fn air_that_comes_from_outside_may_overshoot_there_too() {
    for (first_c, within_c, beyond_c, low_c, high_c) in [(80.0, 84.9, 85.1, 20.0, 85.0), (0.0, -4.9, -5.1, -5.0, 65.0)]
    {
        let mut procedure = procedure(&[soak(25.0), soak(60.0)]);
        for air_c in [first_c, within_c, within_c, beyond_c] {
            assert!(procedure.air(air_c).is_ok(), "{air_c} °C from {first_c} °C");
        }
        let refusal = procedure.air(beyond_c).expect_err("5 °C beyond the first reading");
        assert_eq!(refusal, ChamberRefusal::Overshoot { step: 1, air_c: beyond_c, low_c, high_c });
    }
}

/// The slow noise of the unit is small, so that a hysteresis of ±0.002 °/s (M-02) shows in two cycles.
#[test]
fn curve_and_loop_of_a_unit_are_found_within_their_uncertainty() {
    let spec = Spec { rrw_dps_per_rt_s: 1e-6, flicker_floor_dps: 1e-4, sensitivity_error: 0.0, ..quick(11) };
    let ramp = |to_c| Step { to_c, c_per_min: Some(4.0), end: StepEnd::Hold(300.0) };
    let steps = [ramp(25.0), ramp(60.0), ramp(0.0), ramp(60.0), ramp(0.0), ramp(25.0)];
    let mut bench = Bench::new(&spec);
    let record = measured(&mut bench, &steps).expect("a good unit");
    let outcome = &record.outcomes(&PART, None, 3).expect("a curve")[0];
    let branches = outcome.branches.expect("both ways");
    let off_dps = branches.half_width_dps - 0.002;
    assert!(off_dps.abs() < 2.5 * branches.u_dps && branches.u_dps < 0.001, "{branches:?} {:?}", outcome.curve);
    crate::golden::unchanged("chamber.txt", &format!("{:?}\n{branches:?}\n{:?}\n", outcome.curve, record.soaks));
    let truth = bench.unit.truth();
    for temp_c in [10.0, 25.0, 45.0, 65.0] {
        let off_dps = outcome.curve.correction.at(temp_c) + truth.bias_dps(temp_c);
        assert!(off_dps.abs() < 0.005, "{temp_c}: {off_dps}, {:?}", outcome.curve);
    }
    assert!(outcome.soak_residuals_dps.iter().all(|left| left.abs() < 0.01), "{:?}", outcome.soak_residuals_dps);
}

#[test]
fn a_chamber_that_does_nothing_gives_no_curve() {
    let hold = Step { to_c: 25.0, c_per_min: None, end: StepEnd::Hold(600.0) };
    let mut bench = Bench::new(&Spec { warmup_c: 1.0, ..quick(12) });
    let record = measured(&mut bench, &[hold]).expect("a good unit");
    let refusal = record.outcomes(&PART, None, 3).expect_err("1 °C");
    assert!(matches!(refusal, ChamberRefusal::Span { .. }), "{refusal}");
}

/// Measures a short form of F-57: ramps of 10 °C/min to −10 °C, to 60 °C and back to 25 °C.
fn short_profile(spec: &Spec) -> Record {
    let ramp = |to_c| Step { to_c, c_per_min: Some(10.0), end: StepEnd::Hold(300.0) };
    measured(&mut Bench::new(spec), &[ramp(25.0), ramp(-10.0), ramp(60.0), ramp(25.0)]).expect("a good unit")
}

/// The supply changes the bias by 0.0002 °/s per mV (F-01). The ramps before and after the step are five times as fast
/// as in F-57.
#[test]
fn a_step_of_the_supply_is_named_and_taken_out() {
    for seed in 21..24 {
        let unit = Spec { fault_at_s: Some(1200.0), ..quick(seed) };
        let spec = Spec { supply_step_mv: 300.0, ..unit.clone() };
        let outcome = &short_profile(&spec).outcomes(&PART, None, 3).expect("a curve")[0];
        let Some(Warning::StepTaken { at_s, size_dps, u_dps }) = outcome.warnings(&Axis::ADIS16130).next() else {
            panic!("seed {seed}: no step in {:?}", outcome.curve);
        };
        assert!((at_s - 1200.0).abs() < 20.0 && (size_dps - 0.06).abs() < 4.0 * u_dps, "{at_s} {size_dps} {u_dps}");
        assert_eq!(outcome.warnings(&Axis::ADIS16130).count(), 1, "seed {seed}: {:?}", outcome.curve.steps);
        let without = &short_profile(&unit).outcomes(&PART, None, 3).expect("a curve")[0];
        for temp_c in [0.0, 30.0, 60.0] {
            let moved_dps = without.curve.correction.at(temp_c) - outcome.curve.correction.at(temp_c);
            assert!((moved_dps - 0.06).abs() < 0.01, "seed {seed} at {temp_c}: the level after it, not {moved_dps}");
        }
        let rms = |outcome: &zerorate::chamber::ChamberOutcome| {
            let squares = outcome.residuals.iter().map(|left| left.residual_dps * left.residual_dps);
            (squares.sum::<f64>() / outcome.residuals.len() as f64).sqrt()
        };
        assert!(rms(outcome) < 1.2 * rms(without), "seed {seed}: {} {}", rms(outcome), rms(without));
    }
}

#[test]
fn a_slow_sway_is_named_and_taken_out() {
    for (seed, sway_dps, sway_hz) in
        [(51, 0.049, 0.000_79), (52, 0.02, 0.000_6), (53, 0.03, 0.001_5), (54, 0.04, 0.002)]
    {
        let spec = Spec { motion: Motion::Sway, sway_dps, sway_hz, ..quick(seed) };
        let mut bench = Bench::new(&spec);
        let record = measured(&mut bench, &[soak(20.0), soak(60.0), soak(20.0)]).expect("slow enough");
        let outcome = &record.outcomes(&PART, None, 3).expect("a curve")[0];
        let (correction, truth) = (&outcome.curve.correction, bench.unit.truth());
        let off = (correction.pbc_dps - truth.pbc_dps(correction.t3_c)) / outcome.curve.covariance[0][0].sqrt();
        let codes: Vec<&str> = outcome.warnings(&Axis::ADIS16130).map(|warning| warning.code()).collect();
        assert!(off.abs() < 4.0 && codes.contains(&"swaying"), "seed {seed}: PBC off by {off} u, {codes:?}");
    }
    let spec = Spec { motion: Motion::Sway, sway_dps: 0.2, sway_hz: 0.000_7, ..quick(55) };
    let record = measured(&mut Bench::new(&spec), &[soak(20.0), soak(60.0), soak(20.0)]).expect("slow enough");
    let refusal = record.outcomes(&PART, None, 3).expect_err("0.2 °/s");
    assert!(matches!(refusal, ChamberRefusal::BaseMotion { .. }), "{refusal}");
}

#[test]
fn no_step_is_found_where_none_is() {
    for seed in 31..41 {
        let outcome = &short_profile(&quick(seed)).outcomes(&PART, None, 3).expect("a curve")[0];
        assert_eq!(outcome.warnings(&Axis::ADIS16130).collect::<Vec<_>>(), [], "seed {seed}: {:?}", outcome.curve);
        let unknown = Axis { noise: None, ..Axis::ADIS16130 };
        assert_eq!(outcome.warnings(&unknown).collect::<Vec<_>>(), [Warning::RestUnjudged]);
    }
}
