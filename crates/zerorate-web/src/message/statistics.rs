//! What the page is told of the noise of an axis: Allan deviation, spectrum, and the rate over temperature.

use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

/// What is known of the noise of an axis by now.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Statistics {
    /// Over how much time, s.
    pub duration_s: f64,
    /// Allan deviation.
    pub allan: Vec<AllanPoint>,
    /// Its coefficients; none before there is enough.
    pub coefficients: Vec<Coefficient>,
    /// Welch's spectrum of the last 131 072 readings.
    pub spectrum: Vec<SpectrumPoint>,
    /// What is to be seen in it.
    pub marks: Vec<SpectrumMark>,
    /// The bias over temperature.
    pub temperature: OverTemperature,
    /// What is in there beside noise.
    pub caution: Option<String>,
}

/// A point of the Allan deviation.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct AllanPoint {
    /// s.
    pub tau_s: f64,
    /// °/s.
    pub dev_dps: f64,
    /// One sigma, lower, °/s.
    pub lo_dps: f64,
    /// One sigma, upper, °/s.
    pub hi_dps: f64,
    /// What the model expects, °/s.
    pub model_dps: Option<f64>,
}

/// A noise coefficient.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Coefficient {
    /// `N`, `B` or `K`.
    pub symbol: String,
    /// Its name.
    pub name: String,
    /// In `unit`.
    pub value: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Of it.
    pub unit: String,
    /// Whether to believe it.
    pub identified: bool,
    /// In how many seconds it will be, if the noise is what it seems; null where that cannot be said, or is now.
    pub identified_in_s: Option<f64>,
}

/// A point of the spectrum.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct SpectrumPoint {
    /// Hz.
    pub hz: f64,
    /// One-sided, °/s/√Hz.
    pub density_dps_per_rt_hz: f64,
}

/// Something in the spectrum.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct SpectrumMark {
    /// Hz.
    pub hz: f64,
    /// What.
    pub kind: MarkKind,
    /// In words.
    pub text: String,
}

/// What can be in a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "the text says it")]
pub enum MarkKind {
    Bandwidth,
    Nyquist,
    Resonance,
    Line,
}

/// The rate over temperature.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct OverTemperature {
    /// From cold to warm.
    pub points: Vec<TemperaturePoint>,
    /// The straight line through them; none: there are too few.
    pub line: Option<TemperatureLine>,
}

/// A straight line through the rate over temperature, weighted by the uncertainties of its points.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct TemperatureLine {
    /// Minus BTC, °/s/°C.
    pub slope_dps_per_c: f64,
    /// Standard uncertainty of that by white noise alone, °/s/°C.
    pub u_dps_per_c: f64,
}

/// The rate at a temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct TemperaturePoint {
    /// Mean, °C.
    pub temp_c: f64,
    /// Mean, °/s.
    pub rate_dps: f64,
    /// Standard uncertainty of that by white noise, °/s.
    pub u_dps: f64,
    /// Seconds in it.
    pub seconds: u32,
}
