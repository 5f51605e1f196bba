//! An axis whose readings are judged before they are used.

use std::collections::VecDeque;
use zerorate::health::{Health, Judged};
use zerorate::{Axis, NamedAxis};

/// An axis, and its readings that are judged and not taken yet.
pub struct JudgedAxis {
    pub name: String,
    pub axis: Axis,
    pub health: Health,
    pub judged: VecDeque<Judged>,
}

impl JudgedAxis {
    /// Before the first reading.
    pub fn new(named: &NamedAxis) -> Self {
        let (name, axis) = (named.name.to_string(), named.axis);
        Self { name, axis, health: Health::new(&axis), judged: VecDeque::new() }
    }
}
