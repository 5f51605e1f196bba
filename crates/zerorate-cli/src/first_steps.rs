//! Parses the command line. Without arguments, prints the first steps for new users. Adds advice to clap's errors.

use crate::cli::Cli;
use crate::output::say;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, Command, CommandFactory, FromArgMatches};
use std::error::Error as _;
use std::ffi::OsString;
use std::num::{ParseFloatError, ParseIntError};
use std::process::ExitCode;

const LINES: [&str; 5] = [
    "zerorate measures the noise of any gyroscope, and finds and removes the bias of an ADIS16130. First steps:",
    "  zerorate allan log.csv --fit                   the noise of a log that you have",
    "  zerorate calibrate -o unit.toml                no hardware: calibrate a simulated sensor in seconds",
    "  zerorate probe --device bridge:/dev/ttyACM0    check that a sensor responds and delivers samples",
    "  zerorate help                                  all commands; `zerorate help COMMAND` explains one",
];

/// Commands that this program does not have although users may look for them, and where their functions are.
const ELSEWHERE: [(&str, &str); 3] = [
    ("version", "is an option: zerorate --version"),
    ("fleet", "is in the Python package: pip install './bindings/python[fleet]' in a clone"),
    (
        "certificate",
        "is `zerorate-certificate`: pip install ./bindings/python ./extras/zerorate-certificate in a clone",
    ),
];

const USAGE: u8 = 2;

/// Parses the command line and applies its limits, or prints an error, help or the first steps and returns the code.
pub fn parse(args: &[OsString]) -> Result<Cli, ExitCode> {
    if args.len() < 2 {
        LINES.iter().for_each(say);
        return Err(ExitCode::from(USAGE));
    }
    let cli = parsed(args).map_err(|error| printed(&advised(error)))?;
    cli.set_limits();
    Ok(cli)
}

/// Parses the command line. Options accept negative numbers, so that their own errors can state the limits. Named
/// values may be in upper or lower case.
fn parsed<T: Into<OsString> + Clone>(args: impl IntoIterator<Item = T>) -> Result<Cli, Error> {
    let lenient = |arg: Arg| match arg.get_action().takes_values() && !arg.is_positional() {
        true => arg.allow_negative_numbers(true).ignore_case(true),
        false => arg,
    };
    let command = Cli::command().mut_subcommands(|command| command.mut_args(lenient));
    Cli::from_arg_matches_mut(&mut command.try_get_matches_from(args)?)
}

fn printed(error: &Error) -> ExitCode {
    let text = error.render().to_string();
    match text.starts_with("error:") {
        true => brief(&text).for_each(say),
        // a failure to print is ignored, because it cannot be reported
        false => drop(error.print()),
    }
    ExitCode::from(error.exit_code() as u8)
}

/// The lines of an error. Leaves out empty lines, and the pointer to the help if the error shows the usage.
fn brief(error: &str) -> impl Iterator<Item = &str> {
    let has_usage = error.contains("\nUsage:");
    let lines = error.lines().filter(|line| !line.trim().is_empty());
    lines.filter(move |line| !(has_usage && line.starts_with("For more information")))
}

