//! docs/codes.md explains every code that a warning or a refusal can have, and no other.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::calibration::FileWarning;
use zerorate::chamber::ChamberRefusal;
use zerorate::health::Flags;
use zerorate::temperature::curve::{CurveRefusal, CurveWarning};
use zerorate::{Deviation, Finding, Refusal, Setting, Tone, Warning, Wording};
use zerorate_allan::{AllanWarning, Cause, Misfit, MotionKind, Noise, PoolError, SettingName};
use zerorate_host::SourceWarning;
use zerorate_imu::{ImuWarning, Kind, Moment, Rejection, Rest};
use zerorate_input::InputWarning;
use zerorate_jobs::JobWarning;
use zerorate_jobs::codes;
use zerorate_jobs::pool::NoPool;
use zerorate_logs::{LogWarning, Names};
use zerorate_record::CaptureWarning;
use zerorate_view::SessionWarning;
use zerorate_view::export::ExportWarning;

#[test]
fn every_code_has_a_section_and_every_section_a_code() {
    let explained = |kinds: &[&str]| -> BTreeSet<String> {
        let is_of = |one: &codes::Explanation| one.says.split(" or ").any(|kind| kinds.contains(&kind));
        codes::all().filter(is_of).map(|one| one.code.to_owned()).collect()
    };
    assert_eq!(explained(&["warning", "remark"]), warnings());
    assert_eq!(explained(&["refusal"]), refusals());
}

fn warnings() -> BTreeSet<String> {
    let of_core = Warning::codes().chain(Deviation::codes()).chain(FileWarning::codes()).chain(CurveWarning::codes());
    let of_logs = AllanWarning::codes().chain(LogWarning::codes()).chain(ImuWarning::codes());
    let of_devices = InputWarning::codes()
        .into_iter()
        .chain(CaptureWarning::codes())
        .chain(SourceWarning::codes())
        .chain(ExportWarning::codes());
    let of_runs = JobWarning::codes().chain(SessionWarning::codes());
    of_core.chain(of_logs).chain(of_devices).chain(of_runs).map(str::to_owned).collect()
}

fn refusals() -> BTreeSet<String> {
    let doubts = [Rejection::NoModel(String::new()), Rejection::Rejected(0.5)].map(|doubt| doubt.code());
    let no_pool = NoPool::NoCommonModel(PoolError::NothingInCommon).code();
    let of_core =
        Refusal::codes().chain(Deviation::codes()).chain(ChamberRefusal::codes()).chain(CurveRefusal::codes());
    let of_enums = of_core.chain(doubts).chain(no_pool).map(str::to_owned);
    of_enums.chain(made_with(&["CodedRefusal::new(", "LogError::Refused("], &["moving", "times-uneven"])).collect()
}

/// A warning with its code has at most this many characters.
const MOST_CHARS: usize = 100;

/// Codes of warnings that quote an error or a line of a log, and may be longer.
const WITH_ERRORS: [&str; 4] = ["log-failed", "not-kept", "lines-broken", "chamber-left"];

#[test]
fn a_warning_is_one_short_line() {
    let lines = lines();
    let long = |line: &&String| line.chars().count() > MOST_CHARS || line.contains('\n');
    let may_be_long = |line: &&String| WITH_ERRORS.contains(&line.split(':').next().unwrap());
    let too_long: Vec<_> = lines.iter().filter(|line| !may_be_long(line)).filter(long).collect();
    assert!(too_long.is_empty(), "{too_long:#?}");
    let codes: BTreeSet<String> = lines.iter().map(|line| line.split(':').next().unwrap().to_owned()).collect();
    assert_eq!(codes, warnings(), "each warning has its line in the functions below");
}

/// The lines of all warnings, with names, numbers and errors as long as they typically are.
fn lines() -> Vec<String> {
    let file = FileWarning::NoChecksum;
    let mut lines = vec![format!("{}: {file}", file.code())];
    lines.extend(of_measurement().iter().map(|one| format!("{}: {}", one.code(), one.with(option))));
    lines.extend(of_noise().iter().map(|one| format!("{}: {one}{}", one.code(), options(one))));
    lines.extend(of_exports().iter().map(|one| format!("{}: {one}", one.code())));
    lines.extend(of_sessions().iter().map(|one| format!("{}: {one}", one.code())));
    lines.extend(of_jobs().into_iter().map(|one| one.coded(option).to_string()));
    lines.extend(of_logs().iter().chain(&of_samples()).map(LogWarning::coded));
    lines.extend(of_captures().iter().map(CaptureWarning::coded));
    lines.extend(of_sources().iter().map(SourceWarning::coded));
    lines.extend(of_imu().iter().map(ImuWarning::coded));
    lines.extend(of_curves().iter().map(CurveWarning::coded));
    lines
}

