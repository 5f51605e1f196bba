//! Bags for robots: the capture in them is whole, and what robots read is the same rate.

use super::{Bench, calibration};
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};

fn json(bench: &Bench, line: &str) -> Value {
    serde_json::from_str(&bench.zerorate(line).ok()).expect("one object")
}

fn verdict(bench: &Bench, file: &str) -> Value {
    bench.zerorate(&format!("verify {file} --json")).json()["files"][0].clone()
}

#[test]
fn a_bag_is_a_capture() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=3 --samples 20000 -o unit.arrows").ok();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    bench.zerorate("capture --device replay:unit.arrows --samples 20000 --cal unit.toml -o unit.mcap").ok();
    let (stream, bag) = (verdict(&bench, "unit.arrows"), verdict(&bench, "unit.mcap"));
    assert_eq!((&bag["whole"], &bag["checked"], &bag["form"]), (&true.into(), &true.into(), &"MCAP".into()), "{bag}");
    assert_eq!(bag["samples_sha256"], stream["samples_sha256"], "no code changed");
    // its rows are raw, and are corrected once, as in any capture
    for form in ["arrows", "mcap"] {
        bench.zerorate(&format!("correct unit.{form} --cal unit.toml -o {form}.csv")).ok();
    }
    let rows = |name: &str| {
        let text = fs::read_to_string(bench.path(name)).expect("written");
        text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(rows("arrows.csv") == rows("mcap.csv"));
    let refused = bench.zerorate("correct unit.arrows --cal unit.toml -o corrected.mcap").fails(1);
    assert!(refused.contains("capture --device replay:CAPTURE --cal FILE"), "{refused}");
    let usage = bench.zerorate("capture --device twin: --samples 10 --cal unit.toml -o x.arrows").fails(2);
    assert!(usage.contains("--format mcap"), "{usage}");
}

#[test]
fn a_temperature_beyond_the_calibration_is_said() {
    let bench = Bench::new();
    for (low_c, is_said) in [(20, false), (40, true)] {
        let validity = format!("[validity]\ntemp_min_c = {low_c}.0\ntemp_max_c = 50.0\n");
        bench.write("unit.toml", calibration(-0.25, -0.04, 45.0) + &validity);
        let run = bench.zerorate("capture --samples 2000 --cal unit.toml -o unit.mcap --force");
        assert_eq!((run.code, run.stderr.contains("extrapolated: ")), (Some(0), is_said), "{}", run.stderr);
    }
}

/// The codes, and what robots read of them, have the same Allan deviation: rad/s in between.
#[test]
fn robots_read_the_same_rate() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=4 --samples 30000 -o unit.mcap").ok();
    let codes = json(&bench, "allan unit.mcap --json");
    let rates = json(&bench, "allan unit.mcap --topic /imu/data_raw --column angular_velocity.z --json");
    let (codes, rates) = (codes["points"].as_array().expect("points"), rates["points"].as_array().expect("points"));
    assert_eq!((codes.len(), rates.len()), (codes.len(), codes.len()));
    for (code, rate) in codes.iter().zip(rates) {
        let [code, rate] = [code, rate].map(|point| point["dev"].as_f64().expect("a number"));
        assert!((code / rate - 1.0).abs() < 1e-6, "{code} {rate}");
    }
    bench.zerorate("capture --device twin:seed=4,axes=3 --samples 60000 -o imu.mcap").ok();
    let report = json(&bench, "imu imu.mcap -o imu.yaml --accept-rejected --json");
    assert_eq!(report["axes"].as_array().expect("axes").len(), 3, "{report}");
}

#[test]
fn a_torn_bag_is_read_up_to_its_last_block() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=5 --samples 20000 -o unit.mcap").ok();
    let whole = fs::read(bench.path("unit.mcap")).expect("written");
    bench.write("torn.mcap", &whole[..whole.len() * 2 / 3]);
    let torn = verdict(&bench, "torn.mcap");
    assert_eq!((&torn["torn"], &torn["damage"]), (&true.into(), &Value::Null), "{torn}");
    let kept = bench.zerorate("repair torn.mcap -o kept.arrows").ok();
    assert!(kept.contains("rows kept; missing: "), "{kept}");
    assert_eq!(verdict(&bench, "kept.arrows")["rows"], torn["rows"], "{torn}");
    let usage = bench.zerorate("repair torn.mcap -o kept.mcap").fails(2);
    assert!(usage.contains("capture --device replay:"), "{usage}");
    let mut flipped = whole.clone();
    // in the first chunk
    flipped[whole.len() / 20] ^= 1;
    bench.write("flipped.mcap", flipped);
    let damaged = verdict(&bench, "flipped.mcap");
    assert_eq!((&damaged["whole"], &damaged["torn"]), (&false.into(), &false.into()), "{damaged}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let bench = Bench::new();
    let run = bench.zerorate("capture --device twin: --samples 20000 --format mcap -o /dev/full");
    assert!(run.fails(1).contains("No space left"));
}

