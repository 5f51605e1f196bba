//! What a bag of ROS 2 states beside the rows of its capture.

use zerorate::{Calibration, Part};

/// What stands in a bag beside the rows of its capture.
pub struct RobotLog {
    /// What is known of the part.
    pub part: Part,
    /// What corrects its rates; none: they are as they were measured.
    pub calibration: Option<Calibration>,
    /// What the stamps of the messages are.
    pub stamps: Stamps,
}

/// What the stamps of messages are.
pub enum Stamps {
    /// The time of the part, `t_ns`: of a simulated one, and where nothing else is known.
    OfPart,
    /// The first sample is of this time, ns since 1970.
    From(u64),
    /// The time of day, ns since 1970, when the first block of samples comes: that of its last sample.
    Now(Box<dyn Fn() -> u64 + Send>),
}
