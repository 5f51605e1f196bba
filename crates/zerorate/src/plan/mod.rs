//! The plan of a measurement: the durations of its steps, and the limits of what is accepted.

mod setting;
mod states;

pub use setting::{Bounds, Setting, SettingNames, Worded, Wording};
pub use states::State;
pub(crate) use states::{Check, STATES, TABLE, Until};

use core::fmt;

/// Rotation of the Earth, °/s, on an axis parallel to its own (F-16).
pub const EARTH_DPS: f64 = 0.00418;

/// A method to find the bias over temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Two averages and the line through them (F-51).
    #[default]
    An1042,
    /// A curve of the bias over temperature, fitted to the whole recording ([`temperature`](crate::temperature)).
    Warmup,
    /// A curve of the bias over temperature, fitted to a whole recording in which the part warms and cools.
    Cycle,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::An1042, Self::Warmup, Self::Cycle];

    /// Name of the method in calibrations.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::An1042 => "an1042",
            Self::Warmup => "warmup",
            Self::Cycle => "cycle",
        }
    }
}

/// Durations and limits of a measurement. The default is F-51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Method of the measurement. All but AN-1042 make one recording of the same total time, without steps.
    pub method: Method,
    /// Averaging time of steps 4 and 6, s.
    pub average_s: f64,
    /// Duration of the warm-up by self-heating, step 5, s.
    pub warmup_s: f64,
    /// Settling time, step 7, s.
    pub settle_s: f64,
    /// Averaging time of step 8, s.
    pub offset_s: f64,
    /// Averaging time of the temperature in step 9, s.
    pub final_temp_s: f64,
    /// Largest allowed share of lost samples, and of impossible readings, in an average or a recording, 0 … 1.
    pub max_lost: f64,
    /// Largest allowed standard uncertainty of BTC, °/s/°C.
    pub max_u_btc_dps_per_c: f64,
    /// The component of the Earth's rotation on the part's axis, °/s, which is subtracted from the bias (F-16).
    /// `None` subtracts nothing.
    pub earth_dps: Option<f64>,
    /// Whether to assume that the bias is linear in temperature, without an allowance for curvature and hysteresis.
    pub assume_linear: bool,
    /// The caller may end the recording once the temperature has settled and the standard uncertainty of the
    /// correction, rms over the temperatures seen, is no more than this, °/s. It does not apply to AN-1042.
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

    /// End of step 8, ns after the initialisation. PBC is the bias correction at this time.
    #[must_use]
    pub fn offset_ends_ns(&self) -> u64 {
        let steps_s = [self.average_s, self.warmup_s, self.average_s, self.settle_s, self.offset_s];
        steps_s.into_iter().map(ns).sum()
    }

    pub(crate) fn check(&self) -> Result<(), PlanError> {
        let numbers = [
            (Setting::Average, Some(self.average_s)),
            (Setting::WarmUp, Some(self.warmup_s)),
            (Setting::Settle, Some(self.settle_s)),
            (Setting::Offset, Some(self.offset_s)),
            (Setting::FinalTemperature, Some(self.final_temp_s)),
            (Setting::Target, self.target_dps),
            (Setting::MaxLost, Some(self.max_lost)),
            (Setting::MaxUBtc, Some(self.max_u_btc_dps_per_c)),
            (Setting::Earth, self.earth_dps),
        ];
        let beyond = |(setting, value): (Setting, Option<f64>)| {
            let (value, bounds) = value.zip(setting.bounds())?;
            let is_within = (bounds.least..=bounds.most).contains(&value);
            (!is_within).then_some(PlanError { setting, value, bounds })
        };
        numbers.into_iter().find_map(beyond).map_or(Ok(()), Err)
    }
}

/// The error of a plan with an impossible value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanError {
    /// The setting that is out of range.
    pub setting: Setting,
    /// The value that was asked for, in its unit.
    pub value: f64,
    /// The allowed values.
    pub bounds: Bounds,
}

impl Wording for PlanError {
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
        let Self { setting, value, bounds: Bounds { least, most, unit } } = self;
        let name = names(*setting);
        // a front end that uses the word of the setting takes the target in °/h
        let (per, unit) = match *setting == Setting::Target && name.word == setting.word() {
            true => (3600.0, "°/h"),
            false => (1.0, *unit),
        };
        let [value_in, least, most] = [value, least, most].map(|number| per * number);
        write!(f, "{name} is {value_in}; it must be a number from {least} to {most} {unit}")?;
        let in_dps = value / 3600.0;
        if *setting == Setting::Earth && value.abs() > 0.1 && in_dps.abs() <= EARTH_DPS {
            write!(f, ": if that was °/h, give {in_dps:.5}")?;
        }
        Ok(())
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fmt_with(f, Setting::name)
    }
}

impl core::error::Error for PlanError {}
