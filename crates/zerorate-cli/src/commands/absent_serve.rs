//! Stands in for `zerorate serve` in a program that was built without it.

use crate::exit::Usage;
use anyhow::Result;
use clap::Args;
use std::ffi::OsString;
use std::path::Path;
use zerorate_input::NotBuiltIn;

/// Show a sensor live in the browser (not in this program: it was built without it)
#[derive(Args, Debug)]
pub struct ServeArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    given: Vec<OsString>,
}

impl ServeArgs {
    pub fn file(&self) -> Option<&Path> {
        None
    }
}

pub fn run(_: &ServeArgs) -> Result<()> {
    Err(Usage(NotBuiltIn { what: "`zerorate serve`", feature: "serve" }.to_string()).into())
}
