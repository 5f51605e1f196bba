//! The interval of a value if models disagree. A mean and a variance do not describe two separate peaks.

use core::f64::consts::SQRT_2;

/// The distribution of a value by models of one kind: normal, with their weight among all models.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    pub(super) weight: f64,
    pub(super) mean: f64,
    pub(super) variance: f64,
}

/// Half widths, in standard uncertainties, of the intervals that users rely on: 95 %, 99.73 % and 99.994 % of a normal
/// distribution.
const RELIED_ON: [f64; 3] = [crate::uncertainty::Uncertainty::FACTOR, 3.0, 4.0];
/// Number of halvings of a bracket. They make the bracket narrower by a factor of 10¹².
const HALVINGS: u32 = 40;

/// Returns the smallest standard uncertainty about `centre`, at least `sd`, whose intervals contain as much of all
/// peaks as they would contain of a normal distribution.
pub(super) fn honest_u(peaks: &[Peak], centre: f64, sd: f64) -> f64 {
    RELIED_ON.iter().map(|factor| half_width(peaks, centre, *factor, factor * sd) / factor).fold(sd, f64::max)
}

/// Smallest half width, at least `least`, that leaves no more outside than ±`factor` σ of a normal distribution.
fn half_width(peaks: &[Peak], centre: f64, factor: f64, least: f64) -> f64 {
    let allowed = libm::erfc(factor / SQRT_2);
    if outside(peaks, centre, least) <= allowed {
        return least;
    }
    let far = |peak: &Peak| (peak.mean - centre).abs() + factor * libm::sqrt(peak.variance);
    let (mut low, mut high) = (least, peaks.iter().map(far).fold(least, f64::max));
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if outside(peaks, centre, middle) > allowed { low = middle } else { high = middle }
    }
    high
}

/// Share of the peaks outside of `centre` ± `half_width`.
fn outside(peaks: &[Peak], centre: f64, half_width: f64) -> f64 {
    let tail = |distance: f64, peak: &Peak| 0.5 * libm::erfc(distance / libm::sqrt(2.0 * peak.variance));
    let both = |peak: &Peak| {
        let off = peak.mean - centre;
        peak.weight * (tail(half_width - off, peak) + tail(half_width + off, peak))
    };
    peaks.iter().filter(|peak| peak.weight > 0.0 && peak.variance > 0.0).map(both).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_peak_has_its_own_deviation() {
        let one = [Peak { weight: 1.0, mean: 2.0, variance: 0.25 }];
        assert!((honest_u(&one, 2.0, 0.5) - 0.5).abs() < 1e-9);
    }

    /// Computes the shares outside of the stated intervals without `erfc`, by sums of the density over a fine grid.
    #[test]
    fn two_peaks_are_inside_as_often_as_stated() {
        let peaks = [Peak { weight: 0.7, mean: 0.0, variance: 0.01 }, Peak { weight: 0.3, mean: 1.5, variance: 1.0 }];
        let variance: f64 = peaks.iter().map(|peak| peak.weight * (peak.variance + peak.mean * peak.mean)).sum();
        let u = honest_u(&peaks, 0.0, variance.sqrt());
        assert!(u > 1.1 * variance.sqrt(), "{u}");
        let density = |x: f64, peak: &Peak| {
            let off = x - peak.mean;
            peak.weight * (-off * off / (2.0 * peak.variance)).exp()
                / (2.0 * core::f64::consts::PI * peak.variance).sqrt()
        };
        let beyond = |k: f64| {
            let far = (-20_000..20_000).map(|i| (f64::from(i) + 0.5) * 1e-3).filter(|x| x.abs() > k * u);
            far.map(|x| peaks.iter().map(|peak| density(x, peak)).sum::<f64>() * 1e-3).sum::<f64>()
        };
        assert!(
            beyond(1.96) < 0.0501 && beyond(3.0) < 0.002_71 && beyond(4.0) < 6.4e-5,
            "{} {}",
            beyond(3.0),
            beyond(4.0)
        );
    }
}
