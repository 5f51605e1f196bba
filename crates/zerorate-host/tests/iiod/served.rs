//! A server for a twin, a second reader that records every sample of the twin, and a small client.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use zerorate::Calibration;
use zerorate_host::iiod::Server;
use zerorate_host::{DeviceSpec, Hub, Pace, Setup, Stop};

/// PBC, °/s, BTC, °/s/°C, and T3, °C, of the calibration that is served.
pub const CORRECTION: [f64; 3] = [-0.25, -0.04, 25.0];

/// Shortest time between batches of 4096 samples. It bounds the memory of a test, which records all samples.
const BATCH_TIME: Duration = Duration::from_millis(8);

/// A row of the hub: time, ns, code of the rate, code of the temperature, and number of lost samples.
type Row = (u64, i64, Option<i64>, u32);

pub struct TestServer {
    pub address: SocketAddr,
    rows: Arc<Mutex<Vec<Row>>>,
    count: Arc<AtomicUsize>,
    stop: Stop,
    threads: Vec<JoinHandle<()>>,
}

impl TestServer {
    pub fn start() -> Self {
        Self::of("twin:seed=8")
    }

    pub fn writable() -> Self {
        Self::begin("twin:seed=8", |server| server.writable())
    }

    pub fn of(device: &str) -> Self {
        Self::begin(device, |server| server)
    }

    fn begin(device: &str, change: fn(Server<'_>) -> Server<'_>) -> Self {
        let [pbc, btc, t3] = CORRECTION;
        let text = format!(
            "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = {pbc}\nbtc_dps_per_c = {btc}\nt3_c = {t3:?}\n"
        );
        let calibration = Calibration::parse(&text).expect("a calibration").0;
        let (spec, stop): (DeviceSpec, Stop) = (device.parse().expect("a device"), Stop::default());
        let hub = Arc::new(Hub::open(&spec, Setup::default(), &Stop::default()).expect("a hub"));
        hub.with(|source| source.initialise()).expect("a part");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        let (rows, count) = (Arc::<Mutex<Vec<Row>>>::default(), Arc::<AtomicUsize>::default());
        let everything = hub.everything();
        let (kept, counted, ended) = (rows.clone(), count.clone(), stop.clone());
        let recorder = thread::spawn(move || {
            while let Ok(Some(batch)) = everything.next() {
                let mut kept = kept.lock().expect("no panic");
                kept.extend(batch.rows.iter().map(|row| (row.t_ns, row.codes()[0], row.temp_code, row.lost)));
                counted.store(kept.len(), Ordering::Relaxed);
                drop(kept);
                thread::sleep(BATCH_TIME);
                if ended.asked() {
                    return;
                }
            }
        });
        hub.read(Pace::Free, Vec::new()).expect("a thread");
        let serving = stop.clone();
        let server = thread::spawn(move || {
            let server = Server::new(&hub, Some(&calibration)).expect("its own part");
            change(server).serve(&listener, &serving).expect("a socket");
        });
        Self { address, rows, count, stop, threads: vec![recorder, server] }
    }

    pub fn uri(&self) -> String {
        format!("ip:{}", self.address)
    }

    pub fn recorded(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }

    /// Checks that 16-byte pairs of code and time are rows of the hub, in order.
    pub fn check_pairs(&self, bytes: &[u8]) {
        self.wait_for(field(bytes.rchunks(16).next().expect("a pair"), 8));
        let rows = self.rows.lock().expect("no panic");
        let mut rows = rows.iter();
        for pair in bytes.chunks(16) {
            let (code, t_ns) = (field(pair, 0) as i64, field(pair, 8));
            assert!(rows.any(|row| (row.0, row.1) == (t_ns, code)), "{code} at {t_ns} ns was never read");
        }
    }

    /// Waits until a row of this time, or a later row, is recorded.
    fn wait_for(&self, t_ns: u64) {
        let begun = Instant::now();
        while self.rows.lock().expect("no panic").last().is_none_or(|row| row.0 < t_ns) {
            assert!(begun.elapsed() < Duration::from_secs(60), "nobody recorded that");
            thread::sleep(BATCH_TIME);
        }
    }

    /// Checks that samples with all channels are rows of the hub, in order, and that every missing row is counted.
    /// Returns the number of rows that are missing between the samples.
    pub fn check(&self, bytes: &[u8], samples: usize) -> u64 {
        assert_eq!(bytes.len(), samples * super::SAMPLE);
        self.wait_for(field(bytes.rchunks(super::SAMPLE).next().expect("a sample"), 24));
        let rows = self.rows.lock().expect("no panic");
        let first_ns = field(bytes, 24);
        let first = rows.iter().position(|row| row.0 == first_ns).expect("a row of the hub");
        // the first sample counts the samples missed before it
        let start = field(bytes, 16);
        let (mut at, mut lost) = (first, start);
        for sample in bytes.chunks(super::SAMPLE) {
            let t_ns = field(sample, 24);
            while rows[at].0 < t_ns {
                at += 1;
                lost += 1;
            }
            let (row_ns, code, temp_code, _) = rows[at];
            assert_eq!((row_ns, code), (t_ns, field(sample, 0) as u32 as i64), "row {at}");
            assert_eq!(temp_code, Some(field(sample, 4) as u32 as i64), "row {at}");
            assert_eq!(field(sample, 16), lost, "row {at}");
            check_corrected(code, temp_code, field(sample, 8) as i64, at);
            at += 1;
        }
        lost - start
    }
}

/// Checks the corrected rate, in units of 1e-9 rad/s, against a rate that is computed here by F-40, F-41 and F-50.
fn check_corrected(code: i64, temp_code: Option<i64>, corrected: i64, at: usize) {
    let temp_c = (temp_code.expect("a temperature") - 8_388_608) as f64 / 14_093.0 + 25.0;
    let [pbc, btc, t3] = CORRECTION;
    let dps = (code - 8_388_608) as f64 / 23_488.0 + pbc + btc * (temp_c - t3);
    let expected = dps.to_radians() * 1e9;
    assert!((corrected as f64 - expected).abs() <= 0.51, "row {at}: {corrected}, not {expected}");
}

fn field(sample: &[u8], at: usize) -> u64 {
    let bytes: [u8; 8] = sample[at..at + 8].try_into().expect("eight bytes");
    u64::from_le_bytes(bytes)
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.stop.ask();
        for thread in self.threads.drain(..) {
            let ended = thread.join();
            assert!(ended.is_ok() || thread::panicking(), "a thread of the server failed");
        }
    }
}

