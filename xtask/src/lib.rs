//! What the tasks of `cargo xtask` share with those in `lab/`: how to start other programs, and what they need.

pub mod app;
pub mod arguments;
pub mod images;
pub mod lab;
pub mod targets;
pub mod tools;
pub mod venv;
pub mod web;
