#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

mod block_means;
mod blocks;
#[cfg(feature = "file")]
pub mod calibration;
pub mod chamber;
#[cfg(feature = "file")]
mod check_lines;
mod checkup;
mod code_sum;
mod code_table;
mod correction;
mod corrector;
mod drift_checks;
mod estimate;
mod freeze;
mod gls;
pub mod health;
mod integer;
mod integer_curve;
mod ledger;
mod legs;
pub mod noise;
mod notice;
mod part;
mod part_procedure;
mod plan;
pub mod plausible;
mod procedure;
mod reading;
mod recording;
mod remedy;
pub mod resonance;
mod running;
mod shape;
mod states;
pub mod stationarity;
mod tally;
pub mod thermal;
pub mod track;
mod uncertainty;
mod validity;

#[cfg(feature = "file")]
pub use calibration::Calibration;
#[cfg(feature = "file")]
pub use check_lines::Damage;
pub use checkup::{Checkup, Limits};
pub use code_sum::CodeSum;
pub use code_table::{CodeTable, RowIndex};
pub use correction::{Correction, CorrectionF32, TableError, TableRow};
pub use corrector::{Corrected, Corrector, CorrectorConfig};
pub use drift_checks::{Deviation, Finding};
pub use estimate::{Measured, Noise, Outcome, WindowWarnings};
pub use integer::{IntegerCorrection, IntegerError, IntegerForm};
pub use integer_curve::{CurveError, CurveForm, IntegerCurve};
pub use notice::{Refusal, Warning};
#[cfg(feature = "file")]
pub use part::PartError;
pub use part::{Axis, MAX_AXES, NamedAxis, NoiseSources, Part, Scale, SelfHeating, TypicalBias, TypicalNoise};
pub use part_procedure::{AxisRefusal, PartProcedure};
pub use plan::{EARTH_DPS, Method, Plan, PlanError};
pub use procedure::{Action, Event, FixedProcedure, Procedure, Progress};
pub use reading::{Reading, Scan};
pub use recording::{Forecast, Reached};
pub use remedy::{Names, Remedy, Said, Say, Setting};
pub use states::State;
pub use tally::Tally;
pub use uncertainty::Uncertainty;
pub use validity::Validity;

/// Name and version of this software, as in the files that it writes.
pub const SOFTWARE: &str = concat!("zerorate ", env!("CARGO_PKG_VERSION"));
