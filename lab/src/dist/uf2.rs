//! UF2: the file format that a user copies to the drive of a board's boot loader (<https://github.com/microsoft/uf2>).
//! It has blocks of 512 bytes, each with its address and its number, so that a drive may write them in any order.

use anyhow::{Context, Result, bail, ensure};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{LittleEndian, elf};
use std::collections::BTreeMap;
use std::ops::Range;

pub struct Loader {
    /// The ID of the processor family in Microsoft's list.
    family: u32,
    /// The address range of the flash that the boot loader fills. If the file contains any other address, the boot
    /// loader of an RP2040 treats the file as a program in RAM.
    flash: Range<u32>,
}

pub const RP2040: Loader = Loader { family: 0xE48B_FF56, flash: 0x1000_0000..0x1100_0000 };

/// TinyUF2 on an STM32F4. This boot loader reserves the first 64 KiB (README of `ports/stm32f4` in
/// <https://github.com/adafruit/tinyuf2>).
pub const TINYUF2_STM32F4: Loader = Loader { family: 0x5775_5A57, flash: 0x0801_0000..0x0820_0000 };

/// Number of bytes of the image in a block: the bytes that an RP2040 writes at once.
const PAGE: usize = 256;

pub fn convert(image: &[u8], loader: &Loader) -> Result<Vec<u8>> {
    let pages = pages(image)?;
    ensure!(!pages.is_empty(), "nothing in it is to be flashed");
    if let Some(address) = pages.keys().find(|address| !loader.flash.contains(address)) {
        bail!("{address:#010x} is not in the flash that the boot loader fills");
    }
    Ok(blocks(&pages, loader.family))
}

/// The part of an image for the flash, in whole pages, padded with zeros.
fn pages(image: &[u8]) -> Result<BTreeMap<u32, [u8; PAGE]>> {
    let file = ElfFile32::<LittleEndian>::parse(image)?;
    let mut pages = BTreeMap::new();
    for segment in file.elf_program_headers() {
        let bytes = segment.data(LittleEndian, image).ok().context("a segment is not in the file")?;
        if segment.p_type(LittleEndian) != elf::PT_LOAD || bytes.is_empty() {
            continue;
        }
        let start = segment.p_paddr(LittleEndian);
        for (address, byte) in (start..=u32::MAX).zip(bytes) {
            let place = address as usize % PAGE;
            pages.entry(address - place as u32).or_insert([0; PAGE])[place] = *byte;
        }
    }
    Ok(pages)
}

/// The blocks of the file, in order of their addresses.
fn blocks(pages: &BTreeMap<u32, [u8; PAGE]>, family: u32) -> Vec<u8> {
    let mut file = Vec::with_capacity(512 * pages.len());
    for (number, (address, page)) in (0_u32..).zip(pages) {
        // two magic numbers, the flag "family ID present", address, size, number, count, family
        let head = [0x0A32_4655, 0x9E5D_5157, 0x2000, *address, PAGE as u32, number, pages.len() as u32, family];
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

    #[test]
    fn another_reader_finds_the_same_bytes() {
        let image: Vec<u8> = (0..1000_u32).map(|i| (i * 7) as u8).collect();
        for (loader, start) in [(RP2040, 0x1000_0000), (TINYUF2_STM32F4, 0x0801_0000)] {
            let file = convert(&elf(start + 0x80, &image), &loader).unwrap();
            let (bytes, families) = uf2_decode::convert_from_uf2(&file).unwrap();
            assert_eq!(families.into_iter().collect::<Vec<_>>(), [(loader.family, u64::from(start))]);
            assert_eq!(bytes[..0x80], [0; 0x80]);
            assert_eq!(bytes[0x80..][..1000], image);
            assert_eq!(bytes.len() % PAGE, 0);
        }
    }

    #[test]
    fn segments_outside_the_flash_are_refused() {
        let refusal = |address, bytes: &[u8]| convert(&elf(address, bytes), &RP2040).unwrap_err().to_string();
        assert!(refusal(0x2000_0000, &[1]).contains("not in the flash"));
        assert!(refusal(0x10FF_FFFF, &[1, 2]).contains("not in the flash"));
        assert!(refusal(0x1000_0000, &[]).contains("nothing"));
        assert!(convert(b"no image", &RP2040).is_err());
    }

    /// The smallest image with one segment: file header, program header, and the bytes.
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
