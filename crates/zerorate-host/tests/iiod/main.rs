//! The libiio server over the twin: clients get the same samples as another reader of the hub.

mod clients;
mod served;

use served::{Raw, TestServer};
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener};
use std::thread;
use std::time::{Duration, Instant};
use zerorate_host::iiod::Server;
use zerorate_host::{Hub, Pace, Setup, Stop};

/// All channels of an ADIS16130 with a calibration: rate, temperature, corrected rate, lost samples, time.
const ALL: &str = "0000001f";
/// Size of a sample with all channels, bytes.
const SAMPLE: usize = 32;

#[test]
fn two_clients_at_once_get_the_samples_of_the_hub_or_are_told() {
    let served = TestServer::start();
    let (mut one, mut other) = (Raw::connect(&served), Raw::connect(&served));
    std::thread::scope(|scope| {
        for client in [&mut one, &mut other] {
            scope.spawn(|| {
                client.open(ALL);
                let bytes: Vec<u8> = (0..100).flat_map(|_| client.samples(1000 * SAMPLE)).collect();
                served.check(&bytes, 100_000);
            });
        }
    });
}

#[test]
fn a_sleeping_client_learns_its_losses_and_slows_nobody() {
    let served = TestServer::start();
    let (mut sleeper, mut awake) = (Raw::connect(&served), Raw::connect(&served));
    sleeper.open(ALL);
    let first = sleeper.samples(SAMPLE);
    awake.open(ALL);
    // more samples than the server queues for a client
    while served.recorded() < 1_500_000 {
        awake.samples(1000 * SAMPLE);
    }
    let rest = sleeper.samples(900_000 * SAMPLE);
    let lost = served.check(&[first, rest].concat(), 900_001);
    assert!(lost > 100_000, "{lost} lost of {}", served.recorded());
    let missed: u64 = awake.value("READ iio:device0 BUFFER samples_lost").parse().expect("a number");
    assert!(missed >= lost, "{missed} of all buffers, {lost} of one");
}

#[test]
fn a_client_that_dies_leaves_nothing_behind() {
    let served = TestServer::start();
    // more clients than the server allows at a time
    for round in 0..150 {
        let mut client = Raw::connect(&served);
        client.open(ALL);
        client.ask(&format!("READBUF iio:device0 {}", 100_000 * SAMPLE));
        client.take(1 + 100 * round);
        if round % 2 == 0 {
            client.ask("READ iio:dev");
        }
    }
    let begun = Instant::now();
    while Raw::connect(&served).try_value("READ iio:device0 current_timestamp_clock").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the dead are still connected");
    }
}

#[test]
fn nobody_takes_all_connections() {
    let served = TestServer::start();
    let mut held: Vec<Raw> = (0..64).map(|_| Raw::connect(&served)).collect();
    held.iter_mut().for_each(|client| assert_eq!(client.number("TIMEOUT 100"), 0));
    assert_eq!(Raw::connect(&served).try_value("READ iio:device0 calibration"), None, "one too many");
    held.pop();
    let begun = Instant::now();
    while Raw::connect(&served).try_value("READ iio:device0 calibration").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nobody gets the place that is free");
    }
}

#[test]
fn nonsense_harms_nobody_else() {
    let served = TestServer::start();
    let mut client = Raw::connect(&served);
    assert_eq!(client.number("\u{0}\u{1}\u{7f}"), -22);
    assert_eq!(client.value("READ iio:device0 current_timestamp_clock"), "monotonic", "it goes on");
    let mut browser = Raw::connect(&served);
    assert_eq!(browser.number("POST / HTTP/1.1"), -22);
    assert_eq!(browser.try_value("READ iio:device0 calibration"), None, "a post from a page is not a request");
    for noise in [vec![b'x'; 1 << 20], (0..=255).cycle().take(100_000).collect(), vec![b'\n'; 1 << 16], vec![0; 4096]]
    {
        let mut client = Raw::connect(&served);
        // the server may hang up before it has read all bytes
        let _ = client.stream.write_all(&noise);
        let _ = client.stream.shutdown(Shutdown::Write);
        let mut answer = Vec::new();
        let _ = client.stream.read_to_end(&mut answer);
        let is_answer = |line: &&[u8]| line.is_empty() || line.starts_with(b"-");
        assert!(answer.split(|byte| *byte == b'\n').all(|line| is_answer(&line)), "{answer:?}");
    }
    assert_eq!(client.value("READ iio:device0 current_timestamp_clock"), "monotonic", "nor is anybody else");
}

