//! Tests that columns that are read in one pass equal the columns that are read one by one.

use super::tests::{imu, mcap_packed, npy, options, sqlite_bag, tables};
use super::*;
use crate::series::SeriesBuilder;
use arrow_array::RecordBatch;
use arrow_array::{ArrayRef, DurationNanosecondArray, Float64Array, Int32Array, Int64Array, NullArray, StringArray};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate_allan::Gap;
use zerorate_input::Input;

pub fn all(content: &[u8], wanted: ColumnSelection<'_>, said: &str) -> Result<Vec<Column>> {
    read_all(Path::new("log"), content.to_vec().into(), wanted, &options(said))
}

/// Reads these columns at once and one by one, forwards and backwards, and compares them.
#[track_caller]
fn same(content: &[u8], names: &[&str], said: &str) -> Vec<Column> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let backwards: Vec<String> = names.iter().rev().cloned().collect();
    let one = |name: &String| {
        let options = ColumnOptions { column: Some(name.clone()), ..options(said) };
        read(Path::new("log"), content.to_vec().into(), &options).unwrap()
    };
    for names in [&names, &backwards] {
        let together = all(content, ColumnSelection::Listed(names), said).unwrap();
        let alone: Vec<Column> = names.iter().map(one).collect();
        // NaN is not equal to itself
        assert_eq!(format!("{together:?}"), format!("{alone:?}"));
    }
    all(content, ColumnSelection::Listed(&names), said).unwrap()
}

#[test]
fn a_table_in_memory_is_a_log() {
    let since_ns = [0, 10, 20, 50, 60].map(|ms| ms * 1_000_000_i64).to_vec();
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("index", Arc::new(DurationNanosecondArray::from(since_ns))),
        ("label", Arc::new(NullArray::new(5))),
        ("gz [rad/s]", Arc::new(Float64Array::from(vec![1.0, 2.0, f64::NAN, 4.0, 5.0]))),
    ];
    let table =
        RecordBatch::try_from_iter_with_nullable(columns.into_iter().map(|(name, of)| (name, of, true))).unwrap();
    let read = |wanted, said| read_table(Path::new("the table"), &table, wanted, &options(said));
    let [gz] = &read(ColumnSelection::All, "--time-column index").unwrap()[..] else { panic!("not one column") };
    assert_eq!((gz.name.as_str(), gz.rate_hz, gz.missing()), ("gz [rad/s]", 100.0, 3));
    assert_eq!((gz.quantity, gz.scale), (Some(Quantity::AngularRate), 1f64.to_degrees()));
    let error = read(ColumnSelection::One(Some("label")), "--rate 100").unwrap_err();
    assert!(error.to_string().contains("the table holds no numbers in `label`"), "{error}");
}

/// Rows 3 and 4 are missing in the log, and y is empty in row 5.
fn log() -> Vec<(&'static str, ArrayRef)> {
    let rows = || (0..12).filter(|row| !(3..5).contains(row));
    vec![
        ("x", Arc::new(Int32Array::from_iter_values(rows().map(|row| row * row)))),
        ("t_ms", Arc::new(Int64Array::from_iter_values(rows().map(|row| i64::from(row) * 10)))),
        ("y", Arc::new(Int32Array::from_iter(rows().map(|row| (row != 5).then_some(-row))))),
        ("z_dps", Arc::new(Float64Array::from_iter_values(rows().map(|row| f64::from(row) * 0.25)))),
    ]
}

#[test]
fn columns_of_tables() {
    for content in tables(&log()) {
        let columns = same(&content, &["z_dps", "x", "y"], "--time-column t_ms");
        assert!(columns.iter().all(|column| (column.rate_hz - 100.0).abs() < 1e-9));
        assert_eq!(columns.iter().map(Column::missing).collect::<Vec<_>>(), [2, 2, 3]);
        assert_eq!((columns[0].quantity, columns[1].quantity), (Some(Quantity::AngularRate), None));
        let found = all(&content, ColumnSelection::All, "--time-column t_ms").unwrap();
        assert_eq!(found.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["x", "y", "z_dps"]);
    }
}

