//! Tests the sampler with a simulated converter and a late host. Unless timestamps are late, it must report exactly
//! the losses that happened.

use adis16130::{Config, ConversionTime, Edge, MCLK_HZ, Sampler, SamplerConfig};

use crate::sampler::Random;

/// A data register: the number of the update that it holds, and whether this update is unread.
#[derive(Copy, Clone, Default)]
struct Channel {
    /// Number of updates so far, lost or not.
    updates: u64,
    holds: u64,
    unread: bool,
    /// The register is being read until this time, ns.
    busy_until: f64,
}

impl Channel {
    fn update(&mut self, now: f64) {
        self.updates += 1;
        if now >= self.busy_until {
            self.holds = self.updates;
            self.unread = true;
        }
    }

    /// Reads the register from `now` on for `takes` ns. Returns the number of the update that it holds.
    fn read(&mut self, now: f64, takes: f64) -> u64 {
        self.busy_until = now + takes;
        self.unread = false;
        self.holds
    }
}

/// A converter that simulates both channels in turn (F-31), RDY (F-32), and overwritten and dropped readings (F-33).
/// Times are in ns.
struct Converter {
    now: f64,
    cycles: [f64; 2],
    next: usize,
    due: f64,
    channels: [Channel; 2],
    rdyfn: bool,
    edges: u32,
    /// The newest edge that the host has not seen.
    latch: Option<Edge>,
}

impl Converter {
    fn new(config: &Config, mclk: f64) -> Self {
        let (rate, temp) = config.conversion_cycles();
        let cycles = [rate, temp].map(|cycles| f64::from(cycles) / mclk * 1e9);
        Self {
            now: 5e6,
            cycles,
            next: 0,
            due: 5e6 + cycles[0],
            channels: [Channel::default(); 2],
            rdyfn: config.rdyfn(),
            edges: u32::MAX - 1_000,
            latch: None,
        }
    }

    fn step(&mut self) {
        self.now = self.due;
        self.channels[self.next].update(self.now);
        self.next = 1 - self.next;
        self.due += self.cycles[self.next];
        let [rate, temp] = self.channels.map(|channel| channel.unread);
        if if self.rdyfn { rate && temp } else { rate || temp } {
            self.edges = self.edges.wrapping_add(1);
            self.latch = Some(Edge { t_ns: self.now as u64, seq: self.edges });
        }
    }

    fn advance(&mut self, ns: f64) {
        let end = self.now + ns;
        while self.due <= end {
            self.step();
        }
        self.now = end;
    }

    fn wait_edge(&mut self) -> Edge {
        loop {
            if let Some(edge) = self.latch.take() {
                return edge;
            }
            self.step();
        }
    }
}

/// The host's delays, ns: fixed per read, random before it, and a random pause at one edge in `pause_one_in`.
#[derive(Copy, Clone)]
struct Host {
    reads_ns: f64,
    jitter_ns: f64,
    pause_one_in: f64,
    pause_ns: f64,
    /// Largest random delay of the timestamps of edges. Timestamps are at least 0.6 of this delay apart.
    stamp_ns: f64,
}

const PROMPT: Host = Host { reads_ns: 8_000.0, jitter_ns: 5_000.0, pause_one_in: 0.0, pause_ns: 0.0, stamp_ns: 0.0 };
const SLOW: Host = Host { reads_ns: 45_000.0, jitter_ns: 30_000.0, pause_one_in: 0.0, pause_ns: 0.0, stamp_ns: 0.0 };
const PAUSING: Host =
    Host { reads_ns: 10_000.0, jitter_ns: 20_000.0, pause_one_in: 30.0, pause_ns: 700_000.0, stamp_ns: 0.0 };

/// Numbers of samples, samples that were read twice, losses that happened, and losses that were reported.
#[derive(Debug, Default)]
struct Count {
    samples: u64,
    twice: u64,
    lost: u64,
    reported: u64,
}

