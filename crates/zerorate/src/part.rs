//! The properties of one kind of gyroscope, as a value that the caller passes. [`Part::ADIS16130`] is built in.
//! Other parts come from files ([`Part::parse`], `docs/formats/part.md`).

use crate::noise::NoiseModel;
use alloc::borrow::Cow;
use core::f64::consts::PI;
use zerorate_allan::FLOOR_PER_B;

mod code_sum;
#[cfg(feature = "file")]
mod file;
mod reading;

pub use code_sum::CodeSum;
#[cfg(feature = "file")]
pub use file::PartError;
#[cfg(feature = "file")]
pub(crate) use file::is_word;
pub use reading::{Reading, Scan};

/// Largest number of axes of a part. A [`Scan`] takes memory for this many axes, however many the part has.
pub const MAX_AXES: usize = 8;

/// Allowed distance of a temperature from the span of a calibration if the noise of the temperature is not known, °C.
/// For the ADIS16130 this is ten times the noise of a single reading (M-05).
pub(crate) const UNKNOWN_MARGIN_C: f64 = 0.5;

/// A kind of gyroscope: its name and its axes, which share one temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of the kind of part in captures and calibrations.
    pub name: Cow<'static, str>,
    /// The axes, from one to [`MAX_AXES`].
    pub axes: Cow<'static, [NamedAxis]>,
    /// Column of the temperature in logs, if it is not `temp`.
    pub temp_column: Option<Cow<'static, str>>,
    /// Coldest and warmest air in which the part may operate, °C.
    pub operating_c: Option<(f64, f64)>,
}

/// An axis of a [`Part`], with its names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedAxis {
    /// Name of the axis in captures and calibrations.
    pub name: Cow<'static, str>,
    /// Column in logs, if it differs from the name.
    pub column: Option<Cow<'static, str>>,
    /// Scales, noise, bias and other properties of the axis.
    pub axis: Axis,
    /// Sources of the axis's typical noise.
    pub sources: NoiseSources,
}

/// Sources of the typical noise of an axis: a fact, a data sheet, a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseSources {
    /// Source of the flicker.
    pub flicker: Option<Cow<'static, str>>,
    /// Source of the rate random walk.
    pub rate_random_walk: Option<Cow<'static, str>>,
}

impl Part {
    /// The built-in part, with the bandwidth that it has without an external capacitor (F-03).
    pub const ADIS16130: Self = Self {
        name: Cow::Borrowed("ADIS16130"),
        axes: Cow::Borrowed(&[NamedAxis {
            name: Cow::Borrowed("rate"),
            column: None,
            axis: Axis::ADIS16130,
            sources: NoiseSources {
                flicker: Some(Cow::Borrowed("M-04")),
                rate_random_walk: Some(Cow::Borrowed("M-04")),
            },
        }]),
        temp_column: None,
        operating_c: Some((-40.0, 85.0)), // F-08
    };
}

/// The properties of one axis, and of its temperature. An unknown property is `None`. A check that needs the property
/// is then left out, and a warning says so where that matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Scale of the rate codes, °/s.
    pub rate: Scale,
    /// Scale of the temperature codes, °C.
    pub temp: Scale,
    /// Noise of a single reading of the temperature, °C.
    pub temp_noise_c: Option<f64>,
    /// Largest rate that the axis measures, °/s, in both directions.
    pub range_dps: Option<f64>,
    /// −3 dB frequency of the response as configured, Hz.
    pub bandwidth_hz: Option<f64>,
    /// Typical noise of the rate.
    pub noise: Option<TypicalNoise>,
    /// Typical bias, and its dependence on other quantities.
    pub bias: TypicalBias,
    /// Self-heating of a typical unit after it is switched on.
    pub self_heating: Option<SelfHeating>,
    /// A mechanical resonance that sampling may fold to a frequency near zero.
    pub resonance: Option<Tone>,
    /// Whether one converter takes rate and temperature in turn, so that reading every N-th edge gives 1/(N + 1) of
    /// its conversions.
    pub alternates: bool,
}

