//! A noise model of a record at rest, from the likelihood of its cosine spectrum.
//!
//! Every octave of an Allan variance mixes the whole spectrum: a line, a resonance or a low-pass bends six to ten
//! octaves. In the spectrum the same effects are local, and the coefficients are independent. So the model is fitted
//! to the spectrum. The Allan variance shows and checks the model. A cosine transform, unlike a Fourier transform, has
//! no jump between the ends of the record. It diagonalises the covariance of white noise and of a random walk exactly.
//! Densities are two-sided, unit²/Hz: white noise of coefficient N has N².
//!
//! `docs/noise-models.md` describes the terms, which of them cannot be told apart, and the measured errors.

mod band;
mod bins;
mod coefficients;
mod covering;
mod curve;
mod density;
mod departure;
mod drift;
mod glitches;
mod lines;
mod masked;
mod misfit;
mod model;
mod motion;
mod periods;
mod pool;
mod prediction;
mod profile;
mod readings;
mod record_length;
mod remarks;
mod runs;
mod samples;
mod scoring;
mod select;
mod sines;
mod spectrum;
mod steadiness;
mod steps;
#[cfg(test)]
pub(super) mod tests;
mod thinning;
mod transform;

use super::chi2::{chi2_above, chi2_quantile};
use super::{AllanWarning, Analysis, Coefficient, Deviation, Input, Misfit, Point, Stat};
use alloc::borrow::Cow;
use alloc::vec::Vec;
use coefficients::Coefficients;
use core::fmt;
pub use covering::{Covering, Usage};
use curve::Curves;
use density::Table;
use drift::Drift;
pub use lines::Line;
use masked::MaskedBins;
use misfit::OffCurve;
use model::MeasuredSpectrum;
pub use model::Model;
pub use motion::{Motion, MotionKind, motion};
use periods::Period;
pub use pool::{Differs, Outlier, Pool, PoolError, PoolRecord, Spread, fit_pool};
use prediction::PredictionError;
use realfft::FftError;
use remarks::{Raw, remarks};
use samples::{check, cut_glitches, enough, rates};
use scoring::{B2, N2, Q2, SHAPE_PRICE};
use select::Selection;
use spectrum::Spectrum;
use steadiness::Scatter;
pub use steps::Step;

/// The settings of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The size of one input step in the unit of the result, as in [`Options`](super::Options).
    pub scale: f64,
    /// Replace single samples, or a few in a row, that cannot be noise. Otherwise one sample of 250 °/s among two
    /// million of a quiet gyroscope doubles N.
    pub cut_glitches: bool,
    /// Remove jumps of the level. Otherwise one jump of 0.05 °/s in an hour multiplies the random walk by five.
    pub remove_steps: bool,
    /// The frequency up to which the model holds, Hz. With `None` it is chosen from the data.
    pub max_freq_hz: Option<f64>,
}

impl Default for FitOptions {
    /// Keeps the unit of the input, and removes glitches and steps.
    fn default() -> Self {
        Self { scale: 1.0, cut_glitches: true, remove_steps: true, max_freq_hz: None }
    }
}

/// A parameter with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end of the 95 % interval.
    pub hi: f64,
}

/// A term of the model besides N, B, K, Q and R.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Term {
    /// Correlated noise: a Gauss–Markov process of first order.
    GaussMarkov {
        /// Standard deviation, in the unit of the rate.
        sigma: Estimate,
        /// Correlation time, s.
        tau_s: Estimate,
    },
    /// The shape that the sensor's filter gives to all noise except quantisation, or to the white noise only. It
    /// multiplies the density by exp Σ a_j (cos jθ − 1) with sin(θ/2) = sin(πf·dt) over sin(πf_max·dt). A pole p
    /// multiplies the density by (1 − p)²/(1 + p² − 2p cos θ).
    BandShape {
        /// a_1, a_2 …
        cosines: Vec<f64>,
        /// Pole p of a first-order low-pass.
        pole: Option<f64>,
        /// A second-order low-pass instead of the pole.
        corner: Option<Corner>,
        /// Whether the shape applies to the white noise only, and slow noise is added after the filter.
        of_white: bool,
    },
    /// A disturbance or resonance, which was left out of the fit.
    Line(Line),
    /// A warm-up: the level changes as `size`·e^(−t/`tau_s`) with t from the start of the record.
    WarmUp {
        /// Size, in the unit of the rate.
        size: Estimate,
        /// Time constant, s.
        tau_s: f64,
    },
}

