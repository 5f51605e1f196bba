//! Tests the sampler on synthetic edges: which readings are due, and which are lost.

use adis16130::{Channels, Config, Due, Edge, MCLK_HZ, Sampler, SamplerConfig};

/// Time of a conversion of rate and of temperature, 527 cycles each at 6.000 MHz, in ns: 175.67 µs (F-31).
const PAIR_NS: f64 = 2.0 * 527.0 / 6e6 * 1e9;

/// A linear congruential generator, so that the tests need no crate and repeat.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / 2_f64.powi(31)
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

fn sampler(sampling: SamplerConfig) -> Sampler {
    Sampler::new(sampling, &Config::default(), MCLK_HZ)
}

fn at(periods: f64, seq: u32) -> Edge {
    Edge { t_ns: 1_000_000_000 + (periods * PAIR_NS) as u64, seq }
}

/// Passes an edge, and takes the readings that are due. Returns the losses, or `None` if nothing was due.
fn take(sampler: &mut Sampler, edge: Edge) -> Option<u32> {
    let due = sampler.edge(edge)?;
    Some(sampler.taken(&due))
}

/// Takes edges at these times, in periods, numbered without gaps from the first. Returns the losses.
fn losses(sampler: &mut Sampler, periods: impl IntoIterator<Item = f64>) -> Vec<u32> {
    let edges = (0..).zip(periods);
    edges.filter_map(|(seq, periods)| take(sampler, at(periods, seq))).collect()
}

fn ramp(n: u32) -> impl Iterator<Item = f64> {
    (0..n).map(f64::from)
}

#[test]
fn a_doubled_interval_is_one_lost_sample() {
    // F-33: the part drops the new reading without an edge, so `seq` does not show the loss.
    for k in [2, 3, 10, 1_000] {
        let times = ramp(k).chain((k + 1..k + 20).map(f64::from));
        let lost = losses(&mut sampler(SamplerConfig::new()), times);
        assert_eq!(lost[k as usize], 1, "after {k} edges");
        assert_eq!(lost.iter().sum::<u32>(), 1);
    }
}

#[test]
fn missed_edges_are_lost_samples() {
    // Nothing is read for 100 periods, so there are 199 edges, one per conversion after the first pair (F-32). The
    // host sees only the last of these.
    let mut sampler = sampler(SamplerConfig::new());
    let lost = losses(&mut sampler, ramp(50));
    assert_eq!(lost.iter().sum::<u32>(), 0);
    assert_eq!(take(&mut sampler, at(149.0, 49 + 199)), Some(99));
    assert_eq!(take(&mut sampler, at(150.0, 49 + 200)), Some(0));
}

#[test]
fn the_same_edge_twice_is_one_edge() {
    let mut sampler = sampler(SamplerConfig::new());
    assert_eq!(take(&mut sampler, at(0.0, 7)), Some(0));
    assert_eq!(take(&mut sampler, at(0.0, 7)), None);
    assert_eq!(take(&mut sampler, at(1.0, 8)), Some(0));
}

#[test]
fn samples_that_were_due_and_not_taken_are_lost_once() {
    let mut sampler = sampler(SamplerConfig::new());
    losses(&mut sampler, ramp(20));
    assert!(sampler.edge(at(20.0, 20)).is_some(), "due, but the read fails");
    assert!(sampler.edge(at(21.0, 21)).is_some(), "and fails");
    assert_eq!(take(&mut sampler, at(22.0, 22)), Some(2));
    assert_eq!(take(&mut sampler, at(23.0, 23)), Some(0));
}

#[test]
fn without_a_clock_the_edges_are_counted() {
    let mut sampler = sampler(SamplerConfig::new());
    let mut step = |seq| take(&mut sampler, Edge { t_ns: 0, seq });
    assert_eq!(step(0), Some(0));
    assert_eq!(step(1), Some(0));
    assert_eq!(step(2), Some(0));
    assert_eq!(step(7), Some(2), "five edges are six conversions, that is three pairs");
}