fn option(setting: Setting) -> SettingName {
    SettingName::text(match setting {
        Setting::Earth => "--earth-dps",
        Setting::AssumeLinear => "--assume-linear",
        Setting::Settle => "--settle",
        Setting::Offset => "--offset",
        Setting::Divider => "--divider",
        Setting::Target => "--target-dph",
        Setting::EveryTemp => "--every-temp",
        Setting::Edge => "edge=rising or edge=falling in --device",
        other => panic!("what is the option of {other:?}?"),
    })
}

/// The options that the command line and the Python package name at the end of a warning.
fn options(warning: &AllanWarning) -> &'static str {
    match warning {
        AllanWarning::FollowsTemperature { .. } => " (--detrend temp, --skip)",
        _ => "",
    }
}

fn of_curves() -> Vec<CurveWarning> {
    let unit = "m/s²";
    vec![
        CurveWarning::Unrelated,
        CurveWarning::CoarseThermometer { step_c: 0.25 },
        CurveWarning::StuckThermometer { stuck_s: 1234.0 },
        CurveWarning::Moved { from_s: 1234.0, to_s: 2345.0, times: 12 },
        CurveWarning::NoisyThermometer { smoothed_s: 603.0 },
        CurveWarning::LateThermometer { late_s: 20.0 },
        CurveWarning::LongLag { longest_s: 450.0 },
        CurveWarning::LagOrDraught { lag_s: 322.0 },
        CurveWarning::OneDirection,
        CurveWarning::StillFollowing { unsettled: 0.0123, unit },
        CurveWarning::Jumped { jumps: 12, largest: 0.0123, unit },
        CurveWarning::BeyondCubic { left: 0.0123, unit },
    ]
}

fn of_measurement() -> Vec<Warning> {
    let tone = Tone { hz: 14_300.0, tolerance_hz: 50.0, rms_dps: 0.085 };
    let found = |deviation| Warning::Found(Finding { deviation, pbc_dps: -0.0123, btc_dps_per_c: 0.0123 });
    vec![
        Warning::EarthIncluded,
        Warning::EarthSubtracted { earth_dps: 0.003_21 },
        Warning::TwinAtRest { earth_dps: -0.003_21 },
        Warning::Turning { rate_dps: -4.8139, typical_dps: 1.0 },
        Warning::CurvatureUnseen { u_dps_per_c: 0.002_34 },
        Warning::Drifting { drift_c: 0.123, shift_dps: -0.012_34, u_pbc_dps: 0.0045 },
        found(Deviation::Step { at_s: 2492.0, size_dps: -0.0384, supply_mv: Some(192.0) }),
        found(Deviation::Curvature { dps_per_c2: -0.001_23 }),
        found(Deviation::Lag { lag_s: 123.0 }),
        found(Deviation::Hysteresis { width_c: 12.3 }),
        found(Deviation::BaseMotion { hz: 0.000_35, size_dps: 0.0567 }),
        Warning::Restless,
        Warning::Flat { btc_dps_per_c: -0.0012, typical_dps_per_c: 0.04 },
        Warning::HourUnchecked,
        Warning::ShortAverage { average_s: 60.0, best_s: 300.0 },
        Warning::Aliased { rate_hz: 111.6, needed_hz: 600.0 },
        Warning::Lost { lost: 12_345, fraction: 0.001_234 },
        Warning::Wandering { floor_dps: 0.0123, typical_dps: 0.0016 },
        Warning::Impossible { count: 12_345, fraction: 0.001_234 },
        Warning::Resonance { tone, folded_hz: 12.3, rate_hz: 2846.3, divider: Some(57) },
        Warning::Resonance { tone, folded_hz: 12.3, rate_hz: 2846.3, divider: None },
        Warning::Extrapolated { low_c: -39.0, high_c: 84.0, temp_min_c: 25.0, temp_max_c: 31.0 },
        Warning::RestUnjudged,
        Warning::CurvatureUnknown,
        Warning::Noisy { ratio: 12.3 },
        Warning::Quiet { ratio: 0.05 },
        Warning::Losing { lost: 12_345 },
        Warning::RateOff { rate_hz: 2846.3, nominal_hz: 5692.6 },
        Warning::NoTemperature { wrong_edge: true },
        Warning::NoTemperature { wrong_edge: false },
        Warning::StepTaken { at_s: 2492.0, size_dps: -0.0384, u_dps: 0.0012 },
        Warning::BaseMotionRemoved { hz: 0.000_35, size_dps: 0.0567 },
        Warning::Late { lag_s: 123.0 },
        Warning::OneBranch { hysteresis_dps: Some(0.0123) },
        Warning::OneBranch { hysteresis_dps: None },
        Warning::TargetMissed { u_dps: 0.0034, target_dps: 0.0003 },
    ]
}

