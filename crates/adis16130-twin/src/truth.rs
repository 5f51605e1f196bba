//! The true state of the twin, which a measurement can only estimate.

use crate::facts::TEMP_AT_ZERO_CODE_C;
use crate::gyro::slow::Point;
use crate::spec::Spec;

/// The state of the slow bias at one instant.
///
/// With f(T) = `tempco_dps_per_c`·(T − 25) + `curvature_dps_per_c2`·(T − 25)² and the sensitivity error s, the slow
/// bias at the output is
///
/// bias(T) = (1 + s)·(initial + supply + f(T) + branch + random walk).
///
/// Flicker and white noise are noise, not bias. Rotation and other motion are not bias either. T is the temperature
/// that the part reports in thermal balance. A lag between sensor and element is an error of the measurement, not part
/// of the truth.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Truth {
    /// The time of this state, in ns from the start.
    pub t_ns: u64,
    /// Bias at 25 °C and 5 V, before the sensitivity error, in °/s.
    pub initial_dps: f64,
    /// Linear coefficient at 25 °C, before the sensitivity error, in °/s/°C.
    pub tempco_dps_per_c: f64,
    /// Quadratic coefficient, before the sensitivity error, in °/s/°C².
    pub curvature_dps_per_c2: f64,
    /// Effect of the supply voltage (F-01), before the sensitivity error, in °/s.
    pub supply_dps: f64,
    /// Value of the rate random walk, before the sensitivity error, in °/s.
    pub random_walk_dps: f64,
    /// Difference of the bias from f(T) by hysteresis, before the sensitivity error, in °/s.
    pub branch_dps: f64,
    /// Flicker now, before the sensitivity error, in °/s. [`bias_dps`](Self::bias_dps) leaves it out.
    pub flicker_dps: f64,
    /// Relative sensitivity error s.
    pub sensitivity_error: f64,
    /// Ambient temperature, in °C.
    pub ambient_c: f64,
    /// Temperature of the temperature sensor, without its noise, in °C.
    pub sensor_c: f64,
    /// Temperature of the sensing element, in °C. Without a lag it equals `sensor_c`.
    pub element_c: f64,
}

impl Truth {
    pub(crate) fn new(spec: &Spec, t_ps: u64, point: &Point) -> Self {
        Self {
            t_ns: t_ps / 1000,
            initial_dps: spec.bias_dps,
            tempco_dps_per_c: spec.tempco_dps_per_c,
            curvature_dps_per_c2: spec.curvature_dps_per_c2,
            supply_dps: point.supply_dps,
            random_walk_dps: point.walk_dps,
            branch_dps: point.branch_dps,
            flicker_dps: point.flicker_dps,
            sensitivity_error: spec.sensitivity_error,
            ambient_c: point.ambient_c,
            sensor_c: point.sensor_c,
            element_c: point.element_c,
        }
    }

    /// The slow bias at the output at a reported temperature, in °/s.
    pub fn bias_dps(&self, temp_c: f64) -> f64 {
        let d = temp_c - TEMP_AT_ZERO_CODE_C;
        let temperature_dps = (self.tempco_dps_per_c + self.curvature_dps_per_c2 * d) * d;
        let sum_dps = self.initial_dps + self.supply_dps + temperature_dps + self.branch_dps + self.random_walk_dps;
        (1.0 + self.sensitivity_error) * sum_dps
    }

    /// The PBC that a perfect measurement would find at T3 (F-50), in °/s: minus the slow bias at T3.
    pub fn pbc_dps(&self, t3_c: f64) -> f64 {
        -self.bias_dps(t3_c)
    }

    /// The BTC that a perfect measurement would find at T3 (F-50), in °/s/°C: minus the slope of the bias at T3.
    pub fn btc_dps_per_c(&self, t3_c: f64) -> f64 {
        let slope = self.tempco_dps_per_c + 2.0 * self.curvature_dps_per_c2 * (t3_c - TEMP_AT_ZERO_CODE_C);
        -(1.0 + self.sensitivity_error) * slope
    }
}
