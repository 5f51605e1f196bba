//! Each fault on the wire gives its own error, with the register that shows the fault.

use adis16130::blocking::Adis16130;
use adis16130::registers::Address;
use adis16130::{BusError, Config, Fault, InitError, Mismatch, OutOfRange, ReadError, VerifyError, Width};
use embedded_hal::spi::ErrorKind;

use crate::part::{Line, Part, Pin, Wire};
use std::{cell::RefCell, rc::Rc};

type Gyro = Adis16130<Wire, Pin>;

fn initialised() -> (Rc<RefCell<Part>>, Gyro) {
    let part = Part::new();
    let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
    gyro.init_verified().unwrap();
    (part, gyro)
}

#[test]
fn verify_reads_every_written_register_back() {
    let (part, mut gyro) = initialised();
    part.borrow_mut().frames.clear();
    gyro.verify().unwrap();
    assert_eq!(part.borrow_mut().take_bytes(), [0x41, 0, 0x68, 0, 0x70, 0, 0x6A, 0, 0x72, 0, 0x78, 0]);
}

#[test]
fn verify_before_init_is_an_error() {
    let mut gyro = Adis16130::new(Wire(Part::new()), Pin::default(), Config::default());
    assert_eq!(gyro.verify(), Err(VerifyError::NotInitialised));
}

#[test]
fn verify_names_the_register_that_differs() {
    let part = Part::new();
    part.borrow_mut().deaf_at = Some(0x30);
    let mut gyro = Adis16130::new(Wire(part), Pin::default(), Config::default());
    let error = gyro.init_verified().unwrap_err();
    let InitError::Verify(VerifyError::Differs(differences)) = error else { panic!("{error:?}") };
    let expected = Mismatch { register: Address::RateConv, expected: 0x05, got: 0x91 };
    assert_eq!(differences.iter().collect::<Vec<_>>(), [expected]);
    assert!(error.to_string().contains("RATECONV (30h) reads 91h instead of 05h"), "{error}");
}

#[test]
fn verify_tells_stuck_lines_and_a_brown_out_apart() {
    let (part, mut gyro) = initialised();
    part.borrow_mut().line = Line::High;
    assert!(matches!(gyro.verify(), Err(VerifyError::StuckHigh(seen)) if seen.iter().count() == 6));
    part.borrow_mut().line = Line::Low;
    assert!(matches!(gyro.verify(), Err(VerifyError::StuckLow(seen)) if seen.iter().count() == 6));
    part.borrow_mut().line = Line::Flip(0x38, 0x04);
    assert!(matches!(gyro.verify(), Err(VerifyError::Differs(seen)) if seen.iter().count() == 1));
    part.borrow_mut().line = Line::Good;
    part.borrow_mut().reset(); // a brown-out
    assert!(matches!(gyro.verify(), Err(VerifyError::ConfigurationLost(seen)) if seen.iter().count() == 6));
    gyro.init_verified().unwrap();
}

#[test]
fn diagnose_tells_stuck_lines_and_a_brown_out_apart() {
    let (part, mut gyro) = initialised();
    assert_eq!(gyro.diagnose(), Ok(None));
    part.borrow_mut().line = Line::High;
    assert!(matches!(gyro.diagnose(), Ok(Some(Fault::StuckHigh(_)))));
    part.borrow_mut().line = Line::Low;
    assert!(matches!(gyro.diagnose(), Ok(Some(Fault::StuckLow(_)))));
    part.borrow_mut().line = Line::Flip(0x38, 0x04);
    let bits = Mismatch { register: Address::Mode, expected: 0x22, got: 0x26 };
    assert_eq!(gyro.diagnose(), Ok(Some(Fault::Unexpected(bits))));
    part.borrow_mut().line = Line::Flip(0x22, 0x20);
    let channel = Mismatch { register: Address::TempStatus, expected: 0x40, got: 0x60 };
    assert_eq!(gyro.diagnose(), Ok(Some(Fault::Unexpected(channel))));
    part.borrow_mut().line = Line::Good;
    part.borrow_mut().reset(); // a brown-out
    let lost = Mismatch { register: Address::Mode, expected: 0x22, got: 0x00 };
    assert_eq!(gyro.diagnose(), Ok(Some(Fault::ConfigurationLost(lost))));
}

