//! Bags: what robots read of them is right, and the capture in them is whole.

use super::*;
use crate::mcap_messages::Messages;
use crate::tests::{info, open};
use crate::{CaptureInfo, CaptureWriter, Format, Layout, Row, Stamps};
use std::path::Path;
use std::sync::{Arc, Mutex};
use zerorate::{Axis, Calibration, Part, Scale};

/// The bytes that were written into memory.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl io::Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("no panic").extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// 1 °/s at 26 °C (F-40, F-41); the 20th cannot be, for no part of 300 Hz does that.
fn rows(n: u32) -> impl Iterator<Item = Row> {
    (0..n).map(|k| {
        let code = if k == 20 { 8_388_608 + (1 << 22) } else { 8_388_608 + 23_488 + i64::from(k % 3) };
        let row = Row::new(1_000_000 + u64::from(k) * 175_667, k * 2, &[code]).expect("one axis");
        row.with_temp_code((k % 4 == 0).then_some(8_388_608 + 14_093))
    })
}

const CALIBRATION: &str = "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\n\
    t3_c = 25.0\n";

fn calibration(text: &str) -> Option<Calibration> {
    Some(Calibration::parse(text).expect("a calibration").0)
}

fn write(log: RobotLog, info: &CaptureInfo, rows: impl Iterator<Item = Row>) -> Vec<u8> {
    let memory = Memory::default();
    let out = Box::new(memory.clone());
    let mut writer = CaptureWriter::create_robot_log(Path::new("x.mcap"), out, info, log).expect("a bag");
    rows.for_each(|row| writer.push(&row).expect("a row"));
    writer.finish().expect("an end");
    memory.0.lock().expect("no panic").clone()
}

fn log(calibration: Option<Calibration>, stamps: Stamps) -> RobotLog {
    RobotLog { part: info().part(), calibration, stamps }
}

/// Stamp and numbers of the messages of a topic.
fn messages(bag: &[u8], topic: &str) -> Vec<(u64, Vec<f64>)> {
    let messages = Messages::new(bag, crate::limits::Room::of(bag.len() as u64)).map(|it| it.expect("a message"));
    let numbers = |message: mcap::Message<'static>| {
        let mut fields = cdr::Fields::of(&message.data).expect("CDR");
        let (sec, nanosec) = (fields.number().expect("a stamp"), fields.number().expect("a stamp"));
        let stamp_ns = u64::from(u32::from_le_bytes(sec)) * 1_000_000_000 + u64::from(u32::from_le_bytes(nanosec));
        assert_eq!((fields.text(), message.log_time), (Some("imu_link"), stamp_ns));
        let numbers: Vec<f64> = std::iter::from_fn(|| fields.number().map(f64::from_le_bytes)).collect();
        assert!(fields.is_at_end());
        (stamp_ns, numbers)
    };
    messages.filter(|message| message.channel.topic == topic).map(numbers).collect()
}

#[test]
fn rates_are_in_rad_per_s_on_the_axis_of_the_part() {
    let bag = write(log(None, Stamps::OfPart), &info(), rows(40));
    let found = messages(&bag, MEASURED);
    assert_eq!(found.len(), 39, "one is not to be believed");
    let (stamp_ns, numbers) = &found[1];
    assert_eq!((*stamp_ns, numbers.len()), (1_175_667, 37));
    assert_eq!(numbers[..5], [0.0, 0.0, 0.0, 1.0, -1.0], "no orientation");
    assert_eq!(numbers[13..16], [0.0, 0.0, (1.0 + 1.0 / 23_488.0f64).to_radians()]);
    assert_eq!(numbers[16..25], [0.0; 9], "nobody knows the bias");
    assert_eq!(numbers[25..29], [0.0, 0.0, 0.0, -1.0], "no acceleration");
    let temperatures = messages(&bag, TEMPERATURE);
    // M-05
    assert_eq!((temperatures.len(), &temperatures[0]), (10, &(1_000_000, vec![26.0, 0.05 * 0.05])));
    assert!(messages(&bag, CORRECTED).is_empty());
}

