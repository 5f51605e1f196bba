//! Limits of the memory that a file may take. The unpacked size of a file shows only while it is read, and the sizes
//! that the file states may be wrong.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

/// Memory that any file may take, even the smallest, bytes.
pub const FREE_BYTES: u64 = 64 << 20;

/// Memory that a file may take beyond [`FREE_BYTES`], as a multiple of its size on disk. Recorded noise compresses at
/// best about 20 to 1, so a log stays far below this limit.
pub const FACTOR: u64 = 256;

/// Largest size of a small text file: a calibration, a part file, a data sheet, a token, the state of a tracker.
pub const TEXT: Bytes = Bytes(1 << 20);

/// Lowest memory limit of the process, bytes. The commands need this much for their threads and batches.
const LEAST_BYTES: u64 = 256 << 20;

const DEFAULT_BYTES: u64 = 1 << 30;

static MAX_MEMORY: OnceLock<u64> = OnceLock::new();

/// A number of bytes. Text such as `512M`, `2G` or a bare number of bytes is parsed as a memory limit, so less than
/// 256 MiB is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let digits = text.trim_end_matches(|c: char| !c.is_ascii_digit());
        let unit = match text[digits.len()..].trim().to_ascii_lowercase().as_str() {
            "" | "b" => 0,
            "k" | "kb" | "kib" => 10,
            "m" | "mb" | "mib" => 20,
            "g" | "gb" | "gib" => 30,
            _ => return Err("write it like 512M or 2G".to_owned()),
        };
        let number: u64 = digits.parse().map_err(|_| "write it like 512M or 2G".to_owned())?;
        let bytes = number.checked_mul(1 << unit).ok_or("it is more than any machine has")?;
        if bytes < LEAST_BYTES {
            return Err(format!("at least {} are needed", Self(LEAST_BYTES)));
        }
        Ok(Self(bytes))
    }
}

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = self.0.div_ceil(1 << 20);
        match mebibytes {
            0..10_240 => write!(f, "{mebibytes} MiB"),
            _ => write!(f, "{} GiB", mebibytes / 1024),
        }
    }
}

/// Sets the memory limit of the process, which is at least 256 MiB. Call it once, before anything is read.
pub fn set_max_memory(bytes: Bytes) {
    let _ = MAX_MEMORY.set(bytes.0.max(LEAST_BYTES));
}

/// The memory limit of the process, bytes.
pub fn max_memory() -> u64 {
    *MAX_MEMORY.get_or_init(|| DEFAULT_BYTES)
}

/// The size limits of one unpacked file, in memory and on disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryBudget {
    bytes: u64,
    max_memory: u64,
}

/// The error for a file that exceeds its memory budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OverBudget {
    /// The file unpacks to more than this many bytes, the budget for its size on disk.
    #[error(
        "it grows to more than {} in memory, {} plus {FACTOR} times its size on disk: it is damaged, or made to fill \
         a machine",
        Bytes(*.0), Bytes(FREE_BYTES)
    )]
    ForItsSize(u64),
    /// The file needs more memory than the limit of the process, bytes.
    #[error("it takes more memory than the {} of max_memory: give more, or cut the log", Bytes(*.0))]
    InMemory(u64),
}

impl MemoryBudget {
    /// The budget of a file of this many bytes on disk.
    pub fn of(file_bytes: u64) -> Self {
        Self { bytes: for_size(file_bytes), max_memory: max_memory() }
    }

    /// The limit in memory, bytes.
    pub fn bytes(self) -> u64 {
        self.bytes.min(self.max_memory)
    }

    /// Checks that this many bytes exceed neither the budget nor the memory limit of the process.
    pub fn check(self, bytes: u64) -> Result<(), OverBudget> {
        match bytes {
            _ if bytes > self.bytes => Err(OverBudget::ForItsSize(self.bytes)),
            _ if bytes > self.max_memory => Err(OverBudget::InMemory(self.max_memory)),
            _ => Ok(()),
        }
    }

    /// The limit on disk, bytes, which does not depend on the memory limit of the process.
    pub fn bytes_on_disk(self) -> u64 {
        self.bytes
    }

    /// Checks that this many bytes do not exceed the limit on disk.
    pub fn check_on_disk(self, bytes: u64) -> Result<(), OverBudget> {
        Self { max_memory: u64::MAX, ..self }.check(bytes)
    }
}

/// The size limit for a file of this many bytes, whatever the memory limit of the process.
pub fn for_size(file_bytes: u64) -> u64 {
    FREE_BYTES.saturating_add(file_bytes.saturating_mul(FACTOR))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        for (text, bytes) in [("512M", 512 << 20), ("2G", 2 << 30), ("1 GiB", 1 << 30), ("268435456", 1 << 28)] {
            assert_eq!(text.parse(), Ok(Bytes(bytes)), "{text}");
        }
        for text in ["", "G", "-1G", "1.5G", "12", "63M", "1T", "99999999999999999999G", "18446744073709551615G"] {
            assert!(text.parse::<Bytes>().is_err(), "{text}");
        }
        assert_eq!(Bytes(512 << 20).to_string(), "512 MiB");
        assert_eq!(Bytes(20 << 30).to_string(), "20 GiB");
    }

    #[test]
    fn the_budget_grows_with_the_file_up_to_the_memory_limit() {
        let room = MemoryBudget { bytes: for_size(1000), max_memory: 1 << 30 };
        assert_eq!(room.check(FREE_BYTES + 256_000), Ok(()));
        assert_eq!(room.check(FREE_BYTES + 256_001), Err(OverBudget::ForItsSize(FREE_BYTES + 256_000)));
        let large = MemoryBudget { bytes: for_size(1 << 40), max_memory: 1 << 30 };
        assert_eq!((large.check((1 << 30) + 1), large.bytes()), (Err(OverBudget::InMemory(1 << 30)), 1 << 30));
        assert_eq!(large.check_on_disk(1 << 31), Ok(()));
        assert_eq!(for_size(u64::MAX), u64::MAX);
    }
}
