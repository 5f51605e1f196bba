//! `cargo xtask web`: builds the page, from the core as WebAssembly to the files that a server sends.
//!
//! All WebAssembly modules are builds of one crate with different features. Their dependencies are compiled once.

use crate::arguments::Arguments;
use crate::images::{self, QEMU};
use crate::tools::{self, Tool};
use crate::venv::{done, printed};
use crate::{app, lab, targets};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The text of `--help`.
pub const HELP: &str = "\
\x20 --site DIR  Write the static site, with the book and the licences
  --check     Test the page of the program in Chromium
  --live      Test the static page and the site of --site in Chromium
  --pictures  Write docs/pictures/page
  --small     Make the page as small as the distributed one; this takes minutes longer

The page goes into crates/zerorate-cli/page/, from where the next `cargo build` takes it.

Needs rustup, clang, Node.js 18 and npm; tests and pictures also need Chromium and, for the bridge, QEMU. On Debian,
root installs what is missing; elsewhere the task says what it skips.";

const TARGET: &str = "wasm32-unknown-unknown";
/// The file with the licences of the third-party code in the page.
const LICENCES: &str = "THIRD-PARTY.txt";
/// Enables SIMD, which all browsers of the last years support in WebAssembly.
const RUSTFLAGS: &str = "-C target-feature=+simd128";
/// The folder from which the build of the program embeds the page.
const INTO: &str = "crates/zerorate-cli/page";
/// clang is needed because zstd is written in C, and only clang compiles C to WebAssembly.
const TOOLS: [Tool; 3] = [
    Tool { program: "node", package: "nodejs" },
    Tool { program: "npm", package: "npm" },
    Tool { program: "clang", package: "clang" },
];
const CHROMIUM: Tool = Tool { program: "chromium", package: "chromium" };
/// The oldest major version of Node.js that the bundler and its types support.
const OLDEST_NODE: u32 = 18;

/// A WebAssembly module: the feature that selects its part of the crate, and the start of its files' names.
struct Module {
    feature: &'static str,
    name: &'static str,
    /// Optimisation level: for size or for speed.
    opt_level: &'static str,
}

const MODULES: [Module; 4] = [
    Module { feature: "wasm-first", name: "zerorate_first", opt_level: "s" },
    Module { feature: "wasm-live", name: "zerorate_live", opt_level: "s" },
    Module { feature: "wasm-replay", name: "zerorate_replay", opt_level: "s" },
    // level 3, because LTO does not vectorise loops when it optimises for size
    Module { feature: "wasm-log", name: "zerorate_log", opt_level: "3" },
];

/// Builds the page, copies it to the program's folder, and runs the other requested parts.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let site = arguments.value("--site")?;
    let [check, live, pictures, small] =
        ["--check", "--live", "--pictures", "--small"].map(|name| arguments.flag(name));
    arguments.end()?;
    if !build(if small { "web-dist" } else { "web" })? {
        return Ok(());
    }
    if let Some(site) = site {
        write_site(Path::new(&site))?;
    }
    if check {
        browse("test", "the tests of the page")?;
    }
    if live {
        browse("test:live", "the tests of the static page")?;
    }
    if pictures {
        browse("pictures", "the pictures of the page")?;
    }
    Ok(())
}

/// Builds the page for distribution.
pub fn build_small() -> Result<()> {
    ensure!(build("web-dist")?, "the distributed program contains the page: install the tools named above");
    Ok(())
}

/// Makes `web/dist` with the modules in this profile, and copies it to the program's folder. If a tool or a package of
/// npm is missing, says so and returns false.
fn build(profile: &str) -> Result<bool> {
    if !tools::available(&TOOLS, "the page")? || !has_node()? {
        return Ok(false);
    }
    targets::add_missing(std::iter::once(TARGET))?;
    for module in &MODULES {
        module.build(profile)?;
    }
    if !installed()? {
        return Ok(false);
    }
    done(Command::new(app::built("codegen")?).arg("protocol"))?;
    done(&mut npm(&["run", "--silent", "check"]))?;
    done(&mut npm(&["run", "--silent", "build"]))?;
    embed()?;
    Ok(true)
}

