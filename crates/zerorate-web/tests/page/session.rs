//! Tests of the session with the twin, the simulated sensor, by the messages that the page would get.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, Framing, MCLK_HZ, Sampler, SamplerConfig, Width};
use adis16130_twin::{Spec, Twin, TwinSpi};
use embedded_hal::delay::DelayNs;
use serde_json::{Value, json};
use std::fmt::Display;
use zerorate::Part;
use zerorate_record::{CaptureInfo, Converter, Row};
use zerorate_web::message::DeviceState;
use zerorate_web::session::{About, HostCommand, RequestResult, Session};

/// The simulated sensor, read by the driver.
struct Device {
    twin: Twin,
    gyro: Adis16130<TwinSpi, ()>,
    sampler: Sampler,
}

/// The part is read on every 50th edge, 223 times a second.
const DIVIDER: u16 = 50;

impl Device {
    fn open(keys: &str) -> Self {
        let twin = Twin::new(Spec::parse_keys(keys).unwrap());
        let config = Config::new().with_framing(Framing::Command);
        let mut gyro = Adis16130::new(twin.spi(), (), config);
        gyro.reset().unwrap();
        gyro.init_verified().unwrap();
        twin.delay().delay_us(100);
        let sampling = SamplerConfig::new().with_divider(DIVIDER);
        Self { twin, gyro, sampler: Sampler::new(sampling, &config, MCLK_HZ) }
    }

    fn next(&mut self) -> Row {
        loop {
            let edge = self.twin.next_falling_edge(1_000_000).unwrap();
            if let Some(sample) = self.gyro.sample(&mut self.sampler, Edge { t_ns: edge.t_ns, seq: edge.seq }).unwrap()
            {
                return Row::from(&sample);
            }
        }
    }
}

fn about() -> About {
    let converter = Converter { width: Width::Bits24, rate_conversion: 0x81, temp_conversion: 0x81 };
    let info = CaptureInfo { device: "twin:".into(), divider: DIVIDER, ..CaptureInfo::adis16130(converter) };
    let (registers, checks) = (Vec::new(), Vec::new());
    About { name: "twin:".into(), info, part: Part::ADIS16130, simulated: true, nominal_hz: None, registers, checks }
}

fn feed(session: &mut Session, device: &mut Device, seconds: f64) {
    for _ in 0..(seconds * 2.232).ceil() as u32 {
        (0..100).for_each(|_| session.take(&device.next()));
        session.truths(&[device.twin.truth()]);
    }
}

fn read(frame: &[u8]) -> (Value, Vec<f32>) {
    let length = u32::from_le_bytes(frame[..4].try_into().unwrap()) as usize;
    let header = serde_json::from_slice(&frame[4..4 + length]).unwrap();
    let numbers = frame[(4 + length).next_multiple_of(4)..].chunks_exact(4);
    (header, numbers.map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect())
}

