//! Logs of every form, with what stands in them known beforehand.

use super::*;
use arrow_array::{
    ArrayRef, Float64Array, Int32Array, Int64Array, RecordBatch, StringArray, TimestampNanosecondArray,
};
use arrow_ipc::writer::{FileWriter, StreamWriter};
use std::fs::{self, File};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;
use tempfile::TempDir;

/// Options as one types them.
pub fn options(text: &str) -> ColumnOptions {
    let mut options = ColumnOptions { names: Names(flag), ..ColumnOptions::default() };
    let mut words = text.split_whitespace();
    while let (Some(name), Some(value)) = (words.next(), words.next()) {
        let number = || Some(value.parse().unwrap());
        match name {
            "--column" => options.column = Some(value.to_owned()),
            "--time-column" => options.time_column = Some(value.to_owned()),
            "--time-unit" => {
                let units = [("s", TimeUnit::S), ("ms", TimeUnit::Ms), ("us", TimeUnit::Us), ("ns", TimeUnit::Ns)];
                options.time_unit = units.into_iter().find(|(name, _)| *name == value).map(|(_, unit)| unit);
            }
            "--rate" => options.rate = number(),
            "--unit" => options.unit = Some(value.parse().unwrap()),
            "--scale" => options.scale = number(),
            "--topic" => options.topic = Some(value.to_owned()),
            "--max-bad" => options.max_bad = number(),
            "--decimal" => options.decimal = Some(if value == "comma" { Decimal::Comma } else { Decimal::Point }),
            "--raw" => {
                let types =
                    [("i16", RawType::I16), ("i32", RawType::I32), ("f32", RawType::F32), ("f64", RawType::F64)];
                options.raw = types.into_iter().find(|(name, _)| *name == value).map(|(_, raw)| raw);
            }
            _ => panic!("no option {name}"),
        }
    }
    options
}

/// What a command line calls the options.
fn flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Column => "--column",
        Setting::TimeColumn => "--time-column",
        Setting::TimeUnit => "--time-unit",
        Setting::Topic => "--topic",
        Setting::Decimal => "--decimal",
        Setting::MaxBad => "--max-bad",
        other => other.name(),
    }
}

pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// Reads this content with these options.
    pub fn read(&self, content: impl AsRef<[u8]>, options: &str) -> Result<Column> {
        let path = self.write("log", content);
        super::read(&path, File::open(&path).unwrap().into(), &super::tests::options(options))
    }

    pub fn fails(&self, content: impl AsRef<[u8]>, options: &str) -> String {
        format!("{:#}", self.read(content, options).map(drop).unwrap_err())
    }
}

