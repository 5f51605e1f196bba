//! The Intel La Jolla Cove adapter (8086:0b63) as a USB device: its descriptors and its messages, without a socket
//! or a part. README.md specifies the answers.

use super::redir::{Announcement, Control};

/// Number of GPIO lines of the adapter. One of them is RDY.
pub const PINS: u8 = 8;
/// The GPIO line of RDY.
pub const RDY_PIN: u8 = 3;
/// Largest size of a message, bytes: one USB packet.
pub const LONGEST_MESSAGE: usize = 64;

pub const ANNOUNCEMENT: Announcement = Announcement {
    vendor: 0x8086,
    product: 0x0b63,
    version_bcd: 0x0100,
    class: 255,
    interface_class: 255,
    bulk: [0x01, 0x82],
    max_packet: 64,
};

/// Device descriptor: USB 2.0, vendor class, 8086:0b63, strings 1 and 2, one configuration.
const DEVICE_DESCRIPTOR: [u8; 18] = [18, 1, 0, 2, 255, 0, 0, 64, 0x86, 0x80, 0x63, 0x0b, 0, 1, 1, 2, 0, 1];
/// Configuration descriptor: one configuration, one vendor-class interface, bulk out 1 and bulk in 2 with 64 bytes.
#[rustfmt::skip]
const CONFIGURATION_DESCRIPTOR: [u8; 32] = [
    9, 2, 32, 0, 1, 1, 0, 0x80, 50,
    9, 4, 0, 0, 2, 255, 0, 0, 0,
    7, 5, 0x01, 2, 64, 0, 0,
    7, 5, 0x82, 2, 64, 0, 0,
];
const STRINGS: [&str; 2] = ["zerorate", "ADIS16130 twin on an LJCA adapter"];

const ACK: u8 = 1 << 0;
const COMPLETE: u8 = 1 << 2;
const HEAD: usize = 4;

const MANAGEMENT: u8 = 1;
const GPIO: u8 = 3;
const SPI: u8 = 5;

const GPIO_INTERRUPT: u8 = 1 << 6;
const GPIO_EVENT: u8 = 4;

/// SPI mode 3: clock polarity and phase both set (F-20).
const MODE_3: u8 = 0b11;

/// The hardware behind the adapter.
pub trait Board {
    /// Transfers one frame of CS with the clock in mode 3. Returns the bytes received while `mosi` was sent.
    fn frame(&mut self, mosi: &[u8]) -> Vec<u8>;
    fn rdy_high(&mut self) -> bool;
}

#[derive(Debug, Default)]
pub struct Ljca {
    /// The interrupt state of each GPIO line. A pending interrupt is reported once the line is unmasked.
    lines: [Line; PINS as usize],
    spi_mode: u8,
    /// Number of events for the host since the adapter was last reset.
    pub events: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Line {
    interrupt: bool,
    unmasked: bool,
    pending: bool,
}

impl Ljca {
    /// Answers a control transfer; `None` stalls it.
    pub fn control(&mut self, control: &Control) -> Option<Vec<u8>> {
        const GET_STATUS: u8 = 0;
        const CLEAR_FEATURE: u8 = 1;
        const SET_FEATURE: u8 = 3;
        const GET_DESCRIPTOR: u8 = 6;
        let length = usize::from(control.length);
        let mut answer = match (control.is_in(), control.request) {
            (true, GET_DESCRIPTOR) => descriptor(control.value)?,
            (true, GET_STATUS) => vec![0, 0],
            (false, CLEAR_FEATURE | SET_FEATURE) => vec![],
            _ => return None,
        };
        answer.truncate(length);
        Some(answer)
    }

    /// Handles a message of the host and returns the answers in order. Bytes that are not a message have no answer.
    pub fn message(&mut self, bytes: &[u8], board: &mut impl Board) -> Vec<Vec<u8>> {
        let &[kind, command, flags, length, ..] = bytes else { return vec![] };
        let end = HEAD + usize::from(length);
        let Some(payload) = bytes.get(HEAD..end).filter(|_| end <= LONGEST_MESSAGE) else { return vec![] };
        let answer = match kind {
            MANAGEMENT => management(command, payload),
            GPIO => self.gpio(command, payload, board),
            SPI => self.spi(command, payload, board),
            _ => vec![],
        };
        let mut messages = Vec::new();
        if flags & ACK != 0 {
            messages.push(message(kind, command, ACK | COMPLETE, &answer));
        }
        if kind == GPIO {
            messages.extend(self.held_back(board));
        }
        messages
    }

    /// Handles a falling edge of RDY. Returns the event for the host; `None` if the interrupt is off or masked.
    pub fn rdy_fell(&mut self) -> Option<Vec<u8>> {
        let line = &mut self.lines[usize::from(RDY_PIN)];
        if !line.interrupt {
            return None;
        }
        if !line.unmasked {
            line.pending = true;
            return None;
        }
        line.unmasked = false;
        self.events += 1;
        Some(message(GPIO, GPIO_EVENT, 0, &[1, RDY_PIN, 0]))
    }