#[test]
fn a_clock_that_jumps_back_loses_nothing_by_itself() {
    let mut sampler = sampler(SamplerConfig::new());
    losses(&mut sampler, ramp(100).map(|k| k + 1_000.0));
    let lost: Vec<_> = (0..100).filter_map(|k| take(&mut sampler, at(f64::from(k), 100 + k))).collect();
    assert_eq!((lost.len(), lost.iter().sum::<u32>()), (100, 0));
}

#[test]
fn learns_the_true_period_within_the_tolerance_of_the_clock() {
    for ppm in [-20_000.0, -3_000.0, 0.0, 12_345.0, 20_000.0] {
        let scale = 1.0 + ppm * 1e-6;
        let mut sampler = sampler(SamplerConfig::new());
        let lost = losses(&mut sampler, ramp(6_000).map(|k| k * scale));
        assert_eq!(lost.iter().sum::<u32>(), 0, "{ppm} ppm");
        let error = sampler.rate_period_ns() / (PAIR_NS * scale) - 1.0;
        assert!(error.abs() < 2e-7, "{ppm} ppm: {error:e}");
        // The period is known so well that a gap of half a second is counted exactly.
        assert_eq!(take(&mut sampler, at(5_999.0 * scale + 3_000.0 * scale, 5_999 + 5_999)), Some(2_999));
    }
}

#[test]
fn learns_the_period_once_the_edges_can_be_believed_again() {
    let mut random = Random(3);
    let scale = 1.012;
    let mut last: f64 = 0.0;
    // The edges come up to a period late, and at least 0.6 periods apart.
    let disturbed = ramp(3_000).map(|k| {
        last = (last + 0.6).max(k * scale + random.uniform());
        last
    });
    let times: Vec<f64> = disturbed.chain((3_002..20_000).map(|k| f64::from(k) * scale)).collect();
    let mut sampler = sampler(SamplerConfig::new());
    let lost = losses(&mut sampler, times);
    // The sampler learns anew after some 17 checks of 256 edges each.
    assert_eq!(lost[3_000 + 18 * 256..].iter().sum::<u32>(), 0);
    let error = sampler.rate_period_ns() / (PAIR_NS * scale) - 1.0;
    assert!(error.abs() < 2e-7, "{error:e}");
}

#[test]
fn jitter_of_the_timestamps_neither_adds_nor_hides_losses() {
    for seed in 0..20 {
        let mut random = Random(seed);
        let mut jitter = |sd_us: f64| random.normal() * sd_us * 1e3 / PAIR_NS;
        for every_temp in [1, 4] {
            // The timestamps have a jitter of 15 µs (1 σ). MCLK is 1 % slow. The part drops every 97th sample.
            let times: Vec<f64> =
                ramp(20_000).filter(|k| k % 97.0 != 96.0).map(|k| k * 1.01 + 5.0 + jitter(15.0)).collect();
            let dropped = 20_000 - times.len() as u32;
            let mut sampler = sampler(SamplerConfig::new().with_every_temp(every_temp));
            let lost: u32 = losses(&mut sampler, times).iter().sum();
            // The last loss may still be unreported, and one loss too many may be reported.
            assert!(
                (dropped - 1..=dropped + 1).contains(&lost),
                "{lost} of {dropped}, seed {seed}, every {every_temp}"
            );
        }
    }
}

#[test]
fn follows_a_clock_that_drifts() {
    // The temperature moves MCLK by ±100 ppm, in five cycles of 18 s each.
    let mut sampler = sampler(SamplerConfig::new());
    let phase = |k: f64| k + 1e-4 * 1e5 / std::f64::consts::TAU * (k / 1e5 * std::f64::consts::TAU).sin();
    let lost: u32 = losses(&mut sampler, ramp(500_000).map(phase)).iter().sum();
    assert_eq!(lost, 0);
}

#[test]
fn one_late_timestamp_costs_at_most_one() {
    let mut sampler = sampler(SamplerConfig::new());
    let times = ramp(4_000).map(|k| if k % 500.0 == 250.0 { k + 0.9 } else { k });
    let total: u32 = losses(&mut sampler, times).iter().sum();
    assert!(total <= 1, "{total} for eight late ones");
}