#[cfg(unix)]
#[test]
fn interrupted_it_is_whole() {
    let bench = Bench::new();
    let mut capture = bench.command("capture --device twin: --realtime -o live.mcap");
    let mut capture = capture.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    while fs::metadata(bench.path("live.mcap")).map_or(0, |file| file.len()) < 100_000 {
        assert!(capture.try_wait().expect("a child").is_none(), "it goes on");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let sent = Command::new("sh").args(["-c", &format!("kill -INT {}", capture.id())]).status().expect("sh");
    assert!(sent.success() && capture.wait().expect("it ends").success());
    let mut said = String::new();
    capture.stdout.take().expect("piped").read_to_string(&mut said).expect("text");
    assert!(said.contains("interrupted"), "{said}");
    assert_eq!(verdict(&bench, "live.mcap")["whole"], true);
}

/// A recording of a part that began at 2026-03-01 12:00:00 UTC, as a program of the first version wrote it.
#[cfg(unix)]
fn old_recording(bench: &Bench) -> Bag {
    bench.zerorate("capture --device twin:seed=3 --samples 6000 -o new.csv").ok();
    let text = fs::read_to_string(bench.path("new.csv")).expect("written");
    let table = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.to_owned() + "\n");
    let head = "# zerorate.capture_schema = 1\n# zerorate.created = 2026-03-01T12:00:00Z\n# zerorate.width_bits = 24\n\
        # zerorate.rate_conversion = 5\n# zerorate.temp_conversion = 5\n";
    bench.write("old.csv", head.to_owned() + &table.collect::<String>());
    let rows: Vec<u64> = text.lines().filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    let began_ns = 1_772_366_400_000_000_000; // date -d 2026-03-01T12:00:00Z +%s
    Bag { first_ns: began_ns, last_ns: began_ns + rows[rows.len() - 1] - rows[0], topic: "/imu/data_raw".to_owned() }
}

/// Times of the first and the last message of a bag, and under which name robots find the rate.
#[cfg(unix)]
#[derive(Debug, PartialEq)]
struct Bag {
    first_ns: u64,
    last_ns: u64,
    topic: String,
}

#[cfg(unix)]
impl Bag {
    /// By the specification of MCAP: the footer names the summary, among whose records are statistics and channels.
    fn read(bench: &Bench, name: &str) -> Self {
        let bytes = fs::read(bench.path(name)).expect("written");
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight"));
        let footer = bytes.len() - 8 - 20;
        let mut at = usize::try_from(number(footer)).expect("a place");
        let (mut times, mut topics) = (None, Vec::new());
        while at + 9 < footer {
            let (kind, content, length) = (bytes[at], at + 9, usize::try_from(number(at + 1)).expect("a length"));
            if kind == 0x0B {
                times = Some((number(content + 26), number(content + 34)));
            }
            if kind == 0x04 {
                topics.push(String::from_utf8_lossy(&bytes[content..content + length]).into_owned());
            }
            at = content + length;
        }
        let (first_ns, last_ns) = times.expect("statistics");
        let named = |topic: &str| topics.iter().any(|channel| channel.contains(topic));
        let topic = if named("/imu/data_raw") { "/imu/data_raw" } else { "/imu/data" };
        assert!(named(topic), "{topics:?}");
        Self { first_ns, last_ns, topic: topic.to_owned() }
    }
}

/// Every command that writes a bag stamps it with the time of day, as docs/formats/mcap.md promises.
#[cfg(unix)]
#[test]
fn bags_of_all_commands_have_the_time_of_day() {
    let bench = Bench::new();
    let expected = old_recording(&bench);
    bench.zerorate("capture --device replay:old.csv --duration 1h -o captured.mcap").ok();
    assert_eq!(Bag::read(&bench, "captured.mcap"), expected);
    // too short for a result; the log is whole all the same
    let refused = bench.zerorate("calibrate --device replay:old.csv --log logged.mcap");
    assert_ne!(refused.code, Some(0));
    assert_eq!(Bag::read(&bench, "logged.mcap"), expected);
}