/// A linear relation of codes to values: value = (code − zero code)/`lsb_per_unit` + `zero_value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Codes per unit.
    pub lsb_per_unit: f64,
    /// The code that stands for `zero_value`.
    pub zero_code: i64,
    /// Value of the zero code.
    pub zero_value: f64,
    /// Bits of a code, 1 to 32.
    pub width_bits: u8,
    /// Whether codes are two's complement. Otherwise they begin at 0.
    pub signed: bool,
}

impl Scale {
    /// 24 bits around 2²³ (F-40, F-41).
    const OFFSET_24: Self =
        Self { lsb_per_unit: 1.0, zero_code: 8_388_608, zero_value: 0.0, width_bits: 24, signed: false };

    /// The same scale for codes that lack `bits` low bits (F-43).
    #[must_use]
    pub fn without_low_bits(self, bits: u8) -> Self {
        Self {
            lsb_per_unit: self.lsb_per_unit / (1u64 << bits) as f64,
            zero_code: self.zero_code >> bits,
            width_bits: self.width_bits - bits,
            ..self
        }
    }

    /// Returns the value of the code that lies `from_zero` codes above the zero code, by a single division.
    ///
    /// ```
    /// let axis = zerorate::Axis::ADIS16130;
    /// assert_eq!((axis.rate.value(23_488), axis.temp.value(-14_093)), (1.0, 24.0)); // F-40, F-41
    /// ```
    #[must_use]
    pub fn value(&self, from_zero: i64) -> f64 {
        from_zero as f64 / self.lsb_per_unit + self.zero_value
    }

    /// Returns the code of a value, not rounded.
    #[must_use]
    pub fn code(&self, value: f64) -> f64 {
        (value - self.zero_value) * self.lsb_per_unit + self.zero_code as f64
    }

    /// Returns the code nearest to a value: the first or the last code for a value beyond the scale.
    #[must_use]
    pub fn nearest_code(&self, value: f64) -> i64 {
        let (first, last) = self.codes();
        libm::round(self.code(value).clamp(first as f64, last as f64)) as i64
    }

    /// The first and the last code.
    ///
    /// ```
    /// let scale = zerorate::Axis::ADIS16130.rate;
    /// assert_eq!(scale.codes(), (0, 16_777_215));
    /// assert_eq!(zerorate::Scale { width_bits: 16, signed: true, ..scale }.codes(), (-32_768, 32_767));
    /// ```
    #[must_use]
    #[inline]
    pub const fn codes(&self) -> (i64, i64) {
        let last = (1 << self.width_bits) - 1;
        let first = if self.signed { -(1 << (self.width_bits - 1)) } else { 0 };
        (first, first + last)
    }

    /// The largest code less the smallest.
    #[must_use]
    pub const fn span(&self) -> f64 {
        let (first, last) = self.codes();
        (last - first) as f64
    }
}

/// The noise of a typical unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypicalNoise {
    /// One-sided density of the white noise, °/s/√Hz.
    pub white_dps_per_rt_hz: f64,
    /// Floor of the flicker noise alone in an Allan deviation plot, °/s: 0.664 B.
    pub flicker_floor_dps: f64,
    /// Rate random walk K, °/s/√s.
    pub rate_random_walk_dps_per_rt_s: f64,
}

impl TypicalNoise {
    /// Converts the typical noise to a model.
    #[must_use]
    pub const fn model(&self) -> NoiseModel {
        NoiseModel {
            white_dps_per_rt_hz: self.white_dps_per_rt_hz,
            bias_instability_dps: self.flicker_floor_dps / FLOOR_PER_B,
            rate_random_walk_dps_per_rt_s: self.rate_random_walk_dps_per_rt_s,
        }
    }
}

/// The self-heating of a part, as the sum of two exponentials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfHeating {
    /// Size of the fast share, °C.
    pub fast_c: f64,
    /// Time constant of the fast share, s.
    pub fast_s: f64,
    /// Size of the slow share, °C.
    pub slow_c: f64,
    /// Time constant of the slow share, s.
    pub slow_s: f64,
}

