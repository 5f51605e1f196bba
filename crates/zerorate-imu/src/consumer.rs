//! Noise files for the programs that use the noise of an IMU. Each file explains its numbers.
//!
//! `docs/imu.md` states which number goes where, and the source of each rule.

use super::numbers::{AxisNumbers, NoiseFileOptions, Numbers, Sensor, SourcedNumber};
use zerorate_allan::Usage;
use zerorate_input::plain;

const SOFTWARE: &str = concat!("zerorate ", env!("CARGO_PKG_VERSION"));

/// The program that reads the noise file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Format {
    /// Kalibr: imu.yaml, continuous densities.
    Kalibr,
    /// OpenVINS: `kalibr_imu_chain.yaml`, with the keys and units of Kalibr below `imu0`.
    Openvins,
    /// VINS-Mono and VINS-Fusion: standard deviations of single samples.
    Vins,
    /// ORB-SLAM3: the IMU's part of the settings, continuous densities.
    Orbslam3,
    /// KF-GINS: the section `imunoise` of its settings, by axis, the bias as a Gauss–Markov process.
    KfGins,
    /// Covariances of `sensor_msgs/Imu` of ROS.
    Ros,
}

impl Format {
    /// All formats, in the order in which front ends list them.
    pub const ALL: [Self; 6] = [Self::Kalibr, Self::Openvins, Self::Vins, Self::Orbslam3, Self::KfGins, Self::Ros];

    /// The name of the format as an option value.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kalibr => "kalibr",
            Self::Openvins => "openvins",
            Self::Vins => "vins",
            Self::Orbslam3 => "orbslam3",
            Self::KfGins => "kf-gins",
            Self::Ros => "ros",
        }
    }

    /// True if the format has a number for each of three axes.
    #[must_use]
    pub const fn is_by_axis(self) -> bool {
        matches!(self, Self::KfGins | Self::Ros)
    }

    /// The use of N and K in the program that reads the noise file: in a filter, or in a batch estimate.
    #[must_use]
    pub(super) const fn usage(self) -> Usage {
        match self {
            Self::Kalibr => Usage::Batch,
            _ => Usage::Filter,
        }
    }

    /// The name of the program that reads the file, for messages. The name of the file or message follows in brackets,
    /// if it is fixed.
    #[must_use]
    pub fn reader(self) -> &'static str {
        match self {
            Self::Kalibr => "Kalibr (imu.yaml)",
            Self::Openvins => "OpenVINS (kalibr_imu_chain.yaml)",
            Self::Vins => "VINS-Mono and VINS-Fusion",
            Self::Orbslam3 => "ORB-SLAM3",
            Self::KfGins => "KF-GINS",
            Self::Ros => "ROS (sensor_msgs/Imu)",
        }
    }

    pub(super) fn text(self, numbers: &Numbers) -> String {
        let mut file = Text::default();
        match self {
            Self::Kalibr => kalibr(&mut file, numbers, ""),
            Self::Openvins => openvins(&mut file, numbers),
            Self::Vins => vins(&mut file, numbers),
            Self::Orbslam3 => orbslam3(&mut file, numbers),
            Self::KfGins => kf_gins(&mut file, numbers),
            Self::Ros => ros(&mut file, numbers),
        }
        file.0
    }
}

