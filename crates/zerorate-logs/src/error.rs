//! Errors of reading a log, and the questions that a front end asks.

use crate::setting::{Names, Setting};
use std::path::Path;
use zerorate_input::InputError;

/// The reason why a column cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read, or is damaged.
    #[error(transparent)]
    File(#[from] InputError),
    /// The file lacks a fact or a requested column. The text asks the user for it.
    #[error("{0}")]
    Ask(String),
    /// The file has several candidates for what was asked, such as topics.
    #[error("{question}\n{table}", table = .table.join("\n"))]
    Choose {
        /// The question to the user, with the options that answer it.
        question: String,
        /// A line for each candidate, below a header if it needs one.
        table: Vec<String>,
        /// The topics, if the candidates are topics.
        topics: Vec<String>,
    },
    /// The table holds several sensors: their rows were joined by time, or their columns are side by side.
    #[error("{question}\n  {}", .groups.iter().map(|names| names.join(",")).collect::<Vec<_>>().join("\n  "))]
    Merged {
        /// The question to the user, with the options that answer it.
        question: String,
        /// The columns of each sensor.
        groups: Vec<Vec<String>>,
        /// True if each sensor has a time column of its own. A request for the columns of one sensor finds that time
        /// column.
        has_own_times: bool,
    },
    /// The numbers can be read, but must not become a result. The fields are a code for scripts, and the reason.
    #[error("{1}")]
    Refused(&'static str, String),
}

/// The result of reading a log.
pub type Result<T, E = LogError> = std::result::Result<T, E>;

#[cfg(any(feature = "hdf5", feature = "matlab"))]
pub fn object_of_matlab(path: &Path, name: &str, class: &str) -> LogError {
    let remedy = match class {
        "table" | "timetable" => format!("`write{class}({name}, 'log.csv')`"),
        _ => "save its numbers as arrays".to_owned(),
    };
    InputError::not_a_log(path, format!("`{name}` is a {class} of MATLAB, which MATLAB alone reads; there: {remedy}"))
        .into()
}

pub fn no_time_unit(path: &Path, column: &str, names: Names) -> LogError {
    let why = format!("does not state the unit of its time column `{column}`");
    LogError::Ask(format!("{} {why}; give {} s, ms, us, ns, min or h", path.display(), names.of(Setting::TimeUnit)))
}

pub fn unsteady(path: &Path, column: &str, why: &str) -> LogError {
    LogError::Refused("times-uneven", format!("{}, column {column}: {why}", path.display()))
}

pub fn rate_of_steps(path: &Path, column: &str, rate_hz: f64, names: Names) -> LogError {
    let (path, rate) = (path.display(), names.of(Setting::Rate));
    let what = format!("`{column}` holds the step between rows; the usual step means {rate} {rate_hz:.6}");
    LogError::Ask(format!("{path} does not say how fast it was sampled: {what}; give that"))
}

/// The error for more missing samples than can be filled in.
pub fn too_many(path: &Path, missing: u64, names: Names) -> LogError {
    let remedy = format!("cut the log at its longest gap, or give {} and no time column", names.of(Setting::Rate));
    LogError::Refused(
        "mostly-missing",
        format!("{}: {missing} samples are missing between its rows; {remedy}", path.display()),
    )
}
