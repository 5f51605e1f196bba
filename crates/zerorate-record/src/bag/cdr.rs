//! Common Data Representation of OMG as ROS 2 writes it: little endian, numbers aligned to their size.

/// The mark that states the encoding of a message: CDR, little endian.
const MARK: [u8; 4] = [0, 1, 0, 0];

/// A message that grows.
pub struct Cdr(Vec<u8>);

impl Cdr {
    /// Without a field.
    pub fn new() -> Self {
        Self(MARK.to_vec())
    }

    /// A number in its bytes, lowest first.
    pub fn number<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        let place = (self.0.len() - MARK.len()).next_multiple_of(N);
        self.0.resize(MARK.len() + place, 0);
        self.0.extend(bytes);
        self
    }

    /// Adds these numbers, one after the other.
    pub fn doubles(&mut self, values: &[f64]) -> &mut Self {
        values.iter().fold(self, |message, value| message.number(value.to_le_bytes()))
    }

    /// A text, with its length and a zero.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.number((text.len() as u32 + 1).to_le_bytes());
        self.0.extend(text.bytes());
        self.0.push(0);
        self
    }

    /// The head of most messages: when, ns, and in which frame. Seconds beyond what fits are cut off.
    pub fn head(&mut self, stamp_ns: u64, frame: &str) -> &mut Self {
        let (sec, nanosec) = ((stamp_ns / 1_000_000_000) as i32, (stamp_ns % 1_000_000_000) as u32);
        self.number(sec.to_le_bytes()).number(nanosec.to_le_bytes()).text(frame)
    }

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// A message that is read.
pub struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Fields<'a> {
    /// None if it is written in another way.
    pub fn of(message: &'a [u8]) -> Option<Self> {
        Some(Self { bytes: message.strip_prefix(&MARK)?, at: 0 })
    }

    /// The next number.
    pub fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        let at = self.at.next_multiple_of(N);
        let bytes = *self.bytes.get(at..)?.first_chunk()?;
        self.at = at + N;
        Some(bytes)
    }

    /// The next text.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = u32::from_le_bytes(self.number()?) as usize;
        let bytes = self.bytes.get(self.at..)?.get(..length)?;
        self.at += length;
        std::str::from_utf8(bytes.strip_suffix(&[0])?).ok()
    }

    /// Whether there is nothing more.
    pub fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }
}
