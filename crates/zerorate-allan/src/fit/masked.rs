//! The masked part of the spectrum: bins in a spectral line, which are left out of the fit.

use super::bins::Bin;
use super::density::{BinRow, Table, is_below};
use super::lines::{Line, Narrow};
use super::scoring::{ModelForm, N2, Problem};
use super::select::Selection;
use super::spectrum::Spectrum;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// The masked bins as spectral lines, with their power above the model.
pub(super) struct MaskedBins {
    lines: Vec<WholeLine>,
    /// Density at frequency 0 of the tails of broad lines near the upper end, unit²/Hz.
    pub(super) tail_at_zero: f64,
}

/// The tail of a resonance this near to half the rate, in octaves, cannot be distinguished from white noise.
const NEAR_THE_END: f64 = 2.0;
/// Least number of half widths of a resonance that the mask is assumed to cover.
const LEAST_REACH: f64 = 1.0;

/// A line stands out within a quarter of its period if its power is above this factor times frequency times N².
const SEEN: f64 = 8.0;

/// The coefficients of each line that is still in the samples, as the first and one past the last. Narrow lines are
/// widened by half to either side. The result is empty unless one line stands out of the noise within a quarter of its
/// period. Such a line looks like steps where it begins and ends. Other lines may be its tails, so all are returned.
pub(super) fn loud(spectrum: &Spectrum, chosen: &Selection, rate_hz: f64) -> Vec<(usize, usize)> {
    let narrow = spectrum.narrow.iter().filter(|narrow| !narrow.is_gone).map(|narrow| {
        let ((first, end), half) = (narrow.run, (narrow.run.1 - narrow.run.0).div_ceil(2));
        (&narrow.line, (first.saturating_sub(half).max(1), end + half))
    });
    let masked = MaskedBins::of(spectrum, chosen, rate_hz);
    let broad = masked.lines.iter().map(|whole| (&whole.line, whole.run));
    let stands_out =
        |(line, _): &(&Line, (usize, usize))| line.rms * line.rms > SEEN * line.frequency_hz * chosen.found.at[N2];
    let all: Vec<(&Line, (usize, usize))> = narrow.chain(broad).collect();
    if all.iter().any(stands_out) { all.into_iter().map(|(_, run)| run).collect() } else { Vec::new() }
}

/// Factor on the largest leakage of a sine, which is computed without noise.
const LEAK_MARGIN: f64 = 2.0;

/// A spectral line, narrow or broad.
pub(super) struct WholeLine {
    pub(super) line: Line,
    /// Variance and frequency of the line's sines in the model.
    pub(super) sines: Vec<(f64, f64)>,
    /// The first coefficient, and one past the last.
    run: (usize, usize),
    /// Whether the line is narrow, and may be a sine that is still in the samples. Such a sine leaks into other bins.
    leaks: bool,
}

impl WholeLine {
    fn leaks_into(&self, weak: &Self) -> bool {
        let most = LEAK_MARGIN * self.line.rms * self.line.rms * leak(self.run, weak.run);
        self.leaks && weak.line.rms * weak.line.rms <= most
    }

    fn add(&mut self, rms: f64) {
        let ratio = 1.0 + rms * rms / (self.line.rms * self.line.rms).max(f64::MIN_POSITIVE);
        self.sines.iter_mut().for_each(|(variance, _)| *variance *= ratio);
        self.line.rms *= libm::sqrt(ratio);
    }
}

impl MaskedBins {
    /// All lines of the record with their sines. A sine that begins and ends with the record leaks into coefficients
    /// far from its frequency. The leaked power is added to the line of the sine and forms no line of its own.
    pub(super) fn with_narrow(self, narrow: &[Narrow]) -> Vec<WholeLine> {
        let own = narrow.iter().map(|narrow| WholeLine {
            line: narrow.line,
            sines: narrow.sines.to_vec(),
            run: narrow.run,
            leaks: !narrow.is_gone,
        });
        let mut rest: Vec<WholeLine> = own.chain(self.lines).collect();
        rest.sort_by(|a, b| b.line.rms.total_cmp(&a.line.rms));
        let mut found: Vec<WholeLine> = Vec::new();
        for weak in rest {
            match found.iter_mut().find(|strong| strong.leaks_into(&weak)) {
                Some(strong) => strong.add(weak.line.rms),
                None => found.push(weak),
            }
        }
        found.sort_by(|a, b| a.line.frequency_hz.total_cmp(&b.line.frequency_hz));
        found
    }

