//! The noise of an axis so far: Allan deviation, spectrum, rate over temperature. The memory is bounded.

use super::axis::{BLOCK_S, Block};
use super::live_view::ReadingObserver;
use super::temperatures::Temperatures;
use crate::message::{AllanPoint, Coefficient, MarkKind, SpectrumMark, SpectrumPoint, Statistics as Shown};
use std::collections::VecDeque;
use zerorate::Axis;
use zerorate_allan::{self as allan, FitOptions, Input, Options, Stream, interval};

/// Number of readings in the spectrum: the last 23 s at the full rate of an ADIS16130.
const SPECTRUM: usize = 1 << 17;
/// Number of octaves of averaging times that are computed from single readings. The page gets the short ones.
const OCTAVES: usize = 16;
/// Number of block means at which adjacent means are merged in pairs.
const MOST_MEANS: usize = 1 << 19;
/// Smallest number of means for which coefficients are reported.
const FEWEST_MEANS: usize = 300;
/// Factor by which the duration grows, and by 1 s at least, until deviations and spectrum are computed again.
const GROWN: f64 = 1.01;
/// Factor by which the duration grows until the noise model is fitted again.
const GROWN_FOR_FIT: f64 = 1.1;

#[derive(Debug)]
pub struct Statistics {
    axis: Axis,
    short: Stream<OCTAVES>,
    stand_in: StandIn,
    recent: VecDeque<f64>,
    means: Means,
    temps: Temperatures,
    /// Time in which the part was not at rest, s.
    moved_s: f64,
    pub shown: Shown,
    fit: Option<allan::Fit>,
    fitted_s: f64,
}

impl ReadingObserver for Vec<Statistics> {
    #[inline]
    fn reading(&mut self, axis: usize, code: Option<i32>) {
        self[axis].push(code);
    }

    fn block(&mut self, axis: usize, block: &Block, at_rest: bool) {
        self[axis].push_block(block, at_rest);
    }
}

impl Statistics {
    pub fn new(axis: &Axis) -> Self {
        Self {
            axis: *axis,
            short: Stream::starting_at(0),
            stand_in: StandIn::default(),
            recent: VecDeque::with_capacity(SPECTRUM),
            means: Means::default(),
            temps: Temperatures::default(),
            moved_s: 0.0,
            shown: Shown::default(),
            fit: None,
            fitted_s: 0.0,
        }
    }

    /// Adds a reading; `None` if it was lost or invalid.
    #[inline]
    pub fn push(&mut self, code: Option<i32>) {
        if let Some(code) = code.or_else(|| self.stand_in.code()) {
            self.short.push(code);
        }
        if let Some(code) = code {
            self.stand_in.push(code);
        }
        if self.recent.len() == SPECTRUM {
            self.recent.pop_front();
        }
        self.recent.push_back(code.map_or(f64::NAN, |code| self.axis.rate.value(code.into())));
    }

    /// Adds a complete block. It enters the rate over temperature only if the part is at rest.
    pub fn push_block(&mut self, block: &Block, at_rest: bool) {
        self.means.push(block.rate_dps);
        match at_rest {
            true => self.temps.push(block),
            false => self.moved_s += BLOCK_S,
        }
    }

    /// Computes the results again if there are enough new readings. Returns true if it computed them.
    pub fn refresh(&mut self, rate_hz: f64) -> bool {
        let duration_s = self.means.duration_s();
        if duration_s < GROWN * self.shown.duration_s || duration_s < self.shown.duration_s + 1.0 {
            return false;
        }
        if self.means.values.len() >= FEWEST_MEANS && duration_s >= GROWN_FOR_FIT * self.fitted_s {
            self.fit = self.fitted();
            self.fitted_s = duration_s;
        }
        let caution = self.caution();
        self.shown = Shown {
            duration_s,
            allan: self.allan(rate_hz),
            coefficients: self.coefficients(caution.as_deref()),
            spectrum: self.spectrum(rate_hz),
            marks: self.marks(rate_hz),
            temperature: self.temps.shown(self.white_dps_per_rt_hz()),
            caution,
        };
        true
    }

    fn fitted(&self) -> Option<allan::Fit> {
        allan::fit(&Input::Rate(&self.means.values), self.means.rate_hz(), &FitOptions::default()).ok()
    }

