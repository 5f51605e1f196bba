//! The registers of an ADIS16130 in plain words (docs/facts.md section 3).

use crate::message::{Field, Register};
use adis16130::registers::{Address, ChannelSetup, ChannelStatus, ConversionTime, Iop, Mode, Operation, Range};
use adis16130::{Config, MCLK_HZ, RateCode, TempCode, Width};

/// What was read, register by register, in plain words; `config` is what was written before. A field that reads
/// otherwise than it was written is wrong.
#[must_use]
pub fn described(config: &Config, values: &[(Address, u32)]) -> Vec<Register> {
    values.iter().map(|(address, value)| register(config, *address, *value)).collect()
}

fn register(config: &Config, address: Address, value: u32) -> Register {
    let bits = match address {
        Address::Checksum => 16,
        Address::RateData | Address::TempData => config.width().bits(),
        _ => 8,
    };
    let mut fields = fields(address, value, config.width());
    let written = config.writes().find(|write| write.address == address);
    if let Some(&[_, written]) = written.as_ref().map(|write| write.frame.bytes()) {
        mark_different(&mut fields, self::fields(address, written.into(), config.width()));
    }
    Register { name: address.name().to_owned(), address: address as u32, value, bits, fields }
}

fn mark_different(read: &mut [Field], written: Vec<Field>) {
    for (field, written) in read.iter_mut().zip(written) {
        if field.value != written.value && !LEVELS.contains(&&*field.name) {
            field.wrong = true;
            field.meaning += &format!(" (written was {}: {})", written.value, written.meaning);
        }
    }
}

/// Fields that show the levels of pins, whatever was written.
const LEVELS: [&str; 2] = ["P0", "P1"];

fn fields(address: Address, value: u32, width: Width) -> Vec<Field> {
    let byte = value as u8;
    match address {
        Address::Com => Vec::new(),
        Address::Iop => iop(Iop::new(byte)),
        Address::Revision => vec![field("REVISION", value, "of the converter inside")],
        Address::AdcStatus => adc_status(byte),
        Address::Checksum => vec![field("CHECKSUM", value, "over all bits written since the reset (F-34)")],
        Address::RateData => vec![rate(RateCode::new(value, width))],
        Address::TempData => vec![temp(TempCode::new(value, width))],
        Address::RateStatus => status(ChannelStatus::new(byte), RATE_CHANNEL),
        Address::TempStatus => status(ChannelStatus::new(byte), TEMP_CHANNEL),
        Address::RateCs | Address::TempCs => setup(ChannelSetup::new(byte)),
        Address::RateConv | Address::TempConv => conversion(ConversionTime::new(byte)),
        Address::Mode => mode(Mode::new(byte)),
    }
}

/// Of the converter inside (docs/facts.md section 3).
const RATE_CHANNEL: u8 = 0;
const TEMP_CHANNEL: u8 = 2;

fn field(name: &str, value: impl Into<u32>, meaning: impl Into<String>) -> Field {
    Field { name: name.to_owned(), value: value.into(), meaning: meaning.into(), wrong: false }
}

/// A bit that is as it should be, or not.
fn bit(name: &str, set: bool, [clear_means, set_means]: [&str; 2]) -> Field {
    field(name, set, if set { set_means } else { clear_means })
}

fn wrong_if(wrong: bool, field: Field) -> Field {
    Field { wrong, ..field }
}

fn iop(iop: Iop) -> Vec<Field> {
    let direction = ["output", "input"];
    vec![
        bit("P0", iop.p0(), ["pin P0 is low", "pin P0 is high"]),
        bit("P1", iop.p1(), ["pin P1 is low", "pin P1 is high"]),
        bit("P0DIR", iop.p0_is_input(), direction),
        bit("P1DIR", iop.p1_is_input(), direction),
        bit(
            "RDYFN",
            iop.rdyfn(),
            ["data ready (RDY) tells that any channel has new data", "data ready (RDY) tells that all channels have"],
        ),
        bit("SYNC", iop.sync(), ["the pin SYNC is not used", "the pin SYNC is in use"]),
    ]
}

fn adc_status(bits: u8) -> Vec<Field> {
    let waiting = ["nothing waits to be read", "a reading waits"];
    vec![bit("RATE", bits & 1 != 0, waiting), bit("TEMP", bits & 4 != 0, waiting)]
}

fn rate(code: RateCode) -> Field {
    field("RATE", code.code(), format!("{:+.4} °/s, uncorrected", code.to_dps()))
}

fn temp(code: TempCode) -> Field {
    field("TEMP", code.code(), format!("{:.3} °C", code.to_celsius()))
}

fn status(status: ChannelStatus, channel: u8) -> Vec<Field> {
    let right = status.channel() == channel;
    let of_channel = if right { "of this channel" } else { "of another channel: the bus or the part is at fault" };
    vec![
        wrong_if(!right, field("CHANNEL", status.channel(), of_channel)),
        bit("RDY", status.ready(), ["nothing waits to be read", "a reading waits"]),
        wrong_if(
            status.no_reference(),
            bit("NOREF", status.no_reference(), ["the reference is there", "no reference: readings mean nothing"]),
        ),
        bit("SIGN", status.negative(), ["the input is positive", "the input is negative"]),
        wrong_if(
            status.out_of_range(),
            bit("OVR", status.out_of_range(), ["in range", "the input is beyond the range"]),
        ),
    ]
}