fn has_node() -> Result<bool> {
    let version = printed(Command::new("node").arg("--version"))?;
    let major = version.trim().trim_start_matches('v').split('.').next().and_then(|major| major.parse().ok());
    let is_new = major.is_some_and(|major: u32| major >= OLDEST_NODE);
    if !is_new {
        eprintln!("SKIPPED: the page: node {} is older than {OLDEST_NODE} (https://nodejs.org)", version.trim());
    }
    Ok(is_new)
}

impl Module {
    fn build(&self, profile: &str) -> Result<()> {
        let mut cargo = Command::new("cargo");
        cargo.args(["rustc", "--locked", "-p", "zerorate-web", "--lib", "--crate-type", "cdylib"]);
        cargo.args(["--profile", profile, "--target", TARGET, "--features", "readers", "--features", self.feature]);
        cargo.args(["--", "-C", &format!("opt-level={}", self.opt_level)]);
        done(cargo.env("RUSTFLAGS", RUSTFLAGS))?;
        let bytes = app::target_folder()?.join(TARGET).join(profile).join("zerorate_web.wasm");
        lab::tool("web", [bytes.as_os_str(), self.name.as_ref(), "web/gen".as_ref()])
    }
}

/// Installs the packages of web/package-lock.json if web/node_modules is older. Returns false if npm cannot.
fn installed() -> Result<bool> {
    let (lock, mark) = (Path::new("web/package-lock.json"), Path::new("web/node_modules/.package-lock.json"));
    let is_newer =
        |a: &Path, b: &Path| Some(a.metadata().ok()?.modified().ok()? >= b.metadata().ok()?.modified().ok()?);
    if is_newer(mark, lock) == Some(true) {
        return Ok(true);
    }
    if npm(&["ci", "--silent", "--no-audit", "--no-fund"]).status().context("running npm")?.success() {
        return Ok(true);
    }
    eprintln!("SKIPPED: the page: npm cannot install the packages of web/package-lock.json; check the network");
    Ok(false)
}

fn npm(arguments: &[&str]) -> Command {
    let mut command = Command::new("npm");
    command.args(arguments).current_dir("web").stdin(Stdio::null());
    command
}

/// Copies the page to the program's folder, without the files that only a static site needs. An unchanged file keeps
/// its time, so that cargo does not build the program again.
fn embed() -> Result<()> {
    fs::create_dir_all(INTO)?;
    let (into, page) = (Path::new(INTO), files(Path::new("web/dist"))?);
    let page: Vec<&PathBuf> = page.iter().filter(|file| !is_static_only(name(file))).collect();
    for old in files(into)? {
        if !matches!(name(&old), "README.md" | ".gitignore") && page.iter().all(|file| name(file) != name(&old)) {
            fs::remove_file(old)?;
        }
    }
    for file in page {
        let to = into.join(name(file));
        if fs::read(&to).ok() != Some(fs::read(file)?) {
            fs::copy(file, to)?;
        }
    }
    println!("{INTO}: cargo build puts it into the program");
    Ok(())
}

/// True for files that only a static site needs: modules of a session in the page, and files for offline use.
fn is_static_only(name: &str) -> bool {
    let is_session = ["first", "live", "replay"].iter().any(|of| name == format!("zerorate_{of}_bg.wasm"));
    is_session || matches!(name, "home.json" | "sw.js" | "live.js")
}

fn write_site(site: &Path) -> Result<()> {
    fs::create_dir_all(site)?;
    for file in files(Path::new("web/dist"))? {
        fs::copy(&file, site.join(name(&file)))?;
    }
    done(lab::task("page-licences")?.arg(site.join(LICENCES)))?;
    done(lab::task("book")?.arg("--out").arg(site.join("book")))?;
    println!("{}: any web server will do; http://localhost or https", site.display());
    Ok(())
}

/// Runs a script of the page that needs a browser, with the program that contains the page, and with a bridge in QEMU
/// if that is available.
fn browse(script: &str, purpose: &str) -> Result<()> {
    if !tools::available(&[CHROMIUM], purpose)? {
        return Ok(());
    }
    let mut command = npm(&["run", "--silent", script]);
    command.env("ZERORATE_PROGRAM", std::path::absolute(app::program()?)?);
    if tools::available(&[QEMU], "the page at a bridge")? {
        command.env("ZERORATE_BRIDGE", images::build("release", "bridge")?);
    }
    done(&mut command)
}

fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("reading {}", folder.display()))?;
    let mut files: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    files.retain(|path| path.is_file());
    files.sort();
    Ok(files)
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}
