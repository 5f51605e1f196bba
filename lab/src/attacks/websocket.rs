//! Runs Autobahn's test suite for WebSocket against the page's server.

use super::tally::{Outcome, Tally};
use crate::app::target_folder;
use crate::server::Server;
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread;

/// The only Python version that the suite supports.
const PYTHON: &str = "python2.7";
/// The environment variable that selects Python 2.7 if pyenv has installed several versions.
const PYENV: (&str, &str) = ("PYENV_VERSION", "2.7");
const SUITE: &str = "autobahntestsuite==25.10.1";
/// The groups of cases that run in parallel, each of about the same duration.
const PARTS: [&str; 4] = ["1.*,2.*,3.*,4.*", "5.*,7.*,10.*", "6.*", "9.*"];
/// Groups that are left out: thousands of round trips, which the server slows down on purpose (docs/serve.md).
const LEFT_OUT: &str = "9.7.*,9.8.*";
/// The least number of cases that must run. The tests of compression, which the server does not offer, do not count.
const LEAST: usize = 280;

/// The result of a case, as `suite.py` prints it.
#[derive(Debug, Deserialize)]
struct CaseResult {
    case: String,
    behavior: String,
    closing: String,
    code: Option<u16>,
    what: String,
}

/// Runs the suite. If it cannot be installed, prints that and returns `None`.
pub fn run(program: &Path) -> Result<Option<Tally>> {
    let folder = target_folder()?.join("autobahntestsuite");
    if !folder.join("twisted").is_dir() && !install(&folder)? {
        println!("SKIPPED: Websocket: {SUITE} cannot be installed; it needs {PYTHON} with pip");
        return Ok(None);
    }
    let server = Server::start(program, &["--device", "twin:seed=3"])?;
    let url = format!("ws://{}/ws", server.page);
    let suite = |cases: &str| {
        let mut suite = Command::new(PYTHON);
        suite.env(PYENV.0, PYENV.1).env("PYTHONDONTWRITEBYTECODE", "1").arg("lab/src/attacks/suite.py");
        suite.arg(&folder).args([&*url, cases, LEFT_OUT]).stdin(Stdio::null()).output()
    };
    let parts = thread::scope(|scope| {
        let running = PARTS.map(|cases| scope.spawn(|| suite(cases)));
        running.map(|part| part.join().expect("no thread panics"))
    });
    let mut tally = Tally::default();
    for output in parts {
        tally.0.extend(found(&output?)?.into_iter().map(|found| (found.case.clone(), judge(&found))));
    }
    server.end()?;
    ensure!(tally.0.len() >= LEAST, "{} cases of {LEAST}", tally.0.len());
    Ok(Some(tally))
}

fn install(folder: &Path) -> Result<bool> {
    println!("installing {SUITE} into {}", folder.display());
    let mut pip = Command::new(PYTHON);
    pip.env(PYENV.0, PYENV.1).args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--target"]);
    Ok(pip.arg(folder).arg(SUITE).stderr(Stdio::null()).status().is_ok_and(|status| status.success()))
}

fn found(output: &Output) -> Result<Vec<CaseResult>> {
    let text = str::from_utf8(&output.stderr)?;
    ensure!(output.status.success(), "the suite ended with {}: {text}", output.status);
    let lines = text.lines().filter(|line| line.starts_with('{'));
    lines.map(|line| serde_json::from_str(line).with_context(|| line.to_owned())).collect()
}

/// The suite's verdict, except for messages that the page's server refuses by design: binary or above 1 MiB.
fn judge(found: &CaseResult) -> Outcome {
    let by_design = refusal(&found.case);
    let is_done = matches!(&*found.behavior, "OK" | "NON-STRICT" | "INFORMATIONAL")
        && matches!(&*found.closing, "OK" | "INFORMATIONAL");
    match (by_design, is_done) {
        // the server may close the connection before the suite has sent everything
        (Some(code), _) if found.code.is_none_or(|told| told == code) => Outcome::Refused(format!("closed, {code}")),
        (None, true) => match found.code {
            Some(code @ (1002 | 1003 | 1007 | 1009)) => Outcome::Refused(format!("closed, {code}")),
            _ => Outcome::Right,
        },
        _ => {
            Outcome::Wrong(format!("{}, closing {}, {:?}: {}", found.behavior, found.closing, found.code, found.what))
        }
    }
}

/// The close code with which the server refuses a valid message of this case; `None` if it accepts the message.
fn refusal(case: &str) -> Option<u16> {
    let is_binary = ["1.2.", "9.2.", "9.4.", "9.6."].iter().any(|group| case.starts_with(group));
    let is_large = matches!(case, "9.1.4" | "9.1.5" | "9.1.6") || case.starts_with("9.3.");
    match (is_binary, is_large) {
        // messages of 4 MiB and more are first refused for their size
        (true, _) if matches!(case, "9.2.4" | "9.2.5" | "9.2.6") || case.starts_with("9.4.") => Some(1009),
        (true, _) => Some(1003),
        (false, true) => Some(1009),
        (false, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_of_the_suite_counts() {
        let found = |case: &str, behavior: &str, closing: &str, code| {
            let [case, behavior, closing] = [case, behavior, closing].map(str::to_owned);
            judge(&CaseResult { case, behavior, closing, code, what: String::new() })
        };
        assert!(matches!(found("1.1.1", "OK", "OK", Some(1000)), Outcome::Right));
        assert!(matches!(found("1.1.1", "OK", "UNCLEAN", None), Outcome::Wrong(_)));
        assert!(matches!(found("2.5", "FAILED", "OK", None), Outcome::Wrong(_)));
        assert!(matches!(found("6.3.1", "OK", "OK", Some(1007)), Outcome::Refused(_)));
        assert!(matches!(found("1.2.1", "FAILED", "FAILED", Some(1003)), Outcome::Refused(_)));
        assert!(matches!(found("1.2.1", "FAILED", "FAILED", Some(1002)), Outcome::Wrong(_)));
        assert!(matches!(found("9.1.4", "FAILED", "FAILED", Some(1009)), Outcome::Refused(_)));
    }
}
