//! Tests of the time limits, which are shortened, of a page that falls behind, and of the end of the session.
//! tests/serve/safety.rs tests the other limits from outside.

use super::*;
use crate::serve::session_thread::{BEHIND, SessionRequest, Subscription};
use hyper::body::Bytes;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread;
use tokio::sync::broadcast;
use tungstenite::{Message, WebSocket};

/// Time limit of every wait, long enough for the slowest machine.
const LONG: Duration = Duration::from_secs(60);
const NEVER: Limits = Limits { head: LONG, lifetime: LONG, sign_of_life: LONG };

/// A server whose session thread has no device. The first viewer finds `frames_waiting` frames beside the snapshot.
struct TestServer {
    address: SocketAddr,
    begun: Arc<AtomicUsize>,
    _ends: EndsAll,
}

impl TestServer {
    fn with(limits: Limits, frames_waiting: usize) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let (address, stop) = (listener.local_addr().unwrap(), Stop::default());
        let begun = Arc::<AtomicUsize>::default();
        let (requests, asked) = sync_channel(16);
        let counted = Arc::clone(&begun);
        thread::spawn(move || {
            let (frames, _) = broadcast::channel(BEHIND);
            while let Ok(SessionRequest::Watch(subscriber)) = asked.recv() {
                let watched = frames.subscribe();
                // a viewer that connects again has caught up
                let waiting = if counted.fetch_add(1, Ordering::Relaxed) == 0 { frames_waiting } else { 0 };
                (0..waiting).for_each(|_| drop(frames.send(Bytes::from_static(b"frame"))));
                let _ = subscriber.send(Subscription { snapshot: Bytes::from_static(b"snapshot"), frames: watched });
            }
        });
        let (server, ends) = (Server::new(Guard::new(address, None, vec![]), requests, limits), stop.clone());
        thread::spawn(move || serve(listener, server, &ends));
        Self { address, begun, _ends: EndsAll(stop) }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    fn watch(&self) -> WebSocket<TcpStream> {
        tungstenite::client(format!("ws://{}/ws", self.address), self.connect()).unwrap().0
    }
}

/// Sends a request. Returns false if the connection has ended.
fn ask(stream: &mut TcpStream) -> bool {
    let sent = stream.write_all(b"GET /home.json HTTP/1.1\r\nhost: localhost\r\n\r\n");
    sent.is_ok() && stream.read(&mut [0; 4096]).is_ok_and(|length| length > 0)
}

#[test]
fn the_wait_for_the_next_request_is_limited() {
    let served = TestServer::with(Limits { head: Duration::from_millis(300), ..NEVER }, 0);
    let mut stream = served.connect();
    assert!(ask(&mut stream) && ask(&mut stream));
    let begun = Instant::now();
    assert!(matches!(stream.read(&mut [0; 64]), Ok(0) | Err(_)));
    assert!((Duration::from_millis(250)..LONG / 2).contains(&begun.elapsed()), "{:?}", begun.elapsed());
}

#[test]
fn the_life_of_a_connection_is_limited() {
    let lifetime = Duration::from_millis(700);
    let served = TestServer::with(Limits { lifetime, ..NEVER }, 0);
    let (mut stream, begun) = (served.connect(), Instant::now());
    while ask(&mut stream) {
        assert!(begun.elapsed() < LONG / 2, "it goes on");
        thread::sleep(Duration::from_millis(60));
    }
    assert!(begun.elapsed() >= lifetime, "{:?}", begun.elapsed());
    // the connection of a viewer has no such limit
    let mut page = served.watch();
    thread::sleep(2 * lifetime);
    page.send(Message::Ping(Bytes::new())).unwrap();
    while !matches!(page.read().unwrap(), Message::Pong(_)) {}
}

#[test]
fn a_page_that_is_far_behind_gets_everything_anew() {
    let next = |page: &mut WebSocket<TcpStream>| page.read().unwrap().into_data();
    let in_time = TestServer::with(NEVER, BEHIND);
    let mut page = in_time.watch();
    assert_eq!(next(&mut page), "snapshot");
    assert!((0..BEHIND).all(|_| next(&mut page) == "frame"));
    assert_eq!(in_time.begun.load(Ordering::Relaxed), 1);
    let late = TestServer::with(NEVER, BEHIND + 1);
    let mut page = late.watch();
    assert_eq!([next(&mut page), next(&mut page)], ["snapshot", "snapshot"]);
    assert_eq!(late.begun.load(Ordering::Relaxed), 2);
}

/// Without pings, the server would not notice that a page vanished, and the page would keep its seat.
#[test]
fn a_page_that_gives_no_sign_of_life_loses_its_seat() {
    let sign_of_life = Duration::from_secs(2);
    let served = TestServer::with(Limits { sign_of_life, ..NEVER }, 0);
    let (mut lively, mut dead) = (served.watch(), served.watch());
    // a client that reads also answers pings
    let reads = thread::spawn(move || {
        let mut pings = 0;
        while pings < 3 {
            pings += usize::from(matches!(lively.read().unwrap(), Message::Ping(_)));
        }
    });
    thread::sleep(3 * sign_of_life);
    let begun = Instant::now();
    // this read returns when the server has closed or reset the connection
    let _ = dead.get_mut().read_to_end(&mut Vec::new());
    assert!(begun.elapsed() < LONG / 2, "it goes on");
    reads.join().unwrap();
}

#[test]
fn whatever_ends_the_session_ends_all() {
    let stop = Stop::default();
    let ends = EndsAll(stop.clone());
    let died = thread::spawn(move || {
        let _ends = ends;
        panic!("as a test");
    });
    assert!(died.join().is_err() && stop.asked());
}
