//! Tests of the sampling side, run on the host. The part is a twin, and the test replaces the USB port.

extern crate std;

use core::cell::Cell;
use core::convert::Infallible;
use core::future::Future;
use core::pin::Pin;
use std::boxed::Box;
use std::format;
use std::rc::Rc;
use std::string::String;
use std::vec::Vec;

use adis16130::bridge::{Bus, Command, Decoder, MAX_FRAME, Message, Request, WireSample, encode};
use adis16130::{Edge, RdyEdge};
use adis16130_twin::{Fault, Spec, Twin, TwinSpi};
use embassy_futures::poll_once;
use embassy_time::MockDriver;
use embedded_hal::digital::{ErrorType as PinErrorType, OutputPin};
use embedded_hal_async::digital::Wait;
use embedded_hal_async::spi::{ErrorType, Operation, SpiBus, SpiDevice};

use crate::bus::PartBus;
use crate::link::SIGN_OF_LIFE;
use crate::state::State;
use crate::{Link, port, sampling};

const START: Command<'static> = Command::Start { every_temp: 1, divider: 1, mclk_hz: 6_000_000 };
const END_OF_FRAME: &[u8] = &[0];

#[test]
fn samples_without_room_are_dropped_whole() {
    let mut bench = Bench::full();
    let kept = bench.readings();
    assert!(kept.len() > 900, "{}", kept.len());
    assert!(kept.iter().zip(0..).all(|(reading, number)| reading.number == number));
    bench.edge();
    let after = bench.readings();
    assert_eq!((after.len(), after[0].number, after[0].lost), (1, 2_000, 0));
}

#[test]
fn answers_wait_for_room() {
    let mut bench = Bench::full();
    for _ in 0..8 {
        bench.request(Command::Stop);
    }
    assert!(bench.link.to_host.is_full());
    let messages = bench.messages();
    assert!(messages.iter().rev().take(8).all(|message| message == "Answer { tag: 7, answer: Stopped }"));
}

#[test]
fn a_host_that_leaves_leaves_nothing() {
    for waits in [false, true] {
        let mut bench = Bench::full();
        for _ in 0..if waits { 8 } else { 0 } {
            bench.request(Command::LastEdge);
        }
        bench.link.hang_up();
        bench.poll();
        bench.edge();
        assert_eq!(bench.bytes(), END_OF_FRAME);
        assert_eq!(bench.ask(Command::Stop), ["Answer { tag: 7, answer: Stopped }"]);
    }
}

#[test]
fn rubbish_costs_one_request() {
    let mut bench = Bench::new();
    assert_eq!(bench.link.from_host.try_write(&[1; 100]), Ok(100));
    bench.poll();
    assert_eq!(bench.ask(Command::Stop), [""; 0]);
    assert_eq!(bench.ask(Command::Stop), ["Answer { tag: 7, answer: Stopped }"]);
}

#[test]
fn the_edges_that_a_host_chooses_are_numbered_from_one() {
    let link: &Link = Box::leak(Box::default());
    let mut bus = PartBus::new(NoController, Level::default(), |_, hz| hz, Level::default(), link);
    let mut watch = core::pin::pin!(sampling::watch(Edges { falls: 3, rises: 5 }, link));
    assert!(poll_once(watch.as_mut()).is_pending());
    let edge = link.edge.try_take().unwrap();
    assert_eq!((edge.seq, edge.t_ns % 1_000), (3, 0));
    assert!(bus.set_rdy_edge(RdyEdge::Rising));
    assert!(poll_once(watch.as_mut()).is_pending());
    assert_eq!(link.edge.try_take().map(|edge| edge.seq), Some(8));
    assert!(bus.set_rdy_edge(RdyEdge::Falling));
    assert!(poll_once(watch.as_mut()).is_pending());
    assert!(link.edge.try_take().is_none());
}

#[test]
fn the_self_test_pin_follows_the_host() {
    let pin = Level::default();
    let level = pin.0.clone();
    let link: &Link = Box::leak(Box::default());
    let mut bus = PartBus::new(NoController, Level::default(), |_, hz| hz, pin, link);
    for on in [true, false] {
        assert!(bus.set_self_test(on));
        assert_eq!(level.get(), on);
    }
}

/// The watchdog is fed while idle and while an answer waits for space, but not while a transfer never ends.
#[test]
fn the_watchdog_is_fed_by_a_living_task_only() {
    let mut idle = Bench::new();
    let mut waits = Bench::full();
    for _ in 0..8 {
        waits.request(Command::LastEdge);
    }
    let mut hangs = Bench::with_bus(true);
    hangs.request(START);
    for bench in [&mut idle, &mut waits, &mut hangs] {
        bench.signs.set(0);
    }
    for _ in 0..8 {
        MockDriver::get().advance(SIGN_OF_LIFE);
        for bench in [&mut idle, &mut waits, &mut hangs] {
            bench.poll();
        }
    }
    // all tests share one clock, and no other test advances it
    assert!(idle.signs.get() >= 8 && waits.signs.get() >= 8, "{} {}", idle.signs.get(), waits.signs.get());
    assert_eq!(hangs.signs.get(), 0);
    assert!(sampling::WATCHDOG >= 4 * SIGN_OF_LIFE);
}

