//! `cargo xtask c`: checks what the C library links, and compares the results of C with those of Rust on the host and
//! on an emulated Cortex-M4F.

mod expected;

use crate::app;
use crate::firmware::{QEMU, emulate, image};
use crate::targets;
use crate::tools::{Tool, available};
use crate::venv::{done, printed};
use anyhow::{Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PROJECT: &str = "bindings/c";
const WORK: &str = "target/c";
const M0: &str = "thumbv6m-none-eabi";
const M4F: &str = "thumbv7em-none-eabihf";
const GCC: Tool = Tool { program: "gcc", package: "build-essential" };
const ARM_GCC: Tool = Tool { program: "arm-none-eabi-gcc", package: "gcc-arm-none-eabi" };
const NEWLIB: Tool = Tool { program: "arm-none-eabi-gcc", package: "libnewlib-arm-none-eabi" };
const WARNINGS: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion"];
const EXAMPLES: [&str; 2] = ["main_loop", "interrupt"];

#[derive(clap::Args)]
pub struct CArgs {
    /// The unit of the twin
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn run(args: &CArgs) -> Result<()> {
    targets::add_missing([M0, M4F].into_iter())?;
    for target in [None, Some(M0), Some(M4F)] {
        is_self_contained(&build("zerorate-c", target)?)?;
    }
    fs::create_dir_all(WORK)?;
    let expected = expected::text(args.seed)?;
    fs::write(Path::new(WORK).join("expected.txt"), &expected)?;
    export_header()?;
    if available(&[GCC], "C on the host")? {
        on_host(args.seed, &expected)?;
    }
    if available(&[ARM_GCC, NEWLIB, QEMU], "C on the emulated controller")? {
        on_controller(args.seed, &expected)?;
    }
    Ok(())
}

fn build(package: &str, target: Option<&str>) -> Result<PathBuf> {
    let target_dir = std::path::absolute(WORK)?;
    let mut cargo = Command::new("cargo");
    cargo.current_dir(PROJECT).args(["build", "--quiet", "--locked", "--release", "--package", package]);
    cargo.arg("--target-dir").arg(&target_dir).args(target.into_iter().flat_map(|target| ["--target", target]));
    done(&mut cargo)?;
    let folder = target.map_or(target_dir.clone(), |target| target_dir.join(target)).join("release");
    Ok(folder.join(format!("lib{}.a", package.replace('-', "_"))))
}

fn is_self_contained(library: &Path) -> Result<()> {
    let unwanted = image::unwanted_in_archive(library)?;
    ensure!(unwanted.is_empty(), "{} links {}", library.display(), unwanted.join(", "));
    println!("{}: nothing in it panics or allocates", library.display());
    Ok(())
}

fn export_header() -> Result<()> {
    let unit = Path::new(WORK).join("unit.toml");
    fs::write(&unit, expected::CALIBRATION)?;
    let mut zerorate = Command::new(app::program()?);
    zerorate.arg("export").arg(&unit);
    done(zerorate.args(["--format", "c", "--span-c", "2", "--force", "--output"]).arg(Path::new(WORK).join("unit.h")))
}

/// Runs the test and the examples on the host, with the sanitizers for addresses and undefined behaviour.
fn on_host(seed: u64, expected: &str) -> Result<()> {
    let libraries = [build("zerorate-c", None)?, build("zerorate-c-twin", None)?];
    let link = |sources: &[&str], program: &str| -> Result<PathBuf> {
        let program = Path::new(WORK).join(program);
        let mut gcc = compiler("gcc");
        gcc.args(["-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
        gcc.args(sources.iter().chain(&["tests/no_unwind.c"]).map(|source| Path::new(PROJECT).join(source)));
        gcc.args(&libraries);
        done(gcc.arg("-lm").arg("-o").arg(&program))?;
        Ok(program)
    };
    let program = link(&["tests/agree.c"], "agree")?;
    same(expected, &printed(Command::new(program).arg(seed.to_string()))?, "on the host")?;
    for example in EXAMPLES {
        let program = link(&[&format!("examples/{example}.c"), "tests/board_twin.c"], example)?;
        done(&mut Command::new(program))?;
    }
    let shown = printed(&mut Command::new(link(&["examples/on_twin.c"], "on_twin")?))?;
    let page = fs::read_to_string(Path::new(PROJECT).join("README.md"))?;
    ensure!(
        page.contains(&format!("```text\n{shown}```\n")),
        "{PROJECT}/README.md lacks what on_twin prints: {shown}"
    );
    println!("the examples run on the twin");
    Ok(())
}

/// Runs the test with newlib in the emulator, and links the examples for both cores.
fn on_controller(seed: u64, expected: &str) -> Result<()> {
    let m0 = ["-mcpu=cortex-m0", "-mthumb"];
    let m4f = ["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"];
    for (target, flags) in [(M0, &m0[..]), (M4F, &m4f[..])] {
        let library = build("zerorate-c", Some(target))?;
        for example in EXAMPLES {
            let sources = [format!("examples/{example}.c"), "tests/board_nothing.c".to_owned()];
            let mut gcc = compiler("arm-none-eabi-gcc");
            gcc.args(flags).args(["-Os", "--specs=nosys.specs", "-Wl,--gc-sections", "-Wl,--no-warnings"]);
            gcc.args(sources.map(|source| Path::new(PROJECT).join(source))).arg(&library);
            done(gcc.arg("-o").arg(Path::new(WORK).join(format!("{example}-{target}.elf"))))?;
        }
    }
    println!("the examples link for {M0} and {M4F}");
    let image = Path::new(WORK).join("agree.elf");
    let mut gcc = compiler("arm-none-eabi-gcc");
    gcc.args(m4f).args(["-Os", "-ffunction-sections", "-fdata-sections", "--specs=rdimon.specs"]);
    gcc.args(["tests/agree.c", "tests/startup.c"].map(|source| Path::new(PROJECT).join(source)));
    gcc.arg(build("zerorate-c", Some(M4F))?).arg(build("zerorate-c-twin", Some(M4F))?);
    gcc.arg("-T").arg(Path::new(PROJECT).join("tests/image.ld"));
    done(gcc.args(["-Wl,--gc-sections", "-Wl,--no-warnings", "-o"]).arg(&image))?;
    same(expected, &emulate(&image, &[seed.to_string()])?, "on the controller")
}

fn compiler(name: &str) -> Command {
    let mut gcc = Command::new(name);
    gcc.args(WARNINGS).arg("-I").arg(WORK);
    for folder in ["include", "examples", "tests"] {
        gcc.arg("-I").arg(Path::new(PROJECT).join(folder));
    }
    gcc
}

/// Compares the outputs line by line, so that the error shows the first difference.
fn same(expected: &str, got: &str, place: &str) -> Result<()> {
    for (index, (expected, got)) in expected.lines().zip(got.lines()).enumerate() {
        ensure!(expected == got, "line {} {place}: C says `{got}`, Rust `{expected}`", index + 1);
    }
    let (expected, got) = (expected.lines().count(), got.lines().count());
    ensure!(expected == got, "{got} lines {place}, {expected} from Rust");
    println!("{place}: C gives what Rust gives, in {got} lines");
    Ok(())
}
