//! The rate channel's fast noise (white through two poles, the resonance) and its slow one (flicker, random walk).

use crate::facts;
use crate::normal::{Layers, Normal, Process};
use crate::spec::{Roa, Spec};
use alloc::rc::Rc;
use alloc::vec::Vec;
use core::f64::consts::{LN_2, PI};

/// White noise through the two poles of F-03 (or F-04), with the exact statistics at any sampling instants.
///
/// Unit white noise dW and the poles w₁, w₂ [rad/s] drive two modes by the *same* noise: da = −w₁·a·dt + dW and db =
/// −w₂·b·dt + dW. The output is y = N/√2 · w₁·w₂/(w₂ − w₁) · (a − b). This is the response of 1/((1 + s/w₁)(1 + s/w₂))
/// to noise of one-sided density N. Over a step h the pair takes normal increments with covariance Q(v, w) = (1 −
/// e^(−(v + w)h))/(v + w), which is exact for every h.
pub(crate) struct White {
    w: [f64; 2],
    gain: f64,
    mode: [f64; 2],
    step: Step,
    last_ps: u64,
    normal: Normal,
}

/// For a step of `h_ps`: the decay of each mode, and the Cholesky factor of the covariance of the increments.
#[derive(Copy, Clone)]
struct Step {
    h_ps: u64,
    decay: [f64; 2],
    l11: f64,
    l21: f64,
    l22: f64,
}

impl White {
    pub(crate) fn new(spec: &Spec, layers: &Rc<Layers>) -> Self {
        let lower = match spec.roa {
            Roa::Open => facts::POLE_HZ,
            Roa::TenNanofarad => facts::POLE_ROA_10NF_HZ,
        };
        let w = [2.0 * PI * lower, 2.0 * PI * facts::UPPER_POLE_HZ];
        let mut white = Self {
            w,
            gain: spec.white_dps_per_rt_hz / libm::sqrt(2.0) * w[0] * w[1] / (w[1] - w[0]),
            mode: [0.0; 2],
            step: Step::over(w, u64::MAX),
            last_ps: 0,
            normal: Normal::with_layers(spec.seed, Process::Rate, layers),
        };
        white.advance(); // an infinite step draws from the stationary distribution
        white
    }

    /// The noise at `t_ps`, in °/s.
    #[inline]
    pub(crate) fn at(&mut self, t_ps: u64) -> f64 {
        let h_ps = t_ps - self.last_ps;
        self.last_ps = t_ps;
        if h_ps != self.step.h_ps {
            self.step = Step::over(self.w, h_ps);
        }
        self.advance();
        self.gain * (self.mode[0] - self.mode[1])
    }

    #[inline]
    fn advance(&mut self) {
        let step = &self.step;
        let (n1, n2) = (self.normal.sample(), self.normal.sample());
        self.mode[0] = step.decay[0] * self.mode[0] + step.l11 * n1;
        self.mode[1] = step.decay[1] * self.mode[1] + step.l21 * n1 + step.l22 * n2;
    }
}

impl Step {
    #[cold]
    fn over(w: [f64; 2], h_ps: u64) -> Self {
        let h = h_ps as f64 * 1e-12;
        let q = |rate: f64| -libm::expm1(-rate * h) / rate;
        let l11 = libm::sqrt(q(2.0 * w[0]));
        let l21 = if l11 > 0.0 { q(w[0] + w[1]) / l11 } else { 0.0 };
        Self {
            h_ps,
            decay: w.map(|w| libm::exp(-w * h)),
            l11,
            l21,
            l22: libm::sqrt((q(2.0 * w[1]) - l21 * l21).max(0.0)),
        }
    }
}

/// The mechanical resonance as a pure tone (F-07, M-08), sampled at any instant.
pub(crate) struct Resonance {
    peak_dps: f64,
    /// Frequency in 2⁻⁶⁴ turns per ps. The wrapping product with the time in ps is the phase, without rounding.
    turns_per_ps: u64,
}

impl Resonance {
    pub(crate) fn new(spec: &Spec) -> Self {
        Self {
            peak_dps: spec.resonance_dps_rms * libm::sqrt(2.0),
            turns_per_ps: (spec.resonance_hz * 1e-12 * 18_446_744_073_709_551_616.0) as u64,
        }
    }

    /// The tone at `t_ps`, in °/s.
    #[inline]
    pub(crate) fn at(&self, t_ps: u64) -> f64 {
        self.peak_dps * sine(t_ps.wrapping_mul(self.turns_per_ps))
    }
}

