//! A minimal host that sends bytes, so that the tests need no driver.

use adis16130_twin::{Spec, Twin, TwinEdge, TwinSpi};
use embedded_hal::spi::SpiDevice;

/// The initialisation of F-30.
pub const INIT: [u8; 12] = [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22];
const TIMEOUT_NS: u64 = 10_000_000;

/// The typical unit without noise, hysteresis and temperature coefficient. MCLK is 6.000 MHz, and the bias is 0.
pub fn quiet() -> Spec {
    Spec { noise: false, tempco_dps_per_c: 0.0, hysteresis_dps: 0.0, ..Spec::typical() }
}

pub struct Host {
    pub twin: Twin,
    pub spi: TwinSpi,
}

impl Host {
    pub fn new(spec: Spec) -> Self {
        let twin = Twin::new(spec);
        Self { spi: twin.spi(), twin }
    }

    pub fn started(spec: Spec) -> Self {
        let mut host = Self::new(spec);
        host.send(&INIT);
        host
    }

    /// Sends each byte in its own frame of CS.
    pub fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.spi.write(&[*byte]).unwrap();
        }
    }

    /// Reads `N` bytes of a register, each in its own frame of CS.
    pub fn read<const N: usize>(&mut self, address: u8) -> [u8; N] {
        self.send(&[0x40 | address]);
        let mut data = [0];
        [(); N].map(|()| {
            self.spi.transfer(&mut data, &[0]).unwrap();
            data[0]
        })
    }

    /// Resets the part by 32 ones in a row (F-23).
    pub fn spi_reset(&mut self) {
        self.spi.write(&[0x00, 0xFF, 0xFF, 0xFF, 0xFF]).unwrap();
    }

    pub fn byte(&mut self, address: u8) -> u8 {
        self.read::<1>(address)[0]
    }

    pub fn code24(&mut self, address: u8) -> u32 {
        let [a, b, c] = self.read(address);
        u32::from_be_bytes([0, a, b, c])
    }

    pub fn code16(&mut self, address: u8) -> u16 {
        u16::from_be_bytes(self.read(address))
    }

    pub fn edge(&mut self) -> TwinEdge {
        self.twin.next_falling_edge(TIMEOUT_NS).expect("an edge of RDY")
    }

    /// Waits for an edge and reads both channels. Returns the edge, the rate code and the temperature code.
    pub fn pair(&mut self) -> (TwinEdge, u32, u32) {
        let edge = self.edge();
        (edge, self.code24(0x08), self.code24(0x0A))
    }

    pub fn rates(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| dps(self.pair().1)).collect()
    }
}

/// Converts a rate code to °/s (F-40).
pub fn dps(code24: u32) -> f64 {
    (f64::from(code24) - 8_388_608.0) / 23_488.0
}

/// Converts a temperature code to °C (F-41).
pub fn celsius(code24: u32) -> f64 {
    (f64::from(code24) - 8_388_608.0) / 14_093.0 + 25.0
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let sum: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (sum / (values.len() - 1) as f64).sqrt()
}
