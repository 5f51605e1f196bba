//! The protocol without a socket: requests of libiio get the expected answers, and any other requests do no harm.

#[path = "../../../zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../zerorate-record/src/fuzz/harness.rs"]
#[expect(clippy::print_stderr, reason = "the words of a test that fails")]
mod harness;

use super::device::Device;
use super::session::{Session, Step};
use super::xml::describe;
use crate::{Batch, DeviceSpec, Setup, Stop, WatchedBatch};
use harness::edited;
use std::sync::Arc;
use zerorate::Calibration;
use zerorate::calibration::OtherPart;
use zerorate_record::Row;

const CALIBRATION: &str = "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\n\
    t3_c = 25.0\n";

fn device(address: &str, calibration: Option<&str>) -> Result<Device, OtherPart> {
    let spec: DeviceSpec = address.parse().expect("a device");
    let facts = spec.open(&Setup::default(), &Stop::default()).expect("a twin").facts();
    let calibration = calibration.map(|text| Calibration::parse(text).expect("a calibration").0);
    Device::new(&facts, calibration.as_ref())
}

/// A device with ten readings of about 1 °/s at 26 °C (F-40, F-41), and one sample lost.
fn calibrated() -> Device {
    let device = device("twin:", Some(CALIBRATION)).expect("of this part");
    let row = |k: u32| {
        let row = Row::new(u64::from(k) * 1_000_000, k, &[8_388_608 + 23_488 + i64::from(k % 2)]).expect("one axis");
        row.with_temp_code(Some(8_388_608 + 14_093)).with_lost(u32::from(k == 5))
    };
    device.take(&watched((0..10).map(row)));
    device
}

fn watched(rows: impl Iterator<Item = Row>) -> WatchedBatch {
    WatchedBatch { batch: Arc::new(Batch { rows: rows.collect(), ..Batch::default() }), missed: 0, lost: 0 }
}

fn reply(session: &mut Session<'_>, line: &str) -> String {
    match session.line(line.as_bytes()) {
        Step::Reply(reply) | Step::HangUp(reply) => String::from_utf8_lossy(&reply).into_owned(),
        other => format!("{other:?}"),
    }
}

/// Returns the value in a reply, after checking the stated length.
fn value(session: &mut Session<'_>, line: &str) -> String {
    let reply = reply(session, line);
    let (length, value) = reply.split_once('\n').expect("a length");
    let value = value.strip_suffix('\n').unwrap_or_else(|| panic!("{line}: {reply}"));
    assert_eq!(length.parse(), Ok(value.len()), "{line}");
    value.to_owned()
}

fn write(session: &mut Session<'_>, line: &str, value: &str) -> String {
    let Step::Take(bytes) = session.line(line.as_bytes()) else { panic!("{line} asks for a value") };
    assert_eq!(bytes, value.len(), "{line}");
    String::from_utf8(session.written(value.as_bytes())).expect("a number")
}

#[test]
fn values_are_in_the_units_of_the_kernel() {
    let device = calibrated();
    let mut session = Session::new(&device);
    let mut read = |what: &str| value(&mut session, &format!("READ iio:device0 {what}")).parse::<f64>();
    let mut number = |what: &str| read(what).unwrap_or_else(|error| panic!("{what}: {error}"));
    let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} not {expected}");
    let [raw, scale, offset] = ["raw", "scale", "offset"].map(|what| number(&format!("INPUT anglvel_z {what}")));
    near((raw + offset) * scale, (1.0f64 + 1.0 / 23_488.0).to_radians());
    let [raw, scale, offset] = ["raw", "scale", "offset"].map(|what| number(&format!("INPUT temp0 {what}")));
    near((raw + offset) * scale, 26_000.0); // 0.001 °C
    // −0.25 − 0.04 · (26 − 25)
    near(number("INPUT anglvel_z calibbias"), (-0.29f64).to_radians());
    let corrected = number("INPUT anglvel_z_corrected raw") * number("INPUT anglvel_z_corrected scale");
    assert!((corrected - (0.71f64 + 1.0 / 23_488.0).to_radians()).abs() < 1e-9, "{corrected}");
    near(number("sampling_frequency"), 10.0 / 0.009); // nine readings and the lost one in 9 ms
    assert_eq!([number("samples_lost"), number("INPUT count0 raw"), number("BUFFER samples_lost")], [1.0, 1.0, 0.0]);
    let id = Calibration::parse(CALIBRATION).expect("a calibration").0.id();
    assert_eq!(value(&mut session, "READ iio:device0 calibration"), id);
    assert_eq!(value(&mut session, "READ adis16130 INPUT samples_lost raw"), "1", "by its name as well");
}

