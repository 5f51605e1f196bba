//! A mock of the part: registers behind an SPI bus, written from docs/facts.md sections 2 and 3, not from the driver.

use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};
use std::rc::Rc;

use embedded_hal::digital;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

/// Address, bytes (0 = 2 or 3, as MODE sets), value after reset, readable, writable: docs/facts.md section 3.
pub const TABLE: [(u8, usize, u32, bool, bool); 13] = [
    (0x01, 1, 0x30, true, true),
    (0x02, 1, 0x24, true, false),
    (0x04, 1, 0x00, true, false),
    (0x05, 2, 0xFFFF, true, true),
    (0x08, 0, 0x8000, true, false),
    (0x0A, 0, 0x8000, true, false),
    (0x20, 1, 0x00, true, false),
    (0x22, 1, 0x40, true, false),
    (0x28, 1, 0x00, true, true),
    (0x2A, 1, 0x00, true, true),
    (0x30, 1, 0x91, true, true),
    (0x32, 1, 0x91, true, true),
    (0x38, 1, 0x00, true, true),
];

/// The bytes of F-30, as AN-1042 prints them.
pub const F30: [u8; 12] = [0x01, 0x38, 0x28, 0x0A, 0x30, 0x05, 0x2A, 0x0A, 0x32, 0x05, 0x38, 0x22];

#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub enum Line {
    #[default]
    Good,
    High,
    Low,
    /// `Flip(register, bits)` flips these bits of the answer to a read of the register.
    Flip(u8, u8),
}

#[derive(Debug, Default)]
pub struct Part {
    pub registers: HashMap<u8, u32>,
    /// MOSI bytes, one entry per CS-low frame.
    pub frames: Vec<Vec<u8>>,
    pub line: Line,
    /// The register to which writes have no effect.
    pub deaf_at: Option<u8>,
    /// Number of transfers that succeed before the bus fails.
    pub fails_after: Option<usize>,
    /// Whether the bus works again after one failure.
    pub fails_once: bool,
    /// The rates that reads of RATEDATA return in turn, each ready at once.
    pub rates: VecDeque<u32>,
    /// Whether a read of a data register clears RDY in its channel status, as in the part. Otherwise a status stays as
    /// it was set.
    pub wipes_ready: bool,
    /// The byte on SDO while the part expects a COM byte.
    pub idle: u8,
    checksum: u16,
    ones: u32,
    /// The command under way: COM byte, data (of a write: so far), bytes still to come.
    command: Option<(u8, u32, usize)>,
}

impl Part {
    pub fn new() -> Rc<RefCell<Self>> {
        let mut part = Self { idle: 0xFF, ..Self::default() };
        part.reset();
        Rc::new(RefCell::new(part))
    }

    pub fn reset(&mut self) {
        self.registers = TABLE.iter().map(|row| (row.0, row.2)).collect();
        self.checksum = 0xFFFF;
        self.command = None;
    }

    pub fn set(&mut self, address: u8, value: u32) {
        self.registers.insert(address, value);
    }

    pub fn get(&self, address: u8) -> u32 {
        self.registers[&address]
    }

    pub fn take_bytes(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.frames).concat()
    }

    fn bytes_of(&self, address: u8) -> usize {
        match TABLE.iter().find(|row| row.0 == address).expect("an address of docs/facts.md").1 {
            0 => 2 + usize::from(self.get(0x38) & 0x02 != 0),
            bytes => bytes,
        }
    }

    fn exchange(&mut self, byte: u8) -> u8 {
        self.ones = if byte == 0xFF { self.ones + 8 } else { 0 };
        if self.ones == 32 {
            self.reset();
            return 0xFF;
        }
        let answer = match self.command.take() {
            None => {
                self.start(byte);
                self.idle
            }
            Some((com, data, left)) => self.proceed(com, data, left, byte),
        };
        match self.line {
            Line::High => 0xFF,
            Line::Low => 0x00,
            _ => answer,
        }
    }

    fn start(&mut self, com: u8) {
        if com == 0xFF {
            return; // the rest of a reset that began within a command
        }
        assert_eq!(com & 0x80, 0, "b7 of COM is 0 (F-24)");
        self.feed(com);
        if com == 0 {
            self.command = Some((0, 0, 1)); // a write to COM: the next byte is not for a register
            return;
        }
        let address = com & 0x3F;
        let row = TABLE.iter().find(|row| row.0 == address).expect("an address of docs/facts.md");
        let reads = com & 0x40 != 0;
        assert!(if reads { row.3 } else { row.4 }, "direction of {address:02X}h");
        let answer = if reads { self.load(address) } else { 0 };
        self.command = Some((com, answer, self.bytes_of(address)));
    }

    fn proceed(&mut self, com: u8, data: u32, left: usize, byte: u8) -> u8 {
        let address = com & 0x3F;
        if com == 0 {
            // After a write to COM the next byte is another COM byte, or belongs to the software reset.
            match byte {
                0xFF => self.command = Some((0, 0, 1)),
                _ => self.start(byte),
            }
            return self.idle;
        }
        if com & 0x40 != 0 {
            assert_eq!(byte, 0, "a read clocks out with SDI at 0 (F-23)");
            self.command = (left > 1).then_some((com, data, left - 1));
            let flip = matches!(self.line, Line::Flip(at, _) if at == address);
            let bits = if let (true, Line::Flip(_, bits)) = (flip, self.line) { bits } else { 0 };
            return (data >> (8 * (left - 1))) as u8 ^ bits;
        }
        self.feed(byte);
        let data = data << 8 | u32::from(byte);
        if left > 1 {
            self.command = Some((com, data, left - 1));
        } else if self.deaf_at != Some(address) {
            self.set(address, data);
        }
        0xFF
    }

    fn load(&mut self, address: u8) -> u32 {
        match address {
            0x01 => self.get(0x01) & 0x3F | 0x80, // P0 happens to be high
            0x05 => self.checksum.into(),
            0x08 => {
                if let Some(rate) = self.rates.pop_front() {
                    self.set(0x08, rate);
                }
                self.data(0x08, 0x20)
            }
            0x0A => self.data(0x0A, 0x22),
            0x20 if !self.rates.is_empty() => 0x08,
            _ => self.get(address),
        }
    }

    fn data(&mut self, address: u8, status: u8) -> u32 {
        if self.wipes_ready {
            self.set(status, self.get(status) & !0x08);
        }
        self.get(address)
    }

    /// Adds a byte to the checksum, bit by bit (F-34).
    fn feed(&mut self, byte: u8) {
        for n in (0..8).rev() {
            let fed_back = self.checksum >> 15 != 0;
            self.checksum <<= 1;
            if fed_back {
                self.checksum ^= 0x2D;
            }
            self.checksum ^= u16::from(byte >> n & 1);
        }
    }
}

