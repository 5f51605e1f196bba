//! The noise of logs: columns, several records as one, and the axes of an IMU.

use super::bench::{Folder, record, refusal};
use super::white::white;
use std::path::{Path, PathBuf};
use zerorate_allan::{Fit, FitOptions, Stat};
use zerorate_host::Sampling;
use zerorate_imu::{AllanReport, AnalysisOptions, Detrending, Record};
use zerorate_imu::{Combine, Format, ImuOptions, Kind, NoiseFileOptions, Rule};
use zerorate_jobs::InvalidOptions;
use zerorate_jobs::allan::{AllanOptions, Columns, allan};
use zerorate_jobs::code_scales::CodeOptions;
use zerorate_jobs::imu::{ImuNoise, ImuNoiseOptions, imu};
use zerorate_jobs::pool::{NoPool, pool};
use zerorate_logs::{ColumnOptions, Cut, CutTime, LogWarning, Names, Setting};

fn fitted() -> AnalysisOptions {
    AnalysisOptions { fit: Some(FitOptions::default()), ..AnalysisOptions::default() }
}

fn options(log: ColumnOptions, analysis: AnalysisOptions) -> AllanOptions {
    AllanOptions { columns: Columns::Single, log, temperature: None, analysis }
}

fn of_captures() -> ColumnOptions {
    ColumnOptions { described: Some(zerorate_record::open_described), ..ColumnOptions::default() }
}

fn at(rate_hz: f64) -> ColumnOptions {
    ColumnOptions { rate: Some(rate_hz), ..ColumnOptions::default() }
}

