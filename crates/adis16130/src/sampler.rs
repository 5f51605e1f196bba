//! Decides at each edge of RDY which registers to read, and counts lost samples. Uses neither a bus nor a clock.

use crate::config::{Channels, Config};
use crate::quotient::quotient;
use crate::sample::Edge;
use crate::timeline::{EdgeGrid, Pattern, Timeline};

/// The configuration of a [`Sampler`].
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SamplerConfig {
    /// Read the temperature with every n-th sample (F-55): 1 = with each sample, 0 = never.
    pub every_temp: u16,
    /// Read on every n-th edge of RDY (F-56). 0 counts as 1. With both channels and RDYFN = 1, reading both on every
    /// N-th edge gives f_conv/(N + 1), since the first edge after a read of both comes two conversions later.
    pub divider: u16,
    /// Number n of a counter in the RDY line that lets every n-th edge through to the host (F-56). 1 = no counter, and
    /// 0 counts as 1. [`divider`](Self::divider) counts the edges that the counter lets through.
    #[cfg_attr(feature = "serde", serde(default = "undivided"))]
    pub divided: u16,
    /// Read the status of the rate channel with every sample. `false` has an effect only with both channels, RDYFN = 1
    /// and no counter in the line. Even then the status is read if an edge is doubtful. Set `true` if the line may
    /// lose edges, or if other calls read the data registers between samples. Otherwise an edge at the expected time
    /// may give the previous sample again.
    pub read_status: bool,
}

impl Default for SamplerConfig {
    fn default() -> Self {
        Self::new()
    }
}

impl SamplerConfig {
    /// The default: rate, temperature and status at each edge.
    pub const fn new() -> Self {
        Self { every_temp: 1, divider: 1, divided: 1, read_status: true }
    }

    /// Sets [`every_temp`](Self::every_temp): the temperature is read with every n-th sample.
    pub const fn with_every_temp(mut self, samples: u16) -> Self {
        self.every_temp = samples;
        self
    }

    /// Sets the divider: after a reading, the next one is due at the `edges`-th edge.
    pub const fn with_divider(mut self, edges: u16) -> Self {
        self.divider = edges;
        self
    }

    /// Sets the number of edges of RDY that a counter in the line merges into one.
    pub const fn with_divided(mut self, edges: u16) -> Self {
        self.divided = edges;
        self
    }

    /// Sets whether the status is read with every sample.
    pub const fn with_read_status(mut self, on: bool) -> Self {
        self.read_status = on;
        self
    }
}

#[cfg(feature = "serde")]
const fn undivided() -> u16 {
    1
}

/// The registers to read at an edge, in this order: status, rate, temperature. The rate is always due.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Due {
    /// Whether to read the status of the rate channel first. Without unread data, the edge was stale: read no further.
    pub status: bool,
    /// Whether to read the temperature last.
    pub temp: bool,
    edge: Edge,
    /// Number of ticks of the timeline since the tick of the sample before.
    ticks: i32,
    /// Number of samples without temperature in a row before this one.
    rates_only: u8,
    /// Whether this edge can only announce a rate update.
    is_rate: bool,
}

/// Number of samples whose status is read from a doubtful edge on. Within this number, a late host can catch up.
const SUSPICIOUS_SAMPLES: u8 = 8;

/// Number of periods without an edge, or of intervals between divided edges, after which the part counts as silent. It
/// is several times the longest gap of a working part, which comes from a dropped reading (F-33), a few missed edges
/// and the tolerance of MCLK.
const SILENT_PERIODS: u32 = 64;

/// Largest number of ticks by which samples may be counted ahead of their edges, after edges with late timestamps.
const MAX_AHEAD: i32 = 3;

/// After this many samples without temperature, with no edge missed, the next edge announces a rate update. At the
/// edge of the second sample the temperature was unread (F-32), and it has not been read since.
const RATES_ONLY: u8 = 2;

/// Number of readings in a row that may fail or find nothing new. A pause follows each further one.
const PATIENT_READINGS: u8 = 16;

/// Binary logarithm of the longest pause in edges. 2¹⁰ edges take a tenth of a second with F-30 while nothing is read.
const LONGEST_PAUSE_LOG2: u8 = 10;

