//! What commands print, and where their results go.

mod print;
mod stdio;
#[cfg(test)]
mod tests;

pub use print::{print, print_json, print_lines, warn};
pub use stdio::{Stdout, reader_left, say};
pub use zerorate_jobs::output::{Outputs, Recording, Staged, remove_all_for_good};
