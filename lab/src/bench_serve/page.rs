//! A minimal client in place of a web page. It receives frames and checks them against docs/formats/page.md.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Read timeout, longer than any frame takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);
/// Number of values in a bin of one axis: the smallest and the largest rate, corrected rate and temperature.
const COLUMNS: u64 = 6;

/// First byte of a WebSocket message with a binary frame, including the FIN bit (RFC 6455).
const FRAME: u8 = 0x82;
/// First byte of a request or an answer as text, including the FIN bit.
const TEXT: u8 = 0x81;
/// First byte of a ping, including the FIN bit. A connected page must answer a ping.
const PING: u8 = 0x89;
/// The answer to a ping: an empty pong with FIN, masked like every message of a page.
const PONG: [u8; 6] = [0x8a, 0x80, 0, 0, 0, 0];

#[derive(Clone, Copy, Debug, Default)]
pub struct Frames {
    pub count: u64,
    pub bytes: u64,
    /// Number of snapshots: the first frame, and one whenever the page was too slow.
    pub snapshots: u64,
}

/// Receives frames until `is_over` returns true, but at least two. Stores in `shown_ms` the latest time of the part
/// that a frame shows, ms.
pub fn watch(address: &str, is_over: &dyn Fn() -> bool, shown_ms: &AtomicU64) -> Result<Frames> {
    let mut stream = BufReader::new(connect(address)?);
    let (mut frames, mut last) = (Frames::default(), None);
    while frames.count < 2 || !is_over() {
        let frame = match message(&mut stream)? {
            (FRAME, frame) => frame,
            (PING, _) => {
                stream.get_mut().write_all(&PONG)?;
                continue;
            }
            _ => continue,
        };
        let header = header(&frame)?;
        let is_snapshot = header["snapshot"] == true;
        let seq = header["seq"].as_u64().context("no seq")?;
        ensure!(last.map_or(is_snapshot, |last| is_snapshot || seq == last + 1), "{seq} follows {last:?}");
        last = Some(seq);
        let ledger = &header["ledger"];
        ensure!(ledger.is_null() || (ledger["lost"] == 0 && ledger["missed"] == 0), "samples are missing: {ledger}");
        shown_ms.fetch_max((ledger["duration_s"].as_f64().unwrap_or(0.0) * 1e3) as u64, Ordering::Relaxed);
        frames.count += 1;
        frames.bytes += frame.len() as u64;
        frames.snapshots += u64::from(is_snapshot);
    }
    Ok(frames)
}

/// Sends a request of less than 126 bytes like a page. Returns the answer, or an error if the server refuses.
pub fn ask(address: &str, request: &str) -> Result<Value> {
    let mut stream = BufReader::new(connect(address)?);
    let length = u8::try_from(request.len()).ok().filter(|length| *length < 126).context("a long request")?;
    let masked = [&[TEXT, 0x80 | length, 0, 0, 0, 0], request.as_bytes()].concat();
    stream.get_mut().write_all(&masked)?;
    loop {
        if let (TEXT, answer) = message(&mut stream)? {
            let answer: Value = serde_json::from_slice(&answer)?;
            ensure!(answer["error"].is_null(), "{request} was refused: {answer}");
            return Ok(answer);
        }
    }
}

/// True if a newly opened page gets a notice with this code.
pub fn notice(address: &str, code: &str) -> Result<bool> {
    let mut stream = BufReader::new(connect(address)?);
    let header = header(&message(&mut stream)?.1)?;
    let notices = header["notices"].as_array().context("no notices")?;
    Ok(notices.iter().any(|notice| notice["code"] == code))
}

fn connect(address: &str) -> Result<TcpStream> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    let ask = "GET /ws HTTP/1.1\r\nhost: localhost\r\nconnection: upgrade\r\nupgrade: websocket\r\n\
        sec-websocket-version: 13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    stream.write_all(ask.as_bytes())?;
    let mut answer = Vec::new();
    // read byte by byte, because frames follow directly
    while !answer.ends_with(b"\r\n\r\n") {
        let [byte] = bytes(&mut stream)?;
        answer.push(byte);
    }
    let answer = String::from_utf8_lossy(&answer);
    ensure!(answer.contains(" 101 "), "no WebSocket: {answer}");
    Ok(stream)
}

/// Reads a message of the server, which is not masked (RFC 6455, 5.2). Returns its first byte and its content.
fn message(stream: &mut impl BufRead) -> Result<(u8, Vec<u8>)> {
    let [first, length] = bytes(stream)?;
    let length: u64 = match length {
        126 => u16::from_be_bytes(bytes(stream)?).into(),
        127 => u64::from_be_bytes(bytes(stream)?),
        short => short.into(),
    };
    let mut message = Vec::new();
    stream.take(length).read_to_end(&mut message)?;
    ensure!(message.len() as u64 == length, "the server hung up");
    Ok((first, message))
}

fn bytes<const N: usize>(stream: &mut impl Read) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    stream.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Parses the header of a frame. Checks that the payload has the length that the header's strips state.
fn header(frame: &[u8]) -> Result<Value> {
    let (length, rest) = frame.split_first_chunk().context("a frame without a length")?;
    let length = u32::from_le_bytes(*length) as usize;
    let header: Value = serde_json::from_slice(rest.get(..length).context("half a header")?)?;
    let strips = header["strips"].as_array().context("no strips")?;
    let numbers: u64 = strips.iter().filter_map(|strip| strip["count"].as_u64()).map(|bins| bins * COLUMNS).sum();
    let payload = frame.len().saturating_sub((4 + length).next_multiple_of(4));
    ensure!(payload as u64 == 4 * numbers, "{payload} bytes behind a header of {numbers} numbers");
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_as_long_as_its_strips_say() {
        let frame = |bins: u32, payload: usize| {
            let header = format!(r#"{{"seq":1,"strips":[{{"count":{bins}}}]}}"#);
            let mut frame = [&(header.len() as u32).to_le_bytes()[..], header.as_bytes()].concat();
            frame.resize(frame.len().next_multiple_of(4) + payload, 0);
            frame
        };
        assert!(header(&frame(2, 48)).is_ok());
        for wrong in [frame(2, 44), frame(0, 4), vec![9, 0, 0], vec![9, 0, 0, 0, b'{']] {
            assert!(header(&wrong).is_err(), "{wrong:?}");
        }
    }
}
