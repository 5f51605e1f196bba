//! Fuzz tests of logs in the formats that Cargo features add.

use super::edited;
use super::logs::{OF_TABLES, read, table};
use crate::tests as forms;
use mcap::Compression as Chunks;
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;

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

#[test]
fn files_of_other_writers() {
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
    edited(100, &[forms::HDF5_UNITS.to_vec()], |bytes| {
        read(bytes, &["--column gz --time-column Time", "--column ax"])
    });
    edited(100, &[forms::NPZ_FS, forms::MAT_FS].map(<[u8]>::to_vec), |bytes| read(bytes, &["--column gz"]));
    edited(100, &[forms::MAT_73.to_vec()], |bytes| read(bytes, &["--column gz --time-column t --time-unit s"]));
    let ways = &["--column sensor_gyro#1.z", "--column sensor_combined.gyro_rad[2] --rate 10"];
    edited(300, &[forms::ULOG.to_vec()], |bytes| read(bytes, ways));
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
