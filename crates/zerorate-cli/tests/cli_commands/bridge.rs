//! Devices `bridge:` and `tcp:`. The firmware of the emulated bridge runs in the test, behind a TCP socket.

#[path = "../../../../firmware/qemu/src/bridge.rs"]
mod firmware;

use super::zerorate;
use crate::harness::{Bench, Run};
use adis16130::bridge::{Answer, Decoder, MAX_FRAME, Message, encode};
use adis16130_twin::{Fault, Spec, Twin};
use firmware::Port;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

/// Faults of the cable or of the bridge.
#[derive(Clone, Copy, Default)]
struct Cable {
    /// Flips a bit in every N-th frame, where N is this number.
    damages_every: Option<u64>,
    pulled_after: Option<u64>,
    /// Time from one sample to the next by the bridge's clock, ns; `None` leaves the times as they are.
    clock_step_ns: Option<u64>,
    /// True for old firmware, which does not know the command for a counter in the RDY line.
    is_old: bool,
}

/// Replaces the time in a frame that holds a sample.
fn with_time(frame: &[u8], clock_step_ns: u64) -> Vec<u8> {
    let mut decoder = Decoder::new();
    for byte in frame {
        if let Some(Ok(Message::Sample(mut reading))) = decoder.push(*byte) {
            reading.t_ns = 1_000_000_000 + clock_step_ns * u64::from(reading.number);
            return encode(&Message::Sample(reading), &mut [0; MAX_FRAME]).expect("a frame").to_vec();
        }
    }
    frame.to_vec()
}

fn configures(frame: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    let mut messages = frame.iter().filter_map(|byte| {
        let message = decoder.push(*byte)?.ok()?;
        Some(matches!(message, Message::Answer { answer: Answer::Configured, .. }))
    });
    messages.next() == Some(true)
}

struct Socket {
    /// Number of answers of the firmware to the commands Configure and Divided.
    configured: u32,
    stream: TcpStream,
    cable: Cable,
    frames: u64,
    bytes: u64,
}

impl Port for Socket {
    type Closed = ();

    fn read(&mut self, wait: bool) -> Result<Option<u8>, ()> {
        self.stream.set_nonblocking(!wait).map_err(drop)?;
        let mut byte = [0];
        match self.stream.read(&mut byte) {
            Ok(1) => Ok(Some(byte[0])),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
            _ => Err(()),
        }
    }

    fn write(&mut self, frame: &[u8]) -> Result<(), ()> {
        let mut frame = self.cable.clock_step_ns.map_or(frame.to_vec(), |step_ns| with_time(frame, step_ns));
        self.frames += 1;
        self.configured += u32::from(configures(&frame));
        if self.cable.is_old && self.configured > 1 && configures(&frame) {
            return Ok(());
        }
        if self.cable.damages_every.is_some_and(|every| self.frames.is_multiple_of(every)) {
            frame[2] ^= 0x10;
        }
        self.bytes += frame.len() as u64;
        if self.cable.pulled_after.is_some_and(|bytes| self.bytes > bytes) {
            return Err(());
        }
        self.stream.set_nonblocking(false).map_err(drop)?;
        self.stream.write_all(&frame).map_err(drop)
    }
}

/// Starts a bridge with this part and this cable, which serves one host after the other. Returns its `tcp:` address.
fn bridge(spec: Spec, cable: Cable) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    thread::spawn(move || {
        let twin = Twin::new(spec);
        for stream in listener.incoming().map_while(Result::ok) {
            let _ =
                firmware::serve(&twin, "test 1", &mut Socket { configured: 0, stream, cable, frames: 0, bytes: 0 });
        }
    });
    format!("tcp:{address}")
}

fn capture(device: &str, samples: &str) -> (Run, Bench) {
    let bench = Bench::new();
    let run = bench.zerorate(&format!("capture --device {device} --samples {samples} --json -o unit.csv"));
    (run, bench)
}

fn rows(bench: &Bench) -> Vec<Vec<u64>> {
    let text = bench.text("unit.csv");
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|row| row.split(',').map(|field| field.parse().unwrap_or(0)).collect()).collect()
}

#[test]
fn probe_sees_the_part_through_the_bridge() {
    let device = bridge(Spec::from_seed(7), Cable::default());
    let found = zerorate(&["probe", "--device", &device, "--duration", "1s", "--json"]).ended_with(0).json();
    assert_eq!(found["device"], device.as_str());
    assert_eq!((&found["lost_samples"], &found["warnings"]), (&0.into(), &serde_json::json!([])));
    assert_eq!((&found["sclk_hz"], &found["fastest_clean_sclk_hz"]), (&5_000_000.into(), &10_000_000.into()));
    assert!((found["rate_hz"].as_f64().expect("a rate") / 5692.6 - 1.0).abs() < 0.02, "{found}");
}

