//! Detects signed codes that were written without a sign: 65530 in place of -6.

use crate::column::Column;
use crate::series::Series;
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::Input;

/// The usual widths of codes, bits.
const WIDTHS: [i32; 8] = [8, 12, 14, 16, 18, 20, 24, 32];

/// Share of the range at each end in which codes that wrapped around lie, because a sensor at rest is near zero.
const END: f64 = 0.125;

/// Largest share of the samples between the two ends of the range.
const BETWEEN: f64 = 0.001;

/// Largest hole around zero: this share of the spread of the samples, plus this number of codes. Noise has no hole.
const HOLE: f64 = 0.25;
const HOLE_CODES: f64 = 2.0;

/// Gives codes that wrapped around zero their sign again, and returns their width in bits; `None` if no code wrapped.
pub fn unwrap(series: &mut Series) -> Option<i32> {
    let bits = width(&series.input(&[]))?;
    sign(series, bits);
    Some(bits)
}

/// The series with the sign of its codes, and their width in bits; `None` if no code wrapped around zero.
pub fn unwrapped(input: &Input<'_>) -> Option<(Series, i32)> {
    let bits = width(input)?;
    let mut series = match input {
        Input::Codes { codes, .. } => Series::Codes(codes.to_vec()),
        Input::Rate(numbers) | Input::Phase(numbers) => Series::Numbers(numbers.to_vec()),
    };
    sign(&mut series, bits);
    Some((series, bits))
}

fn width(input: &Input<'_>) -> Option<i32> {
    match input {
        Input::Codes { codes, .. } => bits(|| codes.iter().map(|code| f64::from(*code))),
        Input::Rate(numbers) | Input::Phase(numbers) => {
            bits(|| numbers.iter().copied().filter(|number| !number.is_nan()))
        }
    }
}

/// Gives the codes of a column their sign if another column has codes that wrapped around, and all codes of this
/// column lie at the upper end of the same range. Such a column is always negative.
pub fn unwrap_others(path: &Path, columns: &mut [Column]) {
    let wrapped = |column: &Column| {
        column.warnings.iter().find_map(|warning| match warning {
            LogWarning::CodesUnsigned { bits, .. } => Some(*bits),
            _ => None,
        })
    };
    let Some(bits) = columns.iter().find_map(wrapped) else { return };
    let full = 2f64.powi(bits);
    for column in columns.iter_mut().filter(|column| wrapped(column).is_none()) {
        let high = full * (1.0 - END)..full;
        let are_high = match &column.series {
            Series::Codes(codes) => !codes.is_empty() && codes.iter().all(|code| high.contains(&f64::from(*code))),
            Series::Numbers(_) => false,
        };
        if are_high {
            sign(&mut column.series, bits);
            column.facts = None;
            let (path, name) = (path.display().to_string(), column.name.clone());
            column.warnings.push(LogWarning::CodesUnsigned { path, column: name, bits });
        }
    }
}

fn sign(series: &mut Series, bits: i32) {
    let full = 2f64.powi(bits);
    let signed = |code: f64| if code < full / 2.0 { code } else { code - full };
    match series {
        Series::Codes(codes) => codes.iter_mut().for_each(|code| *code = signed(f64::from(*code)) as i32),
        Series::Numbers(numbers) => numbers.iter_mut().for_each(|number| *number = signed(*number)),
    }
}

/// The width in bits of codes that wrapped around zero; `None` if the codes did not wrap.
fn bits<I: Iterator<Item = f64>>(codes: impl Fn() -> I) -> Option<i32> {
    if codes().any(|code| code < 0.0 || code.fract() != 0.0) {
        return None;
    }
    let most = codes().fold(0.0, f64::max);
    let bits = WIDTHS.into_iter().find(|bits| most < 2f64.powi(*bits))?;
    let full = 2f64.powi(bits);
    if most < full * (1.0 - END) {
        return None;
    }
    let end = |is_in: fn(f64, f64) -> bool| {
        let inside = codes().filter(|code| is_in(*code, full));
        inside.fold((f64::INFINITY, f64::NEG_INFINITY, 0u64), |(least, most, count), code| {
            (least.min(code), most.max(code), count + 1)
        })
    };
    let (low, high) = (end(|code, full| code < full * END), end(|code, full| code >= full * (1.0 - END)));
    let all = codes().count() as u64;
    let between = all - low.2 - high.2;
    let spread = (low.1 - low.0).max(high.1 - high.0);
    let hole = low.0 + full - high.1;
    let is_wrapped = low.2 > 0 && between as f64 <= BETWEEN * all as f64 && hole <= HOLE * spread + HOLE_CODES;
    is_wrapped.then_some(bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column_checks::clipped::tests::noise;

    fn codes(mean: f64, sigma: f64) -> Vec<i64> {
        noise(20_000).into_iter().map(|z| (mean + sigma * z).round() as i64).collect()
    }

    #[test]
    fn codes_get_their_sign_again() {
        for bits in WIDTHS {
            let cases = [(0.0, 6.0), (-2.0, 6.0), (20.0, 6.0), (-1.0, 0.4), (-15.0, 5.0)];
            let fits = |(mean, sigma): &(f64, f64)| mean.abs() + 5.0 * sigma < END * 2f64.powi(bits);
            for (mean, sigma) in cases.into_iter().filter(fits) {
                let signed = codes(mean, sigma);
                let written = signed.iter().map(|code| code.rem_euclid(1 << bits));
                let mut series = match bits {
                    32 => Series::Numbers(written.map(|code| code as f64).collect()),
                    _ => Series::Codes(written.map(|code| code as i32).collect()),
                };
                let found = unwrap(&mut series);
                let got = match series {
                    Series::Codes(codes) => codes.into_iter().map(f64::from).collect(),
                    Series::Numbers(numbers) => numbers,
                };
                assert_eq!((found, got), (Some(bits), signed.iter().map(|code| *code as f64).collect()), "{mean}");
            }
        }
    }

    #[test]
    fn other_codes_are_left() {
        let of = |codes: Vec<i64>| unwrap(&mut Series::Codes(codes.into_iter().map(|code| code as i32).collect()));
        assert_eq!(of(codes(0.0, 6.0)), None, "with a sign");
        assert_eq!(of(codes(8_388_608.0, 1e3)), None, "zero in the middle");
        assert_eq!(of(codes(16_384.0, 30.0)), None);
        assert_eq!(of(codes(100.0, 10.0).into_iter().chain([65_535]).collect()), None, "a mark of a failed read");
        assert_eq!(of(codes(60_000.0, 900.0)), None);
        assert_eq!(of((0..65_536).collect()), None, "a counter");
    }
}