pub fn numbers(column: &Column) -> Vec<f64> {
    match &column.series {
        Series::Codes(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        Series::Numbers(numbers) => numbers.clone(),
    }
}

/// Numbers where a missing one is none.
pub fn there(column: &Column) -> Vec<Option<f64>> {
    numbers(column).into_iter().map(|number| Some(number).filter(|number| !number.is_nan())).collect()
}

/// `0.5 0.25 -1.5 2`, one to a line, as Python's gzip, lzma and zstandard pack it.
pub const GZIP: &[u8] = b"\
    \x1F\x8B\x08\x00\x00\x00\x00\x00\x02\x03\x33\xD0\x33\xE5\x32\xD0\x33\x32\xE5\xD2\x35\x04\xB2\x8C\xB8\x00\
    \x3C\x10\xE6\xEC\x10\x00\x00\x00";
pub const XZ: &[u8] = b"\
    \xFD\x37\x7A\x58\x5A\x00\x00\x01\x69\x22\xDE\x36\x02\x00\x21\x01\x16\x00\x00\x00\x74\x2F\xE5\xA3\x01\x00\
    \x0F\x30\x2E\x35\x0A\x30\x2E\x32\x35\x0A\x2D\x31\x2E\x35\x0A\x32\x0A\x00\x3C\x10\xE6\xEC\x00\x01\x24\x10\
    \xE9\x44\xD9\xCC\x90\x42\x99\x0D\x01\x00\x00\x00\x00\x01\x59\x5A";
pub const ZSTD: &[u8] =
    b"\x28\xB5\x2F\xFD\x20\x10\x81\x00\x00\x30\x2E\x35\x0A\x30\x2E\x32\x35\x0A\x2D\x31\x2E\x35\x0A\x32\x0A";

/// Logs by other people's writers (`fixtures/make.py`).
pub const NPZ: &[u8] = include_bytes!("fixtures/imu.npz");
pub const NPZ_PACKED: &[u8] = include_bytes!("fixtures/imu_packed.npz");
pub const MAT: &[u8] = include_bytes!("fixtures/imu.mat");
pub const MAT_PACKED: &[u8] = include_bytes!("fixtures/imu_packed.mat");
pub const MAT_73: &[u8] = include_bytes!("fixtures/imu73.mat");
pub const HDF5: &[u8] = include_bytes!("fixtures/imu.h5");
pub const HDF5_LATEST: &[u8] = include_bytes!("fixtures/imu_latest.h5");
pub const ROSBAG: &[u8] = include_bytes!("fixtures/imu_none.bag");
pub const ROSBAG_BZ2: &[u8] = include_bytes!("fixtures/imu_bz2.bag");
pub const ROSBAG_LZ4: &[u8] = include_bytes!("fixtures/imu_lz4.bag");
pub const ULOG: &[u8] = include_bytes!("fixtures/imu.ulg");

#[test]
fn packed_files_are_known_by_their_content() {
    let folder = Folder::new();
    for packed in [GZIP, XZ, ZSTD] {
        let column = folder.read(packed, "--rate 10 --unit dps").unwrap();
        assert_eq!(numbers(&column), [0.5, 0.25, -1.5, 2.0]);
        assert!(folder.fails(&packed[..packed.len() - 9], "--rate 10").contains("cannot be unpacked"));
    }
    // 16 bytes of text are two f64
    assert_eq!(folder.read(GZIP, "--rate 10 --raw f64").unwrap().series.len(), 2);
    let twice = zstd::encode_all(GZIP, 1).unwrap();
    assert!(folder.fails(twice, "--rate 10").contains("packed twice"));
    let batch = vec![("x", Arc::new(Float64Array::from(vec![1.5, 2.5])) as ArrayRef)];
    let packed = zstd::encode_all(Cursor::new(parquet_of(&batch)), 1).unwrap();
    assert_eq!(numbers(&folder.read(packed, "--rate 10").unwrap()), [1.5, 2.5]);
}

/// An NPY file of format 1.0, put together as NEP 1 describes.
pub fn npy(header: &str, data: impl AsRef<[u8]>) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    let padding = " ".repeat(63 - (10 + header.len()) % 64);
    file.extend(((header.len() + padding.len() + 1) as u16).to_le_bytes());
    file.extend(format!("{header}{padding}\n").as_bytes());
    file.extend(data.as_ref());
    file
}

