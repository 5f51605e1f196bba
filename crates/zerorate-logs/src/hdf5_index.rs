//! Verifies the checksums in the index of a chunked data set, where the index is an array (HDF5 1.10 and later,
//! `libver="latest"`). The library does not verify them. A changed bit there may leave out a filter, so that values
//! are wrong.
//!
//! The HDF Group, HDF5 File Format Specification 3.0, VII.D (fixed array) and VII.E (extensible array). The
//! blocks of data of an extensible array are not checked.

use hdf5_reader::checksum::jenkins_lookup3;
use hdf5_reader::error::Error;

const CHECK: usize = 4;

/// Size of the header of a fixed array in bytes, if offsets and lengths have eight bytes.
const FIXED_HEAD: usize = 28;

/// Bytes of a fixed array's data block before its entries or, if it has pages, before the bitmap of its pages.
const BLOCK_HEAD: usize = 14;

/// Verifies the checksum of `bytes`, if they are the header of an array index, or a block of it that ends with a
/// checksum. For the header of a fixed array, also verifies its data block, which `read` reads.
pub fn check(bytes: &[u8], read: impl Fn(u64, usize) -> Result<Vec<u8>, Error>) -> Result<(), Error> {
    match bytes.first_chunk() {
        Some(b"FAHD") if bytes.len() == FIXED_HEAD => {
            whole(bytes)?;
            check_block(bytes, read)
        }
        Some(b"EAHD" | b"EAIB" | b"EASB") => whole(bytes),
        _ => Ok(()),
    }
}

fn check_block(head: &[u8], read: impl Fn(u64, usize) -> Result<Vec<u8>, Error>) -> Result<(), Error> {
    let number = |at: usize| head[at..].first_chunk().map_or(u64::MAX, |bytes| u64::from_le_bytes(*bytes));
    let (size, page_bits, entries, block) = (u64::from(head[6]), u32::from(head[7]), number(8), number(16));
    // no chunk was written yet, or addresses do not count from the start of the file, as in a file with a user block
    if block == u64::MAX || read(block, 4)? != b"FADB" {
        return Ok(());
    }
    let bytes = |entries: u64| usize::try_from(entries.saturating_mul(size)).unwrap_or(usize::MAX);
    let in_page = 1u64.checked_shl(page_bits).unwrap_or(u64::MAX);
    if entries <= in_page {
        return whole(&read(block, bytes(entries).saturating_add(BLOCK_HEAD + CHECK))?);
    }
    let pages = entries.div_ceil(in_page);
    let map = usize::try_from(pages.div_ceil(8)).unwrap_or(usize::MAX);
    let start = read(block, map.saturating_add(BLOCK_HEAD + CHECK))?;
    whole(&start)?;
    let mut place = block.saturating_add(start.len() as u64);
    for page in 0..pages {
        let length = bytes(in_page.min(entries - page * in_page)).saturating_add(CHECK);
        let is_there = start[BLOCK_HEAD + (page / 8) as usize] & (0x80 >> (page % 8)) != 0;
        if is_there {
            whole(&read(place, length)?)?;
        }
        place = place.saturating_add(length as u64);
    }
    Ok(())
}

/// Verifies the checksum at the end of a block.
fn whole(block: &[u8]) -> Result<(), Error> {
    let Some((block, check)) = block.split_last_chunk::<CHECK>() else { return Ok(()) };
    let (expected, actual) = (u32::from_le_bytes(*check), jenkins_lookup3(block));
    if expected == actual { Ok(()) } else { Err(Error::ChecksumMismatch { expected, actual }) }
}
