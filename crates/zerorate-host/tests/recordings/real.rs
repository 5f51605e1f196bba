//! A real recording, written and read back in every format.

use super::*;
use arrow_array::{ArrayRef, Int16Array, Int32Array, RecordBatch};
use parquet::arrow::ArrowWriter;
use std::fs::{self, File};
use std::path::PathBuf;
use std::sync::Arc;
use tempfile::TempDir;
use zerorate_logs::Series;
use zerorate_record::{CaptureReader, CaptureWriter, Format, SampleHash};

/// The first 30 000 codes of each gyroscope axis of an ADIS16405 at rest. `None` if the recordings are not there.
fn reference() -> Option<Vec<Vec<i32>>> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ZERORATE_REFERENCE_DATA").map_or(beside, PathBuf::from).join("adis16405");
    if !folder.is_dir() {
        eprintln!("skipped: no reference recordings in {} (set ZERORATE_REFERENCE_DATA)", folder.display());
        return None;
    }
    let options = ColumnOptions { raw: "i16".parse().ok(), rate: Some(100.0), ..ColumnOptions::default() };
    let axis = |axis| {
        let path = folder.join(format!("adis16405_imu1_gyro_{axis}.i16le.xz"));
        let read = zerorate_logs::read(&path, File::open(&path).unwrap().into(), &options).unwrap();
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
fn a_real_log_is_the_same_in_every_form() {
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
