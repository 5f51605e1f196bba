//! `zerorate serve` through its sockets: what it shows, refuses and records.

mod libiio;
mod safety;
mod watching;

use crate::harness::Bench;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Time limit of every wait, for the slowest machine.
const LONG: Duration = Duration::from_secs(60);

/// A server process, ended with the test.
struct TestServer {
    child: Child,
    stderr: Mutex<Receiver<String>>,
    url: String,
    port: u16,
}

impl TestServer {
    /// Starts `serve` in the folder of the test, with free ports for the page and for libiio, and with these
    /// arguments.
    fn at(bench: &Bench, ip: &str, arguments: &str) -> Self {
        let line = format!("serve --listen {ip}:0 --iio 127.0.0.1:0 {arguments}");
        let mut command = bench.command(line.trim_end());
        let mut child = command.stderr(Stdio::piped()).spawn().expect("the program starts");
        let lines = BufReader::new(child.stderr.take().expect("stderr")).lines();
        let (tell, stderr) = channel();
        thread::spawn(move || lines.map_while(Result::ok).try_for_each(|line| tell.send(line)));
        let url = wait_for(&stderr, "open http://");
        let url = url.split_once("open ").expect("an address").1.to_owned();
        let address = url.trim_start_matches("http://").split('/').next().expect("an address");
        let port = address.rsplit(':').next().and_then(|port| port.parse().ok()).expect("a port");
        Self { child, stderr: Mutex::new(stderr), url, port }
    }

    fn start(bench: &Bench, arguments: &str) -> Self {
        Self::at(bench, "127.0.0.1", arguments)
    }

    /// Waits for a line on stderr that contains this text. Returns the line.
    fn says(&self, text: &str) -> String {
        wait_for(&self.said(), text)
    }

    fn said(&self) -> MutexGuard<'_, Receiver<String>> {
        self.stderr.lock().expect("nobody has died")
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(LONG)).expect("a timeout");
        stream
    }

    /// Sends these bytes. Returns all bytes up to the end of the connection.
    fn raw(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        // the server may refuse the request before all of it is sent
        let _ = stream.write_all(request);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Sends a request with these headers, one per line. Returns the answer.
    fn ask(&self, method_and_path: &str, headers: &str, body: &str) -> String {
        let port = self.port;
        let host = if headers.starts_with("host:") { String::new() } else { format!("host: localhost:{port}\r\n") };
        let length = if body.is_empty() { String::new() } else { format!("content-length: {}\r\n", body.len()) };
        let head = format!("{method_and_path} HTTP/1.1\r\n{host}{headers}{length}connection: close\r\n\r\n");
        self.raw((head + body).as_bytes())
    }

    fn get(&self, path: &str) -> String {
        self.ask(&format!("GET {path}"), "", "")
    }

    /// Connects a viewer of the page, with these headers.
    fn watch_with(&self, headers: &[(&'static str, &str)]) -> Result<Watch, tungstenite::Error> {
        let mut request = format!("ws://127.0.0.1:{}/ws", self.port).into_client_request().expect("an address");
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().expect("a header"));
        }
        let connected = tungstenite::client(request, self.connect());
        let (socket, _) = connected.map_err(|error| match error {
            tungstenite::HandshakeError::Failure(error) => error,
            tungstenite::HandshakeError::Interrupted(_) => panic!("the handshake takes too long"),
        })?;
        Ok(Watch { socket })
    }

    fn watch(&self) -> Watch {
        self.watch_with(&[]).expect("a WebSocket")
    }

    /// Ends the server with SIGINT, as Ctrl-C does.
    fn interrupt(mut self) -> ExitStatus {
        let id = i32::try_from(self.child.id()).ok().and_then(rustix::process::Pid::from_raw).expect("an id");
        rustix::process::kill_process(id, rustix::process::Signal::INT).expect("a process");
        self.child.wait().expect("an end")
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        // killing the server fails if it has ended
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn wait_for(stderr: &Receiver<String>, text: &str) -> String {
    let begun = Instant::now();
    let mut all = String::new();
    while let Ok(line) = stderr.recv_timeout(LONG.saturating_sub(begun.elapsed())) {
        if line.contains(text) {
            return line;
        }
        all += &(line + "\n");
    }
    panic!("no {text:?} on stderr:\n{all}");
}

struct Watch {
    socket: WebSocket<TcpStream>,
}

impl Watch {
    fn frame(&mut self) -> Value {
        loop {
            if let Message::Binary(frame) = self.socket.read().expect("a frame") {
                return head(&frame);
            }
        }
    }

    /// Waits for a frame whose header fulfils `is`. Returns the header.
    fn until(&mut self, mut is: impl FnMut(&Value) -> bool) -> Value {
        let begun = Instant::now();
        while begun.elapsed() < LONG {
            let frame = self.frame();
            if is(&frame) {
                return frame;
            }
        }
        panic!("it never came");
    }

    fn ask(&mut self, request: &Value) -> Value {
        self.socket.send(Message::text(request.to_string())).expect("it is sent");
        loop {
            if let Message::Text(answer) = self.socket.read().expect("an answer") {
                return serde_json::from_str(&answer).expect("JSON");
            }
        }
    }
}

/// The header of a frame. Checks that the payload has the length that the strips state (docs/formats/page.md).
fn head(frame: &[u8]) -> Value {
    let length = u32::from_le_bytes(frame[..4].try_into().expect("4 bytes")) as usize;
    let header: Value = serde_json::from_slice(&frame[4..4 + length]).expect("JSON");
    let payload = frame.len() - (4 + length).next_multiple_of(4);
    let strips = header["strips"].as_array().expect("strips");
    let numbers: u64 = strips.iter().map(|strip| strip["count"].as_u64().expect("a number") * 6).sum();
    assert_eq!(payload as u64, numbers * 4, "{header}");
    header
}
