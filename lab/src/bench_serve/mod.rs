//! `cargo xtask bench-serve`: runs `zerorate serve` in real time with pages, libiio clients and a recording at once.
//! The recording must not lose samples.

pub mod page;
pub mod samples;

use crate::app;
use crate::server::{Server, memory_mb};
use crate::tools;
use anyhow::{Result, bail, ensure};
use page::Frames;
use samples::{CaptureSummary, Client, READDEV};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

const DEVICE: &str = "twin:seed=1";
/// Pairs of conversions per second at the nominal clock (F-31): 11 385 conversions, of rate and temperature in turn.
const PAIRS_HZ: f64 = 5692.6;
/// Smallest ratio of the twin's time to the elapsed time that counts as real time.
const REAL_TIME: f64 = 0.98;
/// Longest wait for the twin on a busy machine, as a multiple of the measurement's length.
const LONGEST: u32 = 10;
const STEP: Duration = Duration::from_millis(100);
/// Length of the measurement, s, and numbers of pages and of libiio clients. docs/serve.md states them.
const SECONDS: u64 = 60;
const PAGES: usize = 20;
const CLIENTS: usize = 4;

#[derive(clap::Args)]
pub struct BenchServeArgs {
    /// The program, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Run as a step of the test: with the tests' program, and until the twin has given the wanted time, however long
    /// a busy machine takes for it
    #[arg(long, conflicts_with = "program")]
    check: bool,
}

pub fn run(args: &BenchServeArgs) -> Result<()> {
    let program = app::given_or_built(args.program.as_deref())?;
    let clients = if tools::available(&[READDEV], "clients of libiio that look on")? { CLIENTS } else { 0 };
    let folder = tempfile::tempdir()?;
    let capture = folder.path().join("served.arrows");
    let server = Server::start(&program, &["--device", DEVICE, "-o", &capture.display().to_string()])?;
    let begun = Instant::now();
    let seen = look_on(args.check, &server, clients)?;
    let peak_mb = memory_mb(server.id(), "VmHWM:")?;
    server.end()?;
    let wall_s = begun.elapsed().as_secs_f64();
    let recorded = CaptureSummary::of(&program, &capture)?;
    print(&seen, &recorded, wall_s, peak_mb);
    recorded.check(&program, DEVICE, folder.path())?;
    // the nominal rate (F-31), within 3 %: the master clock may be off by 1 % (M-06)
    let expected = recorded.span_s * PAIRS_HZ;
    ensure!((recorded.rows as f64 / expected - 1.0).abs() < 0.03, "{} samples do not match the time", recorded.rows);
    check_clients(&seen.clients, &program, &capture)
}

struct Watchers {
    /// Processor time of the server as a share of one core.
    share: f64,
    wall_s: f64,
    pages: Vec<Frames>,
    /// The bytes that each libiio client received.
    clients: Vec<Vec<u8>>,
}

fn look_on(check: bool, server: &Server, clients: usize) -> Result<Watchers> {
    let (over, shown_ms) = (AtomicBool::new(false), AtomicU64::new(0));
    thread::scope(|scope| -> Result<Watchers> {
        let watch = || scope.spawn(|| page::watch(&server.page, &|| over.load(Ordering::Relaxed), &shown_ms));
        let pages: Vec<_> = (0..PAGES).map(|_| watch()).collect();
        let readers = (0..clients).map(|_| Client::start(&server.iio_uri)).collect::<Result<Vec<_>>>();
        let (begun, cpu_s, time) = (Instant::now(), server.cpu_s(), Duration::from_secs(SECONDS));
        let is_enough = || !check || shown_ms.load(Ordering::Relaxed) >= SECONDS * 1000;
        while begun.elapsed() < time || (!is_enough() && begun.elapsed() < LONGEST * time) {
            if readers.is_err() || pages.iter().any(|page| page.is_finished()) {
                break;
            }
            thread::sleep(STEP);
        }
        let (wall_s, later_cpu_s) = (begun.elapsed().as_secs_f64(), server.cpu_s());
        let is_enough = is_enough();
        over.store(true, Ordering::Relaxed);
        let clients = readers?.into_iter().map(Client::end).collect::<Result<_>>()?;
        let pages = pages.into_iter().map(|page| page.join().unwrap_or_else(|_| bail!("a page died")));
        let pages = pages.collect::<Result<_>>()?;
        ensure!(is_enough, "the twin gave {} ms in {wall_s:.0} s", shown_ms.load(Ordering::Relaxed));
        Ok(Watchers { share: (later_cpu_s? - cpu_s?) / wall_s, wall_s, pages, clients })
    })
}

fn print(seen: &Watchers, recorded: &CaptureSummary, wall_s: f64, peak_mb: f64) {
    let CaptureSummary { rows, lost, span_s, .. } = recorded;
    let rate_hz = *rows as f64 / span_s;
    println!("recorded      {rows} samples over {span_s:.1} s of twin time, {rate_hz:.1} a second, {lost} lost");
    let share = span_s / wall_s;
    let verdict = if share < REAL_TIME { "MISSED" } else { "kept" };
    println!("real time     {verdict}: {span_s:.1} s in {wall_s:.1} s, {:.1} %", share * 100.0);
    let frames_per_s = seen.pages.iter().map(|page| page.count).min().unwrap_or_default() as f64 / seen.wall_s;
    let kb_per_s = seen.pages.iter().map(|page| page.bytes).max().unwrap_or_default() as f64 / 1e3 / seen.wall_s;
    // the first snapshot is not counted, because every page gets one
    let late: u64 = seen.pages.iter().map(|page| page.snapshots.saturating_sub(1)).sum();
    println!(
        "pages         {}, at least {frames_per_s:.1} frames/s, at most {kb_per_s:.0} KB/s each; \
         too slow {late} times",
        seen.pages.len()
    );
    println!("processor     {:.1} % of a core", seen.share * 100.0);
    println!("memory        {peak_mb:.1} MB at most");
}

/// Checks that each client received samples that were recorded.
fn check_clients(clients: &[Vec<u8>], program: &Path, capture: &Path) -> Result<()> {
    if clients.is_empty() {
        println!("libiio        no client");
        return Ok(());
    }
    let rows = samples::rows(program, capture)?;
    let got = clients.iter().map(|bytes| samples::check_client(bytes, &rows)).collect::<Result<Vec<_>>>()?;
    let least = got.iter().map(|(count, _)| count).min().unwrap_or(&0);
    let missed: u64 = got.iter().map(|(_, missed)| missed).sum();
    println!("libiio        {} clients, at least {least} samples each, {missed} missed and told", got.len());
    Ok(())
}
