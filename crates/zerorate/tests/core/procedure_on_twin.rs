//! Runs the procedure with the driver on the twin. A good unit gives the right numbers, and a bad unit gives a refusal
//! that names the cause.

use crate::unit::{SHORT, Unit};
use adis16130::{Config, SamplerConfig};
use adis16130_twin::{Fault, Motion, Spec, Truth};
use zerorate::{
    Action, Axis, Deviation, Event, Finding, FixedProcedure, Method, Outcome, Plan, Procedure, Reading, Refusal,
    Remedy, State, Warning, WindowWarnings,
};

/// A unit that warms itself with a time constant of 30 s. It has no curvature and no hysteresis, because measurements
/// at two temperatures cannot show them.
fn quick(seed: u64) -> Spec {
    Spec { warmup_s: 30.0, curvature_dps_per_c2: 0.0, hysteresis_dps: 0.0, ..Spec::from_seed(seed) }
}

struct Measured {
    outcome: Outcome,
    truth: Truth,
}

fn measure(spec: Spec, plan: Plan) -> Result<Measured, Refusal> {
    measure_changed(Unit::of(spec), plan, |_| ())
}

fn measure_with(spec: Spec, plan: Plan, config: Config, sampling: SamplerConfig) -> Result<Measured, Refusal> {
    measure_changed(Unit::new(spec, config, sampling), plan, |_| ())
}

fn measure_changed(mut unit: Unit, plan: Plan, mut change: impl FnMut(&mut Reading)) -> Result<Measured, Refusal> {
    let (mut procedure, mut truth) = (started(&Axis::ADIS16130, plan, &unit), unit.twin.truth());
    while procedure.next() == Action::Read {
        let before = procedure.progress().state;
        let mut reading = unit.read();
        change(&mut reading);
        procedure.handle(Event::Reading(&reading))?;
        if before == State::Offset {
            truth = unit.twin.truth();
        }
    }
    Ok(Measured { outcome: procedure.finish()?, truth })
}

/// A procedure that waits for the readings of a unit.
fn started(axis: &Axis, plan: Plan, unit: &Unit) -> Procedure {
    let mut procedure = Procedure::new(axis, plan).expect("a plan that makes sense");
    assert_eq!(procedure.next(), Action::Initialise);
    procedure.handle(Event::Initialised { t_ns: unit.twin.now_ns() }).expect("a beginning");
    procedure
}

fn refused(spec: Spec, plan: Plan) -> Refusal {
    match measure(spec, plan) {
        Ok(Measured { outcome, .. }) => panic!("not refused: {outcome:?}"),
        Err(refusal) => refusal,
    }
}

fn codes(outcome: &Outcome) -> Vec<&'static str> {
    outcome.warnings.iter().map(Warning::code).collect()
}

#[test]
fn a_noiseless_unit_comes_out_to_the_digit() {
    let unit = Spec { noise: false, warmup_s: 5.0, ..quick(1) };
    let spec = Spec { bias_dps: 0.8, tempco_dps_per_c: 0.04, sensitivity_error: 0.0, ..unit };
    let Measured { outcome, truth } = measure(spec, SHORT).unwrap();
    let correction = outcome.correction;
    assert!((correction.btc_dps_per_c + 0.04).abs() < 1e-5, "{correction:?}");
    assert!((correction.pbc_dps - truth.pbc_dps(correction.t3_c)).abs() < 1e-4, "{correction:?}");
    let by_hand = -(0.8 + 0.04 * (correction.t3_c - 25.0));
    assert!((correction.pbc_dps - by_hand).abs() < 1e-3, "{correction:?} against {by_hand}");
}

