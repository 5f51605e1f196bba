//! Finds jumps between samples that hold much of the power of the differences, without a noise model. It is one pass
//! over the samples.

use crate::Input;
use alloc::vec::Vec;

/// Number of differences in a part of the record, and the least number of parts.
const PART: usize = 128;
const FEWEST: usize = 8;
/// Number of differences that the processor computes side by side.
const LANES: usize = 8;
/// A part has a jump if its largest difference is this many times the usual largest difference of a part.
const LONE: f64 = 3.0;
/// Sum of the squares of the differences in a part of white noise, in squares of their usual largest.
const POWER: f64 = 16.0;
/// Jumps are reported if the squares of the largest differences add this share to that power. A wrong sample makes two
/// such differences, which raise the deviations of the shortest averages by a tenth.
const ADDED: f64 = 0.125;

/// Jumps between neighbouring samples that noise does not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jumps {
    /// Largest difference between neighbours, in the unit of the input. For a phase it is the difference of two steps.
    pub largest: f64,
    /// The usual largest difference among 128 neighbours.
    pub usual: f64,
}

/// The jumps of a record, if they raise the deviations of the shortest averages by a tenth or more.
pub fn jumps(input: &Input<'_>) -> Option<Jumps> {
    let parts = match *input {
        Input::Codes { codes, .. } => parts(codes, |code| f64::from(*code)),
        Input::Rate(rate) => parts(rate, |sample| *sample),
        Input::Phase(phase) => {
            let steps: Vec<f64> = phase.windows(2).map(|pair| pair[1] - pair[0]).collect();
            parts(&steps, |step| *step)
        }
    };
    if parts.len() < FEWEST {
        return None;
    }
    let usual = middle(parts.clone());
    let largest = parts.iter().fold(0.0, |most: f64, largest| most.max(*largest));
    let added: f64 = parts.iter().filter(|largest| **largest > LONE * usual).map(|largest| largest * largest).sum();
    let is_much = usual > 0.0 && added > ADDED * POWER * usual * usual * parts.len() as f64;
    is_much.then_some(Jumps { largest, usual })
}

/// The largest difference between neighbours in each part of the record. Differences to a missing sample do not count.
fn parts<T>(samples: &[T], number: impl Fn(&T) -> f64) -> Vec<f64> {
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
        most.into_iter().chain(rest.iter().zip(next_rest).map(size)).fold(0.0, larger)
    };
    (0..samples.len().saturating_sub(1)).step_by(PART).map(of_part).filter(|largest| largest.is_finite()).collect()
}

/// The larger of two numbers; the first if the second is NaN. It is one instruction, which `f64::max` is not.
fn larger(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}

fn middle(mut values: Vec<f64>) -> f64 {
    let at = values.len() / 2;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
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
