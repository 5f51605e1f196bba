//! The commands, one file or folder each.

pub mod allan;
pub mod calibrate;
pub mod capture;
pub mod chamber;
pub mod correct;
mod earth;
pub mod explain;
pub mod export;
pub mod help;
pub mod imu;
pub mod man;
pub mod parts;
pub mod probe;
pub mod repair;
pub mod report;
mod serial;
#[cfg(feature = "serve")]
pub mod serve;
#[cfg(not(feature = "serve"))]
#[path = "absent_serve.rs"]
pub mod serve;
pub mod stream;
pub mod tempcal;
pub mod twin;
pub mod verify;
