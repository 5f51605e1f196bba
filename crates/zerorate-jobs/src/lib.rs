//! The jobs of zerorate as functions: typed options in, events and typed results out.
//!
//! There is no argument parser, no printing and no exit code here. The command line and the Python package add them.
//!
//! * [`calibrate`]: the procedure of AN-1042 (F-51), or a method that uses the whole recording, on a part or on its
//!   recording.
//! * [`allan`]: the noise of columns of logs. [`pool`]: one noise model for several records.
//! * [`imu`]: the noise of all axes of an IMU.
//! * [`tempcal`]: the bias over temperature of all axes in logs.
//! * [`chamber`]: calibrates a part over the temperature range of a chamber.
//! * [`correct`]: writes a corrected copy of a capture.
//! * [`course`]: the capture of a calibration as means over time.
//! * [`probe`]: checks that a part responds and is wired correctly.
//! * [`record`]: records the raw codes of a part into a file.
//! * [`stream`]: passes on the corrected rate of a part, row by row.
//! * [`Acquisition`]: the samples of a device in order, counted and checked.
//! * [`codes`]: what each warning and refusal means.
//! * [`Outputs`](output::Outputs): the files of a run, which never overwrite a file by accident.

pub mod acquisition;
pub mod allan;
pub mod calibrate;
pub mod capture;
pub mod catalogue;
pub mod chamber;
pub mod code_scales;
pub mod codes;
pub mod correct;
pub mod course;
mod error;
pub mod imu;
mod judged;
pub mod output;
pub mod pool;
pub mod probe;
pub mod proposal;
pub mod record;
pub mod recorder;
pub mod stream;
pub mod tempcal;
pub mod temperature;
mod warning;

pub use acquisition::{Acquisition, WarningSink};
pub use error::{CodedRefusal, InvalidOptions, refusal_code};
pub use judged::JudgedAxis;
pub use recorder::Recorder;
pub use warning::{CodedWarning, JobWarning};