#[test]
fn noisy_units_come_out_within_their_uncertainty() {
    for seed in 1..=4 {
        let measured = measure(quick(seed), SHORT).unwrap();
        let ((pbc, btc), u) = (errors(&measured), measured.outcome.uncertainty);
        assert!(pbc.abs() < 4.0 && btc.abs() < 4.0, "seed {seed}: {pbc} u, {btc} u");
        assert!(u.u_pbc_dps < 0.005 && u.u_btc_dps_per_c < 0.004, "seed {seed}: {u:?}");
    }
}

#[test]
fn the_run_is_described() {
    let spec = Spec { mclk_hz: 6.06e6, ..quick(2) };
    let Measured { outcome, .. } = measure(spec, SHORT).unwrap();
    let pairs_hz = 6.06e6 / (2.0 * 527.0);
    assert!((outcome.rate_hz / pairs_hz - 1.0).abs() < 1e-4, "F-31: {}", outcome.rate_hz);
    assert!((outcome.rdy_hz / pairs_hz - 1.0).abs() < 1e-4, "F-32: {}", outcome.rdy_hz);
    assert_eq!(outcome.lost_samples, 0);
    assert!((outcome.duration_s - SHORT.total_s()).abs() < 0.01);
    assert!((outcome.noise.model.white_dps_per_rt_hz / 0.0125 - 1.0).abs() < 0.15, "F-02: {:?}", outcome.noise);
    let means = outcome.means.unwrap();
    assert!(outcome.temp_min_c < means.t1_c && means.t2_c < outcome.temp_max_c);
    assert_eq!(codes(&outcome), ["earth-included", "short-average"]);
}

#[test]
fn lost_samples_are_reported() {
    let mut number = 0;
    let lose = |reading: &mut Reading| {
        number += 1;
        reading.lost += u32::from(number % 100_000 == 0);
    };
    let outcome = measure_changed(Unit::of(quick(2)), SHORT, lose).unwrap().outcome;
    let lost = outcome.lost_samples;
    assert!(lost > 3 && lost == outcome.samples / 100_000, "{lost} of {}", outcome.samples);
    let told = |warning: &Warning| matches!(*warning, Warning::Lost { lost: told, .. } if told == lost);
    assert!(outcome.warnings.iter().any(told), "{:?}", outcome.warnings);
}

#[test]
fn the_earth_is_subtracted_only_when_it_is_given() {
    let without = measure(quick(3), SHORT).unwrap().outcome;
    let with = measure(quick(3), Plan { earth_dps: Some(0.003), ..SHORT }).unwrap().outcome;
    assert!((with.correction.pbc_dps - without.correction.pbc_dps - 0.003).abs() < 1e-12);
    assert!(codes(&without).contains(&"earth-included") && !codes(&with).contains(&"earth-included"));
    let Some(assumed) = with.warnings.iter().find(|warning| warning.code() == "earth-subtracted") else { panic!() };
    assert!(assumed.to_string().contains("+0.00300 °/s of Earth rotation was subtracted"), "{assumed}");
}

#[test]
fn curvature_is_in_the_uncertainty_unless_the_unit_is_said_to_be_linear() {
    let linear = measure(quick(4), SHORT).unwrap().outcome.uncertainty;
    let plan = Plan { assume_linear: false, ..SHORT };
    let outcome = measure(quick(4), plan).unwrap().outcome;
    assert_eq!(linear.u_curvature_dps_per_c, 0.0);
    assert!(outcome.uncertainty.u_btc_dps_per_c > 2.0 * linear.u_btc_dps_per_c);
    assert!(codes(&outcome).contains(&"curvature-unseen"));
    let wanted = Plan { max_u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c * 0.8, ..plan };
    assert!(matches!(refused(quick(4), wanted), Refusal::Curvature { .. }));
}

