//! Compares the recording with the twin's samples, and with the samples that libiio clients received.

use crate::killed::Killed;
use crate::tools::Tool;
use crate::venv::{done, printed};
use anyhow::{Context, Result, anyhow, ensure};
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::{self, JoinHandle};

pub const READDEV: Tool = Tool { program: "iio_readdev", package: "libiio-utils" };

/// Size of a sample of an ADIS16130 without a calibration, bytes: code, temperature, lost samples, time.
const SAMPLE: usize = 24;

/// The facts about a capture, from `zerorate verify`.
pub struct CaptureSummary {
    pub rows: u64,
    pub lost: u64,
    pub span_s: f64,
    sha256: String,
}

impl CaptureSummary {
    pub fn of(program: &Path, capture: &Path) -> Result<Self> {
        let report: Value =
            serde_json::from_str(&printed(Command::new(program).args(["verify", "--json"]).arg(capture))?)?;
        let file = &report["files"][0];
        ensure!(file["whole"] == true, "the recording is not whole: {file}");
        let number = |name: &str| file[name].as_u64().with_context(|| format!("no {name}: {file}"));
        Ok(Self {
            rows: number("rows")?,
            lost: number("lost")?,
            span_s: (number("last_ns")? - number("first_ns")?) as f64 * 1e-9,
            sha256: file["samples_sha256"].as_str().context("no samples_sha256")?.to_owned(),
        })
    }

    /// Checks that nothing was lost, and that every sample equals the one of a twin that runs alone and unpaced.
    pub fn check(&self, program: &Path, device: &str, folder: &Path) -> Result<()> {
        ensure!(self.lost == 0, "{} samples were lost", self.lost);
        let alone = folder.join("alone.arrows");
        let mut capture = Command::new(program);
        capture.args(["capture", "--device", device, "--samples", &self.rows.to_string(), "-o"]).arg(&alone);
        done(capture.stdout(Stdio::null()))?;
        let alone = Self::of(program, &alone)?;
        ensure!(alone.sha256 == self.sha256, "what was recorded is not what the twin gives");
        Ok(())
    }
}

/// The time, ns, and the code of each row of a capture.
pub fn rows(program: &Path, capture: &Path) -> Result<Vec<(u64, u32)>> {
    let csv = capture.with_extension("csv");
    done(Command::new(program).arg("repair").arg(capture).arg("-o").arg(&csv).stdout(Stdio::null()))?;
    let text = fs::read_to_string(csv)?;
    let lines = text.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let row = |line: &str| {
        let mut cells = line.split(',');
        Some((cells.next()?.parse().ok()?, cells.nth(1)?.parse().ok()?))
    };
    lines.map(|line| row(line).with_context(|| format!("no row: {line}"))).collect()
}

/// A running `iio_readdev`, with the arguments that a user would give.
pub struct Client {
    child: Killed,
    bytes: JoinHandle<std::io::Result<Vec<u8>>>,
}

impl Client {
    pub fn start(uri: &str) -> Result<Self> {
        let mut command = Command::new(READDEV.program);
        command.args(["-u", uri, "-b", "1024", "iio:device0"]).stdout(Stdio::piped());
        let mut child = Killed(command.spawn()?);
        let mut out = child.0.stdout.take().context("no stdout")?;
        let bytes = thread::spawn(move || {
            let mut all = Vec::new();
            out.read_to_end(&mut all).map(|_| all)
        });
        Ok(Self { child, bytes })
    }

    pub fn end(self) -> Result<Vec<u8>> {
        drop(self.child);
        Ok(self.bytes.join().map_err(|_| anyhow!("a client died"))??)
    }
}

