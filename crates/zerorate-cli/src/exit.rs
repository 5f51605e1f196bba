//! How a run ends: exit code 0 success, 1 failure, 2 usage error, 3 refusal. The reason is printed to stderr.

use crate::output::{reader_left, say};
use crate::wording::text;
use std::process::ExitCode;
use zerorate_host::{Cause, DeviceError};
use zerorate_input::InputError;
use zerorate_jobs::output::is_refusal;
use zerorate_jobs::refusal_code;
pub use zerorate_jobs::{CodedRefusal, InvalidOptions as Usage};
use zerorate_logs::LogError;
use zerorate_record::CaptureError;

/// Prints why a run failed and returns the exit code. If the reader of stdout closed the pipe (`zerorate … | head`),
/// the run succeeded. Any other closed pipe is a failure.
pub fn report(error: &anyhow::Error) -> ExitCode {
    if reader_left(error) {
        return ExitCode::SUCCESS;
    }
    let cause = error.downcast_ref().map(DeviceError::cause);
    let log = error.downcast_ref::<LogError>();
    let refusal = refusal_code(error);
    let is_request = error.chain().any(|cause| is_request(cause.downcast_ref(), cause.downcast_ref()));
    let (label, code) = if refusal.is_some() {
        ("refused", 3)
    } else if error.is::<Usage>()
        || matches!(log, Some(LogError::Ask(_) | LogError::Choose { .. } | LogError::Merged { .. }))
        || cause == Some(Cause::Request)
        || is_request
        || is_refusal(error)
    {
        ("error", 2)
    } else {
        ("error", 1)
    };
    match log {
        // each row of the table is printed as one line, even if the row has control characters
        Some(LogError::Choose { question, table, .. }) => {
            say(format_args!("{label}: {question}"));
            table.iter().for_each(say);
        }
        _ => say(format_args!("{label}: {}", text(error))),
    }
    if let Some(code) = refusal {
        say(format_args!("code: {code} (`zerorate explain {code}` says more)"));
    }
    ExitCode::from(code)
}

/// True if one of these errors is a usage error: a file name has an unknown extension, or this build lacks a format.
fn is_request(capture: Option<&CaptureError>, log: Option<&LogError>) -> bool {
    let is_missing = |error: &InputError| matches!(error, InputError::NotBuiltIn { .. });
    let of_capture = capture.is_some_and(|error| match error {
        CaptureError::Input(error) => is_missing(error),
        error => matches!(error, CaptureError::UnknownEnding { .. }),
    });
    of_capture || matches!(log, Some(LogError::File(error)) if is_missing(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn each_kind_of_failure_has_its_code() {
        let refused = anyhow::Error::from(CodedRefusal::new("moving", "it moves")).context("step 4");
        let usage: anyhow::Error = Usage("no".into()).into();
        let failed = anyhow::anyhow!("bus");
        let pipe =
            Err::<(), _>(std::io::Error::from(std::io::ErrorKind::BrokenPipe)).context("writing rows").unwrap_err();
        let exists =
            anyhow::Error::from(zerorate_jobs::output::OutputError::Exists { path: "x".into(), has_force: true })
                .context("saving");
        let log = |error: LogError| anyhow::Error::from(error).context("gz");
        let (asked, gapped) =
            (log(LogError::Ask("which?".into())), log(LogError::Refused("mostly-missing", "gaps".into())));
        let several =
            log(LogError::Choose { question: "which?".into(), table: vec!["topic".into()], topics: Vec::new() });
        let expected =
            [(several, 2), (asked, 2), (gapped, 3), (refused, 3), (usage, 2), (exists, 2), (failed, 1), (pipe, 1)];
        for (error, code) in expected {
            assert_eq!(report(&error), ExitCode::from(code), "{error:#}");
        }
    }
}
