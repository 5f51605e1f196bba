//! Compares the program's captures, made through the kernel's HID driver, with what the HID gyroscope sent.

use super::files::{Files, GuestRow, run_of};
use anyhow::{Context, Result};
use serde_json::Value;
use std::collections::HashMap;

/// The captures through the kernel's buffer. The first ends after the requested length, the second when readings stop,
/// and the third when the gyroscope is unplugged.
const BUFFERED: [&str; 3] = ["hid", "hidsilent", "hidcut"];
pub const CAPTURES: [&str; 4] = ["hid", "hidsilent", "hidcut", "hidpolled"];

/// Attributes that the kernel must show, from the properties in `gyro.rs`: 0.01 °/s, 100 Hz.
const ATTRIBUTES: [(&str, &str); 5] = [
    ("name", "gyro_3d"),
    // 0.01 π/180 rad/s, truncated to nine decimals
    ("in_anglvel_scale", "0.000174532"),
    ("in_anglvel_offset", "0"),
    ("in_anglvel_sampling_frequency", "100.000000"),
    ("in_anglvel_z_type", "le:s16/32>>0"),
];
const RATE_HZ: f64 = 100.0;
/// The kernel's scale in codes per °/s.
const LSB_PER_DPS: f64 = 0.017_453_292_519_943_295 / 0.000_174_532;

/// Share of the readings whose losses may be miscounted, because a host that pauses the machine delays the readings.
/// It is also the largest relative error of the probed rate.
const TOLERANCE: f64 = 0.02;
const TOLERANCE_READINGS: f64 = 3.0;
/// Smallest number of losses that shows that a capture counts losses: 4 of 50 readings are withheld.
const ENOUGH_LOST: u64 = 4;

struct HidReading {
    number: u32,
    codes: Vec<i64>,
    /// The gyroscope's clock before and after sending, ns.
    between_ns: (i64, i64),
    /// True if the reading was sent on request.
    asked: bool,
}

struct Stream {
    name: &'static str,
    samples: usize,
    /// True if the samples are the readings that were sent, in order.
    are_those_sent: bool,
    /// The smallest and the largest offset between the clocks of kernel and gyroscope that fits all times, ns.
    offset_ns: (i64, i64),
    lost_counted: u64,
    lost_in_truth: u64,
    /// Number of readings whose `lost` is wrong.
    miscounted: usize,
}

/// Checks the results about the HID gyroscope.
pub fn check(files: &Files, check: &mut impl FnMut(bool, String)) -> Result<()> {
    check_scales(files, check)?;
    for (name, code) in
        [("hid", 0), ("hidprobe", 0), ("hidpolled", 0), ("hidsilent", 1), ("hidbusy", 1), ("hidcut", 1)]
    {
        let (holds, statement) = files.ending(name, code)?;
        check(holds, statement);
    }
    let text = files.text("hid.sent")?;
    let sent = text.lines().skip(1).map(|line| HidReading::parse(line).with_context(|| format!("hid.sent: {line}")));
    let sent: Vec<HidReading> = sent.collect::<Result<_>>()?;
    let reports: Vec<&HidReading> = sent.iter().filter(|sent| !sent.asked).collect();
    let buffered = BUFFERED.iter().map(|name| Ok(Stream::new(name, &files.rows(name)?, &reports)));
    let buffered: Vec<Stream> = buffered.collect::<Result<_>>()?;
    for stream in &buffered {
        stream.check(check);
    }
    let polled = files.rows("hidpolled")?;
    let is_polled = polled.len() >= 50 && axes_in_order(&polled, &sent) == 3;
    check(is_polled, format!("polled: {} samples of 3 axes are of those it had", polled.len()));
    let probe: Value = serde_json::from_str(&files.text("hidprobe.json")?).context("hidprobe.json")?;
    let axes: Vec<&Value> = probe["axes"].as_array().into_iter().flatten().map(|axis| &axis["name"]).collect();
    let rdy_hz = probe["rdy_hz"].as_f64().context("rdy_hz")?;
    let is_probed = axes == ["x", "y", "z"] && (rdy_hz / RATE_HZ - 1.0).abs() < TOLERANCE;
    check(is_probed, format!("probed: {} axes, {rdy_hz:.2} Hz", axes.len()));
    check_errors(files, &buffered, check)
}

fn check_scales(files: &Files, check: &mut impl FnMut(bool, String)) -> Result<()> {
    for (name, expected) in ATTRIBUTES {
        let is = files.text(&format!("hid.{name}"))?;
        check(is == expected, format!("the HID gyroscope's driver states {name} = {is}"));
    }
    for axis in ["x", "y", "z"] {
        let key = format!("axis.{axis}.lsb_per_unit");
        let lsb: f64 = files.said("hid", &key)?.parse()?;
        check((lsb / LSB_PER_DPS - 1.0).abs() < 1e-12, format!("its {key} is that scale: {lsb}"));
    }
    let part = files.said("hidpolled", "part")?;
    check(part == "GYRO_3D", format!("with a file of the part it is called {part}, as there"));
    Ok(())
}

fn check_errors(files: &Files, buffered: &[Stream], check: &mut impl FnMut(bool, String)) -> Result<()> {
    let busy = files.text("hidbusy.err")?;
    check(busy.contains("another program reads it"), format!("hidbusy: {busy}"));
    for (name, said) in [("hidsilent", "no scan came for 1 s"), ("hidcut", "the device is gone")] {
        let error = files.text(&format!("{name}.err"))?;
        let samples = buffered.iter().find(|stream| stream.name == name).map_or(0, |stream| stream.samples);
        let whole = error.contains(&format!("ends after {samples} samples"));
        check(whole && error.contains(said), format!("{name}: {error}"));
    }
    Ok(())
}

