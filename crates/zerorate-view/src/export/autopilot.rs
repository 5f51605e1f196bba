//! Parameters of flight controllers: the bias of three axes as polynomials about a reference temperature, in rad/s.
//! The firmware subtracts the bias.

use super::{Export, InvalidOptions};
use anyhow::{Result, bail, ensure};
use zerorate::{Correction, Validity};

/// The reference temperature that ArduPilot always uses, °C (AP_InertialSensor_tempcal.cpp, TEMP_REFERENCE).
pub(crate) const ARDUPILOT_C: f64 = 35.0;
/// The factor from a coefficient to ArduPilot's parameter (AP_InertialSensor_tempcal.cpp, SCALE_FACTOR).
pub(crate) const ARDUPILOT_SCALE: f64 = 1e6;
/// The sensor numbers for which PX4 has parameters: the n of TC_Gn and TC_An (src/modules/temperature_compensation).
pub(crate) const PX4_SENSORS: std::ops::RangeInclusive<u32> = 0..=3;
/// The IMU numbers for which ArduPilot has parameters INS_TCALn.
pub(crate) const ARDUPILOT_SENSORS: std::ops::RangeInclusive<u32> = 1..=3;

/// A bias, rad/s, as a polynomial in (temperature − `about_c`), °C. `terms` are its coefficients, the constant first.
struct Bias {
    about_c: f64,
    terms: [f64; 4],
}

impl Bias {
    /// The bias that a correction removes (the negative correction), as a polynomial about another temperature.
    fn of(correction: &Correction, about_c: f64) -> Self {
        let shift_c = about_c - correction.t3_c;
        let added_dps = [
            correction.at(about_c),
            correction.slope_dps_per_c(shift_c),
            correction.btc2_dps_per_c2 + 3.0 * correction.btc3_dps_per_c3 * shift_c,
            correction.btc3_dps_per_c3,
        ];
        Self { about_c, terms: added_dps.map(|term| -term.to_radians()) }
    }

    fn at(&self, temp_c: f64) -> f64 {
        let d = temp_c - self.about_c;
        let [t0, t1, t2, t3] = self.terms;
        t0 + d * (t1 + d * (t2 + d * t3))
    }
}

/// The parameter file of PX4: `sensor` is the n of TC_Gn, `device_id` the value of TC_Gn_ID.
pub(super) fn px4(export: &Export, sensor: Option<u32>, device_id: Option<i32>) -> Result<String> {
    let sensor = sensor.unwrap_or(0);
    ensure!(
        PX4_SENSORS.contains(&sensor),
        InvalidOptions(format!("sensor {sensor}: PX4 has gyroscopes 0 to 3, TC_Gn_…"))
    );
    let Some(device_id) = device_id.filter(|id| *id != 0) else {
        bail!(InvalidOptions(format!(
            "PX4 finds the gyroscope of TC_G{sensor} by its device id, and corrects nothing without one. Give the \
             device_id of the topic sensor_gyro (`listener sensor_gyro` in the PX4 console), which is never 0"
        )));
    };
    let axes = three(export)?;
    let Validity { temp_min_c, temp_max_c, .. } = export.layout.valid;
    // the middle of the range, as in PX4's own calibration, rounded to the f32 of a parameter
    let about_c = f64::from((0.5 * (temp_min_c + temp_max_c)) as f32);
    let biases = axes.map(|correction| Bias::of(&correction, about_c));
    let mut text = head(export, &format!("thermal compensation of gyroscope {sensor} of PX4"));
    text += "# The offset X0 + X1 d + X2 d^2 + X3 d^3, rad/s, with d = TEMP - TREF, is subtracted from the rate.\n\
             # Below TMIN and above TMAX, PX4 holds the offset that it has there.\n\
             # It is the whole bias: CAL_GYROn_XOFF, _YOFF and _ZOFF of the same device must be 0.\n\
             #\n# Vehicle-Id Component-Id Name Value Type\n";
    let mut integer = |name: &str, value: i32| text += &format!("1\t1\t{name}\t{value}\t6\n");
    integer("TC_G_ENABLE", 1);
    integer(&format!("TC_G{sensor}_ID"), device_id);
    let mut float = |name: String, value: f64| text += &format!("1\t1\tTC_G{sensor}_{name}\t{}\t9\n", single(value));
    float("TREF".to_owned(), about_c);
    float("TMIN".to_owned(), temp_min_c);
    float("TMAX".to_owned(), temp_max_c);
    for order in 0..4 {
        for (axis, bias) in biases.iter().enumerate() {
            float(format!("X{order}_{axis}"), bias.terms[order]);
        }
    }
    Ok(text)
}

