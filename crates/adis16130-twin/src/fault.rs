//! Faults of the wiring and of the part. A fault begins at a specified time or by a call.

use crate::normal::{Process, Uniform};

/// Bit error rate of [`Fault::BitErrors`] when the specification does not set it.
pub const DEFAULT_BIT_ERROR_RATE: f64 = 1e-6;

/// A fault of the wiring or of the part.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// No fault.
    None,
    /// SDO is stuck at 0. The part still executes commands.
    SdoLow,
    /// SDO is stuck at 1. The part still executes commands.
    SdoHigh,
    /// The data registers keep their codes. RDY goes on as if the registers were updated.
    Frozen,
    /// The RDY line is cut and announces no data. The data registers are still updated.
    RdyLost,
    /// One to five edges of RDY in a row are missing, about once in 100 edges. The data registers are still updated.
    RdyStutter,
    /// Bits flip on their way in both directions, at [`Spec::bit_error_rate`](crate::Spec::bit_error_rate).
    BitErrors,
    /// The supply dips once: all registers take their reset values (MODE 00h), so the conversions stop.
    Brownout,
    /// The cable is unplugged until [`Twin::replug`](crate::Twin::replug): no supply, SDO all ones, no data announced.
    Unplug,
}

pub(crate) struct WireFaults {
    pub(crate) active: Fault,
    random: Uniform,
    bit_error_rate: f64,
    bits_to_error: u64,
    edges_to_drop: u32,
}

impl WireFaults {
    pub(crate) fn new(seed: u64, bit_error_rate: f64) -> Self {
        let mut faults = Self {
            active: Fault::None,
            random: Uniform::new(seed, Process::Faults),
            bit_error_rate,
            bits_to_error: 0,
            edges_to_drop: 0,
        };
        faults.bits_to_error = faults.draw_gap();
        faults
    }

    pub(crate) fn set(&mut self, fault: Fault) {
        self.active = fault;
        if fault == Fault::BitErrors && self.bit_error_rate == 0.0 {
            self.bit_error_rate = DEFAULT_BIT_ERROR_RATE;
            self.bits_to_error = self.draw_gap();
        }
    }

    /// Returns the byte that arrives at the host when the part sends `byte`.
    pub(crate) fn sdo(&mut self, byte: u8) -> u8 {
        match self.active {
            Fault::SdoLow => 0x00,
            Fault::SdoHigh => 0xFF,
            Fault::BitErrors => self.flip(byte),
            _ => byte,
        }
    }

    /// Returns the byte that arrives at the part when the host sends `byte`.
    pub(crate) fn sdi(&mut self, byte: u8) -> u8 {
        match self.active {
            Fault::BitErrors => self.flip(byte),
            _ => byte,
        }
    }

    /// Whether the edge of RDY that is due reaches the host.
    pub(crate) fn edge_passes(&mut self) -> bool {
        match self.active {
            Fault::RdyLost => false,
            Fault::RdyStutter => self.stutter_passes(),
            _ => true,
        }
    }

    fn stutter_passes(&mut self) -> bool {
        if self.edges_to_drop == 0 && self.random.sample() < 0.01 {
            self.edges_to_drop = 1 + (self.random.sample() * 5.0) as u32;
        }
        let passes = self.edges_to_drop == 0;
        self.edges_to_drop = self.edges_to_drop.saturating_sub(1);
        passes
    }

    fn flip(&mut self, mut byte: u8) -> u8 {
        let mut left = 8;
        while self.bits_to_error < left {
            left -= self.bits_to_error + 1;
            byte ^= 1 << left;
            self.bits_to_error = self.draw_gap();
        }
        self.bits_to_error -= left;
        byte
    }

    /// Draws the number of good bits before the next flipped bit, from the geometric distribution.
    fn draw_gap(&mut self) -> u64 {
        if self.bit_error_rate <= 0.0 {
            return u64::MAX;
        }
        let u = 1.0 - self.random.sample();
        (libm::log(u) / libm::log1p(-self.bit_error_rate)) as u64
    }
}