#[derive(Copy, Clone, Debug)]
struct LastSample {
    /// Time, in ns modulo 2³², and number of the sample's edge.
    t_ns: u32,
    seq: u32,
    first: bool,
}

/// Decides at each edge which registers to read, and counts the lost rate samples.
///
/// Call [`edge`](Self::edge) with every edge seen. If it returns a [`Due`], read these registers. Call
/// [`taken`](Self::taken) if, and only if, the reading succeeded and was not stale: it returns how many samples were
/// lost since the previous one. Call [`stale`](Self::stale) if the reading was stale.
///
/// # Example
///
/// A loop that recovers from a brown-out, which stops the edges: it notices the silence, then resets and initialises.
///
/// ```
/// use adis16130::{Config, Edge, Error, MCLK_HZ, Sampler, SamplerConfig, blocking::Adis16130};
/// use adis16130_twin::{Spec, Twin};
///
/// let twin = Twin::new(Spec::from_seed(1)); // on a board: the bus, the pin, and a timer that captures its edges
/// let config = Config::new();
/// let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), config);
/// let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
/// gyro.restart()?;
/// let (mut samples, mut lost, mut restarts) = (0, 0, 0);
/// while samples < 200 {
///     if samples == 100 && restarts == 0 {
///         twin.power_off();
///         twin.power_on();
///     }
///     if let Some(edge) = twin.next_falling_edge(1_000_000) {
///         if let Some(sample) = gyro.sample(&mut sampler, Edge { t_ns: edge.t_ns, seq: edge.seq })? {
///             samples += 1;
///             lost += sample.lost;
///         }
///     } else if sampler.silent_since(twin.now_ns()).is_some() {
///         gyro.restart()?;
///         sampler.restarted();
///         restarts += 1;
///     }
/// }
/// assert!(restarts == 1 && lost > 50, "{restarts} {lost}"); // at least 11.2 ms of silence
/// # Ok::<(), Error<_>>(())
/// ```
///
/// # How losses are counted
///
/// The part raises no flag when it overwrites a reading, or when a reading that arrives during a read is dropped
/// (F-33). But conversions run evenly, so the learned period gives each edge the number of the rate update before it.
/// The difference between the numbers of two successive samples shows how many are missing. So a dropped reading
/// (doubled interval), an overwritten one, missed edges and failed reads are all found by the same rule, once each. A
/// stale edge counts neither as a sample nor as a loss.
///
/// With both channels and RDYFN = 1 an edge announces a rate update or a temperature update, and the edges change from
/// one kind to the other when the host is late. The sampler detects such a change from the times alone. Whether a
/// change loses a sample depends on the kind of the first edge, which is unknown if the host was late from the start.
/// So at the first change the sampler leaves two temperatures out. After two samples without temperature the next edge
/// can only announce a rate update, and the kinds are known. A loss that depends on the kind is therefore reported two
/// samples late.
///
/// With a divider above 1 a loss is a reading that was due and not taken. Their number is the gap divided by the
/// nominal distance of the readings, rounded, less one. That distance is N + 1 conversions with both channels and
/// RDYFN = 1, and N otherwise.
///
/// Edges that a counter has divided by D come D + 1 or D conversions apart. So a missing edge is found by the same
/// rule with N = D, or D times the divider. The edges that the counter keeps back do not count as losses. The distance
/// between edges is learned as the mean of the gaps.
///
/// # Assumptions
///
/// * `t_ns` runs evenly. A jitter of `t_ns` of up to a twelfth of the period (15 µs with F-30, standard deviation)
///   costs at most one loss too many or too few in all. Up to a ninth (20 µs) costs three in 20 000 samples. Both were
///   measured with 200 seeds and the clock off by ±2 %. With jitter, a loss may be reported one or a few samples late.
/// * A host may stop at any moment, for several periods. As long as the timestamps are the times of the edges, every
///   reported loss is real, and each loss is reported within five samples. Timestamps may be late, too, as over USB.
///   Then one stop in 100 periods costs at most two losses too many or too few in all, and one in 20 periods 0.6 % of
///   the samples (measured, 60 seeds of 3000 samples each, stops of up to 5 periods). From timestamps that are late by
///   up to a whole period, nothing can be learned. Then the nominal period holds, and the number of losses is right to
///   within 3.5 % of all samples (measured).
/// * `seq` differs for different edges. If `t_ns` stands still or runs backwards, losses are counted from `seq`: one
///   for every two missed edges with both channels (too many with RDYFN = 0), one for each missed edge otherwise.
/// * MCLK is within 6 % of the nominal one (the part: 2 %), and changes slowly. The period is learned from the first
///   edges on, to some 10⁻⁶ after a second.
/// * The kind of the first edge is guessed. With RDYFN = 0, or if rate and temperature take different times, a host
///   that was late from the start may count one loss too many or too few in all. The same error is possible before the
///   period is learned, if the host stops for some periods and MCLK is more than 1 % off.
/// * After a gap of more than 4096 periods (fewer until the period is learned) the phase starts anew, and the gap is
///   divided by the learned period. A gap above 19.5 h counts as 19.5 h. Without a sample, at most 2³¹ periods are
///   counted (4.4 days with F-30).
/// * With `read_status` off, the status is due for some samples after an edge that comes too early for new data, or
///   after missed edges. So a late host gets no sample twice. With one channel, with RDYFN = 0 or with a counter in
///   the line, only the status shows whether the data is new, so the status is always due.
/// * After a failed read the next edge is due again, with any divider.
///
/// # When nothing comes
///
/// A brown-out stops the edges, so a loop that waits for the next edge needs a time-out. Call
/// [`silent_since`](Self::silent_since) with the time now, or wait at most [`silence_ns`](Self::silence_ns).
///
/// If edges come but readings fail (a dead SDO), the sampler pauses. From the 17th reading in a row that was due
/// and not [`taken`](Self::taken), the sampler skips one edge before the next reading, then two, four, and so on, at
/// most 1024. So a loop that initialises the part after each failure does so 11 times a second and not 11 400 times.
/// The first reading that is taken ends the pauses, and its `lost` counts the samples lost in them.
#[derive(Clone, Debug)]
pub struct Sampler {
    rules: Rules,
    timeline: Timeline,
    taken: Option<LastSample>,
    until_temp: u16,
    /// Number of samples without temperature in a row, with no edge missed between them.
    rates_only: u8,
    /// Whether temperatures are left out until it is known which edges announce rate updates.
    seeks_rate: bool,
    suspicious: u8,
    /// Number of readings that were due since the last one taken.
    untaken: u8,
    /// Number of edges to skip before the next reading is due.
    pause: u16,
    /// Time of the last edge since the (re)start. Without one, time of the first call of `silent_since`.
    heard_ns: Option<u64>,
}

