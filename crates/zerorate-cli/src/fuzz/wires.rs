//! Bytes from wires: the bridge, and the other end of a USB redirection.

use super::edited;
use crate::twin_usb::ljca::{Board, LONGEST_MESSAGE, Ljca};
use crate::twin_usb::redir::{Connection, LONGEST_PACKET, Request};
use adis16130::bridge::{Answer, Ask, Decoder, MAX_FRAME, Message, Request as BridgeRequest, WireSample, encode};

fn frame(message: &impl serde::Serialize) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).expect("it fits").to_vec()
}

/// Messages of a bridge: damaged bytes give at most one message for each zero byte.
#[test]
fn bridge_messages() {
    let reading = WireSample {
        number: 7,
        lost: 1,
        t_ns: 123_456_789,
        edge: 9,
        rate: 0x80_1234,
        status: Some(8),
        temp: Some(0x80_0000),
    };
    let hello = Answer::Hello { protocol: 1, firmware: "zerorate 0.1.0", sclk_hz: 5_000_000 };
    let messages = vec![
        frame(&Message::Sample(reading)),
        frame(&Message::Answer { tag: 3, answer: hello }),
        [frame(&Message::Ended), frame(&Message::Sample(WireSample { status: None, temp: None, ..reading }))].concat(),
    ];
    edited(3000, &messages, |bytes| {
        let mut decoder = Decoder::new();
        let messages = bytes.iter().filter(|byte| decoder.push::<Message>(**byte).is_some()).count();
        assert!(messages <= bytes.iter().filter(|byte| **byte == 0).count());
    });
}

/// Requests to a bridge.
#[test]
fn bridge_requests() {
    let requests = vec![
        frame(&BridgeRequest { tag: 1, ask: Ask::Transfer { bytes: &[1, 2, 3, 4] } }),
        frame(&BridgeRequest { tag: 2, ask: Ask::Start { every_temp: 1, divider: 1, mclk_hz: 6_000_000 } }),
    ];
    edited(3000, &requests, |bytes| {
        let mut decoder = Decoder::new();
        for byte in bytes {
            let _ = decoder.push::<BridgeRequest>(*byte);
        }
    });
}

fn packet(kind: u32, body: &[u8]) -> Vec<u8> {
    [&kind.to_le_bytes()[..], &(body.len() as u32).to_le_bytes(), &[0; 8], body].concat()
}

/// The packets of a session. A hello has a head of 12 bytes, the others a head of 16.
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
        // every request takes bytes away, so this ends
        while let Ok(Some((id, request))) = connection.next() {
            if let Request::Control(control) = &request {
                let answer = Ljca::default().control(control);
                assert!(connection.control_result(id, control, answer.as_deref()).len() <= LONGEST_PACKET);
            }
        }
    });
}

/// A part that answers with the bytes that it gets.
struct Echo;

impl Board for Echo {
    fn frame(&mut self, mosi: &[u8]) -> Vec<u8> {
        mosi.to_vec()
    }

    fn rdy_high(&mut self) -> bool {
        true
    }
}

#[test]
fn usb_messages() {
    // two bytes of type and command, flags, a length, and the body: read a pin, set one up, transfer over SPI
    let messages = vec![vec![3, 3, 1, 2, 1, 3], vec![3, 1, 1, 5, 1, 3, 0, 0, 0], vec![5, 3, 1, 6, 0, 3, 0, 1, 2, 3]];
    edited(2000, &messages, |bytes| {
        for answer in Ljca::default().message(bytes, &mut Echo) {
            assert!(answer.len() <= LONGEST_MESSAGE);
        }
    });
}
