//! The whole analysis of a record: deviations, noise types, degrees of freedom and limits.

use super::kernel::Reason;
use super::kernels::{Deviation, deviations_and_missing, join};
use super::noise_id::{NoiseType, identify};
use super::phase_points::phase_points;
use super::taus::{longest, nearest};
use super::{Input, Stat, Taus, edf, interval};
use alloc::vec::Vec;
use core::fmt;

/// The settings of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The statistic to compute.
    pub stat: Stat,
    /// The averaging times at which it is computed.
    pub taus: Taus,
    /// Probability that the limits enclose the true deviation, above 0 and below 1: 0.683 for one sigma.
    pub confidence: f64,
    /// Size of one input step in the unit of the result: the rate per LSB for codes, otherwise 1 or a unit conversion.
    pub scale: f64,
}

impl Default for Options {
    /// Overlapping Allan deviation, octaves, 68.3 %, unit of the input.
    fn default() -> Self {
        Self { stat: Stat::Oadev, taus: Taus::Octave, confidence: 0.683, scale: 1.0 }
    }
}

/// The result at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Averaging time τ = m / rate, s. The requested time was rounded to a whole number of samples.
    pub tau_s: f64,
    /// Samples in each average.
    pub m: u64,
    /// The deviation: unit of the input (for phase: per s) times [`Options::scale`]. TDEV has that unit times s.
    pub dev: f64,
    /// Lower confidence limit, in the unit of `dev`.
    pub lo: f64,
    /// Upper confidence limit, in the unit of `dev`.
    pub hi: f64,
    /// Equivalent degrees of freedom behind the limits, 1 or more. Gaps reduce them in proportion to the terms that
    /// are lost. The noise exponent assumed for them is at most the last one identified from 128 averages (short
    /// records: 30).
    pub edf: f64,
    /// Exponent α of the noise S_y(f) ∝ f^α at this τ, see [`noise_types`](super::noise_types).
    pub alpha: i32,
    /// Number of terms in the mean square.
    pub n: u64,
}

/// An averaging time without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unavailable {
    /// Requested averaging time, s.
    pub tau_s: f64,
    /// The reason why this averaging time has no result.
    pub reason: Reason,
}

/// The deviations of a record, by averaging time.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The statistic that was computed.
    pub stat: Stat,
    /// Samples per second.
    pub rate_hz: f64,
    /// Number of samples (for phase: points), missing ones included.
    pub samples: u64,
    /// Number of missing samples (for phase: points).
    pub missing: u64,
    /// The results, τ ascending.
    pub points: Vec<Point>,
    /// The averaging times without a result, by ascending length; repeated lengths come last. Unless times were
    /// requested, a record that is too short for any term has the averaging time of one sample here.
    pub unavailable: Vec<Unavailable>,
}

/// An invalid argument of [`analyse`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnalysisError {
    /// Samples per second must be positive and finite.
    Rate(f64),
    /// The confidence must be above 0 and below 1.
    Confidence(f64),
    /// The scale must be positive and finite.
    Scale(f64),
}

impl fmt::Display for AnalysisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rate(value) => write!(f, "the sample rate must be positive and finite, not {value} Hz"),
            Self::Confidence(value) => write!(f, "the confidence must be above 0 and below 1, not {value}"),
            Self::Scale(value) => write!(f, "the scale must be positive and finite, not {value}"),
        }
    }
}

impl core::error::Error for AnalysisError {}

/// Computes `options.stat` of a record sampled `rate_hz` times per second, with the noise type
/// ([`noise_types`](super::noise_types)), the equivalent degrees of freedom ([`edf()`]) and the confidence limits
/// ([`interval()`]) of every point.
///
/// ```
/// use zerorate_allan::{Input, Options, analyse};
/// let rate_dps: Vec<f64> = (0..1000).map(|i: i32| f64::from(i * i % 97)).collect();
/// let analysis = analyse(&Input::Rate(&rate_dps), 100.0, &Options::default()).unwrap();
/// let first = analysis.points[0];
/// assert_eq!((first.tau_s, first.n), (0.01, 999));
/// assert!(first.lo < first.dev && first.dev < first.hi);
/// ```
pub fn analyse(input: &Input<'_>, rate_hz: f64, options: &Options) -> Result<Analysis, AnalysisError> {
    check(rate_hz, options)?;
    let requests = requests(input, rate_hz, options);
    let (first, again): (Vec<Request>, Vec<Request>) = requests.into_iter().partition(|request| request.is_first);
    let lengths: Vec<u64> = first.iter().map(|request| request.m).collect();
    let positive: Vec<u64> = lengths.iter().copied().filter(|m| *m > 0).collect();
    let ((deviations, missing), noise) = join(
        || deviations_and_missing(input, rate_hz, options.stat, &lengths),
        || identify(input, options.stat, &positive),
    );
    let mut unavailable: Vec<Unavailable> = first
        .iter()
        .zip(&deviations)
        .filter_map(|(request, deviation)| Some(Unavailable { tau_s: request.tau_s, reason: deviation.err()? }))
        .collect();
    unavailable.extend(
        again.iter().map(|request| Unavailable { tau_s: request.tau_s, reason: Reason::SameLength { m: request.m } }),
    );
    let mut noise = positive.into_iter().zip(noise);
    let found = deviations.into_iter().flatten();
    let found = found.filter_map(|deviation| Some((deviation, noise.find(|(m, _)| *m == deviation.m)?.1))).collect();
    Ok(Analysis {
        stat: options.stat,
        rate_hz,
        samples: input.len(),
        missing,
        points: points(input, rate_hz, options, found),
        unavailable,
    })
}

