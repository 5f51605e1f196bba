//! Tests the bytes on the wire (F-22, F-23, F-30), and the constants of F-20, F-21 and F-31 to F-33.

use adis16130::blocking::Adis16130;
use adis16130::registers::{Checksum, ConversionTime, Mode, Range};
use adis16130::{
    Channels, Config, Framing, MAX_SCLK_HZ, MCLK_HZ, MIN_SCLK_HZ, RateCode, RdyEdge, SCALING_CYCLES, SPI_MODE,
    WaitBound, WaitError, Width,
};

use adis16130_twin::{RdyTimeout, Spec, Twin, TwinRdy};
use embedded_hal::digital::{ErrorType, InputPin};

use crate::part::{Delay, F30, Line, Part, Pin, Wire};

#[test]
fn numbers_of_the_interface() {
    assert_eq!(SPI_MODE, embedded_hal::spi::MODE_3); // F-20
    assert_eq!(MAX_SCLK_HZ, 1_000_000_000 / (50 + 50)); // F-21: high and low 50 ns each
    assert_eq!(MIN_SCLK_HZ, 1_100_000); // F-33
    assert_eq!(SCALING_CYCLES, 163); // F-32
    assert_eq!(f64::from(SCALING_CYCLES) / f64::from(MCLK_HZ) * 1e7, 271.666_666_666_666_63); // 27.2 µs at 6.000 MHz
}

#[test]
fn f30_per_byte_and_per_command() {
    for (framing, bytes) in [(Framing::PerByte, 1), (Framing::Command, 2)] {
        let part = Part::new();
        Adis16130::new(Wire(part.clone()), Pin::default(), Config::new().with_framing(framing)).init().unwrap();
        let frames: Vec<Vec<u8>> = F30.chunks(bytes).map(<[u8]>::to_vec).collect();
        assert_eq!(part.borrow().frames, frames);
    }
}

#[test]
fn every_builder_reaches_the_wire() {
    let part = Part::new();
    let config = Config::new()
        .with_rdyfn(false)
        .with_sync(true)
        .with_range(Range::Bits01)
        .with_rate_conversion(ConversionTime::new(0x8A))
        .with_temp_conversion(ConversionTime::new(0x7F))
        .with_width(Width::Bits16)
        .with_clamp(true);
    Adis16130::new(Wire(part.clone()), Pin::default(), config).init().unwrap();
    assert_eq!(
        part.borrow_mut().take_bytes(),
        [0x01, 0x31, 0x28, 0x09, 0x30, 0x8A, 0x2A, 0x09, 0x32, 0x7F, 0x38, 0x21]
    );
}

#[test]
fn a_disabled_channel_is_disabled_and_else_left_alone() {
    for (channels, bytes) in [
        (Channels::Rate, [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x02, 0x38, 0x22]),
        (Channels::Temp, [0x01, 0x38, 0x28, 0x02, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22]),
    ] {
        let part = Part::new();
        let config = Config::new().with_channels(channels);
        let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), config);
        gyro.init_verified().unwrap();
        assert_eq!(part.borrow_mut().take_bytes()[..10], bytes);
        assert_eq!(config.channels(), channels);
    }
}

#[test]
fn f23_reset_is_one_frame_in_either_framing() {
    for framing in [Framing::PerByte, Framing::Command] {
        let part = Part::new();
        let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::new().with_framing(framing));
        gyro.init().unwrap();
        part.borrow_mut().frames.clear();
        gyro.reset().unwrap();
        assert_eq!(part.borrow().frames, [[0x00, 0xFF, 0xFF, 0xFF, 0xFF]]);
        assert_eq!(part.borrow().get(0x38), 0x00);
        assert_eq!(gyro.mode(), Mode::new(0));
    }
}

#[test]
fn reads_in_both_framings_and_widths() {
    for (framing, width, frames) in [
        (
            Framing::PerByte,
            Width::Bits24,
            vec![vec![0x48], vec![0], vec![0], vec![0], vec![0x4A], vec![0], vec![0], vec![0]],
        ),
        (Framing::Command, Width::Bits24, vec![vec![0x48, 0, 0, 0], vec![0x4A, 0, 0, 0]]),
        (Framing::Command, Width::Bits16, vec![vec![0x48, 0, 0], vec![0x4A, 0, 0]]),
    ] {
        let part = Part::new();
        let config = Config::new().with_framing(framing).with_width(width);
        let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), config);
        gyro.init().unwrap();
        part.borrow_mut().set(0x08, 0x1234);
        part.borrow_mut().set(0x0A, 0x5678);
        gyro.read_both().unwrap(); // the first call also checks that there is a reading
        part.borrow_mut().frames.clear();
        let (rate, temp) = gyro.read_both().unwrap();
        assert_eq!((rate.code(), temp.code(), rate.width(), temp.width()), (0x1234, 0x5678, width, width));
        assert_eq!(part.borrow().frames, frames);
    }
}

