//! Damaged words of the command line and of files: addresses, keys, durations, units, sizes.

use super::edited;
use adis16130_twin::Spec;
use zerorate_allan::Taus;
use zerorate_host::DeviceSpec;
use zerorate_input::limits::Bytes;
use zerorate_logs::Unit;
use zerorate_view::duration::Seconds;

fn words(words: &[&str]) -> Vec<Vec<u8>> {
    words.iter().map(|word| word.as_bytes().to_vec()).collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn devices() {
    let devices = words(&[
        "twin:seed=7,bias_dps=0.8,profile=ramp",
        "replay:unit.arrows",
        "spi:/dev/spidev1.2?rdy=gpiochip4:25&hz=8000000&framing=byte&mclk=105400",
        "iio:iio:device0?hz=50",
        "bridge:/dev/ttyUSB0?hz=8000000&baud=2000000",
        "tcp:[::1]:16130?mclk=105000",
    ]);
    edited(3000, &devices, |bytes| {
        let word = text(bytes);
        if let Ok(device) = word.parse::<DeviceSpec>() {
            assert_eq!(device.to_string(), word);
        }
    });
}

#[test]
fn twin_keys() {
    let keys = words(&["seed=7,bias_dps=0.8,curvature=-0.001", "fault=sdo_low,fault_at_s=60", "noise=0,roa=10nf"]);
    edited(3000, &keys, |bytes| {
        let _ = Spec::parse_keys(&text(bytes));
    });
}

#[test]
fn durations() {
    edited(3000, &words(&["1h30m", "250ms", "1.5h", "90", "1e3"]), |bytes| {
        if let Ok(Seconds(seconds)) = text(bytes).parse::<Seconds>() {
            assert!((0.0..4e8).contains(&seconds));
            let shown = Seconds(seconds).to_string();
            assert!(shown.parse::<Seconds>().is_ok(), "{shown}");
        }
    });
}

#[test]
fn numbers_with_units() {
    edited(3000, &words(&["rad/s", "deg/h", "512M", "2 GiB", "octave", "log:20", "0.1,1,10"]), |bytes| {
        let word = text(bytes);
        let _ = word.parse::<Unit>();
        let _ = word.parse::<Bytes>();
        let _ = word.parse::<Taus>();
        let _ = Unit::of_column(&word);
    });
}
