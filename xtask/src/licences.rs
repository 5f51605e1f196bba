//! Whose software is linked into what is handed out, and under what licence.

use crate::product::{Component, PRODUCTS, Product};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Rust's page about what is in its own libraries.
pub const RUST_LIBRARY: &str = "rust-std-COPYRIGHT.html";

/// Whose software is in the modules of the page, and under what licence. What is not of a crate lies beside them.
pub fn of_page() -> Result<String> {
    let product = PRODUCTS.iter().find(|product| product.name == "zerorate-page").context("no page is handed out")?;
    page(product, &product.contents()?)
}

/// A table of the components, then each text once, with those that carry it.
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
        "\n## Without a text of their own\n\nWhoever wrote these enclosed no text: {without}. Those of MIT and \
         Apache-2.0 are as in LICENSE-MIT and LICENSE-APACHE beside this page; SQLite's authors ask for nothing but \
         a blessing."
    )?;
    Ok(page)
}
