//! The densities of the noise terms.

use super::bins::Bin;
use super::{Corner, Fit, Term};
use alloc::vec::Vec;
use core::f64::consts::PI;

pub(super) const MOST_COSINES: usize = 6;
/// Largest number of coefficients to which a drift is fitted, with their signs.
pub(super) const LOW: usize = 4000;
/// Expected square of the k-th coefficient c_k of the DCT-II for 1/f noise, divided by the density at f_k =
/// k/(2·record length), for k = 1, 2 … (1 for larger k). It is f_k·∫|Φ_k(f)|²/|f| df over all f, where Φ_k is the
/// Fourier transform of the k-th orthonormal cosine.
const FLICKER: [f64; 20] = [
    0.7737, 0.9028, 0.9311, 0.9499, 0.9592, 0.9664, 0.9709, 0.9747, 0.9774, 0.9798, 0.9815, 0.9831, 0.9844, 0.9855,
    0.9865, 0.9873, 0.9881, 0.9887, 0.9893, 0.9899,
];

/// The bins that are fitted, with everything that does not depend on the parameters.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) rate_hz: f64,
    /// The upper end of the band shape, Hz.
    pub(super) top_hz: f64,
    /// Length of the record, s.
    pub(super) span_s: f64,
    pub(super) rows: Vec<BinRow>,
    /// The first coefficients of the record times √dt, with their signs.
    pub(super) low: Vec<f64>,
}

/// A bin, with the density of each noise term for a coefficient of 1.
#[derive(Clone, Debug)]
pub(super) struct BinRow {
    pub(super) bin: Bin,
    /// Length of the bin's record, s.
    span_s: f64,
    /// Middle and ends of the bin, Hz.
    pub(super) f_hz: f64,
    from_hz: f64,
    to_hz: f64,
    pub(super) walk: f64,
    pub(super) flicker: f64,
    pub(super) quantisation: f64,
    pub(super) cosines: [f64; MOST_COSINES],
}

impl Table {
    /// The band shape ends at half the sample rate.
    pub(super) fn new(bins: impl Iterator<Item = Bin>, low: &[f64], samples: usize, rate_hz: f64) -> Self {
        let span_s = samples as f64 / rate_hz;
        let rows = bins.map(|bin| BinRow::new(bin, span_s, rate_hz)).collect();
        Self { rate_hz, top_hz: rate_hz / 2.0, span_s, rows, low: low[..low.len().min(LOW)].to_vec() }
    }

    /// The same rows with a shape that ends at `top_hz` and is constant above.
    pub(super) fn with_top(mut self, top_hz: f64) -> Self {
        self.top_hz = top_hz;
        for row in &mut self.rows {
            row.cosines = cosines(shape_angle(row.f_hz, self.rate_hz, top_hz));
        }
        self
    }

    /// The rows up to `top_hz`, where their shape ends.
    pub(super) fn below(&self, top_hz: f64) -> Self {
        let rows = self.rows.iter().filter(|row| is_below(row.to_hz, top_hz)).cloned().collect();
        Self { rows, low: self.low.clone(), ..*self }.with_top(top_hz)
    }

    /// Whether part of the spectrum is left out at its upper end.
    pub(super) fn is_cut(&self) -> bool {
        !is_below(self.rate_hz / 2.0, self.top_hz)
    }

    /// Joins the rows of several records, in order of frequency. No drift can be fitted to the result.
    pub(super) fn pooled(tables: &[&Self]) -> Self {
        let mut rows: Vec<BinRow> = tables.iter().flat_map(|table| table.rows.iter().cloned()).collect();
        rows.sort_by(|a, b| a.f_hz.total_cmp(&b.f_hz));
        let span_s = tables.iter().map(|table| table.span_s).fold(0.0, f64::max);
        let rate_hz = tables.iter().map(|table| table.rate_hz).sum::<f64>() / tables.len().max(1) as f64;
        let top_hz = tables.iter().map(|table| table.top_hz).fold(rate_hz / 2.0, f64::min);
        Self { rate_hz, top_hz, span_s, rows, low: Vec::new() }
    }

    /// The number of leading rows whose coefficients are known with their signs: a drift is fitted in them.
    pub(super) fn signed(&self) -> usize {
        self.rows.iter().take_while(|row| row.bin.end <= self.low.len() + 1).count()
    }

