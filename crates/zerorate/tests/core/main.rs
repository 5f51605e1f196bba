//! The core as its users have it: on the twin with the driver, on simulated means, and on files.

mod axes_on_twins;
mod bit_for_bit;
mod calibration_file;
mod calibration_of_axes;
mod chamber_on_twin;
mod golden;
mod health_on_twin;
mod hours;
mod outcome;
mod procedure_on_twin;
mod slow_motion;
mod track;
mod track_on_twin;
mod track_state;
mod unit;