    pub(super) fn of(spectrum: &Spectrum, chosen: &Selection, rate_hz: f64) -> Self {
        let kept = |bin: &Bin| chosen.problem.table.rows.iter().any(|row| row.bin.first == bin.first);
        let top_hz = chosen.problem.table.top_hz;
        let hz = rate_hz / (2.0 * spectrum.samples as f64);
        let is_masked = |bin: &&Bin| is_below((bin.end as f64 - 0.5) * hz, top_hz) && !kept(bin);
        let masked: Vec<Bin> = spectrum.bins.iter().filter(is_masked).copied().collect();
        let table = Table::new(masked.iter().copied(), &[], spectrum.samples, rate_hz).with_top(top_hz);
        let own = &chosen.found;
        let smooth = Problem::new(table, 0.0).density(&ModelForm { drift: None, ..own.form }, &own.at);
        let mut runs: Vec<Vec<(f64, Bin)>> = Vec::new();
        for (bin, smooth) in masked.iter().zip(smooth) {
            let width_hz = (bin.end - bin.first) as f64 * hz;
            let variance = 2.0 * (bin.power - smooth) * width_hz;
            match runs.last_mut() {
                Some(run) if run.last().is_some_and(|(_, last)| last.end == bin.first) => run.push((variance, *bin)),
                _ => runs.push(vec![(variance, *bin)]),
            }
        }
        let whole = |run: &Vec<(f64, Bin)>| WholeLine {
            line: line(run, hz),
            sines: run.iter().flat_map(|part| sines(part, hz)).collect(),
            run: (run[0].1.first, run[run.len() - 1].1.end),
            leaks: false,
        };
        let lines: Vec<WholeLine> = runs.iter().map(whole).collect();
        let reach_hz = |(first, end): (usize, usize)| (end - first) as f64 * hz / 2.0;
        let tail_at_zero = lines.iter().map(|whole| tail(&whole.line, reach_hz(whole.run), rate_hz)).sum();
        Self { lines, tail_at_zero }
    }
}

/// The largest leakage of lines that needs no warning, as a share of power: in the rows of the fit and of slow noise.
const MOST_LEAKAGE: f64 = 0.02;
const MOST_SLOW_LEAKAGE: f64 = 0.1;

/// The strongest line that may leak into the rows of the fit, and the share of the rows' power that may be leakage.
/// The share is the mean over all rows. B and K rest on the rows up to half the line's frequency. If their mean is
/// larger and above [`MOST_SLOW_LEAKAGE`], it counts instead. `None` without such a line, or for a share of at most
/// [`MOST_LEAKAGE`].
pub(super) fn leakage(lines: &[WholeLine], rows: &[BinRow], hz: f64) -> Option<(Line, f64)> {
    let strongest = lines.iter().filter(|whole| whole.leaks);
    let strongest = strongest.max_by(|a, b| a.line.rms.total_cmp(&b.line.rms))?;
    let share = |bin: &Bin| {
        let variance = 2.0 * bin.power * (bin.end - bin.first) as f64 * hz;
        let leaks = |whole: &WholeLine| whole.line.rms * whole.line.rms * leak(whole.run, (bin.first, bin.end));
        (lines.iter().filter(|whole| whole.leaks).map(leaks).sum::<f64>() / variance).min(1.0)
    };
    let mean_below = |f_hz: f64| {
        let below = || rows.iter().take_while(move |row| row.bin.end as f64 * hz < f_hz);
        let freedom: f64 = below().map(|row| row.bin.freedom).sum();
        below().map(|row| row.bin.freedom * share(&row.bin)).sum::<f64>() / freedom
    };
    let (whole, slow) = (mean_below(f64::INFINITY), mean_below(strongest.line.frequency_hz / 2.0));
    let most = if slow > MOST_SLOW_LEAKAGE { whole.max(slow) } else { whole };
    (most > MOST_LEAKAGE).then_some((strongest.line, most))
}

