//! Checks the readings of an axis before they are used.

use std::collections::VecDeque;
use zerorate::health::{Health, Judged};
use zerorate::{Axis, NamedAxis};

/// An axis, and the queue of its checked readings.
pub struct JudgedAxis {
    /// The name of the axis in its part.
    pub name: String,
    /// The scales, limits and noise of the axis, as far as they are known.
    pub axis: Axis,
    /// The checks of the readings of this axis.
    pub health: Health,
    /// Checked readings that were not fetched yet.
    pub judged: VecDeque<Judged>,
}

impl JudgedAxis {
    /// Starts the checks of an axis, before its first reading.
    pub fn new(named: &NamedAxis) -> Self {
        let (name, axis) = (named.name.to_string(), named.axis);
        Self { name, axis, health: Health::new(&axis), judged: VecDeque::new() }
    }
}
