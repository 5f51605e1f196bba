//! The bias over temperature of the axes in logs, as numbers for scripts, as a table in words, as plots and as a page.

mod autopilot;
mod files;
mod page;
mod pictures;
mod sensor;
mod words;

pub use autopilot::{ardupilot, px4};
pub use files::{UnitNames, axis_name, calibration, csv};
pub use page::{TempcalPage, tempcal_page};
pub use pictures::over_temperature;
pub use sensor::{
    FittedAxis, ImuColumns, Sensor, Sensors, foreign_unit, number_of_imu, possible_c, span_c, topic_of, values,
};
use serde::Serialize;
pub use words::{refusal_text, table, warnings_of_axes};
use zerorate::temperature::curve::{CurveRefusal, LogCurve, LogMeans};
use zerorate_imu::Kind;

/// Coverage factor of 95 % intervals.
const FACTOR: f64 = 1.96;
/// Number of points of a reported curve.
const POINTS: usize = 81;
/// The default reference temperature, if the logs reach it, °C.
const REFERENCE_C: f64 = 25.0;

/// The known facts about an axis, apart from its curve.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Name of the sensor: topic or file, and the kind.
    pub sensor: &'a str,
    /// Name of the axis.
    pub name: &'a str,
    /// Gyroscope or accelerometer.
    pub kind: Kind,
    /// The requested reference temperature, °C.
    pub reference_c: Option<f64>,
    /// Number of the IMU in its flight controller, from 0.
    pub imu: u32,
    /// The device id by which PX4 identifies the sensor.
    pub device_id: Option<i64>,
}

/// The bias of an axis over temperature, in `unit`.
#[derive(Clone, Debug, Serialize)]
pub struct AxisCurve {
    /// Name of the axis.
    pub name: String,
    /// Name of the sensor: topic or file, and the kind.
    pub sensor: String,
    /// Gyroscope or accelerometer.
    pub kind: Kind,
    /// Number of the IMU in its flight controller, from 0.
    #[serde(skip)]
    pub imu: u32,
    /// The device id by which PX4 identifies the sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device_id: Option<i64>,
    /// The unit of the bias: °/s or m/s².
    pub unit: &'static str,
    /// The reference temperature, °C.
    pub reference_c: f64,
    /// Bias at the reference temperature; 0 for an accelerometer, whose bias cannot be told from gravity.
    pub bias: f64,
    /// Standard uncertainty of the bias.
    pub u_bias: f64,
    /// Change of the bias per °C at the reference temperature.
    pub slope_per_c: f64,
    /// Standard uncertainty of the slope.
    pub u_slope_per_c: f64,
    /// The bias at evenly spaced temperatures over the span of the logs.
    pub curve: Vec<CurvePoint>,
    /// The cubic polynomial for flight controllers and calibration files.
    pub cubic: CubicReport,
    /// Time constant with which the bias lags behind the thermometer, s; negative if the thermometer lags.
    pub lag_s: f64,
    /// Half width of the backlash between bias and thermometer, °C.
    pub play_c: f64,
    /// Largest standard uncertainty of the bias in case the sensor was on before the log began and its bias lags.
    /// Null if the probability of this case is at most 1 %.
    pub u_if_on_before: Option<f64>,
    /// Half of the difference between warming and cooling; null if the temperature only rose or only fell.
    pub hysteresis: Option<f64>,
    /// Standard deviation of the bias between starts of the sensor, one per log; null with one log.
    pub spread_of_starts: Option<f64>,
    /// Span of the means, largest minus smallest, before the correction.
    pub before: f64,
    /// Span of the means after the correction. Each part of the record is corrected with the curve of the other parts
    /// (cross-validation).
    pub after: f64,
    /// The noise that was estimated together with the curve.
    pub noise: CurveNoise,
    /// Warnings, with their codes.
    pub warnings: Vec<String>,
}

/// A point of a curve. The field names state the unit.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(untagged)]
#[expect(missing_docs, reason = "temperature, bias and standard uncertainty, with their units")]
pub enum CurvePoint {
    /// A point of a gyroscope's curve.
    Gyroscope { temp_c: f64, bias_dps: f64, u_dps: f64 },
    /// A point of an accelerometer's curve.
    Accelerometer { temp_c: f64, bias_mps2: f64, u_mps2: f64 },
}

