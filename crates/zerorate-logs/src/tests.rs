//! Tests with logs that the tests make themselves, so that their content is known.

#[cfg(feature = "full")]
mod forms;

#[cfg(feature = "full")]
pub use forms::*;

use super::*;
use arrow_array::{
    ArrayRef, Float64Array, Int32Array, Int64Array, RecordBatch, StringArray, TimestampNanosecondArray,
};
use arrow_ipc::writer::{FileWriter, StreamWriter};
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;
use zerorate_allan::{Gap, SettingName};

/// Parses options as a user types them: each name is followed by a value.
pub fn options(text: &str) -> ColumnOptions {
    let mut options = ColumnOptions { names: Names(flag), ..ColumnOptions::default() };
    let mut words = text.split_whitespace();
    while let (Some(name), Some(value)) = (words.next(), words.next()) {
        let number = || Some(value.parse().unwrap());
        match name {
            "--column" => options.column = Some(value.to_owned()),
            "--time-column" => options.time_column = Some(value.to_owned()),
            "--time-unit" => options.time_unit = TimeUnit::ALL.into_iter().find(|unit| unit.name() == value),
            "--rate" => options.rate = number(),
            "--unit" => options.unit = Some(value.parse().unwrap()),
            "--scale" => options.scale = number(),
            "--force-unit" => options.force_unit = value == "true",
            "--where" => options.only = Some(value.parse().unwrap()),
            "--topic" => options.topic = Some(value.to_owned()),
            "--max-bad" => options.max_bad = number(),
            "--decimal" => options.decimal = Some(if value == "comma" { Decimal::Comma } else { Decimal::Point }),
            "--raw" => options.raw = Some(value.parse().unwrap()),
            _ => panic!("no option {name}"),
        }
    }
    options
}

fn flag(setting: Setting) -> SettingName {
    SettingName { prefix: "--", joint: '-', ..setting.name() }
}

/// Reads a log from a file on disk: SQLite opens a bag by its name, and a packed log is unpacked into another file.
pub fn read_file(content: impl AsRef<[u8]>, said: &str) -> Result<Column> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("log");
    fs::write(&path, content).unwrap();
    read(&path, File::open(&path).unwrap().into(), &options(said))
}

pub fn fails(content: impl AsRef<[u8]>, said: &str) -> String {
    format!("{:#}", read_file(content, said).map(drop).unwrap_err())
}

pub fn numbers(column: &Column) -> Vec<f64> {
    match &column.series {
        Series::Codes(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        Series::Numbers(numbers) => numbers.clone(),
    }
}

/// The samples of a column, without gaps among codes; `None` if a number is missing.
pub fn there(column: &Column) -> Vec<Option<f64>> {
    numbers(column).into_iter().map(|number| Some(number).filter(|number| !number.is_nan())).collect()
}

fn batch(columns: &[(&str, ArrayRef)]) -> RecordBatch {
    RecordBatch::try_from_iter_with_nullable(columns.iter().map(|(name, column)| (*name, column.clone(), true)))
        .unwrap()
}

#[cfg(feature = "parquet")]
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

/// A table as an Arrow stream, as an Arrow file and as Parquet in several row groups.
pub fn tables(columns: &[(&str, ArrayRef)]) -> Vec<Vec<u8>> {
    let batch = batch(columns);
    let (mut stream, mut file) = (Vec::new(), Vec::new());
    let mut writer = StreamWriter::try_new(&mut stream, &batch.schema()).unwrap();
    writer.write(&batch).and_then(|()| writer.finish()).unwrap();
    let mut writer = FileWriter::try_new(&mut file, &batch.schema()).unwrap();
    writer.write(&batch).and_then(|()| writer.finish()).unwrap();
    drop(writer);
    let tables = vec![stream, file];
    #[cfg(feature = "parquet")]
    let tables = [tables, vec![parquet_of(columns)]].concat();
    tables
}

#[test]
fn tables_of_every_form() {
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
        let column = read_file(&table, "--column c --time-column t").unwrap();
        assert_eq!(column.series, Series::Codes(vec![1, 2, 4, 7]));
        // the empty third row and the missing one after it are one gap
        assert_eq!(column.gaps, [Gap { at: 2, missing: 2 }, Gap { at: 3, missing: 2 }]);
        assert_eq!((column.rate_hz, column.quantity, column.missing()), (100.0, None, 4));
        let column = read_file(&table, "--column gz_mdps --time-column t").unwrap();
        assert_eq!(there(&column), [Some(0.5), None, Some(1.5), None, None, Some(2.5), Some(3.5), Some(4.5)]);
        assert_eq!((column.scale, column.missing(), &column.gaps), (1e-3, 3, &vec![]));
        assert_eq!(read_file(&table, "--column l --rate 5").unwrap().series, Series::Codes(vec![1, 2, 3, 4, 5, 6, 7]));
        assert!(fails(&table, "--rate 5").contains("several columns"));
        assert!(fails(&table, "--column label --rate 5").contains("no numbers in `label`"));
        assert!(fails(&table, "--column c --time-column label").contains("column label, row 0: it holds Utf8"));
        assert!(
            fails(&table, "--column c --time-column gz_mdps --time-unit s").contains("column gz_mdps, row 1: no time")
        );
    }
}

