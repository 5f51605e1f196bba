//! Sends each case on its own connection, and checks all answers until the server closes the connection.

use super::cases::{self, Case, Expectation};
use super::tally::{Outcome, Tally};
use crate::server::Server;
use anyhow::{Context, Result, ensure};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

/// Read timeout. The server closes a connection after waiting 5 s for a request, so this suffices on any machine.
const PATIENCE: Duration = Duration::from_secs(60);
/// Number of simultaneous connections, well below the limit of the server.
const TOGETHER: usize = 32;

pub fn run(program: &Path) -> Result<Tally> {
    let server = Server::start(program, &["--device", "twin:seed=3"])?;
    let waiting = Mutex::new(cases::all().into_iter());
    let work = || {
        let next = || waiting.lock().expect("no thread panics").next();
        std::iter::from_fn(next).map(|case| (case.name.clone(), judge(&case, &server.page))).collect::<Vec<_>>()
    };
    let mut tally = Tally::default();
    thread::scope(|scope| {
        let threads: Vec<_> = (0..TOGETHER).map(|_| scope.spawn(work)).collect();
        threads.into_iter().for_each(|thread| tally.0.extend(thread.join().expect("no thread panics")));
    });
    let after = answers(&exchange(&server.page, cases::SMUGGLED)?)?;
    ensure!(matches!(&after[..], [(200, _)]), "the server does not answer any more: {after:?}");
    server.end()?;
    Ok(tally)
}

fn judge(case: &Case, address: &str) -> Outcome {
    let answers = exchange(address, &case.bytes).and_then(|bytes| answers(&bytes));
    let answers = match answers {
        Ok(answers) => answers,
        Err(why) => return Outcome::Wrong(format!("{why:#}")),
    };
    let is_smuggled = |answer: &(u16, Vec<u8>)| answer.1.starts_with(b"{\"home\"");
    let is_right = match (case.expected, &answers[..]) {
        (Expectation::Refused, []) => return Outcome::Refused("closed".to_owned()),
        (Expectation::Refused, [(status @ 400.., _)]) => return Outcome::Refused(status.to_string()),
        (Expectation::Once, [(200..300, _)]) => true,
        (Expectation::Both, [(200..300, _), second]) => is_smuggled(second),
        _ => false,
    };
    let found: Vec<u16> = answers.iter().map(|answer| answer.0).collect();
    if is_right { Outcome::Right } else { Outcome::Wrong(format!("{:?}, answered with {found:?}", case.expected)) }
}

fn exchange(address: &str, bytes: &[u8]) -> Result<Vec<u8>> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    // the server may close the connection before it has read everything
    let _ = stream.write_all(bytes);
    let (mut all, mut piece) = (Vec::new(), [0; 4096]);
    loop {
        match stream.read(&mut piece) {
            Ok(0) => return Ok(all),
            Ok(length) => all.extend(&piece[..length]),
            Err(error) if error.kind() == std::io::ErrorKind::ConnectionReset => return Ok(all),
            Err(error) => return Err(error).context("the connection stays open"),
        }
    }
}

/// Parses HTTP answers. Returns the status and the body of each.
fn answers(mut bytes: &[u8]) -> Result<Vec<(u16, Vec<u8>)>> {
    let mut answers = Vec::new();
    while !bytes.is_empty() {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").context("half a head of an answer")?;
        let head = str::from_utf8(&bytes[..end])?.to_ascii_lowercase();
        let status = head.strip_prefix("http/1.").and_then(|rest| rest.get(2..5)).context("not an answer")?.parse()?;
        let length = head.lines().find_map(|line| line.strip_prefix("content-length:"));
        let length = length.map_or(Ok(0), |length| length.trim().parse::<usize>())?;
        bytes = &bytes[end + 4..];
        let (content, rest) = bytes.split_at_checked(length).context("half an answer")?;
        answers.push((status, content.to_vec()));
        bytes = rest;
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_told_apart() {
        let two = b"HTTP/1.1 204 No Content\r\n\r\nHTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nab";
        assert_eq!(answers(two).unwrap(), [(204, vec![]), (200, b"ab".to_vec())]);
        assert!(answers(&two[..two.len() - 1]).is_err() && answers(b"ab").is_err());
    }
}
