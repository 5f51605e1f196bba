//! The power law that dominates at an averaging time.

use super::kernel::Reason;
use super::kernels::{Deviation, deviations};
use super::lag1::Lag1;
use super::phase_points::{Run, for_each_run, phase_points, ramp};
use super::stat::StatRow;
use super::{Input, Stat};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::f64::consts::PI;
use core::ops::Range;

/// Least number of averages of τ for the lag-1 autocorrelation.
const FOR_LAG1: u64 = 30;
/// Number of averages of τ with which the lag-1 autocorrelation mistakes white noise for phase noise in only 1 of 100
/// records; with 40 averages, in 1 of 10.
const FOR_CERTAIN: u64 = 128;
/// Number of averages of τ beyond which the answer is certain enough (r1 to 0.004). With more, only evenly spaced
/// blocks of the record are used.
const ENOUGH: u64 = 1 << 16;
/// Longest averaging length at which a block has enough points to represent its part of the record.
const LONGEST_SPARSE: u64 = 64;
/// A series with this δ = r1/(1 + r1) or more is not stationary and is differenced once more.
const NOT_STATIONARY: f64 = 0.25;
const WHITE: i32 = 0;

/// The exponent α of the power law S_y(f) ∝ f^α that dominates at each averaging length in `m`. 2 is white phase, 1
/// flicker phase, 0 white (angle random walk), −1 flicker (bias instability), −2 random walk of the rate. For HDEV and
/// OHDEV, the exponent goes down to −4. Returns one exponent per length. `m` must ascend.
///
/// * At least 30 averages: lag-1 autocorrelation r1 of the phase at every m-th point, δ = r1/(1 + r1). The phase is
///   differenced d times until δ < 0.25 or d is the order of the statistic's differences, then `α = 2 − 2d −
///   round(2δ)`. (Riley & Greenhall, "Power law noise identification using the lag 1 autocorrelation", EFTF 2004, and
///   NIST SP 1065 section 5.5.3. In r1, the sum of products is divided by n, and the variance has n − 1.) Above 65 536
///   averages of up to 64 samples, only evenly spaced blocks of the record are used.
/// * Fewer, at least 8 (for ADEV and HDEV 10): B1, the ratio of the variance of the averages to their Allan variance.
///   B1 is compared with the geometric means of its expected values for two neighbouring α (section 5.5.4). If the
///   answer is phase noise, R(n), the ratio of modified to plain Allan variance, tells white from flicker (5.5.5).
/// * Fewer still: the answer of the next shorter length, or of the longest length with 8 (10) averages if there is
///   none. TOTDEV then counts phase noise as white, because it has published degrees of freedom for frequency noise
///   only. A constant record counts as white.
///
/// Of a rate, only the mean is removed. Missing samples count as the mean rate, and a missing phase is interpolated.
#[must_use]
pub fn noise_types(input: &Input<'_>, stat: Stat, m: &[u64]) -> Vec<i32> {
    identify(input, stat, m).into_iter().map(|found| found.alpha).collect()
}

/// The noise at one averaging length.
pub(crate) struct NoiseType {
    /// The exponent that [`noise_types`] returns.
    pub alpha: i32,
    /// The exponent for the degrees of freedom. With few averages, white noise is too often mistaken for phase noise
    /// (by B1 with 10: in 28 % of the records), and phase noise has as many degrees of freedom as samples. So this
    /// exponent is at most the last answer from 128 averages or more, because the dominant exponent falls with τ. In a
    /// shorter record it is at most the first answer from 30 averages or more, or 0 without one.
    pub cautious: i32,
}

pub(crate) fn identify(input: &Input<'_>, stat: Stat, m: &[u64]) -> Vec<NoiseType> {
    let points = phase_points(input);
    let averages = |m: u64| points.saturating_sub(1) / m.max(1);
    let lead = |fewest: u64| {
        let longest = points.saturating_sub(1) / fewest;
        (longest > 0 && m.first().is_some_and(|&first| averages(first) < fewest)).then_some(longest)
    };
    let row = stat.row();
    let leads: Vec<u64> = [FOR_LAG1, row.fewest_averages].into_iter().filter_map(lead).collect();
    let lengths: Vec<u64> = leads.iter().chain(m).copied().collect();
    let decimated = decimate(input, &lengths, averages);
    let found: Vec<Option<i32>> = decimated.iter().map(|series| series.identify(row, averages(series.m))).collect();
    let phase_noise = resolve_phase_noise(input, &decimated, &found);
    let (mut last, mut certain) = (WHITE, None);
    let all = found.iter().zip(phase_noise).zip(&lengths).map(|((&found, phase_noise), &m)| {
        last = match phase_noise.or(found) {
            Some(alpha) => alpha,
            None if averages(m) < row.fewest_averages => last.min(row.carried_alpha),
            None => last,
        };
        if averages(m) >= FOR_CERTAIN || (certain.is_none() && averages(m) >= FOR_LAG1) {
            certain = Some(last);
        }
        NoiseType { alpha: last, cautious: last.min(certain.unwrap_or(WHITE)) }
    });
    all.skip(leads.len()).collect()
}

