//! Plans of chambers, from a plan file or from a chamber's log.

use super::bench::Folder;
use std::path::Path;
use zerorate::Setting;
use zerorate_jobs::InvalidOptions;
use zerorate_jobs::chamber::PlanFile;
use zerorate_jobs::output::Outputs;

fn read(path: &Path, of_recording: bool) -> anyhow::Result<PlanFile> {
    PlanFile::read(path, of_recording, &mut Outputs::new(false), Setting::name)
}

#[test]
fn the_log_of_a_chamber_is_a_plan_for_a_recording() {
    let folder = Folder::new();
    let at = |s: f64| format!("{s},{}\n", 25.0 + ((s - 300.0) / 6.0).clamp(0.0, 20.0));
    let rows: String = (0..=72).map(|k| at(f64::from(k) * 10.0)).collect();
    let did = folder.write("did.csv", format!("t_s,temp_c\n{rows}"));
    let plan = read(&did, true).unwrap().plan;
    assert_eq!(plan.span_c(), (25.0, 45.0));
    let why = read(&did, false).unwrap_err();
    assert!(why.is::<InvalidOptions>() && why.to_string().contains("is the plan of a recording only"), "{why}");
}

#[test]
fn a_broken_plan_is_refused_with_its_line() {
    let folder = Folder::new();
    let cases: [(&str, &[u8], &str); 9] = [
        ("did.csv", b"", "columns t_s and temp_c are needed; it has none"),
        ("did.csv", b"time,temp\n0,25\n", "columns t_s and temp_c are needed; it has time, temp"),
        ("did.csv", b"t_s,temp_c\n0,25\n10,x\n", "line 3: t_s and temp_c must be numbers"),
        ("did.csv", b"t_s,temp_c\n0,25\n10\n", "line 3: t_s and temp_c must be numbers"),
        ("did.csv", b"t_s,temp_c\n0,25\n", "it has fewer than two rows"),
        ("did.csv", b"t_s,temp_c\n10,25\n0,25\n", "row 2: its t_s is not after the one before"),
        ("did.csv", b"t_s,temp_c\n0,\xff\n", "is not a plan: it is not text in UTF-8"),
        (
            "unit.toml",
            b"# A zerorate calibration (docs\nchecksum = \"sha256:00\"\n",
            "unit.toml is not a plan: it is a calibration",
        ),
        ("bad.toml", b"schema = 1\n[[step]]\nto_c = 15\nramp = 2\n", "line 4, `ramp = 2`: unknown field"),
    ];
    for (name, text, why) in cases {
        let error = read(&folder.write(name, text), true).unwrap_err();
        assert!(error.is::<InvalidOptions>() && error.to_string().contains(why), "{error}");
    }
    let error = format!("{:#}", read(&folder.path("none.toml"), false).unwrap_err());
    assert!(error.contains("f57 and two-point come with the program"), "{error}");
}