fn asked(session: &mut Session, request: impl Display) -> Value {
    match session.ask(&request.to_string()) {
        RequestResult::Answer(text) => serde_json::from_str(&text).unwrap(),
        RequestResult::Host { .. } => panic!("{request} is the session's own"),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A session that has begun a calibration by this request, and whose device was opened again for it.
fn calibrating(request: Value) -> Session {
    let mut session = Session::new(about());
    assert_eq!(session.ask(&request.to_string()), RequestResult::Host { id: 1, command: HostCommand::Reopen });
    let mut session = session.reopened(about());
    session.state(DeviceState::Reading);
    session
}

/// The state of the calibration in the next frame.
fn calibration(session: &mut Session) -> Value {
    read(&session.frame().unwrap()).0["calibration"].clone()
}

/// Checks that the curve of the only axis is that of the twin, within `u` standard uncertainties.
#[track_caller]
fn curve_holds(done: &Value, u: f64) {
    for point in done["axes"][0]["curve"].as_array().unwrap() {
        let off = number(&point["correction_dps"]) - number(&point["truth_dps"]);
        assert!(off.abs() < u * number(&point["u_dps"]), "{point}");
    }
}

#[test]
fn a_minute_of_the_twin_fills_the_frames() {
    let mut device = Device::open("seed=3,bias_dps=0.7,roa=10nf");
    let mut session = Session::new(about());
    session.state(DeviceState::Reading);
    feed(&mut session, &mut device, 61.0);
    let (frame, payload) = read(&session.frame().unwrap());
    assert_eq!((&frame["snapshot"], &frame["device"]["state"]["is"]), (&json!(true), &json!("reading")));
    let now = &frame["now"]["axes"][0];
    assert!((number(&now["rate_dps"]) - 0.7).abs() < 0.1, "{now}");
    assert_eq!(now["rest"]["verdict"], "at-rest");
    assert!((number(&now["angle_deg"]) - 0.7 * 61.0).abs() < 6.0, "{now}");
    let u = number(&now["u_rate_dps"]);
    assert!((0.006..0.012).contains(&u), "0.0125/√2 is 0.0088: {u}");
    assert_eq!(frame["ledger"]["lost"], 0);
    let checks = frame["device"]["checks"].as_array().unwrap();
    let whats: Vec<&Value> = checks.iter().map(|check| &check["what"]).collect();
    assert_eq!(whats, ["samples", "noise"]);
    // at every 50th edge, readings are too rare to tell bit errors from motion, and the check says so
    assert!(checks[0]["text"].as_str().unwrap().contains("smaller divider"), "{checks:?}");
    assert_eq!(checks[1]["ok"], true, "{checks:?}");
    let statistics = &frame["statistics"][0];
    let n = &statistics["coefficients"][0];
    assert!((number(&n["value"]) / (0.0125 / 2f64.sqrt()) - 1.0).abs() < 0.15, "{n}");
    assert_eq!((&n["identified"], &n["symbol"]), (&json!(true), &json!("N")));
    let k = &statistics["coefficients"][2];
    assert!(k["identified"] == false && number(&k["identified_in_s"]) > 0.0, "{k}");
    let points = statistics["allan"].as_array().unwrap();
    assert!(points.len() > 10 && points.windows(2).all(|pair| number(&pair[0]["tau_s"]) < number(&pair[1]["tau_s"])));
    assert!(statistics["spectrum"].as_array().unwrap().len() > 50);
    let kinds: Vec<&Value> = statistics["marks"].as_array().unwrap().iter().map(|mark| &mark["kind"]).collect();
    assert_eq!(kinds, ["bandwidth", "resonance", "nyquist"]);
    let strip = &frame["strips"][2];
    let (at, count) = (number(&strip["at"]) as usize, number(&strip["count"]) as usize);
    assert!(strip["level"] == 2 && count > 900);
    assert!(payload[at..at + count].iter().zip(&payload[at + count..]).all(|(low, high)| low <= high));
    // a bin of 64 ms has about 14 readings around 0.7 °/s
    let low: f32 = payload[at..at + count].iter().sum::<f32>() / count as f32;
    let high: f32 = payload[at + count..at + 2 * count].iter().sum::<f32>() / count as f32;
    assert!(low < 0.7 && 0.7 < high && high - low < 1.5, "{low} {high}");

    assert!(session.frame().is_none(), "nothing is new");
    feed(&mut session, &mut device, 0.3);
    let (frame, _) = read(&session.frame().unwrap());
    assert_eq!(
        (&frame["snapshot"], &frame["device"], &frame["statistics"]),
        (&json!(false), &Value::Null, &Value::Null)
    );
    let (all, _) = read(&session.snapshot());
    assert!(all["snapshot"] == true && all["device"]["part"] == "ADIS16130" && all["calibration"]["is"] == "idle");
}

#[test]
fn the_forecast_agrees_with_the_result() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "warmup" }));
    let mut device = Device::open("seed=11");
    feed(&mut session, &mut device, 610.0);
    let mut shown = Value::Null;
    let looked_s = |shown: &Value| shown["forecast"]["at_s"].as_f64().unwrap_or(0.0);
    while looked_s(&shown) < 612.0 {
        feed(&mut session, &mut device, 0.5);
        shown = calibration(&mut session);
    }
    assert_eq!((&shown["can_finish"], &shown["is_enough"]), (&json!(true), &json!(false)), "it is still warming");
    session.ask(&json!({ "id": 2, "do": "finish-calibration" }).to_string());
    feed(&mut session, &mut device, 0.5);
    let stated = calibration(&mut session)["axes"][0].clone();
    for u in ["u_pbc_dps", "u_btc_dps_per_c"] {
        let ratio = number(&shown["forecast"][u]) / number(&stated[u]);
        assert!((ratio - 1.0).abs() < 0.02, "{u}: {} shown, {} stated", shown["forecast"][u], stated[u]);
    }
}

