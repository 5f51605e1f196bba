//! `cargo xtask third-party`: the crates that are linked into the program, with their licences and the texts of these.

use crate::venv::printed;
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where to write.
#[derive(clap::Args)]
pub struct Args {
    /// The page
    #[arg(short, long, value_name = "FILE", default_value = "target/dist/THIRD-PARTY.md")]
    output: PathBuf,
}

/// Writes the page that goes with every copy of the program that is handed out.
pub fn run(args: &Args) -> Result<()> {
    let crates = Graph::read()?.linked_into("zerorate-cli")?;
    if let Some(folder) = args.output.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(&args.output, page(&crates)?)?;
    println!("{}: {} crates", args.output.display(), crates.len());
    Ok(())
}

/// What cargo knows of the workspace and all that it depends on.
#[derive(Deserialize)]
struct Graph {
    packages: Vec<Package>,
    resolve: Resolve,
}

#[derive(Clone, Deserialize)]
struct Package {
    id: String,
    name: String,
    version: String,
    license: Option<String>,
    license_file: Option<PathBuf>,
    repository: Option<String>,
    source: Option<String>,
    manifest_path: PathBuf,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<Kind>,
}

/// `None` is an ordinary dependency; `dev` and `build` ones are not linked.
#[derive(Deserialize)]
struct Kind {
    kind: Option<String>,
}

impl Graph {
    fn read() -> Result<Self> {
        let text = printed(Command::new("cargo").args(["metadata", "--format-version=1", "--locked"]))?;
        Ok(serde_json::from_str(&text)?)
    }

    /// The crates of others that `root` links, on any system, in the order of their names.
    fn linked_into(self, root: &str) -> Result<Vec<Package>> {
        let packages: BTreeMap<&str, &Package> = self.packages.iter().map(|package| (&*package.id, package)).collect();
        let nodes: BTreeMap<&str, &Node> = self.resolve.nodes.iter().map(|node| (&*node.id, node)).collect();
        let root = self.packages.iter().find(|package| package.name == root).context("no such crate")?;
        let (mut seen, mut open) = (BTreeSet::from([&*root.id]), vec![&*root.id]);
        while let Some(id) = open.pop() {
            let linked = nodes[id].deps.iter().filter(|dep| dep.dep_kinds.iter().any(|kind| kind.kind.is_none()));
            open.extend(linked.map(|dep| &*dep.pkg).filter(|id| seen.insert(id)));
        }
        let mut foreign: Vec<Package> =
            seen.iter().map(|id| packages[id].clone()).filter(|package| package.source.is_some()).collect();
        foreign.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
        Ok(foreign)
    }
}

impl Package {
    /// The texts that lie in the crate: `LICENSE-MIT`, `COPYING`, `NOTICE` and the like.
    fn texts(&self) -> Result<Vec<String>> {
        let folder = self.manifest_path.parent().context("a manifest lies in a folder")?;
        let mut files: Vec<PathBuf> = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
        files.retain(|file| file.is_file() && is_licence(file));
        files.extend(self.license_file.iter().map(|file| folder.join(file)).filter(|file| !is_licence(file)));
        files.sort();
        files.iter().map(|file| Ok(String::from_utf8_lossy(&fs::read(file)?).trim().replace("\r\n", "\n"))).collect()
    }
}

fn is_licence(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"].iter().any(|start| name.starts_with(start))
}

/// A table of the crates, then each text once, with the crates that carry it.
fn page(crates: &[Package]) -> Result<String> {
    let mut page = String::from(
        "# Software of others in zerorate\n\nThe program contains these crates. Made by `cargo xtask third-party`.\n\n\
         | crate | version | licence | source |\n|---|---|---|---|\n",
    );
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in crates {
        let licence = package.license.as_deref().or(package.license_file.as_ref().map(|_| "its own, below"));
        let licence = licence.with_context(|| format!("{} states no licence", package.name))?;
        let source = package.repository.as_deref().unwrap_or("");
        writeln!(page, "| {} | {} | {licence} | {source} |", package.name, package.version)?;
        for text in package.texts()? {
            texts.entry(text).or_default().push(format!("{} {}", package.name, package.version));
        }
    }
    ensure!(!texts.is_empty(), "no licence text was found in any crate");
    for (text, crates) in texts {
        write!(page, "\n## {}\n\n```text\n{}\n```\n", crates.join(", "), text.replace("```", "'''"))?;
    }
    Ok(page)
}
