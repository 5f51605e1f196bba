//! Every row of the Stable32 tables in the reference data: deviations, noise types, confidence limits.
//!
//! Stable32 is the reference program of the field. Its rule for the noise type is not always the published one, so
//! this file implements that rule again from its definition. Every row must follow the rule of Stable32. The test also
//! asserts how many rows do not follow the published rule.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use zerorate_allan::{Input, Options, Point, Stat, Taus, analyse, interval};

/// Largest relative rounding error of the printed deviations, and of the printed limits.
const DEVIATION: f64 = 5e-5;
const LIMITS: f64 = 5e-4;
const CONFIDENCE: f64 = 0.683;

struct Table {
    name: String,
    stat: Stat,
    rows: Vec<Row>,
}

struct Row {
    m: u64,
    tau_s: f64,
    n: u64,
    alpha: i32,
    lo: f64,
    dev: f64,
    hi: f64,
}

/// Numbers of rows of a data set: all rows, and those with confidence limits.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    rows: usize,
    limits: usize,
    /// Rows whose noise type only the rule of Stable32 gives.
    own_rule: usize,
}

fn folder() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("ZERORATE_REFERENCE_DATA").map_or(root, PathBuf::from);
    let folder = root.join("stable32");
    if !folder.is_dir() {
        eprintln!("skipped: no Stable32 tables in {}", folder.display());
        return None;
    }
    Some(folder)
}

/// Rows of numbers; lines that start with # are comments.
fn numbers(file: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file).unwrap();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().map(|word| f64::from_str(word).unwrap()).collect()).collect()
}

fn series(file: &Path) -> Vec<f64> {
    numbers(file).into_iter().map(|row| row[0]).collect()
}

fn table(folder: &Path, name: String, stat: Stat) -> Table {
    let row = |columns: Vec<f64>| Row {
        m: columns[0] as u64,
        tau_s: columns[1],
        n: columns[2] as u64,
        alpha: columns[3] as i32,
        lo: columns[4],
        dev: columns[5],
        hi: columns[6],
    };
    Table { rows: numbers(&folder.join(&name)).into_iter().map(row).collect(), name, stat }
}

/// Compares every row of every table with the record that the table was made of.
fn compare(input: &Input<'_>, tables: &[Table]) -> Tally {
    let phase = phase_of(input);
    let mut tally = Tally::default();
    for Table { name, stat, rows } in tables {
        let rate_hz = rows[0].m as f64 / rows[0].tau_s;
        let taus = Taus::List(rows.iter().map(|row| row.m as f64 / rate_hz).collect());
        let options = Options { stat: *stat, taus, confidence: CONFIDENCE, scale: 1.0 };
        let analysis = analyse(input, rate_hz, &options).unwrap();
        assert!(analysis.unavailable.is_empty(), "{name}: {:?}", analysis.unavailable);
        let is_rate = !matches!(input, Input::Phase(_));
        let theirs = stable32_types(&phase, is_rate, *stat, rows);
        for ((row, point), theirs) in rows.iter().zip(&analysis.points).zip(theirs) {
            let at = format!("{name}, m = {}", row.m);
            assert_eq!((point.m, point.n), (row.m, row.n), "{at}");
            assert!((point.dev / row.dev - 1.0).abs() < DEVIATION, "{at}: {} instead of {}", point.dev, row.dev);
            assert_eq!(theirs, row.alpha, "{at}: the rule of Stable32");
            tally.own_rule += usize::from(point.alpha != row.alpha);
            tally.limits += usize::from(check_limits(&at, *stat, row, point, phase.len() as u64));
            tally.rows += 1;
        }
    }
    tally
}

/// Checks our limits against the limits of the row. Returns whether the row has any.
fn check_limits(at: &str, stat: Stat, row: &Row, point: &Point, points: u64) -> bool {
    if row.hi == 0.0 {
        return false;
    }
    assert_eq!(point.alpha, row.alpha, "{at}");
    let (lo, hi) = match stat {
        Stat::Totdev if row.alpha > 0 => {
            interval(point.dev, stein_edf(row.alpha, row.m as f64, points as f64), CONFIDENCE)
        }
        _ => (point.lo, point.hi),
    };
    // Stable32 solves χ² to only about 2e-4 in the probability, which shows at the smallest degrees of freedom.
    let tolerance = if point.edf < 3.0 { 6e-4 } else { LIMITS };
    assert!((lo / row.lo - 1.0).abs() < tolerance, "{at}: lower limit {lo} instead of {}", row.lo);
    assert!((hi / row.hi - 1.0).abs() < tolerance, "{at}: upper limit {hi} instead of {}", row.hi);
    true
}

/// Stable32's degrees of freedom for TOTDEV of phase noise: the older formulas for OADEV (NIST SP 1065 table 5). For
/// OADEV, Stable32 uses the newer formulas, as this crate does for both. For flicker phase noise, the older and the
/// newer formulas differ by a factor of about 2.
fn stein_edf(alpha: i32, m: f64, n: f64) -> f64 {
    match alpha {
        2 => (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m)),
        _ => (((n - 1.0) / (2.0 * m)).ln() * ((2.0 * m + 1.0) * (n - 1.0) / 4.0).ln()).sqrt().exp(),
    }
}

