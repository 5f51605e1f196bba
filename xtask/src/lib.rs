//! Code that the tasks of `cargo xtask` share with the lab: how to start other programs, and their tools.

pub mod app;
pub mod arguments;
pub mod images;
pub mod lab;
pub mod targets;
pub mod tools;
pub mod venv;
pub mod web;
pub mod wheel;
