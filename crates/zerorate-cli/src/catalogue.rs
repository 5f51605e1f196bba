//! The parts that the program knows by name: the files of `parts/`.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::Result;
use std::io;
use std::path::Path;
use zerorate_input::limits;

macro_rules! files {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("../../../parts/", $name, ".toml")))),*] };
}

/// Name and text of each file.
pub const FILES: &[(&str, &str)] = files! {
    "adis16130" "adis16405" "adis164652" "adis16470" "adis164752" "adis16488" "adis164952"
    "adxrs290" "bmi055" "bmi088" "bmi160" "bmi270" "bno055" "icm20602" "icm20689" "icm20948"
    "icm42688p" "iim42652" "ism330dhcx" "itg3200" "l3gd20h" "lsm6ds3" "lsm6dso" "lsm6dsox" "lsm9ds1"
    "mpu6050" "mpu9250" "mti1" "scha634d03" "vn100"
};

/// The text of a part's file: of the catalogue, or from the path.
pub fn text(named: &Path, outputs: &mut Outputs) -> Result<io::Result<String>> {
    match named.to_str().and_then(find) {
        Some(text) => Ok(Ok(text.to_owned())),
        None => Ok(outputs.try_text(named, limits::TEXT)?),
    }
}

/// The file of the part with this name. Only letters and digits count, of either case.
pub fn find(name: &str) -> Option<&'static str> {
    let wanted = key(name);
    FILES.iter().find(|(known, _)| *known == wanted).map(|(_, text)| *text)
}

/// What to do about a name that is neither in the catalogue nor a file.
pub fn unknown(name: &str) -> Usage {
    let wanted = key(name);
    let near = |known: &&str| wanted.len() > 2 && (known.contains(&wanted) || wanted.contains(*known));
    let near: Vec<&str> = FILES.iter().map(|(known, _)| *known).filter(near).collect();
    let meant = if near.is_empty() { String::new() } else { format!("did you mean {}? ", near.join(" or ")) };
    Usage(format!("{name} is neither a file nor a known part: {meant}`zerorate parts` lists those"))
}

fn key(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate::Part;
    use zerorate_allan::DataSheet;

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
            let read: toml::Table = toml::from_str(text).unwrap_or_else(|why| panic!("{file}: {why}"));
            let of = |name: &str| read.get(name).and_then(toml::Value::as_str).unwrap_or_default();
            assert_eq!(key(of("name")), *file);
            assert!(!of("source").is_empty() && !of("maker").is_empty(), "{file}");
            let (part, sheet) = (Part::parse(text), DataSheet::parse(text));
            if let Err(why) = &sheet {
                assert!(part.is_ok() && why.to_string().contains("states nothing"), "{file}: {why}");
            }
            match part {
                Ok(part) => assert!(part.axes.iter().all(|axis| axis.axis.range_dps.is_some()), "{file}"),
                // it gives values instead of codes, or the scale of its temperature is unknown
                Err(why) => assert!(why.to_string().contains("it has no [temperature]"), "{file}: {why}"),
            }
        }
    }

    /// Codes of 16 bits reach the full scale, and hardly farther: a scale of another range would show.
    #[test]
    fn every_full_scale_fits_its_codes() {
        for (file, text) in FILES {
            let Ok(part) = Part::parse(text) else { continue };
            let read: toml::Table = toml::from_str(text).unwrap();
            let others = read["rate"].get("full_scales").and_then(toml::Value::as_array).into_iter().flatten();
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
        assert_eq!(Part::parse(find("ADIS-16130").unwrap()).unwrap(), Part::ADIS16130);
    }
}
