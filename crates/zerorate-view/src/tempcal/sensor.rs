//! The gyroscopes and accelerometers of logs, and the fits of their axes.

use super::{AxisCurve, Measured, Points};
use crate::plot::range;
use std::path::Path;
use zerorate::temperature::curve::{
    AxisRecord, CurveRefusal, CurveWarning, LagLikelihood, LogCurve, LogMeans, MeansBuilder, check,
};
use zerorate_imu::Kind;
use zerorate_logs::{Column, Result, Series};

/// The axes and the temperature of one IMU in one log.
pub struct ImuColumns {
    /// The topic or message of the columns, which distinguishes the IMUs of a log.
    pub topic: Option<String>,
    /// The axes, with their quantities.
    pub columns: Vec<Column>,
    /// The temperature samples, °C.
    pub temps_c: Vec<f64>,
    /// Sampling rate of the temperature, Hz.
    pub temps_hz: f64,
    /// Time of the first temperature sample on the log's clock, s, if it is of another topic than the axes.
    pub temps_start_s: Option<f64>,
    /// The device id by which PX4 identifies the sensor.
    pub device_id: Option<i64>,
}

/// The gyroscope or the accelerometer of an IMU.
pub struct Sensor {
    /// The name in messages: topic or file, and the kind.
    pub name: String,
    topic: Option<String>,
    kind: Kind,
    device_id: Option<i64>,
    axes: Vec<SensorAxis>,
}

struct SensorAxis {
    name: String,
    logs: Vec<LogMeans>,
}

/// Collects the sensors of several logs of the same hardware.
#[derive(Default)]
pub struct Sensors {
    all: Vec<Sensor>,
    logs: usize,
}

impl Sensors {
    /// Adds all IMUs of the next log.
    ///
    /// # Errors
    /// Returns an error if too many samples are missing. The inner result is an error text if the log has other axes
    /// than the earlier logs, or the samples of one of them.
    pub fn take(&mut self, log: &Path, imus: Vec<ImuColumns>) -> Result<std::result::Result<(), String>> {
        for mut imu in imus {
            for column in std::mem::take(&mut imu.columns) {
                if let Err(why) = self.take_axis(log, &imu, column)? {
                    return Ok(Err(why));
                }
            }
        }
        self.logs += 1;
        let lacks = |axis: &&SensorAxis| axis.logs.len() != self.logs;
        let lacking = self.all.iter().flat_map(|sensor| &sensor.axes).find(lacks);
        Ok(lacking.map_or(Ok(()), |axis| Err(format!("{} has no axis {}", log.display(), axis.name))))
    }

    /// Adds one axis of an IMU in the next log. `imu.columns` are not read. A single log can be added axis by axis in
    /// this way.
    ///
    /// # Errors
    /// Returns an error if too many samples are missing. The inner result is an error text if the earlier logs do not
    /// have the axis, or contain the same samples.
    pub fn take_axis(
        &mut self,
        log: &Path,
        imu: &ImuColumns,
        column: Column,
    ) -> Result<std::result::Result<(), String>> {
        let Some(kind) = column.quantity.and_then(Kind::of) else { return Ok(Ok(())) };
        let name = column.name.clone();
        let means = imu.means(column, log)?;
        let is_first = self.logs == 0;
        let axes = &mut self.sensor(log, imu, kind).axes;
        match axes.iter_mut().find(|axis| axis.name == name) {
            Some(axis) if axis.logs.iter().any(|log| is_same(log, &means)) => {
                return Ok(Err(format!("{} was given before: it has the same samples", log.display())));
            }
            Some(axis) => axis.logs.push(means),
            None if is_first => axes.push(SensorAxis { name, logs: vec![means] }),
            None => return Ok(Err(format!("{} has the axis {name}, which the first log lacks", log.display()))),
        }
        Ok(Ok(()))
    }

    /// Finds or adds the sensor of this kind in an IMU.
    fn sensor(&mut self, log: &Path, imu: &ImuColumns, kind: Kind) -> &mut Sensor {
        let place = self.all.iter().position(|sensor| sensor.kind == kind && sensor.topic == imu.topic);
        let place = place.unwrap_or_else(|| {
            let ImuColumns { topic, device_id, .. } = imu;
            let of = topic.clone().unwrap_or_else(|| log.display().to_string());
            let name = format!("{of}, {}", kind.name());
            self.all.push(Sensor { name, topic: topic.clone(), kind, device_id: *device_id, axes: Vec::new() });
            self.all.len() - 1
        });
        &mut self.all[place]
    }

    /// The sensors, in the order of the first log.
    #[must_use]
    pub fn all(self) -> Vec<Sensor> {
        self.all
    }
}

/// True if two logs have means, and the same ones: then these are means of the same samples.
fn is_same(one: &LogMeans, other: &LogMeans) -> bool {
    !one.blocks().is_empty() && one.blocks() == other.blocks()
}

