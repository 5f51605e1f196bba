//! The simulated part, in this process and on simulated time.

use super::live::{Edges, Live};
use adis16130::{Config, Edge, MCLK_HZ, Sample, SamplerConfig};
use adis16130_twin::{Spec, Truth, Twin, TwinSpi};
use anyhow::Result;

/// The driver, reading the twin.
pub struct TwinDevice {
    pub mclk_hz: u32,
    pub live: Live<TwinSpi, TwinEdges>,
}

impl TwinDevice {
    pub fn new(unit: Spec, sampling: SamplerConfig) -> Self {
        let mclk_hz = told_mclk_hz(unit.mclk_hz);
        let twin = Twin::new(unit);
        let live = Live::new(twin.spi(), TwinEdges(twin), Config::new(), sampling, mclk_hz);
        Self { mclk_hz, live }
    }

    #[inline]
    pub fn next(&mut self) -> Result<Sample> {
        self.live.next()
    }

    /// The twin's truth about its slow bias now.
    pub fn truth(&self) -> Truth {
        self.live.edges.0.truth()
    }
}

/// What the driver is told of the clock: the nominal one (F-31), unless the unit was given quite another.
fn told_mclk_hz(mclk_hz: f64) -> u32 {
    let nominal_hz = f64::from(MCLK_HZ);
    if (mclk_hz / nominal_hz - 1.0).abs() < 0.05 { MCLK_HZ } else { mclk_hz.round() as u32 }
}

/// Its data-ready line.
pub struct TwinEdges(Twin);

impl Edges for TwinEdges {
    #[inline]
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let edge = self.0.next_falling_edge(timeout_ns);
        Ok(edge.map(|edge| Edge { t_ns: edge.t_ns, seq: edge.seq }))
    }

    fn now(&self) -> String {
        format!("{:.1} s after power-on", self.0.now_ns() as f64 * 1e-9)
    }
}