#[derive(Clone, Debug)]
pub struct Wire(pub Rc<RefCell<Part>>);

impl ErrorType for Wire {
    type Error = ErrorKind;
}

impl SpiDevice for Wire {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut part = self.0.borrow_mut();
        match &mut part.fails_after {
            Some(0) => {
                if part.fails_once {
                    part.fails_after = None;
                }
                return Err(ErrorKind::Other);
            }
            Some(left) => *left -= 1,
            None => {}
        }
        part.ones = 0;
        let mut frame = Vec::new();
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    frame.extend_from_slice(bytes);
                    bytes.iter().for_each(|&byte| {
                        part.exchange(byte);
                    });
                }
                Operation::TransferInPlace(bytes) => {
                    frame.extend_from_slice(bytes);
                    bytes.iter_mut().for_each(|byte| *byte = part.exchange(*byte));
                }
                other => panic!("{other:?} does not define what SDI does"),
            }
        }
        part.frames.push(frame);
        Ok(())
    }
}

/// A pin. As an input, the pin is low after `looks_until_low` reads. As an output, it records its levels.
#[derive(Clone, Debug, Default)]
pub struct Pin(pub Rc<RefCell<PinState>>);

#[derive(Debug, Default)]
pub struct PinState {
    pub looks_until_low: u32,
    pub looks: u32,
    pub levels: Vec<bool>,
    /// The level to which the pin cannot be set.
    pub refuses: Option<bool>,
}

impl digital::ErrorType for Pin {
    type Error = digital::ErrorKind;
}

impl Pin {
    fn set(&self, high: bool) -> Result<(), digital::ErrorKind> {
        let mut pin = self.0.borrow_mut();
        pin.levels.push(high);
        if pin.refuses == Some(high) { Err(digital::ErrorKind::Other) } else { Ok(()) }
    }
}

impl digital::InputPin for Pin {
    fn is_low(&mut self) -> Result<bool, digital::ErrorKind> {
        let mut pin = self.0.borrow_mut();
        pin.looks += 1;
        Ok(pin.looks > pin.looks_until_low)
    }

    fn is_high(&mut self) -> Result<bool, digital::ErrorKind> {
        self.is_low().map(|low| !low)
    }
}

impl digital::OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), digital::ErrorKind> {
        self.set(false)
    }

    fn set_high(&mut self) -> Result<(), digital::ErrorKind> {
        self.set(true)
    }
}

/// Adds up the requested delays, in ns.
#[derive(Clone, Debug, Default)]
pub struct Delay(pub Rc<RefCell<u64>>);

impl embedded_hal::delay::DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        *self.0.borrow_mut() += u64::from(ns);
    }
}

#[cfg(feature = "async")]
pub use asynch::now;

#[cfg(feature = "async")]
mod asynch {
    use super::{Delay, ErrorKind, Operation, Pin, SpiDevice, Wire, digital};
    use embedded_hal::digital::InputPin;
    use std::future::{Future, pending};
    use std::pin::pin;
    use std::task::{Context, Poll, Waker};

    /// Returns the output of a future. One poll must be enough, since neither the mock nor the twin waits.
    pub fn now<F: Future>(future: F) -> F::Output {
        match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(output) => output,
            Poll::Pending => panic!("waits for something that never comes"),
        }
    }

    impl embedded_hal_async::spi::SpiDevice for Wire {
        async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
            SpiDevice::transaction(self, operations)
        }
    }

    impl embedded_hal_async::digital::Wait for Pin {
        async fn wait_for_low(&mut self) -> Result<(), digital::ErrorKind> {
            if self.is_low()? { Ok(()) } else { pending().await }
        }

        async fn wait_for_high(&mut self) -> Result<(), digital::ErrorKind> {
            if self.is_high()? { Ok(()) } else { pending().await }
        }

        async fn wait_for_rising_edge(&mut self) -> Result<(), digital::ErrorKind> {
            pending().await
        }

        async fn wait_for_falling_edge(&mut self) -> Result<(), digital::ErrorKind> {
            pending().await
        }

        async fn wait_for_any_edge(&mut self) -> Result<(), digital::ErrorKind> {
            pending().await
        }
    }

    impl embedded_hal_async::delay::DelayNs for Delay {
        async fn delay_ns(&mut self, ns: u32) {
            embedded_hal::delay::DelayNs::delay_ns(self, ns);
        }
    }
}
