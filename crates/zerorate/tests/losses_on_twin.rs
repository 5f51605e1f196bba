//! The losses that the sampler counts, against the losses that the part knows, on hosts that stop at any moment.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, Framing, MCLK_HZ, Sampler, SamplerConfig};
use adis16130_twin::{Spec, Twin, TwinSpi};
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use std::cell::RefCell;
use std::convert::Infallible;
use std::ops::RangeInclusive;
use std::rc::Rc;

/// Two conversions of 527 cycles of 6.000 MHz (F-31), in ns.
const PERIOD_NS: f64 = 175_667.0;
const SAMPLES: usize = 3_000;
/// COM byte of a read of RATE DATA (F-24).
const READ_RATE: u8 = 0x48;

/// A small generator (PCG), so that the tests need no crate and repeat.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / 2_f64.powi(31)
    }

    fn exponential(&mut self, mean: f64) -> f64 {
        -mean * (1.0 - self.uniform()).ln()
    }
}

/// The habits of a host, in periods of the part.
#[derive(Clone, Copy, Debug)]
struct Habits {
    /// From one stop to the next, on average.
    between_stops: f64,
    longest_stop: f64,
    /// Mean delay of its timestamps, in ns, beside the rest of a stop, as for edges that come over USB. Without it
    /// they are the times of the edges.
    late_stamps_ns: Option<f64>,
    every_temp: u16,
}

/// The stops of the host, from and to, in ns, drawn as far as they are needed.
struct Stops {
    habits: Habits,
    random: Random,
    stops: Vec<(u64, u64)>,
}

impl Stops {
    /// The end of the stop in which this moment lies.
    fn end_of(&mut self, t_ns: u64) -> Option<u64> {
        while self.stops.last().is_none_or(|(_, to)| *to <= t_ns) {
            let before = self.stops.last().map_or(0, |(_, to)| *to);
            let from = before + self.random.exponential(self.habits.between_stops * PERIOD_NS) as u64;
            let to = from + (self.random.uniform() * self.habits.longest_stop * PERIOD_NS) as u64 + 1;
            self.stops.push((from, to));
        }
        let next = self.stops.partition_point(|(_, to)| *to <= t_ns);
        self.stops.get(next).filter(|(from, _)| *from <= t_ns).map(|(_, to)| *to)
    }
}

/// The host, with its view of the part's wires.
struct Host {
    twin: Twin,
    stops: RefCell<Stops>,
    /// Rates that were lost until the last read of one.
    known: RefCell<u64>,
}

impl Host {
    /// Before it does anything it may have stopped.
    fn act(&self) {
        let now_ns = self.twin.now_ns();
        if let Some(end_ns) = self.stops.borrow_mut().end_of(now_ns) {
            self.twin.advance_ns(end_ns - now_ns);
        }
    }
}

struct Bus(TwinSpi, Rc<Host>);

impl ErrorType for Bus {
    type Error = Infallible;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let reads_rate = matches!(&operations[0], Operation::TransferInPlace(bytes) if bytes[0] == READ_RATE);
        self.1.act();
        let before = self.1.twin.lost_unread().rate;
        self.0.transaction(operations)?;
        if reads_rate {
            // samples dropped during the read are lost after it (F-33)
            *self.1.known.borrow_mut() = self.1.twin.lost_unread().rate.overwritten + before.lost_new;
        }
        Ok(())
    }
}

/// The losses after each sample: as counted since the first one, and as the part knows them.
fn run(seed: u64, habits: Habits) -> Vec<(i64, i64)> {
    let twin = Twin::new(Spec { noise: false, ..Spec::from_seed(seed) });
    let stops = Stops { habits, random: Random(seed), stops: Vec::new() };
    let host = Rc::new(Host { twin: twin.clone(), stops: RefCell::new(stops), known: RefCell::new(0) });
    let config = Config::new().with_framing(Framing::Command);
    let mut gyro = Adis16130::new(Bus(twin.spi(), host.clone()), (), config);
    let mut sampler = Sampler::new(SamplerConfig::new().with_every_temp(habits.every_temp), &config, MCLK_HZ);
    gyro.init().expect("the twin answers");
    let mut random = Random(!seed);
    // late from the start
    twin.advance_ns((random.uniform() * 5.0 * PERIOD_NS) as u64);
    let (mut counts, mut counted, mut first, mut stamp_ns) = (Vec::new(), 0, None, 0);
    while counts.len() < SAMPLES {
        host.act();
        let edge = twin.next_falling_edge(1_000_000_000).expect("data ready");
        host.act();
        stamp_ns = match habits.late_stamps_ns {
            None => edge.t_ns,
            Some(mean_ns) => {
                let seen_ns = host.stops.borrow_mut().end_of(edge.t_ns).unwrap_or(edge.t_ns);
                (seen_ns + random.exponential(mean_ns) as u64).max(stamp_ns + 1)
            }
        };
        let sample = gyro.sample(&mut sampler, Edge { t_ns: stamp_ns, seq: edge.seq }).expect("a reading");
        if let Some(sample) = sample {
            let known = *host.known.borrow() as i64;
            counted += if counts.is_empty() { 0 } else { i64::from(sample.lost) };
            counts.push((counted, known - *first.get_or_insert(known)));
        }
    }
    counts
}

/// Difference between the counted losses and the known ones at the end.
fn surplus(counts: &[(i64, i64)]) -> i64 {
    counts.last().map_or(0, |(counted, known)| counted - known)
}

/// From one stop to the next, and the longest of them, in periods.
const STOPS: [(f64, f64); 5] = [(1e9, 1.0), (300.0, 1.0), (100.0, 5.0), (20.0, 5.0), (5.0, 3.0)];

#[test]
fn with_true_timestamps_every_loss_is_counted_and_nothing_else() {
    let mut lost = 0;
    for (between_stops, longest_stop) in STOPS {
        for every_temp in [1, 4] {
            let habits = Habits { between_stops, longest_stop, late_stamps_ns: None, every_temp };
            for seed in 0..60 {
                let counts = run(seed, habits);
                lost += counts[SAMPLES - 1].1;
                assert!(counts.iter().all(|(counted, known)| counted <= known), "{habits:?}, seed {seed}: too many");
                let mut later = counts.iter().zip(&counts[5..]);
                assert!(later.all(|(then, now)| now.0 >= then.1), "{habits:?}, seed {seed}: too few");
            }
        }
    }
    assert!(lost > 30_000, "{lost} in all");
}

#[test]
fn with_late_timestamps_the_count_is_off_by_little() {
    let bounds: [RangeInclusive<i64>; 5] = [-1..=1, -2..=2, -2..=2, -18..=18, -40..=40];
    for ((between_stops, longest_stop), bound) in STOPS.into_iter().zip(bounds) {
        for every_temp in [1, 4] {
            for late_ns in [2_000.0, 15_000.0] {
                let habits = Habits { between_stops, longest_stop, late_stamps_ns: Some(late_ns), every_temp };
                let surplus: Vec<i64> = (0..60).map(|seed| surplus(&run(seed, habits))).collect();
                assert!(surplus.iter().all(|surplus| bound.contains(surplus)), "{habits:?}: {surplus:?}");
            }
        }
    }
}
