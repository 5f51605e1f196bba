//! Damaged logs of other software, in formats with checksums: a bit is flipped, or a bag states a wrong number of
//! messages. `crates/zerorate-logs/fixtures/make_checked.py` made the files, with independent writers.

use super::bench::{Bench, Folder, Run, random};
use super::{Class, ClassRun, Verdict};
use anyhow::{Context, Result};
use rand::RngExt;
use rand::rngs::StdRng;
use std::fs;
use std::path::Path;

const fn class(name: &'static str, what: &'static str, run: ClassRun) -> Class {
    Class { name, what, quick: 10, run }
}

/// The classes. The last word of a name is the name of its file, except `folder`.
pub const CLASSES: &[Class] = &[
    class("log none.parquet", "one bit of a page flips, or of what stands before it", flipped),
    class("log snappy.parquet", "the same, packed by Snappy", flipped),
    class("log zstd.parquet", "the same, packed by Zstandard", flipped),
    class("log none.mcap", "one bit of a bag with checked chunks flips", flipped),
    class("log lz4.mcap", "the same, packed by LZ4", flipped),
    class("log zstd.mcap", "the same, packed by Zstandard", flipped),
    class("log flat.mcap", "one bit of a bag without chunks flips", flipped),
    class("log bz2.bag", "one bit of a bag of ROS 1 flips, packed by bzip2", flipped),
    class("log lz4.bag", "the same, packed by LZ4 as ROS does it", flipped),
    class("log packed.mat", "one bit of a packed MATLAB file flips", flipped),
    class("log stored.npz", "one bit of NumPy's arrays flips", flipped),
    class("log packed.npz", "the same, packed", flipped),
    class("log fletcher.h5", "one bit of a checked HDF5 file flips", flipped),
    class("log gzip.h5", "the same, packed by Deflate", flipped),
    class("log lzf.h5", "the same, packed by LZF", flipped),
    class("log log.csv.gz", "one bit of a text in gzip flips", flipped),
    class("log log.csv.bz2", "the same in bzip2", flipped),
    class("log log.csv.xz", "the same in xz", flipped),
    class("log log.csv.lz4", "the same in LZ4", flipped),
    class("log log.csv.zst", "the same in Zstandard", flipped),
    class("log folder", "a bag of ROS 2 in a folder states more messages than it holds, or fewer", miscounted),
];

const FILES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/zerorate-logs/fixtures/checked");

/// Number of messages in each bag.
const MESSAGES: u64 = 120;

fn flipped(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let name = class.rsplit(' ').next().unwrap_or(class);
    let source = Path::new(FILES).join(name);
    let whole = fs::read(&source).with_context(|| source.display().to_string())?;
    let mut random = random(class, seed);
    let mut bytes = whole.clone();
    bytes[random.random_range(0..checked(name, &whole))] ^= 1 << random.random_range(0..8);
    let folder = Folder::new(&format!("{name}-{seed}"))?;
    let file = folder.file(name);
    fs::write(&file, &whole)?;
    let right = analysed(bench, &file)?;
    fs::write(&file, &bytes)?;
    Ok(judged(&analysed(bench, &file)?, &right))
}

/// Number of bytes, from the start, that checksums cover. The index at the end of a Parquet file has no checksum.
fn checked(name: &str, whole: &[u8]) -> usize {
    let index = |at: usize| whole[at..].first_chunk().map_or(0, |length| u32::from_le_bytes(*length) as usize);
    match name.ends_with(".parquet") {
        true => whole.len() - 8 - index(whole.len() - 8),
        false => whole.len(),
    }
}

fn miscounted(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("folder-{seed}"))?;
    fs::copy(Path::new(FILES).join("zstd.mcap"), folder.file("bag.mcap"))?;
    let bag = folder.path().display().to_string();
    let right = stating(bench, &folder, &bag, MESSAGES)?;
    let stated = other(&mut random(class, seed));
    let run = stating(bench, &folder, &bag, stated)?;
    Ok(match judged(&run, &right) {
        Verdict::Right => Verdict::Silent(format!("{stated} messages are stated, and allan says nothing")),
        verdict => verdict,
    })
}

/// A random wrong number of messages.
fn other(random: &mut StdRng) -> u64 {
    let any = random.random_range(0..2 * MESSAGES);
    any + u64::from(any >= MESSAGES)
}

/// Analyses a bag whose description states this number of messages.
fn stating(bench: &Bench, folder: &Folder, bag: &str, messages: u64) -> Result<Run> {
    let text = format!(
        "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - bag.mcap\n  message_count: \
         {messages}\n  topics_with_message_count:\n    - topic_metadata:\n        name: /imu\n        type: \
         sensor_msgs/msg/Imu\n        serialization_format: cdr\n      message_count: {messages}\n"
    );
    fs::write(folder.file("metadata.yaml"), text)?;
    analysed(bench, bag)
}

fn analysed(bench: &Bench, log: &str) -> Result<Run> {
    let time: &[&str] = match log.rsplit('.').next() {
        Some("mat") => &["--time-column", "t", "--time-unit", "s"],
        Some("parquet" | "npz" | "h5" | "gz" | "bz2" | "xz" | "lz4" | "zst") => &["--time-column", "t_ns"],
        _ => &[],
    };
    bench.run(&[&["allan", log, "--column", "all", "--fit", "--json"], time].concat())
}

/// The verdict on a damaged log. The program may read it unchanged, refuse it, or read it with a warning.
fn judged(run: &Run, right: &Run) -> Verdict {
    match run.code {
        Some(1..=3) => Verdict::Refused,
        Some(0) if run.stderr != right.stderr => Verdict::Warned,
        Some(0) if run.stdout == right.stdout => Verdict::Right,
        code => Verdict::Silent(format!("allan ends with {code:?}: {}", run.stderr)),
    }
}