impl HidReading {
    fn parse(line: &str) -> Option<Self> {
        let fields: Vec<i64> = line.split(',').map(|field| field.parse().ok()).collect::<Option<_>>()?;
        let [number, x, y, z, before_ns, after_ns, asked] = fields[..] else { return None };
        Some(Self {
            number: number.try_into().ok()?,
            codes: vec![x, y, z],
            between_ns: (before_ns, after_ns),
            asked: asked == 1,
        })
    }
}

impl Stream {
    fn new(name: &'static str, rows: &[GuestRow], reports: &[&HidReading]) -> Self {
        let codes: Vec<&[i64]> = rows.iter().map(|row| &row.codes[..]).collect();
        let sent = run_of(&codes, reports, |sent| &sent.codes[..]);
        let pairs = || rows.iter().zip(sent);
        let before = |(row, sent): (&GuestRow, &&HidReading)| row.t_ns as i64 - sent.between_ns.1;
        let after = |(row, sent): (&GuestRow, &&HidReading)| row.t_ns as i64 - sent.between_ns.0;
        // the kernel's time of a reading is between the times before and after sending it
        let offset_ns = (pairs().map(before).max().unwrap_or(0), pairs().map(after).min().unwrap_or(0));
        let missing = sent.windows(2).map(|two| u64::from(two[1].number - two[0].number - 1));
        let counted = rows.iter().skip(1).map(|row| row.lost);
        Self {
            name,
            samples: rows.len(),
            are_those_sent: !sent.is_empty(),
            offset_ns,
            lost_counted: counted.clone().sum(),
            lost_in_truth: missing.clone().sum(),
            miscounted: missing.zip(counted).filter(|(missing, counted)| missing != counted).count(),
        }
    }

    fn check(&self, check: &mut impl FnMut(bool, String)) {
        let Self { name, samples, are_those_sent, offset_ns: (least, most), .. } = self;
        check(*are_those_sent, format!("{name}: its {samples} readings of 3 axes are those sent, none is missing"));
        let width_ns = most - least;
        check(
            width_ns >= 0,
            format!("{name}: each timestamp is the time of hand-over, by one clock ({width_ns} ns of slack)"),
        );
        let allowed = TOLERANCE * (*samples as f64 + self.lost_in_truth as f64) + TOLERANCE_READINGS;
        let Self { lost_counted, lost_in_truth, miscounted, .. } = self;
        check(
            *lost_in_truth >= ENOUGH_LOST
                && *miscounted as f64 <= allowed
                && (*lost_counted as f64 - *lost_in_truth as f64).abs() <= allowed,
            format!("{name}: {lost_counted} are counted as lost, {lost_in_truth} are"),
        );
    }
}

/// Number of axes on which every captured code was sent, and the codes are in the order of sending.
fn axes_in_order(rows: &[GuestRow], sent: &[HidReading]) -> usize {
    let in_order = |axis: &usize| {
        // each code belongs to a single reading (`gyro.rs`)
        let number: HashMap<i64, u32> = sent.iter().map(|sent| (sent.codes[*axis], sent.number)).collect();
        let numbers: Option<Vec<u32>> = rows.iter().map(|row| number.get(row.codes.get(*axis)?).copied()).collect();
        numbers.is_some_and(|numbers| numbers.is_sorted())
    };
    (0..3).filter(in_order).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings 1, 2, 4 and 5 as the gyroscope sent them (3 was withheld), and the guest's rows of 2, 4 and 5.
    fn seen() -> (Vec<HidReading>, Vec<GuestRow>) {
        let sent = |number: u32| {
            let t_ns = i64::from(number) * 10_000_000;
            let codes = [1, 2, 3].map(|axis| axis * i64::from(number)).to_vec();
            HidReading { number, codes, between_ns: (t_ns, t_ns + 2_000), asked: false }
        };
        let row = |number: u32, lost| {
            let t_ns = 5_000_000_000 + u64::from(number) * 10_000_000 + 1_000;
            GuestRow { t_ns, edge: number, codes: sent(number).codes, lost }
        };
        ([1, 2, 4, 5].map(sent).into(), vec![row(2, 0), row(4, 1), row(5, 0)])
    }

    fn stream((sent, rows): &(Vec<HidReading>, Vec<GuestRow>)) -> Stream {
        Stream::new("hid", rows, &sent.iter().collect::<Vec<_>>())
    }

    #[test]
    fn readings_are_held_against_those_sent() {
        let good = stream(&seen());
        assert!(good.are_those_sent && good.offset_ns == (4_999_999_000, 5_000_001_000));
        assert_eq!((good.lost_counted, good.lost_in_truth, good.miscounted), (1, 1, 0));
        let mut swapped = seen();
        swapped.1.swap(0, 1);
        assert!(!stream(&swapped).are_those_sent);
    }

    #[test]
    fn a_late_time_and_a_wrong_count_are_found() {
        let mut wrong = seen();
        (wrong.1[1].t_ns, wrong.1[1].lost) = (wrong.1[1].t_ns + 5_000, 0);
        let wrong = stream(&wrong);
        assert!(wrong.offset_ns.0 > wrong.offset_ns.1);
        assert_eq!(wrong.miscounted, 1);
    }

    #[test]
    fn polls_must_not_go_back() {
        let (sent, mut rows) = seen();
        assert_eq!(axes_in_order(&rows, &sent), 3);
        rows[2].codes[1] = 2;
        assert_eq!(axes_in_order(&rows, &sent), 2);
        rows[2].codes[0] = 77;
        assert_eq!(axes_in_order(&rows, &sent), 1);
    }
}