#[test]
fn npy_of_every_type() {
    let folder = Folder::new();
    let header = |descr: &str| format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2,), }}");
    let cases: [(&str, Vec<u8>, [f64; 2]); 12] = [
        ("|i1", vec![5, 0xFE], [5.0, -2.0]),
        ("|u1", vec![5, 0xFE], [5.0, 254.0]),
        ("<i2", vec![5, 0, 0xFE, 0xFF], [5.0, -2.0]),
        (">i2", vec![0, 5, 0xFF, 0xFE], [5.0, -2.0]),
        (">u2", vec![0, 5, 0xFF, 0xFE], [5.0, 65534.0]),
        ("<i4", [5i32, -2].map(i32::to_le_bytes).concat(), [5.0, -2.0]),
        (">u4", [5u32, 4_000_000_000].map(u32::to_be_bytes).concat(), [5.0, 4e9]),
        ("<i8", [5i64, -2].map(i64::to_le_bytes).concat(), [5.0, -2.0]),
        ("<u8", [5u64, 1 << 63].map(u64::to_le_bytes).concat(), [5.0, 9_223_372_036_854_775_808.0]),
        (">f4", [1.5f32, -2.5].map(f32::to_be_bytes).concat(), [1.5, -2.5]),
        ("<f8", [1.5f64, -2.5].map(f64::to_le_bytes).concat(), [1.5, -2.5]),
        (">f8", [1.5f64, -2.5].map(f64::to_be_bytes).concat(), [1.5, -2.5]),
    ];
    for (descr, data, expected) in cases {
        let column = folder.read(npy(&header(descr), data), "--rate 10").unwrap();
        assert_eq!(numbers(&column), expected, "{descr}");
        assert_eq!(
            matches!(column.series, Series::Codes(_)),
            expected.iter().all(|n| n.abs() < 1e5 && n.fract() == 0.0)
        );
    }
    let missing = npy(&header("<f8"), [f64::NAN, 1.0].map(f64::to_le_bytes).concat());
    assert_eq!(there(&folder.read(missing, "--rate 10").unwrap()), [None, Some(1.0)]);
}

#[test]
fn npy_of_two_dimensions_and_of_fields() {
    let folder = Folder::new();
    let header = |order| format!("{{'descr': '<i2', 'fortran_order': {order}, 'shape': (3, 2), }}");
    let rows = [1i16, 10, 2, 20, 4, 40].map(i16::to_le_bytes).concat();
    let columns = [1i16, 2, 4, 10, 20, 40].map(i16::to_le_bytes).concat();
    for file in [npy(&header("False"), rows), npy(&header("True"), columns)] {
        let column = folder.read(&file, "--column 1 --time-column 0 --time-unit s").unwrap();
        assert_eq!(
            (numbers(&column), column.gaps.as_slice()),
            (vec![10.0, 20.0, 40.0], &[Gap { at: 2, missing: 1 }][..])
        );
        assert!(folder.fails(&file, "--rate 10").contains("several columns; choose with --column one of: 0, 1"));
    }
    let descr = "[('t', '<M8[ms]'), ('ok', '|u1'), ('gz_rad_s', '>f4'), ('name', '<U2')]";
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (3,), }}");
    let row = |t: i64, z: f32| [&t.to_le_bytes()[..], &[1], &z.to_be_bytes(), &[0; 8]].concat();
    let file = npy(&header, [row(1000, 0.5), row(1010, 1.5), row(1020, 2.5)].concat());
    let column = folder.read(&file, "--column gz_rad_s --time-column t").unwrap();
    assert_eq!((numbers(&column), column.rate_hz, column.scale), (vec![0.5, 1.5, 2.5], 100.0, 1f64.to_degrees()));
    assert!(folder.fails(&file, "--column name --rate 1").contains("holds no numbers in `name`"));
    assert!(
        folder
            .fails(&file[..file.len() - 1], "--column ok --rate 1")
            .contains("header states 63 bytes of data and 62 follow")
    );
}

fn batch(columns: &[(&str, ArrayRef)]) -> RecordBatch {
    RecordBatch::try_from_iter_with_nullable(columns.iter().map(|(name, column)| (*name, column.clone(), true)))
        .unwrap()
}