fn run(config: Config, sampling: SamplerConfig, host: Host, seed: u64) -> Count {
    let mut random = Random(seed);
    let mut converter = Converter::new(&config, 5.9e6 + 0.2e6 * random.uniform());
    let mut sampler = Sampler::new(sampling, &config, MCLK_HZ);
    let (mut count, mut before, mut stamp_ns) = (Count::default(), None, 0);
    for _ in 0..30_000 {
        let edge = converter.wait_edge();
        let late_ns = if host.stamp_ns > 0.0 { random.uniform() * host.stamp_ns } else { 0.0 };
        let after_last = stamp_ns + (0.6 * host.stamp_ns) as u64;
        stamp_ns = after_last.max(edge.t_ns + late_ns as u64);
        let edge = Edge { t_ns: stamp_ns, ..edge };
        converter.advance(random.uniform() * host.jitter_ns);
        if host.pause_one_in > 0.0 && random.uniform() * host.pause_one_in < 1.0 {
            converter.advance(random.uniform() * host.pause_ns);
        }
        let Some(due) = sampler.edge(edge) else { continue };
        if due.status && !converter.channels[0].unread {
            converter.advance(host.reads_ns / 2.0);
            continue;
        }
        let update = converter.channels[0].read(converter.now, host.reads_ns);
        converter.advance(host.reads_ns);
        if due.temp {
            converter.channels[1].read(converter.now, host.reads_ns);
            converter.advance(host.reads_ns);
        }
        count.reported += u64::from(sampler.taken(&due));
        count.samples += 1;
        if let Some(before) = before.replace(update) {
            count.twice += u64::from(update == before);
            count.lost += update.saturating_sub(before + 1);
        }
    }
    count
}

/// Asserts that every loss is reported, and nothing else. One loss may still be unreported at the end. Returns the
/// number of losses.
fn assert_honest(config: Config, sampling: SamplerConfig, host: Host) -> u64 {
    let mut lost = 0;
    for seed in 1..=12 {
        let count = run(config, sampling, host, seed);
        assert_eq!(count.twice, 0, "{sampling:?} {count:?}");
        assert!(
            (count.lost.saturating_sub(1)..=count.lost).contains(&count.reported),
            "seed {seed}: {count:?}, {sampling:?}, {config:?}"
        );
        lost += count.lost;
    }
    lost
}

const SAMPLINGS: [SamplerConfig; 4] = [
    SamplerConfig::new(),
    SamplerConfig::new().with_every_temp(5),
    SamplerConfig::new().with_every_temp(0),
    SamplerConfig::new().with_read_status(false),
];

/// On a busy bus, timestamps are late by up to a period, so the period cannot be learned from them. The number of
/// reported losses is then right to within 3.5 % of the samples.
#[test]
fn late_timestamps_cost_no_more_than_the_tolerance_of_the_clock() {
    for stamp_ns in [60_000.0, 120_000.0, 175_000.0] {
        let host = Host { stamp_ns, reads_ns: 60_000.0, jitter_ns: 100_000.0, ..PAUSING };
        for seed in 1..=12 {
            for sampling in SAMPLINGS {
                let count = run(Config::default(), sampling, host, seed);
                let off = count.reported.abs_diff(count.lost) as f64 / (count.samples + count.lost) as f64;
                assert!(off < 0.035, "late by {stamp_ns} ns, seed {seed}: {count:?}, {sampling:?}");
            }
        }
    }
}

#[test]
fn every_loss_is_reported_for_any_conversion_times() {
    for (rate, temp) in [(5, 5), (5, 127), (127, 5), (5, 0x85), (60, 61)] {
        let config = Config::new()
            .with_rate_conversion(ConversionTime::new(rate))
            .with_temp_conversion(ConversionTime::new(temp));
        for sampling in SAMPLINGS {
            for host in [PROMPT, SLOW, PAUSING] {
                assert_honest(config, sampling, host);
            }
        }
    }
}

#[test]
fn without_rdyfn_every_other_edge_is_stale() {
    let config = Config::new().with_rdyfn(false);
    for sampling in SAMPLINGS {
        assert_eq!(assert_honest(config, sampling, PROMPT), 0, "{sampling:?}");
        assert_honest(config, sampling, SLOW);
        assert!(assert_honest(config, sampling, PAUSING) > 1_000, "{sampling:?}");
    }
}
