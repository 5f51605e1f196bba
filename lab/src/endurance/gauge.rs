//! Measures memory and file descriptors of a process over time.

use crate::residuals::median;
use crate::server::{descriptors, memory_mb};
use anyhow::{Result, ensure};

/// Ignored growth from the second quarter of a run to the last, MB. Buffers of visitors that come and go need it.
const FLAT_MB: f64 = 4.0;
/// Size of the hub's queue, MB: 16 batches of 4096 samples. The queue fills when a busy machine delays its reader.
const QUEUE_MB: f64 = 6.8;

/// Measurements of a process at equal intervals.
#[derive(Debug, Default)]
pub struct Gauge {
    resident_mb: Vec<f64>,
    descriptors: Vec<usize>,
}

impl Gauge {
    pub fn read(&mut self, process: u32) -> Result<()> {
        self.resident_mb.push(memory_mb(process, "VmRSS:")?);
        self.descriptors.push(descriptors(process)?);
        Ok(())
    }

    pub fn most_descriptors(&self) -> usize {
        self.descriptors.iter().copied().max().unwrap_or(0)
    }

    /// Medians of the second and of the last quarter, MB. The first quarter is ignored, because buffers fill then.
    fn quarters_mb(&self) -> [f64; 2] {
        let quarter = self.resident_mb.len() / 4;
        [quarter..2 * quarter, 3 * quarter..self.resident_mb.len()].map(|part| median(self.resident_mb[part].to_vec()))
    }

    pub fn memory(&self) -> String {
        let ([early, late], count) = (self.quarters_mb(), self.resident_mb.len());
        let most = self.resident_mb.iter().copied().fold(0.0, f64::max);
        format!(
            "{early:.1} MB in the second quarter, {late:.1} MB in the last, {most:.1} MB at most, {count} readings"
        )
    }

    /// Returns an error if the memory grows by more than the allowances plus `kept_mb`, the size of the data that the
    /// server keeps on purpose.
    pub fn check(&self, kept_mb: f64) -> Result<()> {
        let [early, late] = self.quarters_mb();
        let bound = FLAT_MB + QUEUE_MB + kept_mb;
        ensure!(late - early <= bound, "the memory grows from {early:.1} to {late:.1} MB, by more than {bound:.1} MB");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leak_is_told_from_a_warm_up() {
        let gauge = |mb: &dyn Fn(f64) -> f64| Gauge {
            resident_mb: (0..400).map(|second| mb(f64::from(second))).collect(),
            descriptors: vec![],
        };
        assert!(gauge(&|second| 30.0 + second * 0.06).check(0.0).is_err());
        assert!(gauge(&|second| 30.0 + second * 0.06).check(3.0).is_ok());
        assert!(gauge(&|second| 30.0 + (second * 0.5).min(20.0)).check(0.0).is_ok());
        assert!(gauge(&|second| 30.0 + (second % 7.0)).check(0.0).is_ok());
        assert!(Gauge::default().check(0.0).is_err(), "nothing was read");
    }
}
