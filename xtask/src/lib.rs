//! Code that the tasks of `cargo xtask` share with the lab: arguments, builds, and how to find and start other
//! programs.

pub mod app;
pub mod arguments;
pub mod images;
pub mod lab;
pub mod targets;
pub mod tools;
pub mod venv;
pub mod web;
pub mod wheel;
