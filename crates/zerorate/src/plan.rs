//! How long the steps of the procedure take, and what is accepted.

use crate::remedy::{Names, Say, Setting};
use core::fmt;

/// Rotation of the Earth, °/s, on an axis parallel to its own (F-16).
pub const EARTH_DPS: f64 = 0.00418;

/// How the bias over temperature is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Two averages and the line through them (F-51).
    #[default]
    An1042,
    /// A curve through every block of the recording ([`thermal`](crate::thermal)).
    Warmup,
    /// The same, of a recording that warms and cools.
    Cycle,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::An1042, Self::Warmup, Self::Cycle];

    /// What calibrations call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::An1042 => "an1042",
            Self::Warmup => "warmup",
            Self::Cycle => "cycle",
        }
    }
}

/// Durations and limits; the default is F-51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// What is made of the samples. All but AN-1042 take the same time as one recording, without steps in it.
    pub method: Method,
    /// Average of steps 4 and 6, s.
    pub average_s: f64,
    /// Warming up by itself, step 5, s.
    pub warmup_s: f64,
    /// Settling, step 7, s.
    pub settle_s: f64,
    /// Average of step 8, s.
    pub offset_s: f64,
    /// Average of the temperature of step 9, s.
    pub final_temp_s: f64,
    /// Largest share of lost samples in an average, 0 … 1.
    pub max_lost: f64,
    /// Largest standard uncertainty of BTC, °/s/°C.
    pub max_u_btc_dps_per_c: f64,
    /// The component of the Earth's rotation on the part's axis, °/s, which is subtracted from the bias (F-16).
    pub earth_dps: Option<f64>,
    /// The bias is a straight line over temperature: no allowance for curvature and hysteresis.
    pub assume_linear: bool,
    /// End the recording once the temperature has settled and the standard uncertainty of the correction, rms over the
    /// temperatures seen, is no more than this, °/s. Not for AN-1042.
    pub target_dps: Option<f64>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            method: Method::An1042,
            average_s: 10.0,
            warmup_s: 600.0,
            settle_s: 2400.0,
            offset_s: 150.0,
            final_temp_s: 1.0,
            max_lost: 0.001,
            max_u_btc_dps_per_c: 0.01,
            earth_dps: None,
            assume_linear: false,
            target_dps: None,
        }
    }
}

/// Rounded to whole ones.
pub(crate) fn ns(seconds: f64) -> u64 {
    libm::round(seconds * 1e9) as u64
}

impl Plan {
    /// Duration of the whole procedure, s.
    #[must_use]
    #[inline]
    pub fn total_s(&self) -> f64 {
        2.0 * self.average_s + self.warmup_s + self.settle_s + self.offset_s + self.final_temp_s
    }

    /// End of step 8, ns after the initialisation: the correction holds from there.
    #[must_use]
    pub fn offset_ends_ns(&self) -> u64 {
        let steps_s = [self.average_s, self.warmup_s, self.average_s, self.settle_s, self.offset_s];
        steps_s.into_iter().map(ns).sum()
    }

    /// Every number within what a measurement on Earth can be.
    pub(crate) fn check(&self) -> Result<(), PlanError> {
        let within = |setting, value: f64, least: f64, most: f64, unit| {
            if (least..=most).contains(&value) { Ok(()) } else { Err(PlanError { setting, value, least, most, unit }) }
        };
        within(Setting::Average, self.average_s, 1.0, DAY_S, "s")?;
        within(Setting::WarmUp, self.warmup_s, 0.0, DAY_S, "s")?;
        within(Setting::Settle, self.settle_s, 0.0, DAY_S, "s")?;
        within(Setting::Offset, self.offset_s, 1.0, DAY_S, "s")?;
        within(Setting::FinalTemperature, self.final_temp_s, 0.1, DAY_S, "s")?;
        within(Setting::Target, self.target_dps.unwrap_or(1.0), LEAST_TARGET_DPS, MOST_TARGET_DPS, "°/s")?;
        within(Setting::MaxLost, self.max_lost, 0.0, 1.0, "of all samples")?;
        within(Setting::MaxUBtc, self.max_u_btc_dps_per_c, LEAST_U_BTC_DPS_PER_C, MOST_U_BTC_DPS_PER_C, "°/s/°C")?;
        within(Setting::Earth, self.earth_dps.unwrap_or(0.0), -EARTH_DPS, EARTH_DPS, "°/s (F-16)")
    }
}

/// No step of F-51 takes longer than a day, s: the ambient temperature would go round once.
const DAY_S: f64 = 86_400.0;
/// An uncertainty of BTC that no day reaches, °/s/°C: the white noise of a part of this class alone (F-02) makes ten
/// times as much.
const LEAST_U_BTC_DPS_PER_C: f64 = 1e-8;
/// An uncertainty of BTC at which it says nothing: 25 times the coefficient itself (F-05).
const MOST_U_BTC_DPS_PER_C: f64 = 1.0;

/// An uncertainty that no hour reaches, °/s: a thousandth of the flicker floor (M-04).
const LEAST_TARGET_DPS: f64 = 1e-6;
/// An uncertainty that says nothing, °/s: that of a part out of the box (M-01).
const MOST_TARGET_DPS: f64 = 1.0;

/// A plan that cannot be carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanError {
    /// Which number.
    pub setting: Setting,
    /// What was asked, in its unit.
    pub value: f64,
    /// The least that makes sense.
    pub least: f64,
    /// The most that makes sense.
    pub most: f64,
    /// Its unit.
    pub unit: &'static str,
}

impl Say for PlanError {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        let Self { setting, value, least, most, unit } = self;
        write!(f, "{} is {value}; it must be a number from {least} to {most} {unit}", names(*setting))?;
        let in_dps = value / 3600.0;
        if *setting == Setting::Earth && value.abs() > 0.1 && in_dps.abs() <= EARTH_DPS {
            write!(f, ": if that was °/h, give {in_dps:.5}")?;
        }
        Ok(())
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

impl core::error::Error for PlanError {}
