//! `zerorate explain`: the meaning of the code of a warning or refusal.

use crate::exit::Usage;
use crate::output::{print_json, print_lines};
use anyhow::Result;
use clap::Args;
use std::collections::BTreeMap;
use std::fmt::Write;
use zerorate_jobs::codes::{self, Explanation};

/// Explain the code of a warning or refusal
///
/// Every warning begins with its code, and every refusal is followed by one. The explanation says what was seen, why
/// it matters and what to do. Without a code, all codes are listed.
#[derive(Args, Debug)]
pub struct ExplainArgs {
    /// The code, such as aliased, or the whole line of the warning [default: list all].
    #[arg(value_name = "CODE")]
    code: Vec<String>,
    /// Print one JSON object to stdout.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &ExplainArgs) -> Result<()> {
    if args.code.is_empty() {
        return match args.json {
            true => print_json(&BTreeMap::from([("codes", codes::all().collect::<Vec<_>>())])),
            false => print_lines(&list()?),
        };
    }
    let wanted = args.code.join(" ");
    let found = codes::explain(&wanted).ok_or_else(|| unknown(&wanted))?;
    match args.json {
        true => print_json(&found),
        false => print_lines(&text(&found)?),
    }
}

fn list() -> Result<String> {
    let mut text = String::new();
    for group in codes::groups() {
        writeln!(text, "{}:", group.title)?;
        for one in group.codes {
            writeln!(text, "  {:24} {:19} {}", one.code, one.says, one.seen)?;
        }
    }
    Ok(text)
}

fn text(one: &Explanation) -> Result<String> {
    let mut text = String::new();
    writeln!(text, "{}: a {} of {}\n", one.code, one.says, one.by.join(", "))?;
    writeln!(text, "Seen:    {}\nMatters: {}\nDo:      {}", one.seen, one.matters, one.remedy)?;
    if !one.command.is_empty() {
        writeln!(text, "As in:   {}", one.command)?;
    }
    Ok(text)
}

fn unknown(wanted: &str) -> Usage {
    let near = codes::nearest(wanted);
    let meant = match near.as_slice() {
        [] => "`zerorate explain` lists all".to_owned(),
        near => format!("did you mean {}? `zerorate explain` lists all", near.join(", ")),
    };
    Usage(format!("no warning and no refusal has the code {wanted:?}: {meant}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::{CommandFactory, Parser};

    /// Splits an example command into its arguments. Quotes may only enclose a single word.
    fn words(line: &str) -> Vec<String> {
        line.split(' ').map(|word| word.trim_matches('\'').to_owned()).collect()
    }

    #[test]
    fn every_command_of_the_table_is_one() {
        let commands: Vec<&str> =
            codes::all().map(|one| one.command).filter(|one| one.starts_with("zerorate")).collect();
        assert!(commands.len() > 30, "{}", commands.len());
        for command in commands {
            Cli::try_parse_from(words(command)).unwrap_or_else(|why| panic!("{command}: {why}"));
        }
    }

    #[test]
    fn each_code_names_commands_that_exist() {
        let cli = Cli::command();
        let known: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        for one in codes::all() {
            assert!(one.by.iter().all(|name| known.contains(&&**name)), "{}: {:?}", one.code, one.by);
        }
    }
}
