//! Tests RDY by its blocking and async traits, and the delay.

use crate::bus::{Host, quiet};
use adis16130_twin::{RdyOutput, RdyTimeout, Spec};
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::InputPin;
use embedded_hal_async::digital::Wait;

/// Returns the output of a future of the twin, which is ready at once.
fn run<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => output,
        Poll::Pending => panic!("pending"),
    }
}

#[test]
fn f32_each_shape_of_rdy_announces_new_data_at_its_own_edge() {
    for (rdy, rising) in [(RdyOutput::Level, false), (RdyOutput::Pulse, true), (RdyOutput::Inverted, true)] {
        let host = Host::started(Spec { rdy, ..quiet() });
        let data = host.twin.next_edge(rising, 1_000_000).expect("new data");
        assert_eq!(host.twin.rdy().is_high().unwrap(), rising, "{rdy:?}");
        let scaling = host.twin.next_edge(!rising, 1_000_000).expect("the other edge");
        assert!((scaling.t_ns - data.t_ns).abs_diff(87_833 - 27_167) <= 1, "{rdy:?}");
        assert_eq!(host.twin.rdy().is_high().unwrap(), !rising, "{rdy:?}");
        let next = host.twin.next_edge(rising, 1_000_000).expect("new data");
        assert!((next.t_ns - data.t_ns).abs_diff(87_833) <= 1, "{rdy:?}");
    }
}

#[test]
fn waits_follow_the_pulses() {
    let host = Host::started(quiet());
    let mut rdy = host.twin.rdy();
    run(rdy.wait_for_falling_edge()).unwrap();
    let fall = host.twin.now_ns();
    run(rdy.wait_for_low()).unwrap();
    assert_eq!(host.twin.now_ns(), fall);
    run(rdy.wait_for_rising_edge()).unwrap();
    assert!((host.twin.now_ns() - fall).abs_diff(87_833 - 27_167) <= 1);
    run(rdy.wait_for_high()).unwrap();
    assert!(rdy.is_high().unwrap());
    run(rdy.wait_for_low()).unwrap();
    assert!((host.twin.now_ns() - fall).abs_diff(87_833) <= 1);
    run(rdy.wait_for_any_edge()).unwrap();
    assert!(rdy.is_high().unwrap());
    run(rdy.wait_for_falling_edge()).unwrap();
    assert!((host.twin.now_ns() - fall).abs_diff(2 * 87_833) <= 1);
}

#[test]
fn a_wait_without_end_gives_up_after_a_second() {
    let host = Host::new(quiet());
    let mut rdy = host.twin.rdy();
    assert_eq!(run(rdy.wait_for_falling_edge()), Err(RdyTimeout));
    assert_eq!(host.twin.now_ns(), 1_000_000_000);
}

#[test]
fn delay_passes_simulated_time() {
    let host = Host::new(quiet());
    host.twin.delay().delay_ms(3);
    assert_eq!(host.twin.now_ns(), 3_000_000);
}
