//! Words settings, warnings and errors for the command line.

use crate::column::flag_of;
use std::path::Path;
use zerorate::Setting;
use zerorate_allan::SettingName;
use zerorate_jobs::output::could_be_forced;
use zerorate_jobs::{CodedWarning, InvalidOptions, JobWarning};
use zerorate_record::{CaptureError, Format};

/// Formats a warning as `code: text`, with the names of options.
pub fn coded(warning: impl Into<JobWarning>) -> CodedWarning {
    warning.into().coded(flag)
}

/// The text of an error, with advice about an option. Errors and warnings about errors are printed with this text.
pub fn text(error: &anyhow::Error) -> String {
    let advice = if could_be_forced(error) { ", or give --force" } else { "" };
    format!("{error:#}{advice}")
}

/// The format of the file to write: as requested by `--format`, or by the file extension.
pub fn form(asked: Option<Format>, path: &Path) -> anyhow::Result<Format> {
    Format::choose(asked, path).map_err(|error| match error {
        CaptureError::UnknownEnding { .. } => InvalidOptions(format!("{error}, or give --format")).into(),
        other => other.into(),
    })
}

pub fn flag(setting: Setting) -> SettingName {
    match setting {
        Setting::Edge => SettingName::text("edge=rising or edge=falling in --device"),
        Setting::FinalTemperature => setting.name(),
        other => flag_of(other.word()),
    }
}
