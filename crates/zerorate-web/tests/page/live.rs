//! A page's session with its devices, without a browser. The tests control its clock.

#[path = "../../../../firmware/qemu/src/bridge.rs"]
#[allow(dead_code, reason = "a firmware that is built for its target uses all of it")]
mod firmware;

use adis16130_twin::{Fault, Spec, Twin};
use serde_json::Value;
use std::cell::Cell;
use std::collections::VecDeque;
use std::ops::Range;
use std::rc::Rc;
use zerorate_web::first::FirstLook;
use zerorate_web::live::{Live, Open};
use zerorate_web::source::{Bridge, Replay, Source, TwinSource};

fn twin(keys: &'static str) -> Open {
    Box::new(move |_| Ok(Box::new(TwinSource::open(keys)?) as Box<dyn Source>))
}

fn header(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&bytes[4..4 + length]).expect("JSON")
}

fn seen(live: &mut Live) -> Value {
    header(&live.session.snapshot())
}

/// Runs a turn every 33 ms, for `for_ms`. Each reading of the clock takes `look_ms`.
fn run(live: &mut Live, now_ms: &mut f64, for_ms: f64, look_ms: f64) {
    let until_ms = *now_ms + for_ms;
    while *now_ms < until_ms {
        let next_ms = *now_ms + 33.0;
        let mut clock = || {
            *now_ms += look_ms;
            *now_ms
        };
        live.turn(&mut clock, 25.0);
        *now_ms = now_ms.max(next_ms);
    }
}