/// A low-pass of the second order, which multiplies the density by 1/(1 + cx + x²) with x = (sin πf·dt/sin πf_c·dt)².
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Corner {
    /// Corner frequency f_c, Hz.
    pub frequency_hz: f64,
    /// Damping c: 0 for a Butterworth low-pass, 2 for two equal poles, negative for a resonance.
    pub damping: f64,
}

/// The glitches and steps that were found in the record before the fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cleaning {
    /// Number of glitches whose samples were replaced. Adjacent samples are one glitch.
    pub glitches: u64,
    /// Start of each glitch, s from the start of the record.
    pub glitches_s: Vec<f64>,
    /// The jumps that were removed.
    pub steps: Vec<Step>,
    /// The first jumps found, if there were too many to remove any of them.
    pub put_back: Vec<Step>,
    /// The record without glitches and steps, in the result's unit, NaN for missing samples. `None` if nothing was
    /// removed.
    pub rate: Option<Vec<f64>>,
}

/// The noise of a record at rest, in the unit of its rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Angle random walk N, unit·√s, with the Allan variance N²/τ. The one-sided density of the white noise is √2·N
    /// unit/√Hz. N is the plateau of the spectrum below any low-pass.
    pub n: Coefficient,
    /// Bias instability B, unit, with the Allan variance (2 ln 2/π)B². The floor of the curve is 0.664·B.
    pub b: Coefficient,
    /// Rate random walk K, unit/√s, with the Allan variance K²τ/3.
    pub k: Coefficient,
    /// Angle quantisation Q, unit·s, with the Allan variance 3Q²/τ²; only if the spectrum rises as f² up to its end.
    pub q: Option<Coefficient>,
    /// Rate ramp R, unit/s, with the Allan variance R²τ²/2; only if significant.
    pub r: Option<Coefficient>,
    /// The other terms: Gauss–Markov terms, the band shape, a warm-up and lines, in this order.
    pub terms: Vec<Term>,
    /// The Allan variance that the terms predict.
    pub model: Model,
    /// Model error ε: the spectrum scatters about the model as if the model were wrong by this share. 0 if chance
    /// explains the scatter. The largest error of the curve up to 1/[`PREDICTS`] of the record counts instead if it is
    /// beyond chance and larger.
    pub model_error: f64,
    /// The standard deviation of loud windows of ten seconds over that of quiet ones, if the sensor moves. Or the
    /// deviation of one half of the record over that of the other, at an averaging time up to ten seconds.
    pub motion_ratio: Option<f64>,
    /// Probability of a larger scatter than the measured one, if the model with ε is right.
    pub p_value: f64,
    /// Whether the model is wrong by more than [`MOST_ERROR`], or the sensor moves. Nothing is identified then.
    pub is_rejected: bool,
    /// The frequency band and the likely cause of the misfit, if the model is rejected.
    pub misfit: Option<Misfit>,
    /// The measured overlapping Allan deviations at 1, 2, 4 … samples, without glitches and steps. Empty for a pool.
    pub curve: Vec<Deviation>,
    /// The frequency up to which the model holds, Hz. Above it the sensor's filter shapes the noise, and the Allan
    /// variance is computed from the measured spectrum.
    pub max_freq_hz: f64,
    /// Shortest and longest averaging time that the model covers, s.
    pub span_s: (f64, f64),
    /// The glitches and steps that were removed before the fit.
    pub cleaned: Cleaning,
    /// Warnings about the record and the model. Each states what was seen and what to do.
    pub warnings: Vec<AllanWarning>,
}

/// The prediction of a model for one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// The expected deviation. For a record with gaps, [`Fit::expected`] allows for the samples that averages lack.
    pub dev: f64,
    /// Lower end of the band in which the model expects 95 % of the measured deviations.
    pub lo: f64,
    /// Upper end of the band.
    pub hi: f64,
}

impl Fit {
    /// The fitted Allan deviation of averages of `m` samples.
    #[must_use]
    pub fn deviation(&self, m: u64) -> f64 {
        libm::sqrt(self.model.allan_variance(m))
    }

    /// The prediction of the model for a measured point; `None` if the statistic is not an Allan deviation. For the
    /// overlapping deviation the model gives the band. For the others, the point's degrees of freedom give the band.
    #[must_use]
    pub fn expected(&self, analysis: &Analysis, point: &Point) -> Option<Prediction> {
        let (lo, hi) = match analysis.stat {
            stat if !stat.is_allan() => return None,
            Stat::Oadev => self.model.band(point.m, point.n, analysis.samples),
            _ => self.model.band_of(point.m, point.edf),
        };
        Some(Prediction { dev: libm::sqrt(self.model.measured_variance(point.m)), lo, hi })
    }