#[test]
fn width_follows_a_successful_write_only() {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    assert_eq!(gyro.mode().width(), Width::Bits16, "as after a reset");
    part.borrow_mut().fails_after = Some(11); // the last byte of twelve
    gyro.init().unwrap_err();
    assert_eq!(gyro.mode().width(), Width::Bits16);
    part.borrow_mut().fails_after = None;
    gyro.reset().unwrap();
    gyro.init().unwrap();
    assert_eq!(gyro.mode().width(), Width::Bits24);
    gyro.write_register::<Mode>(Mode::new(0x20)).unwrap();
    assert_eq!(gyro.mode().width(), Width::Bits16, "also by hand");
    gyro.verify().unwrap();
}

#[test]
fn f34_checksum_over_the_wire() {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    for expected in [0xE45E, 0x4691, 0x9AEB, 0xFE27] {
        assert_eq!(gyro.read_register::<Checksum>().unwrap().bits(), expected);
    }
    part.borrow_mut().frames.clear();
    assert!(gyro.init_checksummed().unwrap().agrees());
    assert_eq!(part.borrow_mut().take_bytes()[3..15], F30);
    part.borrow_mut().line = Line::Low;
    assert!(!gyro.init_checksummed().unwrap().agrees(), "a hint, not an error");
}

#[test]
fn wait_ready_is_bounded_and_looks_no_oftener_than_it_says() {
    let (part, pin, mut delay) = (Part::new(), Pin::default(), Delay::default());
    part.borrow_mut().set(0x20, 0x08);
    let mut gyro = Adis16130::new(Wire(part), pin.clone(), Config::default());
    let bound = WaitBound::from_us(1_000);

    pin.0.borrow_mut().looks_until_low = 3;
    gyro.wait_ready(&mut delay, bound).unwrap();
    assert_eq!((pin.0.borrow().looks, *delay.0.borrow()), (4, 15_000));

    pin.0.borrow_mut().looks_until_low = u32::MAX;
    *delay.0.borrow_mut() = 0;
    let error = gyro.wait_ready(&mut delay, bound).unwrap_err();
    assert_eq!(error, WaitError::TimedOut { timeout_us: 1_000 });
    assert_eq!((pin.0.borrow().looks, *delay.0.borrow()), (4 + 201, 1_000_000));
    assert!(error.to_string().contains("1000 µs"), "{error}");
}

#[test]
fn the_rdy_edge_is_a_setting() {
    let pin = Pin::default();
    pin.0.borrow_mut().looks_until_low = u32::MAX;
    let config = Config::new().with_rdy_edge(RdyEdge::Rising);
    let part = Part::new();
    part.borrow_mut().set(0x20, 0x08);
    let mut gyro = Adis16130::new(Wire(part), pin, config);
    gyro.wait_ready(&mut Delay::default(), WaitBound::from_us(0)).unwrap();
}

#[test]
fn release_gives_everything_back() {
    let part = Part::new();
    let (wire, _pin) = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default()).release();
    assert!(std::rc::Rc::ptr_eq(&wire.0, &part));
    assert!(part.borrow().frames.is_empty(), "new and release send nothing");
}

/// The RDY line of the twin, as wired: right, through an inverter, or with the pin at ground.
struct Wired(TwinRdy, fn(bool) -> bool);

impl ErrorType for Wired {
    type Error = RdyTimeout;
}

impl InputPin for Wired {
    fn is_high(&mut self) -> Result<bool, RdyTimeout> {
        self.0.is_high().map(self.1)
    }

    fn is_low(&mut self) -> Result<bool, RdyTimeout> {
        self.is_high().map(|high| !high)
    }
}

#[test]
fn no_reading_comes_twice_with_any_rdy_line() {
    let rate_alone = Config::new().with_channels(Channels::Rate);
    let lines: [fn(bool) -> bool; 3] = [|high| high, |high| !high, |_| false];
    for (line, config) in lines.into_iter().flat_map(move |line| [(line, Config::new()), (line, rate_alone)]) {
        let twin = Twin::new(Spec::from_seed(5));
        let mut gyro = Adis16130::new(twin.spi(), Wired(twin.rdy(), line), config);
        gyro.restart().unwrap();
        let mut read = || {
            gyro.wait_ready(&mut twin.delay(), WaitBound::from_us(2_000)).unwrap();
            gyro.read_rate_in_range().unwrap()
        };
        let rates: Vec<RateCode> = (0..400).map(|_| read()).collect();
        let twice = rates.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!(twice <= 2, "{twice} of 400, where chance gives less than one");
    }
}