/// On the wrong edge of a pulsing data-ready line (F-32), a host counts two edges per sample and reads no temperature.
/// The procedure refuses after 30 to 31 s.
#[test]
fn the_wrong_edge_is_refused_within_half_a_minute() {
    for method in [Method::Warmup, Method::Cycle, Method::An1042] {
        let mut unit = Unit::of(quick(1));
        let plan = Plan { method, average_s: 60.0, settle_s: 600.0, ..SHORT };
        let mut procedure = started(&Axis::ADIS16130, plan, &unit);
        let refusal = (0..).step_by(2).find_map(|seq| {
            let reading = Reading { seq, temp: None, ..unit.read() };
            procedure.handle(Event::Reading(&reading)).err()
        });
        assert!((30.0..31.0).contains(&procedure.progress().elapsed_s), "{:?}", procedure.progress());
        let refusal = refusal.expect("a refusal");
        assert!(matches!(refusal, Refusal::NoTemperature { wrong_edge: true, .. }), "{refusal}");
        assert!(refusal.to_string().contains("two edges for each sample"), "{refusal}");
        assert_eq!(refusal.remedies(), [Remedy::OtherEdge]);
    }
}

#[test]
fn a_last_second_without_a_temperature_is_refused_when_it_is_over() {
    let mut unit = Unit::of(quick(1));
    let mut procedure = started(&Axis::ADIS16130, SHORT, &unit);
    let last_s = SHORT.total_s() - SHORT.final_temp_s;
    let refusal = loop {
        let mut reading = unit.read();
        reading.temp = reading.temp.filter(|_| procedure.progress().elapsed_s < last_s - 0.5);
        match procedure.handle(Event::Reading(&reading)) {
            Ok(()) => assert_eq!(procedure.next(), Action::Read, "it is not done"),
            Err(refusal) => break refusal,
        }
    };
    assert!(matches!(refusal, Refusal::NoTemperature { window: State::FinalTemperature, .. }), "{refusal}");
}

/// The edges are right, and the host never reads the temperature.
#[test]
fn a_temperature_that_is_never_read_is_told_from_the_wrong_edge() {
    let plan = Plan { method: Method::Warmup, ..SHORT };
    let never = SamplerConfig::default().with_every_temp(0);
    let Err(refusal) = measure_with(quick(1), plan, Config::default(), never) else { panic!("not refused") };
    assert!(matches!(refusal, Refusal::NoTemperature { wrong_edge: false, .. }), "{refusal}");
    assert_eq!(refusal.remedies(), [Remedy::ReadTemperatureMore]);
}

fn found(outcome: &Outcome) -> Vec<Finding> {
    let finding = |warning: &Warning| if let Warning::Found(finding) = warning { Some(*finding) } else { None };
    outcome.warnings.iter().filter_map(finding).collect()
}

/// The errors of PBC and BTC in stated standard uncertainties.
fn errors(measured: &Measured) -> (f64, f64) {
    let (correction, u) = (measured.outcome.correction, measured.outcome.uncertainty);
    let pbc_dps = correction.pbc_dps - measured.truth.pbc_dps(correction.t3_c);
    let btc_dps_per_c = correction.btc_dps_per_c - measured.truth.btc_dps_per_c(correction.t3_c);
    (pbc_dps / u.u_pbc_dps, btc_dps_per_c / u.u_btc_dps_per_c)
}

fn stepped(mv: f64, at_s: f64) -> Spec {
    Spec { supply_step_mv: mv, fault_at_s: Some(at_s), ..quick(8) }
}

/// Accepts a BTC with an uncertainty of up to 1 °/s/°C, so that disturbed units give a result too.
const LENIENT: Plan = Plan { max_u_btc_dps_per_c: 1.0, ..SHORT };

