//! `cargo xtask endurance`: runs `zerorate serve` for a long time, with a recorder and with pages and libiio clients
//! that come and go. Then it runs the tracker, steps the wall clock, and fills and frees a disk.

mod clock;
mod disk;
mod gauge;
mod load;
mod tracker;

use crate::app;
use crate::bench_serve::page;
use crate::bench_serve::samples::CaptureSummary;
use crate::server::{Server, descriptors};
use anyhow::Result;
use gauge::Gauge;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
pub struct EnduranceArgs {
    /// Length of the run in the sensor's time, h
    #[arg(long, default_value_t = 24.0)]
    hours: f64,
    /// How much faster than the clock the sensor's time goes; where the machine cannot, as fast as it can
    #[arg(long, default_value_t = 4.0)]
    speed: f64,
    /// Run as a step of the test: three minutes of the sensor's time
    #[arg(long, conflicts_with_all = ["hours", "program"])]
    check: bool,
    /// Seed of the simulated sensor that every stage of the run reads
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The program, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

const CHECK_HOURS: f64 = 3.0 / 60.0;

pub fn run(args: &EnduranceArgs) -> Result<()> {
    let program = app::given_or_built(args.program.as_deref())?;
    let hours = if args.check { CHECK_HOURS } else { args.hours };
    let device = format!("twin:seed={}", args.seed);
    long(&program, &device, hours, args.speed)?;
    tracker::run(&program, &device, hours)?;
    clock::run(&program, &device)?;
    disk::run(&program, &device)
}

/// The long run. Memory and descriptors must not grow, and every sample must be recorded.
fn long(program: &Path, device: &str, hours: f64, speed: f64) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let capture = folder.path().join("served.arrows");
    let server = Server::start(program, &["--device", device, "-o", &capture.display().to_string()])?;
    let idle = descriptors(server.id())?;
    page::ask(&server.page, &format!(r#"{{"id":1,"do":"speed","factor":{speed}}}"#))?;
    let begun = Instant::now();
    let mut gauge = Gauge::default();
    let visits = load::run(&server, hours, &mut gauge)?;
    let wall = begun.elapsed();
    let left = server.settled(idle + OWN)?;
    server.end()?;
    let recorded = CaptureSummary::of(program, &capture)?;
    let CaptureSummary { rows, lost, span_s, .. } = recorded;
    println!("long run      {:.2} h of the sensor in {:.0} s", span_s / 3600.0, wall.as_secs_f64());
    println!("recorded      {rows} samples, {lost} lost");
    println!("visits        {visits}");
    println!("memory        {}", gauge.memory());
    println!("descriptors   {idle} before, {} at most, {left} afterwards", gauge.most_descriptors());
    recorded.check(program, device, folder.path())?;
    println!("compared      every sample is the one that the twin gives alone");
    gauge.check(kept_mb(hours))
}

/// Growth of memory, MB, that the page's Allan deviation may cause from the middle of the second quarter to the middle
/// of the last. The server keeps means over 0.1 s, and needs as much memory again while it computes. After 2¹⁹ means
/// (14.6 h) it merges them.
fn kept_mb(hours: f64) -> f64 {
    const MB_PER_H: f64 = 3.0;
    const FULL_H: f64 = 14.6;
    let at = |share: f64| (share * hours).min(FULL_H);
    MB_PER_H * (at(7.0 / 8.0) - at(3.0 / 8.0))
}

/// Number of descriptors that the server may open for itself while it serves. Hundreds of visitors come and go, so a
/// leak per visitor would exceed this number.
const OWN: usize = 8;
