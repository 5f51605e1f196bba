//! A twin that is read with the driver, and a plan that is short enough for a test.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, MCLK_HZ, Sampler, SamplerConfig};
use adis16130_twin::{Spec, Twin, TwinEdge, TwinRdy, TwinSpi};
use std::fmt::Debug;
use zerorate::{Method, Plan, Reading};

/// A plan of 145 s. A part with a time constant of self-heating of 30 s warms enough within it to measure BTC.
pub const SHORT: Plan = Plan {
    method: Method::An1042,
    target_dps: None,
    average_s: 2.0,
    warmup_s: 60.0,
    settle_s: 60.0,
    offset_s: 20.0,
    final_temp_s: 1.0,
    max_lost: 0.001,
    max_u_btc_dps_per_c: 0.01,
    earth_dps: None,
    assume_linear: true,
};

/// A twin that the driver has initialised.
pub struct Unit {
    pub twin: Twin,
    gyro: Adis16130<TwinSpi, TwinRdy>,
    sampler: Sampler,
}

impl Unit {
    pub fn new(spec: Spec, config: Config, sampling: SamplerConfig) -> Self {
        let twin = Twin::new(spec);
        let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), config);
        gyro.init().expect("initialisation");
        Self { twin, gyro, sampler: Sampler::new(sampling, &config, MCLK_HZ) }
    }

    pub fn of(spec: Spec) -> Self {
        Self::new(spec, Config::default(), SamplerConfig::default())
    }

    pub fn read(&mut self) -> Reading {
        loop {
            let edge = self.twin.next_falling_edge(1_000_000_000).expect("data ready");
            if let Some(reading) = self.read_at(edge).expect("a reading") {
                return reading;
            }
        }
    }

    /// Reads at an edge. `None` if the sampler skips this edge.
    pub fn read_at(&mut self, TwinEdge { t_ns, seq }: TwinEdge) -> Result<Option<Reading>, impl Debug + use<>> {
        let sample = self.gyro.sample(&mut self.sampler, Edge { t_ns, seq });
        sample.map(|sample| sample.as_ref().map(Reading::from))
    }
}
