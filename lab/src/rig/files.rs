//! Reads the files that the guest wrote.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;

pub struct Files<'a>(pub &'a Path);

pub struct GuestRow {
    pub t_ns: u64,
    pub edge: u32,
    pub codes: Vec<i64>,
    pub lost: u64,
}

impl Files<'_> {
    pub fn text(&self, name: &str) -> Result<String> {
        let path = self.0.join(name);
        Ok(fs::read_to_string(&path).with_context(|| format!("the guest left no {name}"))?.trim().to_owned())
    }

    pub fn numbers(&self, name: &str) -> Result<Vec<u32>> {
        let text = self.text(name)?;
        let numbers = text.lines().map(|line| line.parse().ok());
        numbers.collect::<Option<_>>().with_context(|| format!("{name} holds something else than numbers"))
    }

    /// Checks the exit code of a `zerorate` run in the guest. If it is wrong, the text includes the run's errors.
    pub fn ending(&self, name: &str, expected: u8) -> Result<(bool, String)> {
        let ended = self.text(&format!("{name}.code"))?;
        let holds = ended == expected.to_string();
        let complaint = if holds { String::new() } else { self.text(&format!("{name}.err"))? };
        Ok((holds, format!("{name}: zerorate ended with {ended} {complaint}")))
    }

    /// Reads a CSV capture (docs/formats/capture.md): a header after the comments, then the rows. A column `NAME_code`
    /// is an axis, except `temp_code`.
    pub fn rows(&self, capture: &str) -> Result<Vec<GuestRow>> {
        let text = self.text(&format!("{capture}.csv"))?;
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let header: Vec<&str> = lines.next().context("an empty capture")?.split(',').collect();
        let place =
            |name: &str| header.iter().position(|column| *column == name).with_context(|| format!("no {name}"));
        let (t_ns, edge, lost) = (place("t_ns")?, place("edge_seq")?, place("lost")?);
        let is_axis = |at: &usize| header[*at].ends_with("_code") && header[*at] != "temp_code";
        let axes: Vec<usize> = (0..header.len()).filter(is_axis).collect();
        let rows = lines.map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            ensure!(fields.len() == header.len(), "{capture}: {line}");
            let codes = axes.iter().map(|at| fields[*at].parse().map_err(anyhow::Error::new));
            Ok(GuestRow {
                t_ns: fields[t_ns].parse()?,
                edge: fields[edge].parse()?,
                codes: codes.collect::<Result<_>>()?,
                lost: fields[lost].parse()?,
            })
        });
        rows.collect()
    }

    /// The value of `key` in the description of a capture.
    pub fn said(&self, capture: &str, key: &str) -> Result<String> {
        let text = self.text(&format!("{capture}.csv"))?;
        let start = format!("# zerorate.{key} = ");
        let said = text.lines().find_map(|line| line.strip_prefix(&start)).map(str::to_owned);
        said.with_context(|| format!("{capture} does not say its {key}"))
    }
}

/// Finds the adjacent items of `all` whose keys are `wanted`; empty if there are none.
pub fn run_of<'a, T, K: PartialEq>(wanted: &[K], all: &'a [T], of: impl Fn(&T) -> K) -> &'a [T] {
    let mut windows = all.windows(wanted.len().max(1)).filter(|_| !wanted.is_empty());
    windows.find(|window| window.iter().zip(wanted).all(|(one, wanted)| of(one) == *wanted)).unwrap_or(&[])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_found_only_whole_and_in_order() {
        let run = |wanted: &[u32]| run_of(wanted, &[5, 6, 7, 7, 8], |one| *one).len();
        assert_eq!(run(&[7, 7, 8]), 3);
        assert_eq!([&[7, 8, 7][..], &[1; 9], &[]].map(run), [0; 3]);
    }
}
