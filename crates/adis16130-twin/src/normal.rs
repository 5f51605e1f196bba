//! Random numbers that are the same on every machine. Each random process has its own stream, all from one seed.
//!
//! The ziggurat here uses `libm` only. `rand_distr` calls `ln` and `exp` through `num-traits`, which any other crate
//! of a workspace can switch to the system's mathematics library by feature unification.

use alloc::rc::Rc;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// The random processes. Each has its own stream, so that draws by one do not change another.
#[derive(Copy, Clone)]
pub(crate) enum Process {
    Unit,
    Flicker,
    RandomWalk,
    Ambient,
    Rate,
    Temperature,
    Faults,
}

/// Uniform numbers in [0, 1).
pub(crate) struct Uniform(Xoshiro256PlusPlus);

impl Uniform {
    /// The stream of `process`: the seed's sequence, jumped ahead by 2¹²⁸ per process.
    pub(crate) fn new(seed: u64, process: Process) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        for _ in 0..process as usize {
            rng.jump();
        }
        Self(rng)
    }

    #[inline]
    pub(crate) fn sample(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// Standard normal numbers by the ziggurat of Doornik (2005), 256 layers.
pub(crate) struct Normal {
    pub(crate) random: Uniform,
    layers: Rc<Layers>,
}

impl Normal {
    pub(crate) fn new(seed: u64, process: Process) -> Self {
        Self::with_layers(seed, process, &Rc::new(Layers::new()))
    }

    pub(crate) fn with_layers(seed: u64, process: Process, layers: &Rc<Layers>) -> Self {
        Self { random: Uniform::new(seed, process), layers: Rc::clone(layers) }
    }

    #[inline]
    pub(crate) fn sample(&mut self) -> f64 {
        let bits = self.random.0.next_u64();
        let layer = (bits & 0xFF) as usize;
        let u = ((bits as i64) >> 11) as f64 * (1.0 / (1u64 << 52) as f64);
        let x = u * self.layers.x[layer];
        if x.abs() < self.layers.x[layer + 1] { x } else { self.outside(layer, x) }
    }

    /// Finishes a draw that falls outside the inner rectangle of its layer, as one draw in 67 does.
    #[cold]
    #[inline(never)]
    fn outside(&mut self, layer: usize, x: f64) -> f64 {
        if layer == 0 {
            let tail = self.tail();
            return if x < 0.0 { -tail } else { tail };
        }
        let (low, high) = (self.layers.f[layer], self.layers.f[layer + 1]);
        if low + (high - low) * self.random.sample() < density(x) { x } else { self.sample() }
    }

    /// Draws a number beyond [`TAIL`], by Marsaglia's method.
    fn tail(&mut self) -> f64 {
        loop {
            let x = -libm::log(1.0 - self.random.sample()) / TAIL;
            let y = -libm::log(1.0 - self.random.sample());
            if 2.0 * y > x * x {
                return TAIL + x;
            }
        }
    }
}

/// Start of the tail, and area of each layer, for 256 layers.
const TAIL: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_974_655;

/// The edges `x` of the layers, outermost first, and `f` = exp(−x²/2) at each edge.
pub(crate) struct Layers {
    x: [f64; 257],
    f: [f64; 257],
}

impl Layers {
    pub(crate) fn new() -> Self {
        let mut x = [0.0; 257];
        x[0] = AREA / density(TAIL);
        x[1] = TAIL;
        for i in 2..256 {
            x[i] = libm::sqrt(-2.0 * libm::log(AREA / x[i - 1] + density(x[i - 1])));
        }
        Self { x, f: x.map(density) }
    }
}

fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_close_at_the_peak() {
        let layers = Layers::new();
        let top = layers.x[255] * (1.0 - layers.f[255]);
        assert!((top - AREA).abs() < 1e-9, "{top}");
    }

    #[test]
    fn moments_and_tails_are_normal() {
        let mut normal = Normal::new(3, Process::Rate);
        let n = 4_000_000;
        let (mut m1, mut m2, mut m4, mut beyond2, mut beyond4) = (0.0, 0.0, 0.0, 0, 0);
        for _ in 0..n {
            let x = normal.sample();
            m1 += x;
            m2 += x * x;
            m4 += x * x * x * x;
            beyond2 += u32::from(x > 2.0);
            beyond4 += u32::from(x.abs() > 4.0);
        }
        let n = f64::from(n);
        assert!((m1 / n).abs() < 4.0 / libm::sqrt(n));
        assert!((m2 / n - 1.0).abs() < 4.0 * libm::sqrt(2.0 / n));
        assert!((m4 / n - 3.0).abs() < 4.0 * libm::sqrt(96.0 / n));
        assert!((f64::from(beyond2) / n - 0.022_750_13).abs() < 4.0 * libm::sqrt(0.0228 / n));
        assert!((f64::from(beyond4) / n - 6.334e-5).abs() < 4.0 * libm::sqrt(6.334e-5 / n));
    }
}
