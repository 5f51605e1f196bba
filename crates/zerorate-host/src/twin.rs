//! The simulated part, in this process and on simulated time.

use crate::error::Told;
use crate::kinds::{Address, Parsed};
use crate::live::{Edges, Live};
use crate::options::PartOptions;
use crate::source::{Facts, Setup, Source};
use crate::{Result, Stop};
use adis16130::{Edge, MCLK_HZ, RdyEdge, SelfTest};
use adis16130_twin::{Roa, Spec, Truth, Twin, TwinSpi};
use std::sync::Arc;
use zerorate::Axis;
use zerorate_data::capture::{CaptureInfo, Row};

/// `twin:KEY=VALUE,…`: the unit, and how the driver configures it.
#[derive(Clone, Debug)]
pub struct TwinAddress {
    unit: Spec,
    part: PartOptions,
}

impl TwinAddress {
    pub fn parse(keys: &str) -> Parsed {
        let (mut part, mut unit) = (PartOptions::new(), Vec::new());
        for item in keys.split(',') {
            match part.with(item.trim())? {
                Some(changed) => part = changed,
                None => unit.push(item),
            }
        }
        let unit = Spec::parse_keys(&unit.join(",")).map_err(|error| error.to_string())?;
        Ok(Arc::new(Self { unit, part }))
    }
}

impl Address for TwinAddress {
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>> {
        let sampling = setup.sampling.config(self.part.divided);
        let mclk_hz = told_mclk_hz(self.unit.mclk_hz);
        let bandwidth_hz = (self.unit.roa == Roa::TenNanofarad).then_some(Axis::ADIS16130_ROA_10NF_HZ);
        let settings = (self.part.config, sampling);
        let facts = Facts::of_part(name, settings, mclk_hz, bandwidth_hz, setup.part.as_ref())?;
        // its files depend on nothing but the seed: they have no time of day
        let info = CaptureInfo { created: String::new(), ..facts.info };
        let facts = Facts { info, is_real: false, ..facts };
        let twin = Twin::new(self.unit.clone());
        let rising = self.part.config.rdy_edge() == RdyEdge::Rising;
        let edges = TwinEdges { rising, divided: sampling.divided.max(1).into(), counted: 0, twin };
        let live = Live::new(edges.twin.spi(), edges, self.part.config, sampling, mclk_hz, stop);
        Ok(Box::new(TwinPart { facts, live }))
    }
}

/// The driver, reading the twin.
struct TwinPart {
    facts: Facts,
    live: Live<TwinSpi, TwinEdges>,
}

impl Source for TwinPart {
    fn facts(&self) -> Facts {
        self.facts.clone()
    }

    fn initialise(&mut self) -> Result<Option<u8>> {
        Ok(self.live.initialise().map(Some)?)
    }

    #[inline]
    fn next(&mut self) -> Result<Option<Row>> {
        Ok(self.live.next().map(|sample| Some(Row::from(&sample)))?)
    }

    fn self_test(&mut self, gpio: &str) -> Result<SelfTest> {
        if !gpio.is_empty() {
            let why = "--self-test takes no GPIO with the twin, whose pins are its own";
            return Err(Told::request(format!("{why}: leave `{gpio}` out")).into());
        }
        let mut pin = self.live.edges.twin.self_test_pin();
        Ok(self.live.self_test(&mut pin)?)
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.live.edges.twin.truth())
    }
}

/// What the driver is told of the clock: the nominal one (F-31), unless the unit was given quite another.
fn told_mclk_hz(mclk_hz: f64) -> u32 {
    let nominal_hz = f64::from(MCLK_HZ);
    if (mclk_hz / nominal_hz - 1.0).abs() < 0.05 { MCLK_HZ } else { mclk_hz.round() as u32 }
}

/// Its data-ready line, with a counter in it where there is one.
struct TwinEdges {
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
    fn next(&mut self, timeout_ns: u64) -> anyhow::Result<Option<Edge>> {
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
