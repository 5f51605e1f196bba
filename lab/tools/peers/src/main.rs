//! Times zerorate and the crates `allan` and `allan-tools` on the rates in a file of little-endian f64. Prints a JSON
//! object per run.
//!
//! `peers generate DATA SAMPLES` makes the file, and `peers time DATA` measures times. `peers memory DATA` computes
//! the overlapping Allan deviation once and prints the peak memory.

use rand_distr::{Distribution, Normal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use serde_json::json;
use std::hint::black_box;
use std::time::Instant;
use zerorate_allan::{Input, Stat, deviations, octaves};

/// Number of runs of zerorate. The fastest run counts, because each is short.
const REPEATS: usize = 7;
/// Number of samples of the short record: 150 s at 5.7 kSPS.
const SHORT: usize = 855_000;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["generate", path, samples] => generate(path, samples.parse().expect("a number of samples")),
        ["time", path] => time(&read(path)),
        ["memory", path] => memory(&read(path)),
        _ => panic!("usage: peers generate DATA SAMPLES | peers time DATA | peers memory DATA"),
    }
}

/// Writes white noise of a gyroscope, °/s, to a file. The speed of the analysis does not depend on the values.
fn generate(path: &str, samples: usize) {
    let normal = Normal::new(0.0, 0.5).expect("a positive deviation");
    let rate = normal.sample_iter(Xoshiro256PlusPlus::seed_from_u64(1)).take(samples);
    std::fs::write(path, rate.flat_map(f64::to_le_bytes).collect::<Vec<u8>>()).expect("room for the data");
}

fn time(rate: &[f64]) {
    // the codes of a 24-bit part, with a step of 1/23488 °/s
    let codes: Vec<i32> = rate.iter().map(|rate| (rate * 23_488.0).round() as i32).collect();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| zerorate(rate, &codes, threads));
    }
    crates(rate);
}

fn read(path: &str) -> Vec<f64> {
    let bytes = std::fs::read(path).expect("the data file");
    let (numbers, _) = bytes.as_chunks::<8>();
    numbers.iter().map(|number| f64::from_le_bytes(*number)).collect()
}

/// 100 averaging factors from 1 to a third of the record, evenly spaced in the logarithm, without duplicates.
fn hundred(samples: usize) -> Vec<u64> {
    let top = (samples as f64 / 3.0).ln();
    let mut lengths: Vec<u64> = (0..100).map(|i| (top * f64::from(i) / 99.0).exp().round() as u64).collect();
    lengths.dedup();
    lengths
}

/// The averaging factors of `--taus fine`: 1, 2, 3, then four per octave.
fn fine(samples: usize) -> Vec<u64> {
    let octaves = (0..60).flat_map(|k| (4..8).map(move |quarter| quarter << k));
    (1..4).chain(octaves).take_while(|m| 2 * m <= samples as u64).collect()
}

/// Averaging factors 1, 2, 4, 10, 20, 40 … up to `longest`. The crate `allan` does not support denser factors.
fn decades(longest: u64) -> Vec<u64> {
    let decade = std::iter::successors(Some(1), |step| Some(step * 10)).take_while(|step| *step <= longest);
    decade.flat_map(|step| [step, 2 * step, 4 * step]).filter(|m| *m <= longest).collect()
}

fn zerorate(rate: &[f64], codes: &[i32], threads: usize) {
    let who = format!("zerorate, {threads} thread{}", if threads == 1 { "" } else { "s" });
    let long = octaves(rate.len());
    let run = |work: &str, input: Input<'_>, stat: Stat, m: &[u64]| {
        let mut dev = Vec::new();
        let seconds = best(REPEATS, || dev = values(&input, stat, m));
        println!("{}", json!({"who": who, "work": work, "seconds": seconds, "dev": dev}));
    };
    run("oadev", Input::Rate(rate), Stat::Oadev, &long);
    run("oadev of codes", Input::Codes { codes, gaps: &[] }, Stat::Oadev, &long);
    run("oadev, 100 times", Input::Rate(rate), Stat::Oadev, &hundred(rate.len()));
    run("oadev, fine", Input::Rate(rate), Stat::Oadev, &fine(rate.len()));
    run("oadev, 1-2-4 decades", Input::Rate(rate), Stat::Oadev, &decades(rate.len() as u64 / 3));
    for (work, stat) in [("mdev", Stat::Mdev), ("ohdev", Stat::Ohdev), ("totdev", Stat::Totdev)] {
        run(work, Input::Rate(rate), stat, &long);
    }
    let short = &rate[..SHORT.min(rate.len())];
    run("oadev, short", Input::Rate(short), Stat::Oadev, &octaves(short.len()));
}

fn values(input: &Input<'_>, stat: Stat, m: &[u64]) -> Vec<Option<f64>> {
    deviations(input, 1.0, stat, m).into_iter().map(|found| found.ok().map(|found| found.dev)).collect()
}

fn crates(rate: &[f64]) {
    let rates = rate.to_vec();
    let taus: Vec<f64> = octaves(rate.len()).iter().map(|m| *m as f64).collect();
    let seconds = best(1, || {
        black_box(allan_tools::deviation(&rates, &taus, allan_tools::Deviation::Allan, 1.0, true, true).is_ok());
    });
    println!("{}", json!({"who": "crate allan-tools", "work": "oadev", "seconds": seconds}));
    let config = allan::Config::new()
        .style(allan::Style::Decade124)
        .max_tau(rate.len() / 3)
        .data_type(allan::DataType::Frequency);
    let seconds = best(1, || {
        let mut running = config.build_allan();
        rate.iter().for_each(|rate| running.record(*rate));
        black_box(running.get(1).and_then(|tau| tau.deviation()));
    });
    println!("{}", json!({"who": "crate allan", "work": "oadev, 1-2-4 decades", "seconds": seconds}));
}

fn best(repeats: usize, mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..repeats).map(time).fold(f64::INFINITY, f64::min)
}

/// Peak resident memory of reading and computing, as a multiple of the input's size.
fn memory(rate: &[f64]) {
    let before = peak_bytes("VmRSS:");
    black_box(values(&Input::Rate(rate), Stat::Oadev, &octaves(rate.len())));
    let input = size_of_val(rate) as f64;
    let peak = input + (peak_bytes("VmHWM:").max(before) - before);
    println!("{}", json!({"who": "zerorate", "work": "oadev", "memory": peak / input}));
}

/// A value in the kernel's status of this process, bytes.
fn peak_bytes(line: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let value = status.lines().find_map(|text| text.strip_prefix(line)).expect("a line of /proc/self/status");
    value.trim().trim_end_matches(" kB").parse::<f64>().expect("a number of kB") * 1024.0
}