struct Request {
    tau_s: f64,
    m: u64,
    /// Whether this is the first request of its length. True for every request of the length 0.
    is_first: bool,
}

fn check(rate_hz: f64, options: &Options) -> Result<(), AnalysisError> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    match options {
        _ if !positive(rate_hz) => Err(AnalysisError::Rate(rate_hz)),
        Options { confidence, .. } if !(*confidence > 0.0 && *confidence < 1.0) => {
            Err(AnalysisError::Confidence(*confidence))
        }
        Options { scale, .. } if !positive(*scale) => Err(AnalysisError::Scale(*scale)),
        _ => Ok(()),
    }
}

/// The requested averaging lengths, ascending. A time below half a sample, or NaN, gets the length 0 (no deviation).
fn requests(input: &Input<'_>, rate_hz: f64, options: &Options) -> Vec<Request> {
    let mut requests: Vec<Request> = match &options.taus {
        Taus::List(times) => {
            times.iter().map(|&tau_s| Request { tau_s, m: nearest(tau_s, rate_hz), is_first: true }).collect()
        }
        taus => taus
            .lengths(longest(options.stat, phase_points(input)).max(1))
            .into_iter()
            .map(|m| Request { tau_s: m as f64 / rate_hz, m, is_first: true })
            .collect(),
    };
    requests.sort_by_key(|request| request.m);
    let mut before = 0;
    for request in &mut requests {
        request.is_first = request.m != before || before == 0;
        before = request.m;
    }
    requests
}