#[test]
fn a_table_with_an_infinite_number_is_an_error() {
    let infinite: Vec<(&str, ArrayRef)> =
        vec![("x", Arc::new(Float64Array::from(vec![0.0, 1.0, 2.0, 3.0, f64::INFINITY])))];
    for table in tables(&infinite) {
        assert!(fails(&table, "--rate 5").contains("column x, row 4: it is infinite"));
    }
}

#[test]
fn raw_numbers_of_every_type() {
    let codes = [5_i16, -7, 300];
    let bytes = |of: &dyn Fn(i16) -> Vec<u8>| codes.iter().flat_map(|code| of(*code)).collect::<Vec<u8>>();
    for (raw, content) in [
        ("i16", bytes(&|code| code.to_le_bytes().to_vec())),
        ("i32", bytes(&|code| i32::from(code).to_le_bytes().to_vec())),
        ("f32", bytes(&|code| f32::from(code).to_le_bytes().to_vec())),
        ("f64", bytes(&|code| f64::from(code).to_le_bytes().to_vec())),
        ("i16be", bytes(&|code| code.to_be_bytes().to_vec())),
        ("f64be", bytes(&|code| f64::from(code).to_be_bytes().to_vec())),
    ] {
        let column = read_file(content, &format!("--raw {raw} --rate 10")).unwrap();
        assert_eq!(there(&column), codes.map(|code| Some(f64::from(code))), "{raw}");
    }
}

#[test]
fn raw_records_have_several_columns() {
    let rows = [[0_i16, 5, -7], [10, 300, 2], [20, -1, 4]];
    let content: Vec<u8> = rows.iter().flatten().flat_map(|code| code.to_be_bytes()).collect();
    let column = read_file(&content, "--raw 3xi16be --column 2 --rate 10").unwrap();
    assert_eq!((numbers(&column), column.name.as_str()), (vec![-7.0, 2.0, 4.0], "2"));
    let column = read_file(&content, "--raw 3xi16be --column 1 --time-column 0 --time-unit ms").unwrap();
    assert_eq!((numbers(&column), column.rate_hz), (vec![5.0, 300.0, -1.0], 100.0));
    let why = fails(&content, "--raw 3xi16be --rate 10");
    assert!(why.contains("has several columns; choose with --column one of: 0, 1, 2"), "{why}");
    let why = fails(&content[1..], "--raw 3xi16be --column 2 --rate 10");
    assert!(why.contains("17 bytes are not a multiple of 6-byte records; check --raw"), "{why}");
    for wrong in ["i8", "xi16", "0xi16", "6xi16xi16", "300xi16", "be", "6x", "-1xf64"] {
        assert!(wrong.parse::<RawType>().is_err(), "{wrong}");
    }
}

