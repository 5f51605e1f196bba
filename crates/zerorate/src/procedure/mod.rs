//! The calibration by F-51 or from one recording, as a state machine: the procedure for one axis and for all axes of
//! a sensor, two kinds of sums over its samples, the estimators of the outcome, and the search for deviations.

mod all_axes;
mod blocks;
mod drift_checks;
mod estimate;
mod one_axis;
mod recording;
mod running;
mod shape;
mod window_sums;

pub use all_axes::{AxisRefusal, PartProcedure};
pub use estimate::{Measured, Noise, Outcome, WindowWarnings};
pub use one_axis::{Action, Event, FixedProcedure, Procedure, Progress};
pub use recording::{Forecast, Reached};

pub(crate) use blocks::{Block, Second};
pub(crate) use estimate::turning;
pub(crate) use recording::{deviations, motions_hz, steps_s, taken_out};
