//! Runs a reader on damaged input that is the same on every machine: the seed files of a target, edited at random.

use super::edit::{Draw, Edits, MOST_ADDED};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Calls `read` with randomly edited `seeds`, `iterations` times unless the environment sets another number.
pub fn edited(iterations: u64, seeds: &[Vec<u8>], read: impl Fn(&[u8])) {
    let seed = from_environment("ZERORATE_FUZZ_SEED").unwrap_or(1);
    let iterations = from_environment("ZERORATE_FUZZ_ITERATIONS").unwrap_or(iterations);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    for iteration in 0..iterations {
        let mut draw = [0; size_of::<Draw>()];
        random.fill_bytes(&mut draw);
        let which = random.next_u32() as usize % seeds.len();
        let edits = Edits::of(&draw);
        let _failure = Replay { seed, iteration, which, edits: &edits };
        read(&edits.apply(&seeds[which]));
    }
}

fn from_environment(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Prints how to replay a failure, if it is dropped by a panic.
struct Replay<'a> {
    seed: u64,
    iteration: u64,
    which: usize,
    edits: &'a Edits,
}

impl Drop for Replay<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let Self { seed, iteration, which, edits } = self;
            let iterations = *iteration + 1;
            let how = format!("ZERORATE_FUZZ_SEED={seed} ZERORATE_FUZZ_ITERATIONS={iterations}");
            eprintln!("{how} replays it: file {which}, {edits:?}");
        }
    }
}

/// Most edits change the input, and none adds more than [`MOST_ADDED`] bytes. Even an empty input can be edited.
#[test]
fn edits_change_the_input_within_bounds() {
    let seed: Vec<u8> = (0..=255).collect();
    let changed = std::cell::Cell::new(0);
    edited(500, &[seed.clone(), Vec::new()], |bytes| {
        assert!(bytes.len() <= seed.len() + MOST_ADDED);
        changed.set(changed.get() + u32::from(*bytes != *seed && !bytes.is_empty()));
    });
    assert!(changed.get() > 200, "{}", changed.get());
}