#[test]
fn text_of_many_dialects() {
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
        let column = read_file(text, &format!("{options} --rate 10")).unwrap();
        assert_eq!(there(&column), expected, "{text:?}");
    }
    let codes = read_file("x\n5\n\n-7\n", "--rate 10").unwrap();
    assert_eq!(codes.series, Series::Codes(vec![5, -7]));
    let codes = read_file("t,x\n0,5\n1,\n2,-7\n", "--rate 10 --column x").unwrap();
    assert_eq!((codes.series, codes.gaps), (Series::Codes(vec![5, -7]), vec![Gap { at: 1, missing: 1 }]));
}

/// The header of the EuRoC recordings is a comment.
#[test]
fn a_header_in_a_comment() {
    let text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad \
        s^-1]\n1403636579758555392,-0.0991,0.1473\n1403636579763555584,-0.0991,0.1473\n";
    for (name, time) in [("1", "0"), ("w_RS_S_x [rad s^-1]", "#timestamp [ns]"), ("1", "timestamp [ns]")] {
        let (column, time_column) = (Some(name.to_owned()), Some(time.to_owned()));
        let options = ColumnOptions { column, time_column, ..options("") };
        let column = read(Path::new("data.csv"), text.as_bytes().to_vec().into(), &options).unwrap();
        assert_eq!((column.name.as_str(), column.scale), ("w_RS_S_x [rad s^-1]", 1f64.to_degrees()));
        assert!((column.rate_hz / 199.992_32 - 1.0).abs() < 1e-8, "{}", column.rate_hz);
    }
}

#[test]
fn a_time_column_gives_rate_and_gaps() {
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
        let column = read_file(&text, &format!("--column gz --time-column 0 {options}")).unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-9);
        assert_eq!(column.gaps, [Gap { at: 50, missing: 3 }]);
    }
    let named = |options: &str| read_file(rows(1e3, "timestamp [ms],gz\n"), options).unwrap();
    assert_eq!(named("").gaps, named("--column gz").gaps);
    assert_eq!((named("--column gz").rate_hz, named("--column gz --rate 7").rate_hz), (named("").rate_hz, 7.0));
    assert!(fails("t_s,b_ms,gz\n0,0,1\n1,1,2\n2,2,1\n", "--column gz").contains("give --rate in Hz"));
    let iso = "when,gz\n2024-02-28T23:59:59.5,1\n2024-02-29T00:00:00,2\n2024-02-29T00:00:00.5,3\n";
    assert_eq!(read_file(iso, "--column gz --time-column when").unwrap().rate_hz, 2.0);
    assert!(
        fails(rows(1.0, "t,gz\n"), "--column gz --time-column t").contains("give --time-unit s, ms, us, ns, min or h")
    );
    assert!(
        fails(rows(1.0, "t,gz\n"), "--column gz")
            .contains("give --rate in Hz, or --time-column t with --time-unit s if it is the time")
    );
    let leap = "t_s,x\n0,0.5\n1,0.5\n2,0.5\n3,0.5\n90000000,0.5\n";
    assert!(fails(leap, "--column x --time-column 0").contains("89999996 samples would be missing in 1 place"));
}

