//! The fields of the registers in plain words, for programs that show them.

/// A field of a register: adjacent bits with a name and a meaning.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// The name in docs/facts.md section 3.
    pub name: &'static str,
    /// The bits of the field.
    pub mask: u32,
    /// The meaning of the field's values.
    pub meaning: Meaning,
}

/// The meaning of the values of a field.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// A bit: the texts for clear and for set.
    Bit([&'static str; 2]),
    /// A bit that shows the level of a pin, not the written bit: the texts for low and for high.
    Level([&'static str; 2]),
    /// A bit that is set if something is wrong: the texts for clear and for set.
    Alarm([&'static str; 2]),
    /// The meaning of 0, of 1 and so on. Greater values are not described for this part.
    Choice(&'static [&'static str]),
    /// A number without a unit, with its meaning.
    Number(&'static str),
    /// The number of the channel that the status belongs to: 0 is rate, 2 is temperature.
    Channel,
    /// The filter word of a conversion time (F-31).
    FilterWord,
    /// A rate code (F-40).
    Rate,
    /// A temperature code (F-41).
    Temp,
}

impl Field {
    /// The value of the field in the value of a register.
    #[must_use]
    pub const fn of(&self, register: u32) -> u32 {
        (register & self.mask) >> self.mask.trailing_zeros()
    }
}