/// The server is a watcher. The samples that did not fit into its queue were read, so they do not count as lost.
#[test]
fn samples_that_the_server_missed_are_not_lost() {
    let device = calibrated();
    let last = Row::new(20_000_000, 20, &[8_388_608]).expect("one axis");
    device.take(&WatchedBatch { missed: 8, lost: 2, ..watched([last].into_iter()) });
    let mut session = Session::new(&device);
    assert_eq!(value(&mut session, "READ iio:device0 samples_lost"), "3", "one in a row, two before what was missed");
    // in 20 ms after the first row: 9 rows, 1 lost and 8 missed samples, 2 lost among the missed, and the last row
    let hz: f64 = value(&mut session, "READ iio:device0 sampling_frequency").parse().expect("a number");
    assert!((hz / (21.0 / 0.020) - 1.0).abs() < 1e-12, "{hz}");
}

/// Only some samples have a temperature. A buffer that is opened after such a sample has corrected rates at once,
/// because it begins with the last known temperature.
#[test]
fn a_buffer_begins_with_the_temperature_that_is_known() {
    let device = device("twin:", Some(CALIBRATION)).expect("of this part");
    let row = |k: u32| Row::new(u64::from(k) * 175_667, k, &[8_388_608 + i64::from(k % 2)]).expect("one axis");
    let warm = row(0).with_temp_code(Some(8_388_608 + 14_093));
    device.take(&watched([warm].into_iter().chain((1..10).map(row))));
    let mut scanner = device.scanner();
    let scans: Vec<_> = (10..20).filter_map(|k| scanner.push(&row(k), 0, &device.trims_dps())).collect();
    assert_eq!(scans.len(), 8, "two wait to be judged");
    for (scan, k) in scans.iter().zip(0..) {
        // −0.25 − 0.04 · (26 − 25)
        let found = scan.corrected_dps[0].unwrap_or_else(|| panic!("no rate of sample {k}"));
        assert!((found - (f64::from(k % 2) / 23_488.0 - 0.29)).abs() < 1e-12, "{k}: {found}");
        assert_eq!(scan.row.temp_code, Some(8_388_608 + 14_093));
    }
}

#[test]
fn all_attributes_at_once_are_framed_as_the_library_reads_them() {
    let device = calibrated();
    let Step::Reply(reply) = Session::new(&device).line(b"READ iio:device0 INPUT count0") else { panic!("a reply") };
    assert_eq!(reply, b"8\n\0\0\0\x021\0\0\0\n");
    let fresh = self::device("twin:", None).expect("a device");
    let Step::Reply(reply) = Session::new(&fresh).line(b"READ iio:device0 INPUT count0") else { panic!("a reply") };
    assert_eq!(reply, b"4\n\xff\xff\xff\xf5\n", "-EAGAIN in place of a length");
}

