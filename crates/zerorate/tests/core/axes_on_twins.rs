//! A part with three axes: three twins on one clock and one temperature, through one procedure.

use crate::unit::Unit;
use adis16130::MCLK_HZ;
use adis16130_twin::{Motion, Spec, Truth};
use std::borrow::Cow;
use zerorate::{
    Action, Axis, AxisRefusal, Event, NamedAxis, Outcome, Part, PartProcedure, Plan, Procedure, Refusal, Scan, State,
};

const SHORT: Plan = Plan { settle_s: 40.0, ..crate::unit::SHORT };

fn part() -> Part {
    let axis = |name| NamedAxis { name: Cow::Borrowed(name), ..Part::ADIS16130.axes[0].clone() };
    Part { name: Cow::Borrowed("THREE"), axes: Cow::Owned(["x", "y", "z"].map(axis).to_vec()), ..Part::ADIS16130 }
}

/// One die with three elements: same clock and same warming, each with its own bias, coefficient and noise.
fn units(changed: impl Fn(usize, Spec) -> Spec) -> [Unit; 3] {
    let die = Spec::from_seed(1);
    [0, 1, 2].map(|index| {
        let own = Spec::from_seed(21 + index as u64);
        let spec = Spec {
            mclk_hz: f64::from(MCLK_HZ),
            ambient_wander_c: 0.0,
            warmup_s: 25.0,
            warmup_c: die.warmup_c,
            ambient_c: die.ambient_c,
            curvature_dps_per_c2: 0.0,
            hysteresis_dps: 0.0,
            ..own
        };
        Unit::of(changed(index, spec))
    })
}

/// Reads all units at one time, with the temperature of the first.
fn scan(units: &mut [Unit; 3]) -> Scan {
    let readings = units.each_mut().map(Unit::read);
    let [x, y, z] = readings;
    assert!(x.t_ns == y.t_ns && x.t_ns == z.t_ns && x.seq == y.seq, "one clock: {readings:?}");
    let scan = Scan::new(x.t_ns, x.seq, &readings.map(|one| one.rate)).unwrap().with_temp(x.temp).with_lost(x.lost);
    let out_of_range = (0..3).filter(|axis| readings[*axis].out_of_range);
    out_of_range.fold(scan, Scan::with_out_of_range)
}

struct Measured {
    outcomes: Vec<Outcome>,
    truths: [Truth; 3],
    /// The result of a procedure for the first axis alone.
    alone: Outcome,
}

fn measure(mut units: [Unit; 3]) -> Result<Measured, AxisRefusal> {
    let mut procedure = PartProcedure::new(&part(), SHORT).expect("a plan that makes sense");
    let mut alone = Procedure::new(&Axis::ADIS16130, SHORT).expect("a plan that makes sense");
    let mut truths = units.each_ref().map(|unit| unit.twin.truth());
    let t_ns = units[0].twin.now_ns();
    procedure.handle(Event::Initialised { t_ns })?;
    alone.handle(Event::Initialised { t_ns }).expect("the same");
    while procedure.next() == Action::Read {
        let before = procedure.progress().state;
        let scan = scan(&mut units);
        procedure.handle(Event::Reading(&scan))?;
        alone.handle(Event::Reading(&scan.reading(0).unwrap())).expect("the same");
        if before == State::Offset {
            truths = units.each_ref().map(|unit| unit.twin.truth());
        }
    }
    Ok(Measured { outcomes: procedure.finish()?, truths, alone: alone.finish().expect("the same") })
}

#[test]
fn three_axes_are_calibrated_in_one_hour() {
    let Measured { outcomes, truths, alone } = measure(units(|_, spec| spec)).unwrap();
    assert_eq!(outcomes[0], alone);
    for (name, (outcome, truth)) in ["x", "y", "z"].iter().zip(outcomes.iter().zip(&truths)) {
        let (correction, u) = (outcome.correction, outcome.uncertainty);
        let pbc = (correction.pbc_dps - truth.pbc_dps(correction.t3_c)) / u.u_pbc_dps;
        let btc = (correction.btc_dps_per_c - truth.btc_dps_per_c(correction.t3_c)) / u.u_btc_dps_per_c;
        assert!(pbc.abs() < 4.0 && btc.abs() < 4.0, "axis {name}: {pbc} u, {btc} u");
        assert!(u.u_pbc_dps < 0.005 && u.u_btc_dps_per_c < 0.004, "axis {name}: {u:?}");
        assert_eq!(correction.t3_c, alone.correction.t3_c, "one temperature");
    }
    let biases: Vec<f64> = outcomes.iter().map(|outcome| outcome.correction.pbc_dps).collect();
    assert!((biases[0] - biases[1]).abs() > 0.01 && (biases[1] - biases[2]).abs() > 0.01, "{biases:?}");
}

#[test]
fn one_axis_that_moves_refuses_the_part_by_its_name() {
    let sway = |spec| Spec { motion: Motion::Sway, sway_dps: 0.3, sway_hz: 0.4, ..spec };
    let moving = |index, spec| if index == 1 { sway(spec) } else { spec };
    let refusal = measure(units(moving)).err().expect("refused");
    assert!(matches!(refusal.refusal, Refusal::Moving { .. }), "{refusal:?}");
    assert_eq!(refusal.axis.as_deref(), Some("y"));
    assert!(refusal.to_string().starts_with("axis y: the part moves"), "{refusal}");
}

#[test]
fn an_axis_that_is_not_read_is_missed() {
    let mut procedure = PartProcedure::new(&part(), SHORT).unwrap();
    procedure.handle(Event::Initialised { t_ns: 0 }).unwrap();
    let two = |k: u32| {
        let wiggle = (k % 7) as i32 * 40;
        Scan::new(u64::from(k) * 175_667, k, &[wiggle, wiggle]).unwrap().with_temp(Some(wiggle))
    };
    let refusal = (0..20_000).find_map(|k| procedure.handle(Event::Reading(&two(k))).err()).expect("refused");
    assert!(matches!(refusal.refusal, Refusal::TooFew { tenths: 0, .. }), "{refusal:?}");
    assert_eq!(refusal.axis.as_deref(), Some("z"));
}

#[test]
fn a_single_axis_without_samples_is_refused_after_its_first_window_and_not_named() {
    let mut procedure = PartProcedure::new(&Part::ADIS16130, SHORT).unwrap();
    procedure.handle(Event::Initialised { t_ns: 5 }).unwrap();
    assert_eq!(procedure.next(), Action::Read);
    assert!(procedure.handle(Event::Time { t_ns: 2_000_000_004 }).is_ok());
    let refusal = procedure.handle(Event::Time { t_ns: 2_000_000_005 }).unwrap_err();
    assert!(matches!(refusal.refusal, Refusal::TooFew { window: State::FirstAverage, tenths: 0, .. }));
    assert_eq!(refusal.to_string(), refusal.refusal.to_string());
}