    /// True if an edge of RDY would cause an event now.
    pub fn wants_rdy(&self) -> bool {
        let line = self.lines[usize::from(RDY_PIN)];
        line.interrupt && line.unmasked
    }

    /// The event, if it is due, for an edge that came while the line was masked. It states the current level.
    fn held_back(&mut self, board: &mut impl Board) -> Option<Vec<u8>> {
        let line = &mut self.lines[usize::from(RDY_PIN)];
        if !(line.pending && line.unmasked) {
            return None;
        }
        (line.pending, line.unmasked) = (false, false);
        self.events += 1;
        Some(message(GPIO, GPIO_EVENT, 0, &[1, RDY_PIN, u8::from(board.rdy_high())]))
    }

    fn gpio(&mut self, command: u8, payload: &[u8], board: &mut impl Board) -> Vec<u8> {
        const CONFIGURE: u8 = 1;
        const READ: u8 = 2;
        const MASK: u8 = 5;
        const UNMASK: u8 = 6;
        let mut answer = vec![payload.first().copied().unwrap_or(0)];
        for item in payload.get(1..).unwrap_or_default().chunks_exact(2) {
            let (pin, mut value) = (item[0], item[1]);
            let Some(line) = self.lines.get_mut(usize::from(pin)) else { continue };
            match command {
                CONFIGURE => *line = Line { interrupt: value & GPIO_INTERRUPT != 0, ..Line::default() },
                READ => value = u8::from(pin == RDY_PIN && board.rdy_high()),
                MASK => line.unmasked = false,
                UNMASK => line.unmasked = true,
                _ => {}
            }
            answer.extend([pin, value]);
        }
        answer
    }

    fn spi(&mut self, command: u8, payload: &[u8], board: &mut impl Board) -> Vec<u8> {
        const INITIALISE: u8 = 1;
        const READ: u8 = 2;
        const WRITE: u8 = 3;
        const WRITE_READ: u8 = 4;
        match (command, payload) {
            (INITIALISE, [_, _, mode, ..]) => {
                self.spi_mode = *mode;
                payload.to_vec()
            }
            (READ, [indicator, 2, low, high, ..]) => {
                let length = usize::from(u16::from_le_bytes([*low, *high])).min(LONGEST_MESSAGE - HEAD - 2);
                self.transfer(*indicator, &vec![0; length], board)
            }
            (WRITE | WRITE_READ, [indicator, length, data @ ..]) => {
                self.transfer(*indicator, &data[..data.len().min(usize::from(*length))], board)
            }
            _ => payload.to_vec(),
        }
    }