/// The rules that follow from the values of [`SamplerConfig`] and [`Config`], computed once.
#[derive(Clone, Debug)]
struct Rules {
    /// [`SamplerConfig::every_temp`], or 0 if the temperature is not converted.
    every_temp: u16,
    divider: u16,
    read_status: bool,
    reads_rate: bool,
    /// Whether edges keep to one kind of update, rate or temperature, so that the sampler can find out the kind.
    steady: bool,
    /// An edge that comes sooner than this after the edge of the previous sample cannot announce new data. Times are
    /// compared modulo 2³² ns, so a late edge may look early. That costs only reads of the status.
    early_ns: u32,
    /// Number of conversions from one reading that is due to the next.
    conversions: u32,
    conversions_per_period: u8,
    /// Whether the timeline counts edges that a counter lets through, and not periods.
    counts_edges: bool,
}

impl Rules {
    fn new(sampling: SamplerConfig, config: &Config, mclk_hz: u32) -> (Self, EdgeGrid) {
        let both = matches!(config.channels(), Channels::Both);
        // after a read of both channels, the next edge comes two conversions later
        let pairs = both && config.rdyfn();
        let (divider, divided) = (sampling.divider.max(1), sampling.divided.max(1));
        let counts_edges = divided > 1;
        let steady = pairs && divider == 1 && !counts_edges;
        let conversions = (u32::from(divider) * u32::from(divided)).saturating_add(pairs.into());
        let conversions_per_period = if both { 2 } else { 1 };
        let pattern = match (pairs, steady) {
            (_, true) => Pattern::Steady,
            (true, false) => Pattern::Mixed,
            (false, false) => Pattern::Each,
        };
        let mut grid = EdgeGrid::new(config.conversion_cycles(), mclk_hz, pattern);
        if counts_edges {
            grid = grid.divided(conversions, u32::from(divider) * u32::from(conversions_per_period));
        }
        let rules = Self {
            every_temp: if both { sampling.every_temp } else { 0 },
            divider,
            read_status: sampling.read_status || !pairs || counts_edges,
            reads_rate: !matches!(config.channels(), Channels::Temp),
            steady,
            early_ns: u32::try_from(grid.unread_ns(divider.into())).unwrap_or(u32::MAX),
            conversions,
            conversions_per_period,
            counts_edges,
        };
        (rules, grid)
    }

