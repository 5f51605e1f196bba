//! Compares the checks with their definitions.

use super::clipped::tests::noise;
use super::*;
use crate::series::Series;
use std::path::Path;

fn checks(samples: &[f64]) -> ColumnChecks {
    ColumnChecks::of(&Input::Rate(samples))
}

/// Plain noise, noise with defects that the checks look for, and columns that are short, empty, constant or all
/// missing.
fn columns() -> Vec<Vec<f64>> {
    let with = |change: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
        noise(20_011).into_iter().enumerate().map(|(at, sample)| change(at, sample)).collect()
    };
    let stands =
        |range: std::ops::Range<usize>| move |at, sample: f64| if range.contains(&at) { 0.25 } else { sample };
    vec![
        with(&|_, sample| sample),
        with(&|_, sample| (0.3 * sample).round()),
        with(&|_, sample| (0.6 * sample + 0.4).round() * 1e-3),
        with(&|_, sample| (20.0 * sample).round().clamp(-15.0, 15.0)),
        with(&|at, sample| if at % 97 == 0 { f64::NAN } else { (2.0 * sample).round() }),
        with(&|at, sample| if (500..1500).contains(&at) { f64::NAN } else { sample }),
        with(&stands(0..1400)),
        with(&stands(700..1900)),
        with(&|at, sample| if at < 600 { f64::NAN } else { stands(600..2000)(at, sample) }),
        with(&stands(5000..6023)),
        with(&stands(18_000..30_000)),
        with(&stands(3010..3073)),
        with(&stands(3010..3074)),
        with(&stands(475..539)),
        with(&stands(480..544)),
        with(&|at, sample| if at >= 15_000 { [f64::NAN, 1.0][at % 2] } else { sample }),
        with(&|at, _| (at / 700) as f64),
        with(&|at, sample| if at == 9000 { 1e200 } else { sample }),
        with(&|at, sample| sample * if at / 5000 == 1 { 1e160 } else { 1.0 }),
        noise(513),
        noise(40),
        vec![f64::NAN; 2000],
        vec![1.0; 10_000],
        vec![1.0, 2.0],
        vec![],
    ]
}

/// Number of changes, and the last of the longest runs: its first sample, its length without and with missing samples.
fn stretches(samples: &[f64]) -> (usize, (usize, usize, usize)) {
    let there: Vec<usize> = (0..samples.len()).filter(|at| !samples[*at].is_nan()).collect();
    let starts: Vec<usize> =
        (0..there.len()).filter(|at| *at == 0 || samples[there[*at]] != samples[there[at - 1]]).collect();
    let ends = starts.iter().skip(1).copied().chain([there.len()]);
    let all = starts.iter().zip(ends).map(|(&start, end)| {
        let until = there.get(end).copied().unwrap_or(samples.len());
        (there[start], end - start, until - there[start])
    });
    (starts.len().saturating_sub(1), all.max_by_key(|stretch| stretch.1).unwrap_or_default())
}

#[test]
fn a_stop_is_found_as_it_is_defined() {
    for (column, samples) in columns().iter().enumerate() {
        let (changes, (start, same, with_missing)) = stretches(samples);
        let len = samples.iter().filter(|sample| !sample.is_nan()).count();
        let found = stopped(Input::Rate(samples), 10.0, Path::new("log"), "c");
        if changes == 0 {
            assert!(found.unwrap_err().to_string().contains(&format!("all {len} samples")), "{column}");
            continue;
        }
        let (path, name) = ("log".to_owned(), "c".to_owned());
        let expected = (same >= (len / 1000).clamp(64, 1000) && 2 * changes > len - same).then(|| {
            match start + with_missing == samples.len() {
                true => LogWarning::Stopped { path, column: name, same, len },
                false => LogWarning::Hung { path, column: name, same, len, from_s: start as f64 / 10.0 },
            }
        });
        assert_eq!(found.unwrap(), expected, "{column}");
        let facts = checks(samples).facts;
        assert_eq!((facts.changes.missing(), facts.finite), (samples.len() - len, len as u64), "{column}");
    }
}

#[test]
fn the_noise_of_coarse_codes_is_as_it_is_defined() {
    for (column, samples) in columns().iter().enumerate() {
        let differences = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let step = differences.filter(|difference| *difference > 0.0).fold(f64::INFINITY, f64::min);
        let variance = |window: &[f64]| {
            let mean = window.iter().sum::<f64>() / 32.0;
            window.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / 31.0
        };
        let mut variances: Vec<f64> = samples.chunks_exact(32).map(variance).filter(|v| v.is_finite()).collect();
        variances.sort_by(f64::total_cmp);
        let steps = variances.get(variances.len() / 2).map(|usual| usual.sqrt() / step);
        let expected = steps.filter(|steps| *steps < 0.577 && step.is_finite());
        let expected = expected.map(|steps| format!("noise of {steps:.2} steps: N, B and K are of the rounding"));
        assert_eq!(checks(samples).coarse.text(), expected, "{column}");
    }
}

#[test]
fn a_limit_is_where_most_of_the_largest_samples_are() {
    for (column, samples) in columns().iter().enumerate() {
        let mut sorted: Vec<f64> = samples.iter().copied().filter(|sample| sample.is_finite()).collect();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let count = sorted.len();
        let sizes: Vec<usize> = sorted.chunk_by(|a, b| a == b).take(4).map(<[f64]>::len).collect();
        let is_limit = |sizes: &[usize]| {
            let inside = sizes.iter().skip(1).max();
            sizes.len() == 4
                && sizes[0] >= 50
                && sizes[0] * 1000 >= count
                && inside.is_some_and(|most| sizes[0] >= 3 * most)
        };
        let text = checks(samples).clipped.text().unwrap_or_default();
        assert_eq!(text.contains("largest"), is_limit(&sizes), "{column}: {sizes:?} {text}");
    }
}

#[test]
fn gaps_among_codes_count_to_the_time_of_a_stop() {
    let mut codes: Vec<i32> = noise(9000).iter().map(|sample| (1e6 * sample) as i32).collect();
    codes[5000..7000].fill(7);
    let gaps = [(100, 50), (4999, 1), (6000, 9)].map(|(at, missing)| zerorate_allan::Gap { at, missing });
    let found = stopped(Input::Codes { codes: &codes, gaps: &gaps }, 1.0, Path::new("log"), "c").unwrap();
    let expected = LogWarning::Hung { path: "log".into(), column: "c".into(), same: 2000, len: 9000, from_s: 5051.0 };
    assert_eq!(found, Some(expected));
}

#[test]
fn a_column_keeps_its_facts_until_it_changes() {
    let bytes: Vec<u8> = noise(5000).iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let options = crate::ColumnOptions { raw: "f64".parse().ok(), rate: Some(1.0), ..Default::default() };
    let column = crate::read(Path::new("log"), bytes.into(), &options).unwrap();
    assert_eq!(column.facts, Some(checks(&noise(5000)).facts));
    let mut changed = [column.clone(), column.clone(), column];
    changed[0].skip(1);
    changed[1].close_gaps();
    changed[2].replace(Series::Codes(vec![1, 2]));
    assert!(changed.iter().all(|column| column.facts.is_none()));
}
