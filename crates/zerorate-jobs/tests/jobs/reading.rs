//! Reading a part: `probe`, recordings and streams, of a healthy part and of faulty ones.

use super::bench::{
    Folder, StreamLog, calibration, cells, codes, corrected, has, open, record, refusal, replay, sampled, streamed,
};
use std::path::Path;
use zerorate::calibration::Notes;
use zerorate::health::{Flags, Health};
use zerorate::{Calibration, Setting, Validity};
use zerorate_host::{Pace, Sampling, Setup, Stop};
use zerorate_imu::{AnalysisOptions, Record};
use zerorate_jobs::acquisition::Acquisition;
use zerorate_jobs::allan::{AllanOptions, Columns, allan};
use zerorate_jobs::capture::read_capture;
use zerorate_jobs::output::Outputs;
use zerorate_jobs::probe::{Findings, probe};
use zerorate_jobs::record::{Length, RecordOptions};
use zerorate_logs::ColumnOptions;
use zerorate_record::Format;
use zerorate_view::Seconds;

fn line() -> Calibration {
    calibration(1, [0.5, -0.04, 31.5], "")
}

fn divided(divider: u16) -> Sampling {
    Sampling { divider: Some(divider), every_temp: None }
}

fn probed(acquisition: Acquisition, self_test: Option<&str>) -> anyhow::Result<Findings> {
    probe(acquisition, Seconds(1.0), self_test, Setting::name, &mut |_| {})
}

fn found(device: &str) -> Findings {
    probed(open(device), None).unwrap()
}

fn analysed(capture: &Path) -> anyhow::Result<Vec<Record>> {
    let log = ColumnOptions { described: Some(zerorate_record::open_described), ..ColumnOptions::default() };
    let analysis = AnalysisOptions::default();
    allan(&[capture.to_owned()], &AllanOptions { columns: Columns::Single, log, temperature: None, analysis })
}

/// True if `value` differs from `expected` by less than this share.
fn near(value: f64, expected: f64, share: f64) -> bool {
    (value / expected - 1.0).abs() < share
}

#[test]
fn probe_measures_rate_noise_and_losses() {
    let found = found("twin:seed=9,mclk_hz=6000000");
    assert!(near(found.rate_hz, 5_692.6, 1e-4) && near(found.rdy_hz, 5_692.6, 1e-4), "F-31: {found:?}");
    assert!(near(found.only.as_ref().unwrap().white_dps_per_rt_hz.unwrap(), 0.0125, 0.25), "F-02: {found:?}");
    assert_eq!((found.revision, found.lost_samples, found.framing), (Some(0x24), 0, Some("byte")));
    assert!(found.warnings.is_empty() && found.self_test.is_none(), "{found:?}");
}

/// With `fw=9:5`, rate and temperature take 783 + 527 clock cycles (F-31). The twin's self-test adds 20 °/s.
#[test]
fn probe_tries_the_self_test_and_releases_it() {
    let found = probed(open("twin:seed=7,framing=command,width=16,fw=9:5"), Some("")).unwrap();
    assert_eq!((found.framing, found.lost_samples), (Some("command"), 0));
    assert!(near(found.rate_hz, 6e6 / 1310.0, 0.02) && found.warnings.is_empty(), "{found:?}");
    let tested = found.self_test.unwrap();
    assert!((tested.shift_dps - 20.0).abs() < 2.0 && tested.u_dps < 0.1, "{found:?}");
    assert!(found.only.as_ref().unwrap().rate_dps.abs() < 5.0, "the pin is released: {found:?}");
}

#[test]
fn each_form_of_data_ready_has_an_edge_without_losses() {
    for keys in ["rdy=inverted,edge=rising", "rdy=pulse,edge=rising", "rdy=level,edge=falling"] {
        let found = found(&format!("twin:{keys}"));
        assert!(found.lost_samples == 0 && found.warnings.is_empty(), "{keys}: {found:?}");
    }
    // these edges come 26 µs before new data (F-32), so each read returns the previous sample
    for keys in ["rdy=level,edge=rising", "rdy=pulse,edge=falling", "rdy=inverted"] {
        found(&format!("twin:{keys}"));
    }
}

#[test]
fn probe_says_what_is_wired_wrong() {
    for (fault, pin) in [("sdo_low", "pin 12"), ("rdy_lost", "pin 10"), ("unplug", "cable")] {
        let error = probed(open(&format!("twin:fault={fault}")), None).unwrap_err();
        assert!(format!("{error:#}").contains(pin), "{fault}: {error:#}");
    }
    for (keys, code) in [
        ("fault=frozen", "frozen"),
        ("fault=rdy_stutter", "data-ready-stutters"),
        ("rotation_dps=360", "out-of-range"),
    ] {
        let warnings = found(&format!("twin:{keys}")).warnings;
        assert!(has(&warnings, code) && !has(&warnings, "lost-samples"), "{keys}: {warnings:?}");
    }
}

