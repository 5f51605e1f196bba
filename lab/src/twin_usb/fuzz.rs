//! Fuzz tests of USB redirection: damaged bytes from the other end must not cause a panic. The harness is shared
//! with `zerorate-record`.

#[path = "../../../crates/zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../crates/zerorate-record/src/fuzz/harness.rs"]
mod harness;

use super::ljca::tests::Echo;
use super::ljca::{LONGEST_MESSAGE, Ljca};
use super::redir::{Connection, LONGEST_PACKET, Request};
use harness::edited;

fn packet(kind: u32, body: &[u8]) -> Vec<u8> {
    [&kind.to_le_bytes()[..], &(body.len() as u32).to_le_bytes(), &[0; 8], body].concat()
}

/// The packets of a session. The header of a hello packet has 12 bytes, and that of any other packet has 16.
fn session() -> Vec<u8> {
    let hello = Connection::hello_packet("guest");
    let control = packet(100, &[0x80, 6, 0x80, 0, 0, 1, 0, 0, 18, 0]);
    let bulk = packet(101, &[0x01, 0, 4, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4]);
    [hello, packet(6, &[1]), control, bulk, packet(9, &[0, 0])].concat()
}

#[test]
fn usb_redirection() {
    edited(2000, &[session()], |bytes| {
        let mut connection = Connection::default();
        connection.push(bytes);
        // every request consumes bytes, so this loop ends
        while let Ok(Some((id, request))) = connection.next() {
            if let Request::Control(control) = &request {
                let answer = Ljca::default().control(control);
                assert!(connection.control_result(id, control, answer.as_deref()).len() <= LONGEST_PACKET);
            }
        }
    });
}

#[test]
fn usb_messages() {
    // each message has two bytes of type and command, flags, a length, and the body: read a pin, set up a pin,
    // transfer over SPI
    let messages = vec![vec![3, 3, 1, 2, 1, 3], vec![3, 1, 1, 5, 1, 3, 0, 0, 0], vec![5, 3, 1, 6, 0, 3, 0, 1, 2, 3]];
    edited(2000, &messages, |bytes| {
        for answer in Ljca::default().message(bytes, &mut Echo(true)) {
            assert!(answer.len() <= LONGEST_MESSAGE);
        }
    });
}
