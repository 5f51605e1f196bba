//! A simulated HID gyroscope for the guest. `gyro RECORD` creates it through `/dev/uhid`, and records its readings.
//!
//! This file is compiled separately and statically, with only the standard library; the guest has no other libraries.

use std::io::{self, Write};
use std::time::{Duration, Instant};

const PERIOD: Duration = Duration::from_millis(10);
/// A reading that is later than this is not sent, so that a receiver can compute the number of missing readings from
/// the times of two readings.
const LATEST: Duration = Duration::from_millis(4);
/// Number of readings in a group. The last `WITHHELD` readings of each group are sent only on request.
const BLOCK: u32 = 50;
const WITHHELD: u32 = 4;

/// The report ID. There is one report of each type.
const REPORT: u8 = 1;
/// The reporting state that the kernel's driver sets to get readings: "all events" in the descriptor.
const ALL_EVENTS: u8 = 2;

/// The report descriptor, with HID Usage Tables, page 0x20 (sensors). The fields of a report are in the order of
/// [`Gyro::feature`] and of [`report`].
const DESCRIPTOR: &[u8] = &[
    0x05, 0x20, // usage page: sensors
    0x09, 0x76, // usage: gyrometer 3D
    0xA1, 0x00, // physical collection
    0x85, REPORT, //
    0x0A, 0x16, 0x03, // property: reporting state
    0x15, 0x01, 0x25, 0x02, 0x75, 0x08, 0x95, 0x01, // 1 to 2, one byte
    0xA1, 0x02, // logical collection
    0x0A, 0x40, 0x08, 0x0A, 0x41, 0x08, // no events, all events
    0xB1, 0x00, // feature, one of them
    0xC0, //
    0x0A, 0x19, 0x03, // property: power state
    0x25, 0x06, // 1 to 6
    0xA1, 0x02, //
    0x0A, 0x50, 0x08, 0x0A, 0x51, 0x08, 0x0A, 0x52, 0x08, // undefined, D0, D1
    0x0A, 0x53, 0x08, 0x0A, 0x54, 0x08, 0x0A, 0x55, 0x08, // D2, D3, D4
    0xB1, 0x00, //
    0xC0, //
    0x0A, 0x0E, 0x03, // property: report interval, in ms by default
    0x15, 0x00, 0x27, 0xFF, 0xFF, 0xFF, 0x7F, 0x75, 0x20, 0x95, 0x01, // 31 bits of 32
    0xB1, 0x02, // feature, a number
    0x0A, 0x01, 0x02, // sensor state
    0x15, 0x01, 0x25, 0x02, 0x75, 0x08, 0x95, 0x01, //
    0xA1, 0x02, //
    0x0A, 0x00, 0x08, 0x0A, 0x01, 0x08, // unknown, ready
    0x81, 0x00, // input, one of them
    0xC0, //
    0x0A, 0x02, 0x02, // sensor event
    0xA1, 0x02, //
    0x0A, 0x10, 0x08, 0x0A, 0x11, 0x08, // unknown, state changed
    0x81, 0x00, //
    0xC0, //
    0x16, 0x00, 0x80, 0x26, 0xFF, 0x7F, 0x75, 0x10, 0x95, 0x01, // 16 bits with a sign
    0x55, 0x0E, // times 10⁻² of the default unit, degrees per second
    0x0A, 0x57, 0x04, 0x81, 0x02, // angular velocity about x
    0x0A, 0x58, 0x04, 0x81, 0x02, // y
    0x0A, 0x59, 0x04, 0x81, 0x02, // z
    0xC0, //
];

/// The event types of linux/uhid.h that are used.
mod kind {
    pub const GET_REPORT: u32 = 9;
    pub const GET_REPORT_REPLY: u32 = 10;
    pub const CREATE2: u32 = 11;
    pub const INPUT2: u32 = 12;
    pub const SET_REPORT: u32 = 13;
    pub const SET_REPORT_REPLY: u32 = 14;
}

/// `UHID_FEATURE_REPORT`. All other report types in use are input reports.
const FEATURE: u8 = 0;
/// `BUS_VIRTUAL`.
const BUS: u16 = 6;

struct Gyro<K, R> {
    kernel: K,
    record: R,
    started: Instant,
    /// The feature report: report id, reporting state, power state, interval.
    feature: [u8; 7],
    /// Number of the newest reading.
    newest: u32,
}