#[test]
fn writing_needs_permission() {
    let device = calibrated();
    let mut session = Session::new(&device);
    let bias = "WRITE iio:device0 INPUT anglvel_z calibbias 4";
    assert_eq!(write(&mut session, bias, "0.01"), "-13\n");
    assert_eq!(write(&mut session, "WRITE iio:device0 INPUT anglvel_z nothing 1", "1"), "-2\n");
    assert_eq!(write(&mut session, "WRITE other INPUT anglvel_z calibbias 1", "1"), "-2\n");
    assert!(matches!(session.line(b"WRITE iio:device0 x 4097"), Step::HangUp(_)), "it would have to be taken in");
    let device = calibrated().writable();
    let mut session = Session::new(&device);
    for (line, value, expected) in [
        ("WRITE iio:device0 INPUT anglvel_z raw 1", "1", "-13\n"),
        ("WRITE iio:device0 sampling_frequency 3", "100", "-13\n"),
        (bias, "none", "-22\n"),
        ("WRITE iio:device0 INPUT anglvel_z calibbias 3", "NaN", "-22\n"),
        ("WRITE iio:device0 INPUT anglvel_z calibbias 3", "1e9", "-22\n"),
        ("WRITE iio:device0 INPUT anglvel_z calibbias 5", "0.01\0", "5\n"),
    ] {
        assert_eq!(write(&mut session, line, value), expected, "{line} {value:?}");
    }
    let bias: f64 = value(&mut session, "READ iio:device0 INPUT anglvel_z calibbias").parse().expect("a number");
    assert!((bias - 0.01).abs() < 1e-15, "{bias}");
    assert!(value(&mut session, "READ iio:device0 calibration").ends_with(" shifted"));
    let mut scanner = device.scanner();
    let row = Row::new(1, 1, &[8_388_608]).expect("one axis").with_temp_code(Some(8_388_608 + 14_093));
    let scans: Vec<_> = (0..9).filter_map(|_| scanner.push(&row, 0, &device.trims_dps())).collect();
    assert!((scans[0].corrected_dps[0].expect("a rate") - 0.01f64.to_degrees()).abs() < 1e-12);
    assert_eq!(scans[0].row.codes(), [8_388_608], "codes are as they were");
}

#[test]
fn buffers_open_once_and_give_whole_samples() {
    let device = calibrated();
    let mut session = Session::new(&device);
    assert_eq!(reply(&mut session, "READBUF iio:device0 64"), "-9\n");
    assert_eq!(reply(&mut session, "CLOSE iio:device0"), "-6\n");
    for (line, expected) in [
        ("OPEN iio:device0 256 00000000", "-22\n"),
        ("OPEN iio:device0 256 00000020", "-22\n"),
        ("OPEN iio:device0 0 00000001", "-22\n"),
        ("OPEN iio:device0 99999999 00000001", "-12\n"),
        ("OPEN iio:device1 256 00000001", "-19\n"),
    ] {
        assert_eq!(reply(&mut session, line), expected, "{line}");
    }
    assert!(matches!(session.line(b"OPEN iio:device0 256 0000001f"), Step::Open(open) if open.mask == 0x1f));
    assert_eq!(reply(&mut session, "OPEN iio:device0 256 0000001f"), "-16\n");
    assert!(matches!(session.line(b"READBUF iio:device0 100"), Step::Fill(96)), "32 bytes each");
    assert_eq!(reply(&mut session, "READBUF iio:device0 31"), "0\n");
    assert!(matches!(session.line(b"CLOSE iio:device0"), Step::Close));
    assert_eq!(reply(&mut session, "READBUF iio:device0 64"), "-9\n");
    device.note_gone();
    assert_eq!(reply(&mut session, "OPEN iio:device0 256 0000001f"), "-19\n");
    assert_eq!(reply(&mut session, "READ iio:device0 INPUT anglvel_z raw"), "-19\n");
}