#[test]
fn the_lamp_shows_what_is_done() {
    let mut bench = Bench::new();
    assert_eq!(bench.link.state(), State::Idle);
    bench.ask(Command::Hello);
    assert_eq!(bench.link.state(), State::Ready);
    bench.ask(START);
    assert_eq!(bench.link.state(), State::Sampling);
    bench.ask(Command::Stop);
    assert_eq!(bench.link.state(), State::Ready);
    bench.link.hang_up();
    bench.poll();
    assert_eq!(bench.link.state(), State::Idle);
    let second = |state: State| (0..8).map(|tick| if state.is_lit(tick) { '#' } else { '.' }).collect::<String>();
    assert_eq!(
        [State::Idle, State::Ready, State::Sampling, State::Failed].map(second),
        ["#.......", "########", "####....", "#.#.#.#."]
    );
}

#[test]
fn a_part_that_falls_silent_shows() {
    let mut bench = Bench::new();
    bench.ask(START);
    bench.twin.set_fault(Fault::SdoLow);
    for _ in 0..200 {
        bench.edge();
        bench.bytes();
    }
    assert_eq!(bench.link.state(), State::Failed);
}

#[test]
fn serial_numbers_are_text() {
    let mut room = [0; 16];
    assert_eq!(port::hex([0xE6, 0x61, 0x38, 0x52, 0x83, 0x0A, 0xBF, 0x09], &mut room), "E6613852830ABF09");
}

struct Bench {
    twin: Twin,
    link: &'static Link,
    signs: Rc<Cell<u32>>,
    serve: Pin<Box<dyn Future<Output = Infallible>>>,
}

impl Bench {
    fn new() -> Self {
        Self::with_bus(false)
    }

    fn with_bus(hangs: bool) -> Self {
        let twin = Twin::new(Spec::from_seed(1));
        let link: &Link = Box::leak(Box::default());
        let signs = Rc::new(Cell::new(0));
        let (bus, count) = (TwinBus { spi: twin.spi(), hangs }, signs.clone());
        let alive = move || count.set(count.get() + 1);
        let serve = Box::pin(async move { sampling::serve(bus, "test 1", link, alive).await });
        Self { twin, link, signs, serve }
    }

    /// A bench that has taken 2000 samples, of which the host has read none.
    fn full() -> Self {
        let mut bench = Self::new();
        bench.ask(START);
        for _ in 0..2_000 {
            bench.edge();
        }
        bench
    }

    fn edge(&mut self) {
        if let Some(edge) = self.twin.next_falling_edge(1_000_000) {
            self.link.edge.signal(Edge { t_ns: edge.t_ns, seq: edge.seq });
        }
        self.poll();
    }

    fn request(&mut self, command: Command<'_>) {
        let mut room = [0; MAX_FRAME];
        let frame = encode(&Request { tag: 7, command }, &mut room).unwrap();
        assert_eq!(self.link.from_host.try_write(frame), Ok(frame.len()));
        self.poll();
    }

    fn ask(&mut self, command: Command<'_>) -> Vec<String> {
        self.request(command);
        self.messages()
    }

    fn poll(&mut self) {
        assert!(poll_once(self.serve.as_mut()).is_pending());
    }

    /// Takes the queued bytes, and the bytes that were waiting for space in the queue.
    fn bytes(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut some = [0; 63];
        while let Ok(len) = self.link.to_host.try_read(&mut some) {
            bytes.extend_from_slice(&some[..len]);
            self.poll();
        }
        bytes
    }

    fn messages(&mut self) -> Vec<String> {
        self.decoded(|message| format!("{message:?}"))
    }

    fn readings(&mut self) -> Vec<WireSample> {
        self.decoded(|message| match message {
            Message::Sample(reading) => reading,
            other => panic!("{other:?}"),
        })
    }

    fn decoded<T>(&mut self, each: impl Fn(Message<'_>) -> T) -> Vec<T> {
        let mut decoder = Decoder::new();
        let bytes = self.bytes();
        bytes.iter().filter_map(|byte| decoder.push(*byte).map(|message| each(message.unwrap()))).collect()
    }
}

struct TwinBus {
    spi: TwinSpi,
    /// Whether transfers never end.
    hangs: bool,
}

impl ErrorType for TwinBus {
    type Error = Infallible;
}

impl SpiDevice for TwinBus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        if self.hangs {
            core::future::pending::<()>().await;
        }
        SpiDevice::transaction(&mut self.spi, operations).await
    }
}

impl Bus for TwinBus {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        hz
    }
}

/// A pin with these numbers of falls and rises. Each edge comes at once.
struct Edges {
    falls: u32,
    rises: u32,
}

impl PinErrorType for Edges {
    type Error = Infallible;
}

impl Wait for Edges {
    async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
        take_one(&mut self.falls).await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
        take_one(&mut self.rises).await
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn wait_for_high(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn wait_for_low(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }
}

async fn take_one(left: &mut u32) -> Result<(), Infallible> {
    if *left == 0 {
        core::future::pending::<()>().await;
    }
    *left -= 1;
    Ok(())
}

#[derive(Default)]
struct Level(Rc<Cell<bool>>);

impl PinErrorType for Level {
    type Error = Infallible;
}

impl OutputPin for Level {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        Ok(())
    }
}

struct NoController;

impl ErrorType for NoController {
    type Error = Infallible;
}

impl SpiBus for NoController {
    async fn read(&mut self, _: &mut [u8]) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn write(&mut self, _: &[u8]) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn transfer_in_place(&mut self, _: &mut [u8]) -> Result<(), Infallible> {
        unreachable!()
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        unreachable!()
    }
}
