//! The smallest image with the driver: reset, verified initialisation, samples at edges of RDY with counted losses,
//! and recovery after an error.

#![no_std]
#![no_main]

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, Framing, MCLK_HZ, Sampler, SamplerConfig};
use firmware_qemu::bare::{Bus, Line, edge, put};

#[cortex_m_rt::entry]
fn main() -> ! {
    let config = Config::new().with_framing(Framing::Command);
    let mut gyro = Adis16130::new(Bus, Line, config);
    let mut sampler = Sampler::new(SamplerConfig::new().with_every_temp(57), &config, MCLK_HZ);
    loop {
        let (t_ns, seq) = edge();
        match gyro.sample(&mut sampler, Edge { t_ns, seq }) {
            Ok(Some(sample)) => put(&sample.rate.code24().to_be_bytes(), sample.lost),
            Ok(None) => {}
            Err(_) => {
                let started = gyro.restart().is_ok();
                sampler.restarted();
                put(&[], started.into());
            }
        }
    }
}
