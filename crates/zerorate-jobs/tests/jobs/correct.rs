//! Correcting a capture: once, with the right calibration, and with its raw columns unchanged.

use super::bench::{Folder, calibration, cells, codes, corrected};
use std::path::PathBuf;
use zerorate::Validity;

/// 10 °/s at 26 °C, then a row without temperature, then −10 °/s at 25 °C (F-42).
const ROWS: &str = "1000000,1,8623488,8,8402701,0\n2000000,2,8388608,8,,0\n3000000,5,8153728,,8388608,1\n";
const LINE: [f64; 3] = [-0.25, -0.04, 24.0];
const FORMS: &[&str] = &["csv", "arrows"];

fn capture(folder: &Folder, name: &str, rows: &str) -> PathBuf {
    let head = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n\
        # zerorate.temp_conversion = 5\n# zerorate.serial = A1\nt_ns,edge_seq,rate_code,status,temp_code,lost\n";
    folder.write(name, format!("{head}{rows}"))
}

/// A linear correction (AN-1042) and a curve, each at 2 °C and 1 °C above T3.
#[test]
fn each_row_is_corrected_by_the_formula() {
    let curve = calibration(3, LINE, "btc2_dps_per_c2 = 0.01\nbtc3_dps_per_c3 = -0.001\n");
    let terms = ["# zerorate.btc2_dps_per_c2 = 0.01", "# zerorate.btc3_dps_per_c3 = -0.001"];
    for (calibration, at_26, at_25, entries) in [
        (calibration(1, LINE, ""), -0.25 - 0.08, -0.25 - 0.04, &[][..]),
        (curve, -0.25 - 0.08 + 0.04 - 0.008, -0.25 - 0.04 + 0.01 - 0.001, &terms[..]),
    ] {
        let folder = Folder::new();
        let rest = capture(&folder, "rest.csv", ROWS);
        corrected(&rest, &calibration, &folder.path("done.csv")).unwrap();
        let done = folder.text("done.csv");
        let head = "t_ns,edge_seq,rate_code,status,temp_code,lost,rate_dps,temp_c,rate_corrected_dps,flags\n";
        assert!(done.contains(head), "{done}");
        let rows = cells(&done);
        assert_eq!(rows.iter().map(|row| row[..6].join(",") + "\n").collect::<String>(), ROWS, "raw columns are kept");
        let expected = [[10.0, 26.0, 10.0 + at_26], [0.0, 26.0, at_26], [-10.0, 25.0, -10.0 + at_25]];
        assert_eq!(rows.len(), expected.len());
        for (row, expected) in rows.iter().zip(expected) {
            assert_eq!(row[9], "0", "{row:?}");
            let found: Vec<f64> = row[6..9].iter().map(|cell| cell.parse().unwrap()).collect();
            assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{row:?}");
        }
        let known = ["# zerorate.calibration_id = ", "# zerorate.serial = A1", "# zerorate.pbc_dps = -0.25"];
        for entry in known.iter().chain(["# zerorate.t3_c = 24"].iter()).chain(entries) {
            assert!(done.contains(entry), "{entry} is missing");
        }
    }
}

#[test]
fn a_bias_is_never_removed_twice() {
    let folder = Folder::new();
    let (rest, line) = (capture(&folder, "rest.csv", ROWS), calibration(1, LINE, ""));
    let refused = |name: &str, why: &str| {
        let error = corrected(&folder.path(name), &line, &folder.path("twice.csv")).unwrap_err();
        let error = format!("{error:#}");
        assert!(error.contains(why) && error.contains(name), "{error}");
        assert!(!folder.path("twice.csv").exists());
    };
    for form in FORMS {
        let once = format!("once.{form}");
        corrected(&rest, &line, &folder.path(&once)).unwrap();
        refused(&once, "corrected already");
    }
    let once = folder.text("once.csv");
    let without = |keys: &[&str]| -> String {
        let kept = once.lines().filter(|line| !keys.iter().any(|key| line.contains(key)));
        kept.map(|line| format!("{line}\n")).collect()
    };
    folder.write("unmarked.csv", without(&["calibration_id"]));
    refused("unmarked.csv", "not those that were recorded");
    // a corrected capture is recognised even if a converter dropped its id and all checks
    let old = without(&["calibration_id", "zerorate.check", "zerorate.ax", "zerorate.temp."]);
    folder.write("unmarked.csv", old.replace("capture_schema = 2", "capture_schema = 1"));
    refused("unmarked.csv", "corrected already");
}

#[test]
fn a_capture_that_is_wrong_leaves_nothing_behind() {
    let folder = Folder::new();
    let refused = |rows: &str, why: &str| {
        let capture = capture(&folder, "bad.csv", rows);
        let error = corrected(&capture, &calibration(1, LINE, ""), &folder.path("done.csv")).unwrap_err();
        assert!(format!("{error:#}").contains(why), "{error:#}");
        assert_eq!(folder.names(), ["bad.csv"]);
    };
    refused(&format!("{ROWS}4000,6,x,,,0\n"), "line 10, column rate_code: `x`");
    refused("1000,1,8623488,8,,0\n", "no temperature");
}

#[test]
fn temperatures_and_readings_that_cannot_be_corrected_are_warned_of() {
    let folder = Folder::new();
    let rest = capture(&folder, "rest.csv", "500,0,8388608,9,,0\n1000,1,8388608,9,8388608,0\n");
    let mut line = calibration(1, LINE, "");
    line.validity = Some(Validity { temp_min_c: 26.0, temp_max_c: 30.0, margin_c: 0.5 });
    let warnings = corrected(&rest, &line, &folder.path("done.csv")).unwrap();
    for code in ["extrapolated", "before-temperature", "out-of-range"] {
        assert!(codes(&warnings).contains(&code), "{code} in {:?}", codes(&warnings));
    }
    let done = folder.text("done.csv");
    assert!(done.contains("500,0,8388608,9,,0,0.0,,,2\n"), "uncorrected rows are empty, not zero: {done}");
}
