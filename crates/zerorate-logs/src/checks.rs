//! Tests with logs that carry checksums, written by common libraries (`fixtures/make_checked.py`): a flipped bit must
//! never pass unnoticed.

use super::tests::{numbers, options};
use super::*;
use std::path::Path;

/// The content of a log: the name of each column and the bits of its numbers, the bits of the rate, and the warnings.
type Read = (Vec<(String, Vec<u64>)>, u64, Vec<LogWarning>);

fn read(bytes: &[u8], said: &str) -> Result<Read> {
    let columns = read_all(Path::new("log"), bytes.to_vec().into(), ColumnSelection::All, &options(said))?;
    let rate = columns.first().map_or(0, |first| first.rate_hz.to_bits());
    let notes = columns.iter().flat_map(|column| column.warnings.clone()).collect();
    let bits = |column: &Column| numbers(column).into_iter().map(f64::to_bits).collect();
    Ok((columns.iter().map(|column| (column.name.clone(), bits(column))).collect(), rate, notes))
}

/// Flips single bits, spread over `places`. Returns the flips that change the result without an error or a warning.
fn silent(whole: &[u8], said: &str, places: std::ops::Range<usize>) -> Vec<(usize, u32)> {
    let (columns, rate, notes) = read(whole, said).unwrap();
    let flips = std::env::var("ZERORATE_FLIPS").ok().and_then(|flips| flips.parse().ok()).unwrap_or(FLIPS);
    let step = (8 * places.len() / flips).max(1);
    let bits = (8 * places.start..8 * places.end).step_by(step);
    let is_silent = |at: &usize| {
        let mut flipped = whole.to_vec();
        flipped[at / 8] ^= 1 << (at % 8);
        match read(&flipped, said) {
            Err(_) => false,
            Ok((_, _, more)) if more != notes => false,
            Ok((found, found_rate, _)) => (found, found_rate) != (columns.clone(), rate),
        }
    };
    bits.filter(is_silent).map(|at| (at / 8, (at % 8) as u32)).collect()
}

/// Number of bits that are flipped per file, unless `ZERORATE_FLIPS` sets another.
const FLIPS: usize = 401;

macro_rules! fixture {
    ($name:literal) => {
        ($name, &include_bytes!(concat!("../fixtures/checked/", $name))[..])
    };
}

#[track_caller]
fn never_silent(files: &[(&str, &[u8])], said: &str) {
    for (name, file) in files {
        let silent = silent(file, said, 0..file.len());
        assert!(silent.is_empty(), "{name} of {} bytes: {} at {silent:?}", file.len(), silent.len());
    }
}

#[test]
fn flips_in_parquet_are_noticed() {
    for (name, file) in [fixture!("none.parquet"), fixture!("snappy.parquet"), fixture!("zstd.parquet")] {
        // the index behind the pages has no checksum, so no bit of it is flipped
        let index = u32::from_le_bytes(*file[file.len() - 8..].first_chunk().unwrap()) as usize + 8;
        let silent = silent(file, "--time-column t_ns", 0..file.len() - index);
        assert!(silent.is_empty(), "{name}: {} at {silent:?}", silent.len());
    }
}

#[test]
fn flips_in_mcap_are_noticed() {
    let files = [fixture!("none.mcap"), fixture!("lz4.mcap"), fixture!("zstd.mcap"), fixture!("flat.mcap")];
    never_silent(&files, "");
}

#[test]
fn flips_in_matlab_are_noticed() {
    never_silent(&[fixture!("packed.mat")], "--time-column t --time-unit s");
}

#[test]
fn flips_in_numpy_are_noticed() {
    never_silent(&[fixture!("stored.npz"), fixture!("packed.npz")], "--time-column t_ns");
}

#[test]
fn flips_in_hdf5_are_noticed() {
    never_silent(&[fixture!("fletcher.h5"), fixture!("gzip.h5"), fixture!("lzf.h5")], "--time-column t_ns");
}

