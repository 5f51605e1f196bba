//! Measures the size of a linked image, and checks whether it can panic.

use anyhow::{Context, Result};
use object::read::archive::ArchiveFile;
use object::read::elf::{ElfFile32, SectionHeader};
use object::{LittleEndian, Object, ObjectSymbol, elf};
use std::fs;
use std::path::Path;

pub struct Image(Vec<u8>);

/// Sizes in the two memories, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Code, constants and the initial values of variables.
    pub flash: u64,
    /// Variables, without the stack.
    pub ram: u64,
}

/// Parts of the names of functions that a panic needs. Every panic needs at least one of them.
const PANIC_MARKS: [&str; 4] = ["panicking", "panic_", "unwrap_failed", "rust_begin_unwind"];

/// Parts of the names of functions that allocate.
const HEAP_MARKS: [&str; 3] = ["__rust_alloc", "__rust_dealloc", "alloc_error"];

/// The symbols in a static library that belong to panics or to a heap.
pub fn unwanted_in_archive(path: &Path) -> Result<Vec<String>> {
    let data = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut unwanted = Vec::new();
    for member in ArchiveFile::parse(data.as_slice())?.members() {
        let object = object::File::parse(member?.data(data.as_slice())?)?;
        let names = object.symbols().filter_map(|symbol| symbol.name().ok().map(str::to_owned));
        let marks = || PANIC_MARKS.iter().chain(&HEAP_MARKS);
        unwanted.extend(names.filter(|name| marks().any(|mark| name.contains(mark))));
    }
    Ok(unwanted)
}

impl Image {
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self(fs::read(path).with_context(|| format!("cannot read {}", path.display()))?))
    }

    /// Sums over the sections of the image: read-only ones are in flash, writable ones in RAM, and writable ones
    /// with initial values in both.
    pub fn memory(&self) -> Result<Memory> {
        let elf = self.elf()?;
        let mut memory = Memory { flash: 0, ram: 0 };
        for section in elf.elf_section_table().iter() {
            let (flags, size) = (section.sh_flags(LittleEndian), u64::from(section.sh_size(LittleEndian)));
            if flags & elf::SHF_ALLOC == 0 {
                continue;
            }
            if flags & elf::SHF_WRITE != 0 {
                memory.ram += size;
            }
            if section.sh_type(LittleEndian) != elf::SHT_NOBITS {
                memory.flash += size;
            }
        }
        Ok(memory)
    }

    pub fn panic_symbols(&self) -> Result<Vec<String>> {
        let elf = self.elf()?;
        let names = elf.symbols().filter_map(|symbol| symbol.name().ok().map(str::to_owned));
        Ok(names.filter(|name| PANIC_MARKS.iter().any(|mark| name.contains(mark))).collect())
    }

    fn elf(&self) -> Result<ElfFile32<'_, LittleEndian>> {
        ElfFile32::parse(self.0.as_slice()).context("not an ELF file of 32 bits, little endian")
    }
}