fn parquet_of(columns: &[(&str, ArrayRef)]) -> Vec<u8> {
    let batch = batch(columns);
    let properties =
        ::parquet::file::properties::WriterProperties::builder().set_max_row_group_row_count(Some(3)).build();
    let mut file = Vec::new();
    let mut writer = ::parquet::arrow::ArrowWriter::try_new(&mut file, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    file
}

/// A table as Parquet in several row groups, as an Arrow stream and as an Arrow file.
pub fn tables(columns: &[(&str, ArrayRef)]) -> [Vec<u8>; 3] {
    let batch = batch(columns);
    let (mut stream, mut file) = (Vec::new(), Vec::new());
    let mut writer = StreamWriter::try_new(&mut stream, &batch.schema()).unwrap();
    writer.write(&batch).and_then(|()| writer.finish()).unwrap();
    let mut writer = FileWriter::try_new(&mut file, &batch.schema()).unwrap();
    writer.write(&batch).and_then(|()| writer.finish()).unwrap();
    drop(writer);
    [parquet_of(columns), stream, file]
}

#[test]
fn tables_of_every_form() {
    let folder = Folder::new();
    let t = TimestampNanosecondArray::from(vec![
        0, 10_000_000, 20_000_000, 40_000_000, 50_000_000, 60_000_000, 70_000_000,
    ]);
    let label = StringArray::from(vec!["x"; 7]);
    let codes = Int32Array::from(vec![Some(1), Some(2), None, Some(4), None, None, Some(7)]);
    let long = Int64Array::from(vec![1, 2, 3, 4, 5, 6, 7]);
    let rate = Float64Array::from(vec![Some(0.5), None, Some(1.5), Some(f64::NAN), Some(2.5), Some(3.5), Some(4.5)]);
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("t", Arc::new(t)),
        ("label", Arc::new(label)),
        ("c", Arc::new(codes)),
        ("l", Arc::new(long)),
        ("gz_mdps", Arc::new(rate)),
    ];
    for table in tables(&columns) {
        let column = folder.read(&table, "--column c --time-column t").unwrap();
        assert_eq!(column.series, Series::Codes(vec![1, 2, 4, 7]));
        // the empty third row and the missing one after it are one gap
        assert_eq!(column.gaps, [Gap { at: 2, missing: 2 }, Gap { at: 3, missing: 2 }]);
        assert_eq!((column.rate_hz, column.quantity, column.missing()), (100.0, None, 4));
        let column = folder.read(&table, "--column gz_mdps --time-column t").unwrap();
        assert_eq!(there(&column), [Some(0.5), None, Some(1.5), None, None, Some(2.5), Some(3.5), Some(4.5)]);
        assert_eq!((column.scale, column.missing(), &column.gaps), (1e-3, 3, &vec![]));
        assert_eq!(
            folder.read(&table, "--column l --rate 5").unwrap().series,
            Series::Codes(vec![1, 2, 3, 4, 5, 6, 7])
        );
        assert!(folder.fails(&table, "--rate 5").contains("several columns"));
        assert!(folder.fails(&table, "--column label --rate 5").contains("no numbers in `label`"));
        assert!(folder.fails(&table, "--column c --time-column label").contains("column label, row 0: it holds Utf8"));
        assert!(
            folder
                .fails(&table, "--column c --time-column gz_mdps --time-unit s")
                .contains("column gz_mdps, row 1: no time")
        );
    }
}

#[test]
fn damaged_tables_are_errors() {
    let folder = Folder::new();
    let columns: Vec<(&str, ArrayRef)> =
        vec![("x", Arc::new(Float64Array::from((0..50).map(f64::from).collect::<Vec<_>>())))];
    for table in tables(&columns) {
        for at in (0..table.len()).step_by(11) {
            let mut damaged = table.clone();
            damaged[at] ^= 0xFF;
            // whatever it says, it says it
            drop(folder.read(&damaged, "--rate 5"));
            drop(folder.read(&table[..at], "--rate 5"));
        }
    }
    let infinite: Vec<(&str, ArrayRef)> =
        vec![("x", Arc::new(Float64Array::from(vec![0.0, 1.0, 2.0, 3.0, f64::INFINITY])))];
    for table in tables(&infinite) {
        assert!(folder.fails(&table, "--rate 5").contains("column x, row 4: it is infinite"));
    }
}