/// A column of numbers and a column of names tell the rows of two sensors apart. Without a choice, the log is refused.
#[test]
fn rows_of_two_sensors_in_tables() {
    let rows = || 0..400;
    let names: StringArray = rows().map(|row| Some(["a", "b"][row % 2])).collect();
    let values: Vec<f64> = rows().map(|row| (row / 2) as f64 * 0.1 + 100.0 * (row % 2) as f64).collect();
    let log: Vec<(&str, ArrayRef)> = vec![
        ("t_ms", Arc::new(Int64Array::from_iter_values(rows().map(|row| (row / 2) as i64 * 10)))),
        ("SensorId", Arc::new(Int32Array::from_iter_values(rows().map(|row| (row % 2) as i32)))),
        ("sensor", Arc::new(names)),
        ("x", Arc::new(Float64Array::from(values))),
    ];
    for content in tables(&log) {
        for wanted in [ColumnSelection::One(Some("x")), ColumnSelection::All] {
            let said = all(&content, wanted, "--time-column t_ms").unwrap_err().to_string();
            assert!(
                said.contains("column `SensorId` is 0 (100 Hz), 1 (100 Hz) in turn, and 200 of 400 rows repeat"),
                "{said}"
            );
        }
        for only in ["SensorId=1", "sensor=b"] {
            let options = format!("--time-column t_ms --where {only}");
            let x = &all(&content, ColumnSelection::One(Some("x")), &options).unwrap()[0];
            assert_eq!((x.rate_hz, x.series.len(), super::tests::numbers(x)[1]), (100.0, 200, 100.1));
        }
    }
}

#[test]
fn rows_of_sensors_that_two_columns_tell() {
    let rows = || 0..800;
    let log: Vec<(&str, ArrayRef)> = vec![
        ("t_ms", Arc::new(Int64Array::from_iter_values(rows().map(|row| i64::from(row / 4 * 10))))),
        ("bus", Arc::new(Int32Array::from_iter_values(rows().map(|row| row / 2 % 2)))),
        ("sensor", Arc::new(Int32Array::from_iter_values(rows().map(|row| row % 2)))),
        ("x", Arc::new(Float64Array::from_iter_values(rows().map(|row| f64::from(row) * 0.1)))),
    ];
    let line = |row: i32| format!("{},{},{},{}\n", row / 4 * 10, row / 2 % 2, row % 2, f64::from(row) * 0.1);
    let text = rows().map(line).fold("t_ms,bus,sensor,x\n".to_owned(), |text, line| text + &line);
    for content in tables(&log).into_iter().chain([text.into_bytes()]) {
        let read = |said: &str| all(&content, ColumnSelection::One(Some("x")), said);
        let said = read("--time-column t_ms").unwrap_err().to_string();
        assert!(said.contains("columns `bus`, `sensor` are 0-0 (100 Hz), 0-1 (100 Hz), 1-0 (100 Hz)"), "{said}");
        assert!(said.contains("rows of 4 sensors") && said.contains("--where bus=0,sensor=0 to read one"), "{said}");
        let said = read("--time-column t_ms --where bus=1").unwrap_err().to_string();
        assert!(said.contains("--where bus=1,sensor=0 to read one"), "{said}");
        let x = &read("--time-column t_ms --where bus=1,sensor=0").unwrap()[0];
        assert_eq!((x.rate_hz, x.series.len(), super::tests::numbers(x)[1]), (100.0, 200, 0.1 * 6.0));
        let none = read("--time-column t_ms --where bus=1,sensor=7").unwrap_err().to_string();
        assert!(none.contains("column `bus` is `1` and `sensor` is `7` in no row"), "{none}");
    }
}

/// All rows of one sensor are above those of the next. Numbers tell the sensors apart in a log whose first rows are of
/// one sensor only, and names in a short log.
#[test]
fn rows_of_sensors_in_blocks() {
    let log = |names: [&str; 2], rows: usize| {
        let line = |row: usize| format!("{},{},0.{}\n", row * 10, names[row / (rows / 2)], row * 7919 % 101);
        (0..rows).map(line).fold("t_ms,imu,x\n".to_owned(), |text, line| text + &line)
    };
    for (names, rows) in [(["1", "2"], 6000), (["left", "right"], 40)] {
        let text = log(names, rows);
        let said = all(text.as_bytes(), ColumnSelection::All, "").unwrap_err().to_string();
        assert!(said.contains(&format!("--where imu={} to read one", names[0])), "{said}");
    }
    let same = log(["1", "1"], 600);
    assert_eq!(all(same.as_bytes(), ColumnSelection::All, "").unwrap().len(), 2);
}

