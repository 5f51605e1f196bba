//! A part in a temperature chamber: the plan of the temperatures ([`ChamberPlan`]), and the measurement that follows
//! it ([`ChamberProcedure`]), without clock, bus or chamber.

#[cfg(feature = "file")]
mod file;
mod outcome;
mod plan;
mod procedure;
mod record;
mod refusal;
#[cfg(feature = "file")]
mod saved;
mod states;

#[cfg(feature = "file")]
pub use file::SHIPPED;
pub use outcome::{Branches, ChamberOutcome, Residual};
pub use plan::{ChamberPlan, ChamberPlanError, Step, StepEnd};
pub use procedure::{ChamberAction, ChamberProcedure, ChamberProgress};
pub use record::{Record, Soak};
pub use refusal::{ChamberRefusal, Disturbance};
#[cfg(feature = "file")]
pub use saved::{Saved, SavedError};
pub use states::ChamberState;