#[test]
fn a_part_that_was_never_initialised_is_healthy() {
    let mut gyro = Adis16130::new(Wire(Part::new()), Pin::default(), Config::default());
    assert_eq!(gyro.diagnose(), Ok(None));
    assert_eq!(gyro.revision().unwrap().bits(), 0x24);
    assert_eq!(gyro.temp_status().unwrap().channel(), 2);
}

#[test]
fn a_rate_at_the_rail_is_out_of_range_only_on_a_healthy_link() {
    let (part, mut gyro) = initialised();
    part.borrow_mut().set(0x08, 0xFF_FFFF);
    let out_of_range = OutOfRange { register: Address::RateData, code: 0xFF_FFFF, width: Width::Bits24, status: None };
    assert_eq!(gyro.read_rate(), Err(ReadError::OutOfRange(out_of_range)));
    part.borrow_mut().line = Line::High;
    assert!(matches!(gyro.read_rate(), Err(ReadError::Fault(Fault::StuckHigh(_)))));
    part.borrow_mut().line = Line::Low;
    assert!(matches!(gyro.read_temp(), Err(ReadError::Fault(Fault::StuckLow(_)))));
    assert!(matches!(gyro.adc_status(), Err(ReadError::Fault(Fault::StuckLow(_)))));
}

#[test]
fn a_status_of_zero_is_true_on_a_healthy_link() {
    let (_part, mut gyro) = initialised();
    assert_eq!(gyro.rate_status().unwrap().bits(), 0x00);
    assert_eq!(gyro.adc_status().unwrap().bits(), 0x00);
}

#[test]
fn a_status_of_another_channel_is_a_fault() {
    let (part, mut gyro) = initialised();
    part.borrow_mut().line = Line::Flip(0x20, 0x40);
    let seen = Mismatch { register: Address::RateStatus, expected: 0x00, got: 0x40 };
    assert_eq!(gyro.rate_status(), Err(ReadError::Fault(Fault::Unexpected(seen))));
}

#[test]
fn a_bus_error_names_the_register() {
    let (part, mut gyro) = initialised();
    gyro.read_temp().unwrap_err(); // there is no temperature, so the driver also reads MODE and TEMP STATUS
    part.borrow_mut().fails_after = Some(7);
    let error = BusError::Transfer { register: Address::TempData, error: ErrorKind::Other };
    assert_eq!(gyro.read_temp(), Err(ReadError::Bus(error)));
    let interrupted = gyro.diagnose().unwrap_err().to_string();
    assert!(interrupted.contains("TEMPDATA (0Ah)") && interrupted.contains("reset and initialise"), "{interrupted}");
    assert_eq!(gyro.reset(), Err(BusError::Transfer { register: Address::Com, error: ErrorKind::Other }));
    let text = error.to_string();
    assert!(text.contains("TEMPDATA (0Ah)") && text.contains("Other") && text.contains("then reset"), "{text}");
}

#[test]
fn every_message_says_what_to_do() {
    let (part, mut gyro) = initialised();
    part.borrow_mut().line = Line::Low;
    let stuck = gyro.verify().unwrap_err().to_string();
    assert!(stuck.contains("stuck at zeros") && stuck.contains("check the SDO wire"), "{stuck}");
    part.borrow_mut().line = Line::Good;
    part.borrow_mut().reset(); // a brown-out
    let lost = gyro.diagnose().unwrap().unwrap().to_string();
    assert!(lost.contains("MODE (38h) reads 00h instead of 22h") && lost.contains("initialise again"), "{lost}");
    part.borrow_mut().set(0x08, 0x00_0000);
    part.borrow_mut().set(0x38, 0x22);
    let range = gyro.read_rate().unwrap_err().to_string();
    assert!(range.contains("RATEDATA (08h) reads 000000h"), "{range}");
}
