//! Finds jumps between samples that hold much of the power of the differences, without a noise model. It is one pass
//! over the samples.

use crate::Input;
use alloc::vec::Vec;

/// Number of differences in a part of the record, and the least number of parts.
const PART: usize = 128;
const FEWEST: usize = 8;
/// A part has a jump if its largest difference is this many times the usual largest difference of a part.
const LONE: f64 = 3.0;
/// Jumps are reported if they add at least this share to the power of the other differences.
const ADDED: f64 = 0.25;

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
        Input::Codes { codes, .. } => parts(codes, 2, |of| f64::from(of[1]) - f64::from(of[0])),
        Input::Rate(rate) => parts(rate, 2, |of| of[1] - of[0]),
        Input::Phase(phase) => parts(phase, 3, |of| of[2] - 2.0 * of[1] + of[0]),
    };
    if parts.len() < FEWEST {
        return None;
    }
    let (power, square) = (middle(parts.iter().map(|part| part.power)), middle(parts.iter().map(|part| part.largest)));
    let jumped = parts.iter().filter(|part| part.largest > LONE * LONE * square);
    let added: f64 = jumped.map(|part| part.power - power).sum();
    let largest = parts.iter().fold(0.0_f64, |most, part| most.max(part.largest));
    let is_much = square > 0.0 && added > ADDED * power * parts.len() as f64;
    is_much.then(|| Jumps { largest: libm::sqrt(largest), usual: libm::sqrt(square) })
}

/// The squares of the differences in a part of the record: their sum, and the largest.
#[derive(Clone, Copy, Default)]
struct Part {
    power: f64,
    largest: f64,
}

/// The parts of a record. Differences with a missing sample are left out. A difference is of `width` samples.
fn parts<T>(samples: &[T], width: usize, difference: impl Fn(&[T]) -> f64) -> Vec<Part> {
    let of_part = |start: usize| {
        let inside = &samples[start..samples.len().min(start + PART + width - 1)];
        let squares = inside.windows(width).map(|of| {
            let difference = difference(of);
            difference * difference
        });
        let add = |part: Part, square: f64| Part {
            power: part.power + square,
            largest: if square > part.largest { square } else { part.largest },
        };
        squares.filter(|square| square.is_finite()).fold(Part::default(), add)
    };
    (0..(samples.len() + 1).saturating_sub(width)).step_by(PART).map(of_part).collect()
}

fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
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
