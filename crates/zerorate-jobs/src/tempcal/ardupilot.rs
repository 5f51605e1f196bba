//! Restores the sensors' own readings from an ArduPilot log, undoing the corrections and rotations in its parameters.
//!
//! `IMU` messages hold readings that were corrected by INS_TCALn and rotated by AHRS_ORIENTATION, while the
//! parameters of a temperature calibration are in the frame of the sensor (ArduPilot, Tools/scripts/tempcal_IMU.py).
//! Constant offsets stay in, since no coefficient over temperature depends on them.

use std::collections::BTreeMap;
use zerorate_imu::Kind;

/// The reference temperature of the coefficients, °C (AP_InertialSensor_tempcal.cpp, TEMP_REFERENCE).
const REFERENCE_C: f64 = 35.0;
/// A coefficient is its parameter times this factor (AP_InertialSensor_tempcal.cpp, SCALE_FACTOR).
const SCALE: f64 = 1e-6;
/// A temperature parameter of ArduPilot below this, °C, means that the temperature is unknown (tempcal_IMU.py).
const NO_TEMPERATURE_C: f64 = -80.0;

const AXES: [&str; 3] = ["X", "Y", "Z"];

/// The corrections and rotation that a log's parameters applied to the readings of one IMU.
pub(super) struct AppliedCorrections<'a> {
    parameters: &'a BTreeMap<String, f64>,
    /// The number of the IMU, from 0.
    imu: u32,
}

impl<'a> AppliedCorrections<'a> {
    pub(super) fn new(parameters: &'a BTreeMap<String, f64>, imu: u32) -> Self {
        Self { parameters, imu }
    }

    /// Undoes the corrections and the rotation of readings (°/s or m/s²) of three axes. `temps_c` has one per reading.
    pub(super) fn undo(&self, kind: Kind, axes: &mut [Vec<f64>; 3], temps_c: &[f64]) -> Result<(), String> {
        if let Some(turn) = self.turn()? {
            let [x, y, z] = axes;
            for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
                let turned = [*x, *y, *z];
                // the inverse of a rotation is its transpose
                let row = |column: usize| (0..3).map(|row| turn[row][column] * turned[row]).sum::<f64>();
                [*x, *y, *z] = [row(0), row(1), row(2)];
            }
        }
        if self.tcal("ENABLE") == Some(1.0) {
            for (name, values) in AXES.iter().zip(axes) {
                let correction = self.correction(kind, name);
                values.iter_mut().zip(temps_c).for_each(|(value, temp_c)| *value -= correction(*temp_c));
            }
        }
        Ok(())
    }

    fn tcal(&self, name: &str) -> Option<f64> {
        self.parameters.get(&format!("INS_TCAL{}_{name}", self.imu + 1)).copied()
    }

    /// The correction that the log's calibration added to an axis, as a function of the temperature.
    fn correction(&self, kind: Kind, axis: &str) -> impl Fn(f64) -> f64 {
        let (name, unit) = match kind {
            Kind::Gyroscope => ("GYR", 180.0 / std::f64::consts::PI),
            Kind::Accelerometer => ("ACC", 1.0),
        };
        let of = |order: u32| self.tcal(&format!("{name}{order}_{axis}")).unwrap_or(0.0) * SCALE * unit;
        let terms = [of(1), of(2), of(3)];
        let [low_c, high_c] = ["TMIN", "TMAX"].map(|name| self.tcal(name).unwrap_or(NO_TEMPERATURE_C));
        let reference = format!("INS_{name}{}_CALTEMP", self.imu + 1);
        let reference_c = self.parameters.get(&reference).copied().unwrap_or(REFERENCE_C);
        let bias = move |temp_c: f64| {
            let d = temp_c.max(low_c).min(high_c) - REFERENCE_C;
            d * (terms[0] + d * (terms[1] + d * terms[2]))
        };
        let is_known = reference_c >= NO_TEMPERATURE_C;
        move |temp_c| if is_known { bias(reference_c) - bias(temp_c) } else { 0.0 }
    }

    /// The rotation matrix from the sensor to the vehicle, by rows; `None` without a rotation.
    fn turn(&self) -> Result<Option<[[f64; 3]; 3]>, String> {
        let orientation = self.parameters.get("AHRS_ORIENTATION").copied().unwrap_or(0.0);
        if orientation == 0.0 {
            return Ok(None);
        }
        let known = ORIENTATIONS.get(orientation as usize).filter(|_| orientation.fract() == 0.0 && orientation > 0.0);
        let unknown = || format!("its AHRS_ORIENTATION {orientation} is not known here; set it to 0 and record again");
        known.map(|angles| Some(rotation(*angles))).ok_or_else(unknown)
    }
}

