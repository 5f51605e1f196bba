//! The async driver is the blocking one with other traits: same bytes, same errors; only waiting differs.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use adis16130::asynch::Adis16130;
use adis16130::{
    Config, Edge, Fault, Framing, MCLK_HZ, RdyEdge, SampleError, Sampler, SamplerConfig, SelfTestPlan, WaitBound,
    WaitError,
};

use crate::part::{Delay, F30, Line, Part, Pin, Wire};

/// The mock never waits, so one poll must be enough.
fn now<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => output,
        Poll::Pending => panic!("waits for something that never comes"),
    }
}

fn gyro(config: Config) -> (std::rc::Rc<std::cell::RefCell<Part>>, Pin, Adis16130<Wire, Pin>) {
    let (part, pin) = (Part::new(), Pin::default());
    (part.clone(), pin.clone(), Adis16130::new(Wire(part), pin, config))
}

#[test]
fn sends_f30_and_reads_it_back() {
    for (framing, chunk) in [(Framing::PerByte, 1), (Framing::Command, 2)] {
        let (part, _, mut gyro) = gyro(Config::new().with_framing(framing));
        now(gyro.reset()).unwrap();
        now(gyro.init()).unwrap();
        let f30: Vec<Vec<u8>> = F30.chunks(chunk).map(<[u8]>::to_vec).collect();
        assert_eq!(part.borrow().frames[0], [0x00, 0xFF, 0xFF, 0xFF, 0xFF]);
        assert_eq!(part.borrow().frames[1..], f30);
        now(gyro.verify()).unwrap();
    }
}

#[test]
fn samples_and_diagnoses() {
    let config = Config::default();
    let (part, _, mut gyro) = gyro(config);
    now(gyro.init_verified()).unwrap();
    part.borrow_mut().set(0x20, 0x08);
    part.borrow_mut().set(0x08, 8_623_488);
    part.borrow_mut().set(0x0A, 8_402_701);
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
    let sample = now(gyro.sample(&mut sampler, Edge { t_ns: 1, seq: 1 })).unwrap().unwrap();
    assert_eq!(sample.rate.to_udps(), 10_000_000);
    assert_eq!(sample.temp.map(|temp| temp.to_millicelsius()), Some(26_000));
    part.borrow_mut().line = Line::High;
    let result = now(gyro.sample(&mut sampler, Edge { t_ns: 175_668, seq: 2 }));
    assert!(matches!(result, Err(SampleError::Fault(Fault::StuckHigh(_)))), "{result:?}");
}

#[test]
fn the_wait_ends_with_the_edge_or_with_the_bound() {
    for edge in [RdyEdge::Falling, RdyEdge::Rising] {
        let (_, pin, mut gyro) = gyro(Config::new().with_rdy_edge(edge));
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
    let (part, rdy, mut gyro) = gyro(Config::default());
    now(gyro.init()).unwrap();
    part.borrow_mut().rates = (0..32).map(|_| 8_388_608).collect();
    let mut pin = Pin::default();
    let levels = pin.clone();
    let mut delay = Stalls { calls: 0, rdy };
    {
        let mut test = pin!(gyro.self_test(&mut pin, &mut delay, SelfTestPlan::new(16)));
        let mut context = Context::from_waker(Waker::noop());
        assert!(test.as_mut().poll(&mut context).is_pending());
        assert_eq!(levels.0.borrow().levels, [false, true], "active, settling");
    }
    assert_eq!(levels.0.borrow().levels, [false, true, false], "dropped");
}

/// A delay whose second settling never ends.
struct Stalls {
    calls: u32,
    rdy: Pin,
}

impl embedded_hal_async::delay::DelayNs for Stalls {
    async fn delay_ns(&mut self, _ns: u32) {
        self.calls += 1;
        assert_eq!(self.rdy.0.borrow().looks_until_low, 0);
        if self.calls == 2 {
            std::future::pending().await
        }
    }
}