fn phase_of(input: &Input<'_>) -> Vec<f64> {
    match input {
        Input::Phase(phase) => phase.to_vec(),
        Input::Rate(rate) => {
            let mean = rate.iter().sum::<f64>() / rate.len() as f64;
            let mut phase = vec![0.0];
            for value in *rate {
                phase.push(phase[phase.len() - 1] + value - mean);
            }
            phase
        }
        Input::Codes { .. } => unreachable!("no table was made of codes"),
    }
}

/// Noise types as Stable32 gives them. Three points differ from the published rules that
/// [`zerorate_allan::noise_types`] follows:
/// 1. For phase data, 2δ is rounded by cutting off the fraction of 2δ + ½, which goes the wrong way for negative δ. δ
///    is at least −1.
/// 2. Boundaries of B1 use the number of terms of the statistic, not the number of averages from which B1 was
///    computed.
/// 3. R(n) is not used: phase noise found by B1 is flicker.
fn stable32_types(phase: &[f64], is_rate: bool, stat: Stat, rows: &[Row]) -> Vec<i32> {
    let fewest = if matches!(stat, Stat::Adev | Stat::Hdev) { 10 } else { 8 };
    let mut last = 0;
    let next = |row: &Row| {
        let m = row.m as usize;
        let decimated: Vec<f64> = phase.iter().copied().step_by(m).collect();
        last = match decimated.len() - 1 {
            30.. => lag1_type(decimated, is_rate),
            averages if averages >= fewest => b1_type(&decimated, row.n as f64),
            _ if stat == Stat::Totdev => last.min(0),
            _ => last,
        };
        last
    };
    rows.iter().map(next).collect()
}

fn lag1_type(mut z: Vec<f64>, is_rate: bool) -> i32 {
    for d in 0.. {
        let n = z.len() as f64;
        let mean = z.iter().sum::<f64>() / n;
        let covariance = z.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>() / n;
        let r1 = covariance / (z.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0));
        let delta = r1 / (1.0 + r1);
        if delta < 0.25 || d == 2 {
            let twice = if is_rate { (2.0 * delta).round() } else { (2.0 * delta.max(-1.0) + 0.5).trunc() };
            return 2 - 2 * d - twice as i32;
        }
        z = z.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    unreachable!()
}

fn b1_type(decimated: &[f64], terms: f64) -> i32 {
    let y: Vec<f64> = decimated.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let n = y.len() as f64;
    let mean = y.iter().sum::<f64>() / n;
    let variance = y.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let allan = y.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / (2.0 * (n - 1.0));
    let expected = [(terms + 1.0) / (1.5 * terms), 1.0, terms * terms.log2() / (2.0 * (terms - 1.0)), terms / 2.0];
    let above = expected.windows(2).filter(|pair| variance / allan >= (pair[0] * pair[1]).sqrt());
    1 - above.count() as i32
}

#[test]
fn phasedat() {
    let Some(folder) = folder().map(|folder| folder.join("phasedat")) else { return };
    let phase = series(&folder.join("PHASE.DAT"));
    let octaves = Stat::ALL.map(|stat| table(&folder, format!("phase_dat_{stat}_octave.txt"), stat));
    let all = [Stat::Oadev, Stat::Mdev].map(|stat| table(&folder, format!("phase_dat_{stat}.txt"), stat));
    let tables: Vec<Table> = octaves.into_iter().chain(all).collect();
    assert_eq!(compare(&Input::Phase(&phase), &tables), Tally { rows: 335, limits: 57, own_rule: 6 });
}

#[test]
fn tic() {
    let Some(folder) = folder().map(|folder| folder.join("tic")) else { return };
    let phase = series(&folder.join("tic_phase.txt"));
    let tables = Stat::ALL.map(|stat| table(&folder, format!("tic_{stat}.txt"), stat));
    assert_eq!(compare(&Input::Phase(&phase), &tables), Tally { rows: 345, limits: 85, own_rule: 11 });
}

#[test]
fn pink() {
    let Some(folder) = folder().map(|folder| folder.join("pink")) else { return };
    let rate = series(&folder.join("pink_frequency.txt"));
    let octaves = table(&folder, "s32_oadev_octave.txt".into(), Stat::Oadev);
    let all = [Stat::Adev, Stat::Oadev, Stat::Mdev, Stat::Hdev, Stat::Ohdev];
    let all = all.map(|stat| table(&folder, format!("{stat}.txt"), stat));
    let tables: Vec<Table> = [octaves].into_iter().chain(all).collect();
    assert_eq!(compare(&Input::Rate(&rate), &tables), Tally { rows: 1047, limits: 12, own_rule: 8 });
}
