//! `cargo xtask uf2`: converts an image to the file that a user copies to the drive of a board: a Raspberry Pi Pico,
//! or an STM32F4 with TinyUF2.
//!
//! The format is Microsoft's UF2 (<https://github.com/microsoft/uf2>): blocks of 512 bytes, each with its address and
//! its number, so that a drive may write them in any order.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use anyhow::{Context, Result};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, elf};

/// Command line of `cargo xtask uf2`.
#[derive(clap::Args)]
pub struct Uf2Args {
    /// The image, in ELF, as `cargo build` leaves it
    #[arg(default_value = "target/firmware/thumbv6m-none-eabi/release/rp2040")]
    image: PathBuf,
    /// The file to write; default: the image's name with .uf2
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// A boot loader's family and flash.
struct Family {
    name: &'static str,
    /// "Family ID" in Microsoft's list.
    id: u32,
    /// Its flash. With anything else in the file, the boot loader of an RP2040 takes it for a program in RAM.
    flash: Range<u32>,
}

/// TinyUF2 keeps the first 64 KiB of an STM32F4 (README of `ports/stm32f4` in <https://github.com/adafruit/tinyuf2>).
const FAMILIES: [Family; 2] = [
    Family { name: "RP2040", id: 0xE48B_FF56, flash: 0x1000_0000..0x1100_0000 },
    Family { name: "STM32F4 with TinyUF2", id: 0x5775_5A57, flash: 0x0801_0000..0x0820_0000 },
];

/// Bytes of the image in a block, and what an RP2040 writes at once.
const PAGE: usize = 256;

/// Writes the file.
pub fn run(args: &Uf2Args) -> Result<()> {
    let name = args.image.display();
    let image = fs::read(&args.image)
        .with_context(|| format!("cannot read {name}: build it first (firmware/bridge/README.md has the command)"))?;
    let output = args.output.clone().unwrap_or_else(|| args.image.with_extension("uf2"));
    let file = convert(&image).with_context(|| name.to_string())?;
    fs::write(&output, &file).with_context(|| format!("cannot write {}", output.display()))?;
    println!("{}: {} blocks; copy it to the drive of the board's boot loader", output.display(), file.len() / 512);
    Ok(())
}

/// The file for an image in ELF.
pub fn convert(image: &[u8]) -> Result<Vec<u8>> {
    let pages = pages(image)?;
    let (first, last) = (pages.keys().next(), pages.keys().next_back());
    let (first, last) = first.zip(last).context("nothing in it is to be flashed")?;
    let family = FAMILIES.iter().find(|family| family.flash.contains(first) && family.flash.contains(last));
    let names = FAMILIES.map(|family| format!("{} ({:#010x}…)", family.name, family.flash.start)).join(", ");
    let family = family.with_context(|| {
        format!("{first:#010x}… is not in the flash that a boot loader fills: {names}; for TinyUF2: --features uf2")
    })?;
    Ok(blocks(&pages, family))
}

/// The part of an image that belongs into flash, in whole pages, filled with zeros.
fn pages(image: &[u8]) -> Result<BTreeMap<u32, [u8; PAGE]>> {
    let file = ElfFile32::<Endianness>::parse(image)?;
    let mut pages = BTreeMap::new();
    for segment in file.elf_program_headers() {
        let endian = file.endian();
        let bytes = segment.data(endian, image).ok().context("a segment is not in the file")?;
        if segment.p_type(endian) != elf::PT_LOAD || bytes.is_empty() {
            continue;
        }
        let start = segment.p_paddr(endian);
        for (address, byte) in (start..=u32::MAX).zip(bytes) {
            let place = address as usize % PAGE;
            pages.entry(address - place as u32).or_insert([0; PAGE])[place] = *byte;
        }
    }
    Ok(pages)
}

/// The blocks of a file, in the order of their addresses.
fn blocks(pages: &BTreeMap<u32, [u8; PAGE]>, family: &Family) -> Vec<u8> {
    let mut file = Vec::with_capacity(512 * pages.len());
    for (number, (address, page)) in (0_u32..).zip(pages) {
        // two magic numbers, "the family is stated", address, size, number, count, family
        let head = [0x0A32_4655, 0x9E5D_5157, 0x2000, *address, PAGE as u32, number, pages.len() as u32, family.id];
        file.extend(head.iter().flat_map(|word: &u32| word.to_le_bytes()));
        file.extend(page);
        file.resize(file.len() + 476 - PAGE, 0);
        file.extend(0x0AB1_6F30_u32.to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes that a boot loader would write, by a reader that shares nothing with the writer.
    #[test]
    fn another_reader_finds_the_same_bytes() {
        let image: Vec<u8> = (0..1000_u32).map(|i| (i * 7) as u8).collect();
        for (family, start) in [(0xE48B_FF56, 0x1000_0000), (0x5775_5A57, 0x0801_0000)] {
            let file = convert(&elf(start + 0x80, &image)).unwrap();
            let (bytes, families) = uf2_decode::convert_from_uf2(&file).unwrap();
            assert_eq!(families.into_iter().collect::<Vec<_>>(), [(family, u64::from(start))]);
            assert_eq!(bytes[..0x80], [0; 0x80]);
            assert_eq!(bytes[0x80..][..1000], image);
            assert_eq!(bytes.len() % PAGE, 0);
        }
    }

    #[test]
    fn what_does_not_belong_into_flash_is_refused() {
        let refusal = |address, bytes: &[u8]| convert(&elf(address, bytes)).unwrap_err().to_string();
        assert!(refusal(0x2000_0000, &[1]).contains("not in the flash"));
        assert!(refusal(0x10FF_FFFF, &[1, 2]).contains("not in the flash"));
        assert!(refusal(0x0800_0000, &[1]).contains("--features uf2"));
        assert!(refusal(0x1000_0000, &[]).contains("nothing"));
        assert!(convert(b"no image").is_err());
    }

    /// The smallest image with one segment: the header of the file, one of a program, its bytes.
    fn elf(address: u32, bytes: &[u8]) -> Vec<u8> {
        let mut file = b"\x7FELF\x01\x01\x01".to_vec();
        file.resize(16, 0);
        let half =
            |file: &mut Vec<u8>, values: &[u16]| file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        let word =
            |file: &mut Vec<u8>, values: &[u32]| file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        half(&mut file, &[2, 40]);
        word(&mut file, &[1, address, 52, 0, 0]);
        half(&mut file, &[52, 32, 1, 40, 0, 0]);
        let len = bytes.len() as u32;
        word(&mut file, &[1, 84, address, address, len, len, 5, 4]);
        file.extend(bytes);
        file
    }
}