impl SelfHeating {
    /// Temperature rise `after_s` seconds after power-on, °C.
    #[must_use]
    pub fn rise_c(&self, after_s: f64) -> f64 {
        -self.fast_c * libm::expm1(-after_s / self.fast_s) - self.slow_c * libm::expm1(-after_s / self.slow_s)
    }

    /// Time after which less than `rest_c` of the rise is left, s. It follows from the slow share alone: the fast
    /// share is assumed to be over by then.
    #[must_use]
    pub fn settles_to_s(&self, rest_c: f64) -> f64 {
        (self.slow_s * libm::log(self.slow_c / rest_c)).max(0.0)
    }
}

/// The bias of a typical unit, and its spread over units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TypicalBias {
    /// Standard deviation of the initial bias over units, °/s.
    pub initial_dps: Option<f64>,
    /// Typical temperature coefficient of the bias, °/s/°C.
    pub tempco_dps_per_c: Option<f64>,
    /// Standard deviation of the temperature coefficient over units, °/s/°C.
    pub tempco_spread_dps_per_c: Option<f64>,
    /// Standard deviation of the curvature over units, °/s/°C².
    pub curvature_dps_per_c2: Option<f64>,
    /// Half width of the hysteresis, °/s.
    pub hysteresis_dps: Option<f64>,
    /// Largest change of the bias with the supply, °/s/mV.
    pub supply_dps_per_mv: Option<f64>,
}

impl TypicalBias {
    /// Largest rate that can be bias, °/s: ten times the spread over units.
    #[must_use]
    pub fn largest_dps(&self) -> Option<f64> {
        self.initial_dps.map(|initial_dps| 10.0 * initial_dps)
    }

    /// The largest temperature coefficient that a unit may have, °/s/°C: six spreads above the typical one.
    #[must_use]
    pub fn largest_tempco_dps_per_c(&self) -> Option<f64> {
        Some(self.tempco_dps_per_c?.abs() + 6.0 * self.tempco_spread_dps_per_c?)
    }

    /// The smallest temperature coefficient that is still usual, °/s/°C: three spreads below the typical one.
    #[must_use]
    pub fn least_tempco_dps_per_c(&self) -> Option<f64> {
        Some(self.tempco_dps_per_c?.abs() - 3.0 * self.tempco_spread_dps_per_c?)
    }

    /// The largest step of the bias that a change of the supply by 500 mV explains, °/s. Infinite if the dependence is
    /// not known.
    #[must_use]
    pub fn largest_supply_step_dps(&self) -> f64 {
        self.supply_dps_per_mv.map_or(f64::INFINITY, |dps_per_mv| 500.0 * dps_per_mv)
    }
}

/// A tone that the part adds to its rate, and the tolerance of its frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Frequency of the tone, Hz.
    pub hz: f64,
    /// Tolerance of the frequency, Hz. For the ADIS16130 it is half a unit of the last printed digit.
    pub tolerance_hz: f64,
    /// Rms of the tone before sampling, °/s.
    pub rms_dps: f64,
}

impl Tone {
    /// Frequency at which the tone appears among samples at `rate_hz`, Hz: 0 … `rate_hz`/2.
    ///
    /// ```
    /// let tone = zerorate::Axis::ADIS16130.resonance.expect("it is known");
    /// assert!((tone.folded_hz(5692.6) - 2777.8).abs() < 0.1); // F-07
    /// assert_eq!(tone.folded_hz(100.0), 0.0);
    /// ```
    #[must_use]
    pub fn folded_hz(&self, rate_hz: f64) -> f64 {
        let turns = self.hz / rate_hz;
        (turns - libm::round(turns)).abs() * rate_hz
    }