/// A constant column is refused in any log. A column that stops gets a warning.
#[test]
fn a_constant_column_is_refused() {
    let folder = Folder::new();
    let analysed = |rate: &dyn Fn(u32) -> u32| {
        let rows: String = (0..5000).map(|k| format!("{}\n", rate(k))).collect();
        let log = folder.write("log.csv", format!("gz_dps\n{rows}"));
        allan(&[log], &options(at(100.0), AnalysisOptions::default()))
    };
    let noise = |k: u32| k.wrapping_mul(2_654_435_761) >> 20;
    let notes = |rate: &dyn Fn(u32) -> u32| {
        let records = analysed(rate).unwrap();
        records[0].notes.iter().map(LogWarning::coded).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(refusal(&analysed(&|_| 7).err().unwrap()), Some("frozen"));
    let said = notes(&|k| noise(k.min(3000)));
    assert!(said.contains("the last 2000 of 5000 samples"), "{said}");
    let said = notes(&|k| noise(if (1500..3500).contains(&k) { 1500 } else { k }));
    assert!(said.contains("2000 of 5000 samples of column gz_dps are the same, from 15.0 s on"), "{said}");
    assert!(!notes(&noise).contains("the same"));
}

/// A capture of 40 minutes from power-on, in which the part warms with time constants of 90 s and 600 s (M-03). The
/// part has a rate random walk K of 1e-4 °/s/√s (M-04).
#[test]
fn a_rate_that_follows_its_temperature_can_be_analysed() {
    let folder = Folder::new();
    let capture = folder.path("a.arrows");
    record("twin:seed=4", Sampling { divider: Some(200), every_temp: None }, 2400.0, &capture);
    let by = |detrending: Detrending| {
        let analysis = AnalysisOptions { detrending, ..fitted() };
        allan(std::slice::from_ref(&capture), &options(of_captures(), analysis)).unwrap().remove(0)
    };
    let follows = |record: &Record| record.of_noise().any(|warning| warning.code() == "follows-temperature");
    let whole = by(Detrending::default());
    assert!(follows(&whole) && whole.model().unwrap().k.lo > 1e-4, "what made the warning necessary");
    let mut detrended = by(Detrending { order: Some(1), ..Detrending::default() });
    let k = &detrended.model().unwrap().k;
    assert!(!follows(&detrended) && k.lo <= 1e-4 && k.hi >= 1e-4, "{k:?}");
    let taken = detrended.detrended.as_ref().unwrap();
    assert!(taken.lost_dof == 1 && taken.explained > 0.95, "{}", taken.explained);
    detrended.analysis.stat = Stat::Tdev;
    let report = AllanReport::new(&detrended);
    assert_eq!((report.unit, report.detrend.unwrap().unit), (Some("°"), Some("°/s")));
    let log = ColumnOptions { cut: Cut { from: Some(CutTime::SinceStart(1800.0)), until: None }, ..of_captures() };
    let skipped = allan(std::slice::from_ref(&capture), &options(log, fitted())).unwrap().remove(0);
    assert!((skipped.skipped_s - 1800.0).abs() < 0.01, "{}", skipped.skipped_s);
    assert!((skipped.analysis.samples as f64 / whole.analysis.samples as f64 - 0.25).abs() < 1e-3);
}

/// Records of white noise at 100 Hz: N is a tenth of the standard deviation.
fn records(sizes: &[(f64, u64)]) -> Vec<Record> {
    let folder = Folder::new();
    let logs: Vec<PathBuf> = sizes
        .iter()
        .map(|(sd, seed)| {
            let rate = white(60_000, *sd, *seed);
            let bytes: Vec<u8> = rate.iter().flat_map(|rate| rate.to_le_bytes()).collect();
            folder.write(&format!("{seed}.f64"), bytes)
        })
        .collect();
    let log = ColumnOptions { raw: "f64".parse().ok(), unit: "dps".parse().ok(), ..at(100.0) };
    allan(&logs, &options(log, AnalysisOptions { keeps_rate: true, ..fitted() })).unwrap()
}

#[test]
fn records_that_have_nothing_in_common_have_no_pool() {
    let mut all = records(&[(0.098, 3), (0.2, 9)]);
    let refused = pool(&all).err().unwrap();
    assert_eq!(refused.code(), Some("no-common-model"), "{refused}");
    let one = pool(&all[..1]).err().unwrap();
    assert!(matches!(one, NoPool::Unfit(_)) && one.code().is_none(), "{one}");
    let first = all[0].file.clone();
    all[1].file = first;
    assert!(matches!(pool(&all), Err(NoPool::Twice(_))));
    all[1].file = "another".into();
    all[1].quantity = None;
    assert!(matches!(pool(&all), Err(NoPool::Mixed(..))));
}

#[test]
fn a_pool_names_the_records_that_it_used() {
    let mut all = records(&[(0.1, 3), (0.1, 9), (0.1, 5)]);
    all[0].fit = None;
    assert_eq!(pool(&all).unwrap().used, [all[1].label(), all[2].label()]);
}

const RATE_HZ: f64 = 100.0;
/// Standard deviations of single samples: of three gyroscopes, °/s, and of three accelerometers, m/s².
const SIGMAS: [f64; 6] = [0.10, 0.12, 0.08, 0.020, 0.025, 0.030];
const HEAD: &str = "t_s,gx_dps,gy_dps,gz_dps,ax [m/s^2],ay [m/s^2],az [m/s^2],mag_x";

/// A CSV log with white noise of each axis. The z accelerometer also measures gravity.
fn log(head: &str, rows: usize) -> String {
    let axes: Vec<Vec<f64>> = (7..).zip(SIGMAS).map(|(seed, sigma)| white(rows, sigma, seed)).collect();
    let row = |k: usize| {
        let cells: Vec<String> = axes.iter().map(|axis| format!("{:.6}", axis[k])).collect();
        let [x, y, z, ax, ay, az] = &cells[..] else { panic!("six") };
        let az = az.parse::<f64>().unwrap() + 9.81;
        format!("{:.2},{x},{y},{z},{ax},{ay},{az:.6},{}\n", k as f64 / RATE_HZ, k % 7)
    };
    format!("{head}\n") + &(0..rows).map(row).collect::<String>()
}

fn of(log: &Path, axes: ImuOptions, format: Option<Format>) -> anyhow::Result<ImuNoise> {
    imu(log, &ImuNoiseOptions { axes, codes: CodeOptions::default(), temperature: None, analysis: fitted(), format })
}

/// Makes the noise file. Returns the N and K that it states for the gyroscope, as continuous densities, and its text.
fn in_file(format: Format, noise: &ImuNoise, rule: Rule, combine: Combine) -> (f64, f64, String) {
    let names = Names(Setting::name);
    let (log, warnings) = ("imu.csv".to_owned(), Vec::new());
    let choice = NoiseFileOptions { log, topic: None, combine, rule, inflate: 1.0, names, warnings };
    let doubts = Record::doubts(&noise.axes);
    let text = format.file(choice, &Record::axes(&noise.axes), &doubts, false).unwrap();
    let number = |key: &str| -> f64 {
        let line = text.lines().find_map(|line| line.trim_start().strip_prefix(key)).unwrap();
        line.trim_start_matches(':').split_whitespace().next().unwrap().parse().unwrap()
    };
    (number("gyroscope_noise_density"), number("gyroscope_random_walk"), text)
}

/// The rule `AsFitted` states the N and K of the fit: of the worst axis, or as a mean over the axes. For a K that is
/// not identified, it states the upper limit. The rule `Covers` may raise both, but Kalibr keeps the fitted N.
#[test]
fn n_and_k_of_an_imu_cover_its_noise_or_are_as_fitted() {
    let folder = Folder::new();
    let file = folder.write("imu.csv", log(HEAD, 20_000));
    let noise = of(&file, ImuOptions::default(), Some(Format::Kalibr)).unwrap();
    let kinds: Vec<Kind> = Record::axes(&noise.axes).iter().map(|axis| axis.kind).collect();
    assert_eq!(kinds, [[Kind::Gyroscope; 3], [Kind::Accelerometer; 3]].concat());
    assert!(noise.absent.is_empty() && noise.topic.is_none());
    let (n, k_limit, fitted) = in_file(Format::Kalibr, &noise, Rule::AsFitted, Combine::Worst);
    assert!((n / (0.12 / RATE_HZ.sqrt()).to_radians() - 1.0).abs() < 0.02, "{fitted}");
    let k = |fit: &Fit| if fit.k.identified { fit.k.value } else { fit.k.hi };
    let largest = noise.axes[..3].iter().map(|axis| k(axis.model().unwrap())).fold(0.0, f64::max);
    assert!((k_limit / largest.to_radians() - 1.0).abs() < 1e-5 && fitted.contains("upper 95 % limit of K of"));
    let covering = Rule::Covers(Some(20.0));
    let (covers_n, covers_k, covers) = in_file(Format::Openvins, &noise, covering, Combine::Worst);
    assert!(covers_n >= n && covers_n <= 2.0 * n && covers_k > 0.0 && covers_k < 10.0 * k_limit, "{covers}");
    assert!(covers.contains("covers the noise up to 20 s; fitted: "), "{covers}");
    let (kalibr_n, kalibr_k, _) = in_file(Format::Kalibr, &noise, covering, Combine::Worst);
    assert!(kalibr_n == n && kalibr_k > 0.0 && kalibr_k < 10.0 * k_limit, "{kalibr_n} {kalibr_k}");
    let (mean, ..) = in_file(Format::Kalibr, &noise, Rule::AsFitted, Combine::Mean);
    assert!((mean / (0.10 / RATE_HZ.sqrt()).to_radians() - 1.0).abs() < 0.02, "{mean}");
}

/// A short log has no model, a constant column is refused, and two axes are an invalid option for KF-GINS.
#[test]
fn a_run_without_a_file_says_why() {
    let folder = Folder::new();
    let file = |name: &str, content: String| folder.write(name, content);
    let short = file("short.csv", log(HEAD, 20));
    let doubts = Record::doubts(&of(&short, ImuOptions::default(), None).unwrap().axes);
    assert!(doubts.code() == Some("no-model") && doubts.to_string().contains("20 samples are too few"), "{doubts}");
    let still =
        file("still.csv", format!("t_s,gx_dps\n{}", (0..2000).map(|k| format!("{k},0.5\n")).collect::<String>()));
    assert_eq!(refusal(&of(&still, ImuOptions::default(), None).err().unwrap()), Some("frozen"));
    let two = ImuOptions { columns: Some(vec!["1".to_owned(), "2".to_owned()]), ..ImuOptions::default() };
    let error = of(&short, two, Some(Format::KfGins)).err().unwrap();
    assert!(error.is::<InvalidOptions>() && error.to_string().contains("KF-GINS takes three"), "{error}");
}
