//! Compares the readings that are judged faulty with what a twin without faults reads.

use crate::unit::Unit;
use adis16130::{Config, SamplerConfig, Width};
use adis16130_twin::{Fault, Motion, Spec};
use zerorate::health::{Flags, Health, Judged};
use zerorate::{Action, Axis, Event, Outcome, Plan, Procedure, Reading, Refusal, Tally};

const AXIS: Axis = Axis::ADIS16130;

/// Reads a twin for a time, as a driver sees it. Samples that cannot be read are lost.
fn readings(spec: Spec, config: Config, sampling: SamplerConfig, seconds: f64) -> Vec<Reading> {
    let mut unit = Unit::new(spec, config, sampling);
    let end_ns = unit.twin.now_ns() + (seconds * 1e9) as u64;
    let mut samples = Vec::new();
    while unit.twin.now_ns() < end_ns {
        let Some(edge) = unit.twin.next_falling_edge(1_000_000_000) else { break };
        samples.extend(unit.read_at(edge).ok().flatten());
    }
    samples
}

fn judged(samples: &[Reading]) -> (Vec<Judged>, Health) {
    let mut health = Health::new(&AXIS);
    let mut all: Vec<Judged> = samples.iter().filter_map(|sample| health.push(sample)).collect();
    while let Some(last) = health.finish() {
        all.push(last);
    }
    assert_eq!(all.len(), samples.len());
    (all, health)
}

/// Rate and temperature in the registers at `t_ns`, from a run without faults, whose edges come when the temperature
/// is new. An edge half a period earlier has the new rate and the old temperature.
fn truth(clean: &[Reading], t_ns: u64) -> Option<(i32, i32)> {
    let next = clean.partition_point(|sample| sample.t_ns < t_ns);
    let newest = clean.partition_point(|sample| sample.t_ns <= t_ns).checked_sub(1)?;
    Some((clean.get(next)?.rate, clean[newest].temp?))
}

/// Adds bit errors from 0.5 s on, when the part has started.
fn with_bit_errors(spec: &Spec, rate: f64) -> Spec {
    Spec { fault: Fault::BitErrors, bit_error_rate: rate, fault_at_s: Some(0.5), ..spec.clone() }
}

/// With a bit error rate of 1e-5, every rate that is wrong by more than 2 °/s is marked (6 °/s with a divider of 3),
/// and every temperature that is wrong by more than 1.5 °C. No correct reading is marked.
#[test]
fn bit_errors_are_marked_at_rest_and_in_motion_and_nothing_else() {
    let motions = [
        (Motion::None, Width::Bits24, 1),
        (Motion::Sway, Width::Bits24, 1),
        (Motion::Bump, Width::Bits24, 1),
        (Motion::None, Width::Bits16, 1),
        (Motion::Bump, Width::Bits24, 3),
    ];
    let (mut wrong, mut found) = (0, 0);
    for (seed, (motion, width, divider)) in (1..).zip(motions) {
        // the first bump comes at 0.5 s, with the first bit errors
        let spec = Spec { motion, fault_at_s: Some(0.5), ..Spec::from_seed(seed) };
        let config = Config::default().with_width(width);
        let sampling = SamplerConfig::new().with_divider(divider);
        let clean = readings(spec.clone(), config, sampling, 30.0);
        let (_, health) = judged(&clean);
        assert_eq!(health.fault_counts().faulty() + health.fault_counts().out_of_range, 0, "{motion:?}: false alarms");
        assert_eq!(health.frozen_at_end(), None);
        // a divider lets fewer samples be read, so the bit error rate is higher by its factor
        let rate = 1e-5 * f64::from(divider);
        let (faulty, _) = judged(&readings(with_bit_errors(&spec, rate), config, sampling, 30.0));
        let allowance_dps = if divider == 1 { 2.0 } else { 6.0 };
        for Judged { reading, flags } in &faulty {
            let Some((rate, temp)) = truth(&clean, reading.t_ns) else { continue };
            let error_dps = AXIS.rate.value(i64::from(reading.rate - rate)).abs();
            if error_dps > allowance_dps {
                wrong += 1;
                found += u32::from(!flags.rate_is_good());
            }
            let right = error_dps == 0.0 && !reading.out_of_range;
            assert!(!right || flags.rate_is_good(), "{motion:?}: a false alarm at {} ns, {flags}", reading.t_ns);
            if let Some(read) = reading.temp {
                let error_c = f64::from(read - temp).abs() / AXIS.temp.lsb_per_unit;
                assert!(error_c < 1.5 || !flags.temp_is_good(), "{error_c} °C believed");
                assert!(error_c > 0.0 || flags.temp_is_good(), "a false alarm of temperature");
            }
        }
    }
    assert!(wrong > 50, "only {wrong} errors to be found");
    assert_eq!(found, wrong, "errors believed");
}