    /// Whether the tone looks like a bias among samples at `rate_hz`, in means over `average_s`. It does if it appears
    /// near zero: below the frequency at which averaging leaves more of the tone than of white noise of this density,
    /// plus the tolerance. A tolerance of more than an eighth of the rate counts as that eighth, because no such low
    /// rate is safe.
    #[must_use]
    pub fn looks_like_bias(&self, rate_hz: f64, average_s: f64, white_dps_per_rt_hz: f64) -> bool {
        let averaged_hz = 2.0 * self.rms_dps / (PI * white_dps_per_rt_hz * libm::sqrt(average_s));
        let near_zero_hz = averaged_hz + self.tolerance_hz.min(rate_hz / 8.0);
        rate_hz > 0.0 && self.folded_hz(rate_hz) < near_zero_hz
    }
}

impl Axis {
    /// The ADIS16130 in 24 bits, without an external capacitor. Multiply 16-bit codes by 256 first (F-43).
    pub const ADIS16130: Self = Self {
        rate: Scale { lsb_per_unit: 23_488.0, zero_value: 0.0, ..Scale::OFFSET_24 }, // F-40
        temp: Scale { lsb_per_unit: 14_093.0, zero_value: 25.0, ..Scale::OFFSET_24 }, // F-41
        temp_noise_c: Some(0.05),                                                    // M-05
        range_dps: Some(250.0),                                                      // F-08
        bandwidth_hz: Some(300.0),                                                   // F-03
        noise: Some(TypicalNoise {
            white_dps_per_rt_hz: 0.0125,         // F-02
            flicker_floor_dps: 0.0016,           // M-04
            rate_random_walk_dps_per_rt_s: 1e-4, // M-04
        }),
        bias: TypicalBias {
            initial_dps: Some(1.0),              // M-01
            tempco_dps_per_c: Some(0.04),        // F-05
            tempco_spread_dps_per_c: Some(0.01), // M-02
            curvature_dps_per_c2: Some(0.0005),  // M-02
            hysteresis_dps: Some(0.002),         // M-02
            supply_dps_per_mv: Some(0.0002),     // F-01
        },
        self_heating: Some(SelfHeating { fast_c: 3.2, fast_s: 90.0, slow_c: 4.8, slow_s: 600.0 }), // M-03
        resonance: Some(Tone { hz: 14_300.0, tolerance_hz: 50.0, rms_dps: 0.02 }),                 // F-07, M-08
        alternates: true,                                                                          // F-56
    };
    /// An axis of which only the scales are known.
    #[must_use]
    pub fn unknown(rate: Scale, temp: Scale) -> Self {
        Self {
            rate,
            temp,
            temp_noise_c: None,
            range_dps: None,
            bandwidth_hz: None,
            noise: None,
            bias: TypicalBias::default(),
            self_heating: None,
            resonance: None,
            alternates: false,
        }
    }

    /// Bandwidth of the ADIS16130 with 0.01 µF between ROA1 and ROA2, Hz (F-04).
    pub const ADIS16130_ROA_10NF_HZ: f64 = 50.0;

    /// Distance beyond the span of a calibration up to which a temperature gives no warning, °C. It is ten times the
    /// noise of a reading, or [`Validity::MARGIN_C`](crate::Validity::MARGIN_C) if that is not known.
    #[must_use]
    pub fn temp_margin_c(&self) -> f64 {
        self.temp_noise_c.map_or(UNKNOWN_MARGIN_C, |noise_c| 10.0 * noise_c)
    }

    /// Whether the part states what a judgement of rest needs: its typical noise and temperature coefficient.
    #[must_use]
    pub fn can_judge_rest(&self) -> bool {
        self.noise.is_some() && self.bias.largest_tempco_dps_per_c().is_some()
    }

    /// The typical noise as a model. If the noise is not known, all terms are zero.
    #[must_use]
    pub fn typical_noise(&self) -> NoiseModel {
        const NONE: TypicalNoise =
            TypicalNoise { white_dps_per_rt_hz: 0.0, flicker_floor_dps: 0.0, rate_random_walk_dps_per_rt_s: 0.0 };
        self.noise.unwrap_or(NONE).model()
    }
}
