//! Compares the guest's data with those of the simulated part, and the guest's results with the truth.

use super::files::{Files, run_of};
use super::part::{Record, RegisterReading};
use super::{SLOW_CAPTURES, hid};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::PathBuf;
use std::time::Duration;

/// The data that guest and part recorded in one run.
pub struct RigData {
    pub files: PathBuf,
    pub iio: Record,
    pub spi: Record,
    pub fast: Record,
    pub calibrate: Record,
    pub cut: Record,
    pub replug: Record,
    /// The calibration of the same unit on this computer, without the guest's kernel and bus.
    pub host: Value,
}

/// A capture of the guest, compared with the part's own record.
struct Stream {
    samples: u64,
    /// Number of edges from the first sample to the last.
    edges_guest: u32,
    edges_of_part: u32,
    lost_counted: u64,
    lost_of_part: u64,
    /// Number of readings that the part made after the first sample, computed from the time span and the part's clock.
    updates: f64,
    codes_guest: Vec<u32>,
    codes_part: Vec<u32>,
}

/// Allowed difference between counts, as a share of the part's readings. If the guest cannot keep up, its timestamps
/// are late by up to a period, while the driver counts by the nominal clock.
const COUNT_TOLERANCE: f64 = 0.02;

/// Cycles of MCLK for a pair of readings: two conversions of 527 cycles (F-31).
const CYCLES_OF_A_PAIR: f64 = 1054.0;

/// Number of losses that may not be reported yet at the end of a capture, or that late timestamps may hide.
const UNREPORTED: f64 = 3.0;

/// Prints each check with its result. Returns an error if one failed.
pub fn run(seed: u64, seen: &RigData, duration: Duration) -> Result<()> {
    let files = Files(&seen.files);
    let slow = SLOW_CAPTURES.into_iter().map(|name| Stream::new(&files, name, &seen.spi));
    let slow: Vec<Stream> = slow.collect::<Result<_>>()?;
    let fast = Stream::new(&files, "fast", &seen.fast)?;
    let checks = checks(&files, seen, &slow, &fast)?;
    eprintln!("Linux {}, part seed={seed}, {:.0} s", files.text("kernel")?, duration.as_secs_f64());
    for (holds, statement) in &checks {
        eprintln!("  {}  {}", if *holds { "ok  " } else { "FAIL" }, statement.trim());
    }
    // how well the guest kept up depends on the load of the host, so this is not checked
    for (name, stream) in slow.iter().map(|stream| ("100 Hz", stream)).chain([("1 kHz", &fast)]) {
        eprintln!("        at {name} the guest saw {}", stream.edges());
    }
    match checks.iter().filter(|(holds, _)| !holds).count() {
        0 => Ok(()),
        failed => bail!("{failed} of {} checks failed", checks.len()),
    }
}

/// All checks: whether each holds, and what it states.
fn checks(files: &Files, seen: &RigData, slow: &[Stream], fast: &Stream) -> Result<Vec<(bool, String)>> {
    let mut checks = Vec::new();
    let mut check = |holds: bool, statement: String| checks.push((holds, statement));
    check_kernel_driver(files, &seen.iio, &mut check)?;
    hid::check(files, &mut check)?;
    for name in ["iio", "probe", "bytes", "slow1", "slow2", "slow3", "fast", "calibrate", "cut", "replug"] {
        let (holds, statement) = files.ending(name, u8::from(name == "cut"))?;
        check(holds, statement);
    }
    for stream in slow {
        check(stream.samples > 0 && stream.is_complete(), format!("at 100 Hz {}", stream.losses()));
    }
    check(fast.samples > 0 && fast.is_complete(), format!("at 1 kHz {}", fast.losses()));
    let unplugged = Stream::new(files, "cut", &seen.cut)?;
    check(unplugged.is_complete(), format!("until the cable is pulled {}", unplugged.losses()));
    let error = files.text("cut.err")?;
    check(error.contains("/dev/spidev0.0 is gone"), format!("unplugged: {error}"));
    let saved = format!("ends after {} samples", unplugged.samples);
    check(
        error.contains(&saved) && files.text("cut.replay.err")?.is_empty(),
        format!("its capture is whole: {saved}"),
    );
    let reads = seen.replug.summary.seen.rate_reads;
    check(reads > 0, format!("plugged in again: {reads} reads"));
    for (what, difference, limit) in calibration(files, seen)? {
        check(difference.abs() <= limit, format!("{what}: {difference:+.5} within ±{limit:.5}"));
    }
    Ok(checks)
}