/// Supply steps inside the averages and between them are found within 3 s of their time, and the uncertainty allows
/// for them.
#[test]
fn a_supply_step_is_a_warning_with_its_time_and_widens_what_it_spoils() {
    let steps = [(250.0, 100.0), (400.0, 3.0), (-400.0, 62.5), (200.0, 135.0), (-300.0, 141.5)];
    for (mv, at) in steps {
        let measured = measure(stepped(mv, at), LENIENT).unwrap();
        let seen = found(&measured.outcome);
        let Some(Deviation::Step { at_s, size_dps, .. }) = seen.first().map(|finding| finding.deviation) else {
            panic!("{mv} mV at {at} s: {:?}", measured.outcome.warnings)
        };
        assert!(
            (at_s - at).abs() < 3.0 && (size_dps - mv * 0.0002).abs() < 0.02,
            "{mv} mV: {size_dps} °/s at {at_s} s"
        );
        let (pbc, btc) = errors(&measured);
        assert!(pbc.abs() < 2.5 && btc.abs() < 2.5, "{mv} mV at {at} s: {pbc} u, {btc} u");
    }
}

/// If the step counted as flicker, it would spoil BTC.
#[test]
fn a_step_inside_step_8_is_not_taken_for_a_lack_of_temperature() {
    let outcome = measure(stepped(300.0, 134.0), SHORT).unwrap().outcome;
    assert_eq!(found(&outcome).len(), 1, "{:?}", outcome.warnings);
    assert!(!outcome.noise.flicker_measured && outcome.uncertainty.u_pbc_dps > 0.01, "{outcome:?}");
    let ordinary = measure(quick(8), SHORT).unwrap().outcome;
    assert_eq!(found(&ordinary), []);
    assert!(outcome.uncertainty.u_btc_dps_per_c < 1.05 * ordinary.uncertainty.u_btc_dps_per_c, "{outcome:?}");
}

type IsCause = fn(&Deviation) -> bool;

#[test]
fn curvature_lag_and_hysteresis_show_in_the_warm_up() {
    let unit = || quick(13);
    let curved = Spec { curvature_dps_per_c2: 0.006, ..unit() };
    let lagging = Spec { lag_s: 20.0, ..unit() };
    let held = Spec { hysteresis_dps: 0.1, ..unit() };
    let causes: [(Spec, IsCause); 3] = [
        (curved, |deviation| matches!(deviation, Deviation::Curvature { .. })),
        (lagging, |deviation| matches!(deviation, Deviation::Lag { .. })),
        (held, |deviation| matches!(deviation, Deviation::Hysteresis { .. })),
    ];
    for (spec, is_cause) in causes {
        let refusal = refused(spec.clone(), Plan { max_u_btc_dps_per_c: 0.003, ..SHORT });
        assert!(matches!(refusal, Refusal::Found { finding, .. } if is_cause(&finding.deviation)), "{refusal:?}");
        let measured = measure(spec, LENIENT).unwrap();
        assert!(found(&measured.outcome).iter().any(|finding| is_cause(&finding.deviation)));
        let (pbc, btc) = errors(&measured);
        assert!(pbc.abs() < 2.5 && btc.abs() < 2.5, "{pbc} u, {btc} u: {:?}", measured.outcome.warnings);
    }
    let stuck = measure(Spec { hysteresis_dps: 2.0, ..unit() }, SHORT).unwrap().outcome;
    assert!(codes(&stuck).contains(&"flat-bias"), "{:?}", stuck.warnings);
}

/// The sway has a period of half the procedure. Each average looks like rest, but the measurement as a whole does not.
#[test]
fn slow_sway_shows_between_the_averages() {
    let swaying = |sway_dps| Spec { motion: Motion::Sway, sway_dps, sway_hz: 0.014, ..quick(14) };
    let measured = measure(swaying(0.04), LENIENT).unwrap();
    assert!(codes(&measured.outcome).contains(&"swaying"), "{:?}", measured.outcome.warnings);
    let (pbc, btc) = errors(&measured);
    assert!(pbc.abs() < 2.5 && btc.abs() < 2.5, "{pbc} u, {btc} u");
    let far = refused(swaying(0.3), LENIENT);
    assert!(matches!(far, Refusal::BaseMotion { .. } | Refusal::Moving { .. }), "{far}");
}

