//! `cargo xtask uf2`: an image as the file that a Raspberry Pi Pico takes when it is copied to its drive.
//!
//! The format is Microsoft's UF2 (<https://github.com/microsoft/uf2>): blocks of 512 bytes, each with its address and
//! its number, so that a drive may write them in any order.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, elf};

/// Command line of `cargo xtask uf2`.
#[derive(clap::Args)]
pub struct Args {
    /// The image, in ELF, as `cargo build` leaves it
    #[arg(default_value = "target/firmware/thumbv6m-none-eabi/release/rp2040")]
    image: PathBuf,
    /// The file to write; default: the image's name with .uf2
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// What an RP2040 takes: "family ID" in Microsoft's list.
const RP2040: u32 = 0xE48B_FF56;

/// Flash of an RP2040: nothing else may be in the file, or its boot loader takes it for a program in RAM.
const FLASH: std::ops::Range<u32> = 0x1000_0000..0x1100_0000;

/// Bytes of the image in a block, and what the RP2040 writes at once.
const PAGE: usize = 256;

/// Writes the file.
pub fn run(args: &Args) -> Result<()> {
    let name = args.image.display();
    let image = fs::read(&args.image)
        .with_context(|| format!("cannot read {name}: build it first (firmware/bridge/README.md has the command)"))?;
    let pages = pages(&image).with_context(|| name.to_string())?;
    let output = args.output.clone().unwrap_or_else(|| args.image.with_extension("uf2"));
    fs::write(&output, blocks(&pages)).with_context(|| format!("cannot write {}", output.display()))?;
    println!(
        "{}: {} blocks; copy it to the drive of a Pico that was plugged in with BOOTSEL held",
        output.display(),
        pages.len()
    );
    Ok(())
}

/// What of an image belongs into flash, by whole pages, zeros where nothing is.
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
        let end = u32::try_from(bytes.len()).ok().and_then(|len| start.checked_add(len));
        let in_flash = FLASH.contains(&start) && end.is_some_and(|end| end <= FLASH.end);
        ensure!(in_flash, "{} bytes at {start:#010x} are not in the flash of an RP2040", bytes.len());
        for (address, byte) in (start..).zip(bytes) {
            let place = address as usize % PAGE;
            pages.entry(address - place as u32).or_insert([0; PAGE])[place] = *byte;
        }
    }
    ensure!(!pages.is_empty(), "nothing in it is to be flashed");
    Ok(pages)
}

/// The blocks of a file, in the order of their addresses.
fn blocks(pages: &BTreeMap<u32, [u8; PAGE]>) -> Vec<u8> {
    let mut file = Vec::with_capacity(512 * pages.len());
    for (number, (address, page)) in (0_u32..).zip(pages) {
        // two magic numbers, "the family is stated", address, size, number, count, family
        let head = [0x0A32_4655, 0x9E5D_5157, 0x2000, *address, PAGE as u32, number, pages.len() as u32, RP2040];
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

    /// What a boot loader would write, by a reader that shares nothing with the writer.
    #[test]
    fn another_reader_finds_the_same_bytes() {
        let image: Vec<u8> = (0..1000_u32).map(|i| (i * 7) as u8).collect();
        let pages = pages(&elf(0x1000_0080, &image)).unwrap();
        let (bytes, families) = uf2_decode::convert_from_uf2(&blocks(&pages)).unwrap();
        assert_eq!(families.into_iter().collect::<Vec<_>>(), [(0xE48B_FF56, 0x1000_0000)]);
        assert_eq!(bytes[..0x80], [0; 0x80]);
        assert_eq!(bytes[0x80..][..1000], image);
        assert_eq!(bytes.len() % PAGE, 0);
    }

    #[test]
    fn what_does_not_belong_into_flash_is_refused() {
        assert!(pages(&elf(0x2000_0000, &[1])).unwrap_err().to_string().contains("not in the flash"));
        assert!(pages(&elf(0x10FF_FFFF, &[1, 2])).is_err());
        assert!(pages(&elf(0x1000_0000, &[])).unwrap_err().to_string().contains("nothing"));
        assert!(pages(b"no image").is_err());
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
