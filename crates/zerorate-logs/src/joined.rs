//! Tests with files joined end to end, as `cat` does. Either the second file is read, or a warning states its size, or
//! an error says that there are two files.

use super::tests::{DATAFLASH, HDF5, HDF5_LATEST, MAT, MAT_73, MAT_PACKED, NPZ, NPZ_PACKED, ROSBAG, ROSBAG_BZ2, ULOG};
use super::tests::{fails, npy, read_file, tables, there};
use super::*;
use arrow_array::{ArrayRef, Float64Array};
use std::sync::Arc;

macro_rules! fixture {
    ($name:literal) => {
        &include_bytes!(concat!("../fixtures/", $name))[..]
    };
}

/// An Arrow stream, an Arrow file and a NumPy array.
fn made() -> Vec<(Vec<u8>, &'static str)> {
    let values = Float64Array::from_iter_values((0..20).map(f64::from));
    let mut all: Vec<_> = tables(&[("gz", Arc::new(values) as ArrayRef)]).into_iter().take(2).collect();
    let data: Vec<u8> = (0..20).flat_map(|n| f64::from(n).to_le_bytes()).collect();
    all.push(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (20,), }", data));
    all.into_iter().map(|bytes| (bytes, "--rate 10")).collect()
}

/// Files whose formats state where the file ends, with the options that read them.
fn with_an_end() -> Vec<(Vec<u8>, &'static str)> {
    let files = [
        (fixture!("nested.mcap"), "--column z"),
        (fixture!("imu_zstd.mcap"), "--column z"),
        (fixture!("checked/none.mcap"), "--column z"),
        (fixture!("checked/flat.mcap"), "--column z"),
        (fixture!("nested.db3"), "--column z"),
        (HDF5, "--column imu/gz --time-column t_s"),
        (HDF5_LATEST, "--column imu/gz --time-column t_s"),
        (fixture!("checked/paged.h5"), "--column x --rate 200"),
        (MAT_73, "--column gz --time-column t --time-unit s"),
    ];
    files.into_iter().map(|(bytes, options)| (bytes.to_vec(), options)).chain(made()).collect()
}

/// The number of bytes behind the end of the first file, according to the warning; `None` without the warning.
fn behind(content: impl AsRef<[u8]>, options: &str) -> Option<u64> {
    let column = read_file(content, options).unwrap();
    column.warnings.iter().find_map(|warning| match warning {
        LogWarning::File(zerorate_input::InputWarning::BytesBehindEnd { bytes, .. }) => Some(*bytes),
        _ => None,
    })
}

#[test]
fn a_file_that_is_filled_up_with_zeros_is_as_good_as_alone() {
    for (bytes, options) in with_an_end() {
        let alone = read_file(&bytes, options).unwrap();
        assert_eq!(behind(&bytes, options), None, "{options}");
        let filled = [&bytes[..], &[0; 5000]].concat();
        let column = read_file(&filled, options).unwrap();
        let codes = |column: &Column| column.warnings.iter().map(LogWarning::code).collect::<Vec<_>>();
        assert_eq!((there(&column), codes(&column)), (there(&alone), codes(&alone)), "{options}");
    }
}

#[test]
fn bytes_behind_the_end_are_counted() {
    let own_head: [(&[u8], &str); 5] = [
        (MAT, "--column gz --time-column t --time-unit s"),
        (MAT_PACKED, "--column gz --time-column t --time-unit s"),
        (ULOG, "--column sensor_gyro#0.z"),
        (ROSBAG, "--column z"),
        (ROSBAG_BZ2, "--column z"),
    ];
    for (bytes, options) in own_head.map(|(bytes, options)| (bytes.to_vec(), options)).into_iter().chain(with_an_end())
    {
        assert_eq!(behind(&bytes, options), None, "{options}");
        for more in [&bytes[..], &[&bytes[..], &bytes].concat()] {
            let said = behind([&bytes[..], more].concat(), options).unwrap_or_default();
            assert_eq!(said, more.len() as u64, "{options}");
        }
        if !bytes.starts_with(b"MATLAB 5") && !bytes.starts_with(b"ULog") && !bytes.starts_with(b"#ROSBAG") {
            assert_eq!(behind([&bytes[..], b"more"].concat(), options), Some(4), "{options}");
        }
    }
}

/// Parquet and `.npz` have their index at the end. Its offsets count from the start of its own file, so the index of
/// the last file would lead to data of the first.
#[test]
fn where_the_first_file_would_be_lost_the_place_of_the_second_is_named() {
    let parquet =
        [fixture!("checked/none.parquet"), fixture!("checked/snappy.parquet"), fixture!("checked/zstd.parquet")];
    for (files, options) in
        [(&parquet[..], "--column x --time-column t_ns"), (&[NPZ, NPZ_PACKED][..], "--column gz_rad_s")]
    {
        for (first, last) in files.iter().flat_map(|first| files.iter().map(move |last| (*first, *last))) {
            let said = fails([first, last].concat(), options);
            assert!(said.contains(&format!("another one follows after its first {} bytes", first.len())), "{said}");
        }
    }
}

/// The readers of text and DataFlash continue behind the joint. The repeated rows are read, or are refused because
/// their times go back.
#[test]
fn joined_texts_are_read_and_joined_logs_are_named() {
    let twice = fails([DATAFLASH, DATAFLASH].concat(), "--column IMU[0].GyrZ");
    assert!(twice.contains("two logs in one file"), "{twice}");
    let text = "gz_dps\n1\n2\n3\n";
    let column = read_file(format!("{text}{text}"), "--rate 10 --max-bad 0.5").unwrap();
    assert_eq!(there(&column).into_iter().flatten().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    assert!(column.warnings.iter().any(|warning| warning.code() == "lines-broken"), "{:?}", column.warnings);
}