#[test]
fn text_of_many_dialects() {
    let folder = Folder::new();
    let expected = [Some(0.5), None, Some(-1.25), Some(3.0)];
    let cases = [
        ("0.5\nnan\n-1.25\n3\n", ""),
        ("\u{FEFF}gz\r\n0.5\r\nNaN\r\n-1.25\r\n3\r\n", ""),
        ("t,gz\n1,0.5\n2,\n3,-1.25\n4,3", "--column gz"),
        ("# made by x\n\"t, s\",\"gz\"\n1,\"0.5\"\n2,\"\"\n3,\"-1.25\"\n4,\"3\"\n", "--column gz"),
        ("t;gz\n1;0,5\n2;\n3;-1,25\n4;3\n", "--column 1"),
        ("t\tgz\n1\t0,5\n2\tNA\n3\t-1,25\n4\t3\n", "--column gz"),
        ("1,0 0,5\n2,0 nan\n3,0 -1,25\n4,0 3\n", "--column 1"),
        ("  1   0.5\n  2   null\n% note\n  3   -1.25\n  4   3.0\n", "--column 1"),
        ("0,500\n-\n-1,250\n3,000\n", "--decimal comma"),
        ("label,gz\na,0.5\nb,nan\nc,-1.25\nd,3\n", ""),
        (
            "2024-01-02 03:04:05,0.5\n2024-01-02 03:04:06,\n2024-01-02 03:04:07,-1.25\n2024-01-02 03:04:08,3\n",
            "--column 1",
        ),
    ];
    for (text, options) in cases {
        let column = folder.read(text, &format!("{options} --rate 10")).unwrap();
        assert_eq!(there(&column), expected, "{text:?}");
    }
    let codes = folder.read("x\n5\n\n-7\n", "--rate 10").unwrap();
    assert_eq!(codes.series, Series::Codes(vec![5, -7]));
    let codes = folder.read("t,x\n0,5\n1,\n2,-7\n", "--rate 10 --column x").unwrap();
    assert_eq!((codes.series, codes.gaps), (Series::Codes(vec![5, -7]), vec![Gap { at: 1, missing: 1 }]));
}

/// The header of the EuRoC recordings is a comment.
#[test]
fn a_header_in_a_comment() {
    let text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad \
        s^-1]\n1403636579758555392,-0.0991,0.1473\n1403636579763555584,-0.0991,0.1473\n";
    let options = "--column 1 --time-column 0";
    let column = Folder::new().read(text, options).unwrap();
    assert_eq!((column.name.as_str(), column.scale), ("w_RS_S_x [rad s^-1]", 1f64.to_degrees()));
    assert!((column.rate_hz / 199.992_32 - 1.0).abs() < 1e-8, "{}", column.rate_hz);
}

#[test]
fn a_time_column_gives_rate_and_gaps() {
    let folder = Folder::new();
    let rows = |unit: f64, head: &str| -> String {
        let there = (0..200).filter(|i| !(50..53).contains(i));
        head.to_owned() + &there.map(|i| format!("{},{}\n", f64::from(i) * 0.01 * unit, i % 7)).collect::<String>()
    };
    let cases = [
        (rows(1e9, "t_ns,gz\n"), ""),
        (rows(1e6, "time_us,gz\n"), ""),
        (rows(1e3, "timestamp [ms],gz\n"), ""),
        (rows(1.0, "t,gz\n"), "--time-unit s"),
    ];
    for (text, options) in cases {
        let column = folder.read(&text, &format!("--column gz --time-column 0 {options}")).unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-9);
        assert_eq!(column.gaps, [Gap { at: 50, missing: 3 }]);
    }
    let named = |options: &str| folder.read(rows(1e3, "timestamp [ms],gz\n"), options).unwrap();
    assert_eq!(named("").gaps, named("--column gz").gaps);
    assert_eq!((named("--column gz").rate_hz, named("--column gz --rate 7").rate_hz), (named("").rate_hz, 7.0));
    assert!(folder.fails("t_s,b_ms,gz\n0,0,1\n1,1,2\n2,2,1\n", "--column gz").contains("give rate in Hz"));
    let iso = "when,gz\n2024-02-28T23:59:59.5,1\n2024-02-29T00:00:00,2\n2024-02-29T00:00:00.5,3\n";
    assert_eq!(folder.read(iso, "--column gz --time-column when").unwrap().rate_hz, 2.0);
    assert!(
        folder.fails(rows(1.0, "t,gz\n"), "--column gz --time-column t").contains("give --time-unit s, ms, us or ns")
    );
    assert!(folder.fails(rows(1.0, "t,gz\n"), "--column gz").contains("give rate in Hz, or --time-column if"));
    let leap = "t_s,x\n0,0.5\n1,0.5\n2,0.5\n3,0.5\n90000000,0.5\n";
    assert!(
        folder.fails(leap, "--column x --time-column 0").contains("89999996 samples would be missing in 1 places")
    );
}

