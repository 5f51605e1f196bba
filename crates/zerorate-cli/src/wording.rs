//! Settings and warnings of a measurement, in the words of the command line.

use zerorate::Setting;
use zerorate_jobs::{CodedWarning, JobWarning};

/// A warning as scripts find it: `code: text`.
pub fn coded(warning: impl Into<JobWarning>) -> CodedWarning {
    warning.into().coded(flag)
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
        other => other.name(),
    }
}