    /// The deviations: below 0.7 of a mean's length from adjacent averages of readings; above, from overlapping means.
    fn allan(&self, rate_hz: f64) -> Vec<AllanPoint> {
        let scale = 1.0 / self.axis.rate.lsb_per_unit;
        let longest = self.means.length_s();
        let short = (0..OCTAVES).filter_map(|octave| self.short.deviation(octave));
        let short = short.map(|one| (one.m as f64 / rate_hz, scale * one.dev, one.n));
        let mut points: Vec<AllanPoint> = short
            .take_while(|(tau_s, ..)| *tau_s < 0.7 * longest)
            .map(|(tau_s, dev_dps, n)| {
                // adjacent averages of white noise: the degrees of freedom are two thirds of the number of differences
                let (lo_dps, hi_dps) = interval(dev_dps, n as f64 * 2.0 / 3.0, ONE_SIGMA);
                AllanPoint { tau_s, dev_dps, lo_dps, hi_dps, model_dps: None }
            })
            .collect();
        let input = Input::Rate(&self.means.values);
        let analysed = allan::analyse(&input, self.means.rate_hz(), &Options::default());
        let model = |m| self.fit.as_ref().map(|fit| fit.deviation(m));
        points.extend(analysed.iter().flat_map(|analysis| &analysis.points).map(|point| AllanPoint {
            tau_s: point.tau_s,
            dev_dps: point.dev,
            lo_dps: point.lo,
            hi_dps: point.hi,
            model_dps: model(point.m),
        }));
        points
    }

    /// The coefficients of the model. With a `caution`, B and K are not identified: slow noise may be other signals.
    fn coefficients(&self, caution: Option<&str>) -> Vec<Coefficient> {
        let Some(fit) = &self.fit else { return Vec::new() };
        let stated = [
            ("N", "angle random walk", fit.n, "°/√s"),
            ("B", "bias instability", fit.b, "°/s"),
            ("K", "rate random walk", fit.k, "°/s/√s"),
        ];
        let left_s = |needed_s: f64| (needed_s - self.means.duration_s()).max(0.0);
        let stated = stated.map(|(symbol, name, found, unit)| Coefficient {
            symbol: symbol.to_owned(),
            name: name.to_owned(),
            value: found.value,
            lo: found.lo,
            hi: found.hi,
            unit: unit.to_owned(),
            identified: found.identified && (symbol == "N" || caution.is_none()),
            identified_in_s: found.needed_s.filter(|needed_s| needed_s.is_finite()).map(left_s),
        });
        stated.into()
    }

    fn spectrum(&mut self, rate_hz: f64) -> Vec<SpectrumPoint> {
        // the Fourier transform cannot fail, because its buffers have matching lengths
        let density = allan::welch(self.recent.make_contiguous(), rate_hz).unwrap_or_default();
        let one_sided = |density: f64| (2.0 * density).sqrt();
        let point = |one: &allan::Density| SpectrumPoint {
            hz: one.frequency_hz,
            density_dps_per_rt_hz: one_sided(one.density),
        };
        density.iter().map(point).collect()
    }

    /// The bandwidth and the aliased resonance of the part, half of the sample rate, and the lines of the model.
    fn marks(&self, rate_hz: f64) -> Vec<SpectrumMark> {
        let half_hz = rate_hz / 2.0;
        let mark = |hz, kind, text| SpectrumMark { hz, kind, text };
        let bandwidth = self.axis.bandwidth_hz.map(|hz| {
            let aliases = if half_hz < hz { ": samples alias, because their rate is below twice that" } else { "" };
            mark(hz.min(half_hz), MarkKind::Bandwidth, format!("bandwidth {hz:.0} Hz (−3 dB){aliases}"))
        });
        let resonance = self.axis.resonance.map(|tone| {
            let hz = tone.folded_hz(rate_hz);
            let text = format!("the resonance at {:.1} kHz appears at {hz:.1} Hz", tone.hz / 1000.0);
            mark(hz, MarkKind::Resonance, text)
        });
        let nyquist = mark(half_hz, MarkKind::Nyquist, format!("half of the sample rate, {half_hz:.1} Hz"));
        bandwidth.into_iter().chain(resonance).chain([nyquist]).chain(self.lines()).collect()
    }

