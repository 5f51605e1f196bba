//! Lists the software in a distributed product: crates, software inside crates, and software from the toolchain.

use super::machine::MACHINES;
use crate::venv::printed;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

pub struct Product {
    /// The name of the product in file names.
    pub name: &'static str,
    manifest: &'static str,
    package: &'static str,
    /// The targets, each with the features of its build.
    builds: &'static [(&'static str, &'static str)],
}

pub const PRODUCTS: [Product; 5] = [
    Product {
        name: "zerorate",
        manifest: "Cargo.toml",
        package: "zerorate-cli",
        builds: &[(MACHINES[0].target, "full"), (MACHINES[1].target, "full"), (MACHINES[2].target, "full")],
    },
    Product {
        name: "zerorate-python",
        manifest: "Cargo.toml",
        package: "zerorate-python",
        builds: &[("x86_64-unknown-linux-gnu", ""), ("aarch64-unknown-linux-gnu", "")],
    },
    Product {
        name: "zerorate-c",
        manifest: "bindings/c/Cargo.toml",
        package: "zerorate-c",
        builds: &[("thumbv7em-none-eabihf", "")],
    },
    Product {
        name: "zerorate-bridge",
        manifest: "firmware/Cargo.toml",
        package: "firmware-bridge",
        builds: &[("thumbv7em-none-eabihf", "stm32f4"), ("thumbv6m-none-eabi", "rp2040")],
    },
    Product {
        name: "zerorate-page",
        manifest: "Cargo.toml",
        package: "zerorate-web",
        builds: &[("wasm32-unknown-unknown", "wasm-log")],
    },
];

/// Software of other projects that is linked in.
#[derive(Clone, Default)]
pub struct Component {
    pub name: String,
    pub version: String,
    /// An SPDX expression.
    pub licence: String,
    pub repository: Option<String>,
    /// Checksum of the crate in the registry.
    pub sha256: Option<String>,
    /// A package URL, <https://github.com/package-url/purl-spec>.
    pub purl: String,
    /// Name and version of each dependency among the linked crates.
    pub needs: Vec<String>,
    /// The licence texts in the component; empty if it has none.
    pub texts: Vec<String>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
    license: Option<String>,
    license_file: Option<PathBuf>,
    repository: Option<String>,
    source: Option<String>,
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    name: String,
    kind: Option<String>,
}

impl Product {
    /// All software of others that is linked into the product on any of its targets, sorted by name.
    pub fn contents(&self) -> Result<Vec<Component>> {
        let linked = self.linked()?;
        let arguments = ["metadata", "--format-version=1", "--locked", "--all-features", "--manifest-path"];
        let metadata = printed(Command::new("cargo").args(arguments).arg(self.manifest))?;
        let mut packages = serde_json::from_str::<Metadata>(&metadata)?.packages;
        packages.retain(|package| package.source.is_some() && linked.contains(&package.id()));
        let sums = checksums(&Path::new(self.manifest).with_file_name("Cargo.lock"))?;
        let mut found: Vec<Component> =
            packages.iter().map(|package| package.component(&packages, &sums)).collect::<Result<_>>()?;
        for package in &packages {
            found.extend(beside(package)?);
        }
        found.push(rust_library()?);
        if self.name == PRODUCTS[0].name {
            found.push(glibc()?);
        }
        found.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
        Ok(found)
    }

    /// Name and version of each linked crate. Macros and build dependencies are not included.
    fn linked(&self) -> Result<BTreeSet<String>> {
        let mut linked = BTreeSet::new();
        for (target, features) in self.builds {
            let mut tree = Command::new("cargo");
            tree.args("tree --quiet --locked --edges=normal,no-proc-macro --prefix=none --format={p}".split(' '));
            tree.args(["--manifest-path", self.manifest, "--package", self.package, "--target", target]);
            if !features.is_empty() {
                tree.args(["--features", features]);
            }
            for line in printed(&mut tree)?.lines() {
                let (name, rest) = line.split_once(" v").with_context(|| format!("cargo tree printed `{line}`"))?;
                linked.insert(format!("{name} {}", rest.split(' ').next().unwrap_or(rest)));
            }
        }
        Ok(linked)
    }
}

impl Package {
    fn id(&self) -> String {
        format!("{} {}", self.name, self.version)
    }