/// The phase at every m-th point.
struct DecimatedPhase {
    m: u64,
    next: u64,
    series: Series,
    /// Every `sparse`-th run is used.
    sparse: u64,
}

enum Series {
    Long(Box<Lag1>),
    Short(Short),
}

#[derive(Default)]
struct Short {
    phase: Vec<f64>,
    /// Sum of all points of the record before each point of `phase`.
    area: Vec<f64>,
}

struct Stretch<'a> {
    run: Run<'a>,
    span: Range<u64>,
    number: u64,
    area: f64,
}

fn decimate(input: &Input<'_>, lengths: &[u64], averages: impl Fn(u64) -> u64) -> Vec<DecimatedPhase> {
    let ramp = ramp(input);
    let new = |&m: &u64| DecimatedPhase {
        m: m.max(1),
        next: 0,
        sparse: if m <= LONGEST_SPARSE { averages(m).div_ceil(ENOUGH).max(1) } else { 1 },
        series: match averages(m) >= FOR_LAG1 {
            true => Series::Long(Box::new(Lag1::new(ramp * m as f64))),
            false => Series::Short(Short::default()),
        },
    };
    let mut all: Vec<DecimatedPhase> = lengths.iter().map(new).collect();
    let (mut start, mut number, mut area) = (0u64, 0u64, 0.0);
    for_each_run(input, |run| {
        let (count, sum) = match run {
            Run::Points(points) => (points.len() as u64, sum(points)),
            Run::Level { value, count } => (count, value * count as f64),
        };
        let stretch = Stretch { run, span: start..start.saturating_add(count), number, area };
        all.iter_mut().for_each(|decimated| decimated.take(&stretch));
        (start, number, area) = (stretch.span.end, number + 1, area + sum);
    });
    all
}

impl DecimatedPhase {
    fn take(&mut self, stretch: &Stretch<'_>) {
        let Stretch { run, span, number, area } = stretch;
        if span.end <= self.next {
            return;
        }
        let picked = (span.end - self.next).div_ceil(self.m);
        let at =
            (self.next - span.start..span.end - span.start).step_by(usize::try_from(self.m).unwrap_or(usize::MAX));
        self.next = self.next.saturating_add(picked.saturating_mul(self.m));
        match (&mut self.series, run) {
            (Series::Short(short), Run::Points(points)) => at.for_each(|at| {
                short.phase.push(points[at as usize]);
                short.area.push(area + sum(&points[..at as usize]));
            }),
            (Series::Short(short), Run::Level { value, .. }) => at.for_each(|at| {
                short.phase.push(*value);
                short.area.push(area + value * at as f64);
            }),
            (Series::Long(lag1), _) if !number.is_multiple_of(self.sparse) => lag1.cut(),
            (Series::Long(lag1), Run::Points(points)) => at.for_each(|at| lag1.push(points[at as usize])),
            (Series::Long(lag1), Run::Level { value, .. }) => lag1.push_level(*value, picked),
        }
    }

    fn identify(&self, row: &StatRow, averages: u64) -> Option<i32> {
        match &self.series {
            Series::Long(lag1) => by_lag1(lag1, row),
            Series::Short(short) if averages >= row.fewest_averages => by_b1(&short.phase),
            Series::Short(_) => None,
        }
    }
}

fn by_lag1(lag1: &Lag1, row: &StatRow) -> Option<i32> {
    let deepest = row.kernel.difference().order as usize;
    for order in 0..=deepest {
        let r1 = lag1.correlation(order)?;
        let delta = r1 / (1.0 + r1);
        if delta < NOT_STATIONARY || order == deepest {
            let alpha = 2 - 2 * order as i32 - libm::round(2.0 * delta) as i32;
            return Some(alpha.clamp(2 - 2 * deepest as i32, 2));
        }
    }
    None
}

fn by_b1(phase: &[f64]) -> Option<i32> {
    if phase.len() < 3 {
        return None;
    }
    let (variance, allan) = (variance_of_averages(phase), allan_variance(phase));
    let n = phase.len() as f64 - 1.0;
    let boundary = |mu: i32| libm::sqrt(expected_b1(n, mu) * expected_b1(n, mu + 1));
    let b1 = variance / allan;
    (allan > 0.0 && b1.is_finite()).then(|| match b1 {
        _ if b1 < boundary(-2) => 1,
        _ if b1 < boundary(-1) => 0,
        _ if b1 < boundary(0) => -1,
        _ => -2,
    })
}

