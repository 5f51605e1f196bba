#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

#[cfg(feature = "file")]
pub mod calibration;
pub mod chamber;
#[cfg(feature = "file")]
mod check_lines;
mod correction;
pub mod health;
pub mod noise;
mod notice;
mod part;
mod plan;
mod procedure;
pub mod temperature;
pub mod track;
mod uncertainty;

#[cfg(feature = "file")]
pub use calibration::Calibration;
#[cfg(feature = "file")]
pub use check_lines::Damage;
pub use correction::{
    CodeTable, Corrected, Correction, CorrectionF32, Corrector, CorrectorConfig, CurveError, CurveForm,
    IntegerCorrection, IntegerCurve, IntegerError, IntegerForm, RowIndex, TableError, TableRow, Validity,
};
pub use health::{Checkup, Tally};
pub use notice::{Deviation, Finding, Refusal, Remedy, Warning, standing_place};
#[cfg(feature = "file")]
pub use part::PartError;
pub use part::{
    Axis, CodeSum, MAX_AXES, NamedAxis, NoiseSources, Part, Reading, Scale, Scan, SelfHeating, Tone, TypicalBias,
    TypicalNoise,
};
pub use plan::{Bounds, EARTH_DPS, Method, Plan, PlanError, Setting, SettingNames, State, Worded, Wording};
pub use procedure::{
    Action, AxisRefusal, Event, FixedProcedure, Forecast, Measured, Noise, Outcome, PartProcedure, Procedure,
    Progress, Reached, WindowWarnings,
};
pub use uncertainty::Uncertainty;

/// Name and version of this software, as in the files that it writes.
pub const SOFTWARE: &str = concat!("zerorate ", env!("CARGO_PKG_VERSION"));