#[test]
fn units_are_declared_or_said_to_be_unknown() {
    let folder = Folder::new();
    let scale = |name: &str, options: &str| {
        let column = folder.read(format!("{name}\n1\n2\n3\n"), &format!("--rate 1 {options}")).unwrap();
        assert_eq!(column.quantity.is_some(), column.warnings.is_empty());
        column.quantity.map(|_| column.scale)
    };
    assert_eq!(scale("gz", ""), None);
    assert_eq!(scale("gz", "--scale 0.05"), Some(0.05));
    assert_eq!(scale("gz", "--unit mdps --scale 8.75"), Some(8.75e-3));
    assert_eq!(scale("gz", "--unit deg/h"), Some(1.0 / 3600.0));
    assert_eq!(scale("gz_rad_s", ""), Some(1f64.to_degrees()));
    assert_eq!(scale("gz_rad_s", "--unit dps"), Some(1.0));
}

/// Two recordings by the Python writer mcap-ros2-support 0.6.0: 8 messages at 200 Hz, one missing before the sixth.
#[test]
fn bags_of_an_independent_writer() {
    let folder = Folder::new();
    for bag in [&include_bytes!("fixtures/imu_zstd.mcap")[..], include_bytes!("fixtures/imu_lz4.mcap")] {
        let column = folder.read(bag, "--column z").unwrap();
        assert_eq!(
            there(&column),
            [0.0, 0.25, 0.5, 0.75, 1.0, f64::NAN, 1.25, 1.5, 1.75].map(|n| Some(n).filter(|n| !n.is_nan()))
        );
        assert_eq!(
            (column.name.as_str(), column.scale, column.rate_hz),
            ("/imu.angular_velocity.z", 1f64.to_degrees(), 200.0)
        );
        assert_eq!(
            folder.read(bag, "--column /imu.angular_velocity.y --rate 10").unwrap().series,
            Series::Numbers(vec![-0.5; 8])
        );
        let gravity = folder.read(bag, "--column linear_acceleration.z").unwrap();
        assert_eq!((numbers(&gravity)[0], gravity.quantity), (9.81, Some(Quantity::Acceleration)));
        let asked = folder.fails(bag, "");
        assert!(
            asked.contains("choose with --column one of: /imu.angular_velocity.x, /imu.angular_velocity.y"),
            "{asked}"
        );
        assert!(
            folder.fails(bag, "--column /gyro.angular_velocity.x").contains("no column `/gyro.angular_velocity.x`")
        );
        for at in (0..bag.len()).step_by(13) {
            drop(folder.read(&bag[..at], "--column z"));
        }
    }
}

/// A message by hand: CDR aligns numbers to their size, ROS 1 does not.
pub fn imu(cdr: bool, big_endian: bool, ns: u64, z: f64) -> Vec<u8> {
    let u32_of = |number: u32| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let f64_of = |number: f64| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let mut body = Vec::new();
    body.extend(u32_of((ns / 1_000_000_000) as u32));
    body.extend(u32_of((ns % 1_000_000_000) as u32));
    let frame: &[u8] = if cdr { b"imu\0" } else { b"imu" };
    body.extend(u32_of(frame.len() as u32));
    body.extend(frame);
    while cdr && !body.len().is_multiple_of(8) {
        body.push(0);
    }
    for at in 0..37 {
        body.extend(f64_of(if at == 15 { z } else { 100.0 + f64::from(at) }));
    }
    let start: &[u8] = if cdr { &[0, u8::from(!big_endian), 0, 0] } else { &[9, 0, 0, 0] };
    [start, &body].concat()
}

