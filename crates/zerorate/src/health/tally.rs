//! Counts samples, losses, and edges of data ready.

use crate::notice::Refusal;
use crate::part::Reading;
use crate::plan::State;

/// Counts of samples, lost samples and edges of data ready, with their rates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rate samples read.
    pub samples: u64,
    /// Rate samples lost.
    pub lost: u64,
    /// Number of gaps, in each of which samples were lost.
    pub gaps: u64,
    /// Gaps in which two or more samples were lost, although no further edge of data ready was counted.
    pub silent_gaps: u64,
    temps: u64,
    edges: u64,
    least_edges: u32,
    first_ns: u64,
    last_ns: u64,
    last_seq: u32,
    longest_gap_ns: u64,
}

impl Tally {
    /// Counts a reading, and the samples that were lost before it.
    #[inline]
    pub fn count(&mut self, reading: &Reading) {
        if self.samples == 0 {
            self.first_ns = reading.t_ns;
        } else {
            let edges = reading.seq.wrapping_sub(self.last_seq);
            self.edges += u64::from(edges);
            self.note_gap(reading.lost, edges);
            let gap_ns = reading.t_ns.saturating_sub(self.last_ns);
            self.longest_gap_ns = self.longest_gap_ns.max(gap_ns);
        }
        (self.last_seq, self.last_ns) = (reading.seq, reading.t_ns);
        self.samples += 1;
        self.temps += u64::from(reading.temp.is_some());
        self.lost += u64::from(reading.lost);
    }

    /// Counts a gap if samples were lost. A late host still counts the edges, and a slow one loses single samples
    /// (F-33). A gap is silent if two or more samples were lost and no further edge was counted.
    #[inline]
    fn note_gap(&mut self, lost: u32, edges: u32) {
        if self.least_edges == 0 || edges < self.least_edges {
            self.least_edges = edges;
        }
        if lost > 0 {
            self.gaps += 1;
            self.silent_gaps += u64::from(lost > 1 && edges <= self.least_edges);
        }
    }

    /// Whether losses come from a silent data-ready line rather than from a late host: at least a quarter of the gaps
    /// were silent.
    #[must_use]
    pub fn data_ready_stutters(&self) -> bool {
        self.silent_gaps > 0 && 4 * self.silent_gaps >= self.gaps
    }

    /// Whether no sample came with a temperature.
    #[must_use]
    #[inline]
    pub fn lacks_temperature(&self) -> bool {
        self.temps == 0
    }

    /// Whether the host uses the wrong edge of data ready: the edge before new data (F-32). The host then counts two
    /// edges to a sample, one of each channel, and never finds a new temperature.
    #[must_use]
    pub fn hears_wrong_edge(&self) -> bool {
        let counted = (self.samples + self.lost).saturating_sub(1) as f64;
        self.lacks_temperature() && counted > 0.0 && (self.edges as f64 / counted - 2.0).abs() < 0.1
    }

    pub(crate) fn no_temperature(&self, window: State) -> Refusal {
        Refusal::NoTemperature { window, wrong_edge: self.hears_wrong_edge() }
    }

    /// Samples per second as the part gave them, lost ones included.
    #[must_use]
    pub fn sampling_hz(&self) -> f64 {
        self.per_second((self.samples + self.lost).saturating_sub(1))
    }

    /// Time from the first sample to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.last_ns.saturating_sub(self.first_ns) as f64 * 1e-9
    }

    /// Rate samples read per second.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.per_second(self.samples.saturating_sub(1))
    }

    /// Edges of data ready per second (F-32).
    #[must_use]
    pub fn rdy_hz(&self) -> f64 {
        self.per_second(self.edges)
    }

    /// Longest time between successive samples, ms.
    #[must_use]
    pub fn longest_gap_ms(&self) -> f64 {
        self.longest_gap_ns as f64 * 1e-6
    }

    fn per_second(&self, count: u64) -> f64 {
        let duration_s = self.duration_s();
        if duration_s > 0.0 { count as f64 / duration_s } else { 0.0 }
    }
}