    /// The spectral lines that the model has removed.
    fn lines(&self) -> impl Iterator<Item = SpectrumMark> + '_ {
        self.fit.iter().flat_map(allan::Fit::lines).map(|line| SpectrumMark {
            hz: line.frequency_hz,
            kind: MarkKind::Line,
            text: format!("a line at {:.3} Hz", line.frequency_hz),
        })
    }

    fn white_dps_per_rt_hz(&self) -> f64 {
        let typical = self.axis.noise.map_or(0.0, |noise| noise.white_dps_per_rt_hz);
        self.fit.as_ref().map_or(typical, |fit| std::f64::consts::SQRT_2 * fit.n.value)
    }

    /// A remark if the deviations contain signals other than noise, or if readings are missing.
    fn caution(&self) -> Option<String> {
        if self.moved_s > 0.0 {
            return Some(format!(
                "the part was not at rest for {:.0} s: this is motion as well as noise. Restart when it is still",
                self.moved_s.ceil()
            ));
        }
        if let Some(fit) = self.fit.as_ref().filter(|fit| fit.is_rejected) {
            let why = match fit.motion_ratio {
                Some(_) => "the sensor moves".to_owned(),
                None => format!("the model is off by {:.0} %", 100.0 * fit.model_error),
            };
            return Some(format!("the rate contains more than noise: {why}"));
        }
        let missing = self.recent.iter().filter(|rate| rate.is_nan()).count() as f64 / self.recent.len().max(1) as f64;
        if missing > MOST_MISSING {
            let percent = 100.0 * missing;
            return Some(format!("{percent:.1} % of the readings are missing: below 0.1 s, the noise is too small"));
        }
        let span_c = self.temps.span_c();
        (span_c > WARMED_C)
            .then(|| format!("the temperature changed by {span_c:.1} °C: long averages show its effect on the bias"))
    }
}

/// The confidence level of the limits of a deviation.
const ONE_SIGMA: f64 = 0.683;
/// Share of missing readings above which there is a remark.
const MOST_MISSING: f64 = 0.001;
/// Change of the temperature above which there is a remark, °C.
const WARMED_C: f64 = 0.5;

/// Means over blocks. When there are too many means, adjacent means are merged in pairs.
#[derive(Debug, Default)]
struct Means {
    values: Vec<f64>,
    doublings: u32,
    pending: Vec<f64>,
}

impl Means {
    fn push(&mut self, rate_dps: f64) {
        self.pending.push(rate_dps);
        if self.pending.len() < 1 << self.doublings {
            return;
        }
        self.values.push(mean(&self.pending));
        self.pending.clear();
        if self.values.len() == MOST_MEANS {
            self.values = self.values.chunks(2).map(mean).collect();
            self.doublings += 1;
        }
    }

    fn length_s(&self) -> f64 {
        BLOCK_S * f64::from(1 << self.doublings)
    }

    fn rate_hz(&self) -> f64 {
        1.0 / self.length_s()
    }

    fn duration_s(&self) -> f64 {
        self.values.len() as f64 * self.length_s()
    }
}

/// The mean of the values; NaN if one of them is NaN.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A substitute for missing readings, so that the readings after a gap keep their time: the running mean of earlier
/// readings.
#[derive(Debug, Default)]
struct StandIn {
    /// The running mean; `None` before the first reading.
    code: Option<f64>,
}

/// The approximate number of readings in the running mean.
const STAND_IN_OVER: f64 = 1000.0;

impl StandIn {
    #[inline]
    fn push(&mut self, code: i32) {
        let code = f64::from(code);
        self.code = Some(self.code.map_or(code, |mean| mean + (code - mean) / STAND_IN_OVER));
    }

    fn code(&self) -> Option<i32> {
        self.code.map(|code| code.round() as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate::Part;

    /// A part whose code is constant has no deviation at all, however many of its readings are missing.
    #[test]
    fn early_missing_readings_make_no_step() {
        let mut statistics = Statistics::new(&Part::ADIS16130.axes[0].axis);
        let constant = |times: usize| std::iter::repeat_n(Some(8_500_000), times);
        let missing = |times: usize| std::iter::repeat_n(None, times);
        let readings = missing(3).chain(constant(2)).chain(missing(40)).chain(constant(200));
        readings.for_each(|code| statistics.push(code));
        assert_eq!(statistics.short.deviation(0).map(|found| found.dev), Some(0.0));
    }
}
