//! Calls each exported function under Miri (`cargo xtask proofs miri`). Each object has its own memory block.

#[path = "../twin/src/rig.rs"]
mod rig;

use crate::bus::{Bus, SelfTestPin};
use crate::correction::*;
use crate::corrector::*;
use crate::gyro::*;
use crate::procedure::*;
use crate::self_test::*;
use crate::status::*;
use crate::table::*;
use crate::tracker::*;
use core::ffi::{CStr, c_void};
use core::ptr::{self, null, null_mut};
use rig::*;
use std::boxed::Box;

/// Allocates a separate memory block for an object, so that Miri detects writes outside it and uses after it is freed.
fn memory<T>() -> Box<T> {
    // SAFETY: the types of the interface are plain numbers and pointers, for which zeros are valid.
    unsafe { Box::<T>::new_zeroed().assume_init() }
}

macro_rules! call {
    ($name:ident($($argument:expr),*)) => {{
        // SAFETY: each pointer is null, or points to memory of its type that nothing else uses.
        unsafe { $name($($argument),*) }
    }};
}

/// Makes a twin, returned as the context of the bus, and a gyroscope that is initialised on this twin.
fn gyro() -> (*mut c_void, Box<Gyro>) {
    let context = call!(zerorate_twin_new(c"seed=3".as_ptr()));
    let bus = Bus {
        context,
        transfer: Some(zerorate_twin_transfer),
        rdy: Some(zerorate_twin_rdy),
        delay_us: Some(zerorate_twin_delay_us),
    };
    let (mut gyro, mut settings) = (memory::<Gyro>(), memory::<Settings>());
    assert_eq!(call!(zerorate_gyro_initialise(&mut *gyro)), ZERORATE_E_STATE);
    assert_eq!(call!(zerorate_settings_default(&mut *settings)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_set_up(&mut *gyro, null(), &*settings)), ZERORATE_E_NULL);
    assert_eq!(call!(zerorate_gyro_set_up(&mut *gyro, &bus, &*settings)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_initialise(&mut *gyro)), ZERORATE_OK);
    (context, gyro)
}

fn correction() -> Correction {
    Correction { pbc_dps: -0.25, btc_dps_per_c: -0.04, t3_c: 31.5, btc2_dps_per_c2: 0.0, btc3_dps_per_c3: 0.0 }
}

#[test]
fn a_gyroscope_is_read() {
    let (context, mut gyro) = gyro();
    let (mut codes, mut sample) = (memory::<Codes>(), memory::<Sample>());
    assert_eq!(call!(zerorate_gyro_wait_ready(&mut *gyro, 2000)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_read(&mut *gyro, &mut *codes)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_read(&mut *gyro, null_mut())), ZERORATE_E_NULL);
    assert!(zerorate_rate_dps(codes.rate_code).abs() < 10.0 && zerorate_temp_c(codes.temp_code) > 10.0);
    let (mut t_ns, mut seq) = (0, 0);
    assert_eq!(call!(zerorate_twin_next_edge(context, &mut t_ns, &mut seq)), 1);
    assert_eq!(call!(zerorate_gyro_sample(&mut *gyro, t_ns, seq, &mut *sample)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_silent(&mut *gyro, t_ns + 1)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_diagnose(&mut *gyro)), ZERORATE_OK);
    call!(zerorate_twin_free(context));
}

#[test]
fn the_self_test_is_measured() {
    let (context, mut gyro) = gyro();
    let pin = SelfTestPin { context, set: Some(zerorate_twin_self_test) };
    let (mut plan, mut result) = (memory::<SelfTestPlan>(), memory::<SelfTest>());
    assert_eq!(call!(zerorate_self_test_plan_default(&mut *plan)), ZERORATE_OK);
    (plan.settle_us, plan.samples) = (1000, 16);
    assert_eq!(call!(zerorate_gyro_self_test(&mut *gyro, &pin, &*plan, null_mut())), ZERORATE_E_NULL);
    assert_eq!(call!(zerorate_gyro_self_test(&mut *gyro, &pin, &*plan, &mut *result)), ZERORATE_OK);
    assert_eq!(result.n, 16);
    call!(zerorate_twin_free(context));
}

