//! `zerorate man` and `zerorate completions`: the command line as a manual page and as completion scripts for shells.

use super::help::DEVICE;
use crate::output::print;
use clap_mangen::Man;
use std::io::{self, Write};

/// Prints one manual page: the program, a section for each command except `help`, and the addresses of devices.
pub fn man(mut root: clap::Command) -> anyhow::Result<()> {
    root.build();
    let man = Man::new(root.clone());
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    render_body(&man, &root, &mut page)?;
    for command in root.get_subcommands().filter(|c| c.get_name() != "help") {
        writeln!(page, ".SH \"ZERORATE {}\"", command.get_name().to_uppercase())?;
        page.extend(command_section(command)?);
    }
    writeln!(page, ".SH DEVICES\n.nf\n{}.fi", roff(DEVICE))?;
    print(&String::from_utf8_lossy(&page))
}

/// The manual section of a command: the text of [`render_body`] one heading level lower.
fn command_section(command: &clap::Command) -> io::Result<Vec<u8>> {
    let mut section = Vec::new();
    render_body(&Man::new(command.clone()), command, &mut section)?;
    Ok(String::from_utf8_lossy(&section).replace(".SH ", ".SS ").into_bytes())
}

fn render_body(man: &Man, command: &clap::Command, page: &mut Vec<u8>) -> io::Result<()> {
    man.render_synopsis_section(page)?;
    man.render_description_section(page)?;
    man.render_options_section(page)?;
    if command.get_after_help().is_some() {
        let mut notes = Vec::new();
        man.render_extra_section(&mut notes)?;
        // the lines of the notes are tables, so roff must not join (fill) them
        let notes = String::from_utf8_lossy(&notes).replacen("EXTRA\n", "NOTES\n.nf\n", 1);
        writeln!(page, "{}\n.fi", notes.trim_end())?;
    }
    Ok(())
}

/// Escapes text for roff, so that roff does not take a line for a request (a command).
fn roff(text: &str) -> String {
    text.replace('\\', "\\e").replace('-', "\\-").replace("\n'", "\n\\&'").replace("\n.", "\n\\&.")
}

pub fn completions(shell: clap_complete::Shell, root: &mut clap::Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, root, "zerorate", &mut script);
    print(&String::from_utf8_lossy(&script))
}