/// At 100 samples a second, the resonance of 14.3 kHz (F-07) aliases to zero. A clock of 105.4 kHz gives this rate:
/// a sample takes 2 · 527 cycles.
#[test]
fn a_rate_that_folds_the_resonance_to_zero_is_warned_of() {
    let folder = Folder::new();
    let device = "twin:mclk_hz=105400";
    assert!(has(&found(device).warnings, "resonance"));
    let recorded = record(device, Sampling::default(), 5.0, &folder.path("slow.arrows")).warnings();
    assert!(codes(&recorded).contains(&"resonance"), "{recorded:?}");
    assert!(!has(&found("twin:mclk_hz=6000000").warnings, "resonance"));
}

/// The rate is f_conv/(N + 1), with f_conv = 2 · 5692.6 Hz (F-56). N is the divider, the line's counter, or their
/// product.
#[test]
fn a_divider_and_a_counter_lower_the_rate() {
    let folder = Folder::new();
    let file = folder.path("slow.csv");
    for (keys, divider, conversions) in [("", 50, 51.0), (",divided=50", 1, 51.0), (",divided=50", 3, 151.0)] {
        let device = format!("twin:mclk_hz=6000000{keys}");
        let mut recorded = record(&device, divided(divider), 3.0, &file);
        let tally = *recorded.tally();
        assert!(near(tally.rate_hz(), 2.0 * 5_692.6 / conversions, 0.005), "{keys} {divider}: {}", tally.rate_hz());
        assert_eq!(tally.lost, 0, "{keys} {divider}");
        assert!(codes(&recorded.warnings()).contains(&"aliased"), "{keys} {divider}");
    }
    assert!(folder.text("slow.csv").contains("# zerorate.divided = 50\n"));
    assert!(near(found(&replay(&file)).rate_hz, 2.0 * 5_692.6 / 151.0, 0.005));
}

/// A capacitor at ROA lowers the bandwidth (F-04), and a recording states this bandwidth.
#[test]
fn a_lower_bandwidth_does_not_alias() {
    let folder = Folder::new();
    let file = folder.path("slow.csv");
    assert!(has(&probed(sampled("twin:", divided(50)), None).unwrap().warnings, "aliased"));
    let mut recorded = record("twin:roa=10nf", divided(50), 2.0, &file);
    assert!(!codes(&recorded.warnings()).contains(&"aliased"));
    assert!(folder.text("slow.csv").contains("# zerorate.bandwidth_hz = 50\n"));
    assert!(!has(&found(&replay(&file)).warnings, "aliased"));
}

/// The correction at T is 0.5 °/s − 0.04 °/s/°C · (T − 31.5 °C), without and with higher terms (F-50).
#[test]
fn a_stream_is_corrected_row_by_row() {
    let unit = "twin:noise=0,bias_dps=0,tempco_dps_per_c=0,curvature=0,hysteresis=0,warmup_c=0";
    let curve = calibration(3, [0.5, -0.04, 31.5], "btc2_dps_per_c2 = 0.002\nbtc3_dps_per_c3 = -0.0001\n");
    for (calibration, [btc2, btc3]) in [(line(), [0.0, 0.0]), (curve, [0.002, -0.0001])] {
        let (StreamLog { rows, .. }, ended) = streamed(unit, &calibration, 1.0, 0.25);
        ended.unwrap();
        assert_eq!(rows.len(), 4, "{rows:?}");
        for row in &rows {
            let d = row.temp_c - 31.5;
            let expected = 0.5 - 0.04 * d + btc2 * d * d + btc3 * d * d * d;
            assert!((row.rates_dps[0].unwrap() - expected).abs() < 1e-4, "{row:?}");
            assert!((row.temp_c - 25.0).abs() < 0.01 && row.lost == 0 && row.flags == Flags::NONE, "{row:?}");
        }
    }
}

#[test]
fn a_stream_warns_once_outside_the_span_of_the_calibration() {
    let mut line = line();
    line.validity = Some(Validity { temp_min_c: 30.0, temp_max_c: 33.0, margin_c: 0.5 });
    let (streamed, ended) = streamed("twin:", &line, 1.0, 0.0);
    ended.unwrap();
    assert_eq!(codes(&streamed.warnings), ["extrapolated"]);
}

/// The flags of a corrected capture. A row has no corrected rate exactly if it has a flag of a faulty rate.
fn flags_of_corrected(folder: &Folder, capture: &Path, code: &str) -> Vec<u8> {
    let warnings = corrected(capture, &line(), &folder.path("done.csv")).unwrap();
    assert!(codes(&warnings).contains(&code), "{code} in {:?}", codes(&warnings));
    let text = folder.text("done.csv");
    let flags = cells(&text).into_iter().map(|row| {
        let flags: u8 = row[9].parse().unwrap();
        let is_bad = flags & !Flags::IMPOSSIBLE_TEMP.bits() > 0;
        assert_eq!(is_bad, row[8].is_empty(), "{row:?}");
        flags
    });
    flags.collect()
}