#[test]
fn a_change_between_rate_and_temperature_edges_is_counted_by_what_it_costs() {
    // Between a temperature edge and a rate edge 1.5 periods later, a rate is lost. Between a rate edge and such a
    // temperature edge, none is lost (F-32, F-33). The sampler finds out the kinds at the first change.
    let times = [0.0, 1.0, 2.0, 3.5, 4.5, 5.5, 7.0, 8.0, 9.5, 10.5];
    assert_eq!(losses(&mut sampler(SamplerConfig::new()), times), [0, 0, 0, 0, 0, 1, 0, 0, 1, 0]);
    // These edges begin with rates. After a sample without temperature the next rate comes half a period later, and
    // nothing is lost. The last change goes back to rate edges, and a rate is lost.
    let times = [0.0, 1.0, 2.0, 3.5, 4.0, 5.0, 6.5, 7.5, 9.0, 10.0];
    assert_eq!(losses(&mut sampler(SamplerConfig::new()), times), [0, 0, 0, 0, 0, 0, 0, 0, 1, 0]);
}

#[test]
fn the_first_change_leaves_two_temperatures_out() {
    let mut sampler = sampler(SamplerConfig::new());
    let times = [0.0, 1.0, 2.5, 3.5, 4.5, 6.0, 7.5];
    let temps: Vec<bool> = (0..)
        .zip(times)
        .map(|(seq, time)| {
            let due = sampler.edge(at(time, seq)).unwrap();
            sampler.taken(&due);
            due.temp
        })
        .collect();
    assert_eq!(temps, [true, true, false, false, true, true, true]);
}

#[test]
fn temperature_is_due_every_nth_time() {
    for (every_temp, pattern) in
        [(1, [true, true, true, true, true, true]), (3, [true, false, false, true, false, false]), (0, [false; 6])]
    {
        let mut sampler = sampler(SamplerConfig::new().with_every_temp(every_temp));
        // The first edge announces a temperature. After a sample without temperature, rate edges follow.
        let mut times = (0..6).map(|k| f64::from(k) - if every_temp == 1 || k < 1 { 0.0 } else { 0.5 });
        let due: Vec<bool> = (0..6)
            .map(|seq| {
                let due = sampler.edge(at(times.next().unwrap(), seq)).unwrap();
                assert_eq!(sampler.taken(&due), 0, "every {every_temp}, edge {seq}");
                due.temp
            })
            .collect();
        assert_eq!(due, pattern);
    }
}

#[test]
fn a_temperature_that_was_not_taken_stays_due() {
    let mut sampler = sampler(SamplerConfig::new().with_every_temp(10));
    assert!(sampler.edge(at(0.0, 0)).unwrap().temp);
    let due = sampler.edge(at(1.0, 1)).unwrap();
    assert!(due.temp);
    sampler.taken(&due);
    assert!(!sampler.edge(at(2.0, 2)).unwrap().temp);
}

#[test]
fn the_phase_is_found_from_a_sample_without_temperature() {
    // The host starts late, so its first edge announces a rate. The sampler must find that out from the second sample
    // on.
    let mut sampler = sampler(SamplerConfig::new().with_every_temp(4));
    assert_eq!(losses(&mut sampler, ramp(40)).iter().sum::<u32>(), 0);
    // A rate is now read late and the next edge announces a temperature: nothing is lost.
    assert_eq!(take(&mut sampler, at(40.5, 40)), Some(0));
    assert_eq!(take(&mut sampler, at(42.0, 41)), Some(1), "back again, one is missing");
}

#[test]
fn status_is_due_when_asked_for_or_when_the_edge_is_not_believable() {
    let mut sampler = sampler(SamplerConfig::new().with_read_status(false));
    let mut status = |periods, seq| {
        let due = sampler.edge(at(periods, seq)).unwrap();
        sampler.taken(&due);
        due.status
    };
    assert!(!status(0.0, 0) && !status(1.0, 1) && !status(2.0, 2));
    assert!(status(2.5, 3), "too early after a read of both: that read came late and has taken this data");
    assert!((4..11).all(|seq| status(f64::from(seq), seq)), "and for a while");
    assert!(!status(11.0, 11));
    assert!(status(13.0, 14), "edges were missed");
    let any_channel = Config::new().with_rdyfn(false);
    let mut sampler = Sampler::new(SamplerConfig::new().with_read_status(false), &any_channel, MCLK_HZ);
    assert!(sampler.edge(at(0.0, 0)).unwrap().status, "without RDYFN only the status tells rate from temperature");
}