#[test]
fn a_guided_calibration_finds_what_the_twin_hides() {
    let keys = "seed=11";
    let mut session = Session::new(about());
    session.state(DeviceState::Reading);
    feed(&mut session, &mut Device::open(keys), 5.0);
    let begin = json!({ "id": 1, "do": "calibrate", "method": "warmup", "settle_s": 600.0, "serial": "A 7" });
    assert_eq!(session.ask(&begin.to_string()), RequestResult::Host { id: 1, command: HostCommand::Reopen });
    let again = session.ask(&begin.to_string());
    assert!(matches!(again, RequestResult::Answer(text) if text.contains("a calibration is running")));
    let mut session = session.reopened(about());
    session.state(DeviceState::Reading);
    let mut device = Device::open(keys);
    feed(&mut session, &mut device, 400.0);
    let running = calibration(&mut session);
    assert_eq!(
        (&running["is"], &running["pending_refusals"], running["steps"].as_array().unwrap().len()),
        (&json!("running"), &json!([]), 1)
    );
    assert!((number(&running["left_s"]) - 971.0).abs() < 3.0, "{running}");
    assert!(number(&running["temps_c"][1]) > number(&running["temps_c"][0]) + 2.0);
    feed(&mut session, &mut device, 980.0);
    let done = calibration(&mut session);
    assert_eq!(done["is"], "done", "{done}");
    curve_holds(&done, 4.0);
    let axis = &done["axes"][0];
    assert!(number(&axis["after_dps"]).abs() < 0.02 && number(&axis["before_dps"]).abs() > 0.02, "{axis}");

    let id = done["entry"]["id"].clone();
    assert_eq!(asked(&mut session, json!({ "id": 2, "do": "apply", "calibration": id }))["ok"], json!({}));
    its_files_are_there(&mut session, &id);
    feed(&mut session, &mut device, 2.0);
    let (frame, _) = read(&session.frame().unwrap());
    assert!(number(&frame["now"]["axes"][0]["corrected_dps"]).abs() < 0.05);
    assert!(!says(&session, "unknown-serial"), "it was measured on this very part");
    assert_eq!(
        (&frame["calibrations"][0]["applied"], frame["calibrations"].as_array().unwrap().len()),
        (&json!(true), 1)
    );
}

/// The calibration of `A 7` can be downloaded in all formats, and added again.
fn its_files_are_there(session: &mut Session, id: &Value) {
    let file = asked(session, json!({ "id": 3, "do": "download", "calibration": id, "form": "toml" }));
    assert_eq!(file["ok"]["name"], "A_7.toml");
    let toml = file["ok"]["text"].as_str().unwrap();
    let kept = asked(session, json!({ "id": 4, "do": "add-calibration", "toml": toml }));
    assert_eq!(kept["ok"]["id"], *id);
    let page = asked(session, json!({ "id": 5, "do": "download", "calibration": id, "form": "report" }));
    assert!(page["ok"]["text"].as_str().unwrap().starts_with("<!"));
    for (form, name, word) in [
        ("c", "A_7.h", "#include <stdint.h>"),
        ("rust", "A_7.rs", "pub const"),
        ("csv", "A_7.csv", "delta_c"),
        ("json", "A_7.json", "{"),
    ] {
        let made = asked(session, json!({ "id": 6, "do": "download", "calibration": id, "form": form }));
        assert_eq!(made["ok"]["name"], name);
        assert!(made["ok"]["text"].as_str().unwrap().contains(word), "{form}");
    }
}