#[test]
fn corrected_rates_carry_their_calibration_and_what_is_known_of_them() {
    let uncertain = "[uncertainty]\ncoverage = 0.95\ncoverage_factor = 2.0\nu_pbc_dps = 0.003\n\
        u_btc_dps_per_c = 0.004\nu_t3_c = 0.0\ncov_pbc_btc_dps2_per_c = 0.0\ncov_pbc_t3_dps_c = 0.0\n\
        cov_btc_t3_dps = 0.0\nu_curvature_dps_per_c = 0.0\nu_b1_dps = 0.0\nu_t1_c = 0.0\nu_b2_dps = 0.0\n\
        u_t2_c = 0.0\n[noise]\nwhite_dps_per_rt_hz = 0.0125\nwhite_source = \"measured\"\n\
        flicker_floor_dps = 0.0\nflicker_cutoff_hz = 1.0\nflicker_source = \"measured\"\n\
        rate_random_walk_dps_per_rt_s = 0.0\nrate_random_walk_source = \"measured\"\n";
    let full = calibration(&format!("{CALIBRATION}{uncertain}"));
    let id = full.as_ref().map(Calibration::id);
    let bag = write(log(full, Stamps::From(1_700_000_000_000_000_000)), &info(), rows(40));
    let (stamp_ns, numbers) = &messages(&bag, CORRECTED)[0];
    assert_eq!(*stamp_ns, 1_700_000_000_000_000_000, "the first sample");
    let expected = (1.0 - 0.25 - 0.04f64).to_radians();
    assert!((numbers[15] - expected).abs() < 1e-12, "{}", numbers[15]);
    // 1 °C from T3; 0.0125 °/s/√Hz through π/2 · 50 Hz, which the capture states
    let sd_dps2 = 0.003f64.powi(2) + 0.004f64.powi(2) + 0.0125f64.powi(2) * std::f64::consts::FRAC_PI_2 * 50.0;
    let variance = sd_dps2 * (std::f64::consts::PI / 180.0).powi(2);
    assert!((numbers[24] / variance - 1.0).abs() < 1e-12, "{} {variance}", numbers[24]);
    assert_eq!((numbers[16], numbers[20], numbers[17]), (1e6, 1e6, 0.0), "axes that the part does not have");
    assert!(messages(&bag, MEASURED).is_empty(), "no bias is removed twice");
    let mut all = Messages::new(&bag[..], crate::limits::Room::of(1 << 20)).map(|message| message.expect("one"));
    let channel = all.find(|message| message.channel.topic == CORRECTED).expect("one").channel;
    assert_eq!(channel.metadata.get("zerorate.calibration_id"), id.as_ref());
    let plain = write(log(calibration(CALIBRATION), Stamps::OfPart), &info(), rows(40));
    assert_eq!(messages(&plain, CORRECTED)[0].1[16..25], [0.0; 9], "a calibration without uncertainties");
}

/// Raw codes come from the part, with and without a correction.
#[test]
fn the_rows_are_those_of_a_capture() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("x.mcap");
    std::fs::write(&path, write(log(calibration(CALIBRATION), Stamps::From(7)), &info(), rows(20_000)))
        .expect("written");
    let reader = open(&path).expect("a capture");
    assert_eq!(reader.calibration_id(), None, "its rows are raw");
    assert_eq!(CaptureInfo { schema: 2, ..info() }, *reader.info());
    let found: Vec<Row> = reader.map(|row| row.expect("a row")).collect();
    assert!(found.iter().copied().eq(rows(20_000)));
}

#[test]
fn stamps_are_the_time_of_day_where_there_is_one() {
    let now = Stamps::Now(Box::new(|| 1_800_000_000_000_000_000));
    let bag = write(log(None, now), &info(), rows(40));
    let stamps: Vec<u64> = messages(&bag, MEASURED).iter().map(|(stamp_ns, _)| *stamp_ns).collect();
    assert_eq!(stamps.last(), Some(&1_800_000_000_000_000_000), "the last row is of now");
    assert!(stamps.windows(2).all(|pair| pair[1] > pair[0]));
}