fn mcap(topics: &[&str], encoding: &str, messages: impl Fn(u64) -> Vec<u8>) -> Vec<u8> {
    mcap_packed(Some(mcap::Compression::Zstd), topics, encoding, messages)
}

pub fn mcap_packed(
    packing: Option<mcap::Compression>,
    topics: &[&str],
    encoding: &str,
    messages: impl Fn(u64) -> Vec<u8>,
) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().compression(packing).create(&mut file).unwrap();
    let schema = writer.add_schema("sensor_msgs/msg/Imu", "ros2msg", b"").unwrap();
    for topic in topics {
        let channel = writer.add_channel(schema, topic, encoding, &Default::default()).unwrap();
        for i in 0..20 {
            let header =
                mcap::records::MessageHeader { channel_id: channel, sequence: i as u32, log_time: i, publish_time: i };
            writer.write_to_known_channel(&header, &messages(i)).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

#[test]
fn messages_in_every_encoding() {
    let folder = Folder::new();
    for (name, cdr, big_endian) in [("cdr", true, false), ("cdr", true, true), ("ros1", false, false)] {
        let bag =
            mcap(&["/imu"], name, |i| imu(cdr, big_endian, 1_700_000_000_000_000_000 + i * 10_000_000, i as f64));
        let column = folder.read(&bag, "--column z").unwrap();
        assert_eq!((numbers(&column), column.rate_hz), ((0..20).map(f64::from).collect(), 100.0));
    }
    let two = mcap(&["/a", "/b"], "cdr", |i| imu(true, false, i * 10_000_000, i as f64));
    let asked = folder.fails(&two, "--column z");
    let head = ["topic", "type", "messages", "rate", "duration", "frame_id"];
    let row = ["/b", "sensor_msgs/msg/Imu", "20", "100.00", "Hz", "0.2", "s", "imu"];
    let rows: Vec<Vec<&str>> = asked.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(asked.contains("several IMUs; choose one with --topic") && rows[1] == head && rows[3] == row, "{asked}");
    assert_eq!(folder.read(&two, "--column z --topic /b").unwrap().name, "/b.angular_velocity.z");
    assert!(folder.fails(&two, "--column z --topic /c").contains("no IMU on a topic `/c`"));
    assert!(folder.fails(&two, "--column w --topic /b").contains("one of: /b.angular_velocity.x"));
    assert_eq!(folder.read(&two, "--column /b.angular_velocity.z").unwrap().series.len(), 20);
    let short = mcap(&["/imu"], "cdr", |_| vec![0, 1, 0, 0, 5]);
    assert!(
        folder
            .fails(&short, "--column z")
            .contains("topic /imu, message 0: its 5 bytes are no sensor_msgs/Imu in Cdr")
    );
    let back = mcap(&["/imu"], "cdr", |i| imu(true, false, (30 - i) * 1000, 0.0));
    assert!(
        folder.fails(&back, "--column z").contains("column /imu.header.stamp: the time goes back by 1000, at row 1")
    );
    let other = mcap(&["/imu"], "json", |_| b"{}".to_vec());
    assert!(folder.fails(&other, "--column z").contains("topic /imu: its messages are encoded in `json`"));
}

/// The tables that rosbag2_storage_sqlite3 makes, with 8 messages at 100 Hz, one missing before the fifth.
pub fn sqlite_bag() -> Vec<u8> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("bag.db3");
    let bag = rusqlite::Connection::open(&path).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format \
         TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data \
         BLOB NOT NULL);
         INSERT INTO topics VALUES (1, '/chat', 'std_msgs/msg/String', 'cdr', ''), (2, '/imu', 'sensor_msgs/msg/Imu', \
         'cdr', '');
         INSERT INTO messages(topic_id, timestamp, data) VALUES (1, 0, x'00010000');",
    )
    .unwrap();
    for i in [0, 1, 2, 3, 5, 6, 7, 8] {
        let message = imu(true, false, i * 10_000_000, i as f64);
        let message = if i > 4 { zstd::encode_all(&message[..], 1).unwrap() } else { message };
        bag.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (2, ?1, ?2)", (i as i64, message))
            .unwrap();
    }
    drop(bag);
    fs::read(&path).unwrap()
}

