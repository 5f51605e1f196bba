//! A data register that has not been updated since the reset holds 8000h (docs/facts.md section 3), the code of 0.0
//! °/s and 25.0 °C. This code is a reading only if a conversion has ended.

use adis16130::blocking::Adis16130;
use adis16130::registers::{Address, Mode, Operation};
use adis16130::{
    Config, Edge, Fault, Framing, MCLK_HZ, NoReading, ReadError, SampleError, Sampler, SamplerConfig, Width,
};
use embedded_hal::spi::ErrorKind;

use crate::part::{Part, Pin, Wire};
use std::{cell::RefCell, rc::Rc};

type Gyro = Adis16130<Wire, Pin>;

/// Parts and drivers with all framings, all widths, and several bytes on SDO between commands. A host that reads 24
/// bits from a 16-bit register gets this byte as the third one.
fn benches() -> impl Iterator<Item = (Rc<RefCell<Part>>, Gyro, Config)> {
    let framings = [Framing::PerByte, Framing::Command];
    let widths = [Width::Bits24, Width::Bits16];
    framings.into_iter().flat_map(move |framing| {
        widths.into_iter().flat_map(move |width| {
            [0x00, 0xFF, 0x80, 0x5A].into_iter().map(move |idle| {
                let part = Part::new();
                (part.borrow_mut().wipes_ready, part.borrow_mut().idle) = (true, idle);
                let config = Config::new().with_framing(framing).with_width(width);
                let gyro = Adis16130::new(Wire(part.clone()), Pin::default(), config);
                (part, gyro, config)
            })
        })
    })
}

/// Sets both data registers and their status, as conversions with these 24-bit codes do.
fn convert(part: &Rc<RefCell<Part>>, config: Config, rate: u32, temp: u32) {
    let drop = 24 - config.width().bits();
    let mut part = part.borrow_mut();
    part.set(0x08, rate >> drop);
    part.set(0x0A, temp >> drop);
    part.set(0x20, 0x08);
    part.set(0x22, 0x48);
}

fn no_reading<T>(register: Address, mode: Mode) -> Result<T, ReadError<ErrorKind>> {
    Err(ReadError::NoReading(NoReading { register, mode }))
}

fn assert_no_reading(gyro: &mut Gyro, mode: Mode) {
    for _ in 0..3 {
        assert_eq!(gyro.read_rate(), no_reading(Address::RateData, mode));
        assert_eq!(gyro.read_temp(), no_reading(Address::TempData, mode));
        assert_eq!(gyro.read_both(), no_reading(Address::RateData, mode));
    }
}

#[test]
fn a_part_that_was_never_initialised_has_no_reading() {
    for (_part, mut gyro, _) in benches() {
        assert_no_reading(&mut gyro, Mode::new(0));
        let text = gyro.read_rate().unwrap_err().to_string();
        assert!(text.contains("RATEDATA (08h)") && text.contains("initialise it"), "{text}");
        gyro.reset().unwrap();
        assert_no_reading(&mut gyro, Mode::new(0));
    }
}

#[test]
fn a_reading_needs_a_conversion() {
    for (part, mut gyro, config) in benches() {
        for _ in 0..2 {
            gyro.restart().unwrap();
            // The data registers hold their reset value in the new width: nothing has been converted.
            convert(&part, config, 0x80_0000, 0x80_0000);
            part.borrow_mut().set(0x20, 0x00);
            part.borrow_mut().set(0x22, 0x40);
            assert_no_reading(&mut gyro, config.mode());
            let text = gyro.read_temp().unwrap_err().to_string();
            assert!(text.contains("TEMPDATA (0Ah)") && text.contains("first conversion has not ended"), "{text}");
            convert(&part, config, 0x81_2300, 0x7F_2300);
            let (rate, temp) = gyro.read_both().unwrap();
            assert_eq!((rate.code24(), temp.code24()), (0x81_2300, 0x7F_2300));
        }
    }
}

#[test]
fn a_conversion_to_the_reset_code_is_a_reading() {
    for (part, mut gyro, config) in benches() {
        gyro.restart().unwrap();
        convert(&part, config, 0x80_0000, 0x80_0000);
        for _ in 0..3 {
            let (rate, temp) = gyro.read_both().unwrap();
            assert_eq!((rate.to_dps(), temp.to_celsius()), (0.0, 25.0));
        }
        gyro.init().unwrap();
        assert_no_reading(&mut gyro, config.mode());
        convert(&part, config, 0x80_0000, 0x80_0000);
        assert_eq!(gyro.read_rate().unwrap().to_dps(), 0.0, "one channel");
        assert_eq!(gyro.read_temp().unwrap().to_celsius(), 25.0);
    }
}

