//! `verify` and `repair` on complete, torn, damaged and joined files.

use super::{Bench, FORMS, calibration};
use serde_json::Value;
use std::fs;

/// A capture of 20 000 samples in each form.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=3 --samples 20000 --serial SN1 -o unit.arrows").ok();
    for form in FORMS.iter().filter(|form| **form != "arrows") {
        bench.zerorate(&format!("capture --device replay:unit.arrows --samples 20000 -o unit.{form}")).ok();
    }
    bench
}

/// The exit code and the JSON of `verify` for one file.
fn verdict(bench: &Bench, file: &str) -> (Option<i32>, Value) {
    let run = bench.zerorate(&format!("verify {file} --json"));
    let report: Value = run.json();
    (run.code, report["files"][0].clone())
}

#[test]
fn whole_files_in_every_form_have_one_hash() {
    let bench = bench();
    let mut hashes = Vec::new();
    for form in FORMS {
        let (code, verdict) = verdict(&bench, &format!("unit.{form}"));
        assert_eq!((code, &verdict["whole"], &verdict["checked"]), (Some(0), &true.into(), &true.into()), "{verdict}");
        assert_eq!(
            (&verdict["rows"], &verdict["schema"], &verdict["torn"]),
            (&20_000.into(), &2.into(), &false.into())
        );
        assert_eq!((&verdict["part"], &verdict["serial"]), (&"ADIS16130".into(), &"SN1".into()), "{verdict}");
        assert_eq!(verdict["simulated"], true, "{verdict}");
        hashes.push(verdict["samples_sha256"].as_str().unwrap().to_owned());
    }
    assert!(hashes.iter().all(|hash| hash.len() == 64 && *hash == hashes[0]), "{hashes:?}");
    let files: Vec<String> = FORMS.iter().map(|form| format!("unit.{form}")).collect();
    let text = bench.zerorate(&format!("verify {}", files.join(" "))).ok();
    assert!(text.contains("unit.csv: whole, CSV, version 2, 20000 rows") && text.contains(&hashes[0]), "{text}");
}

#[cfg(unix)]
#[test]
fn a_running_recording_is_not_called_torn() {
    let bench = bench();
    let whole = fs::read(bench.path("unit.arrows")).unwrap();
    bench.write("now.arrows", &whole[..whole.len() / 2]);
    let recording = fs::File::open(bench.path("now.arrows")).unwrap();
    recording.lock().unwrap();
    let said = bench.zerorate("verify now.arrows").ended_with(1).stdout;
    assert!(said.contains("BEING RECORDED") && said.contains("has ended") && !said.contains("repair"), "{said}");
    bench.write("now.parquet", "");
    let empty = fs::File::open(bench.path("now.parquet")).unwrap();
    empty.lock().unwrap();
    assert!(bench.zerorate("verify now.parquet").ended_with(1).stdout.contains("BEING RECORDED"));
    drop(recording);
    assert!(bench.zerorate("verify now.arrows").stdout.contains("TORN"));
}

#[test]
fn torn_and_damaged_files_are_told_apart() {
    let bench = bench();
    let whole = fs::read(bench.path("unit.arrows")).unwrap();
    bench.write("torn.arrows", &whole[..whole.len() / 2]);
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    bench.write("flipped.arrows", flipped);
    let (code, torn) = verdict(&bench, "torn.arrows");
    assert_eq!((code, &torn["torn"], &torn["damage"]), (Some(1), &true.into(), &Value::Null), "{torn}");
    let (code, damaged) = verdict(&bench, "flipped.arrows");
    assert_eq!((code, &damaged["torn"]), (Some(1), &false.into()), "{damaged}");
    assert!(damaged["damage"].as_str().unwrap().contains("its check differs"), "{damaged}");
    let run = bench.zerorate("verify unit.arrows torn.arrows flipped.arrows absent.arrows");
    let text = run.saying(&["3 of 4 files not whole"]).stdout;
    for state in ["unit.arrows: whole", "torn.arrows: TORN", "flipped.arrows: DAMAGED", "absent.arrows: NOT READ"] {
        assert!(text.contains(state), "{state} in\n{text}");
    }
}

