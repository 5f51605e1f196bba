//! `zerorate man` and `zerorate completions`: what the command line says about itself.

use crate::output::print;
use clap_mangen::Man;
use std::io::{self, Write};

/// One page: the program, then a section for each command.
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
    print(&String::from_utf8_lossy(&page))
}

/// What [`render_body`] gives for a command, one heading level down.
fn command_section(command: &clap::Command) -> io::Result<Vec<u8>> {
    let mut section = Vec::new();
    render_body(&Man::new(command.clone()), command, &mut section)?;
    Ok(String::from_utf8_lossy(&section).replace(".SH ", ".SS ").into_bytes())
}

/// Synopsis, description, options and, where there are any, notes.
fn render_body(man: &Man, command: &clap::Command, page: &mut Vec<u8>) -> io::Result<()> {
    man.render_synopsis_section(page)?;
    man.render_description_section(page)?;
    man.render_options_section(page)?;
    if command.get_after_help().is_some() {
        let mut notes = Vec::new();
        man.render_extra_section(&mut notes)?;
        // Its lines are tables: they stay as they are.
        let notes = String::from_utf8_lossy(&notes).replacen("EXTRA\n", "NOTES\n.nf\n", 1);
        writeln!(page, "{}\n.fi", notes.trim_end())?;
    }
    Ok(())
}

/// The completion script for `shell`.
pub fn completions(shell: clap_complete::Shell, root: &mut clap::Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, root, "zerorate", &mut script);
    print(&String::from_utf8_lossy(&script))
}
