//! The Debian package: the program with its manual page, completions, udev rules and a systemd unit.
//!
//! dpkg-deb, which is part of every Debian, makes the package from the files in `packaging/`. cargo-deb would have to
//! be compiled first. Its advantage is finding the libraries that a program needs, and `zerorate` needs none.

use super::machine::{MACHINES, Machine};
use super::root::{BARE, Root};
use super::{Folder, VERSION, fill, papers, program, put, repository};
use crate::tools::{Tool, available};
use crate::venv::{done, printed};
use anyhow::{Context, Result};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

const TOOLS: [Tool; 2] = [Tool { program: "dpkg-deb", package: "dpkg" }, Tool { program: "gzip", package: "gzip" }];

/// Arguments with which the program prints a text for the package, and the path of that text in the package.
const PRINTED: [(&[&str], &str); 4] = [
    (&["man"], "usr/share/man/man1/zerorate.1"),
    (&["completions", "bash"], "usr/share/bash-completion/completions/zerorate"),
    (&["completions", "zsh"], "usr/share/zsh/vendor-completions/_zerorate"),
    (&["completions", "fish"], "usr/share/fish/vendor_completions.d/zerorate.fish"),
];

const PACKAGED: [(&str, &str); 5] = [
    ("udev/60-zerorate.rules", "usr/lib/udev/rules.d/60-zerorate.rules"),
    ("systemd/zerorate@.service", "usr/lib/systemd/system/zerorate@.service"),
    ("systemd/rest.conf", "usr/share/doc/zerorate/examples/rest.conf"),
    ("debian/postinst", "DEBIAN/postinst"),
    ("debian/postrm", "DEBIAN/postrm"),
];

/// The files that Debian's policy wants compressed.
const COMPRESSED: [&str; 5] = [
    "usr/share/man/man1/zerorate.1",
    "usr/share/doc/zerorate/changelog",
    "usr/share/doc/zerorate/zerorate-THIRD-PARTY.txt",
    "usr/share/doc/zerorate/zerorate.cdx.json",
    "usr/share/doc/zerorate/rust-std-COPYRIGHT.html",
];

fn name(machine: &Machine) -> String {
    format!("zerorate_{VERSION}_{}.deb", machine.debian)
}

pub fn make(folder: &Folder) -> Result<()> {
    if !available(&TOOLS, "the Debian packages")? {
        return Ok(());
    }
    for machine in &MACHINES {
        let tree = folder.empty("deb")?;
        lay_out(folder, machine, &tree)?;
        let mut pack = Command::new("dpkg-deb");
        pack.args(["--root-owner-group", "-Zxz", "--build"]).arg(&tree).arg(folder.of(name(machine)));
        done(pack.env("SOURCE_DATE_EPOCH", &folder.epoch))?;
    }
    Ok(())
}

/// Makes the tree of files as it will be on the user's disk.
fn lay_out(folder: &Folder, machine: &Machine, tree: &Path) -> Result<()> {
    let binary = folder.of(program::name(machine));
    let bytes = fs::read(&binary).with_context(|| format!("{}: make it first", binary.display()))?;
    put(&tree.join("usr/bin/zerorate"), &bytes)?;
    let here = folder.of(program::name(&MACHINES[0]));
    for (arguments, to) in PRINTED {
        put(&tree.join(to), printed(Command::new(&here).args(arguments))?.as_bytes())?;
    }
    for (from, to) in PACKAGED {
        fill(from, &tree.join(to), &[])?;
    }
    documents(folder, &tree.join("usr/share/doc/zerorate"))?;
    for file in COMPRESSED {
        done(Command::new("gzip").args(["--best", "--no-name"]).arg(tree.join(file)))?;
    }
    for program in ["usr/bin/zerorate", "DEBIAN/postinst", "DEBIAN/postrm"] {
        fs::set_permissions(tree.join(program), fs::Permissions::from_mode(0o755))?;
    }
    let kibibytes = printed(Command::new("du").args(["--summarize", "--block-size=KiB"]).arg(tree))?;
    let kibibytes = kibibytes.split("KiB").next().context("du prints a size")?;
    let homepage = repository("Homepage");
    let values =
        [("VERSION", VERSION), ("ARCHITECTURE", machine.debian), ("KIBIBYTES", kibibytes), ("HOMEPAGE", &homepage)];
    fill("debian/control", &tree.join("DEBIAN/control"), &values)
}