impl CurvePoint {
    fn new(kind: Kind, temp_c: f64, bias: f64, u: f64) -> Self {
        match kind {
            Kind::Gyroscope => Self::Gyroscope { temp_c, bias_dps: bias, u_dps: u },
            Kind::Accelerometer => Self::Accelerometer { temp_c, bias_mps2: bias, u_mps2: u },
        }
    }

    /// Temperature, bias and standard uncertainty.
    #[must_use]
    pub fn values(&self) -> (f64, f64, f64) {
        match *self {
            Self::Gyroscope { temp_c, bias_dps, u_dps } => (temp_c, bias_dps, u_dps),
            Self::Accelerometer { temp_c, bias_mps2, u_mps2 } => (temp_c, bias_mps2, u_mps2),
        }
    }
}

/// The cubic polynomial: bias = Σ `terms[k]` · (T − `about_c`)ᵏ.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CubicReport {
    /// Temperature about which the polynomial is expanded, °C.
    pub about_c: f64,
    /// The coefficients, the constant first.
    pub terms: [f64; 4],
    /// Largest distance between the polynomial and the curve, in the unit of the axis.
    pub left: f64,
}

impl CubicReport {
    /// The coefficients of the same polynomial, expanded about another temperature, °C.
    #[must_use]
    pub fn about(&self, about_c: f64) -> [f64; 4] {
        let d = about_c - self.about_c;
        let [t0, t1, t2, t3] = self.terms;
        [t0 + d * (t1 + d * (t2 + d * t3)), t1 + d * (2.0 * t2 + d * 3.0 * t3), t2 + 3.0 * d * t3, t3]
    }
}

/// White noise, bias instability and random walk, as in an Allan analysis.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CurveNoise {
    /// White noise N, in the axis's unit times √s.
    pub n: f64,
    /// Bias instability B, in the axis's unit.
    pub b: f64,
    /// Rate random walk K, in the axis's unit per √s.
    pub k: f64,
}

impl AxisCurve {
    /// Extracts the numbers of a fitted curve.
    #[must_use]
    pub fn new(measured: &Measured<'_>, curve: &LogCurve) -> Self {
        let Measured { sensor, name, kind, reference_c, imu, device_id } = *measured;
        let (low_c, high_c) = curve.span_c();
        let has = (low_c..=high_c).contains(&REFERENCE_C);
        let reference_c = reference_c.unwrap_or(if has { REFERENCE_C } else { ((low_c + high_c) / 2.0).round() });
        let level = Level::of(kind, curve, reference_c);
        let point = |temp_c: f64| CurvePoint::new(kind, temp_c, level.bias(temp_c), level.u(temp_c));
        let mut cubic = curve.cubic(reference_c);
        cubic.terms[0] -= level.zero;
        Self {
            name: name.to_owned(),
            sensor: sensor.to_owned(),
            kind,
            imu,
            device_id,
            unit: kind.quantity().unit(),
            reference_c,
            bias: level.bias(reference_c),
            u_bias: level.u(reference_c),
            slope_per_c: curve.slope_at(reference_c),
            u_slope_per_c: curve.u_slope_at(reference_c),
            curve: curve.even_temps_c(POINTS).into_iter().map(point).collect(),
            cubic: CubicReport { about_c: reference_c, terms: cubic.terms, left: cubic.left },
            lag_s: curve.lag_s(),
            play_c: curve.following.play_c,
            u_if_on_before: curve.u_if_on_before,
            hysteresis: curve.hysteresis,
            spread_of_starts: curve.spread_of_starts,
            before: curve.span.before,
            after: curve.span.after,
            noise: CurveNoise {
                // converts the one-sided density to N
                n: curve.noise.white_dps_per_rt_hz / std::f64::consts::SQRT_2,
                b: curve.noise.bias_instability_dps,
                k: curve.noise.rate_random_walk_dps_per_rt_s,
            },
            warnings: Vec::new(),
        }
    }