/// Roll, pitch and yaw of the orientations 0 to 43, degrees (ArduPilot, libraries/AP_Math/rotations.h).
const ORIENTATIONS: [[f64; 3]; 44] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 45.0],
    [0.0, 0.0, 90.0],
    [0.0, 0.0, 135.0],
    [0.0, 0.0, 180.0],
    [0.0, 0.0, 225.0],
    [0.0, 0.0, 270.0],
    [0.0, 0.0, 315.0],
    [180.0, 0.0, 0.0],
    [180.0, 0.0, 45.0],
    [180.0, 0.0, 90.0],
    [180.0, 0.0, 135.0],
    [0.0, 180.0, 0.0],
    [180.0, 0.0, 225.0],
    [180.0, 0.0, 270.0],
    [180.0, 0.0, 315.0],
    [90.0, 0.0, 0.0],
    [90.0, 0.0, 45.0],
    [90.0, 0.0, 90.0],
    [90.0, 0.0, 135.0],
    [270.0, 0.0, 0.0],
    [270.0, 0.0, 45.0],
    [270.0, 0.0, 90.0],
    [270.0, 0.0, 135.0],
    [0.0, 90.0, 0.0],
    [0.0, 270.0, 0.0],
    [0.0, 180.0, 90.0],
    [0.0, 180.0, 270.0],
    [90.0, 90.0, 0.0],
    [180.0, 90.0, 0.0],
    [270.0, 90.0, 0.0],
    [90.0, 180.0, 0.0],
    [270.0, 180.0, 0.0],
    [90.0, 270.0, 0.0],
    [180.0, 270.0, 0.0],
    [270.0, 270.0, 0.0],
    [90.0, 180.0, 90.0],
    [90.0, 0.0, 270.0],
    [90.0, 68.8, 293.3],
    [0.0, 315.0, 0.0],
    [90.0, 315.0, 0.0],
    [0.0, 7.0, 0.0],
    [45.0, 0.0, 0.0],
    [315.0, 0.0, 0.0],
];

/// The rotation matrix Rz(yaw)·Ry(pitch)·Rx(roll) of angles in degrees.
fn rotation([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| angle.to_radians().sin_cos());
    [
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp, sr * cp, cr * cp],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(all: &[(&str, f64)]) -> BTreeMap<String, f64> {
        all.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
    }

    /// Orientation 16 is a rotation by 90° about x: y of the sensor is z of the vehicle.
    #[test]
    fn a_turned_board_is_turned_back() {
        let mut axes = [vec![1.0], vec![2.0], vec![3.0]];
        let of = parameters(&[("AHRS_ORIENTATION", 16.0)]);
        AppliedCorrections::new(&of, 0).undo(Kind::Gyroscope, &mut axes, &[25.0]).unwrap();
        for (values, expected) in axes.iter().zip([1.0, 3.0, -2.0]) {
            assert!((values[0] - expected).abs() < 1e-12, "{values:?} {expected}");
        }
        let of = parameters(&[("AHRS_ORIENTATION", 101.0)]);
        assert!(AppliedCorrections::new(&of, 0).undo(Kind::Gyroscope, &mut axes, &[25.0]).is_err());
    }

    /// ArduPilot subtracted P(T) − P(30 °C) with P = 2·10⁻⁴ rad/s/°C · (T − 35 °C), and T limited to 40 °C.
    #[test]
    fn a_correction_is_taken_back() {
        let mut axes = [vec![0.0], vec![0.0], vec![0.0]];
        let of = parameters(&[
            ("INS_TCAL2_ENABLE", 1.0),
            ("INS_TCAL2_TMIN", 0.0),
            ("INS_TCAL2_TMAX", 40.0),
            ("INS_TCAL2_GYR1_X", 200.0),
            ("INS_GYR2_CALTEMP", 30.0),
        ]);
        AppliedCorrections::new(&of, 0).undo(Kind::Gyroscope, &mut axes, &[50.0]).unwrap();
        assert_eq!(axes[0], [0.0], "another IMU");
        AppliedCorrections::new(&of, 1).undo(Kind::Gyroscope, &mut axes, &[50.0]).unwrap();
        assert!((axes[0][0] - (2e-4 * 10.0_f64).to_degrees()).abs() < 1e-12, "{axes:?}");
    }
}
