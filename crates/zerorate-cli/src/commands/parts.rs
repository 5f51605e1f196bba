//! `zerorate parts`: the gyroscopes and IMUs that the program knows by name.

use crate::catalogue::{self, FILES};
use crate::output::{print, print_json, print_lines};
use anyhow::{Context, Result};
use clap::Args;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use toml::{Table, Value};
use zerorate::Part;
use zerorate_allan::DataSheet;
use zerorate_allan::datasheet::{Figure, Line};

/// List the gyroscopes and IMUs that are known by name
///
/// --part and `zerorate imu --datasheet` take these names. With a name, the file of that part is printed. It has the
/// scale of each range, the bandwidth and the noise, with their sources. docs/formats/part.md describes it, and a
/// changed copy works as well: zerorate parts icm20948 > mine.toml
#[derive(Args, Debug)]
pub struct PartsArgs {
    /// A part, such as icm20948 [default: list all].
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Print one JSON object with the parts as in their files.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct All {
    parts: Vec<Table>,
}

/// A row of the list.
#[derive(Deserialize)]
struct Row {
    name: String,
    maker: String,
    rate: Rate,
}

#[derive(Deserialize)]
struct Rate {
    range_dps: Value,
    #[serde(default)]
    full_scales: Vec<FullScale>,
}

#[derive(Deserialize)]
struct FullScale {
    range_dps: Value,
}

pub fn run(args: &PartsArgs) -> Result<()> {
    let found = |name: &String| catalogue::find(name).ok_or_else(|| catalogue::unknown(name));
    let texts: Vec<&str> = match &args.name {
        Some(name) => vec![found(name)?],
        None => FILES.iter().map(|(_, text)| *text).collect(),
    };
    if args.json {
        let parts = texts.iter().map(|text| toml::from_str(text)).collect::<Result<_, _>>()?;
        return print_json(&All { parts });
    }
    match args.name {
        Some(_) => print(texts[0]),
        None => print_lines(&list(&texts)?),
    }
}

fn list(texts: &[&str]) -> Result<String> {
    let mut list = format!(
        "{:<15} {:<18} {:<20} {:<16} {:<19} {}\n",
        "part", "maker", "range", "gyroscope noise", "accelerometer noise", "--part"
    );
    for text in texts {
        let row: Row = toml::from_str(text).context("a file of the catalogue")?;
        let sheet = DataSheet::parse(text).ok();
        let is_part = if Part::parse(text).is_ok() { "yes" } else { "no" };
        let (gyroscope, accelerometer) =
            sheet.map_or_else(Default::default, |sheet| (noise(&sheet.gyroscope), noise(&sheet.accelerometer)));
        let range = row.rate.range();
        let (name, maker) = (row.name, row.maker);
        writeln!(list, "{name:<15} {maker:<18} {range:<20} {gyroscope:<16} {accelerometer:<19} {is_part}")?;
    }
    list += "\n`zerorate parts NAME` prints a part, with the sources of its numbers.\n\
             --datasheet takes all that have noise; --part needs the scales of codes and of the temperature.\n";
    Ok(list)
}

impl Rate {
    /// `±250 to 2000 °/s`.
    fn range(&self) -> String {
        let all = self.full_scales.iter().map(|full_scale| &full_scale.range_dps).chain([&self.range_dps]);
        let all: Vec<f64> = all.filter_map(value).collect();
        let (least, most) = all.iter().fold((f64::INFINITY, 0.0), |(a, b), &dps| (dps.min(a), dps.max(b)));
        if least < most { format!("±{least} to {most} °/s") } else { format!("±{most} °/s") }
    }
}

/// A number, alone or in a table with its source.
fn value(number: &Value) -> Option<f64> {
    let number = number.get("value").unwrap_or(number);
    number.as_float().or_else(|| number.as_integer().map(|whole| whole as f64))
}

/// The white noise, as the data sheet prints it.
fn noise(lines: &[Line]) -> String {
    let of = |figure: Figure| lines.iter().find(move |line| line.figure == figure);
    let line = of(Figure::NoiseDensity).or_else(|| of(Figure::RandomWalk));
    line.map_or_else(String::new, |line| format!("{} {}", line.value, line.unit))
}