#[test]
fn a_pending_refusal_is_shown_before_the_end() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "an1042" }));
    let mut device = Device::open("seed=2,motion=sway,sway_dps=0.5,sway_hz=0.2");
    feed(&mut session, &mut device, 8.0);
    let running = calibration(&mut session);
    let refusal = running["pending_refusals"][0].as_str().unwrap();
    assert!(refusal.contains("the part moves") || refusal.contains("shakes"), "{refusal}");
    feed(&mut session, &mut device, 4.0);
    let (frame, _) = read(&session.frame().unwrap());
    assert_eq!(frame["calibration"]["is"], "refused");
    assert!(frame["now"]["axes"][0]["rest"]["verdict"] != "at-rest");
    assert_eq!(asked(&mut session, json!({ "id": 2, "do": "dismiss-calibration" }))["ok"], json!({}));
}

#[test]
fn requests_that_make_no_sense_are_answered() {
    let mut session = Session::new(about());
    for (request, id, word) in [
        ("", 0, "not understood"),
        (r#"{"id": 9, "do": "fly"}"#, 9, "fly"),
        (r#"{"id": 3, "do": "speed", "factor": -1}"#, 3, "factor"),
        (r#"{"id": 4, "do": "apply", "calibration": "none"}"#, 4, "no calibration"),
        (r#"{"id": 5, "do": "add-calibration", "toml": "schema = 1"}"#, 5, "part"),
        (r#"{"id": 6, "do": "finish-calibration"}"#, 6, "no calibration"),
        (r#"{"id": 8, "do": "calibrate", "method": "chamber", "plan": "three-point"}"#, 8, "two-point"),
        (r#"{"id": 7, "do": "calibrate", "method": "warmup", "average_s": -3}"#, 7, "averages"),
        (r#"{"id": 10, "do": "calibrate", "method": "warmup", "latitude_deg": 95}"#, 10, "from -90 to 90"),
    ] {
        let answer = asked(&mut session, request);
        assert_eq!(answer["id"], id, "{request}");
        assert!(answer["error"].as_str().unwrap().contains(word), "{request}: {answer}");
    }
}

/// The simulated oven follows the profile of F-57, like a person who sets a chamber by the plan `f57`.
#[test]
fn a_chamber_is_set_by_hand() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "chamber", "plan": "f57" }));
    let mut device = Device::open("seed=5,profile=oven,hysteresis=0");
    feed(&mut session, &mut device, 3600.0);
    let running = calibration(&mut session);
    assert!(running["advice"].as_str().unwrap().starts_with("Step "), "{running}");
    let steps = running["steps"].as_array().unwrap();
    assert!(steps.windows(2).all(|pair| pair[0]["to_s"] == pair[1]["from_s"]) && steps.len() == 4, "{running}");
    feed(&mut session, &mut device, 9020.0);
    let done = calibration(&mut session);
    assert_eq!((&done["is"], &done["entry"]["method"]), (&json!("done"), &json!("chamber")), "{done}");
    curve_holds(&done, 4.5);
}

/// Nobody sets the chamber: the first step goes on after its least duration, and the other steps are delayed.
#[test]
fn a_step_lasts_until_the_part_has_settled() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "chamber" }));
    let mut device = Device::open("seed=5");
    let mut after = |part_s: f64| {
        feed(&mut session, &mut device, part_s);
        calibration(&mut session)
    };
    let (early, late) = (after(20.0), after(1000.0));
    let steps = late["steps"].as_array().unwrap();
    assert!(late["advice"].as_str().unwrap().starts_with("Step 1 of 3: set the chamber to 15.0 °C"), "{late}");
    assert_eq!(number(&steps[0]["to_s"]), number(&late["elapsed_s"]), "{late}");
    let others_s = |of: &Value| number(&of["steps"][2]["to_s"]) - number(&of["steps"][0]["to_s"]);
    assert!((others_s(&early) - others_s(&late)).abs() < 1e-6, "{early} {late}");
    assert!((number(&late["left_s"]) - others_s(&late)).abs() < 1e-6, "{late}");
}

