//! Damaged bytes to and from a bridge.

use super::edited;
use adis16130::bridge::{Answer, Command, Decoder, MAX_FRAME, Message, Request, WireSample, encode};

fn frame(message: &impl serde::Serialize) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).expect("it fits").to_vec()
}

/// Messages of a bridge. Damaged bytes give at most one message for each zero byte.
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

#[test]
fn bridge_requests() {
    let requests = vec![
        frame(&Request { tag: 1, command: Command::Transfer { bytes: &[1, 2, 3, 4] } }),
        frame(&Request { tag: 2, command: Command::Start { every_temp: 1, divider: 1, mclk_hz: 6_000_000 } }),
    ];
    edited(3000, &requests, |bytes| {
        let mut decoder = Decoder::new();
        for byte in bytes {
            let _ = decoder.push::<Request>(*byte);
        }
    });
}