/// Writes the texts that the licences require, and the changelog.
fn documents(folder: &Folder, to: &Path) -> Result<()> {
    let mit: String = fs::read_to_string("LICENSE-MIT")?
        .lines()
        .map(|line| if line.is_empty() { " .\n".to_owned() } else { format!(" {line}\n") })
        .collect();
    fill("debian/copyright", &to.join("copyright"), &[("MIT", mit.trim_end()), ("SOURCE", &repository("Source"))])?;
    put(&to.join("changelog"), &fs::read("CHANGELOG.md")?)?;
    for paper in [papers::licences("zerorate"), papers::materials("zerorate"), papers::RUST_LIBRARY.to_owned()] {
        let bytes = fs::read(folder.of(&paper)).with_context(|| format!("{paper}: make the part papers first"))?;
        put(&to.join(paper), &bytes)?;
    }
    Ok(())
}

/// Installs each package in a bare Debian, uses it as an ordinary user, and removes it. Programs for other machines
/// run under emulators. This machine's program is also run with the rights of the systemd unit.
pub fn check(folder: &Folder) -> Result<()> {
    let Some(root) = Root::with(folder, BARE)? else { return Ok(()) };
    for machine in &MACHINES {
        root.copy(&folder.of(name(machine)), &name(machine))?;
        if machine.emulator.is_some() {
            root.script(&format!("dpkg --add-architecture {}", machine.debian))?;
        }
        root.script(&format!("dpkg --install /{}", name(machine)))?;
        root.script(INSTALLED)?;
        match machine.emulator {
            None => {
                root.script(&USED.replace("ZERORATE", "/usr/bin/zerorate"))?;
                root.script(AS_THE_UNIT)?;
            }
            Some(emulator) if machine.runs_here()? => {
                root.copy(&Path::new("/usr/bin").join(emulator), "usr/bin/emulator")?;
                root.script(&USED.replace("ZERORATE", "/usr/bin/emulator /usr/bin/zerorate"))?;
            }
            Some(_) => {}
        }
        root.script("dpkg --purge zerorate && test ! -e /usr/bin/zerorate")?;
        println!("{}: installed, used and removed in a bare Debian 12", name(machine));
    }
    unit(folder)
}

/// Checks that systemd accepts the unit, with the example configuration.
fn unit(folder: &Folder) -> Result<()> {
    let Some(root) = Root::with(folder, "adduser,systemd,udev")? else { return Ok(()) };
    let package = name(&MACHINES[0]);
    root.copy(&folder.of(&package), &package)?;
    root.script(&format!("dpkg --install /{package}"))?;
    root.script(
        "mkdir /etc/zerorate && cp /usr/share/doc/zerorate/examples/rest.conf /etc/zerorate &&
         systemd-analyze verify --man=no zerorate@rest.service",
    )?;
    println!("{package}: systemd takes its unit");
    Ok(())
}

/// A script that checks that the listed files were installed and are not empty, and that the user exists.
const INSTALLED: &str = "
    for file in usr/bin/zerorate usr/share/man/man1/zerorate.1.gz \
        usr/lib/systemd/system/zerorate@.service usr/lib/udev/rules.d/60-zerorate.rules \
        usr/share/bash-completion/completions/zerorate usr/share/zsh/vendor-completions/_zerorate \
        usr/share/fish/vendor_completions.d/zerorate.fish usr/share/doc/zerorate/copyright; do
        test -s /$file || { echo \"$file is missing\"; exit 1; }
    done
    id zerorate > /dev/null
    bash -n /usr/share/bash-completion/completions/zerorate";

/// A script that uses the program as an ordinary user.
const USED: &str = "
    mkdir -p /home/user && chown nobody /home/user && cd /home/user
    setpriv --reuid nobody --clear-groups ZERORATE probe > probe.txt 2>&1 < /dev/null || { cat probe.txt; exit 1; }
    setpriv --reuid nobody --clear-groups ZERORATE calibrate --average 5s --warmup 30s --settle 10s --offset 15s \
        --max-u-btc 0.05 --force -o unit.toml 2> /dev/null
    rm unit.toml";

/// A script that checks that the rights of the unit suffice to lock memory and raise the priority.
const AS_THE_UNIT: &str = "
    caps=$(sed -n 's/^AmbientCapabilities=//p' /usr/lib/systemd/system/zerorate@.service |
        tr A-Z a-z | sed 's/cap_/+/g; s/ /,/g')
    setpriv --reuid zerorate --clear-groups --bounding-set -all,$caps --inh-caps $caps --ambient-caps $caps \
        --no-new-privs chrt --fifo 40 /usr/bin/zerorate --version";
