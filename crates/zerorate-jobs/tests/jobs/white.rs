//! Noise for the tests of the jobs and of the command line.

/// White noise of the standard deviation `sd`, by a congruential generator: sums of twelve uniform numbers.
pub fn white(samples: usize, sd: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = move || {
        state = 16_807 * state % 2_147_483_647;
        state as f64 / 2_147_483_647.0 - 0.5
    };
    (0..samples).map(|_| (0..12).map(|_| uniform()).sum::<f64>() * sd).collect()
}
