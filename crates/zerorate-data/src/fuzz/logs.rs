//! Logs of every form that `zerorate allan` reads.

use super::edited;
use crate::capture::{Row, axes};
use crate::column::tests::options;
use crate::column::{self, ColumnOptions, PartLog, tests as forms};
use crate::limits::Room;
use arrow_array::RecordBatch;
use arrow_array::types::Int8Type;
use arrow_array::{ArrayRef, DictionaryArray, Float64Array, Int32Array, TimestampNanosecondArray};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
use arrow_schema::{DataType, Field, Schema};
use mcap::Compression as Chunks;
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use std::path::Path;
use std::sync::Arc;

/// Reads a log in each of these ways. What it is taken for is up to the log; what comes out fits into the room that it
/// has.
fn read(bytes: &[u8], ways: &[&str]) {
    for way in ways {
        let read = column::read(Path::new("edited"), bytes.to_vec().into(), &options(way));
        if let Ok(column) = read {
            let room = Room::of(bytes.len() as u64);
            assert_eq!(room.check(8 * column.series.len() as u64), Ok(()), "{way}");
            assert!(column.rate_hz > 0.0 || column.rate_hz.is_nan(), "{way}: {} Hz", column.rate_hz);
        }
    }
}

/// As the log of a part: times increase, and every row has all codes of its scales.
fn read_as_part(bytes: &[u8]) {
    let part = axes::part();
    let Ok(log) = PartLog::open(Path::new("edited"), bytes.to_vec().into(), &part, &ColumnOptions::default()) else {
        return;
    };
    let rows: Vec<Row> = log.collect();
    assert!(rows.is_sorted_by(|one, next| one.t_ns < next.t_ns));
    let code = |code: &i64| (-32_768..=32_767).contains(code);
    assert!(rows.iter().all(|row| row.codes().len() == 3 && row.codes().iter().all(code)));
}

#[test]
fn of_a_part() {
    let texts = [
        "t_ms,x,y,z,temp\n0,1,-2,3,4\n10,5,,-7,8\n40,9,10,11,\n50,12,13,14,15\n",
        "time [s];x_dps;y [rad/s];z;temp_c\n0;0,05;0,0001;3;25,5\n0,01;-1,5;-0,002;4;26\n0,02;1;0;5;27\n",
    ];
    edited(1500, &texts.map(|text| text.as_bytes().to_vec()), read_as_part);
}

fn columns() -> Vec<(&'static str, ArrayRef)> {
    let times: Vec<i64> = (0..40).map(|i| 1_700_000_000_000_000_000 + i * 10_000_000).collect();
    let words = DictionaryArray::<Int8Type>::from_iter((0..40).map(|i| ["a", "b"].get(i % 3).copied()));
    vec![
        ("t", Arc::new(TimestampNanosecondArray::from(times))),
        ("x", Arc::new(Float64Array::from_iter((0..40).map(|i| (i % 7 != 3).then_some(f64::from(i) * 0.5))))),
        ("n", Arc::new(Int32Array::from_iter_values((0..40).map(|i| i * i - 90)))),
        ("word", Arc::new(words)),
    ]
}

fn table() -> RecordBatch {
    let columns = columns();
    let fields: Vec<Field> = columns
        .iter()
        .map(|(name, column)| Field::new(*name, column.data_type().clone(), *name != "n"))
        .chain([Field::new("none", DataType::Null, true)])
        .collect();
    let none: ArrayRef = Arc::new(arrow_array::NullArray::new(40));
    let arrays = columns.into_iter().map(|(_, column)| column).chain([none]).collect();
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).expect("a batch")
}

const OF_TABLES: &[&str] = &["--column x --time-column t", "--column n --rate 10"];

#[test]
fn text() {
    let texts = [
        "0.5\nnan\n-1.25\n3\n",
        "\u{FEFF}t_ns,gz_rad_s\r\n0,0.5\r\n10000000,NaN\r\n20000000,-1.25\r\n",
        "# made by x\n\"t, s\",\"gz\"\n1,\"0.5\"\n2,\"\"\n3,\"-1.25\"\n4,\"3\"\n",
        "t;gz\n1;0,5\n2;\n3;-1,25\n4;3\n",
        "  1   0.5\n  2   null\n% note\n  3   -1.25\n  4   3.0\n",
        "2024-01-02 03:04:05,0.5\n2024-01-02 03:04:06,\n2024-01-02 03:04:07,-1.25\n",
        "t_s,x\n0,1\n1,2\n2,4\n9000000000,5\n",
        "\"gx\" \"gy\"\n\"1\" 0.5 0.25\n\"2\" -1 0.5\n\"3\" 0 1.5\n",
        "boot v1\nready\nt,gx\nms,deg/s\n0,0.5\n10,0.2\n1\n20,0.125,7\n",
        "gz\n0,5\n-1,25\n3\n2,0\n",
        "t,x\n4294967290,1\n4294967295,2\n4,3\n4,3\n9,4\n19,5\n14,6\n24,7\n",
    ];
    let texts = texts.map(|text| text.as_bytes().to_vec()).to_vec();
    let ways = &["--rate 10", "--column 1 --time-column 0 --time-unit s", "--column 1 --decimal comma --rate 1"];
    edited(700, &texts, |bytes| read(bytes, ways));
}