/// In AN-1042, the temperature drifts during step 8, so PBC is wrong by the effect of the drift up to T3. The sign of
/// this error is known, and the stated u includes it.
#[test]
fn the_drift_from_step_8_to_t3_is_reported_with_its_sign() {
    let drifting = Spec { noise: false, warmup_s: 400.0, tempco_dps_per_c: 0.04, ..quick(15) };
    let measured = measure(drifting, Plan { max_u_btc_dps_per_c: 0.05, ..SHORT }).unwrap();
    let (correction, u) = (measured.outcome.correction, measured.outcome.uncertainty);
    let error_dps = correction.pbc_dps - measured.truth.pbc_dps(correction.t3_c);
    assert!(u.drift_dps > 0.002 && (error_dps / u.drift_dps - 1.0).abs() < 0.05, "{error_dps}, {u:?}");
    assert!(u.u_pbc_dps > u.drift_dps);
}

#[test]
fn sixteen_bits_and_rare_temperatures_do_as_well() {
    let config = Config::default().with_width(adis16130::Width::Bits16);
    let sampling = SamplerConfig::default().with_every_temp(57);
    let Measured { outcome, truth } = measure_with(quick(9), SHORT, config, sampling).unwrap();
    let correction = outcome.correction;
    assert!((correction.pbc_dps - truth.pbc_dps(correction.t3_c)).abs() < 4.0 * outcome.uncertainty.u_pbc_dps);
    assert_eq!(outcome.lost_samples, 0);
}

#[test]
fn a_divider_below_twice_the_bandwidth_warns() {
    let sampling = SamplerConfig::default().with_divider(50);
    let outcome = measure_with(quick(10), SHORT, Config::default(), sampling).unwrap().outcome;
    assert!((outcome.rate_hz - 223.0).abs() < 5.0, "F-56: {}", outcome.rate_hz);
    assert!(codes(&outcome).contains(&"aliased"));
}

type FixedOutcome = Outcome<WindowWarnings>;

/// The results of [`Procedure`] and of [`FixedProcedure`] over the same samples.
fn both(spec: Spec, plan: Plan) -> (Result<Outcome, Refusal>, Result<FixedOutcome, Refusal>) {
    let mut unit = Unit::of(spec);
    let mut full = started(&Axis::ADIS16130, plan, &unit);
    let mut fixed = FixedProcedure::on_fixed_memory(&Axis::ADIS16130, plan).unwrap();
    let mut seen = (Ok(()), fixed.handle(Event::Initialised { t_ns: unit.twin.now_ns() }));
    while (seen.0.is_ok() && full.next() == Action::Read) || (seen.1.is_ok() && fixed.next() == Action::Read) {
        let sample = unit.read();
        if seen.0.is_ok() {
            seen.0 = full.handle(Event::Reading(&sample));
        }
        if seen.1.is_ok() {
            seen.1 = fixed.handle(Event::Reading(&sample));
        }
        if seen == (Ok(()), Ok(())) {
            assert_eq!((full.next(), full.progress()), (fixed.next(), fixed.progress()));
        }
    }
    (seen.0.and_then(|()| full.finish()), seen.1.and_then(|()| fixed.outcome()))
}

#[test]
fn fixed_memory_gives_the_same_numbers_bit_for_bit() {
    for (seed, plan) in [(11, SHORT), (12, Plan { earth_dps: Some(0.003), ..SHORT })] {
        let (full, fixed) = both(quick(seed), plan);
        let (full, fixed) = (full.unwrap(), fixed.unwrap());
        assert_eq!(
            (full.correction, full.uncertainty, full.noise),
            (fixed.correction, fixed.uncertainty, fixed.noise)
        );
        assert_eq!(full.means, fixed.means);
        assert_eq!((full.temp_min_c, full.temp_max_c), (fixed.temp_min_c, fixed.temp_max_c));
        assert_eq!(
            (full.samples, full.lost_samples, full.rate_hz),
            (fixed.samples, fixed.lost_samples, fixed.rate_hz)
        );
        let mut warnings: Vec<Warning> = fixed.warnings.iter().copied().collect();
        assert_eq!(warnings.pop(), Some(Warning::HourUnchecked), "what it does not look for, it says");
        assert_eq!(full.warnings, warnings);
    }
}

