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
        let edges = TwinEdges { rising, divided: sampling.divided.max(1).into(), counted: 0, twin };
        let live = Live::new(edges.twin.spi(), edges, config, sampling, mclk_hz);
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

/// Its data-ready line, with a counter in it where there is one.
pub struct TwinEdges {
    twin: Twin,
    /// The driver is told of rising edges.
    rising: bool,
    /// The counter gives an edge for so many of the part.
    divided: u32,
    /// Edges that it has given.
    counted: u32,
}

impl Edges for TwinEdges {
    #[inline]
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let until_ns = self.twin.now_ns().saturating_add(timeout_ns);
        loop {
            let left_ns = until_ns.saturating_sub(self.twin.now_ns());
            let Some(edge) = self.twin.next_edge(self.rising, left_ns) else { return Ok(None) };
            let given = edge.seq / self.divided;
            if self.divided == 1 || std::mem::replace(&mut self.counted, given) != given {
                return Ok(Some(Edge { t_ns: edge.t_ns, seq: given }));
            }
        }
    }

    fn pause(&mut self, ns: u64) {
        self.twin.advance_ns(ns);
    }

    fn now(&self) -> String {
        format!("{:.1} s after power-on", self.twin.now_ns() as f64 * 1e-9)
    }
}
