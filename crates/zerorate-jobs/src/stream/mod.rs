//! Streams the corrected rate of a part.

mod track;

pub use track::{LearnedAxis, TrackOptions, TrackedAxis, Tracking, UnusableState};

use crate::acquisition::Acquisition;
use crate::error::CodedRefusal;
use crate::warning::JobWarning;
use anyhow::{Error, Result, bail};
use std::path::Path;
use zerorate::health::{Flags, Judged};
use zerorate::{Axis, Calibration, CodeSum, Correction, Corrector};
use zerorate_record::valid;
use zerorate_view::SessionWarning;

/// Receives the rows and the events of a stream.
pub trait Listener {
    /// Receives a row. An error ends the stream.
    fn row(&mut self, row: &StreamRow) -> Result<()>;

    /// Called after the last row.
    fn end(&mut self) -> Result<()>;

    /// Receives a warning, while the stream runs or at its end.
    fn warn(&mut self, warning: JobWarning);

    /// Called when the learned state was saved to the file `state` again, after failures.
    fn kept_again(&mut self, state: &Path);

    /// Receives the learned state of each axis, at the end.
    fn learned(&mut self, learned: &LearnedAxis<'_>);
}

/// One row of the stream: a sample, or the mean of several.
#[derive(Clone, Debug)]
pub struct StreamRow {
    /// Mid-time of the row's samples, s after the first sample of the stream.
    pub t_s: f64,
    /// The corrected rate of each axis, °/s; `None` without a valid reading.
    pub rates_dps: Vec<Option<f64>>,
    /// The temperature that the correction used, °C.
    pub temp_c: f64,
    /// Samples lost since the previous row.
    pub lost: u64,
    /// The combined fault flags of readings that were left out.
    pub flags: Flags,
    /// The tracked bias; `None` without tracking.
    pub tracked: Option<TrackedRow>,
}

/// The tracked bias at a row.
#[derive(Clone, Debug)]
pub struct TrackedRow {
    /// The tracked bias of each axis.
    pub axes: Vec<TrackedAxis>,
    /// The state of motion: moving, quiet, rest or doubtful.
    pub phase: &'static str,
}

/// The settings of a stream.
#[derive(Clone, Copy, Debug, Default)]
pub struct StreamOptions {
    /// The averaging time of a row, ns; `None` gives a row for each sample.
    pub period_ns: Option<u64>,
    /// The duration of the stream, ns; `None` for no limit.
    pub duration_ns: Option<u64>,
}

/// The row period for a number of rows per second, ns; `None` outside of 0.0001 to 1000000 Hz.
#[must_use]
pub fn period_ns(rate_hz: f64) -> Option<u64> {
    (1e-4..=1e6).contains(&rate_hz).then(|| (1e9 / rate_hz).round() as u64)
}

/// Checks that the calibration belongs to the part that is read. `given` is the part's serial number, if the user
/// states one. Messages call the calibration `cal` and the device `name`, and `advice` tells how to state the serial
/// number. Returns a warning if the check is impossible because a serial number is unknown.
///
/// # Errors
/// Returns an error if the calibration or the recording is of another part, or if only `given` is a serial number.
pub fn check_serial(
    acquisition: &Acquisition,
    (cal, calibration): (&str, &Calibration),
    (name, given): (&str, Option<&str>),
    advice: &'static str,
) -> Result<Option<JobWarning>> {
    acquisition.check_serial(given)?;
    if let (Some(given), None) = (given, &calibration.serial) {
        bail!("{cal} is the calibration of a part without a serial number, not of part {given}");
    }
    let serial = given.or(acquisition.facts().info.serial.as_deref());
    let warning = SessionWarning::of_serial((cal.to_owned(), calibration.serial.as_deref()), (name, serial), advice);
    Ok(warning.map_err(Error::msg)?.map(JobWarning::Session))
}

/// Streams the corrected rate until the samples end, the duration is over, the part freezes or `listener` fails.
///
/// # Errors
/// Returns [`CodedRefusal`] if the part is frozen, or an error if the calibration does not fit, or reading,
/// saving the learned state or `listener` fails.
pub fn stream(
    mut acquisition: Acquisition,
    calibration: &Calibration,
    options: StreamOptions,
    tracking: Option<Tracking>,
    listener: &mut dyn Listener,
) -> Result<()> {
    let mut rows = RowMaker::new(acquisition.part(), calibration, tracking, listener)?;
    let followed = rows.follow(&mut acquisition, options);
    // the learned state is saved, whatever ended the stream
    rows.finish().and(followed)?;
    acquisition.disbelief().for_each(|warning| listener.warn(warning));
    Ok(())
}

/// The samples of one row: exact sums of codes, which are divided once at the end.
#[derive(Default)]
struct Mean {
    slot: u64,
    readings: u64,
    first_ns: u64,
    last_ns: u64,
    rates: Vec<CodeSum>,
    temp: CodeSum,
    lost: u64,
    flags: Flags,
}

impl Mean {
    fn is_empty(&self) -> bool {
        self.readings == 0
    }

