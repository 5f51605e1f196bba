//! Logs that carry checks, by other people's writers (`fixtures/make_checked.py`): a flipped bit must never pass
//! unnoticed.

use super::tests::{numbers, options};
use super::*;

/// What a log is found to hold: the name and the bits of each column, its rate, and what is said of it.
type Read = (Vec<(String, Vec<u64>)>, u64, Vec<Note>);

fn read(bytes: &[u8], said: &str) -> Result<Read> {
    let columns = read_all(Path::new("log"), bytes.to_vec().into(), Wanted::All, &options(said))?;
    let rate = columns.first().map_or(0, |first| first.rate_hz.to_bits());
    let notes = columns.iter().flat_map(|column| column.warnings.clone()).collect();
    let bits = |column: &Column| numbers(column).into_iter().map(f64::to_bits).collect();
    Ok((columns.iter().map(|column| (column.name.clone(), bits(column))).collect(), rate, notes))
}

/// Flips a bit in so many bytes, spread over the places, and gives those where another result came without a word.
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

/// Flips per file.
const FLIPS: usize = 401;

macro_rules! fixture {
    ($name:literal) => {
        ($name, &include_bytes!(concat!("fixtures/checked/", $name))[..])
    };
}

/// Whatever bit of these files is flipped.
#[track_caller]
fn never_silent(files: &[(&str, &[u8])], said: &str) {
    for (name, file) in files {
        let silent = silent(file, said, 0..file.len());
        assert!(silent.is_empty(), "{name} of {} bytes: {} at {silent:?}", file.len(), silent.len());
    }
}

#[test]
fn of_parquet() {
    for (name, file) in [fixture!("none.parquet"), fixture!("snappy.parquet"), fixture!("zstd.parquet")] {
        // the index behind the pages has no check
        let index = u32::from_le_bytes(*file[file.len() - 8..].first_chunk().unwrap()) as usize + 8;
        let silent = silent(file, "--time-column t_ns", 0..file.len() - index);
        assert!(silent.is_empty(), "{name}: {} at {silent:?}", silent.len());
    }
}

#[test]
fn of_mcap() {
    let files = [fixture!("none.mcap"), fixture!("lz4.mcap"), fixture!("zstd.mcap"), fixture!("flat.mcap")];
    never_silent(&files, "");
}

#[test]
fn of_matlab() {
    never_silent(&[fixture!("packed.mat")], "--time-column t --time-unit s");
}

#[test]
fn of_numpy() {
    never_silent(&[fixture!("stored.npz"), fixture!("packed.npz")], "--time-column t_ns");
}

#[test]
fn of_hdf5() {
    never_silent(&[fixture!("fletcher.h5"), fixture!("gzip.h5"), fixture!("lzf.h5")], "--time-column t_ns");
}

#[test]
fn of_packers() {
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
fn of_bags_of_ros_1() {
    let files = [("bz2", super::tests::ROSBAG_BZ2), ("lz4", super::tests::ROSBAG_LZ4)];
    never_silent(&files, "--topic /imu");
}
