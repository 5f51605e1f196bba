//! `cargo xtask proofs`: searches for undefined behaviour and data races, with tools that watch the tests.

mod asan;
mod miri;
mod nightly;
mod tsan;
mod valgrind;

use anyhow::{Context, Result};
use clap::ValueEnum;
use std::time::Instant;

/// The folder for the builds and logs of this task. Each build has its own folder below it.
const WORK: &str = "target/proofs";

#[derive(clap::Args)]
pub struct ProofsArgs {
    /// The parts [default: all]
    #[arg(value_enum)]
    parts: Vec<Part>,
    /// Run as a step of the test: the quick half of `miri`, and five million calls of `asan`
    #[arg(long, conflicts_with = "parts")]
    check: bool,
    /// The seed of the calls of `asan`
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// A tool, and what it watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Tests of driver, core and C interface in Miri, on a processor of 32 bits
    Miri,
    /// The C library and its callers with AddressSanitizer, the callers with UBSan too: examples, and random calls
    Asan,
    /// Tests of the hub, its queues, the libiio server and the page's server with ThreadSanitizer
    Tsan,
    /// Tests of the Python package in valgrind
    Valgrind,
}

const QUICK: [Part; 2] = [Part::Miri, Part::Asan];

/// Runs the parts. If the tools of a part are missing, prints that and continues.
pub fn run(args: &ProofsArgs) -> Result<()> {
    let all = if args.check { &QUICK[..] } else { Part::value_variants() };
    for part in if args.parts.is_empty() { all } else { &args.parts } {
        let start = Instant::now();
        let done = match part {
            Part::Miri => miri::run(args.check),
            Part::Asan => asan::run(args.check, args.seed),
            Part::Tsan => tsan::run(),
            Part::Valgrind => valgrind::run(),
        };
        done.with_context(|| format!("{part:?}"))?;
        println!("{part:?}: {:.0} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}
