//! Hostile files in formats that need a feature.

use super::*;
use std::io::{self, Read};

/// A record states a length of 8 GB, and a chunk an unpacked size of 2^62 bytes.
#[test]
fn lengths_in_mcap_are_bounded() {
    let bench = Bench::new();
    let mut bag = b"\x89MCAP0\r\n".to_vec();
    bag.extend(b"\x05");
    bag.extend(8_000_000_000u64.to_le_bytes());
    bag.resize(130, 0);
    bench.write("long.mcap", &bag);
    bench.refuses("allan long.mcap", "long.mcap, as an MCAP file");
    let mut chunk = b"\x89MCAP0\r\n\x06".to_vec();
    let head = [0u64, 0, 1 << 62].map(u64::to_le_bytes).concat();
    let content = [&head[..], &[0; 4], &4u32.to_le_bytes(), b"zstd", &20u64.to_le_bytes(), &[7; 20]].concat();
    chunk.extend((content.len() as u64).to_le_bytes());
    chunk.extend(content);
    bench.write("chunk.mcap", &chunk);
    bench.refuses("allan chunk.mcap", "chunk.mcap, as an MCAP file");
}

/// 200 MiB of the digit 0, compressed to less than 1.5 MB.
#[test]
fn the_packed_size_bounds_the_unpacked_size() {
    let bench = Bench::new();
    let zeros = || io::repeat(b'0').take(200 << 20);
    let mut gz =
        flate2::write::GzEncoder::new(File::create(bench.path("log.gz")).unwrap(), flate2::Compression::fast());
    // many copies of one compressed member of 4 MiB, since a gz file may have several members
    io::copy(&mut io::repeat(b'0').take(4 << 20), &mut gz).unwrap();
    gz.finish().unwrap();
    let member = std::fs::read(bench.path("log.gz")).unwrap();
    bench.write("log.gz", member.repeat(50));
    bench.write("log.zst", zstd::encode_all(zeros(), 1).unwrap());
    for name in ["log.gz", "log.zst"] {
        let size = std::fs::metadata(bench.path(name)).unwrap().len();
        assert!(size < 1_500_000, "{name} has {size} bytes");
    }
    bench.refuses("allan log.gz --rate 10", "log.gz");
    bench.refuses("allan log.zst --rate 10", "log.zst: it grows to more than");
}

/// An SQLite view can run code. This one never ends.
#[test]
fn a_bag_is_tables_and_no_program() {
    let bench = Bench::new();
    let bag = rusqlite::Connection::open(bench.path("bag.db3")).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT);
         INSERT INTO topics VALUES (1, '/imu', 'sensor_msgs/msg/Imu', 'cdr');
         CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)
         SELECT i AS id, 1 AS topic_id, i AS timestamp, zeroblob(1000000000) AS data FROM n;",
    )
    .unwrap();
    drop(bag);
    bench.refuses("allan bag.db3 --column z", "bag.db3, as a ROS 2 bag in SQLite");
}

/// A schema of 200 000 nested groups, which the library parses recursively until the stack overflows.
#[test]
fn the_parent_reports_a_crash_of_the_reader() {
    let bench = Bench::new();
    let depth = 200_000u32;
    // FileMetaData of Parquet in Thrift's compact protocol: version 1, then the list of the schema's elements
    let mut footer = vec![0x15, 0x02, 0x19, 0xFC];
    let mut size = depth + 1;
    while size > 0x7F {
        footer.push(size as u8 | 0x80);
        size >>= 7;
    }
    footer.push(size as u8);
    // repetition: required, name: a, children: 1
    footer.extend([0x35, 0x00, 0x18, 0x01, b'a', 0x15, 0x02, 0x00].repeat(depth as usize));
    // type: INT32, repetition: required, name: x
    footer.extend([0x15, 0x02, 0x25, 0x00, 0x18, 0x01, b'x', 0x00]);
    // number of rows: 0, row groups: none
    footer.extend([0x16, 0x00, 0x19, 0x0C, 0x00]);
    let length = (footer.len() as u32).to_le_bytes();
    let nested = [b"PAR1", footer.as_slice(), &length, b"PAR1"].concat();
    bench.write("nested.parquet", &nested);
    bench.refuses("allan nested.parquet --rate 10", "error: nested.parquet");
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    bench.refuses("correct nested.parquet --cal unit.toml -o out.arrows", "error: nested.parquet");
}

/// Six million equal rows, which take almost no space in a Parquet file.
#[test]
fn rows_of_parquet_are_bounded() {
    use arrow_array::{ArrayRef, Int32Array, RecordBatch};
    let bench = Bench::new();
    let column: ArrayRef = std::sync::Arc::new(Int32Array::from(vec![7; 1 << 20]));
    let batch = RecordBatch::try_from_iter([("x", column)]).unwrap();
    let file = File::create(bench.path("same.parquet")).unwrap();
    let mut writer = parquet::arrow::ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    for _ in 0..6 {
        writer.write(&batch).unwrap();
    }
    writer.close().unwrap();
    bench.refuses("allan same.parquet --rate 10", "same.parquet: it grows to more than");
}
