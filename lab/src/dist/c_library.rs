//! Archives of the C library: header, static library, and files for CMake and pkg-config.

use super::{Folder, VERSION, build, fill, papers, put, repository};
use crate::targets;
use crate::tools::{Tool, available};
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

struct Kind {
    target: &'static str,
    compiler: Tool,
    flags: &'static [&'static str],
    /// The command that runs programs for the target. Without one, they are only linked.
    run: Option<&'static [&'static str]>,
}

const ARM: Tool = Tool { program: "arm-none-eabi-gcc", package: "gcc-arm-none-eabi" };
const KINDS: [Kind; 4] = [
    Kind {
        target: "x86_64-unknown-linux-gnu",
        compiler: Tool { program: "gcc", package: "build-essential" },
        flags: &[],
        run: Some(&[]),
    },
    Kind {
        target: "aarch64-unknown-linux-gnu",
        compiler: Tool { program: "aarch64-linux-gnu-gcc", package: "gcc-aarch64-linux-gnu" },
        flags: &["-static"],
        run: Some(&["qemu-aarch64-static"]),
    },
    Kind {
        target: "thumbv7em-none-eabihf",
        compiler: ARM,
        flags: &["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "--specs=nosys.specs"],
        run: None,
    },
    Kind {
        target: "thumbv6m-none-eabi",
        compiler: ARM,
        flags: &["-mcpu=cortex-m0", "-mthumb", "--specs=nosys.specs"],
        run: None,
    },
];
const TOOLS: [Tool; 4] = [
    Tool { program: "cmake", package: "cmake" },
    Tool { program: "pkg-config", package: "pkg-config" },
    Tool { program: "qemu-aarch64-static", package: "qemu-user-static" },
    Tool { program: "arm-none-eabi-gcc", package: "libnewlib-arm-none-eabi" },
];
/// The expected output of the trial program: a corrected code, and the text for a failing bus.
const PRINTED: &str = "8499475\nthe SPI transfer failed; reset and initialise the part\n";

fn name(kind: &Kind) -> String {
    format!("zerorate-c-{VERSION}-{}", kind.target)
}

pub fn make(folder: &Folder) -> Result<()> {
    targets::add_missing(KINDS.iter().map(|kind| kind.target))?;
    for kind in &KINDS {
        let built = build("bindings/c/Cargo.toml", kind.target, ["--package", "zerorate-c"])?;
        let parent = folder.empty("c")?;
        let to = parent.join(name(kind));
        put(&to.join("lib/libzerorate_c.a"), &fs::read(built.join("libzerorate_c.a"))?)?;
        for file in ["zerorate-config.cmake", "zerorate-config-version.cmake"] {
            fill(&format!("c/{file}"), &to.join("lib/cmake/zerorate").join(file), &[("VERSION", VERSION)])?;
        }
        let values = [("VERSION", VERSION), ("URL", &repository("URL"))];
        fill("c/zerorate.pc", &to.join("lib/pkgconfig/zerorate.pc"), &values)?;
        for file in ["include/zerorate.h", "README.md"] {
            put(&to.join(file), &fs::read(Path::new("bindings/c").join(file))?)?;
        }
        for paper in ["LICENSE-MIT", "LICENSE-APACHE", &papers::licences("zerorate-c"), papers::RUST_LIBRARY] {
            let bytes = fs::read(folder.of(paper)).with_context(|| format!("{paper}: make the part papers first"))?;
            put(&to.join(paper), &bytes)?;
        }
        folder.pack(&parent, &name(kind))?;
    }
    Ok(())
}

/// Builds a small project with each archive, by CMake and by pkg-config, and runs it if possible.
pub fn check(folder: &Folder) -> Result<()> {
    if !available(&[TOOLS.as_slice(), &KINDS.map(|kind| kind.compiler)].concat(), "the C library in a project")? {
        return Ok(());
    }
    for kind in &KINDS {
        let work = folder.empty("c-trial")?;
        let archive = folder.of(format!("{}.tar.gz", name(kind)));
        done(Command::new("tar").arg("--extract").arg("--file").arg(archive).arg("--directory").arg(&work))?;
        let library = work.join(name(kind));
        for (how, program) in
            [("CMake", by_cmake(kind, &library, &work)?), ("pkg-config", by_pkg_config(kind, &library)?)]
        {
            let Some(before) = kind.run else {
                println!("{}: linked by way of {how}", name(kind));
                continue;
            };
            let mut words = before.iter().map(Path::new).chain([program.as_path()]);
            let mut run = Command::new(words.next().context("a program")?);
            let printed = printed(run.args(words))?;
            ensure!(printed == PRINTED, "{}, by way of {how}, prints {printed}", name(kind));
            println!("{}: runs, by way of {how}", name(kind));
        }
    }
    Ok(())
}

const TRIAL: &str = "packaging/c/trial";

fn by_cmake(kind: &Kind, library: &Path, work: &Path) -> Result<PathBuf> {
    let build = work.join("build");
    let mut configure = Command::new("cmake");
    configure.args(["-Wno-dev", "-S", TRIAL, "-B"]).arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", library.display()));
    configure.arg(format!("-DCMAKE_C_COMPILER={}", kind.compiler.program));
    configure.arg(format!("-DCMAKE_C_FLAGS={}", kind.flags.join(" ")));
    if kind.target != KINDS[0].target {
        let system = if kind.run.is_some() { "Linux" } else { "Generic" };
        configure.arg(format!("-DCMAKE_SYSTEM_NAME={system}")).arg("-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH");
    }
    printed(&mut configure)?;
    printed(Command::new("cmake").arg("--build").arg(&build))?;
    Ok(build.join("trial"))
}

fn by_pkg_config(kind: &Kind, library: &Path) -> Result<PathBuf> {
    let mut ask = Command::new("pkg-config");
    ask.args(["--cflags", "--libs", "zerorate"]).env("PKG_CONFIG_LIBDIR", library.join("lib/pkgconfig"));
    let flags = printed(&mut ask)?;
    let program = library.join("trial");
    let mut compile = Command::new(kind.compiler.program);
    compile.args(kind.flags).arg(Path::new(TRIAL).join("main.c")).arg("-o").arg(&program);
    done(compile.args(flags.split_whitespace()).args(["-Wl,--gc-sections", "-Wl,--no-warnings"]))?;
    Ok(program)
}
