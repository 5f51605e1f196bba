//! Messages that robots read, made of judged rows: `sensor_msgs/Imu` and `sensor_msgs/Temperature`.

use super::cdr::Cdr;
use crate::CaptureError;
use crate::judging::{JudgedRow, Judging};
use crate::layout::Layout;
use crate::robot_log::{RobotLog, Stamps};
use crate::row::Row;
use std::path::Path;
use zerorate::calibration::CalibratedAxis;
use zerorate::{Axis, Calibration};

/// The frame in which rates are stated, as robots commonly call it.
const FRAME: &str = "imu_link";

/// Variance of an axis that the part does not have, (rad/s)²: so large that no filter trusts the axis.
const UNKNOWN_VARIANCE: f64 = 1e6;

/// Noise bandwidth of a low-pass of first order over its bandwidth at −3 dB. One of higher order has less.
const NOISE_BANDWIDTH: f64 = std::f64::consts::FRAC_PI_2;

/// Makes the messages.
pub struct Robot {
    judging: Judging,
    /// The direction of each axis: x, y or z.
    directions: Vec<usize>,
    noise: Vec<AxisNoise>,
    temp_variance_c2: f64,
    stamps: Stamps,
    /// Offset added to `t_ns`.
    offset_ns: Option<i64>,
    /// The id of the calibration that corrected it.
    pub calibration_id: Option<String>,
}

/// The known errors of an axis.
struct AxisNoise {
    calibrated: Option<CalibratedAxis>,
    /// Variance of a single sample, (°/s)².
    sample_dps2: Option<f64>,
}

/// The messages of a row.
pub struct RobotMessages {
    pub stamp_ns: u64,
    /// None where no axis is believed.
    pub imu: Option<Cdr>,
    pub temperature: Option<Cdr>,
}

impl Robot {
    /// Makes messages for rows of this layout; `path` names the file in messages.
    pub fn new(path: &Path, layout: &Layout, log: RobotLog) -> Result<Self, CaptureError> {
        let RobotLog { part, calibration, stamps } = log;
        let wrong = |why: String| CaptureError::damaged(path, "messages to be written", why);
        let directions = layout.directions().ok_or_else(|| {
            wrong(
                "a message of sensor_msgs/Imu has the axes x, y and z, but the axes of this part have other names \
                (docs/formats/part.md)"
                    .to_owned(),
            )
        })?;
        let names = || part.axes.iter().map(|axis| &*axis.name);
        let corrector = calibration.as_ref().map(|calibration| calibration.corrector(&part.name, names()));
        let corrector = corrector.transpose().map_err(|error| wrong(error.to_string()))?;
        let axes: Vec<Axis> = part.axes.iter().map(|axis| axis.axis).collect();
        let noise = part.axes.iter().map(|axis| AxisNoise::new(&axis.name, &axis.axis, calibration.as_ref()));
        let temp_noise_c = axes.first().and_then(|axis| axis.temp_noise_c);
        Ok(Self {
            directions,
            noise: noise.collect(),
            judging: Judging::new(layout, &axes, corrector),
            temp_variance_c2: temp_noise_c.map_or(0.0, |noise_c| noise_c * noise_c),
            stamps,
            offset_ns: None,
            calibration_id: calibration.as_ref().map(Calibration::id),
        })
    }

    /// Takes note of the times of a block of rows, before they are handed in.
    pub fn note_times(&mut self, first: &Row, last: &Row) {
        if self.offset_ns.is_none() {
            self.offset_ns = Some(match &self.stamps {
                Stamps::OfPart => 0,
                Stamps::From(began_ns) => signed(*began_ns) - signed(first.t_ns),
                Stamps::Now(clock) => signed(clock()) - signed(last.t_ns),
            });
        }
    }

    /// The stamp of a row, ns.
    pub fn stamp_ns(&self, t_ns: u64) -> u64 {
        t_ns.saturating_add_signed(self.offset_ns.unwrap_or_default())
    }

    /// Takes a row and gives the messages of an earlier row.
    pub fn push(&mut self, row: &Row) -> Option<RobotMessages> {
        let judged = self.judging.push(row)?;
        Some(self.messages(&judged))
    }

    /// The messages of those that still wait: at the end.
    pub fn finish(&mut self) -> Option<RobotMessages> {
        let judged = self.judging.finish()?;
        Some(self.messages(&judged))
    }

    fn messages(&self, judged: &JudgedRow) -> RobotMessages {
        let stamp_ns = self.stamp_ns(judged.row.t_ns);
        let temperature = judged.temp_c.map(|temp_c| {
            let mut message = Cdr::new();
            message.head(stamp_ns, FRAME).doubles(&[temp_c, self.temp_variance_c2]);
            message
        });
        RobotMessages { stamp_ns, imu: self.imu(stamp_ns, judged), temperature }
    }

    /// Orientation and acceleration are marked as absent. There is a message only where all axes can be trusted.
    fn imu(&self, stamp_ns: u64, judged: &JudgedRow) -> Option<Cdr> {
        let rates_dps = if self.calibration_id.is_some() { &judged.corrected_dps } else { &judged.rates_dps };
        let (mut rates, mut variances) = ([0.0; 3], [UNKNOWN_VARIANCE; 3]);
        let mut is_known = true;
        for ((direction, noise), rate_dps) in self.directions.iter().zip(&self.noise).zip(rates_dps) {
            rates[*direction] = (*rate_dps)?.to_radians();
            match noise.variance_dps2(judged.last_temp_c) {
                Some(dps2) => variances[*direction] = dps2.to_radians().to_radians(),
                None => is_known = false,
            }
        }
        let mut covariance = [0.0; 9];
        for (axis, variance) in variances.into_iter().enumerate().filter(|_| is_known) {
            covariance[4 * axis] = variance;
        }
        let mut absent = [0.0; 9];
        absent[0] = -1.0;
        let mut message = Cdr::new();
        message.head(stamp_ns, FRAME).doubles(&[0.0, 0.0, 0.0, 1.0]).doubles(&absent);
        message.doubles(&rates).doubles(&covariance).doubles(&[0.0; 3]).doubles(&absent);
        Some(message)
    }
}

impl AxisNoise {
    /// White noise through a bandwidth; where that is not known, through half the sample rate.
    fn new(name: &str, axis: &Axis, calibration: Option<&Calibration>) -> Self {
        let calibrated = calibration.and_then(|calibration| calibration.axis(name)).cloned();
        let white = calibrated.as_ref().and_then(|axis| axis.noise.as_ref()).map(|noise| noise.white_dps_per_rt_hz);
        let half_rate_hz = calibration.and_then(|calibration| calibration.run).map(|run| run.rate_hz / 2.0);
        let bandwidth_hz = axis.bandwidth_hz.map(|hz| NOISE_BANDWIDTH * hz).or(half_rate_hz);
        Self { calibrated, sample_dps2: white.zip(bandwidth_hz).map(|(white, hz)| white * white * hz) }
    }

    /// The variance of a corrected sample at a temperature: uncertainty of the correction, and noise of a sample.
    fn variance_dps2(&self, temp_c: Option<f64>) -> Option<f64> {
        let u_dps = self.calibrated.as_ref()?.u_correction_dps(temp_c?)?;
        Some(u_dps * u_dps + self.sample_dps2?)
    }
}

fn signed(ns: u64) -> i64 {
    i64::try_from(ns).unwrap_or(i64::MAX)
}
