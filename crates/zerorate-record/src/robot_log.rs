//! The contents of a ROS 2 bag beside the rows of its capture.

use zerorate::{Calibration, Part};

/// The contents of a bag beside the rows of its capture.
pub struct RobotLog {
    /// The known facts about the part.
    pub part: Part,
    /// The calibration that corrects its rates; none: the rates stand as they were measured.
    pub calibration: Option<Calibration>,
    /// The source of the time stamps.
    pub stamps: Stamps,
}

/// The source of the time stamps of messages.
pub enum Stamps {
    /// The time of the part, `t_ns`: of a simulated one, and where nothing else is known.
    OfPart,
    /// The first sample is of this time, ns since 1970.
    From(u64),
    /// The time of day of the last sample in the first block, ns since 1970.
    Now(Box<dyn Fn() -> u64 + Send>),
}