#[test]
fn only_first_and_doubtful_readings_take_more_transfers() {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::new().with_framing(Framing::Command));
    gyro.init().unwrap();
    part.borrow_mut().set(0x20, 0x08);
    let mut commands_of = |code| {
        part.borrow_mut().set(0x08, code);
        part.borrow_mut().frames.clear();
        gyro.read_rate().unwrap();
        part.borrow().frames.len()
    };
    let all = [0x80_0100, 0x80_0100, 0x7F_FFFF, 0x80_0000, 0x80_00FF, 0x80_0000].map(&mut commands_of);
    assert_eq!(all, [4, 1, 1, 3, 3, 3]);
}

#[test]
fn after_a_brown_out_the_configuration_is_lost() {
    for (part, mut gyro, config) in benches() {
        gyro.restart().unwrap();
        convert(&part, config, 0x81_2300, 0x7F_2300);
        gyro.read_both().unwrap();
        part.borrow_mut().reset();
        for _ in 0..3 {
            let lost = |error| matches!(error, ReadError::Fault(Fault::ConfigurationLost(seen)) if seen.got == 0);
            assert!(gyro.read_rate().is_err_and(lost));
            assert!(gyro.read_temp().is_err_and(lost));
            assert!(gyro.read_both().is_err_and(lost));
        }
        gyro.init().unwrap(); // neither resets the part nor reads anything back
        assert_no_reading(&mut gyro, config.mode());
    }
}

#[test]
fn a_brown_out_between_edges_gives_an_error() {
    for read_status in [true, false] {
        for (part, mut gyro, config) in benches() {
            let sampling = SamplerConfig::new().with_read_status(read_status);
            let mut sampler = Sampler::new(sampling, &config, MCLK_HZ);
            gyro.restart().unwrap();
            convert(&part, config, 0x81_2300, 0x7F_2300);
            for n in 1..4 {
                let edge = Edge { t_ns: u64::from(n) * 175_667, seq: n };
                let seen = gyro.sample(&mut sampler, edge);
                if n == 1 {
                    assert_eq!(seen.unwrap().unwrap().rate.code24(), 0x81_2300);
                    part.borrow_mut().reset();
                } else {
                    assert!(matches!(seen, Err(SampleError::Fault(Fault::ConfigurationLost(_)))), "{seen:?}");
                }
            }
        }
    }
}

#[test]
fn edges_before_the_first_conversion_give_no_sample() {
    for read_status in [true, false] {
        for (part, mut gyro, config) in benches() {
            let sampling = SamplerConfig::new().with_read_status(read_status);
            let mut sampler = Sampler::new(sampling, &config, MCLK_HZ);
            gyro.restart().unwrap();
            assert_eq!(gyro.sample(&mut sampler, Edge { t_ns: 0, seq: 1 }), Ok(None), "a glitch");
            convert(&part, config, 0x80_0000, 0x80_0000);
            part.borrow_mut().set(0x22, 0x40);
            let sample = gyro.sample(&mut sampler, Edge { t_ns: 175_667, seq: 2 }).unwrap().unwrap();
            assert_eq!((sample.rate.code24(), sample.temp), (0x80_0000, None), "without RDYFN the rate comes first");
            convert(&part, config, 0x80_0000, 0x80_0000);
            let sample = gyro.sample(&mut sampler, Edge { t_ns: 351_334, seq: 3 }).unwrap().unwrap();
            assert_eq!(sample.temp.map(|temp| temp.code24()), Some(0x80_0000), "it was still due");
        }
    }
}

#[test]
fn a_part_that_runs_otherwise_than_written_is_a_fault() {
    // the host has started anew and does not initialise the part, which still converts to 24 bits
    let part = Part::new();
    let config = Config::new().with_framing(Framing::Command);
    Adis16130::new(Wire(part.clone()), Pin::default(), config).init().unwrap();
    convert(&part, config, 0x81_2345, 0x7F_2345);
    let mut gyro = Adis16130::new(Wire(part), Pin::default(), config);
    let ReadError::Fault(Fault::Unexpected(seen)) = gyro.read_rate().unwrap_err() else { panic!("another error") };
    assert_eq!((seen.register, seen.got), (Address::Mode, 0x22));
}

#[test]
fn single_conversions_are_readings() {
    let part = Part::new();
    part.borrow_mut().wipes_ready = true;
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    gyro.init().unwrap();
    for _ in 0..2 {
        gyro.write_register::<Mode>(Mode::new(0x02).with_operation(Operation::Single)).unwrap();
        part.borrow_mut().set(0x08, 0x80_0000);
        assert_eq!(gyro.read_rate(), no_reading(Address::RateData, Mode::new(0x42)));
        part.borrow_mut().set(0x20, 0x08);
        assert_eq!(gyro.read_rate().unwrap().code(), 0x80_0000);
    }
}
