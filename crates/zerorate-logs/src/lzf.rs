//! Unpacks LZF, by which h5py compresses a data set (`compression="lzf"`). The format is that of Marc Lehmann's
//! LibLZF. It has neither a header nor a checksum.

/// Unpacks a chunk. Returns `None` if the chunk is invalid, or unpacks to more than `most` bytes.
pub fn unpacked(mut packed: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut bytes: Vec<u8> = Vec::new();
    while let Some((&control, rest)) = packed.split_first() {
        packed = rest;
        let (length, high) = (usize::from(control >> 5), usize::from(control & 0x1F));
        if length == 0 {
            let (run, rest) = packed.split_at_checked(high + 1)?;
            bytes.extend(run);
            packed = rest;
        } else {
            let more = if length == 7 { usize::from(taken(&mut packed)?) } else { 0 };
            let back = (high << 8) + usize::from(taken(&mut packed)?) + 1;
            let from = bytes.len().checked_sub(back)?;
            // a repeated range may overlap the copy
            (from..from + length + more + 2).for_each(|at| bytes.push(bytes[at]));
        }
        if bytes.len() > most {
            return None;
        }
    }
    Some(bytes)
}

fn taken(packed: &mut &[u8]) -> Option<u8> {
    let (first, rest) = packed.split_first()?;
    *packed = rest;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::unpacked;

    /// Chunks put together by hand, from the description of the format in LibLZF's comments.
    #[test]
    fn literals_and_repetitions() {
        assert_eq!(unpacked(b"\x02abc", 9).unwrap(), b"abc");
        assert_eq!(unpacked(b"\x02abc\x20\x02", 9).unwrap(), b"abcabc");
        assert_eq!(unpacked(b"\x00a\xE0\x01\x00", 99).unwrap(), b"a".repeat(11));
        assert_eq!(unpacked(b"", 0).unwrap(), b"");
        for wrong in [&b"\x02ab"[..], b"\x00a\x20\x01", b"\x00a\x20", b"\x00a\xE0\x01", b"\x00a\xE0"] {
            assert_eq!(unpacked(wrong, 99), None, "{wrong:?}");
        }
        assert_eq!(unpacked(b"\x00a\xE0\xFF\x00", 99), None, "more than may be");
    }
}
