//! The twin in real time, with a record of the bus traffic.

use super::ljca::Board;
use adis16130_twin::{ChannelLosses, Spec, Twin, TwinRdy, TwinSpi};
use anyhow::{Context, Result};
use embedded_hal::digital::InputPin;
use embedded_hal::spi::SpiDevice;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The initialisation of F-30: data ready on, both channels, conversion word 5, continuous, 24 bit.
const INITIALISATION: [u8; 12] = [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22];

/// The COM bytes that read RATEDATA and TEMPDATA (F-24).
const READ_RATE: u8 = 0x48;
const READ_TEMP: u8 = 0x4A;

/// A part in real time: its time is the wall-clock time since it was switched on.
pub struct WallPart {
    twin: Twin,
    spi: TwinSpi,
    rdy: TwinRdy,
    switched_on: Instant,
    seed: u64,
    mclk_hz: f64,
    seen: BusTraffic,
    wire: Option<Wire>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct BusTraffic {
    pub spi_frames: u64,
    pub rate_reads: u64,
    pub temp_reads: u64,
    /// Number of falling edges of RDY.
    pub edges: u32,
    pub edges_reported: u32,
}

/// The record of the part until it was unplugged, with its true values.
#[derive(Deserialize, Serialize)]
pub struct Summary {
    pub seed: u64,
    pub mclk_hz: f64,
    pub duration_s: f64,
    #[serde(flatten)]
    pub seen: BusTraffic,
    pub lost_rate: Losses,
    pub lost_temp: Losses,
    pub truth: Truth,
}

/// Numbers of readings that were lost before the host read them (F-33).
#[derive(Deserialize, Serialize)]
pub struct Losses {
    pub overwritten: u64,
    pub dropped: u64,
}

/// The true values at the end: PBC = −bias and BTC = −slope at `sensor_c` (F-50), and the curvature of the bias.
#[derive(Deserialize, Serialize)]
pub struct Truth {
    pub sensor_c: f64,
    pub pbc_dps: f64,
    pub btc_dps_per_c: f64,
    pub curvature_dps_per_c2: f64,
}

impl WallPart {
    /// Switches the part on; its time starts now.
    pub fn new(spec: Spec, initialised: bool, wire: Option<&Path>) -> Result<Self> {
        let (seed, mclk_hz) = (spec.seed, spec.mclk_hz);
        let twin = Twin::new(spec);
        let (mut spi, rdy) = (twin.spi(), twin.rdy());
        if initialised {
            let Ok(()) = spi.write(&INITIALISATION);
        }
        let wire = wire.map(Wire::create).transpose()?;
        Ok(Self { twin, spi, rdy, switched_on: Instant::now(), seed, mclk_hz, seen: BusTraffic::default(), wire })
    }

    /// Advances the part to the current time. Returns whether RDY has fallen since the last call.
    pub fn rdy_fell(&mut self) -> bool {
        self.catch_up();
        let Some(edge) = self.twin.next_falling_edge(0) else { return false };
        self.seen.edges = edge.seq;
        true
    }

    /// Time until the next event that the part causes by itself.
    pub fn idle_time(&self) -> Duration {
        let now_ns = self.switched_on.elapsed().as_nanos() as u64;
        let next_ns = self.twin.next_event_ns().unwrap_or(u64::MAX);
        Duration::from_nanos(next_ns.saturating_sub(now_ns))
    }

    /// Finishes the log of the wire and returns the summary. `edges_reported` is the number of edges that the host was
    /// told of.
    pub fn finish(mut self, edges_reported: u32) -> Result<Summary> {
        self.rdy_fell();
        self.seen.edges_reported = edges_reported;
        if let Some(wire) = self.wire {
            wire.finish()?;
        }
        let (lost, truth) = (self.twin.lost_unread(), self.twin.truth());
        let losses = |of: ChannelLosses| Losses { overwritten: of.overwritten, dropped: of.lost_new };
        Ok(Summary {
            seed: self.seed,
            mclk_hz: self.mclk_hz,
            duration_s: truth.t_ns as f64 * 1e-9,
            seen: self.seen,
            lost_rate: losses(lost.rate),
            lost_temp: losses(lost.temp),
            truth: Truth {
                sensor_c: truth.sensor_c,
                pbc_dps: truth.pbc_dps(truth.sensor_c),
                btc_dps_per_c: truth.btc_dps_per_c(truth.sensor_c),
                curvature_dps_per_c2: (1.0 + truth.sensitivity_error) * truth.curvature_dps_per_c2,
            },
        })
    }

    fn catch_up(&self) {
        let wall_ns = self.switched_on.elapsed().as_nanos() as u64;
        self.twin.advance_ns(wall_ns.saturating_sub(self.twin.now_ns()));
    }

    fn note(&mut self, mosi: &[u8], miso: &[u8]) {
        self.seen.spi_frames += 1;
        match mosi.first() {
            Some(&READ_RATE) => self.seen.rate_reads += 1,
            Some(&READ_TEMP) => self.seen.temp_reads += 1,
            _ => {}
        }
        if let Some(wire) = &mut self.wire {
            let lost = self.twin.lost_unread().rate;
            wire.row(self.twin.now_ns(), mosi, miso, lost.overwritten + lost.lost_new, self.seen.edges);
        }
    }
}

impl Board for WallPart {
    fn frame(&mut self, mosi: &[u8]) -> Vec<u8> {
        self.catch_up();
        let mut both = mosi.to_vec();
        let Ok(()) = self.spi.transfer_in_place(&mut both);
        self.note(mosi, &both);
        both
    }

    fn rdy_high(&mut self) -> bool {
        self.catch_up();
        self.rdy.is_high().unwrap_or(true)
    }
}

/// The log of the wire: one row per frame of CS.
struct Wire {
    path: PathBuf,
    rows: BufWriter<File>,
    failed: Option<std::io::Error>,
}

impl Wire {
    fn create(path: &Path) -> Result<Self> {
        let file = File::create(path).with_context(|| format!("creating {}", path.display()))?;
        let mut rows = BufWriter::new(file);
        writeln!(rows, "t_ns,mosi,miso,lost_rate,edges")?;
        Ok(Self { path: path.to_owned(), rows, failed: None })
    }

    /// Adds a row. An error, such as a full disk, must not stop the bus, so it is kept for [`Wire::finish`].
    fn row(&mut self, t_ns: u64, mosi: &[u8], miso: &[u8], lost_rate: u64, edges: u32) {
        if self.failed.is_none() {
            self.failed = writeln!(self.rows, "{t_ns},{},{},{lost_rate},{edges}", hex(mosi), hex(miso)).err();
        }
    }

    fn finish(mut self) -> Result<()> {
        let written = self.failed.take().map_or_else(|| self.rows.flush(), Err);
        written.with_context(|| format!("writing {}", self.path.display()))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
