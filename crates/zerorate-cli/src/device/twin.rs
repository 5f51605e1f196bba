//! The simulated part, in this process and on simulated time.

use super::live::{Edges, Live};
use adis16130::{Config, Edge, MCLK_HZ, RdyEdge, Sample, SamplerConfig, SelfTest};
use adis16130_twin::{Spec, Truth, Twin, TwinSpi};
use anyhow::Result;

/// The driver, reading the twin.
pub struct TwinDevice {
    pub mclk_hz: u32,
    pub live: Live<TwinSpi, TwinEdges>,
}

impl TwinDevice {
    pub fn new(unit: Spec, config: Config, sampling: SamplerConfig) -> Self {
        let mclk_hz = told_mclk_hz(unit.mclk_hz);
        let twin = Twin::new(unit);
        let rising = config.rdy_edge() == RdyEdge::Rising;
        let live = Live::new(twin.spi(), TwinEdges { twin, rising }, config, sampling, mclk_hz);
        Self { mclk_hz, live }
    }

    #[inline]
    pub fn next(&mut self) -> Result<Sample> {
        self.live.next()
    }

    /// What the self-test does to the rate.
    pub fn self_test(&mut self) -> Result<SelfTest> {
        let mut pin = self.live.edges.twin.self_test_pin();
        self.live.self_test(&mut pin)
    }

    /// The twin's truth about its slow bias now.
    pub fn truth(&self) -> Truth {
        self.live.edges.twin.truth()
    }
}

/// What the driver is told of the clock: the nominal one (F-31), unless the unit was given quite another.
fn told_mclk_hz(mclk_hz: f64) -> u32 {
    let nominal_hz = f64::from(MCLK_HZ);
    if (mclk_hz / nominal_hz - 1.0).abs() < 0.05 { MCLK_HZ } else { mclk_hz.round() as u32 }
}

/// Its data-ready line.
pub struct TwinEdges {
    twin: Twin,
    /// The driver is told of rising edges.
    rising: bool,
}

impl Edges for TwinEdges {
    #[inline]
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let edge = self.twin.next_edge(self.rising, timeout_ns);
        Ok(edge.map(|edge| Edge { t_ns: edge.t_ns, seq: edge.seq }))
    }

    fn pause(&mut self, ns: u64) {
        self.twin.advance_ns(ns);
    }

    fn now(&self) -> String {
        format!("{:.1} s after power-on", self.twin.now_ns() as f64 * 1e-9)
    }
}