/// Compares the readings of the kernel's driver with those that the part sent to it, and its scales with the facts.
fn check_kernel_driver(files: &Files, record: &Record, check: &mut impl FnMut(bool, String)) -> Result<()> {
    for (what, file, sent) in [("rates", "iio.rate", &record.rates), ("temperatures", "iio.temp", &record.temps)] {
        let codes = files.numbers(file)?;
        // the script's readings come first, then zerorate's readings through the same driver
        let are_sent = sent.iter().take(codes.len()).map(|reading| reading.code).eq(codes.iter().copied());
        let statement = format!("the kernel driver's {} {what} are those sent", codes.len());
        check(are_sent && codes.len() >= 50, statement);
    }
    let scales = ["in_anglvel_z_scale", "in_anglvel_z_offset", "in_temp0_scale", "in_temp0_offset"];
    let scales = scales.iter().map(|name| files.text(&format!("iio.{name}"))).collect::<Result<Vec<_>>>()?;
    check(
        scales == ["0.000000743", "-8388608", "0.070957212", "-8036283"],
        format!("its scales and offsets agree with F-40 and F-41: {scales:?}"),
    );
    Ok(())
}

impl Stream {
    fn new(files: &Files, capture: &str, record: &Record) -> Result<Self> {
        let rows = files.rows(capture)?;
        let codes = rows.iter().map(|row| row.codes.first().and_then(|code| u32::try_from(*code).ok()));
        let codes_guest = codes.collect::<Option<Vec<u32>>>().context("a capture of another part")?;
        let sent = run_of(&codes_guest, &record.rates, |read| read.code);
        let (first, last) = (rows.first().context("an empty capture")?, rows.last().context("an empty capture")?);
        let span_s = (last.t_ns - first.t_ns) as f64 * 1e-9;
        let lost = |readings: &[RegisterReading]| Some(readings.last()?.lost_rate - readings.first()?.lost_rate);
        let edges = |readings: &[RegisterReading]| Some(readings.last()?.edges - readings.first()?.edges);
        let pairs_hz = record.summary.mclk_hz / CYCLES_OF_A_PAIR;
        Ok(Self {
            updates: span_s * pairs_hz,
            samples: rows.len() as u64,
            edges_guest: last.edge.wrapping_sub(first.edge),
            edges_of_part: edges(sent).unwrap_or(0),
            lost_counted: rows.iter().skip(1).map(|row| row.lost).sum(),
            lost_of_part: lost(sent).unwrap_or(0),
            codes_part: sent.iter().map(|reading| reading.code).collect(),
            codes_guest,
        })
    }

    /// True if three statements hold, which do not depend on the load of the host. The recorded codes are the codes
    /// that were sent, in order. At least as many losses are counted as the part knows of. The recorded and the lost
    /// samples together are all samples. Counts may differ by the tolerance.
    fn is_complete(&self) -> bool {
        let allowed = COUNT_TOLERANCE * self.updates + UNREPORTED;
        let counted = self.lost_counted as f64;
        self.codes_guest == self.codes_part
            && counted + allowed >= self.lost_of_part as f64
            && (self.samples as f64 - 1.0 + counted - self.updates).abs() <= allowed
    }

    fn losses(&self) -> String {
        let Self { samples, lost_counted, lost_of_part, .. } = self;
        format!("{samples} codes are those sent, {lost_counted} are counted as lost; the part knows of {lost_of_part}")
    }

    fn edges(&self) -> String {
        format!("{} of {} edges", self.edges_guest, self.edges_of_part)
    }
}

/// Differences of PBC and BTC in the guest from those on this computer and from the truth, at the guest's T3, each
/// with the half width of its 95 % interval.
fn calibration(files: &Files, seen: &RigData) -> Result<[(&'static str, f64, f64); 4]> {
    let guest: Value = serde_json::from_str(&files.text("calibrate.json")?).context("calibrate.json")?;
    let host = &seen.host;
    let number = |value: &Value, key: &str| value[key].as_f64().with_context(|| format!("{key} in {value}"));
    let (pbc, btc, t3) = (number(&guest, "pbc_dps")?, number(&guest, "btc_dps_per_c")?, number(&guest, "t3_c")?);
    let (host_btc, host_t3) = (number(host, "btc_dps_per_c")?, number(host, "t3_c")?);
    let host_pbc = number(host, "pbc_dps")? + (t3 - host_t3) * host_btc;
    let truth = &seen.calibrate.summary.truth;
    let (off, curvature) = (t3 - truth.sensor_c, truth.curvature_dps_per_c2);
    let true_pbc = truth.pbc_dps + (truth.btc_dps_per_c - curvature * off) * off;
    let true_btc = truth.btc_dps_per_c - 2.0 * curvature * off;
    let limit = |key: &str| -> Result<(f64, f64)> {
        let k = number(&guest, "coverage_factor")?;
        let (own, other) = (number(&guest, key)?, number(host, key)?);
        Ok((k * own, k * own.hypot(other)))
    };
    let (pbc_limit, pbc_limit_of_both) = limit("u_pbc_dps")?;
    let (btc_limit, btc_limit_of_both) = limit("u_btc_dps_per_c")?;
    Ok([
        ("PBC against the in-process twin, °/s", pbc - host_pbc, pbc_limit_of_both),
        ("PBC against the truth, °/s", pbc - true_pbc, pbc_limit),
        ("BTC against the in-process twin, °/s/°C", btc - host_btc, btc_limit_of_both),
        ("BTC against the truth, °/s/°C", btc - true_btc, btc_limit),
    ])
}
