//! ArduPilot's learning during a warm-up (INS_TCALn_ENABLE = 2), as in `AP_InertialSensor_tempcal.cpp` and
//! `polyfit.cpp`. ArduPilot averages the rate over each rise of half a degree, and assigns the mean to the middle of
//! the half degree. It fits a cubic polynomial about 35 °C to these points.
//!
//! Two rules are omitted. ArduPilot saves nothing before the temperature has risen by 10 °C, which a warm-up of 8 °C
//! never reaches; this version has no such limit. ArduPilot also discards the constant, because it measures the level
//! at each start from half a second of rate; here the level comes from the polynomial. ArduPilot's low-pass on the
//! temperature is omitted too, because it makes no difference with this noise.

use super::comparison::MethodResult;
use super::least_squares::cubic;
use super::unit::Recording;

const RISE_C: f64 = 0.5;
const REFERENCE_C: f64 = 35.0;

pub fn fit(recording: &Recording) -> Option<MethodResult> {
    let mut last_c = recording.means.first()?.temp_c;
    let (mut sum_dps, mut count) = (0.0, 0.0);
    let mut points = Vec::new();
    for mean in &recording.means {
        sum_dps += mean.rate_dps;
        count += 1.0;
        if mean.temp_c - last_c >= RISE_C {
            points.push((0.5 * (mean.temp_c + last_c), sum_dps / count));
            (last_c, sum_dps, count) = (mean.temp_c, 0.0, 0.0);
        }
    }
    Some(cubic(&points, REFERENCE_C)?.into())
}
