//! Messages about the noise of an axis: Allan deviation, spectrum, and rate over temperature.

use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;

/// The noise of an axis, as far as it is known.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Statistics {
    /// Length of the record, s.
    pub duration_s: f64,
    /// Allan deviation.
    pub allan: Vec<AllanPoint>,
    /// The coefficients; empty before there are enough samples.
    pub coefficients: Vec<Coefficient>,
    /// Welch's spectrum of the last 131 072 readings.
    pub spectrum: Vec<SpectrumPoint>,
    /// Features of the spectrum.
    pub marks: Vec<SpectrumMark>,
    /// The bias over temperature.
    pub temperature: OverTemperature,
    /// A remark if the deviations contain more than noise.
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
    /// The deviation of the model, °/s.
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
    /// Unit of the value.
    pub unit: String,
    /// Whether the value is identified.
    pub identified: bool,
    /// Seconds until it is identified, if the noise is what it seems. Null if that is unknown, or if it is identified
    /// already.
    pub identified_in_s: Option<f64>,
}

/// A point of the spectrum.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SpectrumPoint {
    /// Frequency, Hz.
    pub hz: f64,
    /// One-sided density, °/s/√Hz.
    pub density_dps_per_rt_hz: f64,
}

/// A feature of the spectrum.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SpectrumMark {
    /// Frequency, Hz.
    pub hz: f64,
    /// The kind of feature.
    pub kind: MarkKind,
    /// The feature in words.
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
    /// The straight line through them; none: there are too few points.
    pub line: Option<TemperatureLine>,
}

/// A straight line through the rate over temperature, weighted by the uncertainties of its points.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct TemperatureLine {
    /// The slope, which is minus BTC, °/s/°C.
    pub slope_dps_per_c: f64,
    /// Standard uncertainty of the slope by white noise alone, °/s/°C.
    pub u_dps_per_c: f64,
}

/// The rate at a temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct TemperaturePoint {
    /// Mean temperature, °C.
    pub temp_c: f64,
    /// Mean rate, °/s.
    pub rate_dps: f64,
    /// Standard uncertainty of the mean rate by white noise, °/s.
    pub u_dps: f64,
    /// Time at this temperature, s.
    pub seconds: u32,
}
