//! What goes with every copy: the licences of all that is linked in with their texts, and a bill of materials.

use super::{Folder, python, sbom};
use crate::licences::{RUST_LIBRARY, page};
use crate::product::PRODUCTS;
use crate::venv::{done, printed};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;
use std::process::Command;

/// The page of a product.
pub fn licences(product: &str) -> String {
    format!("{product}-THIRD-PARTY.txt")
}

/// The bill of materials of a product.
pub fn materials(product: &str) -> String {
    format!("{product}.cdx.json")
}

/// Writes page and bill of each product, and the licences of the project itself.
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

/// Holds each bill to CycloneDX's own schema, by its own library.
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
