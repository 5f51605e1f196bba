//! Messages about the noise of an axis: Allan deviation, spectrum, and rate over temperature.

use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;

/// The noise of an axis as estimated so far.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Statistics {
    /// Length of the record since the statistics restarted, s.
    pub duration_s: f64,
    /// The points of the Allan deviation, in order of averaging time.
    pub allan: Vec<AllanPoint>,
    /// The noise coefficients; empty without a noise model.
    pub coefficients: Vec<Coefficient>,
    /// The spectrum of the last 131 072 readings, by Welch's method.
    pub spectrum: Vec<SpectrumPoint>,
    /// Marked features of the spectrum.
    pub marks: Vec<SpectrumMark>,
    /// The mean rate over temperature, while the part was at rest.
    pub temperature: OverTemperature,
    /// A remark if the deviations contain signals other than noise, or if readings are missing; otherwise null.
    pub caution: Option<String>,
}

/// A point of the Allan deviation.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AllanPoint {
    /// Averaging time, s.
    pub tau_s: f64,
    /// The deviation, °/s.
    pub dev_dps: f64,
    /// Lower end of the one-sigma interval, °/s.
    pub lo_dps: f64,
    /// Upper end of the one-sigma interval, °/s.
    pub hi_dps: f64,
    /// The deviation that the model predicts, °/s; null without a model, and at times too short for the model.
    pub model_dps: Option<f64>,
}

/// A noise coefficient.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Coefficient {
    /// `N`, `B` or `K`.
    pub symbol: String,
    /// The name in words.
    pub name: String,
    /// The value, in `unit`.
    pub value: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Unit of the value and its interval.
    pub unit: String,
    /// True if the value differs significantly from zero; with a `caution`, false for B and K.
    pub identified: bool,
    /// Estimated time until the value differs significantly from zero if the model is right, s. Null if unknown or
    /// already identified.
    pub identified_in_s: Option<f64>,
}

/// A point of the spectrum.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SpectrumPoint {
    /// Frequency, Hz.
    pub hz: f64,
    /// One-sided amplitude density, °/s/√Hz.
    pub density_dps_per_rt_hz: f64,
}

/// A marked feature of the spectrum.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SpectrumMark {
    /// Frequency, Hz.
    pub hz: f64,
    /// The kind of feature.
    pub kind: MarkKind,
    /// The description of the feature.
    pub text: String,
}

/// The kinds of features in a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
#[expect(missing_docs, reason = "the text says it")]
pub enum MarkKind {
    Bandwidth,
    Nyquist,
    Resonance,
    Line,
}

/// The rate over temperature.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct OverTemperature {
    /// The points, from cold to warm.
    pub points: Vec<TemperaturePoint>,
    /// The straight line through the points; null if there are too few.
    pub line: Option<TemperatureLine>,
}

/// A straight line fitted to the rate over temperature, weighted by the uncertainties of the points.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct TemperatureLine {
    /// The slope, which is minus BTC, °/s/°C.
    pub slope_dps_per_c: f64,
    /// Standard uncertainty of the slope due to white noise only, °/s/°C.
    pub u_dps_per_c: f64,
}

/// The mean rate at one temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct TemperaturePoint {
    /// Mean temperature, °C.
    pub temp_c: f64,
    /// Mean rate, °/s.
    pub rate_dps: f64,
    /// Standard uncertainty of the mean rate due to white noise, °/s.
    pub u_dps: f64,
    /// Time at this temperature, s.
    pub seconds: u32,
}
