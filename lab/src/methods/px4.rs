//! PX4's thermal calibration from a log, as in its `Tools/process_sensor_caldata.py`. The rate is filtered by a median
//! over 31 samples and averaged over 2000 intervals of temperature. An unweighted cubic about the middle of the span
//! is fitted to the means. The log has ten samples per second (PX4's logging profile "thermal calibration").

use super::comparison::MethodResult;
use super::least_squares::cubic;
use super::unit::Recording;

const MEDIAN: usize = 31;
const INTERVALS: usize = 2000;

pub fn fit(recording: &Recording) -> Option<MethodResult> {
    let temps: Vec<f64> = recording.means.iter().map(|mean| mean.temp_c).collect();
    let rates: Vec<f64> = recording.means.iter().map(|mean| mean.rate_dps).collect();
    let (low_c, high_c) =
        temps.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), temp| (low.min(*temp), high.max(*temp)));
    let mut sums = vec![(0.0, 0.0, 0u32); INTERVALS];
    for (temp_c, rate_dps) in temps.iter().zip(median(&rates)) {
        let index = ((temp_c - low_c) / (high_c - low_c) * INTERVALS as f64) as usize;
        let (temp_sum, rate_sum, count) = &mut sums[index.min(INTERVALS - 1)];
        *temp_sum += temp_c;
        *rate_sum += rate_dps;
        *count += 1;
    }
    let mean = |(temp_sum, rate_sum, count): &(f64, f64, u32)| {
        (*count > 0).then(|| (temp_sum / f64::from(*count), rate_sum / f64::from(*count)))
    };
    Some(cubic(&sums.iter().filter_map(mean).collect::<Vec<_>>(), 0.5 * (low_c + high_c))?.into())
}

/// The running median, with zeros beyond both ends like SciPy's `medfilt`.
fn median(rates: &[f64]) -> Vec<f64> {
    let half = MEDIAN / 2;
    let padded: Vec<f64> = [vec![0.0; half].as_slice(), rates, vec![0.0; half].as_slice()].concat();
    let middle = |window: &[f64]| {
        let mut window = window.to_vec();
        *window.select_nth_unstable_by(half, f64::total_cmp).1
    };
    padded.windows(MEDIAN).map(middle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_equals_the_one_of_scipy() {
        // scipy.signal.medfilt(numpy.arange(1, 41), 31): the zeros beyond both ends pull the values near the ends down
        let rates: Vec<f64> = (1..=40).map(f64::from).collect();
        let found = median(&rates);
        assert_eq!(found.len(), 40);
        assert_eq!((found[0], found[1], found[15], found[24], found[39]), (1.0, 2.0, 16.0, 25.0, 25.0));
    }
}