fn setup(setup: ChannelSetup) -> Vec<Field> {
    let range = match setup.range() {
        Range::Bits00 => (0u32, "not the range that the part's scale is for"),
        Range::Bits01 => (1, "not the range that the part's scale is for"),
        Range::Bits10 => (2, "the range that the part's scale is for"),
        Range::Bits11 => (3, "not the range that the part's scale is for"),
    };
    vec![
        bit("STATOPT", setup.statopt(), ["the status is that of the channel alone", "the status is extended"]),
        bit("ENABLE", setup.enabled(), ["the channel is not converted", "the channel is converted"]),
        field("RANGE", range.0, range.1),
    ]
}

fn conversion(word: ConversionTime) -> Vec<Field> {
    let took_us = f64::from(word.cycles(true)) * 1e6 / f64::from(MCLK_HZ);
    vec![
        bit("CHOP", word.chop(), ["one conversion for each reading", "the mean of two, with exchanged inputs"]),
        field("FW", word.filter_word(), format!("a conversion takes {took_us:.2} µs at 6 MHz (F-31)")),
    ]
}

fn mode(mode: Mode) -> Vec<Field> {
    let operation = match mode.operation() {
        Operation::Idle => (0u32, "idle: nothing is converted"),
        Operation::Continuous => (1, "all enabled channels are converted in turn"),
        Operation::Single => (2, "one conversion"),
        Operation::PowerDown => (3, "powered down"),
        Operation::Other(bits) => (bits.into(), "not described for this part"),
    };
    vec![
        field("MD", operation.0, operation.1),
        bit("CLKDIS", mode.clkdis(), ["the clock is given out", "the clock is not given out"]),
        bit("DUMP", mode.dump(), ["readings come alone", "readings come with their status"]),
        bit("CONTRD", mode.contrd(), ["each reading is asked for", "readings come without being asked for"]),
        bit("24/16", mode.width() == Width::Bits24, ["16 bits a reading", "24 bits a reading"]),
        bit(
            "CLAMP",
            mode.clamp(),
            ["a code out of range wraps (F-35)", "a code out of range stays at the end (F-35)"],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As F-30 leaves them, typed from docs/facts.md.
    const AFTER_F30: [(Address, u32); 7] = [
        (Address::Iop, 0xF8),
        (Address::RateCs, 0x0A),
        (Address::RateConv, 0x05),
        (Address::TempStatus, 0x48),
        (Address::RateData, 0x80_0000 + 23_488),
        (Address::TempData, 0x80_0000 - 14_093),
        (Address::Mode, 0x22),
    ];

    fn meanings(registers: &[Register], name: &str) -> Vec<String> {
        let found = registers.iter().find(|register| register.name == name).expect("it was read");
        found.fields.iter().map(|field| field.meaning.clone()).collect()
    }

    #[test]
    fn what_was_written_reads_back_and_is_said_in_words() {
        let registers = described(&Config::new(), &AFTER_F30);
        assert!(registers.iter().flat_map(|register| &register.fields).all(|field| !field.wrong));
        assert_eq!(meanings(&registers, "RATECONV")[1], "a conversion takes 87.83 µs at 6 MHz (F-31)");
        // F-40, F-41: 23488 codes are 1 °/s, 14093 are 1 °C, 25 °C at the zero code
        assert_eq!(meanings(&registers, "RATEDATA"), ["+1.0000 °/s, uncorrected"]);
        assert_eq!(meanings(&registers, "TEMPDATA"), ["24.000 °C"]);
        assert_eq!(meanings(&registers, "MODE")[0], "all enabled channels are converted in turn");
        assert_eq!(registers[4].bits, 24);
        let narrow = Config::new().with_width(Width::Bits16);
        assert_eq!(described(&narrow, &[(Address::RateData, 0x8000)])[0].bits, 16);
    }

    /// A brown-out resets MODE to 0; a crossed wire shows another channel.
    #[test]
    fn what_reads_otherwise_is_wrong_and_says_what_was_written() {
        let read = [(Address::Mode, 0x00), (Address::RateStatus, 0x45), (Address::Iop, 0x38)];
        let registers = described(&Config::new(), &read);
        let wrong: Vec<&str> = registers
            .iter()
            .flat_map(|register| &register.fields)
            .filter(|field| field.wrong)
            .map(|field| &*field.name)
            .collect();
        assert_eq!(wrong, ["MD", "24/16", "CHANNEL", "NOREF", "OVR"]);
        let told = "idle: nothing is converted (written was 1: all enabled channels are converted in turn)";
        assert_eq!(meanings(&registers, "MODE")[0], told);
    }
}
