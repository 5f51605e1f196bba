//! Runs the C library with AddressSanitizer, and its callers with AddressSanitizer and UBSan. The callers are the
//! examples, and a fuzzer that calls every function with random arguments that the contract allows.

use super::{WORK, nightly};
use anyhow::{Result, ensure};
use std::env::consts::ARCH;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::tools::{Tool, available, of_clang_available};
use xtask::venv::done;

const PROJECT: &str = "bindings/c";
const PURPOSE: &str = "AddressSanitizer";
const CLANG: Tool = Tool { program: "clang", package: "clang" };
const CALLS: u64 = 100_000_000;
const CALLS_QUICK: u64 = 5_000_000;

pub fn run(check: bool, seed: u64) -> Result<()> {
    every_function_is_called("tests/fuzz.c")?;
    every_function_is_called("src/tests.rs")?;
    let runtime = format!("libclang_rt.asan-{ARCH}.a");
    if !nightly::available("rustc", PURPOSE)
        || !available(&[CLANG], PURPOSE)?
        || !of_clang_available(&runtime, "libclang-rt-dev", PURPOSE)?
    {
        return Ok(());
    }
    let libraries = libraries()?;
    for example in ["main_loop", "interrupt"] {
        let program = link(&libraries, example, &[&format!("examples/{example}.c"), "tests/board_twin.c"])?;
        done(&mut Command::new(program))?;
    }
    println!("the examples run on the twin");
    let calls = if check { CALLS_QUICK } else { CALLS };
    let program = link(&libraries, "fuzz", &["tests/fuzz.c"])?;
    done(Command::new(program).args([seed, calls].map(|number| number.to_string())))
}

/// Checks that the file calls each function of the header.
fn every_function_is_called(caller: &str) -> Result<()> {
    let header = fs::read_to_string(Path::new(PROJECT).join("include/zerorate.h"))?;
    let calls = fs::read_to_string(Path::new(PROJECT).join(caller))?;
    let functions = header.lines().filter(|line| !line.starts_with([' ', '#', '/'])).filter_map(|line| {
        let name = line.split('(').next()?.split_whitespace().last()?.trim_start_matches('*');
        (line.contains('(') && name.starts_with("zerorate_")).then_some(name)
    });
    let functions: Vec<&str> = functions.collect();
    let missing: Vec<_> = functions.iter().filter(|name| !calls.contains(&format!("{name}("))).collect();
    ensure!(missing.is_empty(), "{caller} never calls {missing:?}");
    ensure!(functions.len() > 30, "of the header {} functions were found", functions.len());
    Ok(())
}

/// Builds the library, and the twin for its tests, with AddressSanitizer.
fn libraries() -> Result<[PathBuf; 2]> {
    let mut cargo = nightly::cargo("build --quiet --release --workspace", "asan");
    cargo.args(["--target", nightly::HOST, "--manifest-path"]).arg(Path::new(PROJECT).join("Cargo.toml"));
    done(cargo.env("RUSTFLAGS", "-Zsanitizer=address"))?;
    let folder = Path::new(WORK).join("asan").join(nightly::HOST).join("release");
    Ok(["zerorate_c", "zerorate_c_twin"].map(|name| folder.join(format!("lib{name}.a"))))
}

fn link(libraries: &[PathBuf], name: &str, sources: &[&str]) -> Result<PathBuf> {
    let program = Path::new(WORK).join("asan").join(name);
    let mut clang = Command::new("clang");
    clang.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-g", "-O1"]);
    clang.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
    for folder in ["include", "examples", "tests"] {
        clang.arg("-I").arg(Path::new(PROJECT).join(folder));
    }
    clang.args(sources.iter().chain(&["tests/no_unwind.c"]).map(|source| Path::new(PROJECT).join(source)));
    done(clang.args(libraries).args(["-lm", "-lpthread", "-ldl", "-o"]).arg(&program))?;
    Ok(program)
}
