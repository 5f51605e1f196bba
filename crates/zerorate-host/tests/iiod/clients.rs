//! Independent clients: the programs and bindings of libiio. If they are not installed, the tests print a message and
//! pass, unless `ZERORATE_IIO_CLIENTS` is set. `cargo xtask iiod` installs them and sets this variable. It also
//! installs pyadi-iio in a Python environment, and sets `ZERORATE_ADI_PYTHON` to the path of its Python.

use super::served::{Raw, TestServer};
use std::io::ErrorKind;
use std::process::{Command, Output};

/// The Python for which Debian installs python3-libiio.
const PYTHON: &str = "/usr/bin/python3";

/// The output of a client; `None` if the client is not installed.
fn run(mut client: Command) -> Option<Output> {
    match client.output() {
        Ok(output) => Some(output),
        Err(error) if error.kind() == ErrorKind::NotFound => skipped(&format!("{client:?}: {error}")),
        Err(error) => panic!("{client:?}: {error}"),
    }
}

fn skipped<T>(why: &str) -> Option<T> {
    assert!(std::env::var_os("ZERORATE_IIO_CLIENTS").is_none(), "{why}");
    eprintln!("SKIPPED: {why} (apt install libiio-utils python3-libiio)");
    None
}

fn client(program: &str, served: &TestServer, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(["-u", &served.uri()]).args(arguments);
    command
}

/// The stdout of a client that must succeed and print nothing to stderr.
fn text(output: Output) -> String {
    let (out, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && errors.is_empty(), "{out}\n{errors}");
    out.into_owned()
}

fn number(text: &str, word: &str) -> f64 {
    let found = text.lines().find_map(|line| line.split_once(word)?.1.split_whitespace().next());
    let found = found.unwrap_or_else(|| panic!("no {word:?} in {text}"));
    found.trim_matches('\'').parse().unwrap_or_else(|_| panic!("{found:?} behind {word:?}"))
}

#[test]
fn iio_info_shows_every_attribute() {
    let served = TestServer::start();
    let Some(output) = run(client("iio_info", &served, &[])) else { return };
    let info = text(output);
    for line in [
        "iio:device0: adis16130 (buffer capable)",
        "5 channels found:",
        "anglvel_z:  (input, index: 0, format: le:u24/32>>0)",
        "temp0:  (input, index: 1, format: le:u24/32>>0)",
        "anglvel_z_corrected:  (input, index: 2, format: le:S64/64>>0)",
        "count0: samples_lost (input, index: 3, format: le:U64/64>>0)",
        "timestamp:  (input, index: 4, format: le:S64/64>>0)",
        "hw_model: ADIS16130",
        "zerorate,device: twin:seed=8",
        "No trigger on this device",
    ] {
        assert!(info.contains(line), "{line:?} is missing:\n{info}");
    }
    assert!(!info.contains("ERROR"), "{info}");
    // scale and offset by F-40, in rad/s
    assert_eq!(number(&info, "attr  0: raw value: ").fract(), 0.0);
    assert!((number(&info, "attr  1: scale value: ") / (1f64.to_radians() / 23_488.0) - 1.0).abs() < 1e-9, "{info}");
    assert_eq!(number(&info, "attr  2: offset value: "), -8_388_608.0);
    // the sample rate of F-31, Hz, with a tolerance for a clock that is off by 1 % (M-06)
    assert!((5_600.0..5_800.0).contains(&number(&info, "sampling_frequency value: ")), "{info}");
}

#[test]
fn iio_attr_reads_and_is_refused() {
    let served = TestServer::start();
    let read = |arguments: &[&str]| run(client("iio_attr", &served, arguments)).map(text);
    let Some(offset) = read(&["-c", "iio:device0", "temp0", "offset"]) else { return };
    // 25 °C is the zero code, 25 · 14093 codes above 0 °C (F-41)
    assert_eq!(offset.trim(), (14_093 * 25 - 8_388_608).to_string());
    let clock = read(&["-d", "iio:device0", "current_timestamp_clock"]).expect("it is there");
    assert_eq!(clock.trim(), "monotonic");
    let lost = read(&["-B", "iio:device0", "samples_lost"]).expect("it is there");
    assert_eq!(lost.trim(), "0");
    let write = client("iio_attr", &served, &["-c", "iio:device0", "anglvel_z", "calibbias", "0.01"]);
    let refused = run(write).expect("it is there");
    assert!(String::from_utf8_lossy(&refused.stdout).contains("Permission denied"), "{refused:?}");
}

#[test]
fn iio_attr_writes_where_that_is_allowed() {
    let served = TestServer::writable();
    let write = client("iio_attr", &served, &["-c", "iio:device0", "anglvel_z", "calibbias", "0.01"]);
    let Some(written) = run(write).map(text) else { return };
    // the client reads back the bias that it wrote; the bias has followed the temperature in the meantime
    let bias: f64 = written.trim().parse().expect("a number");
    assert!((bias - 0.01).abs() < 1e-3, "{bias}");
    assert!(Raw::connect(&served).value("READ iio:device0 calibration").ends_with(" shifted"));
}

