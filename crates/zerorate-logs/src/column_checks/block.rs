//! Splits a column into blocks, and computes the facts that all checks share in one pass over the column.

use zerorate_allan::Input;

pub const BLOCK: usize = 512;
/// Number of samples in a window. A block consists of whole windows.
pub const WINDOW: usize = 32;
const WINDOWS: usize = BLOCK / WINDOW;
const LANES: usize = 16;

/// A block with a sample of this size or more has no facts, so that no sum or square is infinite.
const LARGEST: f64 = 1e150;

/// Consecutive samples. All blocks but the last have [`BLOCK`] samples.
pub struct Block<'a> {
    /// The samples, for a check that needs more than the facts.
    pub samples: &'a [f64],
    /// The sample before the block; `None` before the first block.
    before: Option<f64>,
    /// The facts. `None` if the block is first or short, or a sample is too large or, here or right before, missing.
    pub facts: Option<Facts>,
}

/// The facts of a block whose samples are all finite, as is the sample before the block.
pub struct Facts {
    pub largest: f64,
    pub least: f64,
    pub sum: f64,
    /// Least difference between neighbours that is not 0; infinite if all samples are equal.
    pub step: f64,
    pub changes: usize,
    /// Range of each window: its largest minus its least sample.
    pub ranges: [f64; WINDOWS],
}

impl<'a> Block<'a> {
    /// The block that consists of `samples` without the first `before` (0 or 1), which precede the block.
    fn new(samples: &'a [f64], before: usize) -> Self {
        let facts = samples.first_chunk().map(facts);
        let is_finite = |facts: &Facts| facts.sum.is_finite() && facts.largest < LARGEST && facts.least > -LARGEST;
        Self {
            samples: &samples[before..],
            before: samples[..before].first().copied(),
            facts: facts.filter(is_finite),
        }
    }

    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Pairs of a previous sample and a sample. The previous sample of the first in the column is NaN.
    pub fn pairs(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> + ExactSizeIterator + '_ {
        let before = self.before.unwrap_or(f64::NAN);
        let pair = move |(at, sample): (usize, &f64)| (if at > 0 { self.samples[at - 1] } else { before }, *sample);
        self.samples.iter().enumerate().map(pair)
    }

    pub fn windows(&self) -> usize {
        self.samples.len() / WINDOW
    }

    pub fn window(&self, at: usize) -> &'a [f64] {
        &self.samples[at * WINDOW..][..WINDOW]
    }
}

/// Calls `feed` with all samples of a column, block by block. Samples that are missing among codes are left out.
pub fn for_each_block(input: &Input<'_>, mut feed: impl FnMut(&Block<'_>)) {
    match input {
        Input::Rate(numbers) | Input::Phase(numbers) => {
            for start in (0..numbers.len()).step_by(BLOCK) {
                let (before, end) = (start.min(1), numbers.len().min(start + BLOCK));
                feed(&Block::new(&numbers[start - before..end], before));
            }
        }
        Input::Codes { codes, .. } => {
            let mut numbers = Vec::with_capacity(BLOCK + 1);
            for start in (0..codes.len()).step_by(BLOCK) {
                let (before, end) = (start.min(1), codes.len().min(start + BLOCK));
                numbers.clear();
                numbers.extend(codes[start - before..end].iter().map(|code| f64::from(*code)));
                feed(&Block::new(&numbers, before));
            }
        }
    }
}

/// Facts about all samples but the first, which precedes the block. The sum is not finite if any sample is not.
#[multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon"))]
fn facts(samples: &[f64; BLOCK + 1]) -> Facts {
    let (mut step, mut changes, mut sums) = ([f64::INFINITY; LANES], [0.0; LANES], [0.0; LANES]);
    let ((chunks, _), (before, _)) = (samples[1..].as_chunks::<LANES>(), samples[..BLOCK].as_chunks::<LANES>());
    for (chunk, before) in chunks.iter().zip(before) {
        for lane in 0..LANES {
            let difference = (chunk[lane] - before[lane]).abs();
            let is_change = difference > 0.0;
            let unless = step[lane];
            let difference = if is_change { difference } else { unless };
            step[lane] = if difference < unless { difference } else { unless };
            changes[lane] += if is_change { 1.0 } else { 0.0 };
            sums[lane] += chunk[lane];
        }
    }
    let (mut largest, mut least, mut ranges) = (f64::NEG_INFINITY, f64::INFINITY, [0.0; WINDOWS]);
    let (windows, _) = samples[1..].as_chunks::<WINDOW>();
    for (window, range) in windows.iter().zip(&mut ranges) {
        let high = folded(window, |a, b| if a > b { a } else { b });
        let low = folded(window, |a, b| if a < b { a } else { b });
        *range = high - low;
        largest = if high > largest { high } else { largest };
        least = if low < least { low } else { least };
    }
    let sum = sums.iter().sum::<f64>();
    Facts {
        largest,
        least,
        sum: if samples[0].is_finite() { sum } else { f64::NAN },
        step: step.iter().copied().fold(f64::INFINITY, f64::min),
        changes: changes.iter().sum::<f64>() as usize,
        ranges,
    }
}

#[inline(always)]
fn folded(window: &[f64; WINDOW], join: impl Fn(f64, f64) -> f64) -> f64 {
    let mut lanes: [f64; WINDOW / 2] = std::array::from_fn(|lane| join(window[lane], window[lane + WINDOW / 2]));
    let mut half = WINDOW / 4;
    while half > 0 {
        for lane in 0..half {
            lanes[lane] = join(lanes[lane], lanes[lane + half]);
        }
        half /= 2;
    }
    lanes[0]
}