    /// Transfers bytes over SPI. In any mode but 3, the part samples on the wrong clock edges and decodes nothing.
    fn transfer(&self, indicator: u8, mosi: &[u8], board: &mut impl Board) -> Vec<u8> {
        let miso = if self.spi_mode == MODE_3 { board.frame(mosi) } else { vec![0xFF; mosi.len()] };
        let mut packet = vec![indicator, miso.len() as u8];
        packet.extend(miso);
        packet
    }
}

fn management(command: u8, payload: &[u8]) -> Vec<u8> {
    const RESET: u8 = 2;
    const GPIOS: u8 = 4;
    const I2CS: u8 = 5;
    const SPIS: u8 = 8;
    match command {
        RESET => payload.to_vec(),
        GPIOS => {
            let valid = (1u32 << PINS) - 1;
            let mut banks = vec![PINS, 1, 0, PINS];
            banks.extend(valid.to_le_bytes());
            banks
        }
        I2CS => vec![0],
        SPIS => vec![1, 0, 1, 0],
        _ => vec![],
    }
}

fn message(kind: u8, command: u8, flags: u8, payload: &[u8]) -> Vec<u8> {
    let mut message = vec![kind, command, flags, payload.len() as u8];
    message.extend(payload);
    message
}

fn descriptor(value: u16) -> Option<Vec<u8>> {
    match value.to_be_bytes() {
        [1, 0] => Some(DEVICE_DESCRIPTOR.to_vec()),
        [2, 0] => Some(CONFIGURATION_DESCRIPTOR.to_vec()),
        [3, 0] => Some(vec![4, 3, 0x09, 0x04]), // English (United States)
        [3, index] => STRINGS.get(usize::from(index) - 1).map(|text| string_descriptor(text)),
        _ => None,
    }
}

fn string_descriptor(text: &str) -> Vec<u8> {
    let units: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut descriptor = vec![2 + units.len() as u8, 3];
    descriptor.extend(units);
    descriptor
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Answers each byte with its complement.
    pub struct Echo(pub bool);

    impl Board for Echo {
        fn frame(&mut self, mosi: &[u8]) -> Vec<u8> {
            mosi.iter().map(|byte| !byte).collect()
        }
        fn rdy_high(&mut self) -> bool {
            self.0
        }
    }

    fn answers(ljca: &mut Ljca, message: &[u8]) -> Vec<Vec<u8>> {
        ljca.message(message, &mut Echo(true))
    }

    /// The messages that Linux 6.12 sends while it binds, with the answers that it accepts.
    #[test]
    fn the_clients_are_enumerated() {
        let ljca = &mut Ljca::default();
        let cases: [(&[u8], &[u8]); 4] = [
            (&[1, 2, 5, 4, 7, 0, 0, 0], &[1, 2, 5, 4, 7, 0, 0, 0]),
            (&[1, 4, 5, 0], &[1, 4, 5, 8, 8, 1, 0, 8, 0xFF, 0, 0, 0]),
            (&[1, 5, 5, 0], &[1, 5, 5, 1, 0]),
            (&[1, 8, 5, 0], &[1, 8, 5, 4, 1, 0, 1, 0]),
        ];
        for (sent, expected) in cases {
            assert_eq!(answers(ljca, sent), [expected.to_vec()]);
        }
    }

    #[test]
    fn a_transfer_in_mode_3_reaches_the_part_and_in_another_mode_it_does_not() {
        let ljca = &mut Ljca::default();
        let read = [5, 4, 5, 6, 0x40, 4, 0x48, 0, 0, 0];
        assert_eq!(answers(ljca, &read), [[5, 4, 5, 6, 0x40, 4, 0xFF, 0xFF, 0xFF, 0xFF].to_vec()]);
        answers(ljca, &[5, 1, 5, 3, 0, 4, 3]);
        assert_eq!(answers(ljca, &read), [[5, 4, 5, 6, 0x40, 4, 0xB7, 0xFF, 0xFF, 0xFF].to_vec()]);
        assert_eq!(answers(ljca, &[5, 2, 5, 4, 0x40, 2, 3, 0]), [[5, 2, 5, 5, 0x40, 3, 0xFF, 0xFF, 0xFF].to_vec()]);
        assert_eq!(answers(ljca, &[5, 3, 5, 4, 0x40, 2, 0x38, 0x22]), [[5, 3, 5, 4, 0x40, 2, 0xC7, 0xDD].to_vec()]);
    }

    /// Each event masks its line until the host unmasks the line. An edge in between is then reported once.
    #[test]
    fn edges_are_held_back_while_the_line_is_masked() {
        let ljca = &mut Ljca::default();
        assert_eq!(ljca.rdy_fell(), None, "nobody asked");
        answers(ljca, &[3, 1, 5, 3, 1, RDY_PIN, 0xD0]);
        assert!(!ljca.wants_rdy());
        answers(ljca, &[3, 6, 5, 3, 1, RDY_PIN, 0]);
        assert!(ljca.wants_rdy());
        assert_eq!(ljca.rdy_fell(), Some(vec![3, 4, 0, 3, 1, RDY_PIN, 0]));
        assert_eq!(ljca.rdy_fell(), None);
        assert_eq!(ljca.rdy_fell(), None);
        let unmask = answers(ljca, &[3, 6, 5, 3, 1, RDY_PIN, 0]);
        assert_eq!(unmask, [vec![3, 6, 5, 3, 1, RDY_PIN, 0], vec![3, 4, 0, 3, 1, RDY_PIN, 1]]);
        assert_eq!(answers(ljca, &[3, 6, 5, 3, 1, RDY_PIN, 0]).len(), 1, "only once");
    }

    #[test]
    fn the_level_of_rdy_can_be_read() {
        let ljca = &mut Ljca::default();
        assert_eq!(answers(ljca, &[3, 2, 5, 3, 1, RDY_PIN, 0]), [vec![3, 2, 5, 3, 1, RDY_PIN, 1]]);
        assert_eq!(answers(ljca, &[3, 2, 5, 3, 1, 0, 0]), [vec![3, 2, 5, 3, 1, 0, 0]]);
    }

    #[test]
    fn descriptors_are_whole_and_cut_to_what_is_asked_for() {
        let ask = |value, length| {
            let (endpoint, request, request_type, index) = (0x80, 6, 0x80, 0);
            Ljca::default().control(&Control { endpoint, request, request_type, value, index, length })
        };
        assert_eq!(ask(0x0100, 8).map(|d| d.len()), Some(8));
        let configuration = ask(0x0200, 255).expect("a configuration");
        assert_eq!(usize::from(configuration[2]), configuration.len());
        let name = ask(0x0302, 255).expect("a name");
        assert_eq!(usize::from(name[0]), name.len());
        assert_eq!(ask(0x0600, 10), None, "no qualifier: full speed only");
        assert_eq!(ask(0x03FF, 255), None);
    }

    #[test]
    fn nonsense_is_not_answered() {
        let ljca = &mut Ljca::default();
        for sent in [&[][..], &[5, 4], &[5, 4, 5, 60, 1], &[9, 9, 0, 0]] {
            assert!(answers(ljca, sent).is_empty(), "{sent:?}");
        }
        for sent in [&[5, 4, 5, 0][..], &[5, 2, 5, 1, 9], &[3, 6, 5, 3, 1, 200, 0], &[9, 9, 5, 0], &[3, 2, 5, 0]] {
            assert_eq!(answers(ljca, sent).len(), 1, "{sent:?}");
        }
    }
}