type IsReason = fn(&Refusal) -> bool;

#[test]
fn fixed_memory_refuses_for_the_same_reasons() {
    let cases: [(Spec, IsReason); 7] = [
        (Spec { motion: Motion::Bump, fault_at_s: Some(1.0), ..quick(5) }, |refusal| {
            matches!(refusal, Refusal::Moving { .. } | Refusal::Noisy { .. })
        }),
        (Spec { motion: Motion::Sway, ..quick(5) }, |refusal| {
            matches!(refusal, Refusal::Moving { window: State::FirstAverage, .. } | Refusal::Noisy { .. })
        }),
        (Spec { warmup_c: 0.0, ambient_c: -40.0, ..quick(6) }, |refusal| {
            let is_cold = |of_c: f64| (of_c + 40.0).abs() < 0.3;
            matches!(*refusal, Refusal::Span { t1_c, t2_c, .. } if is_cold(t1_c) && is_cold(t2_c))
        }),
        (Spec { fault: Fault::Frozen, fault_at_s: Some(15.0), ..quick(7) }, |refusal| {
            matches!(refusal, Refusal::Frozen { .. })
        }),
        (Spec { rotation_dps: 30.0, ..quick(7) }, |refusal| matches!(refusal, Refusal::Turning { .. })),
        (Spec { rotation_dps: 400.0, ..quick(7) }, |refusal| matches!(refusal, Refusal::Overranged { .. })),
        (Spec { fault: Fault::RdyStutter, ..quick(7) }, |refusal| matches!(refusal, Refusal::Stuttering { .. })),
    ];
    for (spec, is_reason) in cases {
        let (full, fixed) = both(spec, SHORT);
        let refusal = full.unwrap_err();
        assert!(is_reason(&refusal), "{refusal:?}");
        assert_eq!(refusal, fixed.unwrap_err());
    }
}

/// The rotation is five times the spread of the bias over units (M-01).
#[test]
fn a_constant_rotation_far_above_the_typical_bias_is_warned_of() {
    for seed in 1..6 {
        let still = measure(quick(seed), SHORT).unwrap().outcome;
        let turning = measure(Spec { rotation_dps: 5.0, ..quick(seed) }, SHORT).unwrap().outcome;
        assert!(!codes(&still).contains(&"turning") && codes(&turning).contains(&"turning"), "seed {seed}");
    }
}

/// [`Procedure`] recognises such a step and gives a warning. [`FixedProcedure`] looks for no steps on purpose.
#[test]
fn a_small_step_inside_an_average_is_motion_for_the_fixed_procedure() {
    let during_offset = Spec { supply_step_mv: 400.0, fault_at_s: Some(134.0), ..quick(8) };
    let (full, fixed) = both(during_offset, Plan { max_u_btc_dps_per_c: 0.05, ..SHORT });
    assert!(codes(&full.unwrap()).contains(&"step"));
    assert!(matches!(fixed.unwrap_err(), Refusal::Moving { window: State::Offset, .. } | Refusal::Noisy { .. }));
    let small = Spec { supply_step_mv: 120.0, fault_at_s: Some(134.0), ..quick(8) };
    let (full, fixed) = both(small, SHORT);
    assert!(codes(&full.unwrap()).contains(&"step"));
    assert!(matches!(fixed, Err(Refusal::Unsteady { .. }) | Ok(_)), "{fixed:?}");
}