#[test]
fn units_are_declared_or_said_to_be_unknown() {
    let scale = |name: &str, options: &str| {
        let column = read_file(format!("{name}\n1\n2\n3\n"), &format!("--rate 1 {options}")).unwrap();
        assert_eq!(column.quantity.is_some(), column.warnings.is_empty());
        column.quantity.map(|_| column.scale)
    };
    assert_eq!(scale("gz", ""), None);
    assert_eq!(scale("gz", "--scale 0.05"), Some(0.05));
    assert_eq!(scale("gz", "--unit mdps --scale 8.75"), Some(8.75e-3));
    assert_eq!(scale("gz_mdps", "--scale 8.75"), Some(8.75e-3));
    assert_eq!(scale("gz_rad_s", "--scale 2"), Some(2.0 * 1f64.to_degrees()));
    assert_eq!(scale("gz_rad_s", "--scale 2 --unit dps --force-unit true"), Some(2.0));
    assert_eq!(scale("gz", "--unit deg/h"), Some(1.0 / 3600.0));
    assert_eq!(scale("gz_rad_s", ""), Some(1f64.to_degrees()));
    assert_eq!(scale("gz_rad_s", "--unit rad/s"), Some(1f64.to_degrees()));
    assert_eq!(scale("gz_rad_s", "--unit dps --force-unit true"), Some(1.0));
    let error = read_file("gz_rad_s\n1\n2\n3\n", "--rate 1 --unit dps").expect_err("another unit");
    assert!(error.to_string().contains("`gz_rad_s` states rad/s, and --unit says dps, 0.0175 times"), "{error}");
}

/// Missing samples count in the number of skipped samples. If the cut is inside a gap, the whole gap is removed.
#[test]
fn the_beginning_is_left_out() {
    let codes = |codes: &[i32], gaps: &[(usize, u64)]| Column {
        gaps: gaps.iter().map(|&(at, missing)| zerorate_allan::Gap { at, missing }).collect(),
        ..Column::new("c", Series::Codes(codes.to_vec()), 1.0)
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

#[test]
fn a_unit_that_a_type_states_is_not_overridden() {
    let rows: String = (0..20).map(|row| format!("2026-01-01T00:00:00.{:02}Z,{}\n", 5 * row, row % 3)).collect();
    let log = format!("time,gz_dps\n{rows}");
    assert!((read_file(&log, "--column gz_dps --time-column time").unwrap().rate_hz - 20.0).abs() < 1e-6);
    let why = fails(&log, "--column gz_dps --time-column time --time-unit s");
    assert!(why.contains("by its type") && why.contains("leave --time-unit out"), "{why}");
}

/// bagpy writes whole seconds and nanoseconds into two columns, and data loggers a clock and milliseconds.
#[test]
fn a_stamp_in_two_columns_is_one_time() {
    let cases = [
        ("stamp.secs,stamp.nsecs", 1_000_000_000),
        ("tv_sec,tv_usec", 1_000_000),
        ("second,millisecond", 1000),
        ("time,ms", 1000),
    ];
    for (names, parts) in cases {
        let row = |at: u64| {
            let ms = 1_574_793_141_500 + at * 10;
            let seconds = match names.starts_with("time") {
                true => format!("12:{:02}:{:02}", ms / 60_000 % 60, ms / 1000 % 60),
                false => (ms / 1000).to_string(),
            };
            format!("{seconds},{},{}\n", ms % 1000 * (parts / 1000), at % 7)
        };
        let kept = (0..300).filter(|at| !(100..110).contains(at));
        let text = kept.map(row).fold(format!("{names},gz_dps\n"), |text, row| text + &row);
        for options in ["", "--column gz_dps"] {
            let column = read_file(&text, options).unwrap();
            assert!((column.rate_hz - 100.0).abs() < 1e-6, "{names}: {}", column.rate_hz);
            assert_eq!(column.gaps, [Gap { at: 100, missing: 10 }], "{names}");
        }
    }
}

/// A column `time` whose name states no unit, but whose numbers are dates in one unit only.
#[test]
fn dates_tell_the_unit_of_a_time() {
    let text = |start: u64, step: u64| {
        (0..50).map(|at| format!("{},{}\n", start + at * step, at % 7)).fold("time,gz_dps\n".to_owned(), |a, b| a + &b)
    };
    for (start, step) in
        [(1_700_000_000_000, 10), (1_700_000_000_000_000, 10_000), (1_700_000_000_000_000_000, 10_000_000)]
    {
        let column = read_file(text(start, step), "--column gz_dps").unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-3, "{}", column.rate_hz);
        assert!(column.warnings.iter().any(|warning| warning.code() == "time-unit-taken"), "{:?}", column.warnings);
    }
    // a counter since power-on leaves the unit open
    let why = fails(text(5_000_000, 10_000), "--column gz_dps");
    assert!(why.contains("--time-column time with --time-unit us if it is the time, as it rises evenly"), "{why}");
}

/// Stamps of 100 rows a second. The last ones count on where a fraction of a second would begin again.
#[test]
fn a_given_rate_is_compared_with_each_kind_of_stamps() {
    type Stamp = fn(u64) -> String;
    let kinds: [(&str, Stamp, bool); 9] = [
        ("Timestamp", |at| format!("12:00:{:02}.{:02}0", at / 100, at % 100), true),
        ("", |at| format!("2026-03-01 12:00:{:02}.{:02}", at / 100, at % 100), true),
        ("time", |at| (1_700_000_000_000_000_000 + at * 10_000_000).to_string(), true),
        ("time,ms", |at| format!("12:00:{:02},{}", at / 100, at % 100 * 10), true),
        ("time", |at| format!("{:.5}", at as f64 / 100.0 + 3e-5 * (at % 3) as f64), true),
        ("count", |at| (at * 3).to_string(), false),
        ("ticks_100us", |at| (at * 100).to_string(), true),
        ("sec,nanosec", |at| format!("{},{}", 17 + at / 100, at % 100 * 10_000_000), true),
        ("sec,nanosec", |at| format!("{},{}", 17 + at / 100, at * 10_000_000), false),
    ];
    for (names, stamp, tells) in kinds {
        let rows: String = (0..300).map(|at| format!("{},{}\n", stamp(at), at % 7)).collect();
        let contradicts = |rate_hz: u32| {
            let options = format!("--column gz_dps --rate {rate_hz}");
            let column = read_file(format!("{names},gz_dps\n{rows}"), &options).unwrap();
            column.warnings.iter().any(|warning| warning.code() == "rate-contradicts")
        };
        assert_eq!([50, 100].map(contradicts), [tells, false], "{names}");
    }
}

/// A log of 300 rows, with a time column that has this name and rises by this step.
fn stepping(name: &str, step: f64) -> String {
    (0..300).map(|at| format!("{},{}\n", f64::from(at) * step, at % 7)).fold(format!("{name},gz_dps\n"), |a, b| a + &b)
}

#[test]
fn a_unit_of_time_may_be_a_number_of_ticks() {
    let cases = [
        ("time [0.1 ms]", 100.0),
        ("ticks_100us", 100.0),
        ("t_10_ms", 1.0),
        ("SampleTimeFine", 100.0),
        ("SampleTimeFine", 10_000.0),
        ("ts [25 us]", 400.0),
        ("ticks_32768Hz", 327.68),
    ];
    for (name, step) in cases {
        let column = read_file(stepping(name, step), "--column gz_dps").unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-6, "{name} {step}: {}", column.rate_hz);
    }
}

