//! The program `zerorate` as a single file without shared libraries, for each machine.
//!
//! The file contains Debian's glibc. With musl the program was 10 to 40 % slower (docs/reference/build.md).

use super::machine::{MACHINES, Machine};
use super::root::{BARE, Root};
use super::trial::{self, Observations};
use super::{Folder, TARGET_DIR, VERSION, without_paths};
use crate::tools::available;
use crate::venv::{done, printed};
use crate::{targets, web};
use anyhow::{Result, ensure};
use object::Object;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const LAST_BITS: f64 = 1e-11;

pub fn name(machine: &Machine) -> String {
    format!("zerorate-{VERSION}-{}-linux", machine.name)
}

pub fn make(folder: &Folder) -> Result<()> {
    targets::add_missing(MACHINES.iter().map(|machine| machine.target))?;
    if !available(&MACHINES.map(|machine| machine.compiler), "programs for other machines")? {
        return Ok(());
    }
    web::build_small()?;
    for machine in &MACHINES {
        let built = build(machine)?;
        fs::copy(&built, folder.of(name(machine)))?;
        println!("{}: {:.1} MB", name(machine), built.metadata()?.len() as f64 / 1e6);
    }
    Ok(())
}

fn build(machine: &Machine) -> Result<PathBuf> {
    let linker = format!("CARGO_TARGET_{}_LINKER", machine.target.to_uppercase().replace('-', "_"));
    let mut cargo = Command::new("cargo");
    if machine.emulator.is_some() {
        cargo.env(linker, machine.compiler.program);
    }
    let linker = if machine.rust_linker { rust_linker()? } else { String::new() };
    cargo.env("RUSTFLAGS", format!("-C target-feature=+crt-static {} {linker}", without_paths()?));
    cargo.args(["build", "--locked", "--profile", "dist", "--package", "zerorate-cli", "--features", "full"]);
    cargo.args(["--target", machine.target]);
    done(cargo.args(["--target-dir", TARGET_DIR]))?;
    Ok(Path::new(TARGET_DIR).join(machine.target).join("dist/zerorate"))
}

/// The compiler flags for the linker in Rust's toolchain.
fn rust_linker() -> Result<String> {
    let libraries = printed(Command::new("rustc").args(["--print", "target-libdir"]))?;
    let folder = Path::new(libraries.trim()).with_file_name("bin").join("gcc-ld");
    ensure!(folder.exists(), "no linker in {}: install Rust by rustup", folder.display());
    Ok(format!("-C link-arg=-fuse-ld=lld -C link-arg=-B{}", folder.display()))
}

/// Runs each program: this computer's in a bare Debian, the others under emulators. All must print and write the
/// same, but for the last bits of numbers in JSON.
pub fn check(folder: &Folder) -> Result<()> {
    let inputs = folder.empty("trial")?;
    trial::lay_out(&inputs)?;
    let mut first: Option<Observations> = None;
    for machine in &MACHINES {
        ensure!(is_static(&folder.of(name(machine)))?, "{} needs shared libraries", name(machine));
        let Some(seen) = try_out(folder, machine, &inputs)? else { continue };
        println!("{}: {} outputs are as they should be", name(machine), seen.len());
        let first = first.get_or_insert_with(|| seen.clone());
        for ((what, theirs), (_, ours)) in first.iter().zip(&seen) {
            ensure!(is_same(ours, theirs), "{}: `zerorate {what}` is not what other machines have", machine.name);
        }
    }
    Ok(())
}

/// True if two outputs have the same bytes, or are JSON with the same values. Numbers may differ by [`LAST_BITS`]. On
/// armv7 some did by 1e-12. Its C library, which has no fused multiplication, is the presumed cause.
fn is_same(ours: &[u8], theirs: &[u8]) -> bool {
    let json = |bytes| serde_json::from_slice::<Value>(bytes);
    ours == theirs || matches!((json(ours), json(theirs)), (Ok(ours), Ok(theirs)) if are_near(&ours, &theirs))
}

fn are_near(ours: &Value, theirs: &Value) -> bool {
    match (ours, theirs) {
        (Value::Number(ours), Value::Number(theirs)) => {
            let (Some(ours), Some(theirs)) = (ours.as_f64(), theirs.as_f64()) else { return false };
            (ours - theirs).abs() <= LAST_BITS * ours.abs()
        }
        (Value::Array(ours), Value::Array(theirs)) => {
            ours.len() == theirs.len() && ours.iter().zip(theirs).all(|(ours, theirs)| are_near(ours, theirs))
        }
        (Value::Object(ours), Value::Object(theirs)) => {
            let has = |(key, ours): (&String, &Value)| theirs.get(key).is_some_and(|theirs| are_near(ours, theirs));
            ours.len() == theirs.len() && ours.iter().all(has)
        }
        _ => ours == theirs,
    }
}

/// Runs the trial with a machine's program. Returns its output and files, or `None` if the program cannot run here.
fn try_out(folder: &Folder, machine: &Machine, inputs: &Path) -> Result<Option<Observations>> {
    let program = folder.of(name(machine));
    let Some(emulator) = machine.emulator else {
        let Some(root) = Root::with(folder, BARE)? else { return Ok(None) };
        root.copy(&program, "usr/bin/zerorate")?;
        let here = root.path("trial");
        copy_all(inputs, &here)?;
        return trial::run(|| root.command_in("trial", "/usr/bin/zerorate"), &here).map(Some);
    };
    if !machine.runs_here()? {
        return Ok(None);
    }
    let here = folder.empty(&format!("trial-{}", machine.name))?;
    copy_all(inputs, &here)?;
    let command = || {
        // to limit its memory, zerorate starts itself again; under an emulator it cannot, and runs without the limit
        let mut command = Command::new(emulator);
        command.arg(&program).current_dir(&here);
        command
    };
    trial::run(command, &here).map(Some)
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        fs::copy(entry.path(), to.join(entry.file_name()))?;
    }
    Ok(())
}

/// True if an ELF file needs no loader for shared libraries.
fn is_static(program: &Path) -> Result<bool> {
    Ok(object::File::parse(&*fs::read(program)?)?.section_by_name(".interp").is_none())
}
