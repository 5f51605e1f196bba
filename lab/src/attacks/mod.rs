//! `cargo xtask attacks`: runs attack suites and test files of other projects against the program. The suites and
//! files are not copied into this repository, but installed or read from checkouts.

mod apache;
mod cases;
mod http;
mod libiio;
mod mcap;
mod reader;
mod tally;
mod websocket;

use crate::app;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use tally::Tally;

#[derive(clap::Args)]
pub struct AttacksArgs {
    /// The parts [default: all]
    #[arg(value_enum)]
    parts: Vec<Part>,
    /// The folder with the checkouts
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// The program to attack, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Print each case with its outcome
    #[arg(long)]
    list: bool,
}

/// The project or standard that the cases come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Requests that two servers may read in two ways; of PortSwigger's http-request-smuggler and RFC 9112
    Http,
    /// Autobahn's test suite; installed by Python 2.7
    Websocket,
    /// libiio's test programs; of Debian's libiio-utils
    Libiio,
    /// Conformance files of MCAP; `git clone https://github.com/foxglove/mcap`
    Mcap,
    /// Files of Arrow that crashed readers, and whole ones; `git clone https://github.com/apache/arrow-testing`
    Arrow,
    /// Files of Parquet that crashed readers, and whole ones; `git clone https://github.com/apache/parquet-testing`
    Parquet,
}

impl Part {
    /// Runs the cases of this part. If a tool or the data is missing, prints that and returns `None`.
    fn run(self, program: &Path, data: Option<&Path>) -> Result<Option<Tally>> {
        let checkout = |name: &str| {
            let folder = data.map(|data| data.join(name)).filter(|folder| folder.is_dir());
            if folder.is_none() {
                println!("SKIPPED: {self:?}: --data DIR has no checkout {name} (--help says of what)");
            }
            folder
        };
        match self {
            Self::Http => http::run(program).map(Some),
            Self::Websocket => websocket::run(program),
            Self::Libiio => libiio::run(program),
            Self::Mcap => checkout("mcap").map_or(Ok(None), |folder| mcap::run(program, &folder)),
            Self::Arrow => checkout("arrow-testing").map_or(Ok(None), |folder| apache::arrow(program, &folder)),
            Self::Parquet => checkout("parquet-testing").map_or(Ok(None), |folder| apache::parquet(program, &folder)),
        }
    }
}

pub fn run(args: &AttacksArgs) -> Result<()> {
    let program = app::given_or_built(args.program.as_deref())?;
    let parts = if args.parts.is_empty() { Part::value_variants() } else { &args.parts };
    let mut wrong = 0;
    for part in parts {
        if let Some(tally) = part.run(&program, args.data.as_deref())? {
            tally.print(&format!("{part:?}"), args.list);
            wrong += tally.wrong();
        }
    }
    ensure!(wrong == 0, "{wrong} outcomes are wrong");
    Ok(())
}