#[test]
fn a_part_with_several_axes_is_one_message() {
    let named = |name: &str| {
        let axis = Part::ADIS16130.axes[0].clone();
        zerorate::NamedAxis { name: name.to_owned().into(), ..axis }
    };
    let part =
        |names: [&str; 2]| Part { name: "two".into(), axes: names.map(named).to_vec().into(), ..Part::ADIS16130 };
    let two = part(["gyro_y", "gyro_x"]);
    let info = CaptureInfo::new(Layout::of_part(&two).expect("a layout"));
    let row = |k: u32| Row::new(u64::from(k) * 1_000_000, k, &[8_388_608, 8_388_608 + 23_488 + i64::from(k)]);
    let both = RobotLog { part: two, calibration: None, stamps: Stamps::OfPart };
    let bag = write(both, &info, (0..9).filter_map(row));
    let (_, numbers) = &messages(&bag, MEASURED)[0];
    assert_eq!(numbers[13..16], [1f64.to_radians(), 0.0, 0.0], "x is the second axis of the part");
    let others = part(["left", "right"]);
    let info = CaptureInfo::new(Layout::of_part(&others).expect("a layout"));
    let log = RobotLog { part: others, calibration: None, stamps: Stamps::OfPart };
    let refused = CaptureWriter::create_robot_log(Path::new("x.mcap"), Box::new(io::sink()), &info, log);
    assert!(refused.err().expect("no directions").to_string().contains("x, y and z"));
}

/// Signed codes of any name come back as they were.
#[test]
fn samples_keep_their_sign_and_names_become_those_of_ros() {
    let scale = Scale { width_bits: 16, signed: true, zero_code: 0, ..Axis::ADIS16130.rate };
    let axis = Axis { rate: scale, temp: scale, ..Axis::ADIS16130 };
    let named =
        |name: &'static str| zerorate::NamedAxis { name: name.into(), axis, ..Part::ADIS16130.axes[0].clone() };
    let part = Part {
        name: "p".into(),
        axes: vec![named("2G-x"), named("2g.X")].into(),
        temp_column: None,
        operating_c: None,
    };
    let layout = Layout::of_part(&part).expect("a layout");
    let text = messages::sample(&layout).text;
    assert!(text.contains("int32 axis_2g_x_code\nint32 axis1_code\n"), "{text}");
    let row = Row::new(u64::MAX, u32::MAX, &[-32_768, -1]).expect("two").with_temp_code(Some(-5)).with_status(Some(9));
    let message = messages::encode(&row);
    assert_eq!(messages::decode(&layout, message.bytes()), Some(row));
    let cut = &message.bytes()[..message.bytes().len() - 1];
    assert_eq!(messages::decode(&layout, cut), None);
    assert_eq!(messages::decode(&layout, &[message.bytes(), &[0]].concat()), None);
}

/// Rows, what robots read, and the index behind each chunk.
#[test]
fn a_change_anywhere_is_found() {
    let whole = write(log(None, Stamps::OfPart), &info(), rows(12_000));
    for part in 1..40 {
        let mut bag = whole.clone();
        bag[whole.len() * part / 40] ^= 1;
        let reader = crate::CaptureReader::open(Path::new("x.mcap"), bag.into());
        let is_damaged = reader.map_or(true, |mut reader| reader.any(|row| row.is_err()));
        assert!(is_damaged, "{part} of 40");
    }
}

#[test]
fn a_bag_of_somebody_else_is_no_capture() {
    let bag = write(log(None, Stamps::OfPart), &info(), rows(9));
    assert!(is_capture(&mut io::Cursor::new(&bag)).expect("memory"));
    for length in 0..60 {
        let cut = bag[..length].to_vec();
        let _ = is_capture(&mut io::Cursor::new(cut)).expect("memory");
    }
    let place = bag.windows(8).position(|bytes| bytes == b"zerorate").expect("its head");
    let mut other = bag;
    other[place] = b'Z';
    assert!(!is_capture(&mut io::Cursor::new(&other)).expect("memory"));
    assert_eq!(Format::choose(None, Path::new("a.mcap")).ok(), Some(Format::Mcap));
}
