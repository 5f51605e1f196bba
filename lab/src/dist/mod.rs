//! `cargo xtask dist`: builds all distributed files on Debian 12 on x86-64, in `target/dist/`. With `--check`, it
//! tests these files instead, programs on their target systems.

mod c_library;
mod deb;
mod firmware;
mod machine;
mod papers;
mod pictures;
mod product;
mod program;
mod root;
mod sbom;
mod trial;
mod uf2;
mod wheel;

use crate::app::{emptied, target_folder};
use crate::venv::{self, done, printed};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(clap::Args)]
pub struct DistArgs {
    /// Make only these parts; default: all
    #[arg(value_name = "PART", value_parser = clap::builder::PossibleValuesParser::new(PARTS.map(|part| part.name)))]
    only: Vec<String>,
    /// Try the files in target/dist in a bare Debian, under emulators and in an empty environment; make nothing
    #[arg(long)]
    check: bool,
}

struct Part {
    name: &'static str,
    make: fn(&Folder) -> Result<()>,
    check: fn(&Folder) -> Result<()>,
}

/// All parts in build order: `deb` and `pictures` need `program`, and `deb` and `c` need `papers`.
const PARTS: [Part; 7] = [
    Part { name: "program", make: program::make, check: program::check },
    Part { name: "papers", make: papers::make, check: papers::check },
    Part { name: "deb", make: deb::make, check: deb::check },
    Part { name: "wheel", make: wheel::make, check: wheel::check },
    Part { name: "c", make: c_library::make, check: c_library::check },
    Part { name: "firmware", make: firmware::make, check: firmware::check },
    Part { name: "pictures", make: pictures::make, check: pictures::check },
];

/// The version of all distributed files: the workspace's version.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The address of the repository; empty until a release states it in `Cargo.toml`.
const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");
/// Cargo's target folder for all parts but the wheels. The developer's folder is not used, because the flags differ.
const TARGET_DIR: &str = "target/cross";
const SUMS: &str = "SHA256SUMS";

pub fn run(args: &DistArgs) -> Result<()> {
    let folder = Folder::new()?;
    for part in &PARTS {
        if args.only.is_empty() || args.only.iter().any(|name| name == part.name) {
            println!("--- {}", part.name);
            let act = if args.check { part.check } else { part.make };
            act(&folder).with_context(|| format!("the part {}", part.name))?;
        }
    }
    if args.check { folder.check_sums() } else { folder.write_sums() }
}

/// Writes the authors and licences of the software in the modules of the page, including software that is not a crate.
pub fn write_licences_of_page(out: &Path) -> Result<()> {
    let page =
        product::PRODUCTS.iter().find(|product| product.name == "zerorate-page").context("no page is handed out")?;
    fs::write(out, papers::page(page, &page.contents()?)?).with_context(|| out.display().to_string())
}

/// The folder of the results, and the folder for intermediate files.
struct Folder {
    dist: PathBuf,
    work: PathBuf,
    /// Time of the commit, Unix time in s. It is the time of all files, so that the same sources give the same bytes.
    epoch: String,
}

impl Folder {
    fn new() -> Result<Self> {
        let target = target_folder()?;
        let (dist, work) = (target.join("dist"), target.join("dist-work"));
        fs::create_dir_all(&dist)?;
        fs::create_dir_all(&work)?;
        let epoch = printed(Command::new("git").args(["log", "-1", "--format=%ct"]))?;
        Ok(Self { dist, work, epoch: epoch.trim().to_owned() })
    }

    fn of(&self, name: impl AsRef<Path>) -> PathBuf {
        self.dist.join(name)
    }

    fn empty(&self, name: &str) -> Result<PathBuf> {
        emptied(self.work.join(name))
    }

    /// Packs the folder `name` below `parent` into `name.tar.gz`.
    fn pack(&self, parent: &Path, name: &str) -> Result<()> {
        let mut tar = Command::new("tar");
        tar.args(["--create", "--gzip", "--sort=name", "--owner=0", "--group=0", "--numeric-owner"]);
        tar.arg(format!("--mtime=@{}", self.epoch)).arg("--file").arg(self.of(format!("{name}.tar.gz")));
        done(tar.arg("--directory").arg(parent).arg(name))
    }

    fn write_sums(&self) -> Result<()> {
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.dist)? {
            let entry = entry?;
            if entry.file_type()?.is_file() && entry.file_name() != SUMS {
                names.push(entry.file_name());
            }
        }
        names.sort();
        let sums = printed(Command::new("sha256sum").current_dir(&self.dist).arg("--").args(&names))?;
        fs::write(self.of(SUMS), sums)?;
        println!("{}: {} files", self.of(SUMS).display(), names.len());
        Ok(())
    }

    fn check_sums(&self) -> Result<()> {
        done(Command::new("sha256sum").current_dir(&self.dist).args(["--check", "--strict", "--quiet", SUMS]))
    }
}

fn python() -> Result<PathBuf> {
    venv::python("dist", "packaging/requirements.txt")
}

/// Builds a package of a workspace of its own for a target. Returns the folder of the results.
fn build(manifest: &str, target: &str, options: [&str; 2]) -> Result<PathBuf> {
    let mut cargo = Command::new("cargo");
    cargo.args(["build", "--quiet", "--locked", "--release", "--manifest-path", manifest]).args(options);
    cargo.args(["--target", target, "--target-dir", TARGET_DIR]);
    done(cargo.env("RUSTFLAGS", without_paths()?))?;
    Ok(Path::new(TARGET_DIR).join(target).join("release"))
}

/// Compiler flags that remove this computer's paths from the output.
fn without_paths() -> Result<String> {
    let home = std::env::var("CARGO_HOME").or_else(|_| std::env::var("HOME").map(|home| format!("{home}/.cargo")))?;
    let here = std::env::current_dir()?;
    Ok(format!("--remap-path-prefix={home}=/cargo --remap-path-prefix={}=/zerorate", here.display()))
}

/// A line `NAME: address` with the repository; empty without an address.
fn repository(name: &str) -> String {
    if REPOSITORY.is_empty() { String::new() } else { format!("{name}: {REPOSITORY}\n") }
}

/// Copies a file of `packaging/` to `to`, with a value in place of each `@NAME@`.
fn fill(template: &str, to: &Path, values: &[(&str, &str)]) -> Result<()> {
    let from = Path::new("packaging").join(template);
    let text = fs::read_to_string(&from).with_context(|| from.display().to_string())?;
    let text = values.iter().fold(text, |text, (name, value)| text.replace(&format!("@{name}@"), value));
    put(to, text.as_bytes())
}

fn put(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::create_dir_all(path.parent().context("a file lies in a folder")?)?;
    fs::write(path, bytes).with_context(|| path.display().to_string())
}
