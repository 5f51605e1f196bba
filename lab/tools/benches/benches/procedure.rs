//! Benchmarks of the twin. Each simulates a minute of the F-51 procedure, in which every pair of readings is read with
//! one frame of CS per byte.
//!
//! The counter counts conversions. The whole procedure of 53 minutes has 36.2 million of them.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, Sampler, SamplerConfig};
use adis16130_twin::{Spec, Twin, TwinSpi};
use divan::counter::ItemsCount;
use embedded_hal::spi::SpiDevice;

fn main() {
    divan::main();
}

/// Number of pairs of conversions in a simulated minute at 6 MHz.
const PAIRS: u32 = 341_556;
const TIMEOUT_NS: u64 = 1_000_000;

fn minute() -> ItemsCount {
    ItemsCount::new(2 * PAIRS)
}

/// Reads a register with one frame of CS per byte, as in the application note.
fn read<const N: usize>(spi: &mut TwinSpi, address: u8) -> [u8; N] {
    spi.write(&[0x40 | address]).unwrap();
    let mut data = [0; N];
    for byte in &mut data {
        let mut frame = [0];
        spi.transfer(&mut frame, &[0]).unwrap();
        *byte = frame[0];
    }
    data
}

/// Transfers only the bytes of channel status, rate and temperature on each edge.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn bytes(bencher: divan::Bencher) {
    let twin = Twin::new(Spec::from_seed(1));
    let mut spi = twin.spi();
    for byte in [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22] {
        spi.write(&[byte]).unwrap();
    }
    bencher.counter(minute()).bench_local(|| {
        let mut sum = 0;
        for _ in 0..PAIRS {
            twin.next_falling_edge(TIMEOUT_NS).unwrap();
            let [status] = read(&mut spi, 0x20);
            let [a, b, c] = read(&mut spi, 0x08);
            let temp: [u8; 3] = read(&mut spi, 0x0A);
            sum += u64::from(status) + u64::from(u32::from_be_bytes([0, a, b, c])) + u64::from(temp[2]);
        }
        sum
    });
}

/// Transfers the same bytes through the driver and its sampler.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn driver(bencher: divan::Bencher) {
    let twin = Twin::new(Spec::from_seed(1));
    let config = Config::default();
    let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), config);
    gyro.init().unwrap();
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, 6_000_000);
    bencher.counter(minute()).bench_local(|| {
        let mut sum = 0;
        for _ in 0..PAIRS {
            let edge = twin.next_falling_edge(TIMEOUT_NS).unwrap();
            let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
            if let Some(sample) = gyro.sample(&mut sampler, edge).unwrap() {
                sum += u64::from(sample.rate.code24());
            }
        }
        sum
    });
}
