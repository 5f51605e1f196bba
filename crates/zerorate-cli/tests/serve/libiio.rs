//! Clients of libiio beside the page. `zerorate-host/tests/iiod/` and `cargo xtask iiod` test the data for clients.

use super::TestServer;
use crate::harness::{Bench, calibration};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

#[test]
fn a_client_finds_the_calibration_and_may_not_write() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    let served = TestServer::start(&bench, "--device twin:seed=6 --cal unit.toml");
    let line = served.says("libiio: iio_info -u ip:");
    let address = line.rsplit("ip:").next().expect("an address").trim();
    let mut client = BufReader::new(TcpStream::connect(address).expect("a connection"));
    assert_eq!(asked(&mut client, "WRITE iio:device0 INPUT anglvel_z calibbias 1\r\n0"), "-13");
    let length: usize = asked(&mut client, "PRINT").parse().expect("a length");
    let mut xml = vec![0; length];
    client.read_exact(&mut xml).expect("a description");
    assert!(String::from_utf8_lossy(&xml).contains("anglvel_z_corrected"), "there is a calibration");
}

fn asked(client: &mut BufReader<TcpStream>, line: &str) -> String {
    client.get_mut().write_all(format!("{line}\r\n").as_bytes()).expect("a connection");
    let mut answer = String::new();
    client.read_line(&mut answer).expect("an answer");
    answer.trim().to_owned()
}

#[test]
fn others_do_not_reach_it_and_it_can_be_left_out() {
    let bench = Bench::new();
    bench.zerorate("serve --listen 127.0.0.1:0 --iio 0.0.0.0:30431").fails(2, &["no password"]);
    bench.zerorate("serve --no-iio --allow-write").fails(2, &[]);
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address");
    bench.zerorate(&format!("serve --listen 127.0.0.1:0 --iio {address}")).fails(1, &["--iio"]);
}
