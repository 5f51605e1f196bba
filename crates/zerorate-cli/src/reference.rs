//! Writes the reference of all commands and options in Markdown for the book, from the definition of the command line.

use crate::commands::help::DEVICE;
use clap::{Arg, Command};

/// Makes the page: the options that every command takes, a section for each of `groups`, which list commands of `cli`
/// by purpose, and device addresses.
pub fn page(mut cli: Command, groups: &[(&str, &[&str])]) -> String {
    cli.build();
    let global: String = cli.get_arguments().filter(|arg| arg.is_global_set()).map(item).collect();
    let mut page = format!("Every command takes this option:\n\n{global}");
    for (group, names) in groups {
        page += &format!("\n## {group}\n");
        page.extend(names.iter().filter_map(|name| cli.find_subcommand(name)).map(section));
    }
    page + &format!("\n## Devices\n\n{}", block(DEVICE))
}

fn section(command: &Command) -> String {
    let usage = command.clone().render_usage().to_string();
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let mut text = format!("\n### {}\n\n{}\n\n", command.get_name(), plain(&about));
    text += &block(usage.trim_start_matches("Usage: "));
    let is_own = |arg: &&Arg| !arg.is_global_set() && !arg.is_hide_set() && !matches!(arg.get_id().as_str(), "help");
    let (positional, options): (Vec<&Arg>, Vec<&Arg>) =
        command.get_arguments().filter(is_own).partition(|arg| arg.is_positional());
    let items: String = positional.into_iter().chain(options).map(item).collect();
    if !items.is_empty() {
        text += &format!("\n{items}");
    }
    match command.get_after_help() {
        Some(notes) => text + "\n" + &block(&notes.to_string()),
        None => text,
    }
}

fn item(arg: &Arg) -> String {
    let long = arg.get_long().map(|long| format!("--{long}"));
    let names: Vec<String> = arg.get_short().map(|short| format!("-{short}")).into_iter().chain(long).collect();
    let value = arg.get_value_names().filter(|_| arg.get_action().takes_values()).unwrap_or_default();
    let value = value.iter().map(|value| format!("<{value}>")).collect::<Vec<_>>().join(" ");
    let head = [names.join(", "), value].iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join(" ");
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = format!("- `{head}`: {}", plain(&help).replace("\n\n", " "));
    let defaults: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if arg.get_action().takes_values() && !defaults.is_empty() {
        text += &format!(" [default: `{}`]", defaults.join(" "));
    }
    text.push('\n');
    for value in arg.get_possible_values().iter().filter(|value| !value.is_hide_set()) {
        let help = value.get_help().map(|help| format!(": {}", plain(&help.to_string()))).unwrap_or_default();
        text += &format!("    - `{}`{help}\n", value.get_name());
    }
    text
}

fn plain(text: &str) -> String {
    text.trim().replace('<', "\\<").replace('*', "\\*").replace("](", "]\\(")
}

fn block(text: &str) -> String {
    format!("```text\n{}\n```\n", text.trim_end())
}