/// Adds our own tip to an error about a number, a command of another program, or an argument that does not fit.
fn advised(mut error: Error) -> Error {
    let given = |kind| match error.get(kind) {
        Some(ContextValue::String(given)) => Some(given.as_str()),
        _ => None,
    };
    let argument = given(ContextKind::InvalidArg).filter(|_| error.kind() == ErrorKind::UnknownArgument);
    let number = given(ContextKind::InvalidValue).and_then(|value| of_number(value, error.source()));
    let tip = match (number, given(ContextKind::InvalidSubcommand), argument) {
        (Some(tip), _, _) => Some(tip),
        (None, Some(command), _) => {
            let Some((name, how)) = ELSEWHERE.iter().find(|(name, _)| *name == command) else { return error };
            Some(format!("`{name}` {how}"))
        }
        (None, None, Some(argument)) => of_argument(argument, &usage(&error)),
        (None, None, None) => return error,
    };
    // the user means the command of the other program, not one with a similar name
    error.remove(ContextKind::SuggestedSubcommand);
    error.remove(ContextKind::Suggested);
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

fn usage(error: &Error) -> String {
    match error.get(ContextKind::Usage) {
        Some(ContextValue::StyledStr(usage)) => usage.to_string(),
        _ => String::new(),
    }
}

/// A tip about a value that the option does not accept as a number; `None` if there is no tip.
fn of_number(value: &str, why: Option<&(dyn std::error::Error + 'static)>) -> Option<String> {
    let is_whole = || why.is_some_and(|why| why.is::<ParseIntError>());
    let is_float = || why.is_some_and(|why| why.is::<ParseFloatError>());
    match (with_point(value), value.strip_suffix('%').and_then(|share| share.parse::<f64>().ok())) {
        (Some(point), _) => Some(format!("use a decimal point: {point}")),
        (None, Some(percent)) => Some(format!("write the share as a number: {}", percent / 100.0)),
        (None, None) if is_whole() => Some("give a whole number, such as 10".to_owned()),
        (None, None) if is_float() => Some("give a number, such as 0.01".to_owned()),
        (None, None) => None,
    }
}

/// A tip about an argument that does not fit into a command with this usage; `None` if there is no tip.
fn of_argument(argument: &str, usage: &str) -> Option<String> {
    if argument == "--port" {
        return Some("--listen takes address and port: --listen 127.0.0.1:8130".to_owned());
    }
    let cli = Cli::command();
    if let Some(option) = argument.strip_prefix('-') {
        if option.starts_with(|c: char| c.is_ascii_digit()) {
            return Some("join a value that begins with - to its option: --OPTION=-5".to_owned());
        }
        let is_it = |arg: &Arg| names(arg).contains(&argument.to_owned());
        let has = |command: &&Command| command.get_arguments().any(is_it);
        let commands: Vec<&str> = cli.get_subcommands().filter(has).map(Command::get_name).collect();
        return (!commands.is_empty()).then(|| format!("`{argument}` is an option of {}", commands.join(", ")));
    }
    if argument.contains('=') {
        let keys = argument.strip_prefix("twin:").unwrap_or(argument);
        return Some(format!("keys of the simulated sensor belong to a device: --device twin:{keys}"));
    }
    if ["s", "min", "h", "ms", "Hz"].contains(&argument) {
        return Some(format!("join a number and its unit: 5{argument}"));
    }
    let command = cli.find_subcommand(usage.split_whitespace().nth(2)?)?;
    if command.get_positionals().any(|arg| arg.get_id() == "log") {
        return Some(format!("`{}` takes one log", command.get_name()));
    }
    let takes_file = |arg: &&Arg| !arg.is_positional() && arg.get_value_names().is_some_and(|names| names == ["FILE"]);
    let options: Vec<String> = command.get_arguments().filter(takes_file).flat_map(|arg| names(arg).pop()).collect();
    (!options.is_empty()).then(|| format!("an option goes before a file: {}", options.join(", ")))
}

fn names(arg: &Arg) -> Vec<String> {
    let short = arg.get_short().map(|short| format!("-{short}"));
    short.into_iter().chain(arg.get_long().map(|long| format!("--{long}"))).collect()
}

/// Replaces the comma in `100,5` or `1,5h` by a point. `None` if the text is not a single number with a decimal comma.
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
            let error = parsed(command.split(' ')).expect_err(command);
            let text = advised(error).render().to_string();
            assert!((1..=4).contains(&brief(&text).count()), "{command}: {text}");
        }
    }

    #[test]
    fn tips_are_about_the_mistake() {
        for (command, tip) in [
            ("zerorate probe --fit", Some("`--fit` is an option of allan")),
            ("zerorate calibrate --settle -5m", Some("join a value that begins with - to its option: --OPTION=-5")),
            ("zerorate calibrate --unknown-thing", None),
            ("zerorate export a.toml b.toml --format c", Some("an option goes before a file: --output")),
            ("zerorate calibrate unit.toml", Some("an option goes before a file: --output, --log")),
            ("zerorate twin seed=3", Some("keys of the simulated sensor belong to a device: --device twin:seed=3")),
            ("zerorate calibrate --max-lost 1%", Some("write the share as a number: 0.01")),
            ("zerorate capture -o a.csv --samples many", Some("give a whole number, such as 10")),
            (
                "zerorate probe twin:seed=3",
                Some("keys of the simulated sensor belong to a device: --device twin:seed=3"),
            ),
            ("zerorate stream --cal a.toml --duration 5 min", Some("join a number and its unit: 5min")),
            ("zerorate imu a.csv b.csv", Some("`imu` takes one log")),
            ("zerorate version", Some("`version` is an option: zerorate --version")),
        ] {
            let error = advised(parsed(command.split(' ')).expect_err(command)).render().to_string();
            let line = error.lines().find_map(|line| line.trim().strip_prefix("tip: "));
            assert_eq!(line, tip, "{error}");
        }
        // a build without the server accepts all arguments of `serve`, because its only answer is an error
        let of_serve =
            parsed("zerorate serve --port 80".split(' ')).map_err(|error| advised(error).render().to_string());
        assert_eq!(of_serve.is_ok(), !cfg!(feature = "serve"));
        assert!(
            of_serve.err().is_none_or(|error| error.contains("tip: --listen takes address and port: --listen 127"))
        );
        let error = parsed("zerorate allan log.csv --rate -5".split(' ')).expect_err("-5 Hz").to_string();
        assert!(
            error.starts_with("error: invalid value '-5' for '--rate <HZ>': must be a number above zero"),
            "{error}"
        );
    }

    #[test]
    fn every_first_step_is_a_command() {
        for line in &LINES[1..4] {
            let command = line.trim().split("  ").next().unwrap_or_default();
            parsed(command.split(' ')).unwrap_or_else(|why| panic!("{command}: {why}"));
        }
    }
}