/// Counters of 16, 24 and 32 bits, which wrap around at a number of ticks.
#[test]
fn counters_of_ticks_are_unwrapped() {
    let cases: [(&str, u32, u64); 4] =
        [("ticks_100us", 16, 100), ("ts [25 us]", 24, 400), ("ts (25us/LSB)", 32, 400), ("SampleTimeFine", 32, 100)];
    for (name, bits, step) in cases {
        let modulus = 1_u64 << bits;
        let row = |at: u64| format!("{},{}\n", (modulus - 20_000 + at * step) % modulus, at % 7);
        let text = (0..300).map(row).fold(format!("{name},gz_dps\n"), |text, row| text + &row);
        let column = read_file(text, "--column gz_dps").unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-6 && column.missing() == 0, "{name}: {}", column.rate_hz);
    }
}

/// A column `millis` that counts microseconds.
#[test]
fn a_slow_time_whose_name_alone_states_the_unit_is_asked_for() {
    let why = fails(stepping("millis", 10_000.0), "--column gz_dps");
    assert!(why.contains("in us the rows come at 100.000 Hz"), "{why}");
    assert!(why.contains("give --time-column millis with --time-unit us or ms, or --rate alone"), "{why}");
    for (unit, rate_hz) in [("us", 100.0), ("ms", 0.1)] {
        let options = format!("--column gz_dps --time-column millis --time-unit {unit}");
        assert!((read_file(stepping("millis", 10_000.0), &options).unwrap().rate_hz / rate_hz - 1.0).abs() < 1e-9);
    }
    assert!(read_file(stepping("t_s", 10.0), "--column gz_dps").is_ok());
}

