//! The output of commands: what they print and which files they write.

mod print;
mod stdio;
#[cfg(test)]
mod tests;

pub use print::{command_line, print, print_json, print_lines, warn};
pub use stdio::{CANNOT_WRITE, Stdout, clear, reader_left, say, show};
pub use zerorate_jobs::output::{Outputs, StagedOutput, opens_stream, remove_all_for_good};
