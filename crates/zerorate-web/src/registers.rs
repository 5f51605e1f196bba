//! Describes the registers of an ADIS16130 in plain words (docs/facts.md section 3).

use crate::message::{Field, Register};
use adis16130::registers::{self, Address, ConversionTime, Meaning, RateStatus, Register as _, TempStatus};
use adis16130::{Config, MCLK_HZ, RateCode, TempCode, Width};

/// Describes every register with its fields. `config` was written before. A field is marked as wrong if it reads back
/// differently, or shows an alarm or another channel.
#[must_use]
pub fn described(config: &Config, values: &[(Address, u32)]) -> Vec<Register> {
    values.iter().map(|(address, value)| register(config, *address, *value)).collect()
}

fn register(config: &Config, address: Address, value: u32) -> Register {
    let write = config.writes().find(|write| write.address == address);
    let written = write.as_ref().and_then(|write| write.frame.bytes().get(1)).map(|byte| u32::from(*byte));
    let shown = |field: &registers::Field| {
        let read = shown(address, field, value, config.width());
        match written.map(|written| self::shown(address, field, written, config.width())) {
            Some(written) if written.value != read.value && !matches!(field.meaning, Meaning::Level(_)) => Field {
                meaning: format!("{} (written: {}, {})", read.meaning, written.value, written.meaning),
                wrong: true,
                ..read
            },
            _ => read,
        }
    };
    Register {
        name: address.name().to_owned(),
        address: address as u32,
        value,
        bits: 8 * address.size().bytes(config.width()) as u32,
        fields: address.fields().iter().map(shown).collect(),
    }
}

/// Describes a field of the register at `address` with the content `register`.
fn shown(address: Address, field: &registers::Field, register: u32, width: Width) -> Field {
    let value = field.of(register);
    let (wrong, meaning) = match field.meaning {
        Meaning::Bit(words) | Meaning::Level(words) => (false, words[value as usize].to_owned()),
        Meaning::Alarm(words) => (value != 0, words[value as usize].to_owned()),
        Meaning::Choice(words) => {
            (false, (*words.get(value as usize).unwrap_or(&"not described for this part")).to_owned())
        }
        Meaning::Number(words) => (false, words.to_owned()),
        Meaning::Channel if value == own_channel(address) => (false, "of this channel".to_owned()),
        Meaning::Channel => (true, "of another channel: bus or sensor is at fault".to_owned()),
        Meaning::FilterWord => (false, conversion(ConversionTime::new(register as u8))),
        Meaning::Rate => (false, format!("{:+.4} °/s, uncorrected", RateCode::new(value, width).to_dps())),
        Meaning::Temp => (false, format!("{:.3} °C", TempCode::new(value, width).to_celsius())),
    };
    Field { name: field.name.to_owned(), value, meaning, wrong }
}

/// The channel number that a status register has after reset.
fn own_channel(address: Address) -> u32 {
    let reset = if address == Address::TempStatus { TempStatus::RESET } else { RateStatus::RESET };
    reset.channel().into()
}

fn conversion(word: ConversionTime) -> String {
    let took_us = f64::from(word.cycles(true)) * 1e6 / f64::from(MCLK_HZ);
    format!("a conversion takes {took_us:.2} µs at 6 MHz (F-31)")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Some registers after F-30 (docs/facts.md), with the readings 1 °/s and 24 °C.
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
    fn written_values_read_back_and_are_explained() {
        let registers = described(&Config::new(), &AFTER_F30);
        assert!(registers.iter().flat_map(|register| &register.fields).all(|field| !field.wrong));
        assert_eq!(meanings(&registers, "RATECONV")[1], "a conversion takes 87.83 µs at 6 MHz (F-31)");
        // F-40, F-41: 23488 codes are 1 °/s, 14093 codes are 1 °C, and the zero code is 25 °C
        assert_eq!(meanings(&registers, "RATEDATA"), ["+1.0000 °/s, uncorrected"]);
        assert_eq!(meanings(&registers, "TEMPDATA"), ["24.000 °C"]);
        assert_eq!(meanings(&registers, "MODE")[0], "all enabled channels are converted in turn");
        assert_eq!(registers[4].bits, 24);
        let narrow = Config::new().with_width(Width::Bits16);
        assert_eq!(described(&narrow, &[(Address::RateData, 0x8000)])[0].bits, 16);
    }

    /// Names and order from docs/facts.md section 3.
    #[test]
    fn each_register_shows_its_fields_in_this_order() {
        let expected = [
            (Address::Iop, "P0 P1 P0DIR P1DIR RDYFN SYNC"),
            (Address::Revision, "REVISION"),
            (Address::AdcStatus, "RATE TEMP"),
            (Address::Checksum, "CHECKSUM"),
            (Address::RateData, "RATE"),
            (Address::TempData, "TEMP"),
            (Address::RateStatus, "CHANNEL RDY NOREF SIGN OVR"),
            (Address::TempStatus, "CHANNEL RDY NOREF SIGN OVR"),
            (Address::RateCs, "STATOPT ENABLE RANGE"),
            (Address::TempCs, "STATOPT ENABLE RANGE"),
            (Address::RateConv, "CHOP FW"),
            (Address::TempConv, "CHOP FW"),
            (Address::Mode, "MD CLKDIS DUMP CONTRD 24/16 CLAMP"),
        ];
        for (address, fields) in expected {
            let shown = &described(&Config::new(), &[(address, 0)])[0];
            let names: Vec<&str> = shown.fields.iter().map(|field| &*field.name).collect();
            assert_eq!(names.join(" "), fields, "{address}");
        }
    }

    /// A brown-out resets MODE to 0; a crossed wire shows another channel.
    #[test]
    fn a_register_that_reads_otherwise_states_what_was_written() {
        let read = [(Address::Mode, 0x00), (Address::RateStatus, 0x45), (Address::Iop, 0x38)];
        let registers = described(&Config::new(), &read);
        let wrong: Vec<&str> = registers
            .iter()
            .flat_map(|register| &register.fields)
            .filter(|field| field.wrong)
            .map(|field| &*field.name)
            .collect();
        assert_eq!(wrong, ["MD", "24/16", "CHANNEL", "NOREF", "OVR"]);
        let told = "idle: nothing is converted (written: 1, all enabled channels are converted in turn)";
        assert_eq!(meanings(&registers, "MODE")[0], told);
    }
}
