//! Tests that the error for a missing format names the feature that adds it, and does not call the file damaged.

use super::*;
use std::path::Path;
use zerorate_input::NotBuiltIn;

#[track_caller]
fn says(content: &[u8], what: &str, feature: &str) {
    match read(Path::new("log"), content.to_vec().into(), &ColumnOptions::default()) {
        Err(LogError::File(InputError::NotBuiltIn { missing: NotBuiltIn { what: found, feature: adds }, .. })) => {
            assert_eq!((found, adds), (what, feature));
        }
        other => panic!("{what}: {other:?}"),
    }
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn hdf5() {
    says(include_bytes!("../fixtures/imu.h5"), "HDF5", "hdf5");
    says(include_bytes!("../fixtures/imu73.mat"), "HDF5", "hdf5");
}

#[cfg(not(feature = "matlab"))]
#[test]
fn matlab() {
    says(include_bytes!("../fixtures/imu.mat"), "the reader of MATLAB files", "matlab");
}

#[cfg(not(feature = "mcap"))]
#[test]
fn mcap() {
    says(include_bytes!("../fixtures/imu_zstd.mcap"), "MCAP", "mcap");
}

#[cfg(not(feature = "npz"))]
#[test]
fn npz() {
    says(include_bytes!("../fixtures/imu.npz"), "the reader of .npz archives", "npz");
}

#[cfg(not(feature = "numpy"))]
#[test]
fn numpy() {
    says(b"\x93NUMPY\x01\x00", "the reader of NumPy arrays", "numpy");
}

#[cfg(not(feature = "packed"))]
#[test]
fn packed() {
    says(include_bytes!("../fixtures/checked/log.csv.gz"), "gzip", "packed");
    says(include_bytes!("../fixtures/checked/log.csv.bz2"), "bzip2", "packed");
    says(include_bytes!("../fixtures/checked/log.csv.xz"), "xz", "packed");
    says(include_bytes!("../fixtures/checked/log.csv.lz4"), "LZ4", "packed");
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet() {
    says(include_bytes!("../fixtures/checked/none.parquet"), "Parquet", "parquet");
}

#[cfg(not(feature = "ros"))]
#[test]
fn ros() {
    says(include_bytes!("../fixtures/imu_none.bag"), "the reader of ROS 1 bags", "ros");
}

#[cfg(not(feature = "sqlite"))]
#[test]
fn sqlite() {
    says(b"SQLite format 3\0 and no more", "SQLite, in which older ROS 2 bags lie", "sqlite");
}

#[cfg(not(feature = "zstd"))]
#[test]
fn zstd() {
    says(include_bytes!("../fixtures/checked/log.csv.zst"), "Zstandard", "zstd");
}
