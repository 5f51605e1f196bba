//! From arguments to a command: the first steps where there are none, and clap's errors with our advice.

use crate::cli::Cli;
use crate::output::say;
use clap::Parser;
use clap::error::{ContextKind, ContextValue, Error};
use std::ffi::OsString;
use std::process::ExitCode;

/// The text that the program prints without arguments.
const LINES: [&str; 5] = [
    "zerorate measures the noise of any gyroscope, and finds and removes the bias of an ADIS16130. First steps:",
    "  zerorate allan log.csv --fit                   the noise of a log that you have",
    "  zerorate calibrate -o unit.toml                no hardware: calibrate a simulated sensor in seconds",
    "  zerorate probe --device bridge:/dev/ttyACM0    check that a sensor responds and delivers samples",
    "  zerorate help                                  all commands; `zerorate help COMMAND` explains one",
];

/// The commands that are written in Python, and how to install each in a clone.
const OF_PYTHON: [(&str, &str); 2] = [
    ("fleet", "is in the Python package: pip install './bindings/python[fleet]' in a clone"),
    (
        "certificate",
        "is `zerorate-certificate`: pip install ./bindings/python ./extras/zerorate-certificate in a clone",
    ),
];

/// The exit code of a command line that cannot be carried out.
const USAGE: u8 = 2;

/// Parses the command line and puts its limits in force. Without arguments it prints the first steps and returns the
/// exit code.
pub fn parse(args: &[OsString]) -> Result<Cli, ExitCode> {
    if args.len() < 2 {
        LINES.iter().for_each(say);
        return Err(ExitCode::from(USAGE));
    }
    let cli = Cli::try_parse_from(args).map_err(|error| printed(&advised(error)))?;
    cli.set_limits();
    Ok(cli)
}

/// Prints an error of clap's, or the help that was asked for.
fn printed(error: &Error) -> ExitCode {
    let text = error.render().to_string();
    match text.starts_with("error:") {
        true => brief(&text).for_each(say),
        // nobody is left to be told that this cannot be printed
        false => drop(error.print()),
    }
    ExitCode::from(error.exit_code() as u8)
}

/// An error without empty lines, and without a pointer to the help where it has the usage.
fn brief(error: &str) -> impl Iterator<Item = &str> {
    let has_usage = error.contains("\nUsage:");
    let lines = error.lines().filter(|line| !line.trim().is_empty());
    lines.filter(move |line| !(has_usage && line.starts_with("For more information")))
}

/// The error, with a tip where a number has a decimal comma, or a command is written in Python.
fn advised(mut error: Error) -> Error {
    let given = |kind| match error.get(kind) {
        Some(ContextValue::String(given)) => Some(given.as_str()),
        _ => None,
    };
    let point = given(ContextKind::InvalidValue).and_then(with_point);
    let command = given(ContextKind::InvalidSubcommand);
    let of_python = OF_PYTHON.iter().find(|(name, _)| command == Some(name));
    let tip = match (point, of_python) {
        (Some(point), _) => format!("use a decimal point: {point}"),
        (None, Some((command, how))) => format!("`{command}` {how}"),
        (None, None) => return error,
    };
    // the user means this command, and none of a similar name
    error.remove(ContextKind::SuggestedSubcommand);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// `100,5` and `1,5h` with a point; none of what is not one number with a comma in it.
fn with_point(text: &str) -> Option<String> {
    let (whole, rest) = text.split_once(',')?;
    let digits = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let decimals = rest.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    (is_number(digits) && is_number(decimals)).then(|| format!("{whole}.{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_is_told_from_a_list() {
        for (given, point) in [("100,5", "100.5"), ("-0,004", "-0.004"), ("1,5h", "1.5h")] {
            assert_eq!(with_point(given).as_deref(), Some(point));
        }
        for other in ["gx,gy", "1,2,3", "1,", ",5", "100.5", "", "1,5 h 3"] {
            assert_eq!(with_point(other), None, "{other}");
        }
    }

    #[test]
    fn errors_of_the_command_line_are_short() {
        let wrong = [
            "zerorate calibrat",
            "zerorate calibrate --devise twin:",
            "zerorate calibrate --method warm",
            "zerorate calibrate --max-u-btc 0,01",
            "zerorate stream --rate 10",
            "zerorate certificate unit.toml",
        ];
        for command in wrong {
            let error = Cli::try_parse_from(command.split(' ')).expect_err(command);
            let text = advised(error).render().to_string();
            assert!((1..=4).contains(&brief(&text).count()), "{command}: {text}");
        }
    }

    #[test]
    fn every_first_step_is_a_command() {
        for line in &LINES[1..4] {
            let command = line.trim().split("  ").next().unwrap_or_default();
            Cli::try_parse_from(command.split(' ')).unwrap_or_else(|why| panic!("{command}: {why}"));
        }
    }
}