/// A log whose columns have no names, and a log whose times lack the hour.
#[test]
fn the_question_for_the_rate_proposes_the_column_that_rises_evenly() {
    let row = |at: u64| format!("{at},1600,{},0.{}\n", 252_207_918_580_802 + at * 50_000_000, at % 7);
    let why = fails((0..300).map(row).collect::<String>(), "--column 3");
    let proposed = "--time-column 2 with --time-unit ns if it is the time, as it rises evenly (20.000 Hz)";
    assert!(why.contains(proposed), "{why}");
    // a counter of which a number is lost is not proposed
    let lost: String = (0..300).filter(|at| *at != 99).map(|at| format!("{at},{}\n", at % 7)).collect();
    let why = fails(format!("seq,gz_dps\n{lost}"), "--column gz_dps");
    assert!(why.contains("or --time-column if a column holds the time"), "{why}");
    let text: String = (0..300).map(|at| format!("59:{:02}.{},{}\n", at / 100, at / 10 % 10, at % 7)).collect();
    let why = fails(format!("Time,gz\n{text}"), "");
    assert!(why.contains("column `Time` (`59:00.0`) lacks the hour") && why.contains("as Excel shows"), "{why}");
}

#[test]
fn the_question_for_the_rate_names_days_and_several_clocks() {
    let days = |at: u32| format!("{:.9},0.{}\n", 45_218.5 + f64::from(at) * 0.01 / 86_400.0, at % 7);
    let why = fails((0..300).map(days).collect::<String>(), "--column 1");
    assert!(why.contains("which is 100.0") && why.contains("if `0` counts days, as Excel"), "{why}");
    // a count of 100 ns since 1601 is a count of neither µs nor ns
    let text: String =
        (0..40u64).map(|row| format!("{},{}\n", 133_500_000_000_000_000 + row * 100_000, row % 3)).collect();
    let why = fails(&text, "--column 1");
    assert!(why.contains("which is 100.0") && why.contains("counts steps of 100 ns, as Windows"), "{why}");
    let twice = |at: u32| format!("12:00:{0:02}.{1:02},12:00:{0:02}.{1:02},0.{2}\n", at / 100, at % 100, at % 7);
    let why = fails((0..300).map(twice).collect::<String>(), "");
    assert!(why.contains("--time-column with one of: `0`, `1`"), "{why}");
}

#[test]
fn minutes_are_proposed_and_read() {
    let text = stepping("time_min", 1.0 / 6000.0);
    let why = fails(&text, "--column gz_dps");
    assert!(why.contains("--time-unit min if it is the time, as it rises evenly (100.000 Hz)"), "{why}");
    let column = read_file(&text, "--column gz_dps --time-column time_min --time-unit min").unwrap();
    assert!((column.rate_hz - 100.0).abs() < 1e-6, "{}", column.rate_hz);
    // the times in s have more digits
    let row = |at: u32| format!("{:.5},{:.2},{}\n", f64::from(at) / 360_000.0, f64::from(at) / 100.0, at % 7);
    let text = (0..300).map(row).fold("Elapsed Time (hr),Time (s),gz_dps\n".to_owned(), |text, row| text + &row);
    let column = read_file(&text, "--column gz_dps").unwrap();
    assert!((column.rate_hz - 100.0).abs() < 1e-6 && column.missing() == 0, "{}", column.rate_hz);
}

