//! Tests of the async driver where it differs from the blocking driver: in waits and dropped futures.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Waker};

use adis16130::asynch::Adis16130;
use adis16130::{Config, RdyEdge, SelfTestPlan, WaitBound, WaitError};

use crate::part::{Delay, Part, Pin, Wire, now};

#[test]
fn the_wait_ends_with_the_edge_or_with_the_bound() {
    for edge in [RdyEdge::Falling, RdyEdge::Rising] {
        let pin = Pin::default();
        let part = Part::new();
        part.borrow_mut().set(0x20, 0x08);
        let mut gyro = Adis16130::new(Wire(part), pin.clone(), Config::new().with_rdy_edge(edge));
        let (mut delay, bound) = (Delay::default(), WaitBound::from_us(250));
        let never = if edge == RdyEdge::Falling { u32::MAX } else { 0 };
        pin.0.borrow_mut().looks_until_low = never;
        let timed_out = WaitError::TimedOut { timeout_us: 250 };
        assert_eq!(now(gyro.wait_ready(&mut delay, bound)), Err(timed_out));
        assert_eq!(*delay.0.borrow(), 250_000);
        pin.0.borrow_mut().looks_until_low = !never;
        assert_eq!(now(gyro.wait_ready(&mut delay, bound)), Ok(()));
    }
}

#[test]
fn a_dropped_self_test_releases_the_pin() {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    now(gyro.init()).unwrap();
    part.borrow_mut().rates = (0..32).map(|_| 8_388_608).collect();
    let mut pin = Pin::default();
    let (levels, mut delay) = (pin.clone(), Stalls(0));
    {
        let mut test = pin!(gyro.self_test(&mut pin, &mut delay, SelfTestPlan::new(16)));
        let mut context = Context::from_waker(Waker::noop());
        assert!(test.as_mut().poll(&mut context).is_pending());
        assert_eq!(levels.0.borrow().levels, [false, true], "active, settling");
    }
    assert_eq!(levels.0.borrow().levels, [false, true, false], "dropped");
}

/// A delay whose second call, the second settling time of a self-test, never ends.
struct Stalls(u32);

impl embedded_hal_async::delay::DelayNs for Stalls {
    async fn delay_ns(&mut self, _ns: u32) {
        self.0 += 1;
        if self.0 == 2 {
            std::future::pending().await
        }
    }
}