fn points(input: &Input<'_>, rate_hz: f64, options: &Options, found: Vec<(Deviation, NoiseType)>) -> Vec<Point> {
    let stat = options.stat;
    let total = phase_points(input);
    let point = |(deviation, noise): (Deviation, NoiseType)| {
        let Deviation { m, dev, n } = deviation;
        let dev = dev * options.scale;
        let left = n as f64 / stat.row().kernel.terms(total, m).max(1) as f64;
        let edf = (edf(stat, noise.cautious, m, total) * left).max(1.0);
        let (lo, hi) = interval(dev, edf, options.confidence);
        Point { tau_s: m as f64 / rate_hz, m, dev, lo, hi, edf, alpha: noise.alpha, n }
    };
    found.into_iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::tests::nbs14;
    use alloc::vec;

    fn with(stat: Stat, taus: Taus) -> Options {
        Options { stat, taus, ..Options::default() }
    }

    /// NIST SP 1065 section 12.4: OADEV of its 1000 points at τ = 10 s, white noise.
    #[test]
    fn nist_1000_points() {
        let options = with(Stat::Oadev, Taus::List(vec![10.0]));
        let point = analyse(&Input::Rate(&nbs14(1000)), 1.0, &options).unwrap().points[0];
        assert_eq!((point.tau_s, point.m, point.alpha, point.n), (10.0, 10, 0, 981));
        assert!((point.dev / 9.159_953e-2 - 1.0).abs() < 3e-7);
        assert_eq!((point.lo, point.hi), interval(point.dev, edf(Stat::Oadev, 0, 10, 1001), 0.683));
    }

    #[test]
    fn a_constant_deviates_by_nothing() {
        for stat in Stat::ALL {
            for taus in [Taus::Octave, Taus::All] {
                let analysis = analyse(&Input::Rate(&[2.5; 40]), 10.0, &with(stat, taus)).unwrap();
                assert!(!analysis.points.is_empty());
                for point in analysis.points {
                    assert_eq!((point.dev, point.lo, point.hi), (0.0, 0.0, 0.0), "{stat}");
                    assert!(point.edf >= 1.0);
                }
            }
        }
    }

    #[test]
    fn every_point_is_finite_up_to_the_longest() {
        for n in [2, 3, 4, 7, 31, 32, 100] {
            for stat in Stat::ALL {
                let analysis = analyse(&Input::Rate(&nbs14(n)), 1.0, &with(stat, Taus::All)).unwrap();
                assert!(analysis.points.len() as u64 >= longest(stat, n as u64 + 1), "{stat} {n}");
                for point in analysis.points {
                    assert!(
                        point.lo <= point.dev && point.dev <= point.hi && point.hi.is_finite(),
                        "{stat} {n}: {point:?}"
                    );
                    assert!(point.edf >= 1.0 && point.n >= 1 && (-4..=2).contains(&point.alpha));
                }
            }
        }
    }

    #[test]
    fn each_point_that_is_not_computed_has_a_reason() {
        let times = vec![0.0, 0.29, 0.31, 1.0, 1000.0, f64::NAN, -1.0];
        let analysis = analyse(&Input::Rate(&nbs14(100)), 10.0, &with(Stat::Oadev, Taus::List(times))).unwrap();
        let computed: Vec<(u64, f64)> = analysis.points.iter().map(|point| (point.m, point.tau_s)).collect();
        assert_eq!(computed, [(3, 0.3), (10, 1.0)]);
        let reasons: Vec<Reason> = analysis.unavailable.iter().map(|missing| missing.reason).collect();
        let zero = Reason::ZeroLength;
        assert_eq!(reasons, [zero, zero, zero, Reason::TooShort { needs: 20_000 }, Reason::SameLength { m: 3 }]);
    }

    #[test]
    fn a_record_that_is_too_short_has_a_reason() {
        for samples in [&[][..], &[1.0]] {
            let analysis = analyse(&Input::Rate(samples), 1.0, &Options::default()).unwrap();
            assert!(analysis.points.is_empty());
            assert_eq!(analysis.unavailable[0].reason, Reason::TooShort { needs: 2 });
        }
    }

    /// White noise of variance 1/12 has an Allan variance of 1/(12 m). The limits must enclose it in 68.3 % of 400
    /// records, within three standard errors of this count.
    #[test]
    fn limits_enclose_the_truth_as_often_as_they_say() {
        let samples = nbs14(400 * 1000);
        for (stat, m) in
            [(Stat::Adev, 10), (Stat::Oadev, 10), (Stat::Oadev, 100), (Stat::Ohdev, 50), (Stat::Totdev, 100)]
        {
            let truth = libm::sqrt(1.0 / 12.0 / m as f64);
            let options = with(stat, Taus::List(vec![m as f64]));
            let encloses = |record: &&[f64]| {
                let point = analyse(&Input::Rate(record), 1.0, &options).unwrap().points[0];
                (point.lo..point.hi).contains(&truth)
            };
            let hits = samples.chunks(1000).filter(encloses).count();
            assert!((245..=301).contains(&hits), "{stat}, m = {m}: {hits} of 400");
        }
    }

    #[test]
    fn gaps_widen_the_limits() {
        let whole = nbs14(1000);
        let mut gappy = whole.clone();
        gappy[300..600].fill(f64::NAN);
        let of = |rate: &[f64]| analyse(&Input::Rate(rate), 1.0, &Options::default()).unwrap();
        let (whole, gappy) = (of(&whole), of(&gappy));
        assert_eq!((gappy.samples, gappy.missing), (1000, 300));
        for (whole, gappy) in whole.points.iter().zip(&gappy.points) {
            let left = gappy.n as f64 / whole.n as f64;
            assert!(gappy.edf <= whole.edf && left < 1.0, "{gappy:?}");
            assert!(gappy.alpha != whole.alpha || (gappy.edf / whole.edf - left).abs() < 1e-12 || gappy.edf == 1.0);
        }
    }

    #[test]
    fn arguments_are_checked() {
        let refused = |rate_hz, options: Options| analyse(&Input::Rate(&[1.0, 2.0]), rate_hz, &options).unwrap_err();
        assert_eq!(refused(0.0, Options::default()), AnalysisError::Rate(0.0));
        assert!(matches!(refused(f64::NAN, Options::default()), AnalysisError::Rate(_)));
        assert_eq!(refused(1.0, Options { confidence: 1.0, ..Options::default() }), AnalysisError::Confidence(1.0));
        assert_eq!(refused(1.0, Options { scale: -1.0, ..Options::default() }), AnalysisError::Scale(-1.0));
    }
}