#[test]
fn a_device_that_fails_ends_its_calibration() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "an1042" }));
    feed(&mut session, &mut Device::open("seed=1"), 3.0);
    session.state(DeviceState::Failed { why: "the cable was pulled".into() });
    let ended = calibration(&mut session);
    assert_eq!((&ended["is"], &ended["text"]), (&json!("aborted"), &json!("the cable was pulled")));
}

#[test]
fn a_cycle_is_finished_by_hand() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "cycle" }));
    let mut device = Device::open("seed=5,warmup_s=100");
    feed(&mut session, &mut device, 30.0);
    let finish = json!({ "id": 2, "do": "finish-calibration" });
    assert_eq!(calibration(&mut session)["can_finish"], false);
    for to_c in [45.0, 25.0] {
        device.twin.set_ambient(to_c, 300.0);
        feed(&mut session, &mut device, 320.0);
    }
    let running = calibration(&mut session);
    assert_eq!((&running["is"], &running["can_finish"]), (&json!("running"), &json!(true)));
    assert_eq!(asked(&mut session, finish)["ok"], json!({}));
    let done = calibration(&mut session);
    assert_eq!((&done["is"], &done["entry"]["method"]), (&json!("done"), &json!("cycle")), "{done}");
    curve_holds(&done, 4.0);
}

const ON_FILE: &str = include_str!("../../../zerorate-cli/tests/golden/short.toml");

/// The angle restarts when a calibration is applied, because the earlier integral is of the raw rate.
#[test]
fn an_angle_is_of_one_correction() {
    let (mut session, mut device) = (Session::new(about()), Device::open("seed=3,bias_dps=5"));
    feed(&mut session, &mut device, 15.0);
    let angle = |session: &mut Session| read(&session.snapshot()).0["now"]["axes"][0].clone();
    assert!((number(&angle(&mut session)["angle_deg"]) - 75.0).abs() < 4.0);
    let before_deg = number(&angle(&mut session)["u_angle_deg"]);
    let id = session.add_calibration(ON_FILE).unwrap();
    session.apply(Some(&id)).unwrap();
    feed(&mut session, &mut device, 0.4);
    let after = angle(&mut session);
    assert!(number(&after["angle_deg"]).abs() < 4.0 && number(&after["u_angle_deg"]) < before_deg, "{after}");
}

#[test]
fn a_part_that_does_not_bear_a_calibration_has_none_applied() {
    let mut session = Session::new(about());
    let id = session.add_calibration(ON_FILE).unwrap();
    session.apply(Some(&id)).unwrap();
    let session = session.reopened(about());
    assert_eq!(read(&session.snapshot()).0["calibrations"][0]["applied"], true);
    let part = Part { name: "another".into(), ..Part::ADIS16130 };
    let (frame, _) = read(&session.reopened(About { part, ..about() }).snapshot());
    assert_eq!(frame["calibrations"][0]["applied"], false);
    assert!(frame["notices"][0]["text"].as_str().unwrap().contains("no longer"), "{}", frame["notices"]);
}

fn says(session: &Session, code: &str) -> bool {
    let (all, _) = read(&session.snapshot());
    all["notices"].as_array().unwrap().iter().any(|notice| notice["code"] == code)
}

fn file_of(serial: &str, pbc_dps: f64) -> String {
    let correction = format!("[correction]\npbc_dps = {pbc_dps}\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n");
    format!("schema = 1\npart = \"ADIS16130\"\n{serial}{correction}")
}

fn of_part(serial: &str) -> About {
    About { info: CaptureInfo { serial: Some(serial.to_owned()), ..about().info }, ..about() }
}

