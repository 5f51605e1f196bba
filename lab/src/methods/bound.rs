//! The lower bound that noise sets for the error of every method: generalised least squares in which everything is
//! known except the coefficients and the random walk.

use super::unit::{Recording, TEMPS};
use zerorate::noise::{NoiseModel, WeightedMean};
use zerorate::temperature::Block;
use zerorate_allan::linear::{Cholesky, dot};

/// Number of windows into which a recording is divided.
const WINDOWS: usize = 300;

/// The standard uncertainty of the bias at the end of the recording, if the bias is a polynomial of this order in
/// temperature: rms over the temperatures, °/s.
pub fn u_dps(recording: &Recording, noise: &NoiseModel, order: usize) -> Option<f64> {
    let windows = windows(recording);
    let end_s = windows.last()?.start_s + windows.last()?.length_s;
    let factor = Cholesky::new(covariance(&windows, noise, end_s), 0.0)?;
    let middle_c = recording.temps_c()[TEMPS / 2];
    let column = |degree: i32| -> Vec<f64> {
        factor.whiten(windows.iter().map(|window| (window.temp_c - middle_c).powi(degree)))
    };
    let columns: Vec<Vec<f64>> = (0..=order as i32).map(column).collect();
    let information = (0..=order).map(|i| (0..=i).map(|j| dot(&columns[i], &columns[j])).collect()).collect();
    let information = Cholesky::new(information, 0.0)?;
    let variance = |temp_c: f64| {
        let powers: Vec<f64> = (0..=order as i32).map(|degree| (temp_c - middle_c).powi(degree)).collect();
        dot(&powers, &information.solve(powers.iter().copied()))
    };
    let sum: f64 = recording.temps_c().into_iter().map(variance).sum();
    Some((sum / TEMPS as f64).sqrt())
}

fn windows(recording: &Recording) -> Vec<Block> {
    let length_s = recording.means.len() as f64 * super::unit::MEAN_S / WINDOWS as f64;
    (0..WINDOWS).map(|k| recording.window(k as f64 * length_s, (k + 1) as f64 * length_s)).collect()
}

/// Covariance of the windows' mean rates. The random walk from a window to the recording's end counts as noise.
fn covariance(windows: &[Block], noise: &NoiseModel, end_s: f64) -> Vec<Vec<f64>> {
    let steady = noise.without_random_walk();
    let one =
        |block: &Block| [WeightedMean { start_s: block.start_s, end_s: block.start_s + block.length_s, weight: 1.0 }];
    let walk = noise.rate_random_walk_dps_per_rt_s.powi(2);
    // all windows have the same length, so the covariance depends on their distance only
    let by_distance: Vec<f64> =
        windows.iter().map(|other| steady.covariance(&one(&windows[0]), &one(other))).collect();
    let shared_s = |i: usize, j: usize| {
        let to_end_s = end_s - windows[i].start_s - windows[i].length_s;
        to_end_s + windows[i].length_s / if i == j { 3.0 } else { 2.0 }
    };
    (0..windows.len()).map(|i| (0..=i).map(|j| by_distance[i - j] + walk * shared_s(i, j)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::unit::Kind;
    use super::*;

    /// With white noise alone, the uncertainty of a constant bias is N/√(2T).
    #[test]
    fn white_noise_alone_is_averaged_away() {
        let white =
            NoiseModel { white_dps_per_rt_hz: 0.0125, bias_instability_dps: 0.0, rate_random_walk_dps_per_rt_s: 0.0 };
        let recording = Recording::warm_up(&Kind::Linear.spec(1, 0.0), 300.0);
        let level = u_dps(&recording, &white, 0).unwrap();
        assert!((level / (0.0125 / 600f64.sqrt()) - 1.0).abs() < 1e-6, "{level}");
        let walking = NoiseModel { rate_random_walk_dps_per_rt_s: 1e-4, ..white };
        assert!(u_dps(&recording, &walking, 0).unwrap() > 1.3 * level, "the last part of it counts most");
    }
}
