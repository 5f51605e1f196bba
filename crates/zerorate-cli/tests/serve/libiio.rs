//! Clients of libiio beside the page.

use super::Served;
use crate::harness::Bench;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

const CALIBRATION: &str = "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\n\
    t3_c = 31.5\n";

/// A connection to the server.
struct Client(BufReader<TcpStream>);

impl Client {
    fn connect(served: &Served) -> Self {
        let line = served.says("libiio: iio_info -u ip:");
        let address = line.rsplit("ip:").next().expect("an address").trim();
        Self(BufReader::new(TcpStream::connect(address).expect("a connection")))
    }

    fn ask(&mut self, line: &str) -> String {
        self.0.get_mut().write_all(format!("{line}\r\n").as_bytes()).expect("a connection");
        let mut answer = String::new();
        self.0.read_line(&mut answer).expect("an answer");
        answer.trim().to_owned()
    }

    fn value(&mut self, line: &str) -> String {
        let length: usize = self.ask(line).parse().expect("a length");
        let mut value = vec![0; length + 1];
        self.0.read_exact(&mut value).expect("a value");
        String::from_utf8(value).expect("text").trim_end().to_owned()
    }
}

/// Code and time of samples are rows of the recording.
#[test]
fn a_client_gets_the_samples_that_are_recorded() {
    let bench = Bench::new();
    bench.write("unit.toml", CALIBRATION);
    let served = Served::start(&bench, "--device twin:seed=6 --cal unit.toml -o all.csv");
    let mut client = Client::connect(&served);
    assert!(client.value("PRINT").contains("anglvel_z_corrected"), "there is a calibration");
    assert_eq!(client.ask("WRITE iio:device0 INPUT anglvel_z calibbias 1\r\n0"), "-13");
    assert_eq!(client.ask("OPEN iio:device0 64 00000011"), "0");
    let mut samples = Vec::new();
    for _ in 0..50 {
        client.0.get_mut().write_all(b"READBUF iio:device0 1024\r\n").expect("a connection");
        let (mut got, mut line) = (0, String::new());
        while got < 1024 {
            let is_first = got == 0;
            line.clear();
            client.0.read_line(&mut line).expect("a length");
            let length: usize = line.trim().parse().expect("a length");
            assert!(length > 0, "the twin goes on");
            if is_first {
                client.0.read_line(&mut line).expect("a mask");
            }
            let mut bytes = vec![0; length];
            client.0.read_exact(&mut bytes).expect("samples");
            got += length;
            samples.extend(bytes);
        }
    }
    assert!(served.interrupt().success());
    let text = std::fs::read_to_string(bench.path("all.csv")).expect("recorded");
    let rows: BTreeMap<u64, u32> = text
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (cells[0].parse().expect("a time"), cells[2].parse().expect("a code"))
        })
        .collect();
    assert_eq!(samples.len(), 50 * 1024);
    for sample in samples.chunks(16) {
        let code = u32::from_le_bytes(sample[..4].try_into().expect("four"));
        let t_ns = u64::from_le_bytes(sample[8..].try_into().expect("eight"));
        assert_eq!(rows.get(&t_ns), Some(&code), "{t_ns}");
    }
}

#[test]
fn others_do_not_reach_it_and_it_can_be_left_out() {
    let bench = Bench::new();
    let refused = bench.zerorate("serve --listen 127.0.0.1:0 --iio 0.0.0.0:30431").fails(2);
    assert!(refused.contains("no password"), "{refused}");
    bench.zerorate("serve --no-iio --allow-write").fails(2);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address");
    let refused = bench.zerorate(&format!("serve --listen 127.0.0.1:0 --iio {address}")).fails(1);
    assert!(refused.contains("--iio"), "{refused}");
}