/// Rows of two sensors in no order and without a time. The name of the column and the different noise show the
/// sensors.
#[test]
fn rows_of_sensors_in_no_order() {
    let log = |name: &str| {
        let line = |row: usize| {
            let (which, number) = (row * row * 31 % 97 % 2, (row * 7919 % 101) as f64 - 50.0);
            format!("{},{:.3}\n", ["a", "b"][which], number * [0.1, 0.3][which])
        };
        (0..2000).map(line).fold(format!("{name},x\n"), |text, row| text + &row)
    };
    let said = all(log("sensor").as_bytes(), ColumnSelection::All, "--rate 100").unwrap_err().to_string();
    assert!(said.contains("column `sensor` is a, b in turn") || said.contains("is b, a in turn"), "{said}");
    assert_eq!(all(log("state").as_bytes(), ColumnSelection::All, "--rate 100").unwrap().len(), 1);
}

/// The first of two logs in one file is read up to the time that the refusal states.
#[test]
fn two_logs_in_one_file() {
    let line = |row: usize| format!("{},0.{}\n", row % 300 * 10, row * 7919 % 101);
    let text = (0..600).map(line).fold("t_ms,x\n".to_owned(), |text, line| text + &line);
    let mut options = options("");
    let mut read = |until: Option<&str>| {
        options.cut.until = until.map(|until| until.parse().unwrap());
        read_all(Path::new("log"), text.clone().into_bytes().into(), ColumnSelection::All, &options)
    };
    let said = read(None).unwrap_err().to_string();
    assert!(said.contains("--until 2.99 reads the first"), "{said}");
    assert_eq!(read(Some("2.99")).unwrap()[0].series.len(), 299);
}

