//! Captures are read as logs: codes with their scale, losses as gaps, and the temperature.

use adis16130::Width;
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::FileWriter;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use zerorate_allan::Gap;
use zerorate_input::{Input, Quantity};
use zerorate_logs::{Column, ColumnOptions, ColumnSelection, Result, read_all, read_table, read_with_temperature};
use zerorate_record::{CaptureInfo, CaptureWriter, Converter, Format, Row};

const FORMATS: &[Format] = &[
    Format::Arrows,
    Format::Csv,
    #[cfg(feature = "full")]
    Format::Parquet,
];

fn options() -> ColumnOptions {
    ColumnOptions { described: Some(zerorate_record::open_described), ..ColumnOptions::default() }
}

fn read(content: &[u8], wanted: ColumnSelection<'_>) -> Result<Vec<Column>> {
    read_all(Path::new("log"), content.to_vec().into(), wanted, &options())
}

/// A capture of 2,500 samples. Some samples have a status or a temperature, and some are lost in between.
fn capture(format: Format) -> Vec<u8> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("capture");
    let info = CaptureInfo::adis16130(Converter { width: Width::Bits24, rate_conversion: 5, temp_conversion: 5 });
    let mut writer = CaptureWriter::create(&path, Box::new(File::create(&path).unwrap()), format, &info).unwrap();
    for i in 0..2_500_u32 {
        let lost = if i > 0 && i.is_multiple_of(1000) { 3 } else { 0 };
        let t_ns = 1_000 + u64::from(i + 3 * (i / 1000)) * 175_667;
        let row = Row::new(t_ns, i, &[i64::from(i.wrapping_mul(2_654_435_761) >> 8)]).unwrap();
        let row = row.with_status((!i.is_multiple_of(5)).then_some(i & 0xFF));
        let row = row.with_temp_code(i.is_multiple_of(3).then(|| (0x00FF_FFFF - i).into()));
        writer.push(&row.with_lost(lost)).unwrap();
    }
    writer.finish().unwrap();
    fs::read(&path).unwrap()
}

#[test]
fn several_columns_in_one_pass_are_each_by_itself() {
    for format in FORMATS {
        let content = capture(*format);
        let names = ["temp_code", "rate_code", "status"].map(str::to_owned);
        let columns = read(&content, ColumnSelection::Listed(&names)).unwrap();
        let alone: Vec<Column> =
            names.iter().map(|name| read(&content, ColumnSelection::One(Some(name))).unwrap().remove(0)).collect();
        // compared as text, because NaN is not equal to itself
        assert_eq!(format!("{columns:?}"), format!("{alone:?}"));
        assert_eq!(columns[1], read(&content, ColumnSelection::All).unwrap().remove(0), "the rates");
    }
}

/// Reading rate and temperature together gives the same columns as reading them separately. A temperature that is
/// itself the requested column is not returned twice.
#[test]
fn the_temperature_of_a_capture_comes_with_its_rate() {
    for format in FORMATS {
        let content = capture(*format);
        let together = |wanted| {
            let parts = vec![(PathBuf::from("log"), Input::from(content.clone()))];
            read_with_temperature(Path::new("log"), parts, wanted, &options()).unwrap()
        };
        let (columns, temperature) = together(ColumnSelection::One(None));
        assert_eq!(columns, read(&content, ColumnSelection::One(None)).unwrap());
        let alone = read(&content, ColumnSelection::One(Some("temp_code"))).unwrap();
        let temperature = temperature.unwrap();
        assert_eq!((&temperature.series, &temperature.gaps), (&alone[0].series, &alone[0].gaps));
        let (asked, beside) = together(ColumnSelection::One(Some("temp_code")));
        assert_eq!((asked[0].name.as_str(), asked.len(), beside), ("temp_code", 1, None));
    }
}

