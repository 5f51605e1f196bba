//! The hash that names the samples of a capture (docs/formats/capture.md, "The sample hash").

use super::layout::Layout;
use super::row::Row;
use sha2::{Digest, Sha256};
use zerorate::MAX_AXES;

/// Hash prefix for a capture with one axis and an 8-bit status.
const ONE_AXIS: &str = "zerorate.samples.v1\n";
/// Hash prefix for any other layout. The axis names follow it.
const AXES: &str = "zerorate.samples.v2 ";

/// Length of the longest encoded row, bytes.
const LONGEST: usize = 8 + 4 + 4 * MAX_AXES + 4 + 4 + 4 + 1;

/// SHA-256 over the canonical encoding of rows. A live device and its capture in any format have the same hash.
#[derive(Clone, Debug)]
pub struct SampleHash {
    digest: Sha256,
    pending: Vec<u8>,
    status_bytes: usize,
    has_24_bits: bool,
}

impl SampleHash {
    /// The hash of an empty capture.
    pub fn new(layout: &Layout) -> Self {
        let axes: Vec<&str> = layout.axes().iter().map(|axis| axis.name.as_str()).collect();
        let digest = match (&axes[..], layout.status_bits()) {
            ([_], 8) => Sha256::new_with_prefix(ONE_AXIS),
            _ => Sha256::new_with_prefix(format!("{AXES}{}\n", axes.join(","))),
        };
        Self {
            digest,
            pending: Vec::with_capacity(LONGEST * 256),
            status_bytes: usize::from(layout.status_bits() / 8),
            has_24_bits: layout.axes().first().is_some_and(|axis| axis.scale.width_bits == 24),
        }
    }

    /// Adds the next row.
    #[inline]
    pub fn update(&mut self, row: &Row) {
        if self.pending.len() + LONGEST > self.pending.capacity() {
            self.digest.update(&self.pending);
            self.pending.clear();
        }
        self.encode(row);
    }

    /// The hash so far.
    pub fn digest(&self) -> [u8; 32] {
        self.digest.clone().chain_update(&self.pending).finalize().into()
    }

    /// The digest in lower-case hexadecimal.
    pub fn hex(&self) -> String {
        hex(&self.digest())
    }

    #[inline]
    fn encode(&mut self, row: &Row) {
        let row_bytes = &mut self.pending;
        row_bytes.extend_from_slice(&row.t_ns.to_le_bytes());
        row_bytes.extend_from_slice(&row.edge_seq.to_le_bytes());
        row.codes().iter().for_each(|code| row_bytes.extend_from_slice(&low_bytes(*code)));
        row_bytes.extend_from_slice(&low_bytes(row.temp_code.unwrap_or(0)));
        row_bytes.extend_from_slice(&row.lost.to_le_bytes());
        row_bytes.extend_from_slice(&row.status.unwrap_or(0).to_le_bytes()[..self.status_bytes]);
        let present = u8::from(row.status.is_some()) | u8::from(row.temp_code.is_some()) << 1;
        row_bytes.push(present | u8::from(self.has_24_bits) << 2);
    }
}

/// The low 32 bits of a code, as in its column: u32, or i32 in two's complement.
fn low_bytes(code: i64) -> [u8; 4] {
    (code as u32).to_le_bytes()
}

pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