fn kalibr(file: &mut Text, numbers: &Numbers, indent: &str) {
    if indent.is_empty() {
        file.head(
            numbers,
            Format::Kalibr,
            "Continuous time: σ²(τ) = n²/τ and w²τ/3, two-sided densities n² and w²/(2πf)²",
        );
    }
    let (gyroscope, accelerometer) = (numbers.gyroscope.as_ref(), numbers.accelerometer.as_ref());
    file.number(&format!("{indent}gyroscope_noise_density"), gyroscope.map(|all| &all.n), "rad/s/√Hz");
    file.number(&format!("{indent}gyroscope_random_walk"), gyroscope.map(|all| &all.k), "rad/s²/√Hz");
    file.number(&format!("{indent}accelerometer_noise_density"), accelerometer.map(|all| &all.n), "m/s²/√Hz");
    file.number(&format!("{indent}accelerometer_random_walk"), accelerometer.map(|all| &all.k), "m/s³/√Hz");
    let topic = match &numbers.choice.topic {
        Some(topic) => format!("{}   # of the log", quoted(topic)),
        None => format!("{}   # the log does not state it: put yours here", quoted("/imu0")),
    };
    file.line(&format!("{indent}rostopic: {topic}"));
    file.plain(&format!("{indent}update_rate"), numbers.rate_hz, "Hz, as recorded");
}

/// Values beside the noise that OpenVINS wants and that cannot be measured at rest: no rotation, no misalignment, no
/// delay, scales of 1.
const OPENVINS_REST: &str = "  T_i_b:
    - [1.0, 0.0, 0.0, 0.0]
    - [0.0, 1.0, 0.0, 0.0]
    - [0.0, 0.0, 1.0, 0.0]
    - [0.0, 0.0, 0.0, 1.0]
  time_offset: 0.0
  model: \"kalibr\"
  Tw:
    - [1.0, 0.0, 0.0]
    - [0.0, 1.0, 0.0]
    - [0.0, 0.0, 1.0]
  R_IMUtoGYRO:
    - [1.0, 0.0, 0.0]
    - [0.0, 1.0, 0.0]
    - [0.0, 0.0, 1.0]
  Ta:
    - [1.0, 0.0, 0.0]
    - [0.0, 1.0, 0.0]
    - [0.0, 0.0, 1.0]
  R_IMUtoACC:
    - [1.0, 0.0, 0.0]
    - [0.0, 1.0, 0.0]
    - [0.0, 0.0, 1.0]
  Tg:
    - [0.0, 0.0, 0.0]
    - [0.0, 0.0, 0.0]
    - [0.0, 0.0, 0.0]";

fn openvins(file: &mut Text, numbers: &Numbers) {
    file.line("%YAML 1.0\n---");
    file.head(numbers, Format::Openvins, "Continuous time, with the keys and units of Kalibr");
    file.line("imu0:");
    kalibr(file, numbers, "  ");
    file.line("  # not from this record, which was at rest: no rotation, no delay, scales of 1");
    file.line(OPENVINS_REST);
}

/// Standard gravity, m/s². The noise file for VINS asks the user to put in the local gravity.
const G_NORM: &str = "9.80665";

fn vins(file: &mut Text, numbers: &Numbers) {
    file.line("%YAML 1.0\n---");
    let why = "Standard deviations of single samples at the rate below, n·√rate and w·√rate: its propagation \
               multiplies each by dt once per sample (integration_base.h)";
    file.head(numbers, Format::Vins, why);
    let Numbers { rate_hz, .. } = numbers;
    let [gyroscope, accelerometer] = [&numbers.gyroscope, &numbers.accelerometer].map(|all| {
        let all = all.as_ref();
        let per_sample = |one: &SourcedNumber| one.times(rate_hz.sqrt());
        (all.map(|all| per_sample(&all.n)), all.map(|all| per_sample(&all.k)))
    });
    file.number("acc_n", accelerometer.0.as_ref(), "m/s²");
    file.number("gyr_n", gyroscope.0.as_ref(), "rad/s");
    file.number("acc_w", accelerometer.1.as_ref(), "m/s³");
    file.number("gyr_w", gyroscope.1.as_ref(), "rad/s²");
    file.line(&format!("g_norm: {G_NORM}   # m/s², standard gravity: put your local gravity here"));
    file.line(&format!("# the rate: {rate_hz:.6} Hz; at another the four numbers are others"));
}