#[test]
fn f56_a_divider_reads_every_nth_edge() {
    // The first edge after a read of both comes two conversions later, then one per conversion: N + 1 conversions.
    for divider in [2_u32, 3, 50] {
        let mut sampler = sampler(SamplerConfig::new().with_divider(divider as u16));
        let (mut time, mut taken, mut lost) = (0.0, 0, 0);
        for seq in 0..divider * 40 {
            time += if seq % divider == 1 || seq == 0 { 1.0 } else { 0.5 };
            if let Some(missing) = take(&mut sampler, at(time, seq)) {
                taken += 1;
                lost += missing;
            }
        }
        assert_eq!((taken, lost), (40, 0), "every {divider}");
    }
}

#[test]
fn a_missed_reading_behind_a_divider_is_one_loss() {
    let mut sampler = sampler(SamplerConfig::new().with_divider(50));
    assert_eq!(take(&mut sampler, at(0.0, 0)), Some(0));
    assert_eq!(take(&mut sampler, at(25.5, 50)), Some(0));
    assert_eq!(take(&mut sampler, at(51.5, 101)), Some(0), "a conversion late is not late enough");
    assert_eq!(take(&mut sampler, at(51.5 + 51.0, 203)), Some(1));
}

/// RDY behind a counter that lets every N-th edge through. After a read of both channels the first edge comes two
/// conversions later, then one comes per conversion (F-32).
struct DividedRdy {
    sampler: Sampler,
    edges: u32,
    conversion_ns: f64,
    conversions: f64,
    seq: u32,
    is_read: bool,
}

impl DividedRdy {
    fn new(sampling: SamplerConfig, ppm: f64) -> Self {
        let conversion_ns = PAIR_NS / 2.0 * (1.0 + ppm * 1e-6);
        let edges = sampling.divided.into();
        Self { sampler: sampler(sampling), edges, conversion_ns, conversions: 0.0, seq: 0, is_read: true }
    }

    fn next(&mut self) -> Edge {
        self.conversions += f64::from(self.edges + u32::from(self.is_read));
        self.seq += 1;
        self.is_read = false;
        Edge { t_ns: 1_000_000_000 + (self.conversions * self.conversion_ns) as u64, seq: self.seq }
    }

    /// Takes this many edges. Returns the numbers of readings and of losses.
    fn take(&mut self, edges: u32) -> (u32, u32) {
        let (mut readings, mut lost) = (0, 0);
        for _ in 0..edges {
            let edge = self.next();
            if let Some(missing) = take(&mut self.sampler, edge) {
                self.is_read = true;
                readings += 1;
                lost += missing;
            }
        }
        (readings, lost)
    }

    fn miss(&mut self, edges: u32) {
        (0..edges).for_each(|_| _ = self.next());
    }
}

#[test]
fn f56_a_counter_in_the_line_loses_nothing() {
    for ppm in [-20_000.0, 0.0, 20_000.0] {
        for edges in [2, 3, 16, 50, 1_000, u16::MAX] {
            let mut part = DividedRdy::new(SamplerConfig::new().with_divided(edges), ppm);
            assert_eq!(part.take(400), (400, 0), "every {edges}, {ppm} ppm");
            let error = part.sampler.rate_period_ns() / (2.0 * part.conversion_ns) - 1.0;
            assert!(error.abs() < 3e-6, "every {edges}, {ppm} ppm: {error:e}");
        }
    }
}

#[test]
fn a_missing_edge_of_a_counter_is_one_loss() {
    for edges in [2, 3, 50, 1_000] {
        let mut part = DividedRdy::new(SamplerConfig::new().with_divided(edges), 12_345.0);
        part.take(10);
        part.miss(1);
        assert_eq!(part.take(300), (300, 1), "every {edges}");
        part.miss(3);
        // While nothing is read, the counter gives an edge every N conversions, with readings every N + 1.
        let conversions = f64::from(4 * edges + 1);
        let readings = (conversions / f64::from(edges + 1)).round() as u32;
        assert_eq!(part.take(300), (300, readings - 1), "every {edges}");
    }
    // a second of silence on the line, once the distance has been learned
    let mut part = DividedRdy::new(SamplerConfig::new().with_divided(50), 12_345.0);
    part.take(1_000);
    part.miss(220);
    assert_eq!(
        part.take(1_000),
        (1_000, (220.0 * 50.0 / 51.0_f64).round() as u32),
        "11 051 conversions are 216.7 readings"
    );
}

