//! The documents that accompany every distributed copy: licences of all linked software, and a bill of materials.

use super::product::{Component, PRODUCTS, Product};
use super::{Folder, python, sbom};
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Rust's own page about the software in its standard library.
pub const RUST_LIBRARY: &str = "rust-std-COPYRIGHT.html";

pub fn licences(product: &str) -> String {
    format!("{product}-THIRD-PARTY.txt")
}

pub fn materials(product: &str) -> String {
    format!("{product}.cdx.json")
}

pub fn make(folder: &Folder) -> Result<()> {
    for product in &PRODUCTS {
        let contents = product.contents()?;
        fs::write(folder.of(licences(product.name)), page(product, &contents)?)?;
        fs::write(folder.of(materials(product.name)), sbom::text(product, &contents)?)?;
        println!("{}: {} components", product.name, contents.len());
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(licence, folder.of(licence))?;
    }
    let toolchain = printed(Command::new("rustc").args(["--print", "sysroot"]))?;
    let page = Path::new(toolchain.trim()).join("share/doc/rust/COPYRIGHT-library.html");
    fs::copy(&page, folder.of(RUST_LIBRARY)).with_context(|| page.display().to_string())?;
    Ok(())
}

/// A page with a table of the components, followed by each licence text with the components that it applies to.
pub fn page(product: &Product, contents: &[Component]) -> Result<String> {
    let mut page = format!(
        "# Software of others in {}\n\nMade by `cargo xtask dist papers`. {RUST_LIBRARY} has what Rust's own \
         libraries contain.\n\n| what | version | licence | source |\n|---|---|---|---|\n",
        product.name
    );
    let mut texts: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut without = Vec::new();
    for component in contents {
        let Component { name, version, licence, .. } = component;
        writeln!(page, "| {name} | {version} | {licence} | {} |", component.repository.as_deref().unwrap_or(""))?;
        for text in &component.texts {
            texts.entry(text).or_default().push(format!("{name} {version}"));
        }
        if component.texts.is_empty() {
            without.push(format!("{name} ({licence})"));
        }
    }
    ensure!(!texts.is_empty(), "no licence text was found in any component");
    for (text, carriers) in texts {
        write!(page, "\n## {}\n\n```text\n{}\n```\n", carriers.join(", "), text.replace("```", "'''"))?;
    }
    let without = without.join(", ");
    writeln!(
        page,
        "\n## Without a text of their own\n\nThe authors of these enclosed no text: {without}. The texts of MIT and \
         Apache-2.0 are as in LICENSE-MIT and LICENSE-APACHE beside this page; SQLite's authors ask for nothing but \
         a blessing."
    )?;
    Ok(page)
}

/// Validates each bill of materials against CycloneDX's schema, with CycloneDX's own library.
pub fn check(folder: &Folder) -> Result<()> {
    let python = python()?;
    for product in &PRODUCTS {
        let mut validate = Command::new(&python);
        done(validate.args(["-c", VALIDATE]).arg(folder.of(materials(product.name))))?;
        println!("{}: as CycloneDX has it", materials(product.name));
    }
    Ok(())
}

const VALIDATE: &str = "
import sys
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
error = JsonStrictValidator(SchemaVersion.V1_6).validate_str(open(sys.argv[1]).read())
sys.exit(f'{sys.argv[1]}: {error}' if error else 0)";