#[test]
fn simulated_time_goes_with_the_clock_or_as_fast_as_asked() {
    let mut now_ms = 1000.0;
    let mut live = Live::open(twin("seed=7"), now_ms).expect("a twin");
    run(&mut live, &mut now_ms, 2000.0, 0.001);
    let t_s = seen(&mut live)["now"]["t_s"].as_f64().expect("a time");
    assert!((1.9..2.1).contains(&t_s), "{t_s}");
    assert_eq!(live.ask(r#"{"id": 3, "do": "speed", "factor": 10}"#, now_ms), r#"{"id":3,"ok":{}}"#);
    run(&mut live, &mut now_ms, 1000.0, 0.001);
    let faster_s = seen(&mut live)["now"]["t_s"].as_f64().expect("a time") - t_s;
    assert!((9.0..10.6).contains(&faster_s), "{faster_s}");
    assert_eq!(seen(&mut live)["ledger"]["lost"], 0);
    assert_eq!(seen(&mut live)["device"]["registers"].as_array().map(Vec::len), Some(13));
}

/// The smallest rate in each bin of 64 ms, as the bits of an f32, from the first bin on.
fn rates(bytes: &[u8]) -> Vec<u32> {
    let told = header(bytes);
    let is_it = |strip: &&Value| strip["level"] == 2;
    let strip = told["strips"].as_array().and_then(|all| all.iter().find(is_it)).expect("a strip");
    let number = |of: &str| usize::try_from(strip[of].as_u64().expect("a number")).expect("a small one");
    let length = u32::from_le_bytes(bytes[..4].try_into().expect("four bytes")) as usize;
    let payload = &bytes[(4 + length).next_multiple_of(4)..];
    let numbers = payload[4 * number("at")..].chunks_exact(4).take(number("count"));
    assert_eq!(strip["first"], 0);
    numbers.map(|four| u32::from_le_bytes(four.try_into().expect("four bytes"))).collect()
}

#[test]
fn a_session_continues_from_the_preview() {
    let mut now_ms = 1000.0;
    let mut look = FirstLook::open("seed=7,bias_dps=1.5").expect("a twin");
    while now_ms < 3000.0 {
        look.turn(&mut || now_ms, 25.0);
        now_ms += 33.0;
    }
    let seen_first = look.snapshot();
    assert!(look.frame().is_some_and(|frame| header(&frame)["device"]["state"]["is"] == "reading"));
    let shown_s = look.shown_s();
    assert!((1.9..2.1).contains(&shown_s), "{shown_s}");
    // the page's clock goes on while the module of the session loads, and the preview does not
    now_ms += 500.0;
    let mut live = Live::open(twin("seed=7,bias_dps=1.5"), now_ms).expect("the same");
    live.catch_up(shown_s, &mut || now_ms);
    let t_s = seen(&mut live)["now"]["t_s"].as_f64().expect("a time");
    assert!((shown_s - 0.01..shown_s + 0.01).contains(&t_s), "{t_s} is not {shown_s}");
    run(&mut live, &mut now_ms, 1000.0, 0.001);
    let later_s = seen(&mut live)["now"]["t_s"].as_f64().expect("a time") - t_s;
    assert!((0.9..1.1).contains(&later_s), "{later_s}");
    let (before, after) = (rates(&seen_first), rates(&live.session.snapshot()));
    assert!(before.len() > 25 && after.starts_with(&before), "{} bins", before.len());
    assert!(FirstLook::open("sed=7").is_err_and(|why| why.contains("sed")));
}

#[test]
fn a_slow_page_keeps_its_turns_short_and_does_not_catch_up() {
    let mut now_ms = 0.0;
    let mut live = Live::open(twin("seed=7"), now_ms).expect("a twin");
    // each reading of the clock takes 5 ms, so a turn that falls behind ends after four times 64 samples
    run(&mut live, &mut now_ms, 1000.0, 5.0);
    let samples = seen(&mut live)["ledger"]["samples"].as_u64().expect("a count");
    assert!((1000..5694).contains(&samples), "{samples}");
}

#[test]
fn opening_again_begins_anew_and_a_fault_is_reported() {
    let mut now_ms = 0.0;
    let mut live = Live::open(twin("seed=7"), now_ms).expect("a twin");
    run(&mut live, &mut now_ms, 500.0, 0.001);
    assert!(live.ask(r#"{"id": 1, "do": "reopen"}"#, now_ms).contains("ok"));
    run(&mut live, &mut now_ms, 100.0, 0.001);
    assert!(seen(&mut live)["now"]["t_s"].as_f64().expect("a time") < 0.2);
    live.instead(twin("fault=unplug,fault_at_s=0.2"), now_ms).expect("another twin");
    run(&mut live, &mut now_ms, 2000.0, 0.001);
    let state = seen(&mut live)["device"]["state"].clone();
    assert_eq!(state["is"], "failed", "{state}");
    assert!(live.instead(twin("sed=7"), now_ms).is_err_and(|why| why.contains("sed")));
    assert!(Replay::open("x.csv", b"1,2\n".to_vec().into()).is_err());
}

/// A page that reads a bridge. The firmware of the bridge uses it as its serial port.
struct Page {
    live: Live,
    now_ms: f64,
    until_ms: f64,
    to_bridge: VecDeque<u8>,
    /// Number of the bridge's next messages that are lost.
    to_lose: u32,
    /// The time during which the browser window that holds the serial port passes no bytes on, ms.
    blocked_ms: Range<f64>,
    /// The bytes that wait in the blocked window.
    held: Vec<u8>,
}

impl Page {
    fn new(to_lose: u32) -> Self {
        let open: Open = Box::new(|now_ms| Ok(Box::new(Bridge::open(now_ms)) as Box<dyn Source>));
        let live = Live::open(open, 0.0).expect("a bridge that is not there yet");
        let (to_bridge, held) = (VecDeque::new(), Vec::new());
        Self { live, now_ms: 0.0, until_ms: 0.0, to_bridge, to_lose, blocked_ms: 0.0..0.0, held }
    }

    /// Reads the part behind the bridge up to a time.
    fn read_until(&mut self, twin: &Twin, until_ms: f64) -> Value {
        self.until_ms = until_ms;
        assert!(firmware::serve(twin, "test 1.0", self).is_err());
        self.live.session.frame();
        seen(&mut self.live)
    }

    fn is_blocked(&self) -> bool {
        self.blocked_ms.contains(&self.now_ms)
    }
}

impl firmware::Port for Page {
    type Closed = ();

    fn read(&mut self, wait: bool) -> Result<Option<u8>, ()> {
        loop {
            if let Some(byte) = self.to_bridge.pop_front() {
                return Ok(Some(byte));
            }
            self.now_ms += 0.2;
            let now_ms = self.now_ms;
            self.live.turn(&mut || now_ms, 25.0);
            if !self.is_blocked() {
                self.to_bridge.extend(self.live.to_send());
            }
            if now_ms > self.until_ms {
                return Err(());
            }
            if self.to_bridge.is_empty() && !wait {
                return Ok(None);
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), ()> {
        if self.to_lose > 0 {
            self.to_lose -= 1;
            return Ok(());
        }
        self.held.extend(bytes);
        if !self.is_blocked() {
            self.live.received(&std::mem::take(&mut self.held), self.now_ms);
        }
        Ok(())
    }
}

#[test]
fn a_bridge_is_opened_and_read_though_answers_are_lost() {
    let seen = Page::new(2).read_until(&Twin::new(Spec::from_seed(7)), 2500.0);
    assert_eq!(seen["device"]["name"], "bridge: test 1.0");
    assert_eq!((&seen["device"]["state"]["is"], &seen["ledger"]["lost"]), (&"reading".into(), &0.into()), "{seen}");
    assert_eq!(seen["device"]["registers"][0]["name"], "IOP", "{seen}");
    assert!(seen["ledger"]["samples"].as_u64() > Some(5000), "{seen}");
}

#[test]
fn a_dead_part_and_a_silent_bridge_are_reported() {
    let spec = Spec { fault: Fault::Unplug, fault_at_s: Some(0.5), ..Spec::from_seed(7) };
    let state = Page::new(0).read_until(&Twin::new(spec), 10_000.0)["device"]["state"].clone();
    assert!(state["why"].as_str().is_some_and(|why| why.contains("SDO")), "{state}");

    let mut page = Page::new(u32::MAX);
    let state = page.read_until(&Twin::new(Spec::from_seed(7)), 10_000.0)["device"]["state"].clone();
    assert!(state["why"].as_str().is_some_and(|why| why.contains("does not answer")), "{state}");
    page.live.unplugged("NetworkError");
}

#[test]
fn a_window_that_is_blocked_for_a_while_loses_nothing() {
    let mut page = Page::new(0);
    page.blocked_ms = 1000.0..9000.0;
    let seen = page.read_until(&Twin::new(Spec::from_seed(7)), 10_000.0);
    assert_eq!((&seen["device"]["state"]["is"], &seen["ledger"]["lost"]), (&"reading".into(), &0.into()), "{seen}");
    let mut page = Page::new(0);
    page.blocked_ms = 1000.0..f64::INFINITY;
    let state = page.read_until(&Twin::new(Spec::from_seed(7)), 33_000.0)["device"]["state"].clone();
    assert!(state["why"].as_str().is_some_and(|why| why.contains("the window that reads its port")), "{state}");
}

/// The session opens the device when the calibration is requested, and again when the part has answered.
#[test]
fn a_part_behind_a_bridge_is_calibrated() {
    let spec = Spec::parse_keys("seed=7,warmup_s=3").expect("keys");
    let (twin, mut page) = (Twin::new(spec), Page::new(0));
    page.read_until(&twin, 500.0);
    let command = r#"{"id": 1, "do": "calibrate", "method": "an1042", "average_s": 4, "warmup_s": 10, "settle_s": 5,
        "offset_s": 4, "latitude_deg": 30}"#;
    assert!(page.live.ask(command, page.now_ms).contains("ok"));
    let calibration = page.read_until(&twin, 40_000.0)["calibration"].clone();
    assert_eq!(calibration["is"], "done", "{calibration}");
    let curve = calibration["axes"][0]["curve"].as_array().expect("a curve");
    assert!(curve.iter().all(|point| point["correction_dps"].is_number()), "{calibration}");
    let id = &calibration["entry"]["id"];
    let file = format!(r#"{{"id": 2, "do": "download", "calibration": {id}, "form": "toml"}}"#);
    // the Earth's rotation about the vertical is 0.00418 °/s times the sine of the latitude (F-16)
    let toml = page.live.ask(&file, page.now_ms);
    assert!(toml.contains("earth_dps = 0.00209") || toml.contains("earth_dps = 0.0020899"), "{toml}");
}

#[test]
fn a_calibration_ends_when_its_device_is_gone() {
    let mut now_ms = 0.0;
    let gone = Rc::new(Cell::new(false));
    let is_gone = gone.clone();
    let open = move |_| match is_gone.get() {
        true => Err("the part is gone".to_owned()),
        false => Ok(Box::new(TwinSource::open("seed=7")?) as Box<dyn Source>),
    };
    let mut live = Live::open(Box::new(open), now_ms).expect("a twin");
    let command = r#"{"id": 1, "do": "calibrate", "method": "an1042"}"#;
    gone.set(true);
    assert!(live.ask(command, now_ms).contains("the part is gone"));
    let calibration = seen(&mut live)["calibration"].clone();
    assert_eq!((&calibration["is"], &calibration["text"]), (&"aborted".into(), &"the part is gone".into()));
    gone.set(false);
    assert!(live.ask(command, now_ms).contains("ok"));
    run(&mut live, &mut now_ms, 200.0, 0.001);
    assert_eq!(seen(&mut live)["calibration"]["is"], "running");
    live.instead(twin("seed=8"), now_ms).expect("another twin");
    run(&mut live, &mut now_ms, 200.0, 0.001);
    let calibration = seen(&mut live)["calibration"].clone();
    assert_eq!((&calibration["is"], &calibration["text"]), (&"aborted".into(), &"another device was opened".into()));
}
