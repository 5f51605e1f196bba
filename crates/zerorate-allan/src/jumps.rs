//! Finds jumps between samples that hold much of the power of the differences, without a noise model. It is one pass
//! over the samples.

use crate::Input;
use alloc::vec::Vec;

/// Number of differences in a part of the record, and the least number of parts.
const PART: usize = 64;
const FEWEST: usize = 16;
/// Number of differences that the processor computes side by side.
const LANES: usize = 8;
/// A part may have a jump if its largest difference is this many times the usual largest difference of a part.
const LARGE: f64 = 3.3;
/// Such a difference is a jump if, within `NEAR` differences to either side, at most `ALONE` differences with itself
/// are larger than its share `SIMILAR`. Two wrong samples make four. More are a motion, or a stretch with more noise.
const NEAR: usize = 16;
const SIMILAR: f64 = 0.25;
const ALONE: usize = 4;
/// Share of the records of heavy-tailed noise in which a gap between sizes is mistaken for one that isolates jumps.
const GAP_BY_CHANCE: f64 = 0.003;
/// Sum of the squares of the differences in a part of white noise, in squares of their usual largest.
const POWER: f64 = 9.8;
/// Jumps are reported if the squares of the largest differences add this share to that power. A wrong sample makes two
/// such differences, which raise the deviations of the shortest averages by a tenth.
const ADDED: f64 = 0.125;

/// Jumps between neighbouring samples that noise does not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jumps {
    /// Largest difference between neighbours, in the unit of the input. For a phase it is the difference of two steps.
    pub largest: f64,
    /// The usual largest difference among 64 neighbours.
    pub usual: f64,
}

/// The jumps of a record, if they raise the deviations of the shortest averages by a tenth or more.
pub fn jumps(input: &Input<'_>) -> Option<Jumps> {
    match *input {
        Input::Codes { codes, .. } => among(codes, |code| f64::from(*code)),
        Input::Rate(rate) => among(rate, |sample| *sample),
        Input::Phase(phase) => {
            let steps: Vec<f64> = phase.windows(2).map(|pair| pair[1] - pair[0]).collect();
            among(&steps, |step| *step)
        }
    }
}

fn among<T>(samples: &[T], number: impl Fn(&T) -> f64 + Copy) -> Option<Jumps> {
    if samples.len() <= (FEWEST - 1) * PART {
        return None;
    }
    let parts = parts(samples, number);
    let usual = middle(parts.iter().map(|(_, largest)| *largest).collect())?;
    let is_noise = |(start, largest): &(usize, f64)| *largest <= LARGE * usual || is_alone(samples, *start, number);
    let mut sizes: Vec<f64> = parts.into_iter().filter(is_noise).map(|(_, largest)| largest).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let lone = &sizes[first_lone(&sizes, usual)?..];
    let added: f64 = lone.iter().map(|largest| largest * largest).sum();
    let is_much = added > ADDED * POWER * usual * usual * sizes.len() as f64;
    is_much.then_some(Jumps { largest: *lone.last()?, usual })
}

/// Index of the first of the sorted sizes above a gap that the tail of the noise does not explain. A power law is
/// taken for that tail, with the slope of the sizes from the usual one up to the gap.
fn first_lone(sizes: &[f64], usual: f64) -> Option<usize> {
    let large = sizes.partition_point(|size| *size <= LARGE * usual);
    let chance = |at: usize| {
        let tail = &sizes[(sizes.len() / 2).min(at - 1)..at];
        let slope = tail.iter().map(|size| libm::log(size / usual)).sum::<f64>();
        let gap = libm::log(sizes[at] / sizes[at - 1]) * (sizes.len() - at) as f64;
        libm::pow(1.0 + gap / slope, -(tail.len() as f64))
    };
    let most = GAP_BY_CHANCE / (sizes.len() - large) as f64;
    (large..sizes.len()).find(|at| chance(*at) < most)
}

/// Whether few differences are as large as the largest in the part of the record at `start`, close to it.
fn is_alone<T>(samples: &[T], start: usize, number: impl Fn(&T) -> f64) -> bool {
    let from = start.saturating_sub(NEAR);
    let around = &samples[from..samples.len().min(start + PART + NEAR + 1)];
    let sizes: Vec<f64> = around.windows(2).map(|pair| libm::fabs(number(&pair[1]) - number(&pair[0]))).collect();
    let inside = start - from..sizes.len().min(start - from + PART);
    let peak = inside.reduce(|one, other| if sizes[other] > sizes[one] || sizes[one].is_nan() { other } else { one });
    peak.is_some_and(|peak| {
        let near = &sizes[peak.saturating_sub(NEAR)..sizes.len().min(peak + NEAR + 1)];
        near.iter().filter(|size| **size > SIMILAR * sizes[peak]).count() <= ALONE
    })
}