/// Advice to repair a file works: `repair` keeps as many rows as stated, that is, every block before the damage.
#[test]
fn advice_to_repair_can_be_followed() {
    let bench = bench();
    let of = |name: &str| fs::read(bench.path(name)).unwrap();
    let flipped = |name: &str, at: usize| {
        let mut bytes = of(name);
        bytes[at] ^= 1;
        bytes
    };
    let half = |name: &str| of(name).len() / 2;
    // damaged files, each with the least number of rows that must be kept
    let files = [
        ("torn.arrows", of("unit.arrows")[..half("unit.arrows")].to_vec(), 5_000),
        ("flipped.arrows", flipped("unit.arrows", half("unit.arrows")), 5_000),
        ("head.arrows", flipped("unit.arrows", 200), 0),
        #[cfg(feature = "parquet")]
        ("unclosed.parquet", of("unit.parquet")[..half("unit.parquet")].to_vec(), 0),
        #[cfg(feature = "parquet")]
        ("flipped.parquet", flipped("unit.parquet", half("unit.parquet")), 0),
        ("torn.csv", of("unit.csv")[..half("unit.csv")].to_vec(), 5_000),
        ("bad.toml", b"[correction]\npbc_dps = x\n".to_vec(), 0),
    ];
    for (name, bytes, rows) in files {
        bench.write(name, &bytes);
        let (code, verdict) = verdict(&bench, name);
        let remedy = verdict["remedy"].as_str().unwrap_or_default();
        assert_eq!((code, remedy.contains("repair")), (Some(1), rows > 0), "{name}: {verdict}");
        let said = bench.zerorate(&format!("verify {name}"));
        assert!(said.stdout.contains(remedy) && !remedy.is_empty(), "{name}: {}", said.stdout);
        assert!(!said.stderr.contains("repair"), "{name}: {}", said.stderr);
        let repaired = bench.zerorate(&format!("repair {name} -o {name}.whole.csv"));
        if rows == 0 {
            assert_eq!(repaired.code, Some(1), "{name} can be repaired: {}", repaired.stdout);
            continue;
        }
        let said = repaired.ok();
        let kept: u64 = said.split(' ').nth(1).unwrap().parse().unwrap();
        assert!(kept >= rows && remedy.contains(&format!("keeps the {kept} rows")), "{name}: {kept} and {remedy}");
        assert!(said.contains("rows kept; missing: ") && of(name) == bytes, "the input is not touched: {said}");
        assert_eq!(self::verdict(&bench, &format!("{name}.whole.csv")).0, Some(0), "{name}");
        let (saved, all) = (samples(&bench, &format!("{name}.whole.csv")), samples(&bench, "unit.csv"));
        assert!(saved.len() as u64 == kept + 1 && all.starts_with(&saved), "{name}: {} of {} rows", kept, all.len());
    }
    assert_eq!(bench.zerorate("repair torn.arrows -o torn.arrows --force").code, Some(2));
}

/// The header and the rows of a CSV capture.
fn samples(bench: &Bench, file: &str) -> Vec<String> {
    let text = bench.text(file);
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

/// A second capture was appended, as `cat` does. The file counts as damaged, and the message says `joined`.
#[test]
fn captures_that_were_joined_are_not_whole() {
    let bench = bench();
    for form in FORMS {
        let whole = fs::read(bench.path(&format!("unit.{form}"))).unwrap();
        let (file, bytes) = (bench.write(&format!("two.{form}"), [&whole[..], &whole].concat()), whole.len());
        let (code, verdict) = verdict(&bench, &format!("two.{form}"));
        assert_eq!((code, &verdict["whole"], &verdict["checked"]), (Some(1), &false.into(), &false.into()));
        let damage = verdict["damage"].as_str().unwrap();
        assert!(damage.contains(&format!("{bytes} bytes")) && damage.contains("joined"), "{damage}");
        let said = bench.zerorate(&format!("repair two.{form} -o saved-{form}.csv"));
        match *form {
            // the second file's index states positions from the start of that file, so it is wrong in the joined file
            "parquet" => drop(said.fails(1, &["another one follows after its first"])),
            _ => {
                let text = said.ok();
                let count = format!("{bytes} bytes");
                assert!(text.contains("20000 rows kept; missing: ") && text.contains(&count), "{text}");
            }
        }
        let allan = bench.zerorate(&format!("allan two.{form}"));
        let is_said = allan.code == Some(1) || allan.stderr.contains("warning: bytes-behind-end: ");
        assert!(is_said && allan.stderr.contains("joined"), "{}", allan.stderr);
        // zeros that a file system appended are not an error
        if *form == "arrows" {
            fs::write(file, [&whole[..], &[0; 4096]].concat()).unwrap();
            bench.zerorate("verify two.arrows").ok();
        }
    }
}

#[test]
fn corrected_captures_and_calibrations_are_verified() {
    let bench = bench();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    for form in FORMS {
        bench.zerorate(&format!("correct unit.arrows --cal unit.toml -o done.{form}")).ok();
        let (code, verdict) = verdict(&bench, &format!("done.{form}"));
        assert_eq!((code, &verdict["checked"]), (Some(0), &true.into()), "{verdict}");
    }
    let text = bench.text("done.csv");
    let row = text.lines().find(|line| line.starts_with(|c: char| c.is_ascii_digit())).unwrap();
    let edited = row.rsplit_once(',').map(|(raw, _)| format!("{raw},0.5")).unwrap();
    bench.write("edited.csv", text.replace(row, &edited));
    assert_eq!(verdict(&bench, "edited.csv").0, Some(1), "a derived cell was changed");
    let (code, by_hand) = verdict(&bench, "unit.toml");
    assert_eq!((code, &by_hand["checked"], &by_hand["form"]), (Some(0), &false.into(), &"calibration".into()));
    bench.write("cut.toml", "# A zerorate calibration (docs/formats/calibration.md).\nschema = 4\n");
    let (code, cut) = verdict(&bench, "cut.toml");
    assert_eq!((code, &cut["form"]), (Some(1), &"calibration".into()), "its head says what it is: {cut}");
    bench.write("log.csv", "t_s,gz_dps\n0,1\n1,2\n");
    bench.write("noise.bin", [0x5a; 100]);
    let text = bench.zerorate("verify log.csv noise.bin").ended_with(1).stdout;
    for said in [
        "log.csv: NOT A CAPTURE\n",
        "a CSV of other software, which has no check lines, so it cannot be verified",
        "`zerorate allan` reads other logs",
        "noise.bin: NOT A CAPTURE\n",
        "it is not a calibration file either",
    ] {
        assert!(text.contains(said), "{said} in\n{text}");
    }
    for line in ["stream --cal log.csv", "report log.csv", "export log.csv --format c", "stream --cal unit.arrows"] {
        bench.zerorate(line).fails(1, &[" is not a calibration file: give the TOML file"]);
    }
}
