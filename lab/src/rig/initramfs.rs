//! Builds the guest's file system, which contains busybox, kernel modules, the program and its libraries, the HID
//! gyroscope, and the script.

use super::kernel::Kernel;
use crate::app::emptied;
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const MODULES: [&str; 8] =
    ["xhci_pci", "usb_ljca", "spi_ljca", "gpio_ljca", "adis16130", "uhid", "hid_sensor_hub", "hid_sensor_gyro_3d"];
const SCRIPT: &str = include_str!("guest.sh");
const GYRO: &str = include_str!("gyro.rs");
/// The part file of the HID gyroscope, with properties that its driver does not state.
const GYRO_PART: &str = include_str!("gyro.toml");
/// The first line of the script. The settings are inserted after it.
const FIRST_LINE: &str = "#!/bin/busybox sh\n";

/// Builds the file system in `folder`, with `program` in it. `settings` become shell variables of the script.
pub fn build(folder: &Path, kernel: &Kernel, program: &Path, settings: &[(&str, &str)]) -> Result<PathBuf> {
    let root = emptied(folder.join("root"))?;
    for name in ["bin", "lib/modules"] {
        fs::create_dir_all(root.join(name))?;
    }
    add_program(&root, Path::new("/bin/busybox"), "busybox")?;
    let stripped = folder.join("zerorate");
    done(Command::new("strip").arg("-o").arg(&stripped).arg(program))?;
    add_program(&root, &stripped, "zerorate")?;
    add_program(&root, &gyro(folder)?, "gyro")?;
    fs::write(root.join("gyro.toml"), GYRO_PART)?;
    add_modules(&root, &kernel.module_files(&MODULES)?)?;
    let variables: String = settings.iter().map(|(name, value)| format!("{name}='{value}'\n")).collect();
    let script = SCRIPT.replacen(FIRST_LINE, &format!("{FIRST_LINE}{variables}"), 1);
    fs::write(root.join("init"), script)?;
    fs::set_permissions(root.join("init"), fs::Permissions::from_mode(0o755))?;
    pack(&root, &folder.join("initramfs"))
}

fn gyro(folder: &Path) -> Result<PathBuf> {
    let (source, program) = (folder.join("gyro.rs"), folder.join("gyro"));
    fs::write(&source, GYRO)?;
    let mut rustc = Command::new("rustc");
    rustc.args(["--edition", "2024", "-O", "-C", "target-feature=+crt-static", "-C", "strip=symbols", "-o"]);
    done(rustc.arg(&program).arg(&source))?;
    Ok(program)
}

/// Copies a program to `bin/NAME`, and its shared libraries, if any, to the paths that they have on this computer.
fn add_program(root: &Path, program: &Path, name: &str) -> Result<()> {
    fs::copy(program, root.join("bin").join(name)).with_context(|| format!("copying {}", program.display()))?;
    let libraries = Command::new("ldd").arg(program).stderr(Stdio::null()).output()?;
    for word in String::from_utf8(libraries.stdout)?.split_whitespace().filter(|word| word.starts_with('/')) {
        let library = Path::new(word);
        let to = root.join(library.strip_prefix("/")?);
        fs::create_dir_all(to.parent().context("a library without a folder")?)?;
        fs::copy(library, to).with_context(|| format!("copying {word}"))?;
    }
    Ok(())
}

fn add_modules(root: &Path, files: &[PathBuf]) -> Result<()> {
    let mut order = String::new();
    for file in files {
        let name = file.file_name().context("a module without a name")?.to_string_lossy();
        let name = name.trim_end_matches(".xz");
        let to = root.join("lib/modules").join(name);
        if file.extension().is_some_and(|extension| extension == "xz") {
            let unpacked = Command::new("xz").arg("-dc").arg(file).output()?;
            ensure!(unpacked.status.success(), "xz cannot unpack {}", file.display());
            fs::write(to, unpacked.stdout)?;
        } else {
            fs::copy(file, to)?;
        }
        order += &format!("{name}\n");
    }
    Ok(fs::write(root.join("lib/modules/order"), order)?)
}

fn pack(root: &Path, archive: &Path) -> Result<PathBuf> {
    let archive = std::path::absolute(archive)?;
    let quoted = archive.display();
    printed(
        Command::new("sh").arg("-c").arg(format!("find . | cpio -o -H newc --quiet > '{quoted}'")).current_dir(root),
    )?;
    Ok(archive)
}
