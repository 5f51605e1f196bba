#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

pub mod allan;
#[cfg(feature = "file")]
pub mod calibration;
mod code_sum;
mod code_table;
mod correction;
mod estimate;
mod freeze;
mod gls;
pub mod health;
mod hour;
mod ledger;
pub mod noise;
mod notice;
pub mod plausible;
mod procedure;
mod record;
pub mod resonance;
mod running;
mod shape;
mod stationarity;
mod tally;

#[cfg(feature = "file")]
pub use calibration::Calibration;
pub use code_sum::{CodeSum, rate_dps, temp_c};
pub use code_table::{CodeTable, RowIndex, temp_code};
pub use correction::{Correction, CorrectionF32, IntegerCorrection, IntegerError, TableError, TableRow};
pub use estimate::{
    BANDWIDTH_HZ, Noise, Outcome, TYPICAL_CURVATURE_DPS_PER_C2, TYPICAL_HYSTERESIS_DPS, Uncertainty, WindowWarnings,
};
pub use hour::{Deviation, Finding};
pub use notice::{EARTH_DPS, Refusal, SUPPLY_DPS_PER_MV, Warning};
pub use procedure::{Action, Event, FixedProcedure, Plan, PlanError, Procedure, Progress, State};
pub use tally::Tally;
