//! A rate beyond the scale wraps with CLAMP = 0 (F-35). Calls that read the status report it, with any SPI clock.

use adis16130::blocking::Adis16130;
use adis16130::registers::Address;
use adis16130::{Config, Framing, OutOfRange, ReadError, SelfTestError, SelfTestPlan, Width};
use adis16130_twin::{Spec, Twin, TwinRdy, TwinSpi};
use std::convert::Infallible;

use crate::part::{Part, Pin, Wire};

type Reading = Result<(f32, f32), ReadError<Infallible>>;

struct Turning {
    twin: Twin,
    gyro: Adis16130<TwinSpi, TwinRdy>,
}

impl Turning {
    fn new(rate_dps: f64, sclk_hz: f64, config: Config) -> Self {
        let spec = Spec { rotation_dps: rate_dps, bias_dps: 0.0, sensitivity_error: 0.0, ..Spec::from_seed(3) };
        let twin = Twin::new(Spec { sclk_hz, ..spec });
        let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), config);
        gyro.restart().unwrap();
        Self { twin, gyro }
    }

    /// Takes readings at many phases of the conversions, once both channels have converted.
    fn readings(&mut self, count: usize) -> impl Iterator<Item = Reading> {
        self.twin.advance_ns(400_000);
        (0..count).map(move |n| {
            self.twin.advance_ns(7_000 * (n as u64 % 40));
            self.gyro.read_in_range().map(|(rate, temp)| (rate.to_dps(), temp.to_celsius()))
        })
    }
}

const SCLK_HZ: [f64; 4] = [10_000_000.0, 1_000_000.0, 300_000.0, 50_000.0];

fn buses() -> impl Iterator<Item = (Config, f64)> {
    let widths = [Width::Bits24, Width::Bits16].map(|width| Config::new().with_width(width));
    let configs = widths.map(|config| [config, config.with_framing(Framing::Command), config.with_clamp(true)]);
    configs.into_iter().flatten().flat_map(|config| SCLK_HZ.map(|sclk_hz| (config, sclk_hz)))
}

#[test]
fn a_wrapped_rate_is_out_of_range() {
    for (config, sclk_hz) in buses() {
        for rate_dps in [360.0, -360.0, 700.0] {
            for reading in Turning::new(rate_dps, sclk_hz, config).readings(60) {
                let error = reading.expect_err("the scale ends at 357.15 °/s");
                assert!(
                    matches!(error, ReadError::OutOfRange(seen) if seen.register == Address::RateData),
                    "{error} at {rate_dps} °/s, {sclk_hz} Hz"
                );
            }
        }
    }
}

#[test]
fn a_rate_that_leaves_the_scale_now_and_then_never_changes_its_sign() {
    for (config, sclk_hz) in buses() {
        for side in [1.0, -1.0] {
            let rate_dps = side * 357.0; // the noise of one reading is 0.25 °/s (F-02, F-03)
            let (mut inside, mut outside) = (0, 0);
            for reading in Turning::new(rate_dps, sclk_hz, config).readings(400) {
                match reading {
                    Ok((seen_dps, _)) => {
                        inside += 1;
                        assert!(
                            (f64::from(seen_dps) - rate_dps).abs() < 3.0,
                            "{seen_dps} °/s at {sclk_hz} Hz, {config:?}"
                        );
                    }
                    Err(ReadError::OutOfRange(_)) => outside += 1,
                    Err(error) => panic!("{error}"),
                }
            }
            assert!(outside > 20, "{outside} at {sclk_hz} Hz");
            assert!(inside > 20 || sclk_hz < 1e6, "{inside} at {sclk_hz} Hz");
        }
    }
}

#[test]
fn a_rate_in_range_is_read_at_any_speed_of_the_bus() {
    for (config, sclk_hz) in buses() {
        for rate_dps in [0.0, -2.0, 340.0, -340.0] {
            for reading in Turning::new(rate_dps, sclk_hz, config).readings(40) {
                let (seen_dps, temp_c) = reading.unwrap();
                assert!((f64::from(seen_dps) - rate_dps).abs() < 3.0, "{seen_dps} instead of {rate_dps} °/s");
                assert!((20.0..40.0).contains(&temp_c));
            }
        }
    }
}

#[test]
fn the_error_says_on_which_side() {
    for (status, side) in [(0x09, "above the range"), (0x0B, "below the range"), (0x01, "above"), (0x03, "below")] {
        let part = Part::new();
        let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), Config::default());
        gyro.init().unwrap();
        part.borrow_mut().set(0x08, 0x02_3456);
        part.borrow_mut().set(0x20, status);
        let error = gyro.read_rate_in_range().unwrap_err();
        let ReadError::OutOfRange(OutOfRange { code: 0x02_3456, status: Some(seen), .. }) = error else {
            panic!("{error}")
        };
        assert_eq!(u32::from(seen.bits()), status);
        let text = error.to_string();
        assert!(text.contains("RATEDATA (08h) reads 023456h") && text.contains(side), "{text}");
        assert_eq!(gyro.read_rate().unwrap().code(), 0x02_3456, "without its status nothing tells");
    }
}

#[test]
fn a_self_test_does_not_average_wrapped_codes() {
    let Turning { twin, mut gyro } = Turning::new(345.0, 1e6, Config::new()); // and 20 °/s by the self-test
    let plan = SelfTestPlan::new(64).with_settle_us(20_000);
    let result = gyro.self_test(&mut twin.self_test_pin(), &mut twin.delay(), plan);
    assert!(matches!(result, Err(SelfTestError::Read(ReadError::OutOfRange(_)))), "{result:?}");
}
