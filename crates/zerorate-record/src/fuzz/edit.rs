//! Random edits for files of any format, aimed at common weak points: lengths, offsets, ends.

/// The random bytes that determine the edits.
pub type Draw = [u8; 1 + MOST_EDITS * EDIT_BYTES];

const MOST_EDITS: usize = 4;
const EDIT_BYTES: usize = 8;

/// Largest number of bytes that all edits together can add.
pub const MOST_ADDED: usize = MOST_EDITS * 255;

/// One to four edits, in order.
#[derive(Clone, Debug)]
pub struct Edits(Vec<Edit>);

#[derive(Clone, Copy, Debug)]
enum Edit {
    /// Flips one bit.
    Flip { at: Place, bit: u8 },
    /// Replaces one byte.
    Byte { at: Place, byte: u8 },
    /// Overwrites a number with an extreme one.
    Number { at: Place, number: u64, width: usize, big_endian: bool },
    /// Truncates the file.
    Truncate { at: Place },
    /// Removes some bytes.
    Remove { at: Place, length: u8 },
    /// Inserts a copy of some bytes at another place.
    Splice { from: Place, to: Place, length: u8 },
    /// Inserts `length` copies of one byte.
    Fill { at: Place, byte: u8, length: u8 },
}

/// The place of an edit. The head and the end of a file often decide how the rest is read.
#[derive(Clone, Copy, Debug)]
enum Place {
    Head(u8),
    End(u8),
    /// A fraction of the file, in units of 1/65536.
    Anywhere(u16),
}

/// Extreme numbers: zero, limits of integer types, and sizes that need hardly any or far too much memory.
const NUMBERS: [u64; 16] = [
    0,
    1,
    7,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0xFFFF,
    1 << 24,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    1 << 40,
    i64::MAX as u64,
    1 << 63,
    u64::MAX,
];

impl Edits {
    /// Decodes the edits from random bytes.
    pub fn of(draw: &Draw) -> Self {
        let count = 1 + usize::from(draw[0]) % MOST_EDITS;
        Self(draw[1..].as_chunks::<EDIT_BYTES>().0.iter().take(count).map(Edit::of).collect())
    }

    pub fn apply(&self, bytes: &[u8]) -> Vec<u8> {
        let mut edited = bytes.to_vec();
        self.0.iter().for_each(|edit| edit.apply(&mut edited));
        edited
    }
}

impl Edit {
    fn of(&[kind, a0, a1, a2, b0, b1, byte, length]: &[u8; EDIT_BYTES]) -> Self {
        let at = Place::of(a0, a1, a2);
        match kind % 12 {
            0..3 => Self::Flip { at, bit: byte % 8 },
            3..5 => Self::Byte { at, byte },
            5..8 => {
                let number = NUMBERS[usize::from(byte) % NUMBERS.len()];
                Self::Number { at, number, width: 1 << (length % 4), big_endian: length & 4 != 0 }
            }
            8 => Self::Truncate { at },
            9 => Self::Remove { at, length },
            10 => Self::Splice { from: at, to: Place::of(b0, b1, byte), length },
            _ => Self::Fill { at, byte, length },
        }
    }

    fn apply(self, bytes: &mut Vec<u8>) {
        let whole = bytes.len();
        let span = |at: Place, length: u8| at.within(whole)..whole.min(at.within(whole) + usize::from(length));
        match self {
            Self::Flip { at, bit } => {
                if let Some(byte) = bytes.get_mut(at.within(whole)) {
                    *byte ^= 1 << bit;
                }
            }
            Self::Byte { at, byte: new } => {
                if let Some(byte) = bytes.get_mut(at.within(whole)) {
                    *byte = new;
                }
            }
            Self::Number { at, number, width, big_endian } => {
                let mut new = number.to_le_bytes()[..width].to_vec();
                if big_endian {
                    new.reverse();
                }
                bytes.iter_mut().skip(at.within(whole)).zip(new).for_each(|(byte, new)| *byte = new);
            }
            Self::Truncate { at } => bytes.truncate(at.within(whole)),
            Self::Remove { at, length } => drop(bytes.drain(span(at, length))),
            Self::Splice { from, to, length } => {
                let copy = bytes[span(from, length)].to_vec();
                let to = to.within(whole);
                bytes.splice(to..to, copy);
            }
            Self::Fill { at, byte, length } => {
                let at = at.within(whole);
                bytes.splice(at..at, std::iter::repeat_n(byte, length.into()));
            }
        }
    }
}

impl Place {
    fn of(kind: u8, low: u8, high: u8) -> Self {
        match kind % 4 {
            0 => Self::Head(low),
            1 => Self::End(low),
            _ => Self::Anywhere(u16::from_le_bytes([low, high])),
        }
    }

    /// The offset in a file of `length` bytes, at most `length`.
    fn within(self, length: usize) -> usize {
        match self {
            Self::Head(at) => usize::from(at).min(length),
            Self::End(back) => length.saturating_sub(back.into()),
            Self::Anywhere(part) => (length as u64 * u64::from(part) / 65536) as usize,
        }
    }
}
