//! The world in which a unit is tracked.

pub mod world;
