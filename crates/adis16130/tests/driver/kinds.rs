//! Cases in which the sampler must find out which edges announce rates and which announce temperatures. The random
//! tests in `tests/machine` and mutants of the sampler found these cases.

use adis16130::{Channels, Config, ConversionTime, Edge, MCLK_HZ, Sampler, SamplerConfig};

struct Bench {
    sampler: Sampler,
    period_ns: f64,
    seq: u32,
}

impl Bench {
    /// Makes a sampler for a part whose rate conversion takes 527 cycles (F-30), and whose temperature conversion
    /// takes `temp_cycles`. The clock of the part is fast by `ppm` millionths.
    fn new(sampling: SamplerConfig, config: Config, temp_cycles: u32, ppm: f64) -> Self {
        let period_ns = f64::from(527 + temp_cycles) / 6e6 * 1e9 / (1.0 + ppm * 1e-6);
        Self { sampler: Sampler::new(sampling, &config, MCLK_HZ), period_ns, seq: 0 }
    }

    /// Makes the edge at this time, in periods. The host missed `missed` edges before this one.
    fn edge(&mut self, periods: f64, missed: u32) -> Edge {
        self.seq += 1 + missed;
        Edge { t_ns: 1_000_000_000 + (periods * self.period_ns) as u64, seq: self.seq }
    }

    /// Takes an edge with a new rate. Returns the number of reported losses.
    fn lost(&mut self, periods: f64, missed: u32) -> u32 {
        let edge = self.edge(periods, missed);
        let due = self.sampler.edge(edge).expect("due");
        self.sampler.taken(&due)
    }

    /// Takes an edge without a new rate.
    fn stale(&mut self, periods: f64) {
        let edge = self.edge(periods, 0);
        self.sampler.edge(edge).expect("due");
        self.sampler.stale();
    }
}

#[test]
fn a_change_of_the_kind_leaves_the_period_alone() {
    // The temperature takes 0.628 of the period, so a gap in which the kind changes looks nearly like a regular one.
    let config = Config::new().with_temp_conversion(ConversionTime::new(0x85));
    let mut bench = Bench::new(SamplerConfig::new(), config, 889, 0.0);
    let temps = (1..5).map(|k| (f64::from(k) + 0.154, 0));
    let rates = (5..19).map(|k| (f64::from(k) + 0.526, u32::from(k == 5)));
    let end = [(22.154, 6), (23.526, 0), (24.526, 0), (25.526, 0), (26.526, 0)];
    let lost: Vec<u32> = temps.chain(rates).chain(end).map(|(periods, missed)| bench.lost(periods, missed)).collect();
    // Four rates are lost: one before the edge at 5.526 periods, and three between the edges at 18.526 and 23.526.
    assert_eq!(lost.iter().sum::<u32>(), 4, "{lost:?}");
}

#[test]
fn a_clock_that_is_fast_hides_no_change_of_the_kind() {
    // The temperature takes 0.815 of the period, so a rate edge lies close behind each temperature edge.
    let config = Config::new().with_temp_conversion(ConversionTime::new(33));
    let mut bench = Bench::new(SamplerConfig::new(), config, 2_319, 11_531.0);
    let temps = (1..8).map(|k| (f64::from(k), 0));
    let rates = (9..16).map(|k| (f64::from(k) + 0.185, u32::from(k == 9)));
    let lost: Vec<u32> = temps.chain(rates).map(|(periods, missed)| bench.lost(periods, missed)).collect();
    assert_eq!(lost.iter().sum::<u32>(), 2, "{lost:?}");
}

#[test]
fn without_rdyfn_the_first_loss_counts() {
    let mut bench = Bench::new(SamplerConfig::new(), Config::new().with_rdyfn(false), 527, 0.0);
    assert_eq!(bench.lost(1.0, 0), 0);
    bench.stale(1.5);
    assert_eq!(bench.lost(2.0, 0), 0);
    [2.5, 3.0, 3.5].into_iter().for_each(|periods| bench.stale(periods)); // the part dropped a rate at 3.0 (F-33)
    assert_eq!(bench.lost(4.0, 0), 1);
}

#[test]
fn a_restart_before_the_first_edge_ends_with_that_edge() {
    let mut bench = Bench::new(SamplerConfig::new(), Config::new().with_rdyfn(false), 527, 0.0);
    bench.sampler.restarted();
    assert_eq!(bench.lost(1.0, 0), 0);
    // the edge of a temperature, seven conversions later
    assert_eq!(bench.lost(4.5, 6), 2);
}

#[test]
fn samples_before_the_first_one_do_not_count_as_lost() {
    let mut bench = Bench::new(SamplerConfig::new(), Config::new(), 527, 0.0);
    bench.stale(1.0);
    let lost = [1.5, 2.5, 3.5, 4.5, 5.5].map(|periods| bench.lost(periods, 0));
    assert_eq!(lost, [0; 5]);
    let config = Config::new().with_channels(Channels::Rate).with_rdyfn(false);
    let mut bench = Bench::new(SamplerConfig::new(), config, 0, 0.0);
    assert_eq!(bench.lost(1.0, 0), 0);
    bench.stale(2.0); // the reading before was late and took this conversion
    assert_eq!([3.0, 4.0, 5.0].map(|periods| bench.lost(periods, 0)), [0; 3]);
}

#[test]
fn an_edge_of_the_longer_conversion_is_not_believed() {
    // After a read of both channels, the next edge comes a period later. The second edge comes earlier, so it belongs
    // to data that the first read, a late one, has taken.
    let config = Config::new().with_temp_conversion(ConversionTime::new(0xBB));
    let mut bench = Bench::new(SamplerConfig::new().with_read_status(false), config, 7_801, 0.0);
    assert_eq!(bench.lost(1.0, 0), 0);
    let edge = bench.edge(1.937, 0);
    assert!(bench.sampler.edge(edge).is_some_and(|due| due.status));
}