impl<K: Write, R: Write> Gyro<K, R> {
    fn new(kernel: K, mut record: R) -> io::Result<Self> {
        writeln!(record, "number,x,y,z,before_ns,after_ns,asked")?;
        let interval = (PERIOD.as_millis() as u32).to_le_bytes();
        let feature = [REPORT, 1, 1, interval[0], interval[1], interval[2], interval[3]];
        Ok(Self { kernel, record, started: Instant::now(), feature, newest: 0 })
    }

    fn plug_in(&mut self) -> io::Result<()> {
        let mut texts = [0; 128 + 64 + 64];
        texts[..4].copy_from_slice(b"gyro");
        let identity = [[0; 4]; 4].concat();
        let sizes = [(DESCRIPTOR.len() as u16).to_ne_bytes(), BUS.to_ne_bytes()].concat();
        self.tell(kind::CREATE2, &[&texts, &sizes, &identity, DESCRIPTOR])
    }

    fn tell(&mut self, kind: u32, what: &[&[u8]]) -> io::Result<()> {
        self.kernel.write_all(&[&kind.to_ne_bytes()[..], &what.concat()].concat())
    }

    fn hear(&mut self, event: &[u8]) -> io::Result<()> {
        let (Some((kind, rest)), no_error) = (event.split_first_chunk::<4>(), 0u16.to_ne_bytes()) else {
            return Ok(());
        };
        match (u32::from_ne_bytes(*kind), rest) {
            // id, report number, report type
            (kind::GET_REPORT, [a, b, c, d, _, FEATURE, ..]) => {
                let feature = self.feature;
                let size = (feature.len() as u16).to_ne_bytes();
                self.tell(kind::GET_REPORT_REPLY, &[&[*a, *b, *c, *d], &no_error, &size, &feature])
            }
            (kind::GET_REPORT, [a, b, c, d, ..]) => {
                let data = report(self.newest);
                let size = (data.len() as u16).to_ne_bytes();
                let id = [*a, *b, *c, *d];
                self.recorded(true, |gyro| gyro.tell(kind::GET_REPORT_REPLY, &[&id, &no_error, &size, &data]))
            }
            // id, report number, report type, size, data
            (kind::SET_REPORT, [a, b, c, d, _, _, _, _, data @ ..]) => {
                let length = self.feature.len();
                if let Some(feature) = data.get(..length) {
                    self.feature.copy_from_slice(feature);
                }
                self.tell(kind::SET_REPORT_REPLY, &[&[*a, *b, *c, *d], &no_error])
            }
            _ => Ok(()),
        }
    }

    /// Sends a reading, unless it is too late, is one of the withheld readings, or was not requested by the kernel.
    fn send(&mut self, number: u32) -> io::Result<()> {
        if self.started.elapsed() > PERIOD * number + LATEST {
            return Ok(());
        }
        self.newest = number;
        if self.feature[1] != ALL_EVENTS || number % BLOCK >= BLOCK - WITHHELD {
            return Ok(());
        }
        let data = report(number);
        let size = (data.len() as u16).to_ne_bytes();
        self.recorded(false, |gyro| gyro.tell(kind::INPUT2, &[&size, &data]))
    }

    /// Sends the newest reading by `hand_over`, and records it with the times before and after.
    fn recorded(&mut self, asked: bool, hand_over: impl FnOnce(&mut Self) -> io::Result<()>) -> io::Result<()> {
        let before_ns = self.started.elapsed().as_nanos();
        hand_over(self)?;
        let after_ns = self.started.elapsed().as_nanos();
        let [x, y, z] = codes(self.newest);
        writeln!(self.record, "{},{x},{y},{z},{before_ns},{after_ns},{}", self.newest, u8::from(asked))
    }
}

/// The codes of a reading about x, y and z. On each axis, 65536 successive readings have different codes of 16 bits.
fn codes(number: u32) -> [i16; 3] {
    [(25_173, 13_849), (-20_021, 4_711), (9_377, -30_011)]
        .map(|(factor, first): (i32, i32)| factor.wrapping_mul(number as i32).wrapping_add(first) as i16)
}

