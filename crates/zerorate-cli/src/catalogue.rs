//! The parts that the program knows by name: the files of `parts/`.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::Result;
use std::io;
use std::path::Path;
use zerorate_record::limits;

macro_rules! files {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("../../../parts/", $name, ".toml")))),*] };
}

/// Name and text of each file.
pub const FILES: &[(&str, &str)] = files! {
    "adis16130"
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
            let sheet = DataSheet::parse(text).unwrap_or_else(|why| panic!("{file}: {why}"));
            assert_eq!(key(&sheet.name), *file);
            assert!(sheet.source.is_some(), "{file} has no source");
            match Part::parse(text) {
                Ok(part) => assert!(part.axes.iter().all(|axis| axis.axis.range_dps.is_some()), "{file}"),
                // it gives values and not codes
                Err(why) => assert!(!text.contains("lsb_per_dps"), "{file}: {why}"),
            }
        }
    }

    #[test]
    fn the_adis16130_is_a_part_like_the_others() {
        assert_eq!(Part::parse(find("ADIS-16130").unwrap()).unwrap(), Part::ADIS16130);
    }
}