/// The samples of a column in the unit of results; missing samples are NaN. Error texts contain the path `log`.
///
/// # Errors
/// Returns an error if too many samples are missing.
pub fn values(column: Column, log: &Path) -> Result<Vec<f64>> {
    let scale = column.scale;
    let mut values = match column.series {
        Series::Numbers(numbers) => numbers,
        Series::Codes(_) => column.points(log)?,
    };
    if scale != 1.0 {
        values.iter_mut().for_each(|value| *value *= scale);
    }
    Ok(values)
}

/// Plausible temperatures of electronics, °C.
const POSSIBLE_C: std::ops::RangeInclusive<f64> = -80.0..=180.0;
/// Largest share of implausible temperatures that are treated as missing.
const MOST_IMPOSSIBLE: f64 = 0.01;

/// Checks temperatures, °C. A few implausible values, as from transfer errors, become NaN.
///
/// # Errors
/// Returns the lowest and the highest temperature if too many are implausible.
pub fn possible_c(mut temps_c: Vec<f64>) -> std::result::Result<Vec<f64>, (f64, f64)> {
    let is_impossible = |value: &f64| value.is_finite() && !POSSIBLE_C.contains(value);
    let impossible = temps_c.iter().filter(|value| is_impossible(value)).count();
    if impossible as f64 > MOST_IMPOSSIBLE * temps_c.len() as f64 {
        return Err(span_c(&temps_c).unwrap_or_default());
    }
    temps_c.iter_mut().filter(|value| is_impossible(value)).for_each(|value| *value = f64::NAN);
    Ok(temps_c)
}

/// The unit that the name of a temperature states, if it is not °C: `temp_F`, `T [K]`.
#[must_use]
pub fn foreign_unit(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let last = name.split(|c: char| !c.is_alphanumeric()).rfind(|word| !word.is_empty()).unwrap_or_default();
    match () {
        () if name.contains("fahrenheit") || name.contains("°f") || ["f", "degf"].contains(&last) => Some("°F"),
        () if name.contains("kelvin") || last == "k" => Some("K"),
        () => None,
    }
}

/// Lowest and highest of the finite temperatures; `None` if there are none.
#[must_use]
pub fn span_c(temps_c: &[f64]) -> Option<(f64, f64)> {
    range(temps_c.iter().copied())
}

/// The topic or message of a column: `sensor_gyro#0` for the column `sensor_gyro#0.x`.
#[must_use]
pub fn topic_of(column: &str) -> Option<String> {
    let (topic, _) = column.rsplit_once('.')?;
    let topic =
        topic.strip_suffix(".angular_velocity").or(topic.strip_suffix(".linear_acceleration")).unwrap_or(topic);
    Some(topic.to_owned())
}

/// The number of an IMU: the index in `sensor_gyro#1` or `IMU[1]`; 0 without one.
#[must_use]
pub fn number_of_imu(topic: Option<&str>) -> u32 {
    let (_, number) = topic.unwrap_or_default().trim_end_matches(']').rsplit_once(['#', '[']).unwrap_or_default();
    number.parse().unwrap_or(0)
}

/// If a log starts later than this after switch-on, s, the sensor counts as on before the log. An autopilot takes some
/// seconds to start logging.
const LATE_S: f64 = 60.0;

impl ImuColumns {
    /// True if the sensor was on before the log began. `None` if unknown: only the clock of an autopilot is known to
    /// start at switch-on.
    fn was_on(&self, start_s: Option<f64>) -> Option<bool> {
        let of_autopilot =
            |topic: &String| ["sensor_", "IMU", "GYR", "ACC"].iter().any(|start| topic.starts_with(start));
        start_s.filter(|_| self.topic.as_ref().is_some_and(of_autopilot)).map(|start_s| start_s > LATE_S)
    }

    /// Averages the samples of an axis with their temperatures. A temperature of another rate is matched by time.
    fn means(&self, column: Column, log: &Path) -> Result<LogMeans> {
        let (rate_hz, start_s, skipped_s) = (column.rate_hz, column.start_s, column.skipped_s);
        let samples = values(column, log)?;
        let was_on = if skipped_s > 0.0 { Some(true) } else { self.was_on(start_s) };
        let mut means = MeansBuilder::new(samples.len(), rate_hz).was_on(was_on);
        let temps_c = self.temps_of(samples.len(), rate_hz, start_s);
        samples.into_iter().zip(temps_c).for_each(|(sample, temp_c)| means.push(sample, temp_c));
        Ok(means.finish())
    }

