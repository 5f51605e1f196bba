use super::kernels::Deviation;
use core::fmt;

/// Allan deviation computed as samples arrive, for averages of 1, 2, 4 … 2^(`OCTAVES` − 1) samples. It allocates
/// nothing, and takes at most 48 bytes per octave and 16 more.
///
/// The averages cover samples j · 2^k … (j + 1) · 2^k − 1, counted from the start of the whole record. So the streams
/// of two adjacent pieces can be joined: [`Stream::merge`] gives exactly the stream of both. A stream from sample 0
/// equals [`Stat::Adev`](super::Stat::Adev) (NIST SP 1065 equation 10). All sums are integers. With codes of 32 bits
/// they are exact for at least 2^37 samples.
///
/// Do not fit a noise model to these deviations: Gauss–Markov terms, lines, a low-pass, glitches and steps falsify N,
/// B and K, and only the record shows them. Keep the record, and use `fit`.
///
/// ```
/// use zerorate_allan::Stream;
/// let mut whole = Stream::<24>::starting_at(0);
/// let (mut early, mut late) = (Stream::<24>::starting_at(0), Stream::<24>::starting_at(3));
/// for code in [1, 3, 2] {
///     whole.push(code);
///     early.push(code);
/// }
/// for code in [4, 4, 9] {
///     whole.push(code);
///     late.push(code);
/// }
/// early.merge(&late).unwrap();
/// assert_eq!(early, whole);
/// // sums of two: 4, 6, 13; σ² = (2² + 7²) / (2 · 2² · 2)
/// assert_eq!(whole.deviation(1).unwrap().dev, (53.0f64 / 16.0).sqrt());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream<const OCTAVES: usize> {
    start: u64,
    end: u64,
    levels: [Level; OCTAVES],
}

/// Sums over the complete averages of one length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Level {
    first: i64,
    last: i64,
    blocks: u64,
    squares: u128,
}

impl Level {
    fn push(&mut self, sum: i64) {
        if self.blocks == 0 {
            self.first = sum;
        } else {
            self.step(sum);
        }
        self.last = sum;
        self.blocks += 1;
    }

    fn step(&mut self, to: i64) {
        let step = u128::from(to.abs_diff(self.last));
        self.squares = self.squares.saturating_add(step * step);
    }

    fn first(&self) -> Option<i64> {
        (self.blocks > 0).then_some(self.first)
    }

    fn last(&self) -> Option<i64> {
        (self.blocks > 0).then_some(self.last)
    }

    fn append(&mut self, next: &Self) {
        if next.blocks == 0 {
            return;
        }
        self.push(next.first);
        self.squares = self.squares.saturating_add(next.squares);
        self.last = next.last;
        self.blocks += next.blocks - 1;
    }
}

impl<const OCTAVES: usize> Stream<OCTAVES> {
    /// An empty stream. Its first sample will have this index in the whole record.
    pub const fn starting_at(index: u64) -> Self {
        const { assert!(OCTAVES <= 25, "sums of more samples might not fit") };
        Self { start: index, end: index, levels: [Level { first: 0, last: 0, blocks: 0, squares: 0 }; OCTAVES] }
    }

    /// Adds the next sample. This updates the sums of two octaves on average, and of all octaves at most.
    pub fn push(&mut self, code: i32) {
        let mut index = self.end;
        self.end = self.end.wrapping_add(1);
        let mut sum = i64::from(code);
        for level in &mut self.levels {
            let before = level.last();
            level.push(sum);
            match before {
                Some(before) if index % 2 == 1 => sum += before,
                _ => return,
            }
            index /= 2;
        }
    }

    /// Appends the stream of the samples that follow.
    pub fn merge(&mut self, next: &Self) -> Result<(), NotAdjacent> {
        if next.start != self.end {
            return Err(NotAdjacent { expected: self.end, found: next.start });
        }
        let mut across = None;
        for (k, (level, right)) in self.levels.iter_mut().zip(&next.levels).enumerate() {
            let above = join_above(self.end, k, level, across, right);
            across.into_iter().for_each(|sum| level.push(sum));
            level.append(right);
            across = above;
        }
        self.end = next.end;
        Ok(())
    }

    /// Allan deviation of averages of 2^`octave` samples, in LSB; `None` until two averages are complete.
    pub fn deviation(&self, octave: usize) -> Option<Deviation> {
        let level = self.levels.get(octave).filter(|level| level.blocks >= 2)?;
        let (m, n) = (1u64 << octave, level.blocks - 1);
        let dev = libm::sqrt(level.squares as f64 / (2.0 * n as f64)) / m as f64;
        Some(Deviation { m, dev, n })
    }

    /// Number of samples taken.
    pub fn samples(&self) -> u64 {
        self.end.wrapping_sub(self.start)
    }
}

/// Sum of the level `k + 1` average that spans the joint, if both of its halves are complete.
fn join_above(joint: u64, k: usize, left: &Level, across: Option<i64>, right: &Level) -> Option<i64> {
    let is_cut = |level: usize| joint & ((1 << level) - 1) != 0;
    if !is_cut(k + 1) {
        return None;
    }
    let is_second_half = joint >> k & 1 == 1;
    match (is_cut(k), is_second_half) {
        (false, _) => Some(left.last()? + right.first()?),
        (true, true) => Some(left.last()? + across?),
        (true, false) => Some(across? + right.first()?),
    }
}

/// The second stream does not start where the first one ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAdjacent {
    /// Index of the sample after the first stream.
    pub expected: u64,
    /// Index of the first sample of the second stream.
    pub found: u64,
}

impl fmt::Display for NotAdjacent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the next stream must start at sample {}, not {}", self.expected, self.found)
    }
}

impl core::error::Error for NotAdjacent {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Input, Stat, deviations};
    use std::vec::Vec;

    fn codes(len: usize) -> Vec<i32> {
        (0..len as i64).map(|i| (i * i * 7919 % 16_777_213 - 8_388_607) as i32).collect()
    }

    fn stream(codes: &[i32], start: u64) -> Stream<10> {
        let mut stream = Stream::starting_at(start);
        codes.iter().for_each(|&code| stream.push(code));
        stream
    }

    #[test]
    fn a_stream_has_the_allan_deviation_of_the_record() {
        let codes = codes(1000);
        let stream = stream(&codes, 0);
        for octave in 0..9 {
            let input = Input::Codes { codes: &codes, gaps: &[] };
            let whole = deviations(&input, 1.0, Stat::Adev, &[1 << octave])[0].unwrap();
            assert_eq!(stream.deviation(octave), Some(whole));
        }
        assert_eq!(stream.deviation(9), None);
        assert_eq!(stream.deviation(10), None);
    }

    #[test]
    fn any_two_cuts_merge_to_the_whole() {
        let codes = codes(70);
        for start in [0, 1, 5, 1022] {
            let whole = stream(&codes, start);
            for (a, b) in (0..=70).flat_map(|a| (a..=70).map(move |b| (a, b))) {
                let mut first = stream(&codes[..a], start);
                let mut second = stream(&codes[a..b], start + a as u64);
                second.merge(&stream(&codes[b..], start + b as u64)).unwrap();
                first.merge(&second).unwrap();
                assert_eq!(first, whole, "cuts at {a} and {b} from {start}");
            }
        }
    }

    #[test]
    fn only_neighbours_merge_and_memory_is_fixed() {
        let apart = stream(&[1, 2], 0).merge(&stream(&[3], 3));
        assert_eq!(apart, Err(NotAdjacent { expected: 2, found: 3 }));
        assert!(size_of::<Stream<24>>() <= 24 * 48 + 16);
    }
}