/// The `hhmmss.s` of NMEA, over the end of a minute.
#[test]
fn times_whose_digits_are_those_of_a_clock_are_proposed_and_read() {
    let row = |at: u64| format!("12{:02}{:02}.{},{}\n", 57 + (at + 550) / 600, (at / 10 + 55) % 60, at % 10, at % 7);
    let text = (0..1000).map(row).fold("utc,gz\n".to_owned(), |text, row| text + &row);
    let why = fails(&text, "--column gz");
    assert!(why.contains("or --time-column utc if it is the time"), "{why}");
    for unit in ["", "--time-unit s"] {
        let column = read_file(&text, &format!("--column gz --time-column utc {unit}")).unwrap();
        assert!((column.rate_hz - 10.0).abs() < 1e-6 && column.missing() == 0, "{}", column.rate_hz);
    }
}

/// A spreadsheet keeps 6 or 7 digits of a stamp, and float32 keeps 7.
#[test]
fn stamps_that_lost_their_digits_name_the_cause() {
    let log = |stamp: &str, name: &str| {
        (0..300).map(|at| format!("{stamp},{}\n", at % 7)).fold(format!("{name},gz\n"), |a, b| a + &b)
    };
    for (text, seen) in [
        (log("1.70000E+18", "timestamp_ns"), "the stamps have 7 digits at most (1.7e18)"),
        (log("1700000000.0", "t_s"), "the stamps step by 128 s"),
    ] {
        let why = fails(text, "--column gz");
        assert!(why.contains(seen) && why.contains("export again with all digits, or give --rate"), "{why}");
    }
}

/// The name `clock_s` states a unit, but the cells are clock times.
#[test]
fn clock_times_whose_name_states_a_unit_are_the_time() {
    let rows: String = (0..50).map(|at| format!("12:00:{:05.2},{}\n", f64::from(at) / 100.0, at % 7)).collect();
    let column = read_file(format!("clock_s,gz\n{rows}"), "--column gz").unwrap();
    assert!((column.rate_hz - 100.0).abs() < 1e-6, "{}", column.rate_hz);
}

#[test]
fn steps_between_rows_tell_the_rate() {
    // steps of 9 or 11 ms in no order, from the high bits of a hash; the first step is the time since power-on
    let step = |at: u64| 9 + 2 * (at.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63);
    let pair = |at: u64| format!("{},{}\n{},{}\n", step(at), at % 7, 20 - step(at), at % 5);
    let text = (0..60).map(pair).fold("dt_ms,gz_dps\n2345,1\n".to_owned(), |text, rows| text + &rows);
    let why = fails(&text, "--column gz_dps");
    assert!(why.contains("`dt_ms` holds the step between rows; the usual step means --rate 100.000000"), "{why}");
    let why = fails((0..60).map(|at| format!("10,{}\n", at % 7)).fold("dt_ms,gz\n".to_owned(), |a, b| a + &b), "");
    assert!(why.contains("means --rate 100.000000"), "{why}");
    let why = fails(
        (0..60).map(|at| format!("0.005,{}\n", at % 7)).fold("dt,gz\n".to_owned(), |a, b| a + &b),
        "--column gz",
    );
    assert!(why.contains("which is 200.000000 if `dt` holds the step between rows in s"), "{why}");
    // `delta_t` may also name the time since the start of the log
    let text =
        (0..60).map(|at| format!("{},{}\n", 5 * at, at % 7)).fold("delta_t_ms,gz_dps\n".to_owned(), |a, b| a + &b);
    assert!((read_file(&text, "--column gz_dps").unwrap().rate_hz - 200.0).abs() < 1e-9);
}