    /// The band in which 95 % of the overlapping Allan deviations of averages of `m` samples lie in *another* record
    /// of `samples` samples of this sensor at rest. The band includes the uncertainty of the fit and the differences
    /// between eighths of the record. `None` for averages of more than 1/[`PREDICTS`] of the fitted record: it is not
    /// known how steady these are. docs/reference/allan.md states how often the band holds. For a pool the band
    /// includes neither the unsteadiness of the records nor the spread between units.
    #[must_use]
    pub fn predicted(&self, m: u64, samples: u64) -> Option<Prediction> {
        if m as f64 > self.model.samples() / PREDICTS {
            return None;
        }
        let (dev, edf) = (self.deviation(m), self.model.freedom(m, samples));
        let doubt = self.model.doubt(m);
        // half width in ln σ: the variances of chance and of the fit add up, and the unsteadiness adds linearly
        let limit = |p: f64| {
            let chance = libm::log(chi2_quantile(p, edf) / edf);
            let known = libm::sqrt(chance * chance + TWO_SIDED_95 * TWO_SIDED_95 * doubt.own);
            (known + TWO_SIDED_95 * libm::sqrt(doubt.scatter)) / 2.0
        };
        Some(Prediction { dev, lo: dev * libm::exp(-limit(0.025)), hi: dev * libm::exp(limit(0.975)) })
    }
}

/// A model predicts averages up to the length of its record divided by this.
pub const PREDICTS: f64 = 128.0;
/// A model whose error is larger is rejected.
pub const MOST_ERROR: f64 = 0.1;
/// The normal quantile at 97.5 %.
const TWO_SIDED_95: f64 = 1.959963984540054;
/// Least number of samples for a fit.
pub const FEWEST_SAMPLES: u64 = 256;
/// Largest number of steps that are removed. More steps belong to the noise itself.
const MOST_STEPS: usize = 3;
/// Largest score that is not a step, in standard deviations. 1 of 200 one-hour records without a step exceeds it.
const STEP_LIMIT: f64 = 5.0;

/// The reasons why a record has no model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// Fewer than [`FEWEST_SAMPLES`] samples are present.
    TooShort {
        /// Number of samples that are present.
        samples: u64,
    },
    /// More than three quarters of the samples are missing.
    Gaps {
        /// Number of samples that are present.
        present: u64,
        /// Number of samples, missing ones included.
        samples: u64,
    },
    /// The requested upper frequency leaves too little of the spectrum.
    MaxFreq {
        /// The requested upper frequency, Hz.
        max_freq_hz: f64,
        /// The lowest upper frequency that this record allows, Hz.
        least_hz: f64,
    },
    /// All samples are the same, or so many of them that parts of the spectrum are empty.
    Constant,
    /// The squares of samples or of differences are out of the range of f64, or no model has a finite likelihood.
    NotFinite,
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { samples } => write!(
                f,
                "{samples} samples are too few for a noise model; {FEWEST_SAMPLES} are needed: record longer"
            ),
            Self::Gaps { present, samples } => write!(
                f,
                "only {present} of {samples} samples are present, and a noise model needs a quarter of them: record \
                 without the losses"
            ),
            Self::MaxFreq { max_freq_hz, least_hz } => write!(
                f,
                "{max_freq_hz} Hz leave too little of the spectrum for a noise model; give {least_hz:.2e} Hz or more, \
                 or record longer"
            ),
            Self::Constant => write!(
                f,
                "the readings do not change enough for a noise model; check the sensor, or record with a finer step"
            ),
            Self::NotFinite => write!(f, "no noise explains these numbers; check the unit and the readings"),
        }
    }
}

impl core::error::Error for FitError {}

impl From<FftError> for FitError {
    /// The transform fails only if the lengths of its buffers do not match.
    fn from(_: FftError) -> Self {
        Self::NotFinite
    }
}

