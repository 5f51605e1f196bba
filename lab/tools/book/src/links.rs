//! Checks that every link of the book leads to an existing page and anchor, and that no page loads foreign files.

use crate::stage::below;
use anyhow::{Result, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

pub fn check(out: &Path, pages: &[PathBuf]) -> Result<()> {
    let mut texts = BTreeMap::new();
    for page in pages {
        texts.insert(page.clone(), fs::read_to_string(page)?);
    }
    let places: BTreeMap<&PathBuf, BTreeSet<&str>> =
        texts.iter().map(|(page, text)| (page, values(text, "id").collect())).collect();
    let mut broken = Vec::new();
    for (page, text) in &texts {
        let loads = values(text, "src").chain(values(text, "srcset")).chain(values(text, "data"));
        broken.extend(loads.filter(|url| is_elsewhere(url)).map(|url| format!("{}: loads {url}", page.display())));
        for target in values(text, "href").chain(values(text, "src")).filter(|url| !is_elsewhere(url)) {
            if let Err(why) = leads(out, page, target, &places) {
                broken.push(format!("{}: {target}: {why}", page.display()));
            }
        }
    }
    for sheet in below(out)?.iter().filter(|path| path.extension().is_some_and(|e| e == "css")) {
        let text = fs::read_to_string(sheet)?;
        let loads = text.split("url(").skip(1).map(|rest| rest.trim_start_matches(['"', '\'']));
        let elsewhere = loads.filter(|url| is_elsewhere(url)).count() + text.matches("@import").count();
        if elsewhere > 0 {
            broken.push(format!("{}: loads from elsewhere", sheet.display()));
        }
    }
    ensure!(broken.is_empty(), "broken links of the book:\n{}", broken.join("\n"));
    Ok(())
}

/// Checks that a link leads to a file and an anchor of the book. Returns the reason if it does not.
fn leads(
    out: &Path,
    page: &Path,
    target: &str,
    places: &BTreeMap<&PathBuf, BTreeSet<&str>>,
) -> std::result::Result<(), &'static str> {
    let (path, place) = target.split_once('#').unwrap_or((target, ""));
    let file = match path {
        "" => page.to_owned(),
        path => page.parent().unwrap_or(out).join(path),
    };
    let file = file.canonicalize().map_err(|_| "no such file")?;
    if !file.starts_with(out) {
        return Err("outside of the book");
    }
    match (place, places.get(&file)) {
        ("", _) => Ok(()),
        (place, Some(known)) if known.contains(place) => Ok(()),
        _ => Err("no such place in it"),
    }
}

/// The values of an HTML attribute in a page.
fn values<'a>(text: &'a str, attribute: &str) -> impl Iterator<Item = &'a str> {
    let opening = format!(" {attribute}=\"");
    let behind: Vec<&str> = text.split(&opening).skip(1).collect();
    behind.into_iter().filter_map(|rest| rest.split('"').next())
}

/// True if a URL leads to another site.
fn is_elsewhere(url: &str) -> bool {
    !url.starts_with("data:") && (url.contains("://") || url.starts_with("//") || url.starts_with("mailto:"))
}