#[test]
fn bags_in_sqlite() {
    let folder = Folder::new();
    let content = sqlite_bag();
    for content in [content.clone(), zstd::encode_all(&content[..], 1).unwrap()] {
        let column = folder.read(&content, "--column z").unwrap();
        assert_eq!((column.series.len(), column.missing(), column.rate_hz), (9, 1, 100.0));
    }
    assert!(folder.fails(&content[..5000], "--column z").contains("ros2 bag"));
}

#[test]
fn a_capture_tells_what_it_lost() {
    let folder = Folder::new();
    let head = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n# \
        zerorate.temp_conversion = 5\n\
                t_ns,edge_seq,rate_code,status,temp_code,lost\n";
    // 7 before the first row do not matter: the record had not begun
    let rows = "0,1,8388608,8,8400000,7\n10000000,2,8388610,8,,0\n40000000,5,8388609,8,,2\n50000000,6,8388611,8,,0\n";
    let column = folder.read(format!("{head}{rows}"), "").unwrap();
    assert_eq!((column.gaps.as_slice(), column.rate_hz), (&[Gap { at: 2, missing: 2 }][..], 100.0));
    assert_eq!((column.scale, column.missing(), column.quantity), (1.0 / 23_488.0, 2, Some(Quantity::AngularRate)));
    let mut closed = column;
    closed.close_gaps();
    assert_eq!((closed.missing(), closed.series.len()), (0, 4));
    let back = "0,1,8388608,8,,0\n10,2,8388608,8,,0\n10,3,8388608,8,,0\n";
    assert!(folder.fails(format!("{head}{back}"), "").contains("row 2: t_ns does not increase, from 10 to 10"));
    let wide = "0,1,16777216,8,,0\n";
    assert!(folder.fails(format!("{head}{wide}"), "").contains("16777216 is no code of 24 bits"));
}

/// A number of samples counts those that are missing; a gap that is cut through is left out whole.
#[test]
fn the_beginning_is_left_out() {
    let codes = |codes: &[i32], gaps: &[(usize, u64)]| Column {
        name: "c".to_owned(),
        series: Series::Codes(codes.to_vec()),
        gaps: gaps.iter().map(|&(at, missing)| zerorate_allan::Gap { at, missing }).collect(),
        rate_hz: 1.0,
        quantity: None,
        scale: 1.0,
        warnings: Vec::new(),
    };
    let all = || codes(&[0, 1, 5, 6, 9], &[(2, 3), (4, 2)]); // 0 1 _ _ _ 5 6 _ _ 9
    for (skipped, left) in [
        (0, all()),
        (1, codes(&[1, 5, 6, 9], &[(1, 3), (3, 2)])),
        (2, codes(&[5, 6, 9], &[(2, 2)])),
        (4, codes(&[5, 6, 9], &[(2, 2)])),
        (5, codes(&[5, 6, 9], &[(2, 2)])),
        (6, codes(&[6, 9], &[(1, 2)])),
        (9, codes(&[9], &[])),
        (10, codes(&[], &[])),
        (u64::MAX, codes(&[], &[])),
    ] {
        let mut column = all();
        column.skip(skipped);
        assert_eq!(column, left, "{skipped}");
    }
    let mut numbers = Column { series: Series::Numbers(vec![0.5, 1.5, 2.5]), gaps: Vec::new(), ..all() };
    numbers.skip(2);
    assert_eq!(numbers.series, Series::Numbers(vec![2.5]));
    numbers.skip(2);
    assert!(numbers.series.is_empty());
}