fn of_noise() -> Vec<AllanWarning> {
    let misfit = Misfit { from_hz: 12.345, to_hz: 23.456, ratio: 1.234, cause: Cause::Resonance };
    let noise = Noise::AngleRandomWalk;
    vec![
        AllanWarning::QuantisationLimited { q: 1.234e-6, below_s: 12.345 },
        AllanWarning::Drift { r: -1.234e-6, over_record: -1.234e-3 },
        AllanWarning::Glitches { glitches: 123, samples: 1234, ratio: 1.234 },
        AllanWarning::ManyGlitches { most: 0.01 },
        AllanWarning::Step { at_s: 12345.6, size: -1.234e-3 },
        AllanWarning::ManySteps { most: 3 },
        AllanWarning::Gaps { missing: 12345, samples: 12_345_678 },
        AllanWarning::Lines { count: 12, frequency_hz: 123.456, rms: 1.234e-3 },
        AllanWarning::WarmUp { size: -1.234e-3, tau_s: 1234.0 },
        AllanWarning::MemoryOrFlicker { markovs: 2, others: 1, worse: 1.2 },
        AllanWarning::MemoryOrFilter { tau_s: 12.345, n: 1.234e-3 },
        AllanWarning::DriftOrWalk { has_drift: true, worse: 1.2 },
        AllanWarning::PeriodOrWalk { period_s: 612.3, k: 1.234e-4 },
        AllanWarning::Unsteady { tau_s: 123.456, ratio: 0.81 },
        AllanWarning::ShortRecord { samples: 1234, needed: 2000 },
        AllanWarning::Leakage { frequency_hz: 123.456, share: 0.12 },
        AllanWarning::OffCurve { tau_s: 123.456, ratio: 1.23, octaves: 3 },
        AllanWarning::Rejected { error: 0.23, most: 0.1, misfit },
        AllanWarning::FollowsTemperature { explained: 0.93, slope: 1.234e-3, span_c: 12.3 },
        AllanWarning::NotIdentified { noise, record_s: 12345.0, needed_s: 612_345.0 },
        AllanWarning::NotIdentified { noise, record_s: 12345.0, needed_s: f64::INFINITY },
    ]
}

fn of_exports() -> Vec<ExportWarning> {
    let (temp_min_c, temp_max_c, wrong_dps) = (22.5, 40.5, 0.31);
    let short = |axis| ExportWarning::TableShort { axis, span_c: 0.12, temp_min_c, temp_max_c, wrong_dps };
    let unstated = ExportWarning::NoValidity { temp_min_c, temp_max_c, assumed_c: 9.0 };
    vec![unstated, short(None), short(Some("gyro_z".to_owned()))]
}

/// All kinds of session warnings except [`SessionWarning::OfCalibration`], which names a calibration before the
/// warning of its file.
fn of_sessions() -> Vec<SessionWarning> {
    let cal = || "calibration 1f2e3d4c".to_owned();
    let full = || "No space left on device (os error 28)".to_owned();
    let axes = || "the calibration is of ADIS16130, the part is a MEMS-3".to_owned();
    let wide = "gyro_z: cooling and warming lie ±0.00123 ± 0.00012 °/s about their mean; allow for it";
    let unknown = |cal: &str, name: &str, advice| {
        let [cal, calibrated, name] = [cal, "SN17", name].map(str::to_owned);
        SessionWarning::UnknownSerial { cal, calibrated, name, advice }
    };
    vec![
        SessionWarning::WideLoop(wide.to_owned()),
        SessionWarning::Damaged(1234),
        unknown(&cal(), "ADIS16130", "check its number"),
        unknown("unit.toml", "bridge:/dev/ttyACM0", "give --serial SN"),
        SessionWarning::NoSerial { cal: cal() },
        SessionWarning::Missed(12_345),
        SessionWarning::NotApplied(axes()),
        SessionWarning::LeftOut("calibrations/unit.toml: line 4: pbc_dps is not a number".to_owned()),
        SessionWarning::NoFolder,
        SessionWarning::NotKept { id: "1f2e3d4c".to_owned(), why: full() },
        SessionWarning::NotRemoved { id: "1f2e3d4c".to_owned(), why: "Permission denied (os error 13)".to_owned() },
        SessionWarning::NotRecorded(full()),
        SessionWarning::LibiioUnserved {
            address: ([127, 0, 0, 1], 30_431).into(),
            why: "Address already in use (os error 98)".to_owned(),
        },
        SessionWarning::LibiioUncorrected(axes()),
        SessionWarning::LibiioEnded("Too many open files (os error 24)".to_owned()),
        SessionWarning::NoPage,
    ]
}