#[test]
fn a_counter_and_a_divider_multiply() {
    for (edges, divider) in [(2_u16, 2_u16), (7, 3), (10, 5)] {
        let mut part = DividedRdy::new(SamplerConfig::new().with_divided(edges).with_divider(divider), -9_000.0);
        assert_eq!(part.take(600 * u32::from(divider)).1, 0, "{edges} × {divider}");
        let conversions = part.conversions;
        let (readings, lost) = part.take(60 * u32::from(divider));
        assert_eq!((readings, lost), (60, 0));
        let apart = (part.conversions - conversions) / 60.0;
        assert_eq!(apart, f64::from(edges * divider + 1), "conversions from reading to reading");
        part.miss(u32::from(divider));
        assert_eq!(part.take(6 * u32::from(divider)).1, 1, "{edges} × {divider}");
    }
}

#[test]
fn a_counter_with_jitter_or_without_a_clock() {
    let mut random = Random(7);
    let mut sampler = sampler(SamplerConfig::new().with_divided(50));
    let lost = losses(&mut sampler, ramp(20_000).map(|k| 25.5 * k + random.normal() * 20e3 / PAIR_NS));
    assert_eq!((lost.len(), lost.iter().sum::<u32>()), (20_000, 0));
    let mut frozen = self::sampler(SamplerConfig::new().with_divided(50));
    let steps = [0, 1, 2, 7].map(|seq| take(&mut frozen, Edge { t_ns: 0, seq }));
    assert_eq!(steps, [Some(0), Some(0), Some(0), Some(4)]);
}

#[test]
fn a_line_behind_a_counter_is_silent_later() {
    let sampler = sampler(SamplerConfig::new().with_divided(50));
    let silence = sampler.silence_ns() as f64 / (64.0 * 25.5 * PAIR_NS);
    assert!((silence - 1.0).abs() < 1e-5, "{silence} of 64 distances");
    let mut status = self::sampler(SamplerConfig::new().with_divided(50).with_read_status(false));
    assert!(status.edge(at(0.0, 0)).unwrap().status, "a late read cannot be told from the time of a rare edge");
}

#[test]
fn a_new_initialisation_has_a_new_phase_and_costs_what_it_took() {
    let mut sampler = sampler(SamplerConfig::new());
    losses(&mut sampler, ramp(3_000));
    sampler.restarted();
    assert_eq!(take(&mut sampler, at(3_099.3, 3_000)), Some(99));
    let lost: u32 = (1..3_000).filter_map(|k| take(&mut sampler, at(3_099.3 + f64::from(k), 3_000 + k))).sum();
    assert_eq!(lost, 0);
}

#[test]
fn silence_is_found_within_its_bound() {
    let bound_ns = sampler(SamplerConfig::new()).silence_ns();
    assert_eq!(bound_ns, (64.0 * PAIR_NS) as u64);
    // with the last of these starts the clock wraps during the test
    for start_ns in [0, 1_000_000_000, u64::MAX - 5_000_000] {
        let mut sampler = sampler(SamplerConfig::new());
        let at = |ns: u64| start_ns.wrapping_add(ns);
        assert_eq!(sampler.silent_since(at(0)), None, "no edge yet: the time runs from here");
        assert_eq!(sampler.silent_since(at(bound_ns)), None);
        assert_eq!(sampler.silent_since(at(bound_ns + 1)), Some(at(0)));
        sampler.edge(Edge { t_ns: at(bound_ns + 7), seq: 1 });
        assert_eq!(sampler.silent_since(at(bound_ns)), None, "asked with an older time");
        assert_eq!(sampler.silent_since(at(2 * bound_ns + 7)), None);
        assert_eq!(sampler.silent_since(at(2 * bound_ns + 8)), Some(at(bound_ns + 7)));
        sampler.restarted();
        assert_eq!(sampler.silent_since(at(9 * bound_ns)), None, "a part initialised anew has its time again");
        assert_eq!(sampler.silent_since(at(10 * bound_ns + 1)), Some(at(9 * bound_ns)));
    }
}