/// Checks that the times of a client's samples increase, and that its count of missed samples does not decrease.
/// Returns the numbers of received and of missed samples.
pub fn in_order(bytes: &[u8]) -> Result<(u64, u64)> {
    let (mut count, mut missed, mut last_ns) = (0, 0, None);
    for sample in bytes.chunks_exact(SAMPLE) {
        let [stated, t_ns] = wide(sample)?;
        ensure!(last_ns.is_none_or(|last| t_ns > last), "{t_ns} ns follows {last_ns:?}");
        ensure!(stated >= missed, "{stated} missing at {t_ns} ns, and {missed} before");
        (count, missed, last_ns) = (count + 1, stated, Some(t_ns));
    }
    Ok((count, missed))
}

/// The count of missed samples, and the time, ns, in a sample.
fn wide(sample: &[u8]) -> Result<[u64; 2]> {
    let at = |at: usize| sample[at..].first_chunk().map(|bytes| u64::from_le_bytes(*bytes)).context("8 bytes");
    Ok([at(8)?, at(16)?])
}

/// Checks that a client's samples are recorded rows in order, and that they count the missing rows between them.
/// Returns the numbers of received and of missed samples.
pub fn check_client(bytes: &[u8], rows: &[(u64, u32)]) -> Result<(u64, u64)> {
    let mut at = None;
    let (mut count, mut missed) = (0, 0);
    // the client may have been stopped in the middle of a sample
    for sample in bytes.chunks_exact(SAMPLE) {
        let code = u32::from_le_bytes(*sample.first_chunk().context("a code")?);
        let [stated, t_ns] = wide(sample)?;
        let found = rows.binary_search_by_key(&t_ns, |row| row.0);
        let row = found.map_err(|_| anyhow!("a client got a sample of {t_ns} ns, which was never recorded"))?;
        ensure!(rows[row].1 == code, "a client got {code} at {t_ns} ns in place of {}", rows[row].1);
        let expected = at.map_or(stated, |(last, before): (usize, u64)| before + row.saturating_sub(last + 1) as u64);
        ensure!(at.is_none_or(|(last, _)| row > last) && stated == expected, "{stated} missing at {t_ns} ns");
        (at, count, missed) = (Some((row, stated)), count + 1, stated);
    }
    ensure!(count > 0, "a client of libiio got nothing");
    Ok((count, missed))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(row: (u64, u32), lost: u64) -> Vec<u8> {
        [&row.1.to_le_bytes()[..], &[0; 4], &lost.to_le_bytes(), &row.0.to_le_bytes()].concat()
    }

    #[test]
    fn a_client_is_held_to_the_recording() {
        let rows: Vec<(u64, u32)> = (0..10).map(|k| (1000 + 175 * u64::from(k), 8_388_608 + k)).collect();
        let bytes = |taken: &[(usize, u64)]| {
            taken.iter().flat_map(|(row, lost)| sample(rows[*row], *lost)).collect::<Vec<u8>>()
        };
        assert_eq!(check_client(&bytes(&[(2, 0), (3, 0), (6, 2)]), &rows).unwrap(), (3, 2));
        assert!(check_client(&bytes(&[(2, 0), (3, 0), (6, 0)]), &rows).is_err(), "two are missing in silence");
        assert!(check_client(&bytes(&[(2, 0), (2, 0)]), &rows).is_err(), "one came twice");
        assert!(check_client(&bytes(&[(3, 0), (2, 0)]), &rows).is_err(), "in the wrong order");
        assert!(check_client(&sample((1000, 5), 0), &rows).is_err(), "another code");
        assert!(check_client(&sample((1001, 8_388_608), 0), &rows).is_err(), "another time");
        assert!(check_client(&[0; 23], &rows).is_err(), "not one sample");
        assert_eq!(in_order(&bytes(&[(2, 0), (3, 0), (6, 2)])).unwrap(), (3, 2));
        for wrong in [[(3, 0), (3, 0)], [(3, 0), (2, 0)], [(2, 5), (3, 0)]] {
            assert!(in_order(&bytes(&wrong)).is_err(), "{wrong:?}");
        }
    }
}
