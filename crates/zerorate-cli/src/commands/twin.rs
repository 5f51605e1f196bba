//! `zerorate twin`: what the simulated part can be told.

use adis16130_twin::{KEYS, Key};
use anyhow::Result;

pub fn run() -> Result<()> {
    super::print(&(keys_help() + "\n"))
}

/// The table of the keys, from the twin's own.
pub fn keys_help() -> String {
    let keys: Vec<String> = KEYS.iter().map(entry).collect();
    format!(
        "Keys of --device twin:KEY=VALUE,KEY=VALUE,… (drawn: by the seed, so every seed is another unit)\n\n{}\n\n\
         For example: zerorate calibrate --device twin:seed=7,bias_dps=0.8",
        keys.join("\n")
    )
}

fn entry(key: &Key) -> String {
    let Key { name, default, help, .. } = key;
    format!("  {name:<17} {help}\n  {:<17} {} [default: {default}]", "", key.allowed())
}
