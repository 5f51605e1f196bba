//! Calibrations from a recording give the same numbers as from the part itself, bit for bit.

use super::bench::{Folder, calibrate, has, keep, only, open, record, replay, short};
use std::path::Path;
use zerorate::calibration::Notes;
use zerorate::{Method, Plan};
use zerorate_host::Sampling;
use zerorate_jobs::calibrate::{OutputOptions, settle_s};

fn logged(log: &Path) -> OutputOptions {
    let notes = Notes { supply: Some("bench 3".to_owned()), ..Notes::default() };
    OutputOptions { log: Some(log.to_owned()), serial: Some("SN-42".to_owned()), notes, ..OutputOptions::default() }
}

/// A method without steps uses the whole recording, whatever its length. The recording states the Earth's rotation
/// that the user gave for it.
#[test]
fn a_recording_gives_the_same_calibration_byte_for_byte() {
    let whole = Plan { settle_s: settle_s(Method::Warmup, true), max_u_btc_dps_per_c: 0.2, ..Plan::default() };
    for (device, plan, again) in [
        ("twin:seed=5", Plan { earth_dps: Some(0.0031), ..short() }, short()),
        (
            "twin:seed=5,curvature=0.004,warmup_s=40",
            Plan { method: Method::Warmup, ..short() },
            Plan { method: Method::Warmup, ..whole },
        ),
    ] {
        let folder = Folder::new();
        let log = folder.path("log.arrows");
        let live = keep(device, plan, logged(&log)).unwrap().calibration.to_toml();
        assert_eq!(calibrate(&replay(&log), again).unwrap().calibration.to_toml(), live);
        assert!(live.contains("serial = \"SN-42\"") && live.contains("supply_note = \"bench 3\""), "{live}");
        if plan.method == Method::Warmup {
            for part in ["schema = 3", "method = \"warmup\"", "btc2_dps_per_c2", "[curve]", "covariance"] {
                assert!(live.contains(part), "{part} in {live}");
            }
        }
    }
}

/// A calibration from the recording leaves out the same faulty readings, because the recording holds the raw codes.
#[test]
fn a_calibration_over_a_bad_line_is_repeated_from_its_log() {
    let folder = Folder::new();
    let log = folder.path("log.arrows");
    let live = keep("twin:seed=5,bit_error_rate=0.000002,fault_at_s=0.5", short(), logged(&log)).unwrap();
    assert!(only(&live).impossible_readings > 0 && has(&live.report.warnings, "impossible-readings"));
    let again = calibrate(&replay(&log), short()).unwrap();
    assert_eq!(again.calibration.to_toml(), live.calibration.to_toml());
    assert_eq!(only(&again).impossible_readings, only(&live).impossible_readings);
}

/// A part of three simulated axes: each bias is found within its uncertainty, and the recording gives the same
/// numbers.
#[test]
fn a_part_with_three_axes_is_calibrated_in_one_go() {
    let folder = Folder::new();
    let log = folder.path("log.arrows");
    let plan = Plan { assume_linear: true, ..short() };
    let live = keep("twin:seed=11,axes=3,warmup_s=20,curvature=0,hysteresis=0", plan, logged(&log)).unwrap();
    let axes = &live.report.axes;
    assert_eq!(axes.iter().map(|axis| axis.name.as_str()).collect::<String>(), "xyz");
    for found in axes.iter().map(|axis| &axis.numbers) {
        let truth = found.truth.as_ref().unwrap();
        let pbc = (found.pbc_dps - truth.pbc_dps) / found.u_pbc_dps;
        let btc = (found.btc_dps_per_c - truth.btc_dps_per_c) / found.u_btc_dps_per_c;
        assert!(pbc.abs() < 4.0 && btc.abs() < 4.0, "{pbc} u, {btc} u: {found:?}");
    }
    assert!((axes[0].numbers.pbc_dps - axes[2].numbers.pbc_dps).abs() > 0.01);
    let again = calibrate(&replay(&log), plan).unwrap().calibration;
    assert_eq!(again.axes.len(), 3);
    for (again, live) in again.axes.iter().zip(&live.calibration.axes) {
        assert_eq!((again.correction, again.measured), (live.correction, live.measured));
    }
}

#[test]
fn a_recording_of_another_part_is_refused() {
    let folder = Folder::new();
    let log = folder.path("log.arrows");
    keep("twin:", short(), logged(&log)).unwrap();
    let kept = OutputOptions { serial: Some("SN7".to_owned()), ..OutputOptions::default() };
    let why = keep(&replay(&log), short(), kept).err().unwrap().to_string();
    assert!(why.contains("the recording is of part SN-42, not of part SN7"), "{why}");
    assert!(open(&replay(&log)).check_serial(Some("SN-42")).is_ok());
}

#[test]
fn a_recording_that_is_too_short_says_what_to_give() {
    let folder = Folder::new();
    let log = folder.path("log.arrows");
    record("twin:", Sampling::default(), 3.0, &log);
    let (warmup_s, settle_s) = (0.0, 0.0);
    for plan in [Plan::default(), Plan { average_s: 2.0, warmup_s, settle_s, offset_s: 1.0, ..Plan::default() }] {
        let why = calibrate(&replay(&log), plan).err().unwrap().to_string();
        assert!(why.contains("the recording ends after 3s") && why.contains("average_s"), "{why}");
    }
}