    fn component(&self, linked: &[Self], sums: &BTreeMap<String, String>) -> Result<Component> {
        let ordinary = self.dependencies.iter().filter(|dependency| dependency.kind.is_none());
        let needs: BTreeSet<&str> = ordinary.map(|dependency| &*dependency.name).collect();
        let licence = self.license.clone().with_context(|| format!("{} states no licence", self.id()))?;
        Ok(Component {
            name: self.name.clone(),
            version: self.version.clone(),
            licence: licence.replace('/', " OR "),
            repository: self.repository.clone(),
            sha256: sums.get(&self.id()).cloned(),
            purl: format!("pkg:cargo/{}@{}", self.name, self.version),
            needs: linked.iter().filter(|other| needs.contains(&*other.name)).map(Self::id).collect(),
            texts: self.texts()?,
        })
    }

    /// The licence texts in the crate: `LICENSE-MIT`, `COPYING`, `NOTICE` and the like.
    fn texts(&self) -> Result<Vec<String>> {
        let folder = self.folder();
        let mut files: Vec<PathBuf> = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
        files.retain(|file| file.is_file() && is_licence(file));
        files.extend(self.license_file.iter().map(|file| folder.join(file)).filter(|file| !is_licence(file)));
        files.sort();
        files.iter().map(|file| text(file)).collect()
    }

    fn folder(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(Path::new("."))
    }
}

fn is_licence(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"].iter().any(|start| name.starts_with(start))
}

fn text(file: &Path) -> Result<String> {
    let bytes = fs::read(file).with_context(|| file.display().to_string())?;
    Ok(String::from_utf8_lossy(&bytes).trim().replace("\r\n", "\n"))
}

/// The checksums in a lock file, by name and version.
fn checksums(lock: &Path) -> Result<BTreeMap<String, String>> {
    let text = fs::read_to_string(lock).with_context(|| lock.display().to_string())?;
    let value = |block: &str, key: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(&format!("{key} = \"")));
        line.map(|line| line.trim_end_matches('"').to_owned())
    };
    let blocks = text.split("[[package]]").skip(1);
    Ok(blocks
        .filter_map(|block| {
            Some((format!("{} {}", value(block, "name")?, value(block, "version")?), value(block, "checksum")?))
        })
        .collect())
}

/// Software that is not a crate.
fn other(name: &str, version: &str, licence: &str, texts: Vec<String>) -> Component {
    Component {
        name: name.to_owned(),
        version: version.to_owned(),
        licence: licence.to_owned(),
        purl: format!("pkg:generic/{name}@{version}"),
        texts,
        ..Component::default()
    }
}

/// Software inside a crate that is not a crate itself; `None` if the crate has none.
fn beside(package: &Package) -> Result<Option<Component>> {
    Ok(match &*package.name {
        "zstd-sys" => {
            let version = package.version.split("+zstd.").nth(1).context("zstd-sys names its zstd")?;
            Some(other("zstd", version, "BSD-3-Clause", vec![text(&package.folder().join("zstd/LICENSE"))?]))
        }
        "libsqlite3-sys" => {
            let header = fs::read_to_string(package.folder().join("sqlite3/sqlite3.h"))?;
            let version = header.split("#define SQLITE_VERSION").nth(1).and_then(|rest| rest.split('"').nth(1));
            Some(other("sqlite", version.context("SQLite names its version")?, "blessing", Vec::new()))
        }
        // resvg draws the texts in plots, with the font that is embedded in the program
        "resvg" => {
            let licence = fs::canonicalize("bindings/python/LICENSE-OFL-Inter.txt")?;
            Some(other("Inter", "4", "OFL-1.1", vec![text(&licence)?]))
        }
        _ => None,
    })
}

/// Rust's standard library. Its licence texts are on a separate page.
fn rust_library() -> Result<Component> {
    let version = printed(Command::new("rustc").arg("--version"))?;
    let version = version.split_whitespace().nth(1).context("rustc names its version")?;
    let repository = Some("https://github.com/rust-lang/rust".to_owned());
    Ok(Component { repository, ..other("rust-std", version, "MIT OR Apache-2.0", Vec::new()) })
}

/// Debian's C library, which is linked into the program. Its licence requires that users can replace it. They can,
/// since `cargo xtask dist program` builds the program from the sources.
fn glibc() -> Result<Component> {
    let version = printed(Command::new("dpkg-query").args(["--show", "--showformat=${source:Version}", "libc6-dev"]))?;
    let texts = vec![text(Path::new("/usr/share/common-licenses/LGPL-2.1"))?];
    Ok(Component {
        repository: Some("https://sources.debian.org/src/glibc/".to_owned()),
        purl: format!("pkg:deb/debian/glibc@{version}"),
        ..other("glibc", &version, "LGPL-2.1-or-later", texts)
    })
}