/// Stamps whose parts are not seconds and the rest of a second, and times that only look like dates.
#[test]
fn a_time_that_two_readings_fit_is_asked_for() {
    let text = |head: &str, row: &dyn Fn(u64) -> String| {
        (0..300).map(row).fold(format!("{head}\n"), |text, row| text + &row + "\n")
    };
    let twice = text("t_sec,t_nsec,gz_dps", &|at| format!("{:.3},{},{}", at as f64 * 0.005, at * 5_000_000, at % 7));
    let running = text("sec,nanosec,gz_dps", &|at| format!("{},{},{}", 17 + at / 200, at * 5_000_000, at % 7));
    for text in [twice, running] {
        let why = fails(&text, "--column gz_dps");
        assert!(why.contains("are not whole seconds and the parts of a second"), "{why}");
    }
    // nanoseconds since power-on, 17 days ago, are dates of 2017 in microseconds
    let uptime = text("timestamp,gz_dps", &|at| format!("{},{}", 1_500_000_000_000_000 + at * 5_000_000, at % 7));
    assert!(fails(&uptime, "--column gz_dps").contains("does not say how fast"));
    assert!(fails(&uptime, "--column gz_dps --time-column timestamp").contains("give --time-unit"));
    // columns with the parts of a time do not hide the time
    let parts = text("t_ms,sec,ms,gz_dps", &|at| format!("{},{},{},{}", at * 5, at / 200, at * 5 % 1000, at % 7));
    assert!((read_file(&parts, "--column gz_dps").unwrap().rate_hz - 200.0).abs() < 1e-9);
}

/// A clock without a unit beside the stamps of a video, a counter of rows, and ticks of unknown length.
#[test]
fn two_clocks_are_asked_about() {
    let log = |names: &str, step: f64, other: f64| {
        let row = |at: u32| format!("{},{},{}\n", f64::from(at) * step, (f64::from(at) * other).floor(), at % 7);
        (0..300).map(row).fold(format!("{names},gz_dps\n"), |text, row| text + &row)
    };
    let why = fails(log("timestamp,pts_ms", 10.0, 1000.0 / 60.0), "--column gz_dps");
    assert!(why.contains("give --time-column pts_ms (60."), "{why}");
    assert!(why.contains("or --time-column timestamp with --time-unit ms (100.000 Hz)"), "{why}");
    for (names, step) in [("timestamp,t_ms", 0.01), ("timestamp,t_ms", 10_000.0), ("t,t_ms", 1.0), ("x,t_ms", 7.0)] {
        let column = read_file(log(names, step, 10.0), "--column gz_dps").unwrap();
        assert!((column.rate_hz - 100.0).abs() < 1e-6, "{names} {step}: {}", column.rate_hz);
    }
    let why = fails(stepping("cyccnt", 1_680_000.0), "--column gz_dps");
    assert!(why.contains("give --rate in Hz (f/1680000.000 if cyccnt counts f ticks a second), or"), "{why}");
    let why = fails(stepping("ticks", 100.0), "--column gz_dps");
    assert!(why.contains("which is f/100.000 if `ticks` counts f ticks a second"), "{why}");
    let why = fails(stepping("time_days", 0.01 / 86_400.0), "--column gz_dps");
    assert!(why.contains("which is 100.000 if `time_days` counts days"), "{why}");
}

#[test]
fn seconds_beside_minutes_are_unwrapped() {
    let row = |at: u32| format!("10,{},{},{},{}\n", at / 600, at / 10 % 60, at % 10 * 100, at % 7);
    let text = (0..2000).map(row).fold("hour,min,sec,ms,gz_dps\n".to_owned(), |text, row| text + &row);
    let column = read_file(text, "--column gz_dps").unwrap();
    assert!((column.rate_hz - 10.0).abs() < 1e-9 && column.missing() == 0, "{}", column.rate_hz);
    assert!(column.warnings.iter().any(|warning| warning.to_string().contains("start again 3 times")));
    let restarted = |at: u32| format!("{},{},{},{}\n", 1 - at / 500, 9 + at % 500 / 10, at % 10 * 100, at % 7);
    let text = (0..1000).map(restarted).fold("min,sec,ms,gz_dps\n".to_owned(), |text, row| text + &row);
    assert!(fails(text, "--column gz_dps").contains("goes back"));
}