/// The variance of the averages over τ, times τ².
fn variance_of_averages(phase: &[f64]) -> f64 {
    let n = phase.len() as f64 - 1.0;
    let mean = (phase[phase.len() - 1] - phase[0]) / n;
    phase.windows(2).map(|x| (x[1] - x[0] - mean) * (x[1] - x[0] - mean)).sum::<f64>() / (n - 1.0)
}

fn allan_variance(phase: &[f64]) -> f64 {
    let second = phase.windows(3).map(|x| (x[2] - x[1]) - (x[1] - x[0]));
    second.map(|d| d * d).sum::<f64>() / (2.0 * (phase.len() as f64 - 2.0))
}

/// Expected ratio of the variance of `n` averages to their Allan variance if the latter goes as τ^`mu` (Barnes; Howe,
/// "The total deviation approach to long-term characterization of frequency stability", 2000, table 3).
fn expected_b1(n: f64, mu: i32) -> f64 {
    match mu {
        1 => n / 2.0,
        0 => n * libm::log2(n) / (2.0 * (n - 1.0)),
        -1 => 1.0,
        _ => (n + 1.0) / (1.5 * n),
    }
}

/// Sums with a fixed number of partial sums, which is fast and rounds alike on every machine.
fn sum(points: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (chunks, rest) = points.as_chunks::<8>();
    for chunk in chunks {
        lanes.iter_mut().zip(chunk).for_each(|(lane, point)| *lane += point);
    }
    lanes.iter_mut().zip(rest).for_each(|(lane, point)| *lane += point);
    lanes.iter().sum()
}

/// Tests by R(n) whether phase noise that B1 found is white; if so, `Some(2)`.
fn resolve_phase_noise(input: &Input<'_>, all: &[DecimatedPhase], found: &[Option<i32>]) -> Vec<Option<i32>> {
    let question = |(series, alpha): (&DecimatedPhase, &Option<i32>)| match &series.series {
        Series::Short(short) if *alpha == Some(1) => {
            let in_doubt = short.r_at_a_glance(series.m as f64) < 10.0 * r_boundary(series.m as f64);
            in_doubt.then(|| (series.m, allan_variance(&short.phase)))
        }
        _ => None,
    };
    let questions: Vec<(u64, f64)> = all.iter().zip(found).filter_map(question).collect();
    let lengths: Vec<u64> = questions.iter().map(|question| question.0).collect();
    let answers = deviations(input, 1.0, Stat::Mdev, &lengths);
    let is_white = |((m, allan), modified): (&(u64, f64), Result<Deviation, Reason>)| {
        let modified = modified.ok()?.dev * *m as f64;
        (modified * modified / allan < r_boundary(*m as f64)).then_some(*m)
    };
    let white: Vec<u64> = questions.iter().zip(answers).filter_map(is_white).collect();
    all.iter().map(|series| white.contains(&series.m).then_some(2)).collect()
}

impl Short {
    /// A rough R(n) from modified terms that do not overlap, without another pass over the record. It often suffices.
    fn r_at_a_glance(&self, m: f64) -> f64 {
        let averages: Vec<f64> = self.area.windows(2).map(|area| (area[1] - area[0]) / m).collect();
        allan_variance(&averages) / allan_variance(&self.phase)
    }
}