    /// The number of leading rows with one coefficient each.
    pub(super) fn singles(&self) -> usize {
        self.rows.iter().take_while(|row| row.bin.is_single() && row.bin.first <= self.low.len()).count()
    }
}

/// Whether a bin that ends at `to_hz` is below `top_hz`. The last bin may end a little above half the rate.
pub(super) fn is_below(to_hz: f64, top_hz: f64) -> bool {
    to_hz <= 1.0001 * top_hz
}

/// The angle θ of the shape's cosines, with sin²(θ/2) = sin²(πf·dt)/sin²(π`top_hz`·dt), and π from `top_hz` on. If the
/// shape ends at half the rate, θ is 2πf·dt.
pub(super) fn shape_angle(f_hz: f64, rate_hz: f64, top_hz: f64) -> f64 {
    let ratio = libm::sin(PI * f_hz / rate_hz) / libm::sin(PI * top_hz / rate_hz);
    2.0 * libm::asin(if f_hz < top_hz { ratio.min(1.0) } else { 1.0 })
}

/// cos jθ − 1 for j = 1, 2 …, by which the coefficients of the band shape are multiplied.
fn cosines(angle: f64) -> [f64; MOST_COSINES] {
    core::array::from_fn(|j| libm::cos((j + 1) as f64 * angle) - 1.0)
}

impl BinRow {
    fn new(bin: Bin, span_s: f64, rate_hz: f64) -> Self {
        let hz = 1.0 / (2.0 * span_s);
        let (from_hz, to_hz) = ((bin.first as f64 - 0.5) * hz, (bin.end as f64 - 0.5) * hz);
        let f_hz = bin.middle() * hz;
        let half_angle = PI * f_hz / rate_hz;
        let sin = libm::sin(half_angle);
        let (walk, flicker) = match bin.is_single() {
            true => (1.0 / (f_hz * f_hz), FLICKER.get(bin.first - 1).unwrap_or(&1.0) / f_hz),
            false => (1.0 / (from_hz * to_hz), libm::log(to_hz / from_hz) / (to_hz - from_hz)),
        };
        let sampled = half_angle / sin;
        Self {
            bin,
            span_s,
            f_hz,
            from_hz,
            to_hz,
            walk: walk / (4.0 * PI * PI) * sampled * sampled,
            flicker: flicker / (2.0 * PI),
            quantisation: 4.0 * sin * sin * rate_hz * rate_hz,
            cosines: cosines(2.0 * half_angle),
        }
    }

    /// The width of the part of the bin above a frequency, Hz.
    pub(super) fn width_above(&self, f_hz: f64) -> f64 {
        (self.to_hz - self.from_hz.max(f_hz)).max(0.0)
    }

    /// A Gauss–Markov process of variance 1 and correlation time `tau_s`: its density and the slope by ln `tau_s`.
    /// Both are exact for a single coefficient, otherwise means over the bin.
    pub(super) fn gauss_markov(&self, tau_s: f64) -> (f64, f64) {
        let span_s = self.span_s;
        if self.bin.is_single() {
            let w = 2.0 * PI * self.f_hz * tau_s;
            let lorentz = 1.0 + w * w;
            let (a, slope) = (2.0 * tau_s / lorentz, 2.0 * tau_s * (1.0 - w * w) / (lorentz * lorentz));
            let sign = if self.bin.first.is_multiple_of(2) { 1.0 } else { -1.0 };
            let rest = sign * libm::exp(-span_s / tau_s);
            let end = 1.0 - rest;
            let end_slope = -rest * span_s / tau_s;
            return (
                a * (1.0 - end * a / span_s),
                slope * (1.0 - 2.0 * end * a / span_s) - end_slope * a * a / span_s,
            );
        }
        let (w0, w1) = (2.0 * PI * self.from_hz * tau_s, 2.0 * PI * self.to_hz * tau_s);
        let per_width = 1.0 / (PI * (self.to_hz - self.from_hz));
        // atan(w1) − atan(w0) without the difference of two numbers near π/2
        let wide = per_width * libm::atan((w1 - w0) / (1.0 + w0 * w1));
        let slope = per_width * (w1 / (1.0 + w1 * w1) - w0 / (1.0 + w0 * w0));
        (wide * (1.0 - wide / span_s), slope * (1.0 - 2.0 * wide / span_s))
    }
}

