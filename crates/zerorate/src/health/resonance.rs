//! The frequency at which a mechanical resonance of a part appears among its samples, and whether averaging removes it
//! there.
//!
//! A tone of `tone_hz`, sampled `rate_hz` times a second, appears at |tone − n·rate| for the nearest n. The tone of
//! the ADIS16130 appears at 2.778 kHz at the full rate of 5692.6/s (F-07), where any mean removes it. Near zero it
//! looks like a bias. A mean over τ leaves no more than √2·a/(π·f·τ) of a tone with rms a at f, and d/√(2τ) of white
//! noise with density d. Below f = 2·a/(π·d·√τ) the tone is the larger one.

use crate::notice::Warning;
use crate::part::Axis;

/// Warns if the resonance looks like a bias. The samples come at `rate_hz`, as measured, with every `divider`-th edge
/// of data ready read, in means over `average_s`. `None` for a part whose resonance or noise is not known.
#[must_use]
pub fn warning(axis: &Axis, rate_hz: f64, divider: u16, average_s: f64) -> Option<Warning> {
    let (tone, white) = (axis.resonance?, axis.noise?.white_dps_per_rt_hz);
    let divider = divider.max(1);
    // F-56: if the channels alternate, a divider of N gives f_conv/(N + 1). N = 1 has one edge for each pair of two
    // conversions, which is f_conv/2.
    let extra = if axis.alternates { 1.0 } else { 0.0 };
    let rate_at = |other: u16| rate_hz * (f64::from(divider) + extra) / (f64::from(other) + extra);
    tone.looks_like_bias(rate_hz, average_s, white).then(|| Warning::Resonance {
        tone,
        folded_hz: tone.folded_hz(rate_hz),
        rate_hz,
        divider: nearest(divider, |other| !tone.looks_like_bias(rate_at(other), average_s, white)),
    })
}

/// The divider nearest to `divider` that `good` accepts, or the lower of two. `None` if there is none up to four times
/// `divider`.
fn nearest(divider: u16, good: impl Fn(u16) -> bool) -> Option<u16> {
    (1..=divider.saturating_mul(3))
        .flat_map(|apart| [divider.checked_sub(apart), divider.checked_add(apart)])
        .flatten()
        .find(|other| *other >= 1 && good(*other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::Tone;

    fn warning(rate_hz: f64, divider: u16, average_s: f64) -> Option<Warning> {
        super::warning(&Axis::ADIS16130, rate_hz, divider, average_s)
    }

    /// Sample rate by F-56 at f_conv = 11 385.2/s.
    fn rate_hz(divider: u16) -> f64 {
        11_385.2 / (f64::from(divider) + 1.0)
    }

    #[test]
    fn the_full_rate_is_good_and_a_hundred_a_second_is_not() {
        assert_eq!(warning(rate_hz(1), 1, 10.0), None);
        let Some(Warning::Resonance { folded_hz, divider, .. }) = warning(100.0, 1, 10.0) else {
            panic!("no warning")
        };
        assert!(folded_hz < 1e-6 && divider == Some(2), "{folded_hz} Hz, {divider:?}");
    }

    #[test]
    fn the_next_divider_is_good_and_the_nearest() {
        for divider in 1..400 {
            for mclk in [0.99, 1.0, 1.0048, 1.01] {
                let rate_hz = rate_hz(divider) * mclk;
                if let Some(Warning::Resonance { divider: Some(other), .. }) = warning(rate_hz, divider, 10.0) {
                    let other_hz = 11_385.2 * mclk / (f64::from(other) + 1.0);
                    assert_eq!(warning(other_hz, other, 10.0), None, "{divider} → {other}");
                    assert!(other.abs_diff(divider) <= 8, "{divider} → {other}");
                }
            }
        }
    }

    /// With N = 3 the tone is 68 Hz away from a multiple of the sample rate. If the clock is 0.48 % faster, the tone
    /// is at a multiple.
    #[test]
    fn the_measured_rate_decides() {
        assert_eq!(warning(rate_hz(3), 3, 10.0), None);
        assert!(matches!(warning(rate_hz(3) * 1.0048, 3, 10.0), Some(Warning::Resonance { divider: Some(2), .. })));
    }

    #[test]
    fn longer_means_remove_what_is_nearer_to_zero() {
        let tone = Tone { tolerance_hz: 0.0, ..Axis::ADIS16130.resonance.unwrap() };
        let looks = |average_s| tone.looks_like_bias(99.99, average_s, 0.0125);
        // at 99.99/s the tone appears at 14 300 − 143 · 99.99 = 1.43 Hz
        assert!(looks(0.1) && !looks(10.0));
    }
}