    #[inline]
    fn push(&mut self, t_ns: u64, slot: u64, axes: &[Judged]) {
        if self.is_empty() {
            (self.slot, self.first_ns) = (slot, t_ns);
        }
        self.last_ns = t_ns;
        self.readings += 1;
        self.rates.resize_with(axes.len(), CodeSum::default);
        for (sum, judged) in self.rates.iter_mut().zip(axes) {
            if let Some(rate) = judged.rate() {
                sum.push(rate);
            }
            self.flags = self.flags.and(judged.flags);
        }
        // all axes share the temperature and the count of losses
        if let Some(first) = axes.first() {
            if let Some(temp) = first.temp() {
                self.temp.push(temp);
            }
            self.lost += u64::from(first.reading.lost);
        }
    }

    fn t_s(&self) -> f64 {
        (self.first_ns + self.last_ns) as f64 * 0.5e-9
    }
}

/// Corrects the means and passes the rows to the listener.
struct RowMaker<'a> {
    axes: Vec<Axis>,
    corrector: Corrector<Vec<Correction>>,
    warned_of_span: bool,
    warned_of: Flags,
    tracking: Option<Tracking>,
    listener: &'a mut dyn Listener,
}

impl<'a> RowMaker<'a> {
    fn new(
        part: &zerorate::Part,
        calibration: &Calibration,
        tracking: Option<Tracking>,
        listener: &'a mut dyn Listener,
    ) -> Result<Self> {
        let corrector = calibration.corrector(&part.name, part.axes.iter().map(|axis| &*axis.name))?;
        let axes = part.axes.iter().map(|axis| axis.axis).collect();
        Ok(Self { axes, corrector, warned_of_span: false, warned_of: Flags::NONE, tracking, listener })
    }

    /// Passes rows to the listener until the end. If the part freezes, the listener gets the row so far, and a
    /// refusal is returned, since later readings are not measurements.
    fn follow(&mut self, acquisition: &mut Acquisition, options: StreamOptions) -> Result<()> {
        let mut mean = Mean::default();
        let mut judged = Vec::new();
        let period_ns = options.period_ns.unwrap_or(1);
        let ends_after_ns = options.duration_ns.unwrap_or(u64::MAX);
        let mut first_ns = None;
        while acquisition.next_judged(&mut judged)? {
            let now_ns = judged.first().map_or(0, |first| first.reading.t_ns);
            let t_ns = now_ns.saturating_sub(*first_ns.get_or_insert(now_ns));
            let slot = t_ns / period_ns;
            if !mean.is_empty() && slot != mean.slot {
                self.write(&mut mean)?;
            }
            if t_ns >= ends_after_ns {
                break;
            }
            mean.push(t_ns, slot, &judged);
            if let Some(tracking) = &mut self.tracking {
                tracking.push(t_ns, &judged, self.listener);
            }
            if let Some(frozen) = acquisition.frozen() {
                mean.flags = mean.flags.and(Flags::FROZEN);
                self.write(&mut mean)?;
                return Err(CodedRefusal::new("frozen", valid::frozen_text(&frozen, acquisition.start_ns())).into());
            }
        }
        if options.period_ns.is_none() { self.write(&mut mean) } else { Ok(()) }
    }

    /// Passes the row of these samples to the listener and empties the mean. Before the first temperature there is no
    /// row; the next row has the losses and flags of these samples.
    fn write(&mut self, mean: &mut Mean) -> Result<()> {
        // all axes have the same temperature
        self.corrector.read(self.axes.first().and_then(|first| mean.temp.mean(&first.temp)));
        let Some(temp_c) = self.corrector.temp_c().filter(|_| !mean.is_empty()) else {
            *mean = Mean { lost: mean.lost, flags: mean.flags, ..Mean::default() };
            return Ok(());
        };
        self.warn(mean.flags);
        let means = mean.rates.iter().zip(&self.axes).map(|(sum, axis)| sum.mean(&axis.rate)).enumerate();
        let mut rates_dps: Vec<_> = means.map(|(index, rate)| self.corrector.correct(index, rate)).collect();
        let correction_dps = |axis| self.corrector.correct(axis, Some(0.0)).unwrap_or_default();
        let tracked = self.tracking.as_ref().map(|tracking| tracking.row(temp_c, correction_dps));
        for (rate_dps, axis) in rates_dps.iter_mut().zip(tracked.iter().flat_map(|row| &row.axes)) {
            *rate_dps = rate_dps.map(|rate_dps| rate_dps - axis.tracked.change_dps);
        }
        self.listener.row(&StreamRow {
            t_s: mean.t_s(),
            rates_dps,
            temp_c,
            lost: mean.lost,
            flags: mean.flags,
            tracked,
        })?;
        *mean = Mean::default();
        Ok(())
    }

    fn finish(mut self) -> Result<()> {
        let temp_c = self.corrector.temp_c();
        let kept = self.tracking.as_mut().map_or(Ok(()), |tracking| tracking.finish(temp_c, self.listener));
        let ended = self.listener.end();
        kept.and(ended)
    }

    /// Warns once about an extrapolated correction, and about `flags` that had no warning before.
    fn warn(&mut self, flags: Flags) {
        if self.corrector.is_extrapolated() && !self.warned_of_span {
            self.corrector.warning().into_iter().for_each(|warning| self.listener.warn(warning.into()));
            self.warned_of_span = true;
        }
        if flags != Flags::NONE && !self.warned_of.has(flags) {
            self.listener.warn(JobWarning::LeftOut(flags));
            self.warned_of = self.warned_of.and(flags);
        }
    }
}