    /// Returns the readings lost if `ticks` have passed since the previous sample, and the advance of the count.
    ///
    /// Without a divider, the count advances by one even if `ticks` is 0 or negative: the late timestamp of an earlier
    /// edge has counted one tick too many. The count is at most [`MAX_AHEAD`] ticks ahead, so that no loss stays
    /// hidden.
    fn lost_in(&self, ticks: i32) -> (u32, i32) {
        if self.divider > 1 {
            (self.readings_in(ticks).saturating_sub(1), ticks)
        } else if ticks > 0 {
            (ticks as u32 - 1, ticks)
        } else {
            (0, 1.min(ticks + MAX_AHEAD))
        }
    }

    /// Returns the number of readings that are due in this many ticks of the timeline.
    fn readings_in(&self, ticks: i32) -> u32 {
        let (per_tick, step) =
            if self.counts_edges { (1, self.divider.into()) } else { (self.conversions_per_period, self.conversions) };
        let (passed, step) = (u64::from(per_tick) * ticks.max(0) as u64, u64::from(step));
        quotient(2 * passed + step, 2 * step) as u32
    }
}

impl Sampler {
    /// Makes a sampler for a part that runs with `config`. `mclk_hz` is the nominal master clock: [`crate::MCLK_HZ`],
    /// unless a better value is known.
    pub fn new(sampling: SamplerConfig, config: &Config, mclk_hz: u32) -> Self {
        let (rules, grid) = Rules::new(sampling, config, mclk_hz);
        Self {
            rules,
            timeline: Timeline::new(grid),
            taken: None,
            until_temp: 0,
            suspicious: 0,
            rates_only: 0,
            seeks_rate: false,
            untaken: 0,
            pause: 0,
            heard_ns: None,
        }
    }

    /// Takes an edge and returns the registers to read now. `None` if nothing is due.
    #[inline]
    pub fn edge(&mut self, edge: Edge) -> Option<Due> {
        self.heard_ns = Some(edge.t_ns);
        let ticks = self.timeline.advance(edge)?;
        let mut status = self.rules.read_status;
        let rates_only = core::mem::take(&mut self.rates_only);
        let mut is_rate = rates_only >= RATES_ONLY;
        if let Some(taken) = &self.taken {
            let edges = edge.seq.wrapping_sub(taken.seq);
            let divider = u32::from(self.rules.divider);
            if edges < divider {
                return None;
            }
            let early = (edge.t_ns as u32).wrapping_sub(taken.t_ns) < self.rules.early_ns;
            if edges != divider || early || ticks <= 0 {
                self.suspicious = SUSPICIOUS_SAMPLES;
            }
            is_rate &= edges == 1;
        }
        if self.pause > 0 {
            self.pause -= 1;
            return None;
        }
        self.pause = self.pause_after_failure();
        status |= self.suspicious > 0;
        let due = Due { status, temp: self.temp_is_due(is_rate), edge, ticks, rates_only, is_rate };
        self.rules.reads_rate.then_some(due)
    }

