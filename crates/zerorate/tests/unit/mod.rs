//! A unit of the twin, read with the driver.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, MCLK_HZ, Sampler, SamplerConfig};
use adis16130_twin::{Spec, Twin, TwinRdy, TwinSpi};
use zerorate::Reading;

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
            let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
            if let Some(sample) = self.gyro.sample(&mut self.sampler, edge).expect("a reading") {
                return Reading::from(&sample);
            }
        }
    }
}