#[test]
fn npy() {
    let data: Vec<u8> = (0..96).collect();
    let arrays = [
        ("'<f8'", "False", "(12,)"),
        ("'>i2'", "True", "(24, 2)"),
        ("'<M8[ms]'", "False", "(12,)"),
        ("[('t', '<M8[ms]'), ('ok', '|u1'), ('z', '>f4', (2,)), ('name', '<U2')]", "False", "(3,)"),
    ];
    let arrays = arrays.map(|(descr, order, shape)| {
        forms::npy(&format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}"), &data)
    });
    edited(700, &arrays, |bytes| read(bytes, &["--rate 10", "--column 1 --time-column 0"]));
}

#[test]
fn raw() {
    let seeds = vec![(0..=255).collect(), [1.5f64, -2.5, f64::NAN].map(f64::to_le_bytes).concat()];
    let ways = &["--rate 10 --raw i16", "--rate 10 --raw i32", "--rate 10 --raw f32", "--rate 10 --raw f64"];
    edited(200, &seeds, |bytes| read(bytes, ways));
}

#[test]
fn parquet() {
    let packings = [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::LZ4_RAW,
        Compression::GZIP(Default::default()),
        Compression::ZSTD(ZstdLevel::default()),
    ];
    let files = packings.map(|packing| {
        let batch = table().project(&[0, 1, 2]).expect("three columns");
        let properties = WriterProperties::builder().set_compression(packing).set_max_row_group_row_count(Some(16));
        let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties.build())).expect("a writer");
        writer.write(&batch).expect("rows");
        writer.into_inner().expect("a file")
    });
    edited(700, &files, |bytes| read(bytes, OF_TABLES));
}

fn packings() -> [IpcWriteOptions; 3] {
    let packed = |packing| IpcWriteOptions::default().try_with_compression(Some(packing)).expect("it can be packed");
    [IpcWriteOptions::default(), packed(CompressionType::LZ4_FRAME), packed(CompressionType::ZSTD)]
}

#[test]
fn arrow_file() {
    let files = packings().map(|options| {
        let batch = table();
        let mut writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options).expect("a writer");
        writer.write(&batch).expect("rows");
        writer.into_inner().expect("a file")
    });
    edited(900, &files, |bytes| read(bytes, OF_TABLES));
}

#[test]
fn arrow_stream() {
    let streams = packings().map(|options| {
        let batch = table();
        let mut writer = StreamWriter::try_new_with_options(Vec::new(), &batch.schema(), options).expect("a writer");
        writer.write(&batch).expect("rows");
        writer.into_inner().expect("a stream")
    });
    edited(900, &streams, |bytes| read(bytes, OF_TABLES));
}

#[test]
fn mcap_bag() {
    let chunks = [Some(Chunks::Zstd), Some(Chunks::Lz4), None];
    let bags = chunks.map(|packing| {
        forms::mcap_packed(packing, &["/imu"], "cdr", |i| forms::imu(true, false, i * 10_000_000, i as f64))
    });
    edited(900, &bags, |bytes| read(bytes, &["--column z", "--column x --rate 10"]));
}

#[test]
fn sqlite_bag() {
    edited(150, &[forms::sqlite_bag()], |bytes| read(bytes, &["--column z"]));
}

/// What other people's writers made, and pieces of it that tests of the forms know.
#[test]
fn of_others() {
    let files = [forms::ROSBAG, forms::ROSBAG_BZ2, forms::ROSBAG_LZ4].map(<[u8]>::to_vec);
    edited(300, &files, |bytes| read(bytes, &["--column z", "--column x --rate 10"]));
    let files = [forms::NPZ, forms::NPZ_PACKED].map(<[u8]>::to_vec);
    edited(250, &files, |bytes| read(bytes, &["--column gz_rad_s --time-column t_ns", "--column gyro.1 --rate 10"]));
    let files = [forms::MAT, forms::MAT_PACKED].map(<[u8]>::to_vec);
    edited(300, &files, |bytes| {
        read(bytes, &["--column gz --time-column t --time-unit s", "--column imu.gx --rate 10"])
    });
    let files = [forms::HDF5, forms::HDF5_LATEST].map(<[u8]>::to_vec);
    let ways = &["--column imu/gz --time-column t_s", "--column imu/gyro.1 --rate 10", "--column table.gz --rate 10"];
    edited(300, &files, |bytes| read(bytes, ways));
    edited(100, &[forms::MAT_73.to_vec()], |bytes| read(bytes, &["--column gz --time-column t --time-unit s"]));
    let ways = &["--column sensor_gyro#1.z", "--column sensor_combined.gyro_rad[2] --rate 10"];
    edited(300, &[forms::ULOG.to_vec()], |bytes| read(bytes, ways));
}

#[test]
fn wide_text() {
    let text = "t_ms;gz_dps\r\n0;0,5\r\n10;0,25\r\n20;1,5\r\n";
    let wide = |to_bytes: fn(u16) -> [u8; 2]| {
        "\u{FEFF}"
            .chars()
            .chain(text.chars())
            .collect::<String>()
            .encode_utf16()
            .flat_map(to_bytes)
            .collect::<Vec<u8>>()
    };
    edited(300, &[wide(u16::to_le_bytes), wide(u16::to_be_bytes)], |bytes| {
        read(bytes, &["--column 1 --time-column 0"])
    });
}

#[test]
fn packed() {
    let packed = vec![
        forms::GZIP.to_vec(),
        forms::XZ.to_vec(),
        forms::ZSTD.to_vec(),
        zstd::encode_all(forms::sqlite_bag().as_slice(), 1).expect("it can be packed"),
    ];
    edited(500, &packed, |bytes| read(bytes, &["--rate 10"]));
}
