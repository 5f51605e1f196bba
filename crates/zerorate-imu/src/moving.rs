//! Finds the times of motion in a record that has no valid noise model, or many glitches. During motion, the samples
//! spread far more than at rest.

/// Length of a window, s, and its least number of samples.
const WINDOW_S: f64 = 10.0;
const FEWEST: usize = 20;

/// Ratio of the spread in a window to the median spread, above which the sensor moves.
const MOVES: f64 = 4.0;

/// The times in which the samples spread more than `MOVES` times as much as usual, as pairs of start and end, s from
/// the first sample. A missing sample is NaN.
pub fn moving(samples: &[f64], rate_hz: f64) -> Vec<(f64, f64)> {
    let length = ((WINDOW_S * rate_hz) as usize).max(FEWEST);
    let spreads: Vec<f64> = samples.chunks(length).map(spread).collect();
    let mut known: Vec<f64> = spreads.iter().copied().filter(|spread| *spread > 0.0).collect();
    known.sort_unstable_by(f64::total_cmp);
    let Some(usual) = known.get(known.len() / 2) else { return Vec::new() };
    let time_s = |window: usize| (window * length).min(samples.len()) as f64 / rate_hz;
    let busy = (0..spreads.len()).filter(|window| spreads[*window] > MOVES * usual);
    busy.fold(Vec::new(), |mut spans: Vec<(f64, f64)>, window| {
        let (from_s, to_s) = (time_s(window), time_s(window + 1));
        match spans.last_mut().filter(|last| last.1 == from_s) {
            Some(last) => last.1 = to_s,
            None => spans.push((from_s, to_s)),
        }
        spans
    })
}

/// Standard deviation of the samples that are present; NaN if there are none.
fn spread(samples: &[f64]) -> f64 {
    let present = || samples.iter().filter(|sample| !sample.is_nan());
    let count = present().count() as f64;
    let mean = present().sum::<f64>() / count;
    (present().map(|sample| (sample - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The times at which at least half of the axes move, as joined spans.
pub fn shared(axes: &[&[(f64, f64)]]) -> Vec<(f64, f64)> {
    let mut edges: Vec<(f64, i32)> =
        axes.iter().flat_map(|spans| spans.iter()).flat_map(|(from, to)| [(*from, 1), (*to, -1)]).collect();
    // if one span begins when another ends, the beginning comes first, so that both are joined
    edges.sort_by(|one, other| one.0.total_cmp(&other.0).then(other.1.cmp(&one.1)));
    let enough = axes.len().div_ceil(2) as i32;
    let (mut open, mut found): (i32, Vec<(f64, f64)>) = (0, Vec::new());
    for (time_s, change) in edges {
        match (open, open + change) {
            (before, now) if before < enough && now >= enough => found.push((time_s, time_s)),
            (before, now) if before >= enough && now < enough => {
                found.last_mut().into_iter().for_each(|last| last.1 = time_s);
            }
            _ => {}
        }
        open += change;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_of_motion_are_found_and_shared() {
        let sample = |at: usize| {
            let noise = ((at * 7919) % 101) as f64 - 50.0;
            if (3_000..3_400).contains(&at) { 20.0 * noise } else { noise }
        };
        let mut record: Vec<f64> = (0..10_000).map(sample).collect();
        record[100..300].fill(f64::NAN);
        assert_eq!(moving(&record, 10.0), [(300.0, 340.0)]);
        assert_eq!(moving(&record[..2_000], 10.0), []);
        assert_eq!(moving(&[f64::NAN; 500], 10.0), []);
        let axes: [&[(f64, f64)]; 3] = [&[(300.0, 340.0)], &[(310.0, 350.0), (900.0, 910.0)], &[]];
        assert_eq!(shared(&axes), [(310.0, 340.0)]);
        assert_eq!(shared(&[&[(1.0, 2.0), (2.0, 3.0)]]), [(1.0, 3.0)]);
    }
}