#[test]
fn a_calibration_of_another_part_is_not_applied() {
    let mut session = Session::new(of_part("B2"));
    let foreign = session.add_calibration(&file_of("serial = \"A1\"\n", 0.5)).unwrap();
    let why = session.apply(Some(&foreign)).unwrap_err();
    assert!(why.contains("part B2") && why.contains("part A1"), "{why}");
    assert!(read(&session.snapshot()).0["calibrations"][0]["applied"] == false);
    let own = session.add_calibration(&file_of("serial = \"B2\"\n", 0.5)).unwrap();
    session.apply(Some(&own)).unwrap();
    assert!(says(&session, "no-checksum") && !says(&session, "unknown-serial"));
    let nameless = session.add_calibration(&file_of("", 0.5)).unwrap();
    session.apply(Some(&nameless)).unwrap();
    assert!(says(&session, "unknown-serial"));
    // the part that is opened now does not fit the calibration that was applied before
    session.apply(Some(&own)).unwrap();
    let mut other = session.reopened(of_part("A1"));
    assert!(says(&other, "not-applied") && !says(&other, "unknown-serial"));
    feed(&mut other, &mut Device::open("seed=3"), 2.0);
    let (all, _) = read(&other.snapshot());
    assert!(all["now"]["axes"][0]["corrected_dps"].is_null(), "{}", all["now"]);
    assert!(all["calibrations"].as_array().unwrap().iter().all(|one| one["applied"] == false));
    // a part without a serial number may be another part than the calibrated one
    let mut unknown = other.reopened(about());
    unknown.apply(Some(&own)).unwrap();
    assert!(says(&unknown, "unknown-serial"));
}

#[test]
fn a_calibration_begins_only_where_its_result_can_be_stored() {
    let mut session = Session::new(about());
    let ids: Vec<String> =
        (0..100).map(|k| session.add_calibration(&file_of("", f64::from(k) * 0.01)).unwrap()).collect();
    let begin = json!({ "id": 1, "do": "calibrate", "method": "warmup" });
    let refused = asked(&mut session, begin.clone());
    assert!(refused["error"].as_str().unwrap().contains("remove one"), "{refused}");
    session.apply(Some(&ids[7])).unwrap();
    let remove = |id: &str| json!({ "id": 2, "do": "remove-calibration", "calibration": id });
    assert!(asked(&mut session, remove(&ids[7]))["error"].as_str().unwrap().contains("applied"));
    assert_eq!(asked(&mut session, remove(&ids[8])), json!({ "id": 2, "ok": {} }));
    assert!(asked(&mut session, remove(&ids[8]))["error"].as_str().unwrap().contains("no calibration"));
    assert_eq!(session.calibrations().count(), 99);
    assert_eq!(session.ask(&begin.to_string()), RequestResult::Host { id: 1, command: HostCommand::Reopen });
    assert!(session.add_calibration(&file_of("", 2.0)).is_err(), "the last place is that of the result");
    assert_eq!(asked(&mut session, json!({ "id": 3, "do": "abort-calibration" }))["ok"], json!({}));
    session.add_calibration(&file_of("", 2.0)).unwrap();
}

#[test]
fn missed_samples_restart_what_is_computed() {
    let mut session = calibrating(json!({ "id": 1, "do": "calibrate", "method": "an1042" }));
    let mut device = Device::open("seed=4");
    feed(&mut session, &mut device, 10.0);
    let statistics_s = |session: &mut Session| {
        session.frame();
        number(&read(&session.snapshot()).0["statistics"][0]["duration_s"])
    };
    assert!(statistics_s(&mut session) > 9.0);
    for _ in 0..1000 {
        device.next();
    }
    session.missed(1000);
    feed(&mut session, &mut device, 3.0);
    let seen_s = statistics_s(&mut session);
    assert!((1.0..3.3).contains(&seen_s), "{seen_s}");
    let (all, _) = read(&session.snapshot());
    assert_eq!((&all["calibration"]["is"], &all["ledger"]["missed"]), (&json!("aborted"), &json!(1000)));
    assert!(all["calibration"]["text"].as_str().unwrap().starts_with("1000 samples"), "{}", all["calibration"]);
    assert!(says(&session, "samples-missed"));
}