/// Fits a noise model to a record sampled `rate_hz` times per second. The same record always gives the same bits.
///
/// ```
/// use zerorate_allan::{FitOptions, Input, fit};
/// let mut state = 1u64;
/// let mut uniform = || {
///     state = 16_807 * state % 2_147_483_647;
///     state as f64 / 2_147_483_647.0 - 0.5
/// };
/// // white noise of variance 1 at 100 Hz has N = 0.1
/// let rate: Vec<f64> = (0..20_000).map(|_| (0..12).map(|_| uniform()).sum()).collect();
/// let fit = fit(&Input::Rate(&rate), 100.0, &FitOptions::default())?;
/// assert!(fit.n.lo < 0.1 && 0.1 < fit.n.hi && !fit.b.identified && !fit.k.identified);
/// # Ok::<(), zerorate_allan::FitError>(())
/// ```
///
/// # Errors
/// Returns [`FitError`] if samples are too few, do not change or are out of range, or if `max_freq_hz` is too low.
pub fn fit(input: &Input<'_>, rate_hz: f64, options: &FitOptions) -> Result<Fit, FitError> {
    enough(input.len() - input.missing(), input.len())?;
    let mut rate = rates(input, rate_hz, options.scale);
    let present = rate.iter().filter(|value| !value.is_nan()).count();
    enough(present as u64, rate.len() as u64)?;
    check(&rate)?;
    let raw = Raw { record_s: rate.len() as f64 / rate_hz, missing: rate.len() - present };
    let mut warnings = Vec::new();
    let mut cleaned = Cleaning::default();
    if options.cut_glitches {
        let firsts = cut_glitches(&mut rate, &mut warnings);
        cleaned.glitches = firsts.len() as u64;
        cleaned.glitches_s = firsts.into_iter().map(|first| first as f64 / rate_hz).collect();
    }
    let first = selected(&rate, rate_hz, options.max_freq_hz)?;
    let found = if let Some(Period { period_s, k, .. }) = periods::period(&first.1) {
        warnings.push(AllanWarning::PeriodOrWalk { period_s, k });
        first
    } else if options.remove_steps {
        without_steps(&mut rate, rate_hz, first, options.max_freq_hz, &mut cleaned)?
    } else {
        first
    };
    warnings.extend(cleaned.steps.iter().map(|step| AllanWarning::Step { at_s: step.at_s, size: step.size }));
    if !cleaned.put_back.is_empty() {
        warnings.push(AllanWarning::ManySteps { most: MOST_STEPS });
    }
    let mut fit = described(&rate, rate_hz, found, raw, warnings)?;
    if cleaned.glitches > 0 || !cleaned.steps.is_empty() {
        cleaned.rate = Some(rate.into_owned());
    }
    fit.cleaned = cleaned;
    Ok(fit)
}

/// Removes steps and fits the model again, until no step is left. If there are too many steps, all are put back.
fn without_steps(
    rate: &mut Cow<'_, [f64]>,
    rate_hz: f64,
    first: (Spectrum, Selection),
    max_freq_hz: Option<f64>,
    cleaned: &mut Cleaning,
) -> Result<(Spectrum, Selection), FitError> {
    let (mut whole, mut now, mut steps) = (None, first.clone(), Vec::new());
    while let Some(step) = steps::largest(rate, rate_hz, &now)?.filter(|step| libm::fabs(step.score) > STEP_LIMIT) {
        if steps.len() == MOST_STEPS {
            cleaned.put_back = steps;
            *rate = whole.unwrap_or_else(|| rate.clone());
            return Ok(first);
        }
        whole.get_or_insert_with(|| rate.clone());
        rate.to_mut()[step.index..].iter_mut().for_each(|value| *value -= step.size);
        steps.push(Step { at_s: step.index as f64 / rate_hz, size: step.size });
        now = selected(rate, rate_hz, max_freq_hz)?;
    }
    steps.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    cleaned.steps = steps;
    Ok(now)
}

fn selected(rate: &[f64], rate_hz: f64, max_freq_hz: Option<f64>) -> Result<(Spectrum, Selection), FitError> {
    let (spectrum, table) = fitted(rate, rate_hz)?;
    let least_hz = FEWEST_SAMPLES as f64 / (2.0 * table.span_s);
    if let Some(max_freq_hz) = max_freq_hz.filter(|max_freq_hz| *max_freq_hz < least_hz) {
        return Err(FitError::MaxFreq { max_freq_hz, least_hz });
    }
    let priced = |top_hz: f64, price: f64| select::select(table.below(top_hz), price).ok_or(FitError::NotFinite);
    let up_to = |top_hz: f64| priced(top_hz, SHAPE_PRICE);
    // most records show no filter, so cosines cost more in the first try: a false filter makes N a sixth less certain
    let plain_price = libm::log(spectrum.samples as f64);
    let selection = match max_freq_hz {
        Some(max_freq_hz) => up_to(max_freq_hz.min(rate_hz / 2.0))?,
        None => match priced(rate_hz / 2.0, plain_price)? {
            plain if plain.has_plain_form() => plain,
            _ => up_to(band::top_hz(&table))?,
        },
    };
    Ok((spectrum, selection))
}

