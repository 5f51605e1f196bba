//! Parameters of flight controllers for all sensors of a log: cubic polynomials of the bias, to be subtracted.

use super::AxisCurve;
use crate::export::InvalidOptions;
use crate::export::autopilot::{ARDUPILOT_C, ARDUPILOT_SCALE, ARDUPILOT_SENSORS, PX4_SENSORS, single};
use std::fmt::Write;
use zerorate_imu::Kind;

/// The three axes of a sensor, in the order x, y, z.
type Triad<'a> = [&'a AxisCurve; 3];

/// The parameter file of PX4: TC_Gn and TC_An.
///
/// # Errors
/// Returns an error if a sensor does not have three axes, has no device id, or has a number without parameters in PX4.
pub fn px4(axes: &[AxisCurve]) -> Result<String, InvalidOptions> {
    let mut text = head("thermal compensation of PX4");
    text += "# The offset X0 + X1 d + X2 d^2 + X3 d^3, rad/s or m/s^2, with d = TEMP - TREF, is subtracted.\n\
             # Below TMIN and above TMAX, PX4 holds the offset that it has there.\n\
             # CAL_GYROn_XOFF, _YOFF and _ZOFF of the same devices must be 0; calibrate the accelerometers anew.\n\
             #\n# Vehicle-Id Component-Id Name Value Type\n";
    let triads = triads(axes)?;
    for (kind, letter) in [(Kind::Gyroscope, 'G'), (Kind::Accelerometer, 'A')] {
        let of_kind: Vec<&Triad<'_>> = triads.iter().filter(|triad| triad[0].kind == kind).collect();
        if of_kind.is_empty() {
            continue;
        }
        let _ = writeln!(text, "1\t1\tTC_{letter}_ENABLE\t1\t6");
        for triad in of_kind {
            write_px4(triad, letter, &mut text)?;
        }
    }
    Ok(text)
}

/// The parameter file of ArduPilot: INS_TCALn.
///
/// # Errors
/// Returns an error if a sensor does not have three axes, or an IMU has a number beyond those of ArduPilot.
pub fn ardupilot(axes: &[AxisCurve]) -> Result<String, InvalidOptions> {
    let mut text = head("temperature calibration of ArduPilot");
    text += "# P = (1 d + 2 d^2 + 3 d^3) * 1e-6 rad/s or m/s^2 with d = TEMP - 35 is subtracted, less its value at\n\
             # CALTEMP. Below TMIN and above TMAX, ArduPilot holds P. It measures the offsets of the gyroscopes anew\n\
             # at every start; calibrate the accelerometers anew after these parameters are set.\n";
    let triads = triads(axes)?;
    let mut imus: Vec<u32> = triads.iter().map(|triad| triad[0].imu).collect();
    imus.sort_unstable();
    imus.dedup();
    for imu in imus {
        if !ARDUPILOT_SENSORS.contains(&(imu + 1)) {
            return Err(InvalidOptions(format!(
                "IMU {}: ArduPilot has INS_TCALn for IMUs 1 to 3; choose them",
                imu + 1
            )));
        }
        let of_imu: Vec<&Triad<'_>> = triads.iter().filter(|triad| triad[0].imu == imu).collect();
        let spans = || of_imu.iter().map(|triad| triad[0].span_c());
        let low_c = spans().map(|span| span.0).fold(f64::MIN, f64::max);
        let high_c = spans().map(|span| span.1).fold(f64::MAX, f64::min);
        let start = format!("INS_TCAL{}_", imu + 1);
        let mut parameter = |name: String, value: f64| {
            let _ = writeln!(text, "{start}{name},{}", single(value));
        };
        parameter("ENABLE".to_owned(), 1.0);
        parameter("TMIN".to_owned(), low_c);
        parameter("TMAX".to_owned(), high_c);
        for triad in of_imu {
            let name = if triad[0].kind == Kind::Gyroscope { "GYR" } else { "ACC" };
            let terms = terms(triad, ARDUPILOT_C);
            for order in 1..4 {
                for (axis, terms) in ["X", "Y", "Z"].iter().zip(&terms) {
                    parameter(format!("{name}{order}_{axis}"), terms[order] * ARDUPILOT_SCALE);
                }
            }
        }
    }
    Ok(text)
}

fn head(what: &str) -> String {
    format!("# {what}\n# Written by {}.\n", zerorate::SOFTWARE)
}

fn triads(axes: &[AxisCurve]) -> Result<Vec<Triad<'_>>, InvalidOptions> {
    axes.chunk_by(|one, other| one.sensor == other.sensor).map(triad).collect()
}

fn triad(axes: &[AxisCurve]) -> Result<Triad<'_>, InvalidOptions> {
    let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
    let sensor = axes.first().map_or("", |axis| axis.sensor.as_str());
    let wrong = || {
        let names = names.join(", ");
        InvalidOptions(format!("{sensor}: a flight controller has the axes x, y and z, and the log has {names}"))
    };
    let [one, other, third] = axes else { return Err(wrong()) };
    let before = names[0].chars().zip(names[1].chars()).take_while(|(one, other)| one == other).count();
    let letter = |axis: &AxisCurve| axis.name.chars().nth(before).map(|letter| letter.to_ascii_lowercase());
    let named =
        |letters: [char; 2]| [one, other, third].into_iter().find(|axis| letters.map(Some).contains(&letter(axis)));
    let found = [named(['x', '0']), named(['y', '1']), named(['z', '2'])];
    match found {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => Err(wrong()),
    }
}

/// The coefficients of the three polynomials about `about_c`, in rad/s or m/s².
fn terms(triad: &Triad<'_>, about_c: f64) -> [[f64; 4]; 3] {
    let per_unit = if triad[0].kind == Kind::Gyroscope { std::f64::consts::PI / 180.0 } else { 1.0 };
    triad.map(|axis| axis.cubic.about(about_c).map(|term| term * per_unit))
}

fn write_px4(triad: &Triad<'_>, letter: char, text: &mut String) -> Result<(), InvalidOptions> {
    let AxisCurve { imu, device_id, sensor, .. } = triad[0];
    if !PX4_SENSORS.contains(imu) {
        return Err(InvalidOptions(format!("sensor {imu}: PX4 has TC_{letter}n for 0 to 3; choose them")));
    }
    let start = format!("TC_{letter}{imu}_");
    let Some(device_id) = device_id else {
        return Err(InvalidOptions(format!(
            "{sensor}: PX4 finds a sensor by its device_id, which only its own logs (.ulg) state"
        )));
    };
    let (low_c, high_c) = triad[0].span_c();
    // the middle of the range, as in PX4's own calibration, rounded to the f32 of a parameter
    let about_c = f64::from((0.5 * (low_c + high_c)) as f32);
    let _ = writeln!(text, "1\t1\t{start}ID\t{device_id}\t6");
    let mut float = |name: String, value: f64| {
        let _ = writeln!(text, "1\t1\t{start}{name}\t{}\t9", single(value));
    };
    float("TREF".to_owned(), about_c);
    float("TMIN".to_owned(), low_c);
    float("TMAX".to_owned(), high_c);
    let terms = terms(triad, about_c);
    for order in 0..4 {
        for (axis, terms) in terms.iter().enumerate() {
            float(format!("X{order}_{axis}"), terms[order]);
        }
    }
    Ok(())
}