#[test]
fn an_edge_without_a_sample_breaks_the_silence() {
    let mut sampler = sampler(SamplerConfig::new().with_divider(50));
    let bound_ns = sampler.silence_ns();
    for seq in 0..1_000 {
        sampler.edge(at(f64::from(seq) / 2.0, seq));
        assert_eq!(sampler.silent_since(at(f64::from(seq) / 2.0, 0).t_ns + bound_ns), None);
    }
}

#[test]
fn readings_that_fail_again_and_again_get_rare() {
    let mut sampler = sampler(SamplerConfig::new());
    losses(&mut sampler, ramp(100));
    // nothing is read for two seconds, so an edge comes with each conversion
    let conversions_a_s = (2e9 / PAIR_NS) as u32;
    let mut due = |from: u32| {
        let edges = from..from + conversions_a_s;
        edges.filter(|&k| sampler.edge(at(100.0 + f64::from(k) / 2.0, 100 + k)).is_some()).count()
    };
    let (first, second) = (due(0), due(conversions_a_s));
    assert!((26..=37).contains(&first), "{first} in the first second");
    assert!((11..=12).contains(&second), "{second} in the next");
    let mended = 2 * conversions_a_s;
    let back = (0..=1_024).find_map(|k| take(&mut sampler, at(100.0 + f64::from(mended + k) / 2.0, 100 + mended + k)));
    assert!(back.is_some_and(|lost| lost.abs_diff(conversions_a_s) <= 513), "{back:?}");
    let after = at(100.0 + f64::from(mended + 1_026) / 2.0, 100 + mended + 1_026);
    assert!(sampler.edge(after).is_some(), "no pause is left");
}

#[test]
fn a_few_failures_cost_no_pause() {
    let mut sampler = sampler(SamplerConfig::new());
    for seq in 0..1_000 {
        let due = sampler.edge(at(f64::from(seq), seq));
        assert!(due.is_some(), "edge {seq}");
        if seq % 16 == 15 {
            sampler.taken(&due.expect("due"));
        }
    }
}

#[test]
fn a_divider_and_a_counter_of_zero_are_one() {
    for sampling in [SamplerConfig::new().with_divider(0), SamplerConfig::new().with_divided(0)] {
        assert_eq!(losses(&mut sampler(sampling), ramp(100)), [0; 100]);
    }
}

#[test]
fn rate_alone_has_an_edge_per_conversion() {
    let config = Config::new().with_channels(Channels::Rate);
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
    let period = 526.0 / 1054.0;
    let lost = losses(&mut sampler, ramp(100).filter(|k| *k != 50.0).map(|k| k * period));
    assert_eq!((lost.len(), lost.iter().sum::<u32>(), lost[50]), (99, 1, 1));
    assert!(sampler.edge(at(100.0 * period, 99)).is_some_and(|due: Due| !due.temp), "there is no temperature to read");
}

#[test]
fn temperature_alone_gives_no_samples() {
    let config = Config::new().with_channels(Channels::Temp);
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
    assert_eq!(losses(&mut sampler, ramp(10)), [0_u32; 0]);
}

#[test]
fn absurd_arguments_do_not_panic() {
    for mclk_hz in [0, 1, u32::MAX] {
        let mut random = Random(mclk_hz.into());
        let mut sampler = Sampler::new(SamplerConfig::new(), &Config::default(), mclk_hz);
        for _ in 0..2_000 {
            let t_ns = (random.uniform() * 1.8e19) as u64;
            take(&mut sampler, Edge { t_ns, seq: (random.uniform() * 4.2e9) as u32 });
        }
        take(&mut sampler, Edge { t_ns: u64::MAX, seq: 0 });
        take(&mut sampler, Edge { t_ns: 0, seq: u32::MAX });
    }
}
