//! The register table, the values of the registers, and the checksum over the written bits.

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Rate,
    Temp,
}

impl Channel {
    pub(crate) const ALL: [Self; 2] = [Self::Rate, Self::Temp];

    /// The number of the channel in the part's registers: 0 for the rate, 2 for the temperature.
    pub(crate) const fn number(self) -> u8 {
        2 * self as u8
    }

    /// The bit of the channel in the sets of channels of this crate.
    pub(crate) const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// The register at an address (`docs/facts.md` section 3).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Register {
    Com,
    Iop,
    Revision,
    AdcStatus,
    Checksum,
    Data(Channel),
    Status(Channel),
    Setup(Channel),
    Conversion(Channel),
    Mode,
    /// The address has no register. A read gives one byte 00h, and a write ignores one byte.
    Unknown,
}

impl Register {
    #[inline]
    pub(crate) const fn at(address: u8) -> Self {
        match address {
            0x00 => Self::Com,
            0x01 => Self::Iop,
            0x02 => Self::Revision,
            0x04 => Self::AdcStatus,
            0x05 => Self::Checksum,
            0x08 => Self::Data(Channel::Rate),
            0x0A => Self::Data(Channel::Temp),
            0x20 => Self::Status(Channel::Rate),
            0x22 => Self::Status(Channel::Temp),
            0x28 => Self::Setup(Channel::Rate),
            0x2A => Self::Setup(Channel::Temp),
            0x30 => Self::Conversion(Channel::Rate),
            0x32 => Self::Conversion(Channel::Temp),
            0x38 => Self::Mode,
            _ => Self::Unknown,
        }
    }

    /// Number of data bytes of a write to this register. `wide` = the data registers have 24 bits. A write to a data
    /// register has as many bytes as the register, although it is ignored.
    pub(crate) const fn write_len(self, wide: bool) -> u8 {
        match self {
            Self::Com => 0,
            Self::Checksum => 2,
            Self::Data(_) => 2 + wide as u8,
            _ => 1,
        }
    }
}

/// IOP bit 7: level of P0.
pub(crate) const IOP_P0: u8 = 1 << 7;
/// IOP bit 6: level of P1, which is pin 18.
pub(crate) const IOP_P1: u8 = 1 << 6;
pub(crate) const IOP_P0_INPUT: u8 = 1 << 5;
pub(crate) const IOP_P1_INPUT: u8 = 1 << 4;
/// IOP bit 3: RDY falls only when all enabled channels hold unread data.
pub(crate) const IOP_RDYFN: u8 = 1 << 3;
/// IOP bit 0: pin 18 is SYNC.
pub(crate) const IOP_SYNC: u8 = 1 << 0;
pub(crate) const SETUP_ENABLE: u8 = 1 << 3;
pub(crate) const CONVERSION_CHOP: u8 = 1 << 7;
/// MODE bits 7–5, MD: the operating mode.
pub(crate) const MODE_MD: u8 = 0b111 << 5;
pub(crate) const MODE_CONTINUOUS: u8 = 0b001 << 5;
/// MODE MD = 010: each enabled channel once.
pub(crate) const MODE_SINGLE: u8 = 0b010 << 5;
pub(crate) const MODE_24BIT: u8 = 1 << 1;
/// MODE bit 0: out-of-range codes saturate instead of wrapping.
pub(crate) const MODE_CLAMP: u8 = 1 << 0;

/// Value of the revision register of an AD7732.
const REVISION: u8 = 0x24;

/// The registers that keep the values written to them.
#[derive(Clone, Debug)]
pub(crate) struct Registers {
    pub(crate) iop: u8,
    pub(crate) setup: [u8; 2],
    pub(crate) conversion: [u8; 2],
    pub(crate) mode: u8,
    pub(crate) checksum: Checksum,
}

impl Registers {
    pub(crate) const RESET: Self =
        Self { iop: 0x30, setup: [0x00; 2], conversion: [0x91; 2], mode: 0x00, checksum: Checksum(0xFFFF) };

    pub(crate) const fn wide(&self) -> bool {
        self.mode & MODE_24BIT != 0
    }

    /// The enabled channels as a set of [`Channel::bit`].
    pub(crate) fn enabled(&self) -> u8 {
        let bit = |channel: Channel| {
            if self.setup[channel as usize] & SETUP_ENABLE != 0 { channel.bit() } else { 0 }
        };
        bit(Channel::Rate) | bit(Channel::Temp)
    }

    /// MCLK cycles of one conversion of `channel` (F-31).
    pub(crate) fn conversion_cycles(&self, channel: Channel) -> u32 {
        let word = self.conversion[channel as usize];
        let both = u32::from(self.enabled() == 0b11);
        let filter = u32::from(word & !CONVERSION_CHOP);
        if word & CONVERSION_CHOP != 0 { filter * 128 + 248 + both } else { filter * 64 + 206 + both }
    }

    /// Completes a write. Returns whether the register can be written.
    pub(crate) fn write(&mut self, register: Register, value: u16) -> bool {
        let byte = value as u8;
        match register {
            Register::Iop => self.iop = byte,
            Register::Checksum => self.checksum = Checksum(value),
            Register::Setup(channel) => self.setup[channel as usize] = byte,
            Register::Conversion(channel) => self.conversion[channel as usize] = byte,
            Register::Mode => self.mode = byte,
            _ => return false,
        }
        true
    }

    /// Value of an 8-bit register of this structure or of REVISION, 00h for others. `p1` is the level of pin 18.
    pub(crate) fn read(&self, register: Register, p1: bool) -> u8 {
        match register {
            Register::Iop => self.iop_levels(p1),
            Register::Revision => REVISION,
            Register::Setup(channel) => self.setup[channel as usize],
            Register::Conversion(channel) => self.conversion[channel as usize],
            Register::Mode => self.mode,
            _ => 0x00,
        }
    }

    /// IOP with the pin levels in b7–6: an input shows its level (P0 is tied low), an output the written level.
    fn iop_levels(&self, p1: bool) -> u8 {
        let mut value = self.iop;
        if value & IOP_P0_INPUT != 0 {
            value &= !IOP_P0;
        }
        if value & IOP_P1_INPUT != 0 {
            value &= !IOP_P1;
            value |= if p1 { IOP_P1 } else { 0 };
        }
        value
    }
}

/// The checksum register: a 16-bit LFSR over every written bit (F-34).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Checksum(pub(crate) u16);

impl Checksum {
    /// Takes in eight bits at once. No bit that the feedback 2Dh sets is shifted out within the same byte. So the
    /// feedback of a whole byte is the carry-less product of 2Dh and the byte that is shifted out.
    #[inline]
    pub(crate) fn take(&mut self, byte: u8) {
        let out = self.0 >> 8;
        let feedback = (out << 5) ^ (out << 3) ^ (out << 2) ^ out;
        self.0 = ((self.0 << 8) | u16::from(byte)) ^ feedback;
    }
}
