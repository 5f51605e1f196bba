//! Makes pages satisfy a content security policy without inline code, and adds the policy to them.
//!
//! mdBook writes a few scripts into its pages. Each is moved to a file, which all pages with the same script share.
//! The page loads this file at the same position, so that it runs at the same time. Alignments of tables become
//! classes.

use crate::stage::below;
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::collections::hash_map::DefaultHasher;
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src 'self'; \
    connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'";
/// Inline styles of mdBook, and the classes of `docs/book.css` that replace them.
const STYLES: [(&str, &str); 4] = [
    (r#" style="clear: both""#, r#" class="clear""#),
    (r#" style="text-align: left""#, r#" class="align-left""#),
    (r#" style="text-align: center""#, r#" class="align-center""#),
    (r#" style="text-align: right""#, r#" class="align-right""#),
];

pub fn apply(out: &Path) -> Result<Vec<PathBuf>> {
    let pages: Vec<PathBuf> =
        below(out)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "html")).collect();
    let mut scripts = BTreeMap::new();
    for page in &pages {
        let depth = page.strip_prefix(out)?.components().count() - 1;
        let text = without_inline(&fs::read_to_string(page)?, &"../".repeat(depth), &mut scripts)?;
        ensure!(!text.contains(" style=\""), "{}: a style that stands in the page", page.display());
        let handler = [" onclick=", " onload=", " onchange=", " onerror=", "href=\"javascript:"];
        let found = handler.iter().find(|name| text.contains(**name));
        ensure!(found.is_none(), "{}: {found:?} is code in the page", page.display());
        fs::write(page, text)?;
    }
    for (name, script) in scripts {
        fs::write(out.join(name), script)?;
    }
    Ok(pages)
}

/// Returns the page without inline scripts and styles, and adds its scripts to `scripts`.
fn without_inline(page: &str, to_root: &str, scripts: &mut BTreeMap<String, String>) -> Result<String> {
    let mut made = String::with_capacity(page.len());
    let mut rest = page;
    while let Some((before, after)) = rest.split_once("<script>") {
        let (script, behind) = after.split_once("</script>").context("a script without an end")?;
        let name = format!("inline-{:016x}.js", hash(script));
        made += before;
        made += &format!("<script src=\"{to_root}{name}\"></script>");
        scripts.insert(name, script.to_owned());
        rest = behind;
    }
    made += rest;
    for (style, class) in STYLES {
        made = made.replace(style, class);
    }
    let meta = format!(
        "<meta charset=\"UTF-8\">\n        <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">"
    );
    ensure!(made.matches("<meta charset=\"UTF-8\">").count() == 1, "a page without its character set");
    Ok(made.replace("<meta charset=\"UTF-8\">", &meta))
}

/// A hash of the script. It is the same in every build by the same compiler.
fn hash(script: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    script.hash(&mut hasher);
    hasher.finish()
}