/// The parameter file of ArduPilot: `sensor` is the n of INS_TCALn.
pub(super) fn ardupilot(export: &Export, sensor: Option<u32>) -> Result<String> {
    let sensor = sensor.unwrap_or(1);
    ensure!(
        ARDUPILOT_SENSORS.contains(&sensor),
        InvalidOptions(format!("sensor {sensor}: ArduPilot has IMUs 1 to 3 under INS_TCALn_…"))
    );
    let axes = three(export)?;
    let Validity { temp_min_c, temp_max_c, .. } = export.layout.valid;
    let biases = axes.map(|correction| Bias::of(&correction, ARDUPILOT_C));
    // ArduPilot also limits CALTEMP to TMIN … TMAX, so it must be within this range
    let offset_c = f64::from(ARDUPILOT_C.clamp(temp_min_c, temp_max_c) as f32);
    let mut text = head(export, &format!("temperature calibration of IMU {sensor} of ArduPilot"));
    text += "# With P = (GYR1 d + GYR2 d^2 + GYR3 d^3) * 1e-6 rad/s and d = TEMP - 35, the rate is corrected by\n\
             # - P(TEMP) + P(CALTEMP) - OFFS. Below TMIN and above TMAX, ArduPilot holds P.\n\
             # OFFS is the bias at CALTEMP. Unless INS_GYR_CAL is 0, ArduPilot measures both anew at every start.\n\
             # ENABLE, TMIN and TMAX are of the accelerometers too: where INS_TCALn_ACC are set, calibrate both.\n";
    let mut parameter = |name: String, value: f64| text += &format!("{name},{}\n", single(value));
    parameter(format!("INS_TCAL{sensor}_ENABLE"), 1.0);
    parameter(format!("INS_TCAL{sensor}_TMIN"), temp_min_c);
    parameter(format!("INS_TCAL{sensor}_TMAX"), temp_max_c);
    for order in 1..4 {
        for (axis, bias) in ["X", "Y", "Z"].iter().zip(&biases) {
            parameter(format!("INS_TCAL{sensor}_GYR{order}_{axis}"), bias.terms[order] * ARDUPILOT_SCALE);
        }
    }
    parameter(format!("INS_GYR{sensor}_CALTEMP"), offset_c);
    // the parameters of the first IMU have no number, for historical reasons
    let offsets = if sensor == 1 { "INS_GYROFFS".to_owned() } else { format!("INS_GYR{sensor}OFFS") };
    for (axis, bias) in ["X", "Y", "Z"].iter().zip(&biases) {
        parameter(format!("{offsets}_{axis}"), bias.at(offset_c));
    }
    Ok(text)
}

/// The corrections of the axes x, y and z.
pub(super) fn three(export: &Export) -> Result<[Correction; 3]> {
    let axes = &export.calibration.axes;
    let names = axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ");
    let named = |letter: char| {
        let mut of = axes.iter().filter(|axis| axis.name.to_ascii_lowercase().ends_with(letter));
        match (of.next(), of.next()) {
            (Some(only), None) => Ok(only.correction),
            _ => bail!(
                "a flight controller has the axes x, y and z, and the calibration is of {names}: one name must end in \
                 {letter}. Rename the axes, or calibrate all three (`zerorate calibrate --part`)"
            ),
        }
    };
    ensure!(axes.len() == 3, "a flight controller has the axes x, y and z, and the calibration is of {names} alone");
    Ok([named('x')?, named('y')?, named('z')?])
}

fn head(export: &Export, what: &str) -> String {
    let Export { calibration, layout, .. } = export;
    let text = |text: &Option<String>| text.as_deref().map_or("not stated".to_owned(), super::firmware::comment);
    let Validity { temp_min_c, temp_max_c, .. } = layout.valid;
    let whence = if layout.stated { "seen while measuring" } else { "assumed, the calibration states none" };
    format!(
        "# {what}\n# Written by {}; part {}, serial {}, calibration {}, measured {},\n\
         # {temp_min_c:.1} to {temp_max_c:.1} deg C, {whence}.\n",
        zerorate::SOFTWARE,
        super::firmware::comment(&calibration.part),
        text(&calibration.serial),
        calibration.id(),
        text(&calibration.created)
    )
}

/// Rounds to the f32 of a parameter and removes a negative zero.
pub(crate) fn single(value: f64) -> f32 {
    value as f32 + 0.0
}