#[test]
fn a_frozen_part_is_known_within_a_fifth_of_a_second() {
    let spec = Spec { fault: Fault::Frozen, fault_at_s: Some(2.0), ..Spec::from_seed(3) };
    let (judged, health) = judged(&readings(spec, Config::default(), SamplerConfig::new(), 3.0));
    let first = judged.iter().find(|judged| judged.flags.has(Flags::FROZEN)).expect("frozen").reading.t_ns;
    assert!((2_000_000_000..2_200_000_000).contains(&first), "{first}");
    assert!(health.frozen_at_end().is_some_and(|frozen| frozen.both && frozen.since_ns <= 2_001_000_000));
    assert!(judged.iter().rev().take(1000).all(|judged| !judged.flags.rate_is_good()));
}

/// A data-ready line that stutters loses samples, and so does a late host. The tally tells the two apart.
#[test]
fn a_stuttering_line_is_told_from_a_late_host() {
    let tally = |samples: &[Reading]| {
        let mut tally = Tally::default();
        samples.iter().for_each(|sample| tally.count(sample));
        tally
    };
    let stuttering = Spec { fault: Fault::RdyStutter, ..Spec::from_seed(5) };
    let line = tally(&readings(stuttering, Config::default(), SamplerConfig::new(), 2.0));
    assert!(line.data_ready_stutters(), "{line:?}");
    let mut unit = Unit::of(Spec::from_seed(5));
    let mut late = Vec::new();
    for k in 0..10_000u64 {
        let edge = unit.twin.next_falling_edge(1_000_000_000).expect("an edge");
        if k % 50 == 0 {
            unit.twin.advance_ns(200_000 + k * 37 % 900_000);
        }
        late.extend(unit.read_at(edge).ok().flatten());
    }
    let host = tally(&late);
    assert!(host.gaps > 50 && !host.data_ready_stutters(), "{host:?}");
}

const SHORT: Plan = Plan {
    warmup_s: 30.0,
    settle_s: 30.0,
    offset_s: 10.0,
    max_lost: 0.01,
    max_u_btc_dps_per_c: 0.2,
    ..crate::unit::SHORT
};

fn measure(samples: &[Reading], plan: Plan) -> Result<Outcome, Refusal> {
    let mut procedure = Procedure::new(&AXIS, plan).expect("a plan");
    procedure.handle(Event::Initialised { t_ns: samples[0].t_ns })?;
    for sample in samples {
        if procedure.next() == Action::Done {
            break;
        }
        procedure.handle(Event::Reading(sample))?;
    }
    procedure.finish()
}

fn short_record(spec: Spec) -> Vec<Reading> {
    readings(Spec { warmup_s: 10.0, ..spec }, Config::default(), SamplerConfig::new(), SHORT.total_s() + 1.0)
}

#[test]
fn no_mean_includes_a_faulty_reading() {
    let clean = short_record(Spec::from_seed(6));
    let expected = measure(&clean, SHORT).expect("a good part");
    assert_eq!(expected.impossible_readings, 0);
    let mut faulty = clean;
    for k in (500..faulty.len()).step_by(997) {
        faulty[k].rate = ((faulty[k].rate + (1 << 23)) ^ (1 << (17 + k % 7))) - (1 << 23);
    }
    let found = measure(&faulty, SHORT).expect("a good part on a bad line");
    assert!(found.impossible_readings > 300, "{}", found.impossible_readings);
    let pbc = found.correction.pbc_dps - expected.correction.pbc_dps;
    assert!(pbc.abs() < 1e-4, "PBC moved by {pbc} °/s");
    assert!(found.warnings.iter().any(|warning| warning.code() == "impossible-readings"), "{:?}", found.warnings);
}

#[test]
fn bit_errors_are_not_blamed_on_motion() {
    let noisy_line = with_bit_errors(&Spec::from_seed(7), 1e-4);
    let refusal = measure(&short_record(noisy_line), Plan { max_lost: 0.2, ..SHORT });
    let blames_the_line = match &refusal {
        Ok(outcome) => outcome.impossible_readings > 0,
        Err(refusal) => matches!(refusal, Refusal::BitErrors { .. }),
    };
    assert!(blames_the_line, "{refusal:?}");
}
