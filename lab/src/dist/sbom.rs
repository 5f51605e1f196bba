//! Writes a bill of materials in CycloneDX 1.6 (<https://cyclonedx.org/docs/1.6/json/>).
//!
//! We do not use cargo-cyclonedx: it would have to be compiled first, it also lists packages that are only needed to
//! build a crate, and it does not know the C code and the font inside crates.

use super::VERSION;
use super::product::{Component, Product};
use anyhow::Result;
use serde_json::{Value, json};

/// The bill of materials of a product. It has no time and no random number: the same contents give the same text.
pub fn text(product: &Product, contents: &[Component]) -> Result<String> {
    let root = format!("{}@{VERSION}", product.name);
    let mut dependencies = vec![json!({
        "ref": root,
        "dependsOn": contents.iter().map(|component| &component.purl).collect::<Vec<_>>(),
    })];
    dependencies.extend(contents.iter().filter(|component| !component.needs.is_empty()).map(|component| {
        let needs =
            contents.iter().filter(|other| component.needs.contains(&format!("{} {}", other.name, other.version)));
        json!({ "ref": component.purl, "dependsOn": needs.map(|other| &other.purl).collect::<Vec<_>>() })
    }));
    let bill = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": root,
                "name": product.name,
                "version": VERSION,
                "licenses": [{ "expression": "MIT OR Apache-2.0" }],
            },
        },
        "components": contents.iter().map(entry).collect::<Vec<_>>(),
        "dependencies": dependencies,
    });
    Ok(serde_json::to_string_pretty(&bill)? + "\n")
}

fn entry(component: &Component) -> Value {
    let mut entry = json!({
        "type": "library",
        "bom-ref": component.purl,
        "name": component.name,
        "version": component.version,
        "purl": component.purl,
        "licenses": [{ "expression": component.licence }],
    });
    if let Some(sum) = &component.sha256 {
        entry["hashes"] = json!([{ "alg": "SHA-256", "content": sum }]);
    }
    if let Some(address) = &component.repository {
        entry["externalReferences"] = json!([{ "type": "vcs", "url": address }]);
    }
    entry
}
