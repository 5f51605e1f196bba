//! Settings and warnings of a measurement, in the words of the command line.

use zerorate::Setting;
use zerorate_jobs::output::could_be_forced;
use zerorate_jobs::{CodedWarning, JobWarning};
use zerorate_record::CaptureError;

/// A warning as scripts find it: `code: text`.
pub fn coded(warning: impl Into<JobWarning>) -> CodedWarning {
    warning.into().coded(flag)
}

/// What a command can do about an error, as the end of its sentence.
pub fn remedy(error: &anyhow::Error) -> &'static str {
    match error.downcast_ref() {
        _ if could_be_forced(error) => ", or give --force",
        Some(CaptureError::Corrected { .. }) => {
            ": give `zerorate capture --device replay:CAPTURE --cal FILE -o BAG.mcap` the capture that this was \
             corrected from"
        }
        _ => "",
    }
}

/// What a setting is called on the command line.
pub fn flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Average => "--average",
        Setting::WarmUp => "--warmup",
        Setting::Settle => "--settle",
        Setting::Offset => "--offset",
        Setting::MaxLost => "--max-lost",
        Setting::MaxUBtc => "--max-u-btc",
        Setting::Earth => "--earth-dps",
        Setting::AssumeLinear => "--assume-linear",
        Setting::Target => "--target-dph",
        Setting::EveryTemp => "--every-temp",
        Setting::Divider => "--divider",
        Setting::Edge => "edge=rising or edge=falling in --device",
        Setting::Device => "--device",
        Setting::SelfTest => "--self-test",
        other => other.name(),
    }
}