pub struct Raw {
    pub stream: TcpStream,
    reader: BufReader<TcpStream>,
}

impl Raw {
    pub fn connect(served: &TestServer) -> Self {
        Self::at(served.address)
    }

    pub fn at(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a socket");
        let reader = BufReader::new(stream.try_clone().expect("a socket"));
        Self { stream, reader }
    }

    pub fn ask(&mut self, line: &str) {
        // the server may have hung up
        let _ = self.stream.write_all(format!("{line}\r\n").as_bytes());
    }

    /// Reads a line that is a number; `None` if the server hung up.
    fn answer(&mut self) -> Option<i64> {
        let mut line = String::new();
        self.reader.read_line(&mut line).ok().filter(|read| *read > 0)?;
        Some(line.trim().parse().unwrap_or_else(|_| panic!("{line:?} is no number")))
    }

    pub fn number(&mut self, line: &str) -> i64 {
        self.ask(line);
        self.answer().expect("an answer")
    }

    pub fn try_value(&mut self, line: &str) -> Option<String> {
        self.ask(line);
        let length = self.answer()?;
        let mut value = vec![0; usize::try_from(length).expect("a length") + 1];
        self.reader.read_exact(&mut value).ok()?;
        assert_eq!(value.pop(), Some(b'\n'));
        String::from_utf8(value).ok()
    }

    pub fn value(&mut self, line: &str) -> String {
        self.try_value(line).expect("a value")
    }

    pub fn open(&mut self, mask: &str) {
        assert_eq!(self.number(&format!("OPEN iio:device0 256 {mask}")), 0);
    }

    pub fn take(&mut self, bytes: usize) -> Vec<u8> {
        let mut taken = vec![0; bytes];
        self.reader.read_exact(&mut taken).expect("bytes");
        taken
    }

    pub fn samples(&mut self, bytes: usize) -> Vec<u8> {
        self.try_samples(bytes).expect("samples")
    }

    /// Reads samples of the open buffer as libiio does, or fewer at its end. The error is a negative errno, or 0.
    pub fn try_samples(&mut self, bytes: usize) -> Result<Vec<u8>, i64> {
        self.ask(&format!("READBUF iio:device0 {bytes}"));
        let mut all = Vec::with_capacity(bytes);
        while all.len() < bytes {
            let more = self.answer().expect("an answer");
            if more <= 0 {
                return if all.is_empty() { Err(more) } else { Ok(all) };
            }
            if all.is_empty() {
                let mut mask = String::new();
                self.reader.read_line(&mut mask).expect("a mask");
                assert_eq!(mask.len(), 9, "{mask:?}");
            }
            all.extend(self.take(more as usize));
        }
        Ok(all)
    }
}
