//! The correction of F-50: its formula, in floating point and in integers, as a table, and applied to a stream.

mod code_table;
mod corrector;
mod formula;
mod integer;
mod integer_curve;
mod validity;

pub use code_table::{CodeTable, RowIndex};
pub use corrector::{Corrected, Corrector, CorrectorConfig};
pub use formula::{Correction, CorrectionF32, TableError, TableRow};
pub use integer::{IntegerCorrection, IntegerError, IntegerForm};
pub use integer_curve::{CurveError, CurveForm, IntegerCurve};
pub use validity::Validity;
