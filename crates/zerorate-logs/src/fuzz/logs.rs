//! Fuzz tests of logs as text, raw numbers and Arrow.

use super::edited;
use crate::tests::options;
use arrow_array::RecordBatch;
use arrow_array::types::Int8Type;
use arrow_array::{ArrayRef, DictionaryArray, Float64Array, Int32Array, NullArray, TimestampNanosecondArray};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
use std::path::Path;
use std::sync::Arc;
use zerorate_input::limits::MemoryBudget;

/// Reads a log with each of these options. Reading may succeed or fail; a column must fit into the memory limit of the
/// log.
pub fn read(bytes: &[u8], ways: &[&str]) {
    for way in ways {
        let read = crate::read(Path::new("edited"), bytes.to_vec().into(), &options(way));
        if let Ok(column) = read {
            let room = MemoryBudget::of(bytes.len() as u64);
            assert_eq!(room.check(8 * column.series.len() as u64), Ok(()), "{way}");
            assert!(column.rate_hz > 0.0 || column.rate_hz.is_nan(), "{way}: {} Hz", column.rate_hz);
        }
    }
}

pub fn table() -> RecordBatch {
    let times: Vec<i64> = (0..40).map(|i| 1_700_000_000_000_000_000 + i * 10_000_000).collect();
    let words = DictionaryArray::<Int8Type>::from_iter((0..40).map(|i| ["a", "b"].get(i % 3).copied()));
    let columns: [(&str, ArrayRef); 5] = [
        ("t", Arc::new(TimestampNanosecondArray::from(times))),
        ("x", Arc::new(Float64Array::from_iter((0..40).map(|i| (i % 7 != 3).then_some(f64::from(i) * 0.5))))),
        ("n", Arc::new(Int32Array::from_iter_values((0..40).map(|i| i * i - 90)))),
        ("word", Arc::new(words)),
        ("none", Arc::new(NullArray::new(40))),
    ];
    let columns = columns.map(|(name, column)| (name, column, name != "n"));
    RecordBatch::try_from_iter_with_nullable(columns).expect("a batch")
}

pub const OF_TABLES: &[&str] = &["--column x --time-column t", "--column n --rate 10"];

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
        "When,gz\n19-Oct-2023 11:59:59.5 PM,1\n20-Oct-2023 12:00:00 AM,2\n20.10.2023 00:00:00:500,3\n",
        "1:23:45.00 -> gx:0.5, gy=-1\n1:23:45.01 -> gx:1, gy=2\n1:23:45.02 -> gx:.25, gy=nan\n",
        "SampleTimeFine,gz\n100,0.5\n200,0.25\n300,1.5\n",
        "Delta_X\t0,01\nX_Value\tgz\n0,00\t0,5\n0,01\t0,25\n0,02\t1,5\n",
        "t,x\n4294967290,1\n4294967295,2\n4,3\n4,3\n9,4\n19,5\n14,6\n24,7\n",
    ];
    let texts = texts.map(|text| text.as_bytes().to_vec()).to_vec();
    let ways = &["--rate 10", "--column 1 --time-column 0 --time-unit s", "--column 1 --decimal comma --rate 1"];
    edited(700, &texts, |bytes| read(bytes, ways));
}

#[test]
fn raw() {
    let seeds = vec![(0..=255).collect(), [1.5f64, -2.5, f64::NAN].map(f64::to_le_bytes).concat()];
    let ways = &["--rate 10 --raw i16", "--rate 10 --raw i32", "--rate 10 --raw f32", "--rate 10 --raw f64"];
    edited(200, &seeds, |bytes| read(bytes, ways));
    let ways = &["--rate 10 --raw 2xi16be --column 1", "--raw 2xf32be --column 1 --time-column 0 --time-unit s"];
    edited(200, &seeds, |bytes| read(bytes, ways));
}

fn packings() -> Vec<IpcWriteOptions> {
    let count = if cfg!(feature = "zstd") { 2 } else { 1 };
    let packings = [CompressionType::LZ4_FRAME, CompressionType::ZSTD].into_iter().take(count);
    let packed = |packing| IpcWriteOptions::default().try_with_compression(Some(packing)).expect("it can be packed");
    std::iter::once(IpcWriteOptions::default()).chain(packings.map(packed)).collect()
}

#[test]
fn arrow_file() {
    let files = packings().into_iter().map(|options| {
        let batch = table();
        let mut writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options).expect("a writer");
        writer.write(&batch).expect("rows");
        writer.into_inner().expect("a file")
    });
    edited(900, &files.collect::<Vec<_>>(), |bytes| read(bytes, OF_TABLES));
}

#[test]
fn arrow_stream() {
    let streams = packings().into_iter().map(|options| {
        let batch = table();
        let mut writer = StreamWriter::try_new_with_options(Vec::new(), &batch.schema(), options).expect("a writer");
        writer.write(&batch).expect("rows");
        writer.into_inner().expect("a stream")
    });
    edited(900, &streams.collect::<Vec<_>>(), |bytes| read(bytes, OF_TABLES));
}

#[test]
fn wide_text() {
    let text = "\u{FEFF}t_ms;gz_dps\r\n0;0,5\r\n10;0,25\r\n20;1,5\r\n";
    let wide = |to_bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(to_bytes).collect::<Vec<u8>>();
    edited(300, &[wide(u16::to_le_bytes), wide(u16::to_be_bytes)], |bytes| {
        read(bytes, &["--column 1 --time-column 0"])
    });
}