#[test]
fn a_server_ends_while_clients_are_there() {
    let served = TestServer::start();
    let mut client = Raw::connect(&served);
    client.open(ALL);
    client.ask(&format!("READBUF iio:device0 {}", 10_000_000 * SAMPLE));
    client.take(1000);
    let begun = Instant::now();
    drop(served);
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
}

/// The part is unplugged after 120 s. The client gets the samples before that, then an error.
#[test]
fn a_lost_device_is_reported() {
    // the twin does not wait for a client, but even a slow client connects before 100 s of simulated time have passed
    let served = TestServer::of("twin:seed=9,fault=unplug,fault_at_s=120");
    let mut client = Raw::connect(&served);
    client.open(ALL);
    let mut bytes = Vec::new();
    while let Ok(more) = client.try_samples(1000 * SAMPLE) {
        bytes.extend(more);
    }
    // F-31: 5692.6 a second
    assert!((100_000..684_000).contains(&(bytes.len() / SAMPLE)), "{}", bytes.len() / SAMPLE);
    assert_eq!(client.number("READBUF iio:device0 3200"), -19);
    assert_eq!(Raw::connect(&served).number("OPEN iio:device0 256 00000001"), -19);
}

/// The hub does not read the device, so no sample comes.
#[test]
fn waiting_for_samples_times_out() {
    let spec = "twin:seed=8".parse().expect("a device");
    let hub = Hub::open(&spec, Setup::default(), &Stop::default()).expect("a hub");
    hub.with(|source| source.initialise()).expect("a part");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    thread::spawn(move || Server::new(&hub, None).expect("its own part").serve(&listener, &Stop::default()));
    let mut client = Raw::at(address);
    client.open("00000001");
    assert_eq!(client.number("TIMEOUT 100"), 0);
    let begun = Instant::now();
    assert_eq!(client.number("READBUF iio:device0 64"), -110);
    assert!(begun.elapsed() >= Duration::from_millis(100));
    assert_eq!(client.number("CLOSE iio:device0"), 0, "it goes on");
}

#[test]
fn half_a_value_ends_with_its_client() {
    let served = TestServer::writable();
    let mut client = Raw::connect(&served);
    client.ask("WRITE iio:device0 INPUT anglvel0 scale 100");
    client.stream.shutdown(Shutdown::Write).expect("it hangs up");
    let mut answer = Vec::new();
    client.stream.read_to_end(&mut answer).expect("the server hangs up too");
    assert!(answer.is_empty(), "{answer:?}");
    let mut other = Raw::connect(&served);
    other.ask("HELP");
    assert_eq!(other.take(9), b"Commands:", "others are served");
}

/// A listener on a UDP socket, which accepts no connections.
#[cfg(target_os = "linux")]
#[test]
fn a_listener_that_fails_is_reported_at_once() {
    use std::net::UdpSocket;
    use std::os::fd::OwnedFd;
    let spec = "twin:seed=8".parse().expect("a device");
    let hub = Hub::open(&spec, Setup::default(), &Stop::default()).expect("a hub");
    hub.with(|source| source.initialise()).expect("a part");
    hub.read(Pace::RealTime, Vec::new()).expect("a thread");
    let listener = TcpListener::from(OwnedFd::from(UdpSocket::bind("127.0.0.1:0").expect("a socket")));
    let (say, said) = std::sync::mpsc::channel();
    thread::spawn(move || {
        let served = Server::new(&hub, None).expect("its own part").serve(&listener, &Stop::default());
        say.send(served.is_err()).expect("somebody waits");
    });
    assert_eq!(said.recv_timeout(Duration::from_secs(30)), Ok(true));
}