/// Returns the largest share of a sine's power that leaks from the middle of one run of coefficients into another.
///
/// In the worst case the sine is zero at both ends of the record. Then every second coefficient, at a distance d from
/// the sine, receives the share 4/(πd)².
fn leak((first, end): (usize, usize), (from, to): (usize, usize)) -> f64 {
    let middle = (first + end - 1) as f64 / 2.0;
    let (near, far) = if from as f64 > middle {
        (from as f64 - middle, to as f64 - middle)
    } else {
        (middle + 1.0 - to as f64, middle + 1.0 - from as f64)
    };
    if near < 1.0 { 1.0 } else { 2.0 / (PI * PI) * (1.0 / (near - 0.5) - 1.0 / (far - 0.5)) }
}

/// Variance and frequency of four sines that stand for a masked bin.
fn sines((variance, bin): &(f64, Bin), hz: f64) -> [(f64, f64); 4] {
    let (from, width) = (bin.first as f64 - 0.5, (bin.end - bin.first) as f64);
    [0.125, 0.375, 0.625, 0.875].map(|part| (variance / 4.0, (from + part * width) * hz))
}

/// Adjacent masked bins as one line: the centre of its power, and the width in Hz that holds half of it.
fn line(run: &[(f64, Bin)], hz: f64) -> Line {
    let total: f64 = run.iter().map(|(variance, _)| variance.max(0.0)).sum();
    let at = |part: f64| {
        let mut sum = 0.0;
        let reaches = |(variance, _): &&(f64, Bin)| {
            sum += variance.max(0.0);
            sum >= part * total
        };
        run.iter().find(reaches).map_or(0.0, |(_, bin)| bin.middle() * hz)
    };
    let narrowest = run.iter().map(|(_, bin)| (bin.end - bin.first) as f64 * hz).fold(f64::INFINITY, f64::min);
    Line { frequency_hz: at(0.5), width_hz: (at(0.75) - at(0.25)).max(narrowest), rms: libm::sqrt(total) }
}

/// Density of a resonance at frequency 0: P·w/(π(f² + w²)), with half width w and power P. Returns 0 for a line at
/// least [`NEAR_THE_END`] octaves below half the rate.
///
/// `line.rms` includes only the power within `reach_hz`. With x = reach/w, this is the share (2/π)·atan x of P. Half
/// of this power lies within w′ = reach/(1 + √(1 + x²)).
fn tail(line: &Line, reach_hz: f64, rate_hz: f64) -> f64 {
    if line.frequency_hz <= rate_hz / 2.0 / libm::exp2(NEAR_THE_END) {
        return 0.0;
    }
    let ratio = (2.0 * reach_hz / line.width_hz - 1.0).max(1.0);
    let x = libm::sqrt(ratio * ratio - 1.0).max(LEAST_REACH);
    let half_hz = reach_hz / x;
    let power = line.rms * line.rms * PI / 2.0 / libm::atan(x);
    power * half_hz / (PI * (line.frequency_hz * line.frequency_hz + half_hz * half_hz))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A resonance of known power and half width. The mask covers x half widths to either side.
    #[test]
    fn the_tail_of_a_resonance_is_known_from_the_part_in_the_mask() {
        let (power, half_hz, frequency_hz) = (3.0, 0.8, 40.0);
        let tail_at_zero = power * half_hz / (PI * (frequency_hz * frequency_hz + half_hz * half_hz));
        for x in [1.5, 3.0, 20.0] {
            let seen = power * 2.0 / PI * libm::atan(x);
            let half_of_it_hz = x * half_hz / (1.0 + libm::sqrt(1.0 + x * x));
            let line = Line { frequency_hz, width_hz: 2.0 * half_of_it_hz, rms: libm::sqrt(seen) };
            let found = tail(&line, x * half_hz, 200.0);
            assert!((found / tail_at_zero - 1.0).abs() < 1e-9, "{x} half widths: {found}, not {tail_at_zero}");
            assert_eq!(tail(&line, x * half_hz, 320.0), 0.0, "two octaves below half the rate");
        }
    }
}
