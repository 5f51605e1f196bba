//! Condenses the capture of a calibration to means over time, for plots.

use anyhow::{Context, Result, ensure};
use std::path::Path;
use zerorate::{Calibration, Part};
use zerorate_host::Stop;
use zerorate_record::{CaptureReader, Layout, Row, SampleHash};
use zerorate_view::report::{Course, Moment};

/// Averaging time of a mean, ns.
const LENGTH_NS: u64 = 5_000_000_000;
/// The checksum in a calibration covers up to this many rows more than the samples that the calibration states.
const ROWS_BEHIND: u64 = 64;

/// Averages the samples of a capture that the calibration used: all, or the first ones. `stop` can end the reading.
///
/// # Errors
/// Returns an error if the capture is damaged, if a stop is requested, or if the calibration was made from another
/// capture or does not state its capture.
pub fn course(
    capture: &Path,
    mut reader: CaptureReader,
    part: &Part,
    calibration: &Calibration,
    stop: &Stop,
) -> Result<Course> {
    let made_from = calibration.capture_sha256.as_ref().zip(calibration.run.as_ref());
    let (sha256, run) = made_from.context("the calibration does not state its capture; leave out --capture")?;
    let layout = reader.info().layout.clone();
    let mut hash = SampleHash::new(&layout);
    let (mut moments, mut start_ns, mut sums, mut rows) = (Vec::new(), None, Sums::default(), 0);
    'all: while let Some(batch) = reader.next_rows()? {
        ensure!(!stop.asked(), "interrupted; nothing written");
        for row in batch.iter() {
            hash.update(&row);
            let stretch = row.t_ns.saturating_sub(*start_ns.get_or_insert(row.t_ns)) / LENGTH_NS;
            if stretch != sums.stretch {
                moments.push(sums.moment());
                sums = Sums { stretch, ..Sums::default() };
            }
            sums.add(&layout, part, &row);
            rows += 1;
            if (run.samples..=run.samples + ROWS_BEHIND).contains(&rows) && hash.hex() == *sha256 {
                break 'all;
            }
        }
    }
    moments.push(sums.moment());
    ensure!(
        hash.hex() == *sha256,
        "{} is not the capture that the calibration was made from; give that one, or leave out --capture",
        capture.display()
    );
    Ok(Course { axes: part.axes.iter().map(|axis| axis.name.to_string()).collect(), moments })
}

#[derive(Default)]
struct Sums {
    stretch: u64,
    temp_c: Sum,
    rates_dps: Vec<Sum>,
}

impl Sums {
    fn add(&mut self, layout: &Layout, part: &Part, row: &Row) {
        self.rates_dps.resize(part.axes.len(), Sum::default());
        for (index, axis) in part.axes.iter().enumerate() {
            let Some(reading) = layout.reading(row, index).filter(|reading| !reading.out_of_range) else { continue };
            self.rates_dps[index].add(axis.axis.rate.value(reading.rate.into()));
            // all axes have the same temperature
            if let Some(code) = reading.temp.filter(|_| index == 0) {
                self.temp_c.add(axis.axis.temp.value(code.into()));
            }
        }
    }

    fn moment(&self) -> Moment {
        let at_s = (self.stretch as f64 + 0.5) * LENGTH_NS as f64 * 1e-9;
        Moment { at_s, temp_c: self.temp_c.mean(), rates_dps: self.rates_dps.iter().map(Sum::mean).collect() }
    }
}

#[derive(Clone, Default)]
struct Sum {
    total: f64,
    count: u64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        self.total += value;
        self.count += 1;
    }

    /// NaN without values.
    fn mean(&self) -> f64 {
        self.total / self.count as f64
    }
}
