//! Finds the sines of a record: the narrow lines above its noise that one sine explains.

use super::super::bins::{Bin, all_edges};
use super::super::lines::{Line, Narrow};
use super::super::sines::Sine;
use super::super::transform::smooth_length;
use super::averages::{averages, fill_gaps};
use super::{Part, Spectrum};
use alloc::borrow::Cow;
use alloc::vec::Vec;
use realfft::FftError;

/// A line at frequency f is examined if its power exceeds `LOUD` · f · S(f), where S is the noise density.
const LOUD: f64 = 2.0;
/// A line is a sine if one sine has more than this share of the line's power.
const MOST_OF_IT: f64 = 0.9;
/// Largest number of lines that are examined in one round, the strongest first.
const MOST_SINES: usize = 16;
/// Largest number of means in the search for slow lines.
const MOST_MEANS: usize = 1 << 17;
/// Highest frequency of a slow line, as a share of the rate of the means. Averaging attenuates faster sines.
const WHOLE: f64 = 0.125;

/// Removes the sines from a rate, the strongest first, and returns them.
pub(super) fn take_out_sines(
    spectrum: &Spectrum,
    rate: &mut Cow<'_, [f64]>,
    rate_hz: f64,
) -> Result<Vec<Sine>, FftError> {
    let mut lines = loud(&spectrum.narrow, &spectrum.bins, rate_hz / (2.0 * spectrum.samples as f64));
    if spectrum.has_levels {
        lines.extend(slow_lines(rate, rate_hz)?);
    }
    lines.sort_by(|a, b| b.rms.total_cmp(&a.rms));
    let mut sines = Vec::new();
    for line in lines.into_iter().take(MOST_SINES) {
        let found = Sine::near(rate, rate_hz, line.frequency_hz, line.width_hz / 2.0)?;
        if let Some(sine) = found.filter(|sine| sine.variance() > MOST_OF_IT * line.rms * line.rms) {
            sine.take_out(rate.to_mut(), rate_hz);
            sines.push(sine);
        }
    }
    Ok(sines)
}

/// The narrow lines that stand out of the noise; coefficients are `hz` apart.
fn loud(narrow: &[Narrow], bins: &[Bin], hz: f64) -> Vec<Line> {
    let density_at = |f_hz: f64| {
        let near = bins.partition_point(|bin| (bin.end as f64) * hz < f_hz);
        bins.get(near).or(bins.last()).map_or(0.0, Bin::density)
    };
    let lines = narrow.iter().map(|narrow| narrow.line);
    lines.filter(|line| line.rms * line.rms > LOUD * line.frequency_hz * density_at(line.frequency_hz)).collect()
}

/// The slow lines of a rate, from one transform of means. The segments of levels are too short for them. Gaps are
/// filled with straight lines.
fn slow_lines(rate: &[f64], rate_hz: f64) -> Result<Vec<Line>, FftError> {
    let slot = rate.len().div_ceil(MOST_MEANS);
    let (mut means, _) = averages(rate, slot);
    means.truncate(smooth_length(means.len()));
    fill_gaps(&mut means);
    let rate_hz = rate_hz / slot as f64;
    let Part { hz, bins, narrow, .. } = Part::transform(&means, rate_hz, all_edges(means.len()))?;
    let is_slow = |line: &Line| line.frequency_hz < WHOLE * rate_hz;
    Ok(loud(&narrow, &bins, hz).into_iter().filter(is_slow).collect())
}