/// A frozen part is recorded to the end and then reported. A correction flags it; an analysis and a stream refuse it.
#[test]
fn a_frozen_part_is_never_trusted() {
    let folder = Folder::new();
    let (device, file) = ("twin:seed=3,fault=frozen,fault_at_s=2", folder.path("f.arrows"));
    let recorded = record(device, Sampling::default(), 4.0, &file);
    assert!(recorded.frozen_at_end().is_some() && recorded.tally().samples > 22_000, "nothing is lost");
    let flags = flags_of_corrected(&folder, &file, "frozen");
    let frozen = flags.iter().filter(|flags| **flags == Flags::FROZEN.bits()).count();
    assert!((10_500..11_500).contains(&frozen), "{frozen} of {} rows", flags.len());
    assert_eq!(read_capture(&file).unwrap().axes[0].flags, flags);
    let (streamed, ended) = streamed(device, &line(), 10.0, 0.1);
    assert_eq!(refusal(&ended.unwrap_err()), Some("frozen"));
    assert!(streamed.rows.len() < 25 && streamed.rows.last().unwrap().flags.has(Flags::FROZEN), "it ends soon after");
    assert_eq!(refusal(&analysed(&file).err().unwrap()), Some("frozen"));
}

/// The twin warns of its ambient temperature with its first sample, and the stop comes with the warning.
#[test]
fn only_a_recording_that_is_too_short_was_interrupted() {
    let folder = Folder::new();
    for (samples, interrupted) in [(1, false), (2, true)] {
        let stop = Stop::default();
        let asked = stop.clone();
        let device = "twin:ambient_c=100".parse().unwrap();
        let mut acquisition =
            Acquisition::open(&device, Setup::default(), Pace::Free, &stop, Box::new(move |_| asked.ask())).unwrap();
        let (output, length) = (folder.path("f.csv"), Length::Samples(samples));
        let options = RecordOptions { output, format: Format::Csv, length, serial: None, notes: Notes::default() };
        let (mut outputs, names) = (Outputs::new(true), Setting::name);
        let report = zerorate_jobs::record::record(&mut acquisition, &mut outputs, &options, names, &mut |_| {});
        let report = report.unwrap();
        assert_eq!((report.samples, report.interrupted), (1, interrupted));
    }
}

/// F-35: with CLAMP = 0 a code wraps at 357 °/s, and 360 °/s reads as −354 °/s.
#[test]
fn out_of_range_means_the_same_everywhere() {
    let folder = Folder::new();
    let (device, file) = ("twin:rotation_dps=360", folder.path("f.arrows"));
    let mut recorded = record(device, Sampling::default(), 0.2, &file);
    assert!(codes(&recorded.warnings()).contains(&"out-of-range"));
    let out_of_range = recorded.healths().map(Health::fault_counts).map(|counts| counts.out_of_range).sum::<u64>();
    assert_eq!(out_of_range, recorded.tally().samples);
    let flags = flags_of_corrected(&folder, &file, "out-of-range");
    assert!(flags.iter().all(|flags| *flags == Flags::OUT_OF_RANGE.bits()));
    let (streamed, ended) = streamed(device, &line(), 0.1, 0.0);
    ended.unwrap();
    assert_eq!(streamed.with(Flags::OUT_OF_RANGE), streamed.rows.len());
    assert!(
        streamed.rows.iter().all(|row| row.rates_dps == [None]) && codes(&streamed.warnings).contains(&"not-believed")
    );
}

#[test]
fn bit_errors_are_marked_and_named() {
    let folder = Folder::new();
    let (device, file) = ("twin:seed=4,bit_error_rate=0.00002,fault_at_s=0.5", folder.path("f.arrows"));
    let mut recorded = record(device, Sampling::default(), 20.0, &file);
    assert!(codes(&recorded.warnings()).contains(&"impossible-readings"));
    let impossible = recorded.healths().map(Health::fault_counts).map(|counts| counts.impossible).sum::<u64>();
    assert!(impossible > 5, "{impossible}");
    let flags = flags_of_corrected(&folder, &file, "impossible-readings");
    let flagged = flags.iter().filter(|flags| *flags & Flags::IMPOSSIBLE.bits() > 0).count() as u64;
    assert_eq!(flagged, impossible, "the same judge over the capture");
    let text = folder.text("done.csv");
    let believed = cells(&text).into_iter().filter(|row| !row[8].is_empty());
    assert!(believed.map(|row| row[6].parse::<f64>().unwrap().abs()).all(|rate_dps| rate_dps < 7.0));
    let (streamed, ended) = streamed(device, &line(), 20.0, 0.0);
    ended.unwrap();
    assert_eq!(streamed.with(Flags::IMPOSSIBLE) as u64, impossible, "and over the live part");
    let records = analysed(&file).unwrap();
    let analysis = &records[0].analysis;
    assert!(analysis.missing as u64 >= impossible && analysis.points[0].dev < 0.3, "gaps, not values");
}