/// Calibrates a part that warms at rest. With `jump`, its rate jumps. Returns the status that ends the calibration.
fn calibrate(procedure: &mut Procedure, jump: bool) -> Status {
    let mut plan = memory::<Plan>();
    call!(zerorate_plan_default(&mut *plan));
    (plan.average_s, plan.warmup_s, plan.settle_s) = (1.0, 0.0, 0.0);
    (plan.offset_s, plan.final_temp_s, plan.max_u_btc_dps_per_c) = (1.0, 0.1, 1.0);
    assert_eq!(call!(zerorate_procedure_begin(&mut *procedure, &*plan)), ZERORATE_OK);
    assert_eq!(call!(zerorate_procedure_next(&mut *procedure)), ZERORATE_INITIALISE);
    assert_eq!(call!(zerorate_procedure_initialised(&mut *procedure, 0)), ZERORATE_OK);
    let mut sample = memory::<Sample>();
    (sample.bits, sample.has_temp) = (24, 1);
    for seq in 0..600 {
        sample.seq = seq;
        sample.t_ns = u64::from(seq) * 10_000_000;
        sample.rate_code = 8_388_608 + (seq * 7919 % 4001) + if jump { seq % 64 * 5000 } else { 0 };
        sample.temp_code = 8_388_608 + seq * 1000;
        call!(zerorate_procedure_sample(&mut *procedure, &*sample));
        match call!(zerorate_procedure_next(&mut *procedure)) {
            ZERORATE_SAMPLE => {}
            ended => return ended,
        }
    }
    ZERORATE_SAMPLE
}

#[test]
fn a_procedure_comes_to_its_end() {
    let (mut procedure, mut outcome) = (memory::<Procedure>(), memory::<Outcome>());
    let (mut elapsed_s, mut total_s) = (0.0, 0.0);
    assert_eq!(calibrate(&mut procedure, false), ZERORATE_DONE);
    assert_eq!(call!(zerorate_procedure_time(&mut *procedure, 1 << 40)), ZERORATE_OK);
    assert_eq!(call!(zerorate_procedure_step(&mut *procedure)), 10);
    assert_eq!(call!(zerorate_procedure_progress(&mut *procedure, &mut elapsed_s, &mut total_s)), ZERORATE_OK);
    assert!(elapsed_s >= 3.1 && total_s >= 3.1);
    assert_eq!(call!(zerorate_procedure_outcome(&mut *procedure, &mut *outcome)), ZERORATE_OK);
    assert!(outcome.samples > 300 && outcome.temp_max_c > outcome.temp_min_c);
    assert!(calibrate(&mut procedure, true) < 0, "refused");
    assert_ne!(call!(zerorate_procedure_remedy(&mut *procedure, 0)), 0);
    assert_eq!(call!(zerorate_procedure_remedy(&mut *procedure, usize::MAX)), 0);
}

#[test]
fn a_correction_is_applied_in_each_form() {
    let mut single = memory::<CorrectionF32>();
    let mut integer = memory::<CorrectionInteger>();
    let mut curve = memory::<CorrectionCurve>();
    assert_eq!(call!(zerorate_correction_to_f32(&correction(), &mut *single)), ZERORATE_OK);
    assert_eq!(call!(zerorate_correction_to_integer(&correction(), &mut *integer)), ZERORATE_OK);
    assert_eq!(call!(zerorate_correction_to_curve(&correction(), &mut *curve)), ZERORATE_OK);
    assert_eq!(call!(zerorate_correct(&correction(), 1.0, 31.5)), 0.75);
    assert_eq!(call!(zerorate_correct_f32(&*single, 1.0, 31.5)), 0.75);
    assert_eq!(call!(zerorate_correct_integer(null(), 5, 0)), 5);
    for temp_code in [0, 8_480_212, 0xFF_FFFF, u32::MAX] {
        let line = call!(zerorate_correct_integer(&*integer, 8_400_000, temp_code));
        let curve = call!(zerorate_correct_curve(&*curve, 8_400_000, temp_code));
        assert!(line.abs_diff(curve) < 4 || temp_code != 8_480_212);
    }
    let (mut corrector, mut corrected) = (memory::<Corrector>(), memory::<Corrected>());
    assert_eq!(call!(zerorate_corrector_begin(&mut *corrector, &correction(), null())), ZERORATE_OK);
    assert_eq!(call!(zerorate_corrector_take(&mut *corrector, 1.0, f64::NAN, &mut *corrected)), ZERORATE_NOTHING);
    assert_eq!(call!(zerorate_corrector_take(&mut *corrector, 1.0, 31.5, &mut *corrected)), ZERORATE_OK);
    assert_eq!(corrected.rate_dps, 0.75);
}

