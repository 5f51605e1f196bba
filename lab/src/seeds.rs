//! Runs simulated units by their seeds, on all cores.

use anyhow::{Context, anyhow};
use std::ops::RangeInclusive;
use std::sync::Mutex;

/// Parses `FIRST..LAST`, which includes both ends.
pub fn parse(text: &str) -> Result<RangeInclusive<u64>, String> {
    let (first, last) = text.split_once("..").ok_or("seeds are given as FIRST..LAST, for example 1..200")?;
    let seed = |text: &str| text.trim_start_matches('=').parse().map_err(|_| format!("`{text}` is no seed"));
    let (first, last) = (seed(first)?, seed(last)?);
    if first > last { Err(format!("{first} lies behind {last}")) } else { Ok(first..=last) }
}

/// Runs `unit` for every seed, in as many threads as there are cores. The results are in the order of the seeds.
pub fn for_each_seed<T: Send>(
    seeds: impl Iterator<Item = u64> + Send,
    unit: impl Fn(u64) -> anyhow::Result<T> + Sync,
) -> anyhow::Result<Vec<T>> {
    let waiting = Mutex::new(seeds);
    let worker = || {
        let next = || waiting.lock().expect("no seed panics").next();
        let mine = std::iter::from_fn(next);
        mine.map(|seed| Ok((seed, unit(seed).with_context(|| format!("seed {seed}"))?)))
            .collect::<anyhow::Result<Vec<_>>>()
    };
    let mut results = std::thread::scope(|scope| -> anyhow::Result<Vec<(u64, T)>> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        let joined = workers.into_iter().map(|worker| worker.join().map_err(|_| anyhow!("a worker panicked"))?);
        Ok(joined.collect::<anyhow::Result<Vec<_>>>()?.into_iter().flatten().collect())
    })?;
    results.sort_by_key(|(seed, _)| *seed);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}