#[test]
fn columns_of_text() {
    let text = "x,t_ms,word,y,z_dps\n1,0,a,5,0.5\n2,10,b,,0.25\n3,30,c,7,-0.5\n4,40,d,8,1.0";
    let columns = same(text.as_bytes(), &["y", "x", "z_dps"], "--time-column t_ms");
    assert_eq!(columns[0].gaps, [Gap { at: 1, missing: 2 }]);
    assert_eq!((&columns[1].series, columns[1].missing()), (&Series::Codes(vec![1, 2, 3, 4]), 1));
    assert_eq!(all(text.as_bytes(), ColumnSelection::All, "--time-column t_ms").unwrap().len(), 3);
    // a last line with an empty cell is kept; a last line with too few cells is dropped
    let cut = all("x,y\n1,2\n3,4\n5,".as_bytes(), ColumnSelection::All, "--rate 1").unwrap();
    assert_eq!(cut.iter().map(|column| column.series.len()).collect::<Vec<_>>(), [3, 2]);
    let cut = all("x,y\n1,2\n3,4\n5".as_bytes(), ColumnSelection::All, "--rate 1").unwrap();
    assert_eq!(cut.iter().map(|column| column.series.len()).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn columns_of_arrays() {
    let data: Vec<u8> = (0..24i16).flat_map(|number| (number * 3).to_le_bytes()).collect();
    for order in ["False", "True"] {
        let array = npy(&format!("{{'descr': '<i2', 'fortran_order': {order}, 'shape': (6, 4), }}"), &data);
        let columns = same(&array, &["3", "0", "2"], "--time-column 1 --time-unit s");
        let expected = if order == "True" { [54, 57, 60] } else { [9, 21, 33] };
        assert!(matches!(&columns[0].series, Series::Codes(codes) if codes[..3] == expected), "{columns:?}");
        assert_eq!(all(&array, ColumnSelection::All, "--rate 1").unwrap().len(), 4);
    }
    let fields = "[('t', '<u2'), ('name', '|S2'), ('x', '>i2'), ('y', '<f4'), ('more', '|S2')]";
    let array = npy(&format!("{{'descr': {fields}, 'fortran_order': False, 'shape': (4,), }}"), &data);
    same(&array, &["y", "x"], "--rate 5");
    assert_eq!(
        all(&array, ColumnSelection::All, "--time-column t --time-unit s").map(|columns| columns.len()).unwrap(),
        2
    );
}

#[test]
fn quantities_of_bags() {
    let mcap = mcap_packed(None, &["/imu"], "cdr", |i| imu(true, false, i * 10_000_000, i as f64));
    for bag in [mcap, sqlite_bag()] {
        let columns = same(&bag, &["z", "x", "linear_acceleration.y"], "");
        assert_eq!(
            (columns[1].name.as_str(), columns[1].quantity),
            ("/imu.angular_velocity.x", Some(Quantity::AngularRate))
        );
        assert_eq!(
            (columns[2].name.as_str(), columns[2].quantity),
            ("/imu.linear_acceleration.y", Some(Quantity::Acceleration))
        );
        assert_eq!(all(&bag, ColumnSelection::All, "").unwrap().len(), 6);
    }
    let two = mcap_packed(None, &["/one", "/two"], "cdr", |i| imu(true, false, i * 10_000_000, i as f64));
    let names = ["/one.angular_velocity.x", "/two.angular_velocity.x"].map(str::to_owned);
    assert!(all(&two, ColumnSelection::Listed(&names), "").unwrap_err().to_string().contains("two topics"));
}

/// A table that does not describe itself has no temperature beside the columns that are asked for.
#[test]
fn a_table_has_no_temperature_beside_its_columns() {
    let parts = vec![(PathBuf::from("log"), Input::from(b"temp_c,x\n1,2\n3,4\n".to_vec()))];
    let (_, beside) =
        read_with_temperature(Path::new("log"), parts, ColumnSelection::One(Some("x")), &options("--rate 1")).unwrap();
    assert_eq!(beside, None);
}

#[test]
fn a_column_is_chosen_once_and_by_a_name_that_exists() {
    let error = |wanted: &[&str]| {
        let wanted: Vec<String> = wanted.iter().map(|name| (*name).to_owned()).collect();
        all(b"x,y,t\n1,2,3\n4,5,6\n", ColumnSelection::Listed(&wanted), "--time-column t").unwrap_err().to_string()
    };
    assert!(error(&["x", "w"]).contains("no column `w`"));
    assert!(error(&["x", "x"]).contains("asked twice for `x`"));
    assert!(error(&["x", "t"]).contains("both time and rate in `t`"));
    assert!(error(&[]).contains("no column of numbers"));
}

#[test]
fn the_memory_of_all_columns_is_counted() {
    let one = SeriesBuilder::sharing(zerorate_input::limits::MemoryBudget::of(0), 1);
    let eight = SeriesBuilder::sharing(zerorate_input::limits::MemoryBudget::of(0), 8);
    let rows = zerorate_input::limits::FREE_BYTES / 16;
    assert!(one.check_room(rows).is_ok() && one.check_room(rows + 1).is_err());
    assert!(eight.check_room(rows / 8).is_ok() && eight.check_room(rows / 8 + 1).is_err());
}

/// Equal sensors on one clock, two rows of each in turn, and a counter of the samples in packets of ten.
#[test]
fn rows_of_sensors_in_groups_and_counted_rows() {
    let log = |name: &str, value: &dyn Fn(usize) -> usize| {
        let line = |row: usize| format!("{},{},0.{}\n", row * 10, value(row), row * 7919 % 101);
        (0..2000).map(line).fold(format!("t_ms,{name},x\n"), |text, row| text + &row)
    };
    let groups = log("port", &|row| row / 2 % 2);
    let said = all(groups.as_bytes(), ColumnSelection::All, "").unwrap_err().to_string();
    assert!(said.contains("give --where port=0 to read one (with --rate 50), or"), "{said}");
    let x = &all(groups.as_bytes(), ColumnSelection::All, "--where port=0 --rate 50").unwrap()[0];
    assert_eq!((x.rate_hz, x.series.len(), x.missing()), (50.0, 1000, 0));
    let counted = log("idx", &|row| row % 10);
    let said = all(counted.as_bytes(), ColumnSelection::All, "").unwrap_err().to_string();
    assert!(said.contains("or --where 'idx=*' if all rows are of one sensor"), "{said}");
    let x = &all(counted.as_bytes(), ColumnSelection::All, "--where idx=*").unwrap()[0];
    assert_eq!((x.rate_hz, x.series.len(), x.missing()), (100.0, 2000, 0));
    assert_eq!(all(log("heater", &|row| row / 50 % 2).as_bytes(), ColumnSelection::All, "").unwrap().len(), 2);
}