#[test]
fn a_capture_as_a_table_in_memory_keeps_its_scale_and_its_rate() {
    let content = capture(Format::Arrows);
    let batch = StreamReader::try_new(content.as_slice(), None).unwrap().next().unwrap().unwrap();
    let read = |options: ColumnOptions| read_table(Path::new("table"), &batch, ColumnSelection::One(None), &options);
    let column = read(options()).unwrap().remove(0);
    assert_eq!((column.scale, column.quantity), (1.0 / 23_488.0, Some(Quantity::AngularRate)));
    assert!((column.rate_hz / 5692.7 - 1.0).abs() < 1e-3, "{} Hz", column.rate_hz);
    assert!(read(ColumnOptions { rate: Some(1.0), ..ColumnOptions::default() }).is_err(), "not as codes");
}

/// Other software rewrote a capture as an Arrow file. The batches lost their checks, but the description remains.
#[test]
fn a_capture_as_an_arrow_file_keeps_its_scale_and_its_rate() {
    let content = capture(Format::Arrows);
    let batches: Vec<_> = StreamReader::try_new(content.as_slice(), None).unwrap().map(Result::unwrap).collect();
    let mut writer = FileWriter::try_new(Vec::new(), &batches[0].schema()).unwrap();
    batches.iter().for_each(|batch| writer.write(batch).unwrap());
    let file = writer.into_inner().unwrap();
    let column = read(&file, ColumnSelection::One(None)).unwrap().remove(0);
    let original = read(&content, ColumnSelection::One(None)).unwrap().remove(0);
    assert_eq!((column.scale, column.rate_hz, &column.gaps), (original.scale, original.rate_hz, &original.gaps));
    assert_eq!(column.series, original.series);
    assert!(column.warnings.iter().any(|warning| warning.code() == "not-checked"), "{:?}", column.warnings);
}

#[test]
fn losses_of_a_capture_are_gaps() {
    let head = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n# \
        zerorate.temp_conversion = 5\n\
                t_ns,edge_seq,rate_code,status,temp_code,lost\n";
    let read = |rows: &str| read(format!("{head}{rows}").as_bytes(), ColumnSelection::One(None));
    // the 7 samples lost before the first row are not a gap, because the record had not begun
    let rows = "0,1,8388608,8,8400000,7\n10000000,2,8388610,8,,0\n40000000,5,8388609,8,,2\n50000000,6,8388611,8,,0\n";
    let mut column = read(rows).unwrap().remove(0);
    assert_eq!((column.gaps.as_slice(), column.rate_hz), (&[Gap { at: 2, missing: 2 }][..], 100.0));
    assert_eq!((column.scale, column.missing(), column.quantity), (1.0 / 23_488.0, 2, Some(Quantity::AngularRate)));
    column.close_gaps();
    assert_eq!((column.missing(), column.series.len()), (0, 4));
    let why = |rows: &str| read(rows).unwrap_err().to_string();
    let back = why("0,1,8388608,8,,0\n10,2,8388608,8,,0\n10,3,8388608,8,,0\n");
    assert!(back.contains("row 2: t_ns does not increase, from 10 to 10"), "{back}");
    let wide = why("0,1,16777216,8,,0\n");
    assert!(wide.contains("16777216 is not a code of 24 bits"), "{wide}");
}

/// Without the reader of captures, codes would be read as numbers without a unit.
#[test]
fn a_capture_without_its_reader_is_refused() {
    for format in FORMATS {
        let content = capture(*format);
        let why =
            read_all(Path::new("log"), content.into(), ColumnSelection::All, &ColumnOptions::default()).unwrap_err();
        assert!(why.to_string().contains("set `described` to its reader"), "{why}");
    }
}

/// One letter of the description is broken. The codes must not be read as numbers without a unit.
#[test]
fn a_capture_with_a_broken_description_is_refused() {
    for format in FORMATS {
        let mut content = capture(*format);
        let key = b"zerorate.capture_schema";
        let places: Vec<usize> = (0..content.len() - key.len()).filter(|at| content[*at..].starts_with(key)).collect();
        assert!(!places.is_empty());
        places.iter().for_each(|at| content[at + 12] = b'x');
        assert!(read(&content, ColumnSelection::One(Some("rate_code"))).is_err(), "{format:?}");
    }
}
