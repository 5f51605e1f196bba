//! Tests that the error for a missing format names the feature that adds it, and does not call the file damaged.

use super::*;
use std::path::Path;
use zerorate_input::NotBuiltIn;

macro_rules! fixture {
    ($name:literal) => {
        &include_bytes!(concat!("../fixtures/", $name))[..]
    };
}

#[test]
fn a_missing_format_names_its_feature() {
    for (is_there, feature, what, content) in [
        (cfg!(feature = "hdf5"), "hdf5", "HDF5", fixture!("imu.h5")),
        (cfg!(feature = "hdf5"), "hdf5", "HDF5", fixture!("imu73.mat")),
        (cfg!(feature = "matlab"), "matlab", "the reader of MATLAB files", fixture!("imu.mat")),
        (cfg!(feature = "mcap"), "mcap", "MCAP", fixture!("imu_zstd.mcap")),
        (cfg!(feature = "npz"), "npz", "the reader of .npz archives", fixture!("imu.npz")),
        (cfg!(feature = "numpy"), "numpy", "the reader of NumPy arrays", b"\x93NUMPY\x01\x00"),
        (cfg!(feature = "packed"), "packed", "gzip", fixture!("checked/log.csv.gz")),
        (cfg!(feature = "packed"), "packed", "bzip2", fixture!("checked/log.csv.bz2")),
        (cfg!(feature = "packed"), "packed", "xz", fixture!("checked/log.csv.xz")),
        (cfg!(feature = "packed"), "packed", "LZ4", fixture!("checked/log.csv.lz4")),
        (cfg!(feature = "parquet"), "parquet", "Parquet", fixture!("checked/none.parquet")),
        (cfg!(feature = "ros"), "ros", "the reader of ROS 1 bags", fixture!("imu_none.bag")),
        (
            cfg!(feature = "sqlite"),
            "sqlite",
            "SQLite, in which older ROS 2 bags lie",
            b"SQLite format 3\0 and no more",
        ),
        (cfg!(feature = "zstd"), "zstd", "Zstandard", fixture!("checked/log.csv.zst")),
    ] {
        match read(Path::new("log"), content.to_vec().into(), &ColumnOptions::default()) {
            _ if is_there => {}
            Err(LogError::File(InputError::NotBuiltIn { missing, .. })) => {
                assert_eq!(missing, NotBuiltIn { what, feature });
            }
            other => panic!("{what}: {other:?}"),
        }
    }
}
