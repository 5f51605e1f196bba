//! Parses the command line. Without arguments, prints the first steps for new users. Adds advice to clap's errors.

use crate::cli::{Cli, GROUPS};
use crate::output::say;
use clap::builder::{PossibleValuesParser, StyledStr};
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
    let cli = parsed(args).map_err(|error| printed(&advised(error, args)))?;
    cli.set_limits();
    Ok(cli)
}

/// Parses the command line. Options accept negative numbers, so that their own errors can state the limits. Named
/// values may be in upper or lower case. `help` knows all commands and topics, so that clap can propose one.
fn parsed<T: Into<OsString> + Clone>(args: impl IntoIterator<Item = T>) -> Result<Cli, Error> {
    let lenient = |arg: Arg| match arg.get_action().takes_values() && !arg.is_positional() {
        true => arg.allow_negative_numbers(true).ignore_case(true),
        false => arg,
    };
    let topics = GROUPS.iter().flat_map(|(_, names)| *names).copied().chain(["device"]);
    let topics = PossibleValuesParser::new(topics);
    let command = Cli::command().mut_subcommands(|command| command.mut_args(lenient)).mut_subcommand("help", |help| {
        help.mut_arg("about", |about| about.value_parser(topics).hide_possible_values(true))
    });
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
fn advised(error: Error, args: &[OsString]) -> Error {
    let mut error = of_joined_value(&error, args).unwrap_or(error);
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
        (None, None, Some(argument)) => of_argument(argument, args, &usage(&error)),
        (None, None, None) => return error,
    };
    // the user means the command of the other program, not one with a similar name
    error.remove(ContextKind::SuggestedSubcommand);
    error.remove(ContextKind::Suggested);
    if let Some(tip) = tip {
        // the usage is then that of the argument that clap suggests
        let had_other = error.remove(ContextKind::SuggestedArg).is_some();
        if let Some(plain) = plain_usage(&usage(&error)).filter(|_| had_other) {
            error.insert(ContextKind::Usage, ContextValue::StyledStr(plain));
        }
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

/// The usage of the command that this usage is of, without the options that were given.
fn plain_usage(usage: &str) -> Option<StyledStr> {
    let mut cli = Cli::command();
    cli.build();
    Some(cli.find_subcommand_mut(usage.split_whitespace().nth(2)?)?.render_usage())
}

/// The places of an unknown argument that begins with - and a digit, and of the option before it. It may be a value.
fn of_negative<'a>(argument: &str, args: &'a [OsString]) -> Option<(usize, &'a str, &'a str)> {
    let is_number = argument.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let is_it = |arg: &OsString| arg.to_str().is_some_and(|arg| arg.starts_with(argument));
    let at = args.iter().position(is_it).filter(|_| is_number)?;
    let option = args.get(at.checked_sub(1)?)?.to_str().filter(|option| option.starts_with('-'))?;
    Some((at, option, args[at].to_str()?))
}

/// The error for a value that begins with - and is refused even where it is joined to its option: `--settle -5m`.
fn of_joined_value(error: &Error, args: &[OsString]) -> Option<Error> {
    let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else { return None };
    let (at, option, value) = of_negative(argument, args).filter(|_| error.kind() == ErrorKind::UnknownArgument)?;
    let joined = [OsString::from(format!("{option}={value}"))];
    let error = parsed([&args[..at - 1], &joined, &args[at + 1..]].concat()).err()?;
    (error.kind() == ErrorKind::ValueValidation).then_some(error)
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
fn of_argument(argument: &str, args: &[OsString], usage: &str) -> Option<String> {
    if argument == "--port" {
        return Some("--listen takes address and port: --listen 127.0.0.1:8130".to_owned());
    }
    if let Some((_, option, value)) = of_negative(argument, args) {
        return Some(format!("join a value that begins with - to its option: {option}={value}"));
    }
    let cli = Cli::command();
    if argument.starts_with('-') {
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
    of_surplus(argument, args, cli.find_subcommand(usage.split_whitespace().nth(2)?)?)
}

/// A tip about one argument too many, which may be the file of an option that is not given.
fn of_surplus(argument: &str, args: &[OsString], command: &Command) -> Option<String> {
    if let Some(only) = command.get_positionals().next() {
        let name = only.get_value_names()?.first()?.to_lowercase().replace('|', " or ");
        return Some(format!("`{}` takes one {name}", command.get_name()));
    }
    let takes_file = |arg: &&Arg| !arg.is_positional() && arg.get_value_names().is_some_and(|names| names == ["FILE"]);
    let given: Vec<&str> = args.iter().filter_map(|given| given.to_str()?.split('=').next()).collect();
    let is_given = |arg: &Arg| names(arg).iter().any(|name| given.contains(&name.as_str()));
    let open = command.get_arguments().filter(takes_file).filter(|arg| !is_given(arg));
    let options: Vec<String> = open.flat_map(|arg| names(arg).pop()).collect();
    let is_file = argument.contains(['.', '/', '\\']) && !options.is_empty();
    is_file.then(|| format!("an option goes before a file: {}", options.join(", ")))
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

    /// The error about a command line, with its tip.
    fn advised_of(command: &str) -> String {
        let args: Vec<OsString> = command.split(' ').map(OsString::from).collect();
        advised(parsed(&args).expect_err(command), &args).render().to_string()
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
            let text = advised_of(command);
            assert!((1..=4).contains(&brief(&text).count()), "{command}: {text}");
        }
    }

    #[test]
    fn tips_are_about_the_mistake() {
        for (command, tip) in [
            ("zerorate probe --fit", Some("`--fit` is an option of allan")),
            ("zerorate calibrate --serial -5m", Some("join a value that begins with - to its option: --serial=-5m")),
            ("zerorate calibrate -5m", None),
            ("zerorate calibrate --unknown-thing", None),
            ("zerorate export a.toml b.toml --format c", Some("`export` takes one calibration")),
            ("zerorate correct a.csv b.csv -o c.csv", Some("`correct` takes one capture or log")),
            ("zerorate capture --duration 5 parsec -o a.arrows", None),
            ("zerorate capture b.arrows -o a.arrows", None),
            ("zerorate help calibrate stream", Some("`help` takes one command or topic")),
            ("zerorate help devise", Some("a similar value exists: 'device'")),
            ("zerorate help calibrat", Some("a similar value exists: 'calibrate'")),
            ("zerorate help xyz", None),
            ("zerorate calibrate -o a.toml unit.toml", Some("an option goes before a file: --log")),
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
            let error = advised_of(command);
            let line = error.lines().find_map(|line| line.trim().strip_prefix("tip: "));
            assert_eq!(line, tip, "{error}");
        }
        // a build without the server accepts all arguments of `serve`, because its only answer is an error
        let of_serve =
            parsed("zerorate serve --port 80".split(' ')).map_err(|error| advised(error, &[]).render().to_string());
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
    fn the_usage_is_of_the_command_and_not_of_another_option() {
        for (command, usage) in [
            ("zerorate calibrate --rate 200", "Usage: zerorate calibrate [OPTIONS]"),
            ("zerorate imu a.csv --fit", "Usage: zerorate imu [OPTIONS] <LOG>"),
        ] {
            let error = advised_of(command);
            assert!(error.contains("` is an option of ") && error.lines().any(|line| line == usage), "{error}");
        }
    }

    #[test]
    fn no_duration_is_negative() {
        for option in ["calibrate --settle", "stream --cal a.toml --duration", "probe --duration", "imu a.csv --skip"]
        {
            for value in ["-5m", "-5", "-1h30m"] {
                let error = advised_of(&format!("zerorate {option} {value}"));
                assert!(error.contains("it cannot be negative") && !error.contains("tip:"), "{error}");
            }
        }
    }

    #[test]
    fn every_first_step_is_a_command() {
        for line in &LINES[1..4] {
            let command = line.trim().split("  ").next().unwrap_or_default();
            parsed(command.split(' ')).unwrap_or_else(|why| panic!("{command}: {why}"));
        }
    }
}