#[test]
fn a_table_is_looked_up_up_to_both_ends() {
    let (mut table, mut rows, mut row) = (memory::<Table>(), std::vec![0; 41], 0);
    let rows_of = rows.as_mut_ptr();
    assert_eq!(
        call!(zerorate_table_lay_out(&mut *table, &correction(), 0.1, 2.0, rows_of, 40)),
        ZERORATE_E_TABLE_ROOM
    );
    assert_eq!(call!(zerorate_table_lay_out(&mut *table, &correction(), 0.1, 2.0, rows_of, 41)), ZERORATE_OK);
    assert_eq!(call!(zerorate_table_look_up(&*table, table.t3_code as u32, &mut row)), ZERORATE_OK);
    assert_eq!(row, 0);
    for (temp_code, end) in [(0, 80_000), (u32::MAX, -80_000)] {
        assert_eq!(call!(zerorate_table_look_up(&*table, temp_code, &mut row)), ZERORATE_E_TABLE_OUTSIDE);
        assert_eq!(row, end);
    }
}

#[test]
fn a_tracker_is_kept_and_resumed() {
    let prior =
        TrackerPrior { u_pbc_dps: 0.001, u_btc_dps_per_c: 0.001, cov_pbc_btc: 0.0, white_dps_per_rt_hz: 0.0125 };
    let (mut tracker, mut saved) = (memory::<Tracker>(), memory::<TrackerState>());
    let mut tracked = memory::<Tracked>();
    assert_eq!(call!(zerorate_tracker_push(&mut *tracker, 0.0, 25.0)), ZERORATE_E_STATE);
    assert_eq!(call!(zerorate_tracker_begin(&mut *tracker, &correction(), &prior, 100.0)), ZERORATE_OK);
    for sample in 0..2000 {
        let rate_dps = f64::from(sample * 7919 % 401 - 200) * 1e-3;
        assert!(call!(zerorate_tracker_push(&mut *tracker, rate_dps, 25.0)) >= 0);
    }
    assert_eq!(call!(zerorate_tracker_bias(&mut *tracker, 25.0, &mut *tracked)), ZERORATE_OK);
    assert_eq!(call!(zerorate_tracker_save(&mut *tracker, &mut *saved)), ZERORATE_OK);
    assert_eq!(call!(zerorate_tracker_resume(&mut *tracker, &correction(), &prior, &*saved, 100.0)), ZERORATE_OK);
    for bit in 0..8 * size_of::<TrackerState>() {
        let mut damaged = saved.clone();
        // SAFETY: the byte is in the state, of which any bits are valid.
        unsafe { *ptr::from_mut(&mut *damaged).cast::<u8>().add(bit / 8) ^= 1 << (bit % 8) };
        let resumed = call!(zerorate_tracker_resume(&mut *tracker, &correction(), &prior, &*damaged, 100.0));
        assert_eq!(resumed, ZERORATE_E_ARGUMENT, "bit {bit}");
    }
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    let mut corrected = memory::<Corrected>();
    let mut corrector = memory::<Corrector>();
    for validity in [(30.0, 20.0, 0.5), (f64::NAN, 20.0, 0.5), (20.0, 30.0, -0.5), (20.0, 30.0, f64::NAN)] {
        let validity = Validity { temp_min_c: validity.0, temp_max_c: validity.1, margin_c: validity.2 };
        let begun = call!(zerorate_corrector_begin(&mut *corrector, &correction(), &validity));
        assert_eq!(begun, ZERORATE_E_ARGUMENT);
    }
    let broken = Correction { t3_c: f64::NAN, ..correction() };
    assert_eq!(call!(zerorate_corrector_begin(&mut *corrector, &broken, null())), ZERORATE_E_COEFFICIENT);
    assert_eq!(call!(zerorate_correction_to_f32(&broken, &mut *memory::<CorrectionF32>())), ZERORATE_E_COEFFICIENT);
    assert_eq!(call!(zerorate_corrector_begin(&mut *corrector, &correction(), null())), ZERORATE_OK);
    for (rate_dps, temp_c) in [(f64::INFINITY, 25.0), (1.0, f64::NEG_INFINITY)] {
        let taken = call!(zerorate_corrector_take(&mut *corrector, rate_dps, temp_c, &mut *corrected));
        assert_eq!(taken, ZERORATE_E_ARGUMENT);
    }
    assert_eq!(call!(zerorate_corrector_take(&mut *corrector, 1.0, f64::NAN, &mut *corrected)), ZERORATE_NOTHING);

    let possible =
        TrackerPrior { u_pbc_dps: 0.003, u_btc_dps_per_c: 0.006, cov_pbc_btc: 9.6e-9, white_dps_per_rt_hz: 0.0125 };
    let priors = [
        TrackerPrior { u_pbc_dps: f64::NAN, ..possible },
        TrackerPrior { u_btc_dps_per_c: -0.001, ..possible },
        TrackerPrior { cov_pbc_btc: 1.0, ..possible },
        TrackerPrior { cov_pbc_btc: f64::NAN, ..possible },
        TrackerPrior { white_dps_per_rt_hz: 0.0, ..possible },
    ];
    let mut tracker = memory::<Tracker>();
    let mut begin =
        |correction: &Correction, prior, age_s| call!(zerorate_tracker_begin(&mut *tracker, correction, prior, age_s));
    assert!(priors.iter().all(|prior| begin(&correction(), prior, 100.0) == ZERORATE_E_ARGUMENT));
    assert!([f64::NAN, -1.0].iter().all(|age_s| begin(&correction(), &possible, *age_s) == ZERORATE_E_ARGUMENT));
    assert_eq!(begin(&broken, &possible, 100.0), ZERORATE_E_COEFFICIENT);
    assert_eq!(begin(&correction(), &possible, 100.0), ZERORATE_OK);
    assert_eq!(call!(zerorate_tracker_push(&mut *tracker, f64::INFINITY, 25.0)), ZERORATE_E_ARGUMENT);
    let biased = call!(zerorate_tracker_bias(&mut *tracker, f64::NAN, &mut *memory::<Tracked>()));
    assert_eq!(biased, ZERORATE_E_ARGUMENT);
}