/// An HDF5 file without Fletcher's checksums in its chunks has checksums only in its object headers and its indices.
/// The index of data set `x` has two pages.
#[test]
fn flips_in_indices_of_hdf5_are_noticed() {
    let (_, file) = fixture!("paged.h5");
    for (signature, length) in [(b"FAHD", 28), (b"FADB", 100), (b"EAHD", 72), (b"EAIB", 100)] {
        let start = file.windows(4).position(|bytes| bytes == signature).unwrap();
        let silent = silent(file, "--rate 200", start..start + length);
        assert!(silent.is_empty(), "{}: {silent:?}", signature.escape_ascii());
    }
}

#[test]
fn flips_in_compressed_text_are_noticed() {
    let files = [
        fixture!("log.csv.gz"),
        fixture!("log.csv.bz2"),
        fixture!("log.csv.xz"),
        fixture!("log.csv.lz4"),
        fixture!("log.csv.zst"),
    ];
    never_silent(&files, "--time-column t_ns");
}

#[test]
fn flips_in_bags_of_ros_1_are_noticed() {
    never_silent(&[fixture!("bz2.bag"), fixture!("lz4.bag")], "");
}

/// Fixtures of several formats and compressions hold the same samples in three columns.
#[test]
fn every_fixture_is_read() {
    let of =
        |file: (&str, &[u8]), said: &str| read(file.1, said).unwrap_or_else(|error| panic!("{}: {error}", file.0));
    let (expected, rate, notes) = of(fixture!("log.csv.gz"), "--time-column t_ns");
    assert_eq!((expected.len(), f64::from_bits(rate), &notes[..]), (3, 200.0, &[][..]));
    let values = |read: &Read| read.0.iter().map(|(_, values)| values.clone()).collect::<Vec<_>>();
    let all: Vec<Vec<u64>> = expected.into_iter().map(|(_, values)| values).collect();
    let texts = [fixture!("log.csv.bz2"), fixture!("log.csv.xz"), fixture!("log.csv.lz4"), fixture!("log.csv.zst")];
    let tables = [fixture!("none.parquet"), fixture!("snappy.parquet"), fixture!("fletcher.h5"), fixture!("lzf.h5")];
    for file in texts.into_iter().chain(tables) {
        assert_eq!(values(&of(file, "--time-column t_ns")), all, "{}", file.0);
    }
    for bag in [fixture!("none.mcap"), fixture!("flat.mcap"), fixture!("bz2.bag"), fixture!("lz4.bag")] {
        let read = of(bag, "");
        assert_eq!((values(&read)[..3].to_vec(), read.2.len()), (all.clone(), 0), "{}", bag.0);
    }
}

#[test]
fn a_damaged_variable_does_not_vanish() {
    let (_, file) = fixture!("packed.mat");
    let (columns, ..) = read(file, "--time-column t --time-unit s").unwrap();
    assert_eq!(columns.len(), 3);
    // flips a bit in the middle of the compressed second variable
    let second = 136 + u32::from_le_bytes(*file[132..].first_chunk().unwrap()) as usize;
    let length = u32::from_le_bytes(*file[second + 4..].first_chunk().unwrap()) as usize;
    let mut flipped = file.to_vec();
    flipped[second + 8 + length / 2] ^= 1;
    let said = read(&flipped, "--time-column t --time-unit s").unwrap_err().to_string();
    assert!(said.contains("variable 2 of a MATLAB file: it cannot be unpacked"), "{said}");
}

/// Turns a chunk of a bag packed with LZ4 into another record. The index then counts more messages than the bag holds.
#[test]
fn a_bag_that_lost_a_chunk_gets_a_warning() {
    let (_, bag) = fixture!("lz4.bag");
    let chunk = bag.windows(4).rposition(|bytes| bytes == b"op=\x05").unwrap() + 3;
    let mut lost = bag.to_vec();
    lost[chunk] = 4;
    let (_, _, notes) = read(&lost, "--rate 200").unwrap();
    assert_eq!(notes.iter().map(LogWarning::code).collect::<Vec<_>>(), ["messages-miscounted"]);
    assert!(notes[0].to_string().contains("states 120 messages of /imu and holds "), "{}", notes[0]);
}