    /// The last temperature up to each sample of an axis, °C; NaN where there is none. The axis has `samples` samples
    /// at `rate_hz`, and starts at `start_s` on the log's clock.
    pub fn temps_of(&self, samples: usize, rate_hz: f64, start_s: Option<f64>) -> impl Iterator<Item = f64> {
        let is_same = self.temps_c.len() == samples;
        let per_sample = self.temps_hz / rate_hz;
        let later = start_s.zip(self.temps_start_s).map(|(axis_s, temps_s)| (axis_s - temps_s) * self.temps_hz);
        (0..samples).map(move |index| {
            let at = match later {
                None if is_same => index as f64,
                None => (index as f64 + 0.5) * per_sample,
                // the middle of the sample, so that a rounding error does not select another temperature
                Some(later) => (index as f64 + 0.5) * per_sample + later,
            };
            let temp_c = if at < 0.0 { None } else { self.temps_c.get(at as usize) };
            temp_c.copied().unwrap_or(f64::NAN)
        })
    }
}

/// The fit of an axis: its numbers, its function and its points for plots.
pub type FittedAxis = (AxisCurve, LogCurve, Points);

impl Sensor {
    /// Fits the curves of the axes. The axes of a sensor share the estimate of the lag.
    ///
    /// # Errors
    /// Returns a refusal if the logs do not determine the curves.
    pub fn fitted(self, reference_c: Option<f64>) -> std::result::Result<Vec<FittedAxis>, CurveRefusal> {
        check(self.axes.iter().map(|axis| &axis.logs[..]))?;
        let of_axis = |axis: &SensorAxis| {
            let unknown = |error| CurveRefusal::of_axis(error, &axis.name);
            AxisRecord::new(axis.logs.clone()).map_err(unknown)
        };
        let records = on_threads(&self.axes, of_axis);
        let records = records.into_iter().collect::<std::result::Result<Vec<AxisRecord>, CurveRefusal>>()?;
        let indices: Vec<usize> = (0..records.len()).collect();
        let curves = on_threads(&indices, |index| {
            let others = records.iter().enumerate().filter(|(other, _)| other != index);
            records[*index].curve(&others.map(|(_, other)| other.lag()).collect::<Vec<&LagLikelihood>>())
        });
        let mut all = Vec::new();
        for ((axis, record), curve) in self.axes.iter().zip(&records).zip(curves) {
            let curve = curve.map_err(|error| CurveRefusal::of_axis(error, &axis.name))?;
            let (sensor, name, kind, device_id) = (&*self.name, &*axis.name, self.kind, self.device_id);
            let imu = number_of_imu(self.topic.as_deref());
            let mut found = AxisCurve::new(&Measured { sensor, name, kind, reference_c, imu, device_id }, &curve);
            found.warnings = curve.warnings(record.logs(), found.unit).iter().map(CurveWarning::coded).collect();
            let points = Points::new(&curve, record.logs(), &found);
            all.push((found, curve, points));
        }
        Ok(all)
    }
}

/// Applies a function to each item, with one thread per item.
#[cfg(not(target_arch = "wasm32"))]
fn on_threads<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    use std::thread;
    let of = &of;
    thread::scope(|scope| {
        let running: Vec<_> = items.iter().map(|item| scope.spawn(move || of(item))).collect();
        let join = |thread: thread::ScopedJoinHandle<'_, R>| match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        running.into_iter().map(join).collect()
    })
}

/// Applies a function to each item, without threads, which a browser lacks.
#[cfg(target_arch = "wasm32")]
fn on_threads<T, R>(items: &[T], of: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A temperature in °C that equals the log's clock in s. It has one sample a second and starts 10 s after the
    /// axis.
    #[test]
    fn a_temperature_of_another_topic_is_joined_by_time() {
        let samples = (0..20_000).map(|k| f64::from(k % 7)).collect();
        let mut axis = Column::new("x", Series::Numbers(samples), 100.0);
        axis.start_s = Some(5.0);
        let imu = ImuColumns {
            topic: None,
            columns: Vec::new(),
            temps_c: (15..205).map(f64::from).collect(),
            temps_hz: 1.0,
            temps_start_s: Some(15.0),
            device_id: None,
        };
        let means = imu.means(axis, Path::new("log")).unwrap();
        let first = means.blocks()[0];
        assert!((9.5..10.5).contains(&first.start_s), "{first:?}");
        // the temperature of a block is the time of its middle on the log's clock, which is 5 s at the first sample
        let off = means.blocks().iter().map(|block| (block.temp_c - block.start_s - block.length_s / 2.0 - 5.0).abs());
        let most = off.fold(0.0, f64::max);
        assert!(most < 0.15, "{most}");
    }

    #[test]
    fn a_name_states_another_unit_than_celsius() {
        for name in ["temp_F", "temp [°F]", "temp_degF", "imu_temp_fahrenheit", "T(F)"] {
            assert_eq!(foreign_unit(name), Some("°F"), "{name}");
        }
        assert_eq!(foreign_unit("temp [K]"), Some("K"));
        for name in ["temp", "temp_c", "temperature", "T", "temp_degC", "imu.temp_front"] {
            assert_eq!(foreign_unit(name), None, "{name}");
        }
    }
}
