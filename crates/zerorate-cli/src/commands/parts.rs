//! `zerorate parts`: the gyroscopes and IMUs that the program knows by name.

use crate::output::{print, print_json, print_lines};
use anyhow::{Context, Result};
use clap::Args;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use toml::{Table, Value};
use zerorate::Part;
use zerorate_allan::DataSheet;
use zerorate_allan::datasheet::{Figure, Line};
use zerorate_jobs::catalogue::{self, FILES};

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
        let parts: Vec<Table> = texts.iter().map(|text| toml::from_str(text)).collect::<Result<_, _>>()?;
        return print_json(&BTreeMap::from([("parts", parts)]));
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
    /// Formats the range of full scales: `±250 to 2000 °/s`.
    fn range(&self) -> String {
        let all = self.full_scales.iter().map(|full_scale| &full_scale.range_dps).chain([&self.range_dps]);
        let all: Vec<f64> = all.filter_map(value).collect();
        let (least, most) = all.iter().fold((f64::INFINITY, 0.0), |(a, b), &dps| (dps.min(a), dps.max(b)));
        if least < most { format!("±{least} to {most} °/s") } else { format!("±{most} °/s") }
    }
}

/// The value of a number that a part file gives alone or in a table with its source; `None` for other entries.
fn value(number: &Value) -> Option<f64> {
    let number = number.get("value").unwrap_or(number);
    number.as_float().or_else(|| number.as_integer().map(|whole| whole as f64))
}

/// Formats the white noise as the data sheet states it; empty if the data sheet does not state it.
fn noise(lines: &[Line]) -> String {
    let of = |figure: Figure| lines.iter().find(move |line| line.figure == figure);
    let line = of(Figure::NoiseDensity).or_else(|| of(Figure::RandomWalk));
    line.map_or_else(String::new, |line| format!("{} {}", line.value, line.unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_in_the_catalogue() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../parts");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        files.sort_unstable();
        assert_eq!(FILES.iter().map(|(name, _)| *name).collect::<Vec<_>>(), files);
    }

    #[test]
    fn every_part_is_whole() {
        for (file, text) in FILES {
            let read: Table = toml::from_str(text).unwrap_or_else(|why| panic!("{file}: {why}"));
            let of = |name: &str| read.get(name).and_then(Value::as_str).unwrap_or_default();
            assert_eq!(catalogue::find(of("name")), Some(*text), "{file}");
            assert!(!of("source").is_empty() && !of("maker").is_empty(), "{file}");
            let (part, sheet) = (Part::parse(text), DataSheet::parse(text));
            if let Err(why) = &sheet {
                assert!(part.is_ok() && why.to_string().contains("states nothing"), "{file}: {why}");
            }
            match part {
                Ok(part) => assert!(part.axes.iter().all(|axis| axis.axis.range_dps.is_some()), "{file}"),
                // the part gives values instead of codes, or the scale of its temperature is unknown
                Err(why) => assert!(why.to_string().contains("it has no [temperature]"), "{file}: {why}"),
            }
        }
    }

    /// Each full scale takes 15 % to 101 % of the codes. More would mean that the scale belongs to another range.
    #[test]
    fn every_full_scale_fits_its_codes() {
        for (file, text) in FILES {
            let Ok(part) = Part::parse(text) else { continue };
            let read: Table = toml::from_str(text).unwrap();
            let others = read["rate"].get("full_scales").and_then(Value::as_array).into_iter().flatten();
            let others =
                others.map(|one| one["range_dps"].as_float().or(one["range_dps"].as_integer().map(|n| n as f64)));
            for range_dps in [None].into_iter().chain(others) {
                let axis = Part::parse_at(text, range_dps).unwrap_or_else(|why| panic!("{file}: {why}")).axes[0].axis;
                let codes = 2f64.powi(i32::from(axis.rate.width_bits) - 1);
                let used = axis.range_dps.unwrap() * axis.rate.lsb_per_unit / codes;
                assert!((0.15..1.01).contains(&used), "{file}, {:?}: {used}", axis.range_dps);
            }
            assert_eq!(part.axes.len(), read["axis"].as_array().unwrap().len());
        }
    }

    #[test]
    fn the_adis16130_is_a_part_like_the_others() {
        assert_eq!(Part::parse(catalogue::find("ADIS-16130").unwrap()).unwrap(), Part::ADIS16130);
    }
}
