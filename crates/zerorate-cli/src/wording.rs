//! Settings, warnings and errors in the words of the command line.

use crate::column::flag_of;
use std::path::Path;
use zerorate::Setting;
use zerorate_allan::SettingName;
use zerorate_jobs::output::could_be_forced;
use zerorate_jobs::{CodedWarning, InvalidOptions, JobWarning};
use zerorate_record::{CaptureError, Format};

/// Formats a warning for scripts: `code: text`.
pub fn coded(warning: impl Into<JobWarning>) -> CodedWarning {
    warning.into().coded(flag)
}

/// The text of an error, with the option that helps. Errors and warnings that carry an error both take it.
pub fn text(error: &anyhow::Error) -> String {
    format!("{error:#}{}", remedy(error))
}

/// The form of the file that a command with `--format` writes.
pub fn form(asked: Option<Format>, path: &Path) -> anyhow::Result<Format> {
    Format::choose(asked, path).map_err(|error| match error {
        CaptureError::UnknownEnding { .. } => InvalidOptions(format!("{error}, or give --format")).into(),
        other => other.into(),
    })
}

/// The end of the sentence: what to do about an error.
fn remedy(error: &anyhow::Error) -> &'static str {
    if could_be_forced(error) { ", or give --force" } else { "" }
}

/// Returns the option of a setting.
pub fn flag(setting: Setting) -> SettingName {
    match setting {
        Setting::Edge => SettingName::text("edge=rising or edge=falling in --device"),
        Setting::FinalTemperature => setting.name(),
        other => flag_of(other.word()),
    }
}
