//! Tests captures of parts with several axes and signed codes.

use super::tests::{FORMATS, info, open, start, write};
use super::*;
use adis16130::{ChannelStatus, RateCode, Sample, TempCode, Width};
use std::fs;
use tempfile::TempDir;
use zerorate::{Axis, Part, Reading, Scan};
use zerorate_input::table::BatchSource;

/// The layout of an ADIS16405, with a status of this width.
fn layout(status_bits: u8) -> Result<Layout, LayoutError> {
    let layout = Layout::of_part(&part())?;
    Layout::new(layout.part_name().to_owned(), layout.axes().to_vec(), *layout.temp(), status_bits)
}

/// The description of a capture of an ADIS16405, with a status of 16 bits.
fn imu() -> CaptureInfo {
    CaptureInfo { device: "replay:log.csv".to_owned(), ..CaptureInfo::new(layout(16).unwrap()) }
}

fn rows(n: u32) -> Vec<Row> {
    let row = |i: u32| {
        let code = |seed: u32| i64::from((i.wrapping_mul(seed) >> 16) as i16);
        Row::new(10_000_000 * u64::from(i + 1), i, &[code(2_654_435_761), code(40_503_761), -32_768 + i64::from(i)])
            .unwrap()
            .with_status((i % 5 != 1).then_some(0x2400 + i))
            .with_temp_code((i % 3 != 2).then_some(i64::from(i % 40) - 20))
    };
    (0..n).map(row).collect()
}

pub fn bytes(format: Format, count: u32) -> Vec<u8> {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("capture");
    write(&path, format, &imu(), &rows(count));
    fs::read(&path).unwrap()
}

pub fn part() -> Part {
    Part::parse(
        r#"
        schema = 1
        name = "ADIS16405"
        axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
        rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, signed = true, range_dps = 300, bandwidth_hz = 330 }
        temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12, signed = true }
        "#,
    )
    .unwrap()
}

fn hash(rows: &[Row]) -> String {
    let mut hash = SampleHash::new(&imu().layout);
    rows.iter().for_each(|row| hash.update(row));
    hash.hex()
}

#[test]
fn every_form_gives_back_every_axis() {
    let dir = TempDir::new().unwrap();
    let rows = rows(1_000);
    for &format in FORMATS {
        let path = dir.path().join(format!("{format:?}"));
        write(&path, format, &imu(), &rows);
        let mut reader = open(&path).unwrap();
        assert_eq!(reader.info(), &imu(), "{format:?}");
        let found: Vec<Row> = reader.by_ref().map(Result::unwrap).collect();
        assert_eq!((&found, reader.warnings()), (&rows, Vec::new()), "{format:?}");
        let mut checked = Checked::new(&path, recognised(&path)).unwrap();
        assert!(checked.by_ref().all(|batch| batch.is_ok()) && checked.is_checked());
        assert_eq!(checked.samples_sha256().unwrap(), hash(&rows));
    }
}

fn recognised(path: &Path) -> Box<dyn BatchSource> {
    match table::recognise(path, fs::File::open(path).unwrap().into()).unwrap() {
        Opened::Table(source) => source,
        Opened::Other(_) => panic!("text"),
    }
}

/// The example in docs/formats/capture.md. Python's hashlib over struct.pack gave its hash.
#[test]
fn the_hash_is_that_of_the_document() {
    let first = Row::new(10_000_000, 0, &[-3, 32_767, -32_768]).unwrap();
    let second = Row::new(30_000_000, 2, &[5, 0, 1]).unwrap().with_lost(1);
    let both = [first.with_status(Some(0x2400)).with_temp_code(Some(-17)), second];
    assert_eq!(hash(&both), "6e6fd963b32b7f93c4f37cb35b5255a78a26356135b493969cf358837d161826");
}

#[test]
fn columns_and_metadata_of_the_document() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("imu.csv");
    write(&path, Format::Csv, &imu(), &rows(2));
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("\nt_ns,edge_seq,x_code,y_code,z_code,status,temp_code,lost\n10000000,0,0,0,-32768,9216,"));
    let stated = [
        "part = ADIS16405",
        "axes = x,y,z",
        "axis.y.unit = dps",
        "axis.y.width_bits = 16",
        "axis.y.zero_code = 0",
        "axis.y.lsb_per_unit = 20",
        "axis.y.signed = true",
        "temp.lsb_per_unit = 7.14",
        "temp.zero_value = 25",
        "temp.signed = true",
        "status_bits = 16",
    ];
    for line in stated {
        assert!(text.contains(&format!("# zerorate.{line}\n")), "{line}");
    }
    assert!(!text.contains("conversion") && !text.contains("# zerorate.width_bits"), "of an ADIS16130 alone");
}

#[test]
fn rows_of_another_layout_are_refused() {
    let dir = TempDir::new().unwrap();
    let good = rows(1)[0];
    let bad = [
        Row::new(1, 1, &[0; 2]).unwrap(),
        Row::new(1, 1, &[0, 0, 32_768]).unwrap(),
        good.with_temp_code(Some(2_048)),
        good.with_status(Some(1 << 16)),
    ];
    for row in bad {
        let mut writer = start(&dir.path().join("bad"), Format::Csv, &imu());
        let error = writer.push(&row).unwrap_err().to_string();
        assert!(error.contains("is not a row of part ADIS16405"), "{error}");
        writer.push(&good).unwrap();
    }
}

