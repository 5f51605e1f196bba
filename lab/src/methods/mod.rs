//! `cargo xtask methods`: compares the results of all methods for the bias over temperature with the truth of many
//! simulated units, and writes docs/reference/methods.md.

mod an1042;
mod ardupilot;
mod bound;
mod campaign;
mod chamber;
mod comparison;
mod gls;
pub mod least_squares;
mod page;
mod picture;
mod px4;
mod table;
mod unit;

use crate::seeds;
use crate::tracking;
use campaign::Units;
use std::ops::RangeInclusive;
use unit::Kind;

#[derive(clap::Args)]
pub struct MethodsArgs {
    /// Units of each kind, by their seeds, both ends included
    #[arg(long, default_value = "1..500", value_parser = seeds::parse, value_name = "A..B")]
    seeds: RangeInclusive<u64>,
    /// Lag of the lagging units, s
    #[arg(long, default_value_t = 30.0, value_name = "S")]
    lag_s: f64,
    /// The methods alone, on three units of each kind; prints, and writes no page. As in `cargo xtask night`
    #[arg(long, conflicts_with = "seeds")]
    quick: bool,
    /// The first unit of --quick
    #[arg(long, value_name = "N", default_value_t = 1, requires = "quick")]
    seed: u64,
}

/// Number of units of each kind with `--quick`.
const QUICK: u64 = 3;
/// Ratio of the number of all units to the number of units in the additional tables.
const SIDE_SHARE: u64 = 5;
/// Number of seeds for which the short form of AN-1042 is compared with the real procedure.
const CHECKED: u64 = 5;

/// Runs every method. Without `--quick`, it also writes docs/reference/methods.md and its plots.
pub fn run(args: &MethodsArgs) -> anyhow::Result<()> {
    let seeds = if args.quick { args.seed..=args.seed + QUICK - 1 } else { args.seeds.clone() };
    let units = Units { seeds: &seeds, lag_s: args.lag_s };
    let methods = units.by_method()?;
    println!("{}", table::overview(&methods));
    if args.quick {
        return Ok(());
    }
    let count = (seeds.end() - seeds.start() + 1).div_ceil(SIDE_SHARE);
    let side = *seeds.start()..=seeds.start() + count - 1;
    let side_units = Units { seeds: &side, ..units };
    let results = page::Results {
        methods,
        lengths: side_units.by_length(&page::LENGTHS_MIN.map(|minutes| 60.0 * minutes))?,
        walks: side_units.by_walk(&page::WALKS)?,
        bounds_dph: page::WALKS.into_iter().map(|factor| campaign::bound_dph(1, factor)).collect::<Result<_, _>>()?,
        tracking: tracking::days(&side, tracking::SELDOM)?,
        curved_bound_dph: campaign::bound_dph(2, 1.0)?,
        checked: (*seeds.start()..=*seeds.end())
            .take(CHECKED as usize)
            .map(|seed| an1042::held_against_the_procedure(Kind::Linear.spec(seed, args.lag_s)))
            .collect::<Result<_, _>>()?,
        seeds: seeds.clone(),
        side,
        lag_s: args.lag_s,
    };
    page::write(&results)
}
