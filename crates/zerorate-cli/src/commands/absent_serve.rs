//! `zerorate serve`, where it is not built in.

use crate::exit::Usage;
use anyhow::Result;
use clap::Args;
use std::ffi::OsString;
use std::path::Path;
use zerorate_record::NotBuiltIn;

/// Shows a part live in the browser; this program was built without it.
#[derive(Args, Debug)]
pub struct ServeArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    given: Vec<OsString>,
}

impl ServeArgs {
    /// The file of unknown origin that it reads: none.
    pub fn file(&self) -> Option<&Path> {
        None
    }
}

/// Says what adds it.
pub fn run(_: &ServeArgs) -> Result<()> {
    Err(Usage(NotBuiltIn { what: "`zerorate serve`", feature: "serve" }.to_string()).into())
}
