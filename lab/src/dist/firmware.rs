//! The bridge firmware for all boards: ELF for a debug probe, UF2 for a boot loader.

use super::uf2::{self, Loader};
use super::{Folder, VERSION, build};
use crate::firmware::image::Image;
use crate::targets;
use anyhow::{Context, Result, ensure};
use std::fs;

struct Board {
    name: &'static str,
    target: &'static str,
    bin: &'static str,
    features: &'static str,
    forms: &'static [Form],
}

enum Form {
    Elf,
    Uf2(Loader),
}

/// The boards. With a boot loader, the firmware of a Black Pill is at another flash address.
const BOARDS: [Board; 3] = [
    Board {
        name: "pico",
        target: "thumbv6m-none-eabi",
        bin: "rp2040",
        features: "rp2040",
        forms: &[Form::Elf, Form::Uf2(uf2::RP2040)],
    },
    Board {
        name: "blackpill",
        target: "thumbv7em-none-eabihf",
        bin: "stm32f4",
        features: "stm32f4",
        forms: &[Form::Elf],
    },
    Board {
        name: "blackpill-tinyuf2",
        target: "thumbv7em-none-eabihf",
        bin: "stm32f4",
        features: "stm32f4,uf2",
        forms: &[Form::Uf2(uf2::TINYUF2_STM32F4)],
    },
];

fn name(board: &Board, form: &Form) -> String {
    let ending = match form {
        Form::Elf => "elf",
        Form::Uf2(_) => "uf2",
    };
    format!("zerorate-bridge-{VERSION}-{}.{ending}", board.name)
}

pub fn make(folder: &Folder) -> Result<()> {
    targets::add_missing(BOARDS.iter().map(|board| board.target))?;
    for board in &BOARDS {
        let built = build("firmware/bridge/Cargo.toml", board.target, ["--features", board.features])?;
        let image = fs::read(built.join(board.bin))?;
        for form in board.forms {
            let bytes = match form {
                Form::Elf => image.clone(),
                Form::Uf2(loader) => uf2::convert(&image, loader)?,
            };
            fs::write(folder.of(name(board, form)), bytes)?;
        }
    }
    Ok(())
}

/// Checks the format of the files. The firmware is not run on a board.
pub fn check(folder: &Folder) -> Result<()> {
    for board in &BOARDS {
        for form in board.forms {
            let path = folder.of(name(board, form));
            if let Form::Elf = form {
                ensure!(Image::read(&path)?.memory()?.flash > 0, "{} has no program", path.display());
            } else {
                let file = fs::read(&path).with_context(|| path.display().to_string())?;
                let starts = file.chunks(512).all(|block| block.starts_with(b"UF2\n"));
                ensure!(starts && !file.is_empty() && file.len() % 512 == 0, "{} is no UF2", path.display());
            }
            println!("{}: well formed; tried on no board", name(board, form));
        }
    }
    Ok(())
}
