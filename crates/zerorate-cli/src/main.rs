//! The program `zerorate`.

use std::process::ExitCode;

fn main() -> ExitCode {
    zerorate_cli::main_confined(std::env::args_os())
}