    /// Checks that the bias of a gyroscope is known to `wanted_dps` (standard uncertainty, °/s) at all temperatures.
    ///
    /// # Errors
    /// Returns a refusal that names the temperature with the largest uncertainty.
    pub fn known_to(&self, wanted_dps: f64) -> Result<(), CurveRefusal> {
        let u_of = |point: &CurvePoint| match *point {
            CurvePoint::Gyroscope { temp_c, u_dps, .. } => Some((temp_c, u_dps)),
            CurvePoint::Accelerometer { .. } => None,
        };
        match self.curve.iter().filter_map(u_of).max_by(|(_, a), (_, b)| a.total_cmp(b)) {
            Some((at_c, u_dps)) if u_dps > wanted_dps => {
                Err(CurveRefusal::TooUncertain { axis: self.name.clone(), u_dps, at_c, wanted_dps })
            }
            _ => Ok(()),
        }
    }

    /// Lowest and highest temperature of the curve, °C.
    #[must_use]
    pub fn span_c(&self) -> (f64, f64) {
        let temp_c = |point: Option<&CurvePoint>| point.map_or(0.0, |point| point.values().0);
        (temp_c(self.curve.first()), temp_c(self.curve.last()))
    }
}

/// The level that is subtracted from a curve: zero for a gyroscope; for an accelerometer the value at the reference
/// temperature, since its bias cannot be told from gravity.
struct Level<'a> {
    curve: &'a LogCurve,
    zero: f64,
    reference_c: Option<f64>,
}

impl<'a> Level<'a> {
    fn of(kind: Kind, curve: &'a LogCurve, reference_c: f64) -> Self {
        match kind {
            Kind::Gyroscope => Self { curve, zero: 0.0, reference_c: None },
            Kind::Accelerometer => Self { curve, zero: curve.at(reference_c), reference_c: Some(reference_c) },
        }
    }

    fn bias(&self, temp_c: f64) -> f64 {
        self.curve.at(temp_c) - self.zero
    }

    fn u(&self, temp_c: f64) -> f64 {
        self.reference_c.map_or_else(|| self.curve.u_at(temp_c), |from_c| self.curve.u_change(from_c, temp_c))
    }
}

/// The means of an axis over blocks of its logs, prepared for plots.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// The means of all logs.
    pub all: Vec<MeanPoint>,
}

/// A mean of an axis over part of a log, with its residual.
#[derive(Clone, Copy, Debug)]
pub struct MeanPoint {
    /// Time of the mean since the first sample of its log, s.
    pub at_s: f64,
    /// Temperature, °C.
    pub temp_c: f64,
    /// The mean without the earlier steps of its log, less the level that is subtracted from the curve, °/s or m/s².
    pub value: f64,
    /// Residual: the value minus the curve at the temperature that the bias follows.
    pub left: f64,
    /// True unless the sensor was cooling.
    pub is_warming: bool,
}

impl Points {
    /// Prepares the means for plots, and computes their residuals.
    #[must_use]
    pub fn new(curve: &LogCurve, logs: &[LogMeans], axis: &AxisCurve) -> Self {
        let zero = Level::of(axis.kind, curve, axis.reference_c).zero;
        let mut all = Vec::new();
        for (index, log) in logs.iter().enumerate() {
            let blocks = log.blocks();
            let followed_c = log.followed_c(&curve.following, curve.was_on);
            for (at, (block, temp_c)) in blocks.iter().zip(followed_c).enumerate() {
                let at_s = block.start_s + block.length_s / 2.0;
                let stepped = |step: &&zerorate::temperature::curve::CurveStep| step.log == index && step.at_s < at_s;
                let steps: f64 = curve.steps.iter().filter(stepped).map(|step| step.size).sum();
                let near = blocks[at.saturating_sub(NEAR)..(at + NEAR + 1).min(blocks.len())].iter();
                let ends = near.clone().next().zip(near.last());
                all.push(MeanPoint {
                    at_s,
                    temp_c: block.temp_c,
                    value: block.rate_dps - zero - steps,
                    left: block.rate_dps - steps - curve.at(temp_c),
                    is_warming: ends.is_some_and(|(first, last)| last.temp_c >= first.temp_c),
                });
            }
        }
        Self { all }
    }
}

/// Number of means on each side that decide whether the sensor is warming.
const NEAR: usize = 5;
