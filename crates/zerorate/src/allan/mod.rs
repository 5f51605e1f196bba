//! Allan deviation and its relatives: how much the mean over τ moves from one stretch to the next.

mod input;
mod kernels;
mod stat;

pub use input::{Gap, Input};
pub use kernels::{Deviation, Reason, deviations};
pub use stat::{Stat, UnknownStat};

/// Averages of 1, 2, 4 … samples, as long as at least one difference of two adjacent averages fits into `len` samples.
pub fn octaves(len: usize) -> alloc::vec::Vec<u64> {
    let longest = len as u64 / 2;
    core::iter::successors(Some(1u64), |m| m.checked_mul(2)).take_while(|m| *m <= longest).collect()
}
