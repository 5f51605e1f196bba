//! Random sequences of calls, faults and waits on the driver, compared with the twin.
//!
//! The test checks these rules. No step panics. No two samples have the same conversion, and no reading has a code
//! that was never measured. `lost` is right to within the bounds that `ledger.rs` states. After a call that was cut
//! short nothing is sent until a reset. The part starts again once its faults are removed.
//!
//! `DRIVER_STEPS` and `DRIVER_SEED` in the environment set the least number of steps and the seed from which they are
//! drawn.

mod bench;
mod bus;
mod gyro;
mod judge;
mod ledger;
mod step;

use std::cell::Cell;
use std::env;

use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use bench::Bench;
use step::Plan;

#[test]
fn any_order_of_calls_faults_and_time() {
    let number = |name, default: u64| env::var(name).map_or(default, |text| text.parse().expect(name));
    let (wanted, seed) = (number("DRIVER_STEPS", 10_000), number("DRIVER_SEED", 1));
    let steps = Cell::new(0);
    let mut round = 0;
    while steps.get() < wanted {
        let result = runner(seed, round).run(&step::plan(), |plan| run(&plan, &steps));
        result.unwrap_or_else(|failure| panic!("DRIVER_SEED={seed}: {failure}"));
        round += 1;
    }
    println!("{} steps in {} runs, seed {seed}", steps.get(), round * u64::from(CASES));
}

/// Drops each call after each number of bytes. `read_all` has the most, 31.
#[cfg(feature = "async")]
#[test]
fn a_dropped_call_never_shifts_what_is_read_next() {
    for plan in (0..32).flat_map(step::dropped) {
        run(&plan, &Cell::default()).unwrap_or_else(|failure| panic!("{failure:?} of {plan:?}"));
    }
}

/// Number of runs in a round, of up to 200 steps each.
const CASES: u32 = 20;

fn runner(seed: u64, round: u64) -> TestRunner {
    let config = Config { cases: CASES, failure_persistence: None, max_shrink_iters: 20_000, ..Config::default() };
    let bytes = [seed, round, 0, 0].map(u64::to_le_bytes).concat();
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &bytes))
}

fn run(plan: &Plan, steps: &Cell<u64>) -> Result<(), TestCaseError> {
    let mut bench = Bench::new(plan);
    for (index, step) in plan.steps.iter().enumerate() {
        steps.set(steps.get() + 1);
        let verdict = bench.carry_out(step);
        verdict.map_err(|rule| TestCaseError::fail(format!("step {index}, {step:?}: {rule}")))?;
    }
    Ok(())
}
