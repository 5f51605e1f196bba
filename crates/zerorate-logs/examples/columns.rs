//! Prints the columns of numbers of a log as JSON: `{"columns": [[NAME, [NUMBERS]], …]}`. A missing number is `null`.
//! A log that cannot be read gives `{"refused": REASON}`.
//!
//! ```text
//! cargo run --release -p zerorate-logs --features full --example columns -- log.parquet
//! ```

use serde_json::{Value, json};
use std::fs::File;
use std::path::Path;
use zerorate_logs::{ColumnOptions, ColumnSelection, InputError, LogError, read_all};

fn main() {
    let path = std::env::args().nth(1).expect("the name of a log");
    let found = columns(Path::new(&path)).unwrap_or_else(|why| json!({"refused": why.to_string()}));
    println!("{found}");
}

fn columns(path: &Path) -> Result<Value, LogError> {
    let file = File::open(path).map_err(|error| InputError::io("read", path, error))?;
    // the printed numbers do not depend on the rate
    let options = ColumnOptions { rate: Some(1.0), ..ColumnOptions::default() };
    let columns = read_all(path, file.into(), ColumnSelection::All, &options)?;
    let pair = columns.iter().map(|column| Ok((&*column.name, column.points(path)?)));
    Ok(json!({"columns": pair.collect::<Result<Vec<_>, LogError>>()?}))
}
