//! The bridge, with the mock of `part.rs` as its gyroscope. Its frames are compared with bytes that were made by hand
//! from `docs/formats/bridge.md`.

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::time::Duration;

use adis16130::bridge::{
    Answer, Bus, Client, Command, Continuity, DamagedFrame, Decoder, Event, MAX_FRAME, Message, Pending, Refusal,
    Request, RequestError, Settings, Station, Step, WireSample, encode,
};
use adis16130::{Config, ConversionTime, Edge, RdyEdge, Width};
use embedded_hal_async::spi::{ErrorType, Operation, SpiDevice};

use crate::part::{F30, Line, Part, Wire, now};

const START: Command<'static> = Command::Start { every_temp: 1, divider: 1, mclk_hz: 6_000_000 };
const READING: WireSample = WireSample {
    number: 3,
    lost: 1,
    t_ns: 1_000_000_000,
    edge: 7,
    rate: 0x80_8809,
    status: Some(0x08),
    temp: Some(0x80_1EA6),
};

/// Requests and their frames. zlib computed the CRC-32.
const REQUESTS: [(Request<'_>, &[u8]); 5] = [
    (Request { tag: 7, command: Command::Hello }, &[0x02, 0x07, 0x05, 0x38, 0x84, 0x98, 0x0E, 0x00]),
    (
        Request { tag: 8, command: Command::Clock { sclk_hz: 5_000_000 } },
        &[0x0B, 0x08, 0x01, 0xC0, 0x96, 0xB1, 0x02, 0xEF, 0xDE, 0xF2, 0xFC, 0x00],
    ),
    (
        Request { tag: 9, command: Command::Transfer { bytes: &[0x68, 0x00] } },
        &[0x05, 0x09, 0x02, 0x02, 0x68, 0x05, 0x26, 0x68, 0x9B, 0xCF, 0x00],
    ),
    (
        Request { tag: 10, command: START },
        &[0x0D, 0x0A, 0x04, 0x01, 0x01, 0x80, 0x9B, 0xEE, 0x02, 0xC3, 0x43, 0x7D, 0xC4, 0x00],
    ),
    (
        Request { tag: 11, command: Command::Divided { edges: 50 } },
        &[0x08, 0x0B, 0x08, 0x32, 0x7B, 0xED, 0x1A, 0xF3, 0x00],
    ),
];

const MESSAGES: [(Message<'_>, &[u8]); 4] = [
    (
        Message::Answer { tag: 9, answer: Answer::Transfer { bytes: &[0xFF, 0x40] } },
        &[0x01, 0x0A, 0x09, 0x02, 0x02, 0xFF, 0x40, 0xD5, 0x63, 0xA7, 0xF0, 0x00],
    ),
    (
        Message::Answer { tag: 10, answer: Answer::Refused(Refusal::Part) },
        &[0x01, 0x08, 0x0A, 0x06, 0x02, 0x60, 0x9C, 0x87, 0x94, 0x00],
    ),
    (
        Message::Sample(READING),
        &[
            0x19, 0x01, 0x03, 0x01, 0x80, 0x94, 0xEB, 0xDC, 0x03, 0x07, 0x89, 0x90, 0x82, 0x04, 0x01, 0x08, 0x01,
            0xA6, 0xBD, 0x80, 0x04, 0x52, 0x95, 0x81, 0x88, 0x00,
        ],
    ),
    (Message::Ended, &[0x06, 0x02, 0xA1, 0x8E, 0x0C, 0x3C, 0x00]),
];

/// Decodes bytes, and returns the messages as `Debug` prints them.
macro_rules! decoded {
    ($message:ty, $bytes:expr) => {{
        let mut decoder = Decoder::new();
        let messages = $bytes.iter().filter_map(|byte| {
            decoder.push::<$message>(*byte).map(|message| message.map(|message| format!("{message:?}")))
        });
        messages.collect::<Vec<Result<String, DamagedFrame>>>()
    }};
}

#[test]
fn frames_are_those_of_the_specification() {
    for (request, bytes) in REQUESTS {
        assert_eq!(encode(&request, &mut [0; MAX_FRAME]).unwrap(), bytes, "{request:?}");
        assert_eq!(decoded!(Request<'_>, bytes), [Ok(format!("{request:?}"))]);
    }
    for (message, bytes) in MESSAGES {
        assert_eq!(encode(&message, &mut [0; MAX_FRAME]).unwrap(), bytes, "{message:?}");
        assert_eq!(decoded!(Message<'_>, bytes), [Ok(format!("{message:?}"))]);
    }
}

fn asked(client: &mut Client, pending: &mut Pending<'_>, ms: u64, bytes: &[u8]) -> Result<Step<()>, RequestError> {
    client.poll(pending, &mut bytes.iter().copied(), Duration::from_millis(ms), Answer::Started.only())
}

#[test]
fn a_client_asks_three_times_and_takes_the_answer_to_the_last() {
    let answer = |tag, answer| encode(&Message::Answer { tag, answer }, &mut [0; MAX_FRAME]).unwrap().to_vec();
    let mut client = Client::default();
    let mut pending = Pending::new(START);
    for tag in 1..=3 {
        let ms = 500 * (u64::from(tag) - 1);
        let Ok(Step::Send(frame)) = asked(&mut client, &mut pending, ms, &[]) else { panic!("attempt {tag}") };
        assert_eq!(frame.bytes()[0], 0);
        assert_eq!(decoded!(Request<'_>, frame.bytes()), [Ok(format!("{:?}", Request { tag, command: START }))]);
        let stale = [answer(tag - 1, Answer::Started), answer(tag, Answer::Stopped), vec![1, 2, 0]].concat();
        let waited = asked(&mut client, &mut pending, ms + 499, &stale);
        assert!(matches!(waited, Ok(Step::Wait(until)) if until == Duration::from_millis(ms + 500)), "{waited:?}");
    }
    assert_eq!(client.damaged, 3);
    assert!(matches!(asked(&mut client, &mut pending, 1500, &[]), Err(RequestError::Silent)));
    let refused = answer(3, Answer::Refused(Refusal::Part));
    let refused = asked(&mut client, &mut pending, 1500, &refused);
    assert!(matches!(refused, Err(RequestError::Refused(Refusal::Part))), "{refused:?}");
    let both = [answer(3, Answer::Started), MESSAGES[2].1.to_vec()].concat();
    let mut received = both.iter().copied();
    let answered = client.poll(&mut pending, &mut received, Duration::MAX, Answer::Started.only());
    assert!(matches!(answered, Ok(Step::Answered(()))), "{answered:?}");
    assert_eq!(client.next_event(&mut received), Some(Event::Sample(READING)), "what follows the answer is left");
}

#[test]
fn the_longest_reading_fits() {
    let longest = WireSample {
        number: u32::MAX,
        lost: u32::MAX,
        t_ns: u64::MAX,
        edge: u32::MAX,
        rate: 0xFF_FFFF,
        status: Some(0xFF),
        temp: Some(0xFF_FFFF),
    };
    assert!(encode(&Message::Sample(longest), &mut [0; MAX_FRAME]).is_ok());
    let hello = Answer::Hello { protocol: u16::MAX, firmware: "x".repeat(24).leak(), sclk_hz: u32::MAX };
    assert!(encode(&Message::Answer { tag: 0, answer: hello }, &mut [0; MAX_FRAME]).is_ok());
    let long = [0xFF; 64];
    let request = Request { tag: 0, command: Command::Transfer { bytes: &long } };
    assert!(encode(&request, &mut [0; MAX_FRAME]).is_err());
}

#[test]
fn every_damaged_bit_is_found() {
    let (_, sound) = MESSAGES[2];
    for bit in 0..8 * (sound.len() - 1) {
        let mut bytes = sound.to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let mut decoder = Decoder::new();
        let seen: Vec<_> = bytes
            .iter()
            .chain(sound)
            .filter_map(|byte| decoder.push::<Message<'_>>(*byte).map(|message| message.is_ok()))
            .collect();
        // a flipped bit can make or remove the zero at the end of a frame, so the next frame may be joined to this one
        assert!(seen.starts_with(&[false]), "bit {bit}: {seen:?}");
        assert_eq!(seen.last(), Some(&true), "bit {bit}: {seen:?}");
    }
}

#[test]
fn rubbish_is_damaged_and_silence_is_not() {
    assert_eq!(decoded!(Message<'_>, [0; 5]), []);
    assert_eq!(decoded!(Message<'_>, [1; 200]), []);
    let endless = [[1; 200].as_slice(), &[0]].concat();
    assert_eq!(decoded!(Message<'_>, endless), [Err(DamagedFrame)]);
    // message 9, which does not exist, with its right CRC
    assert_eq!(decoded!(Message<'_>, [0x06, 0x09, 0x29, 0x57, 0xDE, 0xAB, 0x00]), [Err(DamagedFrame)]);
}

#[test]
fn a_transfer_reaches_the_part() {
    let (part, mut station) = station();
    part.borrow_mut().set(0x28, 0x40);
    let hello = Answer::Hello { protocol: 2, firmware: "test 1", sclk_hz: 1_000_000 };
    assert_eq!(answer(&mut station, Command::Hello), hello);
    let clock = answer(&mut station, Command::Clock { sclk_hz: 2_500_000 });
    assert_eq!(clock, Answer::Clock { sclk_hz: 2_000_000 });
    let hello = Answer::Hello { protocol: 2, firmware: "test 1", sclk_hz: 2_000_000 };
    assert_eq!(answer(&mut station, Command::Hello), hello);
    let transfer = Command::Transfer { bytes: &[0x68, 0x00] };
    let Answer::Transfer { bytes } = answer(&mut station, transfer) else { panic!("no transfer") };
    assert_eq!((bytes.len(), bytes[1]), (2, 0x40));
    assert_eq!(part.borrow().frames.last(), Some(&vec![0x68, 0x00]));
    assert_eq!(refusal(&mut station, Command::Transfer { bytes: &[0; 9] }), Some(Refusal::TooLong));
}

#[test]
fn a_bridge_samples_between_start_and_stop() {
    let (part, mut station) = station();
    assert_eq!(now(station.edge(Edge { t_ns: 5, seq: 1 })), None);
    assert_eq!(answer(&mut station, Command::LastEdge), Answer::LastEdge { t_ns: 5, seq: 1 });
    assert_eq!(refusal(&mut station, START), None);
    let written: Vec<Vec<u8>> = F30.chunks(2).map(<[u8]>::to_vec).collect();
    assert_eq!(part.borrow().frames[0], [0x00, 0xFF, 0xFF, 0xFF, 0xFF]);
    assert_eq!(part.borrow().frames[1..=written.len()], written);
    assert_eq!(refusal(&mut station, Command::Transfer { bytes: &[0x68, 0x00] }), Some(Refusal::Sampling));

    ready(&part, 0x80_1EA6);
    // an edge comes every 175 667 ns (F-31), and the one before the last is missing
    for (number, pairs) in [0, 1, 3].into_iter().enumerate() {
        let t_ns = 1_000_000 + 175_667 * u64::from(pairs);
        let seq = 2 + pairs;
        let Some(Message::Sample(reading)) = now(station.edge(Edge { t_ns, seq })) else { panic!("no sample") };
        let lost = u32::from(pairs == 3);
        assert_eq!((reading.number, reading.lost), (number as u32, lost));
        assert_eq!((reading.t_ns, reading.edge, reading.rate), (t_ns, seq, 0x80_8809));
        assert_eq!((reading.status, reading.temp), (Some(0x08), Some(0x80_1EA6)));
    }
    assert_eq!(answer(&mut station, Command::Stop), Answer::Stopped);
    assert_eq!(now(station.edge(Edge { t_ns: 9_000_000, seq: 9 })), None);
}

#[test]
fn a_host_chooses_the_configuration_of_the_next_start() {
    let (part, mut station) = station();
    let config = Config::new().with_width(Width::Bits16).with_rate_conversion(ConversionTime::new(0x89));
    assert_eq!(Config::from(Settings::from(&config)), config);
    assert_eq!(answer(&mut station, Command::Configure(Settings::from(&config))), Answer::Configured);
    assert_eq!(refusal(&mut station, START), None);
    // byte by byte (F-22), with F-30's last byte for 16 bits
    let sent = part.borrow().frames.concat();
    let expected = [0x01, 0x38, 0x28, 0x0A, 0x30, 0x89, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x20];
    assert!(sent.windows(12).any(|window| window == expected), "{sent:02X?}");
    assert!(part.borrow().frames[1..].iter().all(|frame| frame.len() == 1));
    let rising = Settings::from(&config.with_rdy_edge(RdyEdge::Rising));
    assert_eq!(refusal(&mut station, Command::Configure(rising)), Some(Refusal::NoSuchWire), "unless its bus can");
    assert!(!station.is_sampling(), "what is configured anew begins anew");
    let reading = WireSample { rate: 0x80_8800, temp: Some(0x80_1E00), ..READING };
    let sample = Continuity::new(Width::Bits16).sample(&reading);
    assert_eq!((sample.rate.code(), sample.temp.map(|temp| temp.code())), (0x8088, Some(0x801E)));
}

#[test]
fn a_counter_in_the_line_loses_nothing_once_the_bridge_knows_of_it() {
    let lost = |divided: Option<Command<'static>>| {
        let (part, mut station) = station();
        for command in
            [Some(Command::Configure(Settings::from(&Config::new()))), divided, Some(START)].into_iter().flatten()
        {
            assert_eq!(refusal(&mut station, command), None);
        }
        let mut lost = 0;
        for n in 1..=100 {
            ready(&part, 0x80_1EA6);
            // every 50th edge is 51 conversions after the one before (F-56)
            let t_ns = 51 * 87_833 * u64::from(n);
            let Some(Message::Sample(reading)) = now(station.edge(Edge { t_ns, seq: n })) else { panic!("a sample") };
            lost = reading.lost;
        }
        lost
    };
    assert_eq!(lost(Some(Command::Divided { edges: 50 })), 0);
    assert!(lost(None) > 99 * 24, "{}", lost(None));
    let (_, mut station) = station();
    assert_eq!(answer(&mut station, Command::Divided { edges: 50 }), Answer::Configured);
}

#[test]
fn the_self_test_pin_is_released_with_the_host() {
    let mut without = Station::new(Wire(Part::new()), 1_000_000, "test 1");
    assert_eq!(refusal(&mut without, Command::SelfTest { on: true }), Some(Refusal::NoSuchWire));
    let pin = Rc::new(Cell::new(false));
    let mut station = Station::new(Slow { wire: Wire(Part::new()), pin: Some(pin.clone()) }, 1_000_000, "test 1");
    assert_eq!(answer(&mut station, Command::SelfTest { on: true }), Answer::SelfTest { on: true });
    assert!(pin.get());
    station.stop();
    assert!(!pin.get());
}

#[test]
fn a_bridge_reports_that_the_part_is_gone() {
    let (part, mut station) = station();
    assert_eq!(refusal(&mut station, START), None);
    part.borrow_mut().line = Line::High;
    assert_eq!(now(station.edge(Edge { t_ns: 1, seq: 1 })), Some(Message::Ended));
    assert!(!station.is_sampling());
    assert_eq!(refusal(&mut station, START), Some(Refusal::Part));
}

#[test]
fn sampling_goes_on_after_a_temperature_out_of_range() {
    let (part, mut station) = station();
    assert_eq!(refusal(&mut station, START), None);
    let mut reading = |n, temp| {
        ready(&part, temp);
        now(station.edge(Edge { t_ns: 175_667 * u64::from(n), seq: n }))
    };
    assert!(matches!(reading(1, 0x80_1EA6), Some(Message::Sample(_))));
    assert_eq!(reading(2, 0xFF_FFFF), None);
    assert!(matches!(reading(3, 0x80_1EA6), Some(Message::Sample(reading)) if reading.lost == 1));
}

#[test]
fn sampling_goes_on_after_a_failed_transfer_which_is_counted() {
    for failing in 0..3 {
        let (part, mut station) = station();
        assert_eq!(refusal(&mut station, START), None);
        let mut lost = Vec::new();
        for n in 1..6 {
            ready(&part, 0x80_1EA6);
            if n == 3 {
                (part.borrow_mut().fails_after, part.borrow_mut().fails_once) = (Some(failing), true);
            }
            match now(station.edge(Edge { t_ns: 175_667 * u64::from(n), seq: n })) {
                Some(Message::Sample(reading)) => {
                    assert_eq!((reading.rate, reading.temp), (0x80_8809, Some(0x80_1EA6)));
                    lost.push(reading.lost);
                }
                other => assert_eq!((other, n), (None, 3)),
            }
        }
        assert_eq!(lost, [0, 0, 1, 1], "transfer {failing} of the sample");
        part.borrow_mut().fails_after = Some(0);
        part.borrow_mut().fails_once = false;
        assert_eq!(now(station.edge(Edge { t_ns: 2_000_000, seq: 9 })), Some(Message::Ended), "it stays so");
    }
}

#[test]
fn missing_samples_are_counted_once() {
    let mut continuity = Continuity::default();
    // The bridge lost two samples before the first and one later. Three more were lost on the link.
    let readings = [(0, 2), (1, 2), (5, 3), (6, 3)];
    let samples = readings.map(|(number, lost)| continuity.sample(&WireSample { number, lost, ..READING }));
    assert_eq!(samples.map(|sample| sample.lost), [2, 0, 4, 0]);
    assert_eq!(continuity.missing(), 3);
    let sample = samples[0];
    assert_eq!((sample.t_ns, sample.seq, sample.rate.code()), (1_000_000_000, 7, 0x80_8809));
    assert_eq!(sample.rate.width(), Width::Bits24);
    assert_eq!(sample.status.map(|status| status.bits()), Some(0x08));
    assert_eq!(sample.temp.map(|temp| temp.code24()), Some(0x80_1EA6));
}

fn station() -> (Rc<RefCell<Part>>, Station<Slow>) {
    let part = Part::new();
    (part.clone(), Station::new(Slow { wire: Wire(part), pin: None }, 1_000_000, "test 1"))
}

/// Gives the part a new rate and this temperature.
fn ready(part: &RefCell<Part>, temp: u32) {
    let mut part = part.borrow_mut();
    part.set(0x20, 0x08);
    part.set(0x08, 0x80_8809);
    part.set(0x0A, temp);
}

/// A bus whose clock can be set in steps of 1 MHz.
struct Slow {
    wire: Wire,
    /// The level of the self-test pins. `None` if the bridge has no self-test pin.
    pin: Option<Rc<Cell<bool>>>,
}

impl ErrorType for Slow {
    type Error = <Wire as ErrorType>::Error;
}

impl SpiDevice for Slow {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        SpiDevice::transaction(&mut self.wire, operations).await
    }
}

impl Bus for Slow {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        hz / 1_000_000 * 1_000_000
    }

    fn set_self_test(&mut self, on: bool) -> bool {
        self.pin.as_ref().map(|pin| pin.set(on)).is_some()
    }
}

impl Bus for Wire {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        hz
    }
}

fn answer<'a>(station: &'a mut Station<impl Bus>, command: Command<'_>) -> Answer<'a> {
    match now(station.request(&Request { tag: 3, command })) {
        Message::Answer { tag: 3, answer } => answer,
        other => panic!("{other:?}"),
    }
}

fn refusal(station: &mut Station<impl Bus>, command: Command<'_>) -> Option<Refusal> {
    match answer(station, command) {
        Answer::Refused(refusal) => Some(refusal),
        _ => None,
    }
}