#[test]
fn the_other_requests_are_answered() {
    let device = device("twin:", None).expect("a device");
    let mut session = Session::new(&device);
    for (line, expected) in [
        ("VERSION\r\n", "0.24.v0.24  \n"),
        ("TIMEOUT 100", "0\n"),
        ("GETTRIG iio:device0", "-2\n"),
        ("GETTRIG trigger0", "-19\n"),
        ("SETTRIG iio:device0", "0\n"),
        ("SETTRIG iio:device0 trigger0", "-2\n"),
        ("SET iio:device0 BUFFERS_COUNT 4", "0\n"),
        ("READ iio:device0 INPUT anglvel_z raw", "-11\n"),
        ("READ iio:device0 INPUT anglvel_z calibbias", "-2\n"),
        ("READ iio:device0 OUTPUT anglvel_z raw", "-2\n"),
        ("READ iio:device0 INPUT voltage0 raw", "-2\n"),
        ("READ iio:device0 DEBUG direct_reg_access", "-2\n"),
        ("READ nothing raw", "-19\n"),
        ("ZPRINT", "-22\n"),
        ("EXIT", ""),
    ] {
        assert_eq!(reply(&mut session, line), expected, "{line}");
    }
    assert_eq!(session.patience, Some(std::time::Duration::from_millis(100)));
    assert!(value(&mut session, "PRINT").starts_with("<?xml"));
    assert_eq!(value(&mut session, "READ iio:device0 calibration"), "none");
}

#[test]
fn a_part_with_several_axes_has_a_channel_for_each() {
    let xml = describe(&device("twin:axes=3", None).expect("a device"));
    for id in ["anglvel_x", "anglvel_y", "anglvel_z", "temp0", "count0", "timestamp"] {
        assert!(xml.contains(&format!("<channel id=\"{id}\"")), "{id}: {xml}");
    }
    assert!(!xml.contains("corrected") && !xml.contains("calibbias"), "nothing is corrected: {xml}");
    let error = device("twin:axes=3", Some(CALIBRATION)).expect_err("of another part");
    assert!(matches!(error, OtherPart::Part { .. }), "{error}");
}

#[test]
fn a_name_cannot_break_the_description() {
    let mut device = device("twin:", None).expect("a device");
    device.context.push(("hw_serial", "<\"&'>\u{1}\n\u{fffe}".to_owned()));
    let xml = describe(&device);
    assert!(xml.contains("value=\"&lt;&quot;&amp;&apos;&gt;???\""), "{xml}");
    assert!(!xml.contains('\n'), "one line");
}

/// The answer to any line is a number, a value with its length, a text, nothing, or the end of the connection.
#[test]
fn nonsense_is_answered() {
    let device = calibrated().writable();
    let seeds: Vec<Vec<u8>> = [
        "PRINT",
        "TIMEOUT 2500",
        "READ iio:device0 INPUT anglvel_z raw",
        "READ iio:device0 BUFFER samples_lost",
        "WRITE iio:device0 INPUT anglvel_z calibbias 12",
        "OPEN iio:device0 256 0000001f",
        "READBUF iio:device0 4096",
        "CLOSE iio:device0",
        "GETTRIG iio:device0",
        "SET iio:device0 BUFFERS_COUNT 4",
        "EXIT",
        "\r\n",
    ]
    .map(|line| line.as_bytes().to_vec())
    .into();
    edited(20_000, &seeds, |bytes| {
        let mut session = Session::new(&device);
        for line in bytes.split(|byte| *byte == b'\n') {
            match session.line(line) {
                Step::Reply(reply) => {
                    let end = reply.iter().position(|byte| *byte == b'\n').expect("a line");
                    let number = std::str::from_utf8(&reply[..end]).expect("text");
                    let is_text = reply.starts_with(b"Commands") || reply.starts_with(b"0.24");
                    let number =
                        number.parse::<i64>().unwrap_or_else(|_| if is_text { 0 } else { panic!("{number}") });
                    assert!(number <= 0 || reply.len() == end + 2 + number as usize, "{reply:?}");
                }
                Step::Take(bytes) => {
                    let taken = session.written(&vec![b'7'; bytes]);
                    assert!(taken.ends_with(b"\n"), "{taken:?}");
                }
                Step::Nothing | Step::Open(_) | Step::Fill(_) | Step::Close | Step::HangUp(_) => {}
            }
        }
    });
}
