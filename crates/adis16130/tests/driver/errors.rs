//! The error of each operation converts to [`Error`].

use adis16130::blocking::Adis16130;
use adis16130::registers::Address;
use adis16130::{
    BusError, Config, Edge, Error, Fault, InitError, MCLK_HZ, Mismatch, RateCode, ReadError, SampleError, Sampler,
    SamplerConfig, SelfTestError, SelfTestPlan, VerifyError, WaitBound, WaitError,
};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, SpiDevice};

use crate::part::{Delay, Line, Part, Pin, Wire};

type Any<SPI, RDY, PIN> =
    Error<<SPI as spi::ErrorType>::Error, <RDY as digital::ErrorType>::Error, <PIN as digital::ErrorType>::Error>;

/// Calls one operation for each type of error. `?` converts them all to [`Error`].
fn all<SPI: SpiDevice, RDY: InputPin, PIN: OutputPin>(
    gyro: &mut Adis16130<SPI, RDY>,
    pin: &mut PIN,
    delay: &mut impl DelayNs,
) -> Result<RateCode, Any<SPI, RDY, PIN>> {
    gyro.restart()?;
    gyro.verify()?;
    gyro.diagnose()?.map_or(Ok(()), Err)?;
    gyro.wait_ready(delay, WaitBound::from_us(100))?;
    gyro.self_test(pin, delay, SelfTestPlan::new(16))?;
    let mut sampler = Sampler::new(SamplerConfig::new(), gyro.config(), MCLK_HZ);
    gyro.sample(&mut sampler, Edge { t_ns: 0, seq: 0 })?;
    Ok(gyro.read_in_range()?.0)
}

fn outcome(
    line: Line,
    looks: u32,
    refuses: Option<bool>,
) -> Result<RateCode, Error<spi::ErrorKind, digital::ErrorKind, digital::ErrorKind>> {
    let (part, rdy, mut pin) = (Part::new(), Pin::default(), Pin::default());
    rdy.0.borrow_mut().looks_until_low = looks;
    pin.0.borrow_mut().refuses = refuses;
    part.borrow_mut().line = line;
    part.borrow_mut().set(0x0A, 0x81_0000);
    part.borrow_mut().rates = (0..40).map(|_| 0x81_0000).collect();
    all(&mut Adis16130::new(Wire(part), rdy, Config::default()), &mut pin, &mut Delay::default())
}

#[test]
fn the_error_of_each_operation_converts_to_error() {
    // the mock takes the configuration but converts nothing, so no call of `all` can succeed
    assert!(matches!(outcome(Line::Low, 0, None), Err(Error::Init(_))));
    assert!(matches!(outcome(Line::Good, u32::MAX, None), Err(Error::Wait(WaitError::TimedOut { timeout_us: 100 }))));
    assert!(matches!(outcome(Line::Good, 0, Some(true)), Err(Error::SelfTest(_))));
    let text = outcome(Line::Good, u32::MAX, None).unwrap_err().to_string();
    assert!(text.contains("RDY (pin 10)"), "{text}");
    let lost = Fault::ConfigurationLost(Mismatch { register: Address::Mode, expected: 0x22, got: 0 });
    assert_eq!(Error::<(), (), ()>::from(lost).to_string(), lost.to_string());
    assert_eq!(
        Error::<()>::from(VerifyError::NotInitialised).to_string(),
        VerifyError::<()>::NotInitialised.to_string()
    );
    fn is_error<T: std::error::Error>() {}
    is_error::<Error<spi::ErrorKind, digital::ErrorKind, digital::ErrorKind>>();
}

#[test]
fn an_outer_error_has_the_text_of_the_inner_one() {
    let bus = || BusError::Transfer { register: Address::Mode, error: () };
    let around: [Error<(), (), ()>; 7] = [
        Error::Bus(bus()),
        Error::Init(InitError::Bus(bus())),
        Error::Verify(VerifyError::Bus(bus())),
        Error::Read(ReadError::Bus(bus())),
        Error::Sample(SampleError::Bus(bus())),
        Error::SelfTest(SelfTestError::Read(ReadError::Bus(bus()))),
        Error::Init(InitError::Verify(VerifyError::Bus(bus()))),
    ];
    assert!(around.iter().all(|error| error.to_string() == bus().to_string()), "{around:?}");
    let wait = || WaitError::Pin(());
    let around: [Error<(), (), ()>; 2] = [Error::Wait(wait()), Error::SelfTest(SelfTestError::Wait(wait()))];
    assert!(around.iter().all(|error| error.to_string() == wait().to_string()), "{around:?}");
    assert!(wait().to_string().contains("RDY pin cannot be read"));
    assert!(SelfTestError::<(), (), ()>::Pin(()).to_string().contains("self-test pin cannot be set"));
}

#[test]
fn each_fault_has_its_own_text() {
    let seen = Mismatch { register: Address::Mode, expected: 0x22, got: 0xFF };
    let stuck = Fault::StuckHigh(seen).to_string();
    assert!(stuck.contains("reads FFh instead of 22h") && stuck.contains("stuck at ones"), "{stuck}");
    let differs = VerifyError::<()>::Differs(Default::default()).to_string();
    let unexpected = Fault::Unexpected(seen).to_string();
    assert!(unexpected.contains("lower the SPI clock") && differs.contains("lower the SPI clock"), "{unexpected}");
}