/// The start of each part of the record that changes, and its largest difference between neighbours. Differences to a
/// missing sample do not count.
fn parts<T>(samples: &[T], number: impl Fn(&T) -> f64) -> Vec<(usize, f64)> {
    let size = |(one, next): (&T, &T)| (number(next) - number(one)).abs();
    let of_part = |start: usize| {
        let inside = &samples[start..samples.len().min(start + PART + 1)];
        let (ones, rest) = inside[..inside.len() - 1].as_chunks::<LANES>();
        let (nexts, next_rest) = inside[1..].as_chunks::<LANES>();
        let mut most = [0.0; LANES];
        for (one, next) in ones.iter().zip(nexts) {
            let sizes = one.iter().zip(next).map(size);
            most.iter_mut().zip(sizes).for_each(|(most, size)| *most = larger(*most, size));
        }
        (start, most.into_iter().chain(rest.iter().zip(next_rest).map(size)).fold(0.0, larger))
    };
    let parts = (0..samples.len().saturating_sub(1)).step_by(PART).map(of_part);
    parts.filter(|(_, largest)| *largest > 0.0 && largest.is_finite()).collect()
}

/// The larger of two numbers; the first if the second is NaN. It is one instruction, which `f64::max` is not.
fn larger(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}

fn middle(mut values: Vec<f64>) -> Option<f64> {
    let at = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize) -> Vec<f64> {
        let mut uniform = crate::fit::tests::uniform(11);
        (0..count).map(|_| (0..4).map(|_| uniform()).sum::<f64>()).collect()
    }

    #[test]
    fn a_bit_error_is_a_jump_and_noise_is_not() {
        let mut rate = noise(3000);
        assert_eq!(jumps(&Input::Rate(&rate)), None);
        rate[700] = f64::NAN;
        rate[1500] += 600.0;
        let found = jumps(&Input::Rate(&rate)).unwrap();
        assert!((596.0..604.0).contains(&found.largest) && (1.0..4.0).contains(&found.usual), "{found:?}");
        assert_eq!(jumps(&Input::Rate(&rate[..1000])), None);
        let mut phase = noise(3000);
        phase[9..].iter_mut().for_each(|point| *point += 360.0);
        assert!(jumps(&Input::Phase(&phase)).is_some_and(|found| found.largest > 350.0));
    }

    #[test]
    fn a_fast_motion_and_heavy_tails_are_no_jumps() {
        let turned = |at: usize| 500.0 * ((at as f64 - 2000.0) / 8.0).clamp(0.0, 1.0);
        let table: Vec<f64> = noise(3000).iter().enumerate().map(|(at, sample)| sample + turned(at)).collect();
        assert_eq!(jumps(&Input::Rate(&table)), None);
        let mut uniform = crate::fit::tests::uniform(3);
        // a tail as Student's t has with 3 degrees of freedom
        let tails: Vec<f64> = (0..200_000).map(|_| (uniform() - 0.5) * libm::pow(uniform(), -1.0 / 3.0)).collect();
        let found = |part: &&[f64]| jumps(&Input::Rate(part)).is_some();
        assert!(tails.chunks_exact(2000).filter(found).count() <= 2);
    }

    #[test]
    fn a_wrong_code_among_codes_that_seldom_change_is_a_jump() {
        let mut codes: Vec<i32> = noise(3000).iter().map(|sample| ((sample - 2.0) * 0.35).round() as i32).collect();
        codes[1000] += 256;
        assert!(jumps(&Input::Codes { codes: &codes, gaps: &[] }).is_some_and(|found| found.usual == 1.0));
    }

    #[test]
    fn coarse_codes_and_a_changing_noise_have_no_jumps() {
        for steps in [0.05, 0.3, 1.0, 100.0] {
            let codes: Vec<i32> = noise(20_000).iter().map(|sample| (sample * steps) as i32).collect();
            assert_eq!(jumps(&Input::Codes { codes: &codes, gaps: &[] }), None, "{steps}");
        }
        let louder: Vec<f64> = noise(20_000).iter().enumerate().map(|(at, s)| s * (1.0 + at as f64 / 1e4)).collect();
        assert_eq!(jumps(&Input::Rate(&louder)), None);
        assert_eq!(jumps(&Input::Rate(&[])), None);
    }
}
