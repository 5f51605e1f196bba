//! An axis whose readings are judged before they are used.

use std::collections::VecDeque;
use zerorate::health::{Health, Judged};
use zerorate::{Axis, NamedAxis};

/// An axis, and its readings that are judged and not taken yet.
pub struct JudgedAxis {
    /// The name of the axis in the part.
    pub name: String,
    /// The known facts about the axis.
    pub axis: Axis,
    /// The checks of its readings.
    pub health: Health,
    /// Readings that are judged and not taken yet.
    pub judged: VecDeque<Judged>,
}

impl JudgedAxis {
    /// Before the first reading.
    pub fn new(named: &NamedAxis) -> Self {
        let (name, axis) = (named.name.to_string(), named.axis);
        Self { name, axis, health: Health::new(&axis), judged: VecDeque::new() }
    }
}
