//! The digital side of the part, which executes the bytes on the wire as register accesses.

use crate::adc::{Adc, to_16_bits};
use crate::registers::{Channel, IOP_SYNC, MODE_MD, Register, Registers};

/// Number of ones in a row on SDI with CS low that resets the part (F-23).
const RESET_ONES: u32 = 32;

/// The state of a command. It does not depend on CS, so both framings of F-22 work.
#[derive(Copy, Clone)]
enum Phase {
    /// The next byte is a COM byte (F-24).
    Command,
    /// Data bytes of a write are still to come.
    Write { register: Register, left: u8, value: u16 },
    /// Data bytes of a read are still to go out, the next one from the highest byte of `shift`.
    Read { left: u8, shift: u32 },
}

#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) enum Effect {
    None,
    /// A register was written, or everything was reset.
    Changed {
        rdy_was_low: bool,
    },
}

pub(crate) struct Chip {
    pub(crate) registers: Registers,
    pub(crate) adc: Adc,
    phase: Phase,
    ones: u32,
    sync_high: bool,
}

impl Chip {
    pub(crate) fn new(mclk_hz: f64) -> Self {
        Self { registers: Registers::RESET, adc: Adc::new(mclk_hz), phase: Phase::Command, ones: 0, sync_high: true }
    }

    pub(crate) fn reset(&mut self) {
        self.registers = Registers::RESET;
        self.adc.reset();
        self.phase = Phase::Command;
        self.ones = 0;
    }

    /// Handles a rise of CS, which ends the run of ones of F-23.
    #[inline]
    pub(crate) fn deselect(&mut self) {
        self.ones = 0;
    }

    /// Clocks eight bits with CS low: takes a byte from SDI and returns the byte on SDO (0 outside a read).
    #[inline]
    pub(crate) fn byte(&mut self, sdi: u8, now_ps: u64) -> (u8, Effect) {
        let (sdo, effect) = match self.phase {
            Phase::Command => (0, self.command(sdi)),
            Phase::Read { left, shift } => (self.shift_out(left, shift), Effect::None),
            Phase::Write { register, left, value } => {
                (0, self.shift_in(register, left, value << 8 | u16::from(sdi), sdi, now_ps))
            }
        };
        if sdi == 0 {
            self.ones = 0;
        } else if self.ones_complete(sdi) {
            let rdy_was_low = self.adc.rdy_low(now_ps);
            self.reset();
            return (sdo, Effect::Changed { rdy_was_low });
        }
        (sdo, effect)
    }

    fn ones_complete(&mut self, sdi: u8) -> bool {
        let complete = self.ones + sdi.leading_ones() >= RESET_ONES;
        self.ones = if sdi == 0xFF { self.ones + 8 } else { sdi.trailing_ones() };
        complete
    }

    #[inline]
    fn command(&mut self, com: u8) -> Effect {
        if com & 0x80 != 0 {
            return Effect::None; // not a COM byte, in which bit 7 is 0 (F-24)
        }
        self.registers.checksum.take(com);
        let register = Register::at(com & 0x3F);
        if com & 0x40 != 0 {
            self.phase = self.begin_read(register);
        } else {
            let left = register.write_len(self.registers.wide());
            if left > 0 {
                self.phase = Phase::Write { register, left, value: 0 };
            }
        }
        Effect::None
    }

    #[inline]
    fn begin_read(&mut self, register: Register) -> Phase {
        match register {
            Register::Data(channel) => self.begin_data_read(channel),
            Register::Status(channel) => one_byte(self.adc.channel_status(channel)),
            Register::AdcStatus => one_byte(self.adc.status()),
            Register::Checksum => Phase::Read { left: 2, shift: u32::from(self.registers.checksum.0) << 16 },
            _ => one_byte(self.registers.read(register, self.sync_high)),
        }
    }

    #[inline]
    fn begin_data_read(&mut self, channel: Channel) -> Phase {
        let code24 = self.adc.begin_read(channel);
        if self.registers.wide() {
            Phase::Read { left: 3, shift: code24 << 8 }
        } else {
            Phase::Read { left: 2, shift: u32::from(to_16_bits(code24)) << 16 }
        }
    }

    #[inline]
    fn shift_out(&mut self, left: u8, shift: u32) -> u8 {
        self.phase = if left > 1 {
            Phase::Read { left: left - 1, shift: shift << 8 }
        } else {
            self.adc.end_read();
            Phase::Command
        };
        (shift >> 24) as u8
    }

    fn shift_in(&mut self, register: Register, left: u8, value: u16, sdi: u8, now_ps: u64) -> Effect {
        self.registers.checksum.take(sdi);
        if left > 1 {
            self.phase = Phase::Write { register, left: left - 1, value };
            return Effect::None;
        }
        self.phase = Phase::Command;
        let rdy_was_low = self.adc.rdy_low(now_ps);
        if !self.registers.write(register, value) {
            return Effect::None;
        }
        self.plan(register == Register::Mode, now_ps);
        Effect::Changed { rdy_was_low }
    }

    /// Sets MODE to idle after the last conversion of the single mode.
    pub(crate) fn finish_single(&mut self, now_ps: u64) {
        self.registers.mode &= !MODE_MD;
        self.plan(false, now_ps);
    }

    /// Sets the level of pin 18. With IOP.SYNC = 1, low holds the conversions, and a rise restarts the sequence.
    pub(crate) fn set_sync(&mut self, high: bool, now_ps: u64) {
        let rises = high && !self.sync_high;
        self.sync_high = high;
        let restart = rises && self.registers.iop & IOP_SYNC != 0;
        self.plan(restart, now_ps);
    }

    fn plan(&mut self, restart: bool, now_ps: u64) {
        let held = self.registers.iop & IOP_SYNC != 0 && !self.sync_high;
        self.adc.plan(&self.registers, held, restart, now_ps);
    }
}

#[inline]
fn one_byte(value: u8) -> Phase {
    Phase::Read { left: 1, shift: u32::from(value) << 24 }
}