fn of_jobs() -> Vec<JobWarning> {
    let full = || "unit.arrows: No space left on device (os error 28)".to_owned();
    vec![
        JobWarning::Overflowed(120_000),
        JobWarning::LogFailed { after_s: 1830.0, why: full() },
        JobWarning::BeforeTemperature(1200),
        JobWarning::TemperatureMissing(1200),
        JobWarning::TemperatureHeld(240.0),
        JobWarning::LagAtStart { for_s: 180.0, most_dps: 0.098 },
        JobWarning::LeftOut(Flags::IMPOSSIBLE),
        JobWarning::StateAgeUnknown,
        JobWarning::StateNotKept { why: full(), again_s: 60 },
        JobWarning::StepsNotKept(full()),
        JobWarning::LimitsUnknown,
        JobWarning::ChamberLeft("the chamber did not stop: it does not answer; switch it off".to_owned()),
        JobWarning::Resumed,
        JobWarning::SlowTurn { axis: "z".to_owned(), doubtful_s: 1200 },
    ]
}

fn of_logs() -> Vec<LogWarning> {
    let [path, column] = [|| "log.csv".to_owned(), || "gz_dps".to_owned()];
    let [unit, scale] = ["--unit", "--scale"].map(SettingName::text);
    let names = || "mag_x, mag_y, mag_z, temp_c".to_owned();
    let gaps = |are_closed| LogWarning::Gaps { path: path(), missing: 1200, among: 720_000, are_closed };
    vec![
        LogWarning::Miscounted { path: "run_0".to_owned(), topic: "/imu".to_owned(), stated: 12_000, found: 11_950 },
        LogWarning::RowsIncomplete { path: path(), lacking: 12, rows: 720_000 },
        LogWarning::OffCodes { path: path(), column: column(), by: 1.234e-4, unit: "°/s", codes: 0.52 },
        LogWarning::Stopped { path: path(), column: column(), same: 2000, len: 720_000 },
        LogWarning::Hung { path: path(), column: column(), same: 2000, len: 72_000, from_s: 15.0 },
        LogWarning::TimesRepaired {
            path: path(),
            column: "t_us".to_owned(),
            how: "12 rows come too late and are sorted (the first: row 3456)".to_owned(),
        },
        LogWarning::TimesJitter {
            path: path(),
            how: "stamps are off an even clock by 15 % of an interval; judge from 0.1234 s on".to_owned(),
        },
        LogWarning::TimeUnitTaken { path: path(), column: "timestamp".to_owned(), unit: "ns" },
        LogWarning::RateChanges {
            path: path(),
            how: "100.0 to 110.0 rows a second (100.0 at first, 110.0 at the end)".to_owned(),
        },
        LogWarning::LinesSkipped {
            path: path(),
            lines: 4,
            first: "ets Jun  8 2016 00:22:57, rst:0x1 (POWERON_RESET)".to_owned(),
        },
        LogWarning::ScaleUnused { path: path(), line: "gyro sensitivity,0.07".to_owned() },
        LogWarning::CodesUnsigned { path: path(), column: column(), bits: 16 },
        LogWarning::RateContradicts { path: path(), given_hz: 200.0, stamps_hz: 100.0 },
        LogWarning::LinesBroken("log.csv: 12 of 720000 lines are broken, and skipped; look at line 3456".to_owned()),
        LogWarning::Implausible { path: path(), what: "gravity is 1.003 m/s²".to_owned() },
        LogWarning::UnitUnknown { path: path(), column: "gz".to_owned(), unit, scale },
        LogWarning::ColumnsLeftOut { path: path(), names: names() },
        LogWarning::NoNumbers { path: path(), names: names() },
        LogWarning::BlanksLeftOut { path: path(), names: names() },
        LogWarning::ConstantsLeftOut { path: path(), names: names() },
        gaps(true),
        gaps(false),
        LogWarning::NotAlike(
            "a.csv, gz_dps has 1.23 times the N of the others: left out of the common model".to_owned(),
        ),
    ]
}

