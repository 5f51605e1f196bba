//! The twin on wall time, with a record of the bus.

use super::ljca::Board;
use crate::output::Recording;
use adis16130_twin::{LostUnread, Spec, Truth, Twin, TwinRdy, TwinSpi};
use anyhow::{Context, Result};
use embedded_hal::digital::InputPin;
use embedded_hal::spi::SpiDevice;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::time::{Duration, Instant};

/// F-30: data ready on, both channels, conversion word 5, continuous, 24 bit.
const INITIALISATION: [u8; 12] = [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22];

/// COM bytes of reads of RATEDATA and TEMPDATA (F-24).
const READ_RATE: u8 = 0x48;
const READ_TEMP: u8 = 0x4A;

/// The part. Its time is the wall-clock time since it was switched on.
pub struct WallPart {
    twin: Twin,
    spi: TwinSpi,
    rdy: TwinRdy,
    switched_on: Instant,
    seen: Served,
    wire: Option<Wire>,
}

/// The traffic that the part saw on the bus.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Served {
    pub spi_frames: u64,
    pub rate_reads: u64,
    pub temp_reads: u64,
    /// Falling edges of RDY.
    pub edges: u32,
    /// The edges that were reported to the host.
    pub edges_reported: u32,
}

/// The state of the part at the end.
pub struct Final {
    pub seen: Served,
    pub lost: LostUnread,
    pub truth: Truth,
}

impl WallPart {
    /// Switches the part on; its time starts now.
    pub fn new(spec: Spec, initialised: bool, wire: Option<Recording>) -> Result<Self> {
        let twin = Twin::new(spec);
        let (mut spi, rdy) = (twin.spi(), twin.rdy());
        if initialised {
            let Ok(()) = spi.write(&INITIALISATION);
        }
        let wire = wire.map(Wire::create).transpose()?;
        Ok(Self { twin, spi, rdy, switched_on: Instant::now(), seen: Served::default(), wire })
    }

    /// Advances the part to the present, and returns whether RDY has fallen since the last call.
    pub fn rdy_fell(&mut self) -> bool {
        self.catch_up();
        let Some(edge) = self.twin.next_falling_edge(0) else { return false };
        self.seen.edges = edge.seq;
        true
    }

    /// Time until the part may do something by itself.
    pub fn idle_time(&self) -> Duration {
        let now_ns = self.switched_on.elapsed().as_nanos() as u64;
        let next_ns = self.twin.next_event_ns().unwrap_or(u64::MAX);
        Duration::from_nanos(next_ns.saturating_sub(now_ns))
    }

    /// Ends the log of the wire and returns the final state, after so many edges were reported.
    pub fn finish(mut self, edges_reported: u32) -> Result<Final> {
        self.rdy_fell();
        self.seen.edges_reported = edges_reported;
        if let Some(wire) = self.wire {
            wire.finish()?;
        }
        Ok(Final { seen: self.seen, lost: self.twin.lost_unread(), truth: self.twin.truth() })
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
        let Ok(high) = self.rdy.is_high() else { return true };
        high
    }
}

/// The log of the wire: one row per frame of CS.
struct Wire {
    file: Recording,
    rows: BufWriter<File>,
    failed: Option<std::io::Error>,
}

impl Wire {
    fn create(file: Recording) -> Result<Self> {
        let mut rows = BufWriter::new(file.file()?);
        writeln!(rows, "t_ns,mosi,miso,lost_rate,edges")?;
        Ok(Self { file, rows, failed: None })
    }

    /// A full disk must not stop the bus: the error waits for [`Wire::finish`].
    fn row(&mut self, t_ns: u64, mosi: &[u8], miso: &[u8], lost_rate: u64, edges: u32) {
        if self.failed.is_none() {
            self.failed = writeln!(self.rows, "{t_ns},{},{},{lost_rate},{edges}", hex(mosi), hex(miso)).err();
        }
    }

    fn finish(mut self) -> Result<()> {
        let path = self.file.path().display().to_string();
        let written = self.failed.take().map_or_else(|| self.rows.flush(), Err).and_then(|()| self.file.finish());
        written.with_context(|| format!("writing {path}"))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