#[test]
fn settings_that_cannot_be_are_refused() {
    assert!(call!(zerorate_twin_new(null())).is_null());
    let context = call!(zerorate_twin_new(c"seed=3".as_ptr()));
    let bus = Bus { context, transfer: Some(zerorate_twin_transfer), rdy: None, delay_us: None };
    let (mut gyro, mut settings) = (memory::<Gyro>(), memory::<Settings>());
    call!(zerorate_settings_default(&mut *settings));
    let plain = *settings;
    for wrong in [
        Settings { mclk_hz: 6, ..plain },
        Settings { mclk_hz: 4_000_000_000, ..plain },
        Settings { rdy_rises: 2, ..plain },
        Settings { read_status: 3, ..plain },
    ] {
        assert_eq!(call!(zerorate_gyro_set_up(&mut *gyro, &bus, &wrong)), ZERORATE_E_ARGUMENT);
    }
    assert_eq!(call!(zerorate_gyro_set_up(&mut *gyro, &bus, &plain)), ZERORATE_OK);
    assert_eq!(call!(zerorate_gyro_diagnose(&mut *gyro)), ZERORATE_E_STATE);
    call!(zerorate_twin_free(context));
}

#[test]
fn every_status_has_words() {
    for status in -100..20 {
        // SAFETY: the string lives for ever.
        assert!(!unsafe { CStr::from_ptr(zerorate_text(status)) }.is_empty());
    }
}