#[test]
fn names_that_no_capture_can_have_are_refused() {
    let named = |names: &[&str]| {
        let mut part = part();
        for (axis, name) in part.axes.to_mut().iter_mut().zip(names) {
            axis.name = (*name).to_owned().into();
        }
        Layout::of_part(&part).map(drop)
    };
    assert_eq!(named(&["x", "y", "z"]), Ok(()));
    assert_eq!(named(&["a,b"]), Err(LayoutError::Name("a,b".to_owned())));
    assert_eq!(named(&["temp"]), Err(LayoutError::Column("temp_code".to_owned())));
    assert_eq!(named(&["x", "x_corrected"]), Err(LayoutError::Column("x_corrected_dps".to_owned())));
    assert_eq!(layout(12), Err(LayoutError::Status(12)));
    let mut wide = part();
    wide.axes.to_mut()[1].axis.rate.width_bits = 32;
    assert!(Layout::of_part(&wide).is_ok(), "two's complement");
    wide.axes.to_mut()[1].axis.rate.signed = false;
    assert!(matches!(Layout::of_part(&wide), Err(LayoutError::Codes { name, .. }) if name == "y"));
}

#[test]
fn metadata_of_axes_are_checked() {
    let error = |key: &str, value: Option<&str>| {
        let mut metadata = imu().to_metadata();
        match value {
            Some(value) => drop(metadata.insert(key, value)),
            None => drop(metadata.remove(key)),
        }
        CaptureInfo::from_metadata(Path::new("imu.arrows"), &metadata).unwrap_err().to_string()
    };
    assert!(error("zerorate.axis.y.unit", Some("m/s^2")).contains("`m/s^2`, which is not a unit of angular rate"));
    assert!(error("zerorate.axes", Some("x,y,w")).contains("`zerorate.axis.w.unit` is missing"));
    assert!(error("zerorate.axes", None).contains("`zerorate.axes` is missing"));
    assert!(error("zerorate.axes", Some("x,y,x")).contains("two columns would be called"));
    assert!(error("zerorate.axis.x.width_bits", Some("0")).contains("do not make a scale"));
    assert!(error("zerorate.axis.x.signed", Some("yes")).contains("zerorate.axis.x.signed = yes"));
    assert!(error("zerorate.temp.lsb_per_unit", Some("-1")).contains("do not make a scale"));
    assert!(error("zerorate.part", Some("ADIS16130")).contains("`zerorate.width_bits` is missing"));
}

/// A property that the capture does not state is unknown. It is not taken from the ADIS16130.
#[test]
fn of_another_part_only_what_the_capture_states_is_known() {
    let info = CaptureInfo { bandwidth_hz: Some(50.0), ..imu() };
    let unknown = info.part();
    let axis = &unknown.axes[2].axis;
    assert_eq!((axis.rate, axis.temp), (part().axes[2].axis.rate, part().axes[2].axis.temp));
    assert_eq!((axis.bandwidth_hz, axis.range_dps, axis.noise, axis.temp_noise_c), (Some(50.0), None, None, None));
    let known = info.part_from(&part()).unwrap();
    assert_eq!((known.axes[2].axis.range_dps, known.axes[2].axis.bandwidth_hz), (Some(300.0), Some(50.0)));
    let error = info.part_from(&Part::ADIS16130).unwrap_err().to_string();
    assert!(error.contains("ADIS16405 with the axes x, y, z") && error.contains("ADIS16130"), "{error}");
}

#[test]
fn a_scale_in_radians_is_converted_to_degrees() {
    let degrees = imu().to_metadata();
    let radians = degrees.with("zerorate.axis.x.unit", "rad/s").with("zerorate.axis.x.lsb_per_unit", "1000");
    let part = CaptureInfo::from_metadata(Path::new("x"), &radians).unwrap().part();
    assert!((part.axes[0].axis.rate.value(1000) - 180.0 / std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn a_scan_is_the_row_less_the_zero_codes() {
    let row = Row::new(7, 3, &[-5, 32_767, 12]).unwrap().with_temp_code(Some(-17)).with_lost(4);
    let expected = Scan::new(7, 3, &[-5, 32_767, 12]).unwrap().with_temp(Some(-17)).with_lost(4).with_out_of_range(1);
    let layout = imu().layout;
    assert_eq!(layout.scan(&row), expected);
    assert_eq!(
        (0..4).map(|axis| layout.reading(&row, axis)).collect::<Vec<_>>(),
        [expected.reading(0), expected.reading(1), expected.reading(2), None]
    );
}

/// A [`Reading`] of an ADIS16130 has 24-bit codes, for any width of the recorded codes (F-43).
#[test]
fn a_row_of_an_adis16130_is_read_as_its_sample() {
    for (width, code) in [(Width::Bits24, 8_400_000), (Width::Bits16, 55_706), (Width::Bits16, 65_535)] {
        for status in [None, Some(ChannelStatus::new(8)), Some(ChannelStatus::new(9))] {
            let (rate, temp) = (RateCode::new(code, width), Some(TempCode::new(40_000, width)));
            let sample = Sample { t_ns: 5, seq: 6, rate, status, temp, lost: 7 };
            let layout = Layout::adis16130(width);
            assert_eq!(layout.reading(&Row::from(&sample), 0), Some(Reading::from(&sample)));
            assert_eq!(layout.scan(&Row::from(&sample)), Scan::from(&Reading::from(&sample)));
        }
    }
    assert_eq!(info().part().axes[0].axis, Axis { bandwidth_hz: Some(50.0), ..Axis::ADIS16130 });
}