/// The input report: report id, state "ready", event "state changed", and the codes.
fn report(number: u32) -> Vec<u8> {
    let [x, y, z] = codes(number).map(i16::to_le_bytes);
    [&[REPORT, 2, 2][..], &x, &y, &z].concat()
}

#[cfg(not(test))]
fn main() -> io::Result<()> {
    use std::fs::{File, OpenOptions};
    use std::io::Read;
    use std::sync::{Arc, Mutex, PoisonError};
    use std::thread;

    /// Size of the largest event, bytes.
    const EVENT: usize = 4376;

    let record = std::env::args().nth(1).ok_or_else(|| io::Error::other("gyro RECORD"))?;
    let mut kernel = OpenOptions::new().read(true).write(true).open("/dev/uhid")?;
    let mut gyro = Gyro::new(kernel.try_clone()?, File::create(record)?)?;
    gyro.plug_in()?;
    let started = gyro.started;
    let gyro = Arc::new(Mutex::new(gyro));
    let sender = Arc::clone(&gyro);
    thread::spawn(move || -> io::Result<()> {
        loop {
            let number = (started.elapsed().as_nanos() / PERIOD.as_nanos()) as u32 + 1;
            thread::sleep((PERIOD * number).saturating_sub(started.elapsed()));
            sender.lock().unwrap_or_else(PoisonError::into_inner).send(number)?;
        }
    });
    let mut event = [0; EVENT];
    loop {
        let length = kernel.read(&mut event)?;
        gyro.lock().unwrap_or_else(PoisonError::into_inner).hear(&event[..length])?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Returns the messages to the kernel and the record, and clears both.
    fn told(gyro: &mut Gyro<Vec<u8>, Vec<u8>>) -> (Vec<u8>, String) {
        let record = std::mem::take(&mut gyro.record);
        (std::mem::take(&mut gyro.kernel), String::from_utf8(record).expect("text"))
    }

    #[test]
    fn readings_are_sent_when_they_are_wanted_and_in_time_and_written_down() {
        let mut gyro = Gyro::new(Vec::new(), Vec::new()).expect("a gyroscope");
        gyro.send(1).expect("sent");
        let (nothing, header) = told(&mut gyro);
        assert_eq!((nothing.len(), header.lines().count()), (0, 1));
        // SET_REPORT 7 of the feature report: all events, D0, every 10 ms
        let set = [&kind::SET_REPORT.to_ne_bytes()[..], &[7, 0, 0, 0, 1, 0, 7, 0], &[1, 2, 2, 10, 0, 0, 0]].concat();
        gyro.hear(&set).expect("heard");
        assert_eq!(told(&mut gyro).0, [14, 0, 0, 0, 7, 0, 0, 0, 0, 0]);
        for number in [2, BLOCK - 1] {
            gyro.send(number).expect("sent");
        }
        let (input, record) = told(&mut gyro);
        assert_eq!(input, [&[12, 0, 0, 0, 9, 0][..], &report(2)].concat());
        let [x, y, z] = codes(2);
        assert!(record.starts_with(&format!("2,{x},{y},{z},")) && record.ends_with(",0\n"), "{record}");
        gyro.started -= PERIOD * 1000;
        gyro.send(3).expect("left out");
        assert!(told(&mut gyro).0.is_empty());
    }

    #[test]
    fn questions_are_answered() {
        let mut gyro = Gyro::new(Vec::new(), Vec::new()).expect("a gyroscope");
        told(&mut gyro);
        for (kind_of_report, answer) in [(FEATURE, vec![1, 1, 1, 10, 0, 0, 0]), (2, report(0))] {
            gyro.hear(&[9, 0, 0, 0, 5, 0, 0, 0, 1, kind_of_report]).expect("heard");
            let head = [10, 0, 0, 0, 5, 0, 0, 0, 0, 0, answer.len() as u8, 0];
            assert_eq!(told(&mut gyro).0, [&head[..], &answer].concat());
        }
        gyro.plug_in().expect("plugged in");
        assert_eq!(told(&mut gyro).0.len(), 4 + 128 + 64 + 64 + 2 + 2 + 16 + DESCRIPTOR.len());
    }

    #[test]
    fn a_code_stands_for_one_reading() {
        for axis in 0..3 {
            let all: BTreeSet<i16> = (0..65_536).map(|number| codes(number)[axis]).collect();
            assert_eq!(all.len(), 65_536);
        }
    }
}