#[test]
fn iio_readdev_gets_the_bytes_of_the_hub() {
    let served = TestServer::start();
    let samples = ["-b", "64", "-s", "100000", "iio:device0"];
    let Some(all) = run(client("iio_readdev", &served, &samples)) else { return };
    assert!(all.stderr.is_empty(), "{}", String::from_utf8_lossy(&all.stderr));
    served.check(&all.stdout, 100_000);
    let some = client("iio_readdev", &served, &["-b", "256", "-s", "1000", "iio:device0", "anglvel_z", "timestamp"]);
    let some = run(some).expect("it is there").stdout;
    assert_eq!(some.len(), 16_000, "code, four bytes of nothing, time");
    let codes = some.chunks(16).map(|sample| u32::from_le_bytes([sample[0], sample[1], sample[2], sample[3]]));
    // 10 °/s at most, in codes of F-40
    assert!(codes.into_iter().all(|code| code.abs_diff(8_388_608) < 234_880));
}

/// Opens a device, reads attributes, and writes the samples of a buffer to standard output.
const SCRIPT: &str = "
import sys, iio
context = iio.Context(sys.argv[1])
device = context.find_device('adis16130')
channel = device.find_channel('anglvel_z')
scale, offset = (float(channel.attrs[name].value) for name in ('scale', 'offset'))
assert abs(scale / 7.430727e-7 - 1) < 1e-6 and offset == -8388608, (scale, offset)
assert channel.type == iio.ChannelType.IIO_ANGL_VEL and channel.modifier == iio.ChannelModifier.IIO_MOD_Z
assert device.find_channel('samples_lost').type == iio.ChannelType.IIO_COUNT
assert device.buffer_attrs['samples_lost'].value == '0'
for each in device.channels:
    each.enabled = True
assert device.sample_size == 32, device.sample_size
buffer = iio.Buffer(device, 1000)
for _ in range(100):
    buffer.refill()
    # as the library takes a channel out of it
    codes = memoryview(channel.read(buffer)).cast('I')
    assert len(codes) == 1000 and all(abs(code + offset) * scale < 0.2 for code in codes)
    sys.stdout.buffer.write(buffer.read())
";

#[test]
fn python_gets_the_bytes_of_the_hub() {
    let served = TestServer::start();
    let mut python = Command::new(PYTHON);
    python.args(["-c", "import iio"]);
    match run(python) {
        Some(output) if output.status.success() => {}
        Some(_) => return skipped("python3-libiio is not installed").unwrap_or_default(),
        None => return,
    }
    let mut python = Command::new(PYTHON);
    python.args(["-c", SCRIPT, &served.uri()]);
    let output = run(python).expect("it is there");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    served.check(&output.stdout, 100_000);
}

/// Reads samples through the class of pyadi-iio on which its devices with a buffer are based.
const ADI_SCRIPT: &str = "
import sys
import numpy
from adi.context_manager import context_manager
from adi.rx_tx import rx

class Gyroscope(rx, context_manager):
    _rx_channel_names = ['anglvel_z', 'timestamp']
    _rx_data_type = [numpy.uint32, numpy.int64]
    _device_name = ''

    def __init__(self, uri):
        context_manager.__init__(self, uri, self._device_name)
        self._ctrl = self._rxadc = self._ctx.find_device('adis16130')
        rx.__init__(self)

gyroscope = Gyroscope(sys.argv[1])
assert gyroscope._get_iio_attr('anglvel_z', 'offset', False) == -8388608
assert abs(gyroscope._get_iio_attr('anglvel_z', 'scale', False) / 7.430727e-7 - 1) < 1e-6
gyroscope.rx_buffer_size = 1000
gyroscope.rx_enabled_channels = [0, 1]
for _ in range(100):
    codes, times = gyroscope.rx()
    samples = numpy.zeros(len(codes), dtype=[('code', '<u8'), ('t_ns', '<i8')])
    samples['code'], samples['t_ns'] = codes, times
    sys.stdout.buffer.write(samples.tobytes())
";

#[test]
fn pyadi_iio_gets_the_samples_of_the_hub() {
    let Some(python) = std::env::var_os("ZERORATE_ADI_PYTHON") else {
        eprintln!("SKIPPED: pyadi-iio (cargo xtask iiod installs it)");
        return;
    };
    let served = TestServer::start();
    let mut python = Command::new(python);
    python.args(["-c", ADI_SCRIPT, &served.uri()]);
    let output = run(python).expect("it is there");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.stdout.len(), 100_000 * 16);
    served.check_pairs(&output.stdout);
}