/// The spectrum, and the part of it that is fitted.
fn fitted(rate: &[f64], rate_hz: f64) -> Result<(Spectrum, Table), FitError> {
    let spectrum = Spectrum::of(rate, rate_hz)?;
    if spectrum.bins.iter().any(|bin| !(bin.power > 0.0 && bin.power.is_finite())) {
        return Err(FitError::Constant);
    }
    let (mask, _) = lines::broad(&spectrum.bins);
    let kept = spectrum.bins.iter().zip(&mask).filter(|(_, masked)| !**masked).map(|(bin, _)| *bin);
    let table = Table::new(kept, &spectrum.low, spectrum.samples, rate_hz);
    Ok((spectrum, table))
}

fn described(
    rate: &[f64],
    rate_hz: f64,
    (spectrum, chosen): (Spectrum, Selection),
    raw: Raw,
    mut warnings: Vec<AllanWarning>,
) -> Result<Fit, FitError> {
    let masked = MaskedBins::of(&spectrum, &chosen, rate_hz);
    let tail_at_zero = masked.tail_at_zero;
    let all = masked.with_narrow(&spectrum.narrow);
    let sines = all.iter().flat_map(|whole| whole.sines.iter().copied()).collect();
    let top_hz = chosen.problem.table.top_hz;
    let lines: Vec<Line> = all.iter().map(|whole| whole.line).filter(|line| line.frequency_hz < top_hz).collect();
    let measured =
        MeasuredSpectrum { rate_hz, record_s: raw.record_s, top_hz, above: spectrum.above(top_hz, rate_hz), sines };
    let model = Model::new(&chosen.found, &measured)?.with_gaps_of(rate);
    let curves = Curves::of(rate, rate_hz);
    let curve = curves.whole();
    // longer averages rest on slow noise alone: there a misfit is only a warning
    let is_short = |found: &&Deviation| found.m as f64 <= rate.len() as f64 / PREDICTS;
    let short: Vec<Deviation> = curve.iter().filter(is_short).copied().collect();
    let off_short = OffCurve::of(&short, &curves, &model);
    let off_curve = OffCurve::of(&curve, &curves, &model).or(off_short);
    let moves = steadiness::motion(rate, rate_hz).or_else(|| steadiness::loud_half(&curves, &model));
    let is_rejected = chosen.problem.error > MOST_ERROR || off_short.is_some() || moves.is_some();
    let misfit = is_rejected.then(|| match moves {
        Some(spread) => Misfit::of_motion(&chosen.problem, spread),
        None => Misfit::of((&chosen.problem, &chosen.found), off_short, (&curves, &model)),
    });
    let coefficients = Coefficients { samples: spectrum.samples, chosen: &chosen, rate_hz, is_rejected };
    let scatter = Scatter::of(&curves, &model);
    let widening = libm::sqrt(scatter.variance_of_ln_n(rate_hz, chosen.found.at[N2], &model));
    let doubt = PredictionError::of((&chosen.problem, &chosen.found), &model, &measured, Some(&scatter))?;
    let (chi2, freedom) = select::chi2(&chosen.problem, &chosen.found);
    let (n, other) = coefficients.n(widening, tail_at_zero);
    let fit = Fit {
        n,
        b: coefficients.of(B2),
        k: coefficients.k(),
        q: chosen.found.form.quantised.then(|| coefficients.of(Q2)),
        r: (chosen.found.form.drift == Some(Drift::Ramp)).then(|| coefficients.ramp()),
        terms: coefficients.terms(&lines),
        model: model.with(doubt),
        model_error: off_short.map_or(0.0, OffCurve::error).max(chosen.problem.error),
        motion_ratio: moves,
        p_value: chi2_above(chi2, freedom),
        is_rejected,
        misfit,
        curve,
        max_freq_hz: top_hz,
        span_s: (1.0 / rate_hz, raw.record_s / 2.0),
        cleaned: Cleaning::default(),
        warnings: Vec::new(),
    };
    let leakage = masked::leakage(&all, &chosen.problem.table.rows, rate_hz / (2.0 * spectrum.samples as f64));
    warnings.extend(leakage.map(|(line, share)| AllanWarning::Leakage { frequency_hz: line.frequency_hz, share }));
    warnings.extend(remarks(&fit, (&chosen, other), &curves, off_curve, raw));
    Ok(Fit { warnings, ..fit })
}