fn orbslam3(file: &mut Text, numbers: &Numbers) {
    file.line("%YAML 1.0\n---");
    let why = "Continuous time; it makes samples of them by IMU.Frequency itself. Cameras and IMU.T_b_c1 are yours";
    file.head(numbers, Format::Orbslam3, why);
    let (gyroscope, accelerometer) = (numbers.gyroscope.as_ref(), numbers.accelerometer.as_ref());
    file.number("IMU.NoiseGyro", gyroscope.map(|all| &all.n), "rad/s^0.5");
    file.number("IMU.NoiseAcc", accelerometer.map(|all| &all.n), "m/s^1.5");
    file.number("IMU.GyroWalk", gyroscope.map(|all| &all.k), "rad/s^1.5");
    file.number("IMU.AccWalk", accelerometer.map(|all| &all.k), "m/s^2.5");
    file.plain("IMU.Frequency", numbers.rate_hz, "Hz, as recorded");
}

/// mGal in 1 m/s².
const MILLI_GAL: f64 = 1e5;

fn kf_gins(file: &mut Text, numbers: &Numbers) {
    let why = "By axis x, y, z (there forward, right, down: the order is yours); the wander of the bias as a \
               Gauss–Markov process of one correlation time for all";
    file.head(numbers, Format::KfGins, why);
    let Numbers { gyroscope, accelerometer, memory, .. } = numbers;
    let SourcedNumber { value: tau_s, from } = memory;
    file.line("imunoise:");
    // 1 rad/√s is 60·180/π °/√h
    file.list("  arw", gyroscope, |axis| axis.fitted_n.value.to_degrees() * 60.0, "°/√h: N of each axis");
    file.list("  vrw", accelerometer, |axis| axis.fitted_n.value * 60.0, "m/s/√h: N of each axis");
    file.list(
        "  gbstd",
        gyroscope,
        |axis| axis.sigma.to_degrees() * 3600.0,
        "°/h: σ of a process of that time that peaks as high as the model without N",
    );
    file.list("  abstd", accelerometer, |axis| axis.sigma * MILLI_GAL, "mGal: the same");
    file.line("  gsstd: [300.0, 300.0, 300.0]   # ppm: KF-GINS's example; no scale can be told at rest");
    file.line("  asstd: [300.0, 300.0, 300.0]   # ppm: the same");
    file.plain("  corrtime", tau_s / 3600.0, &format!("h, {from}"));
}

fn ros(file: &mut Text, numbers: &Numbers) {
    let why = "Covariances of sensor_msgs/Imu, by axis, row by row: n²·rate, the variance that single samples have \
               in a filter that takes them as white at the rate below";
    file.head(numbers, Format::Ros, why);
    let Numbers { gyroscope, accelerometer, rate_hz, .. } = numbers;
    file.line("orientation_covariance: [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]   # no orientation is given");
    let variance = |axis: &AxisNumbers| axis.fitted_n.value * axis.fitted_n.value * rate_hz;
    file.covariance("angular_velocity_covariance", gyroscope, variance, "rad²/s²");
    file.covariance("linear_acceleration_covariance", accelerometer, variance, "m²/s⁴");
    file.line(&format!("# the rate: {rate_hz:.6} Hz; at another the numbers are others"));
}

#[derive(Default)]
struct Text(String);

impl Text {
    fn line(&mut self, line: &str) {
        self.0.push_str(line);
        self.0.push('\n');
    }

