//! A log of a gyroscope with three axes as rows of a capture, by the file of its part and no line of code.

use arrow_array::{ArrayRef, Int16Array, Int32Array, RecordBatch};
use parquet::arrow::ArrowWriter;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use zerorate::Part;
use zerorate_data::Note;
use zerorate_data::capture::{CaptureReader, CaptureWriter, Format, Row, SampleHash};
use zerorate_data::column::{self, ColumnOptions, PartLog, RawType, Series};

/// The scales are those of the data sheet; the log holds no temperature, so that is made up.
const ADIS16405: &str = r#"
    schema = 1
    name = "ADIS16405"
    axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
    rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, signed = true }
    temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12, signed = true }
"#;

fn part() -> Part {
    Part::parse(ADIS16405).unwrap()
}

fn open(content: impl AsRef<[u8]>, part: &Part, args: &ColumnOptions) -> column::Result<PartLog> {
    PartLog::open(Path::new("log"), content.as_ref().to_vec().into(), part, args)
}

fn rows(content: impl AsRef<[u8]>) -> Vec<Row> {
    open(content, &part(), &ColumnOptions::default()).unwrap().collect()
}

#[track_caller]
fn fails(content: impl AsRef<[u8]>, reason: &str) {
    let error = open(content, &part(), &ColumnOptions::default()).unwrap_err().to_string();
    assert!(error.contains(reason), "{error}");
}

#[test]
fn codes_times_and_losses() {
    let found = rows("t_ms,temp,z,x,y\n100,5,3,1,-2\n110,,6,4,-5\n140,7,9,7,-8\n150,8,,0,0\n160,9,12,10,-11\n");
    let row = |t_ms: u64, seq, codes: &[i64]| Row::new(t_ms * 1_000_000, seq, codes).unwrap();
    let expected = [
        row(100, 0, &[1, -2, 3]).with_temp_code(Some(5)),
        row(110, 1, &[4, -5, 6]),
        // two are missing in the time, and the row after them lacks an axis
        row(140, 4, &[7, -8, 9]).with_temp_code(Some(7)).with_lost(2),
        row(160, 6, &[10, -11, 12]).with_temp_code(Some(9)).with_lost(1),
    ];
    assert_eq!(found, expected);
    let log = open("t_ms,temp,z,x,y\n0,5,3,1,-2\n10,5,nan,1,2\n20,5,1,1,2\n", &part(), &ColumnOptions::default());
    let log = log.unwrap();
    let Note { code, text } = &log.warnings()[0];
    assert_eq!(*code, "rows-incomplete");
    assert!(text.contains("1 rows of 3 lack the value of an axis; they count as lost"), "{text}");
}

#[test]
fn a_rate_in_place_of_times() {
    let options = ColumnOptions { rate: Some(3.0), ..ColumnOptions::default() };
    let found: Vec<u64> =
        open("x,y,z,temp\n1,2,3,4\n1,2,3,4\n1,2,3,4\n", &part(), &options).unwrap().map(|row| row.t_ns).collect();
    assert_eq!(found, [0, 333_333_333, 666_666_667]);
}

#[test]
fn values_become_codes() {
    let log = |text: &str| open(text, &part(), &ColumnOptions::default()).unwrap();
    let exact =
        log("t_s,x_dps,y [deg/h],z (rad/s),temp_c\n0,0.05,180,0.0008726646,25\n1,-1.5,-360,0.0017453293,25.14006\n");
    assert_eq!(exact.warnings(), []);
    let codes: Vec<Vec<i64>> = exact.map(|row| [row.codes(), &[row.temp_code.unwrap()]].concat()).collect();
    assert_eq!(codes, [[1, 1, 1, 0], [-30, -2, 2, 1]]);
    let rounded = log("t_s,x_dps,y,z,temp\n0,0.07,0,0,0\n1,0.049,0,0,0\n");
    let said = &rounded.warnings()[0].to_string();
    assert!(said.contains("column x_dps") && said.contains("2.000e-2 °/s at most (0.40 codes)"), "{said}");
    assert_eq!(rounded.map(|row| row.codes()[0]).collect::<Vec<_>>(), [1, 1]);
}

#[test]
fn columns_of_other_names() {
    let text = ADIS16405
        .replace("{ name = \"x\" }", "{ name = \"x\", column = \"gx [rad/s]\" }")
        .replace("zero_c = 25", "zero_c = 25, column = \"T (°C)\"");
    let (part, options) = (Part::parse(&text).unwrap(), ColumnOptions::default());
    let log = open("T (°C);x;gx [rad/s];y;z;stamp [us]\n25;9;0.0;1;2;0\n25;9;0.1;1;2;500\n", &part, &options).unwrap();
    assert_eq!(log.map(|row| (row.t_ns, row.codes()[0])).collect::<Vec<_>>(), [(0, 0), (500_000, 115)]);
    let error = open("temp,x,y,z,t_s\n1,2,3,4,0\n1,2,3,4,1\n", &part, &options).unwrap_err().to_string();
    assert!(error.contains("has no column `gx [rad/s]` for the axis x") && error.contains("column = "), "{error}");
}

