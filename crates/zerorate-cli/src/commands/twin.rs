//! `zerorate twin`: lists the keys of the simulated part.

use crate::output::print;
use adis16130_twin::{KEYS, Key};
use anyhow::Result;

pub fn run() -> Result<()> {
    print(&(keys_help() + "\n"))
}

pub fn keys_help() -> String {
    let keys: Vec<String> = KEYS.iter().map(entry).collect();
    format!(
        "Keys of --device twin:KEY=VALUE,KEY=VALUE,… (drawn: by the seed, so every seed is another unit)\n\n{}\n\n\
         For example: zerorate calibrate --device twin:seed=7,bias_dps=0.8\n\
         axes=3 makes a part with the axes x, y and z. Each has its own bias and noise.\n\
         All axes share one clock and one temperature.",
        keys.join("\n")
    )
}

fn entry(key: &Key) -> String {
    let Key { name, default, help, .. } = key;
    format!("  {name:<17} {help}\n  {:<17} {} [default: {default}]", "", key.allowed())
}