    /// Writes the comments at the head of a noise file: the program that reads it, the meaning and choice of the
    /// numbers, and warnings.
    fn head(&mut self, numbers: &Numbers, format: Format, meaning: &str) {
        let (reader, is_by_axis) = (format.reader(), format.is_by_axis());
        let NoiseFileOptions { log, combine, rule, inflate, names, warnings, .. } = &numbers.choice;
        self.line(&format!("# Noise of an IMU for {reader}, by {} from {}.", SOFTWARE, plain::line(log)));
        self.line(&format!("# {meaning}."));
        if !is_by_axis {
            self.line(&format!("# Of the axes of a kind {}.", combine.words(*names)));
            self.line(&format!("# {}.", rule.words(numbers.usage, *names)));
        }
        if *inflate != 1.0 {
            self.line(&format!("# All noise is multiplied by {inflate}, for what a record at rest does not show."));
        }
        if !numbers.left_out.is_empty() {
            let all = numbers.left_out.join("; ");
            self.line(&format!("# Not noise, and in none of the numbers: {}.", plain::line(&all)));
        }
        for doubt in &numbers.doubts {
            self.line(&format!("# NOT A RESULT: {}", plain::line(doubt)));
        }
        for warning in warnings {
            self.line(&format!("# warning: {}", plain::line(warning)));
        }
    }

    fn number(&mut self, key: &str, chosen: Option<&SourcedNumber>, unit: &str) {
        match chosen {
            Some(SourcedNumber { value, from }) => {
                self.line(&format!("{key}: {}   # {unit}: {}", number(*value), plain::line(from)));
            }
            None => self.missing(key, unit),
        }
    }

    /// Writes a comment in place of a number that the log does not give.
    fn missing(&mut self, key: &str, unit: &str) {
        self.line(&format!("# {}:   # {unit}: no such axes were read; fill it in", key.trim_start()));
    }

    fn plain(&mut self, key: &str, value: f64, what: &str) {
        self.line(&format!("{key}: {}   # {what}", decimal(value)));
    }

    fn list(&mut self, key: &str, sensor: &Option<Sensor>, of: impl Fn(&AxisNumbers) -> f64, what: &str) {
        match sensor {
            Some(sensor) => self.values(key, sensor.axes.iter().map(of), what),
            None => self.missing(key, what),
        }
    }

    fn covariance(&mut self, key: &str, sensor: &Option<Sensor>, of: impl Fn(&AxisNumbers) -> f64, what: &str) {
        let Some(sensor) = sensor else { return self.missing(key, what) };
        let mut all = [0.0; 9];
        for (place, variance) in all.iter_mut().step_by(4).zip(sensor.axes.iter().map(of)) {
            *place = variance;
        }
        self.values(key, all, what);
    }

    fn values(&mut self, key: &str, values: impl IntoIterator<Item = f64>, what: &str) {
        let values: Vec<String> = values.into_iter().map(number).collect();
        self.line(&format!("{key}: [{}]   # {what}", values.join(", ")));
    }
}

/// Formats a number so that YAML 1.0 to 1.2 reads a number: PyYAML takes `1.5e3` for a word.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0.0".to_owned();
    }
    let text = format!("{value:.6e}");
    match text.split_once('e') {
        Some((digits, exponent)) if !exponent.starts_with('-') => format!("{digits}e+{exponent}"),
        _ => text,
    }
}

/// Writes a rate or a time without an exponent.
fn decimal(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0');
    if short.ends_with('.') { format!("{short}0") } else { short.to_owned() }
}

/// Quotes a word for YAML. OpenCV takes the comment behind an unquoted word for a part of the word.
fn quoted(word: &str) -> String {
    format!("\"{}\"", plain::line(word).replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(all(test, feature = "clap"))]
mod tests {
    use super::Format;
    use crate::Combine;
    use clap::ValueEnum;

    /// Python uses these names, and the command line uses the names of clap.
    #[test]
    fn front_ends_have_the_same_names() {
        let of_clap = |value: Option<clap::builder::PossibleValue>| value.map(|value| value.get_name().to_owned());
        assert_eq!(Format::value_variants(), Format::ALL);
        for format in Format::ALL {
            assert_eq!(of_clap(format.to_possible_value()).as_deref(), Some(format.name()));
        }
        for combine in Combine::value_variants() {
            assert_eq!(of_clap(combine.to_possible_value()).as_deref(), Some(combine.name()));
        }
    }
}