#[test]
fn a_bridge_takes_the_options_of_the_part() {
    let device = bridge(Spec::from_seed(7), Cable::default());
    let options = format!("{device}?framing=byte&width=16&fw=9");
    let arguments = ["probe", "--device", &options, "--duration", "1s", "--json", "--self-test"];
    let found = zerorate(&arguments).ended_with(0).json();
    assert_eq!((&found["framing"], &found["lost_samples"]), (&"byte".into(), &0.into()));
    // a filter word of 9 makes a conversion take 783 cycles of the master clock (F-31); a sample is two conversions
    assert!((found["rate_hz"].as_f64().expect("a rate") / (6e6 / 1566.0) - 1.0).abs() < 0.02, "{found}");
    let shift_dps = found["self_test"]["shift_dps"].as_f64().expect("a shift");
    assert!((shift_dps - 20.0).abs() < 2.0, "the twin's is 20 °/s, and its sensitivity is off by 3 %: {found}");
    // the pin of the self-test is released, so the rate is no longer shifted
    assert!(found["rate_dps"].as_f64().expect("a rate").abs() < 5.0, "{found}");
    let refused = format!("{device}?edge=rising");
    zerorate(&["probe", "--device", &refused]).ended_with(1).saying(&["cannot hear the edge", "leave edge= out"]);
    zerorate(&["probe", "--device", &device, "--self-test", "gpiochip0:3"]).ended_with(2).saying(&["takes no GPIO"]);
}

#[test]
fn a_bridge_is_told_of_a_counter_in_the_line() {
    let device = bridge(Spec::from_seed(7), Cable::default());
    let (run, bench) = capture(&format!("{device}?divided=50"), "50");
    run.ended_with(0);
    let text = bench.text("unit.csv");
    assert!(text.contains("zerorate.divided = 50"), "{}", &text[..1_000]);
    // the line of this bridge has no counter, so a capture without `divided` resets the setting
    let (run, bench) = capture(&device, "5000");
    assert_eq!(run.ended_with(0).json()["lost_samples"], 0);
    let rows = rows(&bench);
    assert_eq!(rows.len(), 5_000);
    let runs_on = |pair: &[Vec<u64>]| pair[1][0] > pair[0][0] && pair[1][1] == pair[0][1] + 1;
    assert!(rows.windows(2).all(runs_on), "time and edges run on");
    let old = bridge(Spec::from_seed(7), Cable { is_old: true, ..Cable::default() });
    zerorate(&["probe", "--device", &old, "--duration", "100ms"]).ended_with(0);
    let told = zerorate(&["probe", "--device", &format!("{old}?divided=50")]);
    told.ended_with(1).saying(&["does not know of a counter", "--divider 50"]);
}

#[test]
fn damaged_frames_are_counted_as_lost() {
    let cable = Cable { damages_every: Some(100), ..Cable::default() };
    let (run, bench) = capture(&bridge(Spec::from_seed(7), cable), "10000");
    let summary = run.ended_with(0).json();
    assert!(summary["warnings"].to_string().contains("damaged-frames: "), "{summary}");
    let (lost, rows) = (summary["lost_samples"].as_u64().expect("a number"), rows(&bench));
    // every 100th frame is damaged, and a few frames are answers in place of samples
    assert!((100..=102).contains(&lost), "{lost}");
    assert_eq!(rows.iter().map(|row| row[5]).sum::<u64>(), lost);
    assert_eq!(rows.iter().filter(|row| row[5] == 1).count() as u64, lost, "each is told of by the sample after it");
}

#[test]
fn a_pulled_cable_ends_a_whole_capture() {
    let cable = Cable { pulled_after: Some(100_000), ..Cable::default() };
    let (run, bench) = capture(&bridge(Spec::from_seed(7), cable), "100000");
    let run = run.ended_with(1).saying(&["is gone", "cable was pulled", "unit.csv ends after"]);
    let rows = rows(&bench).len();
    assert!((2_500..4_000).contains(&rows), "{rows}");
    assert!(run.stderr.contains(&format!("ends after {rows} samples")), "{}", run.stderr);
}

#[test]
fn a_clock_that_creeps_ends_a_whole_capture() {
    let cable = Cable { clock_step_ns: Some(1), ..Cable::default() };
    let (run, bench) = capture(&bridge(Spec::from_seed(7), cable), "100000000");
    let run = run.ended_with(1).saying(&["the clock of the bridge does not run", "reset the bridge", "unit.csv ends"]);
    let rows = rows(&bench).len();
    assert!(rows > 1_000 && run.stderr.contains(&format!("ends after {rows} samples")), "{rows}: {}", run.stderr);
}

#[test]
fn a_clock_that_stands_still_ends_every_command() {
    let cable = Cable { clock_step_ns: Some(0), ..Cable::default() };
    for command in ["probe", "calibrate"] {
        let device = bridge(Spec::from_seed(7), cable);
        zerorate(&[command, "--device", &device]).ended_with(1).saying(&["the clock of the device stands still"]);
    }
}

#[test]
fn an_unplugged_sensor_is_told_from_an_unplugged_bridge() {
    let mut spec = Spec::from_seed(7);
    (spec.fault, spec.fault_at_s) = (Fault::Unplug, Some(1.0));
    let (run, bench) = capture(&bridge(spec, Cable::default()), "100000");
    run.ended_with(1).saying(&["the part is unplugged or has no power", "ends after"]);
    assert!(rows(&bench).len() > 4_000);
}

#[test]
fn a_port_without_a_bridge_is_reported() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = format!("tcp:{}", listener.local_addr().expect("an address"));
    thread::spawn(move || {
        let kept: Vec<_> = listener.incoming().collect();
        drop(kept);
    });
    zerorate(&["probe", "--device", &address]).ended_with(1).saying(&[
        "does not answer",
        "is it a bridge",
        "nobody else",
    ]);
    zerorate(&["probe", "--device", "tcp:127.0.0.1:1"]).ended_with(1).saying(&["nothing answers at 127.0.0.1:1"]);
    zerorate(&["probe", "--device", "bridge:/dev/no-such-port"])
        .ended_with(1)
        .saying(&["no /dev/no-such-port", "ls /dev/ttyACM*"]);
}
