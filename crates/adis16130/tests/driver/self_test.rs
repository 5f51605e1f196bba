//! Tests the self-test (F-11): the shift, the uncertainty of the shift, and the pin, which is always released.

use adis16130::blocking::Adis16130;
use adis16130::{Config, SelfTestError, SelfTestPlan, WaitBound};

use crate::part::{Delay, Part, Pin, Wire};

/// One sample per batch, so that the scatter of the batches equals the scatter of the samples.
const PLAN: SelfTestPlan = SelfTestPlan::new(16).with_settle_us(1_000);

/// 0.1 °/s in codes. The rate alternates by ±0.1 °/s around 0, and around 1 °/s with the self-test.
const SPREAD: u32 = 2_349;

fn gyro(levels: usize) -> Adis16130<Wire, Pin> {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    gyro.init().unwrap();
    let rates = (0..levels * PLAN.samples() as usize).map(|k| {
        let mean = 8_388_608 + 23_488 * (k as u32 / PLAN.samples());
        if k % 2 == 0 { mean + SPREAD } else { mean - SPREAD }
    });
    part.borrow_mut().rates = rates.collect();
    gyro
}

#[test]
fn reports_the_shift_and_its_uncertainty() {
    let (mut pin, mut delay) = (Pin::default(), Delay::default());
    let result = gyro(2).self_test(&mut pin, &mut delay, PLAN).unwrap();
    assert!((result.shift_dps - 1.0).abs() < 1e-6, "{result:?}");
    assert_eq!(result.n, 16);
    // The sample variance of a level is 0.1²·16/15, and that of its mean 0.1²/15. The shift is a difference of two.
    let u: f32 = 0.1 * (2.0_f32 / 15.0).sqrt();
    assert!((result.u_dps - u).abs() < 1e-5, "{result:?} instead of {u}");
    assert_eq!(pin.0.borrow().levels, [false, true, false]);
    assert_eq!(*delay.0.borrow(), 2 * 1_000_000, "settles twice, and waits for nothing else");
}

#[test]
fn an_error_with_the_pin_active_releases_it() {
    let mut pin = Pin::default();
    // With the self-test active the status shows no new rate, four times.
    let result = gyro(1).self_test(&mut pin, &mut Delay::default(), PLAN);
    assert!(matches!(result, Err(SelfTestError::Wait(_))), "{result:?}");
    assert_eq!(pin.0.borrow().levels, [false, true, false]);
}

#[test]
fn a_pin_that_cannot_be_set_is_an_error() {
    for (refused, levels) in [(false, vec![false]), (true, vec![false, true, false])] {
        let mut pin = Pin::default();
        pin.0.borrow_mut().refuses = Some(refused);
        let result = gyro(2).self_test(&mut pin, &mut Delay::default(), PLAN);
        assert_eq!(result, Err(SelfTestError::Pin(embedded_hal::digital::ErrorKind::Other)));
        assert_eq!(pin.0.borrow().levels, levels);
    }
}

#[test]
fn samples_are_rounded_up_to_whole_batches() {
    assert_eq!(SelfTestPlan::new(0).samples(), 16);
    assert_eq!(SelfTestPlan::new(17).samples(), 32);
    assert_eq!(SelfTestPlan::new(u16::MAX).samples(), 65_536);
    let bound = WaitBound::from_us(7);
    assert_eq!(PLAN.with_bound(bound).bound(), bound);
}