impl Fit {
    /// The two-sided density of the model at a frequency, unit²/Hz, for a record sampled `rate_hz` times per second.
    /// Lines, ramp and warm-up are not included. The density is valid up to `max_freq_hz`.
    #[must_use]
    pub fn density(&self, frequency_hz: f64, rate_hz: f64) -> f64 {
        let omega = 2.0 * PI * frequency_hz;
        let half = PI * frequency_hz / rate_hz;
        let sinc = half / libm::sin(half);
        let square = |x: f64| x * x;
        let of_term = |term: &Term| match term {
            Term::GaussMarkov { sigma, tau_s } => {
                2.0 * square(sigma.value) * tau_s.value / (1.0 + square(omega * tau_s.value))
            }
            _ => 0.0,
        };
        let shape = |term: &Term| match term {
            Term::BandShape { cosines, pole, corner, .. } => {
                let angle = shape_angle(frequency_hz, rate_hz, self.max_freq_hz);
                let cosine = |(j, a): (usize, &f64)| a * (libm::cos((j + 1) as f64 * angle) - 1.0);
                let low_pass = |p: f64| square(1.0 - p) / (1.0 + p * p - 2.0 * p * libm::cos(angle));
                let second_order = |corner: Corner| {
                    let x = square(libm::sin(half) / libm::sin(PI * corner.frequency_hz / rate_hz));
                    1.0 / (1.0 + corner.damping * x + x * x)
                };
                libm::exp(cosines.iter().enumerate().map(cosine).sum())
                    * pole.map_or(1.0, low_pass)
                    * corner.map_or(1.0, second_order)
            }
            _ => 1.0,
        };
        let slow = square(self.b.value) / omega
            + square(self.k.value * sinc / omega)
            + self.terms.iter().map(of_term).sum::<f64>();
        let of_all = |term: &&Term| !matches!(term, Term::BandShape { of_white: true, .. });
        square(self.n.value) * self.terms.iter().map(shape).product::<f64>()
            + slow * self.terms.iter().filter(of_all).map(shape).product::<f64>()
            + self.q.as_ref().map_or(0.0, |q| square(2.0 * q.value * rate_hz * libm::sin(half)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::bins::{Bin, Response};
    use super::*;

    fn bin(first: usize, end: usize) -> Bin {
        Bin { first, end, freedom: (end - first) as f64, power: 1.0, response: Response::WHOLE }
    }

    /// The exact variance of a coefficient is a sum over the covariance matrix e^(−|i−j|·dt/`tau_s`).
    #[test]
    fn gauss_markov_is_exact_for_a_coefficient() {
        let (n, rate_hz, tau_s) = (400usize, 10.0, 8.0);
        for k in [1usize, 2, 5] {
            let w = |i: usize| (2.0 / n as f64).sqrt() * (PI * (k * (2 * i + 1)) as f64 / (2 * n) as f64).cos();
            let correlation = |i: usize, j: usize| (-(i.abs_diff(j) as f64) / rate_hz / tau_s).exp();
            let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let exact: f64 = pairs.map(|(i, j)| w(i) * w(j) * correlation(i, j)).sum::<f64>() / rate_hz;
            let row = BinRow::new(bin(k, k + 1), n as f64 / rate_hz, rate_hz);
            let (found, slope) = row.gauss_markov(tau_s);
            assert!((found / exact - 1.0).abs() < 2e-3, "{k}: {found} for {exact}");
            let beside = row.gauss_markov(tau_s * 1e-4f64.exp()).0;
            assert!(((beside - found) / 1e-4 - slope).abs() < 1e-3 * found, "{k}: slope {slope}");
        }
    }

    #[test]
    fn wide_bins_are_means_over_their_coefficients() {
        let (span_s, rate_hz) = (100.0, 100.0);
        let wide = BinRow::new(bin(200, 240), span_s, rate_hz);
        let singles: Vec<BinRow> = (200..240).map(|k| BinRow::new(bin(k, k + 1), span_s, rate_hz)).collect();
        let mean = |of: &dyn Fn(&BinRow) -> f64| singles.iter().map(of).sum::<f64>() / 40.0;
        assert!((wide.walk / mean(&|row| row.walk) - 1.0).abs() < 1e-4);
        assert!((wide.flicker / mean(&|row| row.flicker) - 1.0).abs() < 1e-4);
        let of = |row: &BinRow| row.gauss_markov(0.3).0;
        assert!((of(&wide) / mean(&of) - 1.0).abs() < 1e-4);
    }
}