#[test]
fn hostile_logs_are_refused_with_the_place() {
    fails("t_s,x,y,temp\n0,1,2,3\n1,1,2,3\n", "has no column `z` for the axis z");
    fails("t_s,x,y,z\n0,1,2,3\n1,1,2,3\n", "has no column `temp` for the temperature");
    fails("t_s,x,y,z_code,z_dps,temp\n0,1,2,3,4,5\n", "several columns that may be the axis z");
    fails("t_s,x,y,z,temp\n0,1,2,3,\n1,1,2,3,nan\n", "no temperature in any row");
    fails("t_s,x,y,z,temp\n0,1,2,nan,1\n1,1,,3,2\n", "no row with all axes");
    fails("t_s,x,y,z,temp\n0,1,2,3,4\n2,1,2,3,4\n1,1,2,3,4\n", "the time goes back");
    fails("t_s,x,y,z,temp\n0,1,2,32768,4\n1,1,2,3,4\n", "column z, row 0: 32768 is beyond the codes of the part");
    fails("t_s,x,y,z_dps,temp\n0,1,2,2000,4\n1,1,2,3,4\n", "16 bits and go from -32768 to 32767");
    fails("t_s,x,y,z,temp\n0,1,2,3,2048\n1,1,2,3,4\n", "column temp, row 0: 2048 is beyond");
    fails("t_s,x,y,z,temp\n0,1,2,0.5,4\n1,1,2,3,4\n", "column z, row 0: 0.5 is no code, and no unit is stated");
    fails("t_s,x,y,z,temp\n0,1,2,inf,4\n1,1,2,3,4\n", "infinite");
    fails("x,y,z,temp\n1,2,3,4\n1,2,3,4\n", "does not say how fast it was sampled");
    fails("t,x,y,z,temp\n1,1,2,3,4\n2,1,2,3,4\n", "does not say how fast it was sampled");
    fails("", "empty");
    let built_in = open("t_s,rate,temp\n0,1,2\n1,1,2\n", &Part::ADIS16130, &ColumnOptions::default());
    assert!(built_in.unwrap_err().to_string().contains("is built in"));
}

/// Three gyroscope axes of a real ADIS16405 at rest.
fn reference() -> Option<Vec<Vec<i32>>> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ZERORATE_REFERENCE_DATA").map_or(beside, PathBuf::from).join("adis16405");
    if !folder.is_dir() {
        eprintln!("skipped: no reference recordings in {} (set ZERORATE_REFERENCE_DATA)", folder.display());
        return None;
    }
    let options = ColumnOptions { raw: Some(RawType::I16), rate: Some(100.0), ..ColumnOptions::default() };
    let axis = |axis| {
        let path = folder.join(format!("adis16405_imu1_gyro_{axis}.i16le.xz"));
        let read = column::read(&path, File::open(&path).unwrap().into(), &options).unwrap();
        let Series::Codes(mut codes) = read.series else { panic!("{axis} holds no codes") };
        codes.truncate(30_000);
        codes
    };
    Some(["x", "y", "z"].map(axis).to_vec())
}

fn simulated_temps(rows: usize) -> Vec<i32> {
    (0..rows).map(|row| (200.0 * (1.0 - (-(row as f64) / 9_000.0).exp())) as i32 + (row * 7 % 3) as i32).collect()
}

fn text_of(axes: &[Vec<i32>], temps: &[i32]) -> Vec<u8> {
    let mut text = "t_ms,temp_code,z,y,x\n".to_owned();
    for (row, temp) in temps.iter().enumerate() {
        text += &format!("{},{temp},{},{},{}\n", row * 10, axes[2][row], axes[1][row], axes[0][row]);
    }
    text.into_bytes()
}

fn parquet_of(axes: &[Vec<i32>], temps: &[i32]) -> Vec<u8> {
    let short =
        |codes: &[i32]| -> ArrayRef { Arc::new(Int16Array::from_iter_values(codes.iter().map(|code| *code as i16))) };
    let times: ArrayRef = Arc::new(Int32Array::from_iter_values((0..temps.len()).map(|row| row as i32 * 10)));
    let columns = [
        ("x_code", short(&axes[0])),
        ("y_code", short(&axes[1])),
        ("z_code", short(&axes[2])),
        ("temp", short(temps)),
        ("time [ms]", times),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.into_inner().unwrap()
}

#[test]
fn a_real_log_in_and_out_of_every_form() {
    let Some(axes) = reference() else { return };
    let temps = simulated_temps(axes[0].len());
    let dir = TempDir::new().unwrap();
    let mut hashes = Vec::new();
    for (form, log) in [("csv", text_of(&axes, &temps)), ("parquet", parquet_of(&axes, &temps))] {
        let path = dir.path().join(format!("log.{form}"));
        fs::write(&path, log).unwrap();
        for format in [Format::Arrows, Format::Parquet, Format::Csv] {
            let input = File::open(&path).unwrap().into();
            let mut log = PartLog::open(&path, input, &part(), &ColumnOptions::default()).unwrap();
            let capture = dir.path().join("capture");
            let out = Box::new(File::create(&capture).unwrap());
            let mut writer = CaptureWriter::create(&capture, out, format, log.info()).unwrap();
            log.by_ref().for_each(|row| writer.push(&row).unwrap());
            assert_eq!((writer.finish().unwrap().lost, log.warnings().len()), (0, 0));
            let mut reader = CaptureReader::open(&capture, File::open(&capture).unwrap().into()).unwrap();
            assert_eq!((reader.info(), reader.info().part_from(&part()).unwrap()), (log.info(), part()));
            let mut hash = SampleHash::new(&reader.info().layout);
            for (row, found) in reader.by_ref().enumerate() {
                let found = found.unwrap();
                let codes = [0, 1, 2].map(|axis| i64::from(axes[axis][row]));
                assert_eq!((found.codes(), found.temp_code), (&codes[..], Some(temps[row].into())), "row {row}");
                assert_eq!((found.t_ns, found.lost), (row as u64 * 10_000_000, 0));
                hash.update(&found);
            }
            assert_eq!(reader.warnings(), []);
            hashes.push(hash.hex());
        }
    }
    hashes.dedup();
    assert_eq!(hashes.len(), 1, "{hashes:?}");
}