fn of_samples() -> [LogWarning; 6] {
    let [path, column] = [|| "log.csv".to_owned(), || "gz_dps".to_owned()];
    let assumed = "--gyro-range 250: 131.1 codes per °/s; lsm6ds3 and 5 more differ: give --part";
    [
        LogWarning::UnitsTaken { path: path(), what: "angular_velocity in rad/s, as in messages of ROS (REP-103)" },
        LogWarning::ScaleAssumed(assumed.to_owned()),
        LogWarning::RateTaken { path: path(), name: "imu.Fs".to_owned(), rate_hz: 200.0 },
        LogWarning::Resampled {
            path: path(),
            column: column(),
            how: "50 % of the samples lie on the line between neighbours; use the raw log".to_owned(),
        },
        LogWarning::Clipped {
            path: path(),
            column: column(),
            how: "0.50 % of the samples are -9999, the least; a limit, or a mark?".to_owned(),
        },
        LogWarning::CoarseCodes {
            path: path(),
            column: column(),
            how: "noise of 0.12 steps: N, B and K are of the rounding".to_owned(),
        },
    ]
}

fn of_captures() -> Vec<CaptureWarning> {
    let path = || "rest.arrows".to_owned();
    let frozen = zerorate::health::Frozen { since_ns: 1_830_500_000_000, both: true };
    vec![
        CaptureWarning::Frozen(zerorate_record::valid::frozen_text(&frozen, 0)),
        CaptureWarning::OutOfRange(1200),
        CaptureWarning::Unjudged { can_judge: true },
        CaptureWarning::Unjudged { can_judge: false },
        CaptureWarning::DataReadyStutters { silent_gaps: 120, gaps: 340 },
        CaptureWarning::ClockStands(120),
        CaptureWarning::ClockJump(1200),
        CaptureWarning::File(InputWarning::Torn(
            "rest.arrows was not closed; 1024 rows after its last whole block are dropped".to_owned(),
        )),
        CaptureWarning::File(InputWarning::BytesBehindEnd { path: path(), bytes: 123_456 }),
        CaptureWarning::Unchecked { path: path() },
        CaptureWarning::Rewritten { path: path() },
        CaptureWarning::EdgesMisplaced { path: path(), rows: 1200 },
    ]
}

fn of_sources() -> [SourceWarning; 3] {
    let part = "ADIS16130".to_owned();
    let beyond = SourceWarning::BeyondLimits { ambient_c: 150.0, part, low_c: -40.0, high_c: 85.0 };
    [SourceWarning::NoRealtimePriority, SourceWarning::MemoryNotLocked, beyond]
}

fn of_imu() -> [ImuWarning; 5] {
    let axes = || ["gx_dps", "gy_dps", "gz_dps"].map(str::to_owned).to_vec();
    let moment = |at, kind| Moment { at_s: 300.0 + f64::from(at), axes: axes(), kind };
    let together = |kind| (0..7).map(|at| moment(at, kind)).collect::<Vec<_>>();
    let jumps = together(MotionKind::Jump);
    let rest = Rest::between(&[(300.0, 306.0)], (0.0, 3600.0), Names::default());
    [
        ImuWarning::Moves(vec![(300.0, 306.0), (900.0, 960.0)], rest),
        ImuWarning::Jumps(jumps, rest),
        ImuWarning::Knocks(together(MotionKind::Knock)),
        ImuWarning::KindAbsent(Kind::Accelerometer, None),
        ImuWarning::KindAbsent(Kind::Accelerometer, Some(SettingName::text("--column"))),
    ]
}

#[test]
fn no_text_begins_with_a_code() {
    for (path, text) in sources() {
        let text = text.split("#[cfg(test)]").next().unwrap();
        for one in codes::all().filter(|one| one.code.contains('-') && one.code != TERM) {
            assert!(!text.contains(&format!("\"{}: ", one.code)), "{}: {} in a text", path.display(), one.code);
        }
    }
}

/// A code that is also the name of a term of a noise model.
const TERM: &str = "warm-up";

/// Returns the codes that stand in the source right after one of the texts `makers`. Fails unless the `known` codes
/// are among them.
fn made_with(makers: &[&str], known: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (path, text) in sources() {
        for (at, made) in makers.iter().flat_map(|maker| text.match_indices(maker)) {
            let argument = text[at + made.len()..].trim_start();
            let Some(literal) = argument.strip_prefix('"') else { continue };
            let (code, _) = literal.split_once('"').unwrap_or_else(|| panic!("{}", path.display()));
            found.insert(code.to_owned());
        }
    }
    assert!(known.iter().all(|code| found.contains(*code)), "the sources were not understood: {found:?}");
    found
}

fn sources() -> Vec<(PathBuf, String)> {
    let (mut found, mut folders) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        folders.push(entry.unwrap().path().join("src"));
    }
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    found
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
