//! Runs an image in QEMU and parses its output: readings and counts.

use super::scenario::Reading;
use super::tracking::TrackerState;
use crate::venv::printed;
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// log₂ of the virtual time, ns, that QEMU counts for an instruction.
const SHIFT: u32 = 10;

/// Length of a tick of SysTick, ns. The core of the mps2-an386 runs at 25 MHz.
const TICK_NS: u32 = 40;

#[derive(Default)]
pub struct Report {
    pub readings: Vec<Reading>,
    pub tracked: Vec<TrackerState>,
    /// Smallest and largest number of instructions of each measured operation, by its name.
    pub instructions: BTreeMap<String, (u64, u64)>,
    /// Sizes of objects in RAM, bytes.
    pub bytes: BTreeMap<String, u64>,
}

/// Runs an image to its end, with `arguments` as its command line, and returns its output. Returns an error if the
/// image exits with a failure code.
pub fn run(image: &Path, arguments: &[String]) -> Result<String> {
    let arguments: String = arguments.iter().map(|argument| format!(",arg={argument}")).collect();
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-icount", &format!("shift={SHIFT},sleep=off")]);
    qemu.args(["-semihosting-config", &format!("enable=on,target=native,arg=firmware{arguments}")]);
    printed(qemu.arg("-kernel").arg(image))
}

pub fn version() -> Result<String> {
    let text = printed(Command::new("qemu-system-arm").arg("--version"))?;
    Ok(text.split_whitespace().nth(3).unwrap_or("unknown").to_owned())
}

impl Report {
    pub fn parse(text: &str) -> Result<Self> {
        let mut report = Self::default();
        let mut ticks = BTreeMap::new();
        for line in text.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let number = |index: usize| -> Result<i64> {
                let word = words.get(index).with_context(|| format!("`{line}` is too short"))?;
                word.parse().with_context(|| format!("`{word}` in `{line}` is not a number"))
            };
            match words[..] {
                ["reading", ..] => report.readings.push(Reading {
                    rate_code: number(1)? as u32,
                    temp_code: number(2)? as u32,
                    corrected_code: number(3)? as u32,
                    curved_code: number(4)? as u32,
                    table_udps: number(5)? as i32,
                    corrected_f32_bits: number(6)? as u32,
                }),
                ["tracked", ..] => report.tracked.push(TrackerState {
                    change_bits: number(1)? as u64,
                    u_bits: number(2)? as u64,
                    phase: number(3)? as u8,
                }),
                ["ticks", name, ..] => drop(ticks.insert(name.to_owned(), (number(2)?, number(3)?))),
                ["bytes", name, ..] => drop(report.bytes.insert(name.to_owned(), number(2)? as u64)),
                _ => bail!("the image said `{line}`"),
            }
        }
        let (empty, _) = ticks.remove("empty").context("the image did not say what counting itself takes")?;
        report.instructions = ticks
            .into_iter()
            .map(|(name, (least, most))| Ok((name, (instructions(least - empty)?, instructions(most - empty)?))))
            .collect::<Result<_>>()?;
        Ok(report)
    }
}

/// Converts ticks to a whole number of instructions. Ticks are rounded down at the start and at the end.
fn instructions(ticks: i64) -> Result<u64> {
    let per_instruction = f64::from(1u32 << SHIFT) / f64::from(TICK_NS);
    let count = (ticks as f64 / per_instruction).round();
    ensure!(
        (count * per_instruction - ticks as f64).abs() <= 2.0,
        "{ticks} ticks are not a whole number of instructions"
    );
    Ok(count as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A measurement: 1 000 rounds of a loop took 80 947 ticks, which are 3 162 instructions.
    #[test]
    fn ticks_are_instructions() {
        assert_eq!(instructions(80_947).unwrap(), 3162);
        assert_eq!((instructions(0).unwrap(), instructions(26).unwrap(), instructions(51).unwrap()), (0, 1, 2));
        assert!(instructions(39).is_err());
    }
}