/// sin(2π·phase/2⁶⁴) to within 4·10⁻⁶: the Taylor polynomial of degree 9 over ±π/2.
#[inline]
fn sine(phase: u64) -> f64 {
    // As a signed number the phase is within ±½ turn. A reflection about a quarter turn brings it within ±¼ turn.
    let signed = phase as i64;
    let folded = if (phase.wrapping_add(1 << 62) as i64) < 0 { i64::MIN.wrapping_sub(signed) } else { signed };
    let x = folded as f64 * (2.0 * PI / 18_446_744_073_709_551_616.0);
    let q = x * x;
    x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0))))
}

const FLICKER_TOP_HZ: f64 = 10.0;

/// Flicker with one-sided density S(f) = B²/(π·f) between `flicker_hz` and 10 Hz. Below this band S is flat, and above
/// it S falls as 1/f².
///
/// It is a sum of Ornstein-Uhlenbeck processes. The band is cut into cells of equal ratio r ≤ 2. Each cell has one
/// process, whose corner is at the cell's geometric centre and whose variance is (B²/π)·ln r. The processes start from
/// their stationary distribution.
pub(crate) struct Flicker {
    parts: Vec<OrnsteinUhlenbeck>,
    normal: Normal,
}

impl Flicker {
    pub(crate) fn new(spec: &Spec, tick_s: f64, layers: &Rc<Layers>) -> Self {
        let mut normal = Normal::with_layers(spec.seed, Process::Flicker, layers);
        let b = spec.flicker_floor_dps / facts::FLOOR_PER_B;
        let band_ln = libm::log(FLICKER_TOP_HZ / spec.flicker_hz);
        let cells = libm::ceil(band_ln / LN_2).max(0.0) as u32;
        let ratio_ln = band_ln / f64::from(cells.max(1));
        let sd = b * libm::sqrt(ratio_ln.max(0.0) / PI);
        let corner = |cell: u32| spec.flicker_hz * libm::exp(ratio_ln * (f64::from(cell) + 0.5));
        let parts = (0..cells)
            .map(|cell| OrnsteinUhlenbeck::stationary(sd, tick_s * 2.0 * PI * corner(cell), &mut normal))
            .collect();
        Self { parts, normal }
    }

    pub(crate) fn step(&mut self) {
        for part in &mut self.parts {
            part.step(&mut self.normal);
        }
    }

    pub(crate) fn value(&self) -> f64 {
        self.parts.iter().map(|part| part.value).sum()
    }
}

/// Exponentially correlated noise with one value per tick of fixed length.
pub(crate) struct OrnsteinUhlenbeck {
    pub(crate) value: f64,
    decay: f64,
    kick: f64,
}

impl OrnsteinUhlenbeck {
    /// Makes a process of standard deviation `sd` whose tick lasts `ticks` time constants, from a stationary start.
    pub(crate) fn stationary(sd: f64, ticks: f64, normal: &mut Normal) -> Self {
        Self {
            value: sd * normal.sample(),
            decay: libm::exp(-ticks),
            kick: sd * libm::sqrt(-libm::expm1(-2.0 * ticks)),
        }
    }

    pub(crate) fn step(&mut self, normal: &mut Normal) -> f64 {
        self.value = self.decay * self.value + self.kick * normal.sample();
        self.value
    }
}

/// Rate random walk, which starts at zero (M-04).
pub(crate) struct RandomWalk {
    pub(crate) value: f64,
    kick: f64,
    normal: Normal,
}

impl RandomWalk {
    pub(crate) fn new(spec: &Spec, tick_s: f64, layers: &Rc<Layers>) -> Self {
        Self {
            value: 0.0,
            kick: spec.rrw_dps_per_rt_s * libm::sqrt(tick_s),
            normal: Normal::with_layers(spec.seed, Process::RandomWalk, layers),
        }
    }

    pub(crate) fn step(&mut self) {
        self.value += self.kick * self.normal.sample();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_within_its_stated_error() {
        for i in 0..10_000u64 {
            let phase = i.wrapping_mul(0x0123_4567_89AB_CDEF);
            let exact = libm::sin(phase as f64 * (2.0 * PI / 18_446_744_073_709_551_616.0));
            assert!((sine(phase) - exact).abs() < 4e-6, "{phase}");
        }
    }

    #[test]
    fn white_variance_is_density_times_noise_bandwidth() {
        let spec = Spec::typical();
        let mut white = White::new(&spec, &Rc::new(Layers::new()));
        let n = 400_000u32;
        // the variance is the same with steps of one pair of conversions, and of 1 s
        for h_ps in [175_666_666u64, 1_000_000_000_000] {
            let start = white.last_ps;
            let sum: f64 = (1..=u64::from(n))
                .map(|i| {
                    let x = white.at(start + i * h_ps);
                    x * x
                })
                .sum();
            let bandwidth = PI / 2.0 * 327.0 * 1000.0 / 1327.0;
            let expected = 0.0125 * 0.0125 * bandwidth;
            assert!((sum / f64::from(n) / expected - 1.0).abs() < 0.01, "{h_ps}");
        }
    }
}
