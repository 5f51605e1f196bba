//! Opens and closes pages and libiio clients while the server runs.

use super::gauge::Gauge;
use crate::bench_serve::page;
use crate::bench_serve::samples::{self, Client, READDEV};
use crate::server::Server;
use crate::tools;
use anyhow::{Context, Result, anyhow, ensure};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

const PAGES: u32 = 20;
const CLIENTS: u32 = 4;
/// Duration of the first visitor's visits. Each next one stays longer by [`LONGER`], so that they do not end together.
const VISIT: Duration = Duration::from_secs(2);
const LONGER: Duration = Duration::from_millis(500);
/// Longest wait for data of the sensor, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Counts of the visits, and of the data that the visitors received.
#[derive(Debug, Default)]
pub struct Visits {
    pages: u64,
    frames: u64,
    clients: u64,
    samples: u64,
    missed: u64,
}

impl fmt::Display for Visits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pages, frames, clients, samples, missed } = self;
        write!(
            f,
            "{pages} of pages, {frames} frames; {clients} of libiio, {samples} samples, {missed} missed and told"
        )
    }
}

impl Visits {
    fn add(self, other: &Self) -> Self {
        Self {
            pages: self.pages + other.pages,
            frames: self.frames + other.frames,
            clients: self.clients + other.clients,
            samples: self.samples + other.samples,
            missed: self.missed + other.missed,
        }
    }
}

/// Lets pages and clients connect and disconnect until a page has shown `hours` of the sensor's time.
pub fn run(server: &Server, hours: f64, gauge: &mut Gauge) -> Result<Visits> {
    let clients = if tools::available(&[READDEV], "clients of libiio that come and go")? { CLIENTS } else { 0 };
    let (over, shown_ms) = (AtomicBool::new(false), AtomicU64::new(0));
    thread::scope(|scope| {
        let (over, shown_ms) = (&over, &shown_ms);
        let page = |at| scope.spawn(move || pages(server, visit(at), over, shown_ms));
        let client = |at| scope.spawn(move || self::clients(server, visit(at), over));
        let (pages, clients): (Vec<_>, Vec<_>) = ((0..PAGES).map(page).collect(), (0..clients).map(client).collect());
        let visitors: Vec<_> = pages.into_iter().chain(clients).collect();
        let all_well = || !visitors.iter().any(thread::ScopedJoinHandle::is_finished);
        let watched = wait(server, (hours * 3.6e6) as u64, shown_ms, gauge, &all_well);
        over.store(true, Ordering::Relaxed);
        let visits = visitors.into_iter().map(|visitor| visitor.join().map_err(|_| anyhow!("a visitor died"))?);
        let visits = visits.collect::<Result<Vec<_>>>()?.iter().fold(Visits::default(), Visits::add);
        ensure!(visits.clients == 0 || visits.samples > 0, "no client of libiio got a sample");
        watched.map(|()| visits)
    })
}

fn visit(at: u32) -> Duration {
    VISIT + LONGER * at
}

/// Measures memory and descriptors each second until the pages have shown `enough_ms`, or a visitor has failed.
fn wait(
    server: &Server,
    enough_ms: u64,
    shown_ms: &AtomicU64,
    gauge: &mut Gauge,
    well: &dyn Fn() -> bool,
) -> Result<()> {
    let mut latest = (0, Instant::now());
    while well() {
        gauge.read(server.id())?;
        let now_ms = shown_ms.load(Ordering::Relaxed);
        if now_ms >= enough_ms {
            return Ok(());
        }
        if now_ms > latest.0 {
            latest = (now_ms, Instant::now());
        }
        ensure!(latest.1.elapsed() < PATIENCE, "the sensor stands at {now_ms} ms");
        sleep(Duration::from_secs(1));
    }
    Ok(())
}

fn pages(server: &Server, visit: Duration, over: &AtomicBool, shown_ms: &AtomicU64) -> Result<Visits> {
    let mut visits = Visits::default();
    while !over.load(Ordering::Relaxed) {
        let begun = Instant::now();
        let frames = page::watch(&server.page, &|| begun.elapsed() >= visit, shown_ms)?;
        visits = visits.add(&Visits { pages: 1, frames: frames.count, ..Visits::default() });
    }
    Ok(visits)
}

/// Starts one client after the other. Each is killed while it reads.
fn clients(server: &Server, visit: Duration, over: &AtomicBool) -> Result<Visits> {
    let mut visits = Visits::default();
    while !over.load(Ordering::Relaxed) {
        let client = Client::start(&server.iio_uri)?;
        sleep(visit);
        let (samples, missed) = samples::in_order(&client.end()?).context("a client of libiio")?;
        visits = visits.add(&Visits { clients: 1, samples, missed, ..Visits::default() });
    }
    Ok(visits)
}