/// Geometric mean of the R(n) expected for white and for flicker phase noise, with a noise bandwidth of half the
/// sample rate (IEEE Std 1139-2008 table B.2). The expected values are 1/m and 3 ln(256/27) / 2(1.038 + 3 ln(π m)).
fn r_boundary(m: f64) -> f64 {
    let flicker = 3.0 * libm::log(256.0 / 27.0) / (2.0 * (1.038 + 3.0 * libm::log(PI * m)));
    libm::sqrt(flicker / m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Gap;
    use crate::kernels::tests::white;
    use alloc::vec;

    const SEED: u64 = 1_234_567_890;

    fn integral(series: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        let sums = series.iter().map(|value| {
            sum += value;
            sum
        });
        sums.collect()
    }

    const OCTAVES: [u64; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

    #[test]
    fn pure_noises_are_identified() {
        let white = white(SEED, 20_000);
        let walk = integral(&white);
        let run = integral(&walk);
        for stat in Stat::ALL {
            assert_eq!(noise_types(&Input::Phase(&white), stat, &OCTAVES), [2; 8], "{stat}");
            assert_eq!(noise_types(&Input::Rate(&white), stat, &OCTAVES), [0; 8], "{stat}");
            assert_eq!(noise_types(&Input::Phase(&walk), stat, &OCTAVES), [0; 8], "{stat}");
            assert_eq!(noise_types(&Input::Rate(&walk), stat, &OCTAVES), [-2; 8], "{stat}");
        }
        assert_eq!(noise_types(&Input::Rate(&run), Stat::Ohdev, &OCTAVES), [-4; 8]);
        assert_eq!(noise_types(&Input::Rate(&run), Stat::Oadev, &OCTAVES), [-2; 8]);
    }

    /// With 20 averages, the answer is right for at least 60 of 100 records.
    #[test]
    fn short_records_go_by_b1_and_r() {
        let right = |of: &dyn Fn(&[f64]) -> i32, truth: i32| {
            let white = white(SEED, 100 * 400);
            white.chunks(400).filter(|part| of(part) == truth).count()
        };
        let at = [20];
        let rate = |part: &[f64]| noise_types(&Input::Rate(part), Stat::Oadev, &at)[0];
        assert!(right(&rate, 0) >= 60);
        assert!(right(&|part| rate(&integral(part)), -2) >= 60);
        assert!(right(&|part| noise_types(&Input::Phase(part), Stat::Oadev, &at)[0], 2) >= 60);
    }

    #[test]
    fn scale_offset_and_direction_do_not_matter() {
        let white = white(SEED, 5_000);
        let mixed: Vec<f64> = white.iter().zip(integral(&white)).map(|(white, walk)| white + 0.02 * walk).collect();
        let lengths: Vec<u64> = (1..700).collect();
        let types = |rate: &[f64]| noise_types(&Input::Rate(rate), Stat::Oadev, &lengths);
        let expected = types(&mixed);
        assert!(expected.contains(&0) && expected.contains(&-2));
        assert_eq!(types(&mixed.iter().map(|rate| 1e-3 * rate).collect::<Vec<_>>()), expected);
        assert_eq!(types(&mixed.iter().map(|rate| rate + 1e6).collect::<Vec<_>>()), expected);
        assert_eq!(types(&mixed.iter().map(|rate| -rate).collect::<Vec<_>>()), expected);
    }

    #[test]
    fn codes_are_a_rate_and_gaps_do_not_shift_it() {
        let codes: Vec<i32> = white(SEED, 6_000).iter().map(|value| (value * 1000.0) as i32).collect();
        let rate: Vec<f64> = codes.iter().map(|&code| f64::from(code)).collect();
        let codes_input = Input::Codes { codes: &codes, gaps: &[] };
        assert_eq!(
            noise_types(&codes_input, Stat::Mdev, &OCTAVES),
            noise_types(&Input::Rate(&rate), Stat::Mdev, &OCTAVES)
        );
        let gaps = [Gap { at: 1000, missing: 500 }, Gap { at: 4000, missing: 1 << 40 }];
        let types = noise_types(&Input::Codes { codes: &codes, gaps: &gaps }, Stat::Oadev, &OCTAVES[..5]);
        assert_eq!(types, [0; 5]);
    }

    #[test]
    fn there_is_an_answer_without_evidence() {
        for input in [
            Input::Rate(&[]),
            Input::Rate(&[1.0; 100]),
            Input::Phase(&[f64::NAN; 50]),
            Input::Rate(&[f64::INFINITY; 50]),
        ] {
            assert_eq!(noise_types(&input, Stat::Oadev, &[1, 4, 40]), [0; 3]);
        }
        assert_eq!(noise_types(&Input::Rate(&[1.0, 2.0]), Stat::Totdev, &[0, 1]), vec![0; 2]);
        assert_eq!(noise_types(&Input::Rate(&[1.0, 2.0]), Stat::Totdev, &[]), vec![0; 0]);
    }

    /// With 40 averages, white noise is taken for phase noise in one of ten records. At most 4 of 200 records get the
    /// degrees of freedom of phase noise.
    #[test]
    fn few_averages_do_not_make_degrees_of_freedom() {
        let white = white(SEED, 200 * 5_000);
        let lengths = [32, 122];
        let at_41: Vec<NoiseType> =
            white.chunks(5_000).filter_map(|part| identify(&Input::Rate(part), Stat::Oadev, &lengths).pop()).collect();
        assert!(at_41.iter().any(|found| found.alpha > 0));
        assert!(at_41.iter().filter(|found| found.cautious > 0).count() <= 4);
    }

    /// A long averaging time alone has no shorter one before it. It gets the answer for the longest identifiable time.
    #[test]
    fn a_lone_long_time_is_identified() {
        let walk = integral(&white(SEED, 1_000));
        assert_eq!(
            noise_types(&Input::Rate(&walk), Stat::Oadev, &[400]),
            noise_types(&Input::Rate(&walk), Stat::Oadev, &[125, 400])[1..]
        );
    }
}