    /// Notes that the due reading has been taken. Returns the number of rate samples lost since the previous reading.
    #[inline]
    pub fn taken(&mut self, due: &Due) -> u32 {
        self.suspicious = self.suspicious.saturating_sub(1);
        self.untaken = 0;
        self.pause = 0;
        let mut ticks = due.ticks;
        if self.rules.steady {
            if due.is_rate {
                ticks = ticks.saturating_add(self.timeline.align().into());
            }
            self.rates_only = if due.temp { 0 } else { due.rates_only.saturating_add(1) };
        }
        self.until_temp = if due.temp { self.rules.every_temp } else { self.until_temp }.saturating_sub(1);
        let first = self.taken.is_none();
        self.taken = Some(LastSample { t_ns: due.edge.t_ns as u32, seq: due.edge.seq, first });
        let (lost, goes_by) =
            if first { (0, ticks.saturating_add(self.timeline.anchor().into())) } else { self.rules.lost_in(ticks) };
        self.timeline.count_from(goes_by);
        lost
    }

    /// Notes that the due reading was not new: the status shows that the previous reading took the data. If the
    /// previous reading was the first one, it was late. The samples that it missed were lost before it, and are not
    /// counted.
    pub fn stale(&mut self) {
        if self.taken.is_some_and(|taken| taken.first) {
            self.timeline.begin();
        }
    }

    /// Notes that the part has been initialised anew, so that its conversions have another phase. The samples that
    /// were lost in the gap are counted at the next sample, to within one. Discard the edges from before the
    /// initialisation. If one is passed to [`edge`](Self::edge) later, the count is right to within two.
    pub fn restarted(&mut self) {
        self.timeline.restart();
        self.heard_ns = None;
    }

    /// Returns the time of the last edge if the part has been silent since. `None` until `now_ns` (of the clock of
    /// [`Edge::t_ns`]) is more than [`silence_ns`](Self::silence_ns) after that edge. A silent part has lost its
    /// supply or its configuration, or RDY is cut.
    ///
    /// Before the first edge, and after [`restarted`](Self::restarted), the time counts from the first call on. The
    /// clock may wrap, and `now_ns` may be older than the last edge. Pass all edges that are still queued to
    /// [`edge`](Self::edge) before this call.
    pub fn silent_since(&mut self, now_ns: u64) -> Option<u64> {
        let heard_ns = *self.heard_ns.get_or_insert(now_ns);
        let silence_ns = now_ns.wrapping_sub(heard_ns) as i64;
        (silence_ns > self.silence_ns() as i64).then_some(heard_ns)
    }

    /// The time without an edge that counts as silence, in ns: 64 periods of the rate, 11.2 ms with F-30, or 64
    /// intervals of divided edges.
    pub fn silence_ns(&self) -> u64 {
        self.timeline.eighths_of_period_ns(8 * SILENT_PERIODS)
    }

    /// The learned time from one rate update to the next, in ns.
    pub fn rate_period_ns(&self) -> f64 {
        let Rules { divider, conversions, conversions_per_period, counts_edges, .. } = self.rules;
        let tick_ns = self.timeline.period_ns();
        if counts_edges {
            tick_ns * f64::from(u32::from(divider) * u32::from(conversions_per_period)) / f64::from(conversions)
        } else {
            tick_ns
        }
    }

    /// Whether to read the temperature now. It waits while the sampler must find out which edges announce rate
    /// updates.
    fn temp_is_due(&mut self, is_rate: bool) -> bool {
        if self.rules.steady {
            self.seeks_rate |= self.timeline.is_ambiguous();
            self.seeks_rate &= !is_rate && !self.timeline.is_aligned();
        }
        self.until_temp == 0 && self.rules.every_temp > 0 && !self.seeks_rate
    }

    /// Returns the number of edges to skip after the reading that is due now, unless it is taken.
    fn pause_after_failure(&mut self) -> u16 {
        let failed_before = self.untaken;
        self.untaken = failed_before.saturating_add(1);
        match failed_before.checked_sub(PATIENT_READINGS) {
            None => 0,
            Some(doublings) => 1 << doublings.min(LONGEST_PAUSE_LOG2),
        }
    }
}