#[test]
fn a_part_of_which_little_is_known_is_calibrated_with_warnings() {
    let known = Axis::ADIS16130;
    let unknown = Axis { range_dps: None, noise: None, bias: zerorate::TypicalBias::default(), ..known };
    let plan = Plan { warmup_s: 60.0, settle_s: 400.0, offset_s: 20.0, max_u_btc_dps_per_c: 0.2, ..Plan::default() };
    let outcome = calibrated(&unknown, plan);
    let codes: Vec<_> = outcome.warnings.iter().map(Warning::code).collect();
    for code in ["rest-unjudged", "hour-unchecked", "curvature-unknown"] {
        assert!(codes.contains(&code), "no {code} in {codes:?}");
    }
    assert!(!codes.contains(&"curvature-unseen"), "{codes:?}");
    let of_known = calibrated(&known, plan);
    assert_eq!(outcome.correction, of_known.correction, "the numbers come from the samples");
    assert!(outcome.noise.flicker_measured && outcome.noise.walk_measured);
    let ratio = outcome.uncertainty.u_pbc_dps / of_known.uncertainty.u_pbc_dps;
    assert!((0.5..4.0).contains(&ratio), "the noise of the record stands in for the typical one: {ratio}");
}

/// The Allan deviation of a recording is judged less its dependence on temperature. That takes both typical values.
#[test]
fn a_recording_without_a_known_tempco_says_that_rest_was_not_judged() {
    let known = Axis::ADIS16130;
    let unknown = Axis { bias: zerorate::TypicalBias { tempco_dps_per_c: None, ..known.bias }, ..known };
    let plan = Plan { method: Method::Warmup, settle_s: 400.0, max_u_btc_dps_per_c: 1.0, ..SHORT };
    for (axis, is_told) in [(known, false), (unknown, true)] {
        assert_eq!(codes(&calibrated(&axis, plan)).contains(&"rest-unjudged"), is_told);
    }
}

/// With half as many codes per °/s, the same codes mean twice the rate. So PBC and BTC double, and T3 stays.
#[test]
fn the_part_gives_the_scale() {
    let plan = Plan { warmup_s: 60.0, settle_s: 120.0, offset_s: 20.0, max_u_btc_dps_per_c: 0.4, ..Plan::default() };
    let fine = Axis::ADIS16130;
    let noise = fine.noise.map(|noise| zerorate::TypicalNoise {
        white_dps_per_rt_hz: 2.0 * noise.white_dps_per_rt_hz,
        flicker_floor_dps: 2.0 * noise.flicker_floor_dps,
        rate_random_walk_dps_per_rt_s: 2.0 * noise.rate_random_walk_dps_per_rt_s,
    });
    let rate = zerorate::Scale { lsb_per_unit: fine.rate.lsb_per_unit / 2.0, ..fine.rate };
    let coarse = Axis { rate, noise, range_dps: Some(500.0), ..fine };
    let (fine, coarse) = (calibrated(&fine, plan).correction, calibrated(&coarse, plan).correction);
    assert_eq!(coarse.pbc_dps, 2.0 * fine.pbc_dps);
    assert_eq!((coarse.btc_dps_per_c, coarse.t3_c), (2.0 * fine.btc_dps_per_c, fine.t3_c));
}

fn calibrated(axis: &Axis, plan: Plan) -> Outcome {
    let mut unit = Unit::of(Spec::from_seed(3));
    let mut procedure = started(axis, plan, &unit);
    while procedure.next() == Action::Read {
        procedure.handle(Event::Reading(&unit.read())).expect("a part at rest");
    }
    procedure.finish().expect("a result")
}

#[test]
fn a_forecast_ends_where_the_target_is_reached() {
    let forecast = |target_dps| Axis::ADIS16130.forecast(target_dps, 3600.0).unwrap();
    let (easy, hard) = (forecast(0.02), forecast(1e-6));
    assert!((600.0..1800.0).contains(&easy.after_s) && easy.u_dps <= 0.02, "a settled part: {easy:?}");
    assert!(hard.after_s == 3600.0 && hard.u_dps > 1e-6, "never: {hard:?}");
}
