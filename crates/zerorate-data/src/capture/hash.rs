//! The hash that names the samples of a capture (docs/formats/capture.md, "The sample hash").

use super::chain::hex;
use adis16130::{Sample, Width};
use sha2::{Digest, Sha256};

const PREFIX: &[u8] = b"zerorate.samples.v1\n";
const ROW: usize = 26;

/// SHA-256 over the canonical encoding of samples: the same live, from a log of it, and from any form of the log.
#[derive(Clone, Debug)]
pub struct SampleHash {
    digest: Sha256,
    pending: Vec<u8>,
}

impl Default for SampleHash {
    fn default() -> Self {
        Self::new()
    }
}

impl SampleHash {
    /// The hash of no sample yet.
    pub fn new() -> Self {
        Self { digest: Sha256::new_with_prefix(PREFIX), pending: Vec::with_capacity(ROW * 512) }
    }

    /// Takes in the next sample.
    pub fn update(&mut self, sample: &Sample) {
        if self.pending.len() == self.pending.capacity() {
            self.digest.update(&self.pending);
            self.pending.clear();
        }
        self.pending.extend_from_slice(&encode(sample));
    }

    /// The hash so far.
    pub fn digest(&self) -> [u8; 32] {
        self.digest.clone().chain_update(&self.pending).finalize().into()
    }

    /// The same in lower-case hexadecimal.
    pub fn hex(&self) -> String {
        hex(&self.digest())
    }
}

fn encode(sample: &Sample) -> [u8; ROW] {
    let mut row = [0; ROW];
    row[0..8].copy_from_slice(&sample.t_ns.to_le_bytes());
    row[8..12].copy_from_slice(&sample.seq.to_le_bytes());
    row[12..16].copy_from_slice(&sample.rate.code().to_le_bytes());
    row[16..20].copy_from_slice(&sample.temp.map_or(0, |temp| temp.code()).to_le_bytes());
    row[20..24].copy_from_slice(&sample.lost.to_le_bytes());
    row[24] = sample.status.map_or(0, |status| status.bits());
    let wide = sample.rate.width() == Width::Bits24;
    row[25] = u8::from(sample.status.is_some()) | u8::from(sample.temp.is_some()) << 1 | u8::from(wide) << 2;
    row
}
