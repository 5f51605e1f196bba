//! Tests `Adis16130::sample`: the order of reads, stale edges, faults, and the count of losses.

use adis16130::blocking::Adis16130;
use adis16130::registers::Address;
use adis16130::{BusError, ChannelStatus, Config, Edge, Fault, Framing, MCLK_HZ, SampleError, Sampler, SamplerConfig};
use embedded_hal::spi::ErrorKind;

use crate::part::{Line, Part, Pin, Wire};
use std::{cell::RefCell, rc::Rc};

const PAIR_NS: u64 = 175_667; // 2 · 527 cycles of 6 MHz (F-31)

const RATE: u32 = 0x80_0101;
const TEMP: u32 = 0x80_0102;

struct Bench {
    part: Rc<RefCell<Part>>,
    gyro: Adis16130<Wire, Pin>,
    sampler: Sampler,
}

impl Bench {
    fn new(sampling: SamplerConfig) -> Self {
        let part = Part::new();
        let config = Config::new().with_framing(Framing::Command);
        let mut gyro = Adis16130::new(Wire(part.clone()), Pin::default(), config);
        gyro.init().unwrap();
        part.borrow_mut().frames.clear();
        part.borrow_mut().set(0x08, RATE);
        part.borrow_mut().set(0x0A, TEMP);
        Self { part, gyro, sampler: Sampler::new(sampling, &config, MCLK_HZ) }
    }

    fn edge(&mut self, n: u32, status: u32) -> Result<Option<adis16130::Sample>, SampleError<ErrorKind>> {
        self.part.borrow_mut().set(0x20, status);
        self.gyro.sample(&mut self.sampler, Edge { t_ns: u64::from(n) * PAIR_NS, seq: n })
    }
}

#[test]
fn reads_status_then_rate_then_temperature() {
    let mut bench = Bench::new(SamplerConfig::new());
    let sample = bench.edge(1, 0x08).unwrap().unwrap();
    let (status, rate, temp) = (vec![0x60, 0], vec![0x48, 0, 0, 0], vec![0x4A, 0, 0, 0]);
    let look = [vec![0x62, 0], vec![0x78, 0], vec![0x62, 0]]; // the driver checks whether there is a temperature
    let first_frames = [vec![status.clone(), rate.clone()], look.to_vec(), vec![temp.clone()]].concat();
    assert_eq!(bench.part.borrow().frames, first_frames);
    bench.part.borrow_mut().frames.clear();
    bench.edge(2, 0x08).unwrap().unwrap();
    assert_eq!(bench.part.borrow().frames, [status, rate, temp]);
    assert_eq!((sample.t_ns, sample.seq, sample.lost), (PAIR_NS, 1, 0));
    assert_eq!(sample.rate.code(), RATE);
    assert_eq!(sample.temp.map(|temp| temp.code()), Some(TEMP));
    assert_eq!(sample.status, Some(ChannelStatus::new(0x08)));
}

#[test]
fn without_status_and_temperature_it_reads_the_rate_only() {
    let mut bench = Bench::new(SamplerConfig::new().with_read_status(false).with_every_temp(0));
    let first = bench.edge(1, 0x08).unwrap().unwrap();
    assert_eq!(bench.part.borrow().frames, [vec![0x60, 0], vec![0x48, 0, 0, 0]], "whether there is a first reading");
    assert_eq!((first.status, first.temp), (Some(ChannelStatus::new(0x08)), None));
    bench.part.borrow_mut().frames.clear();
    let sample = bench.edge(2, 0x08).unwrap().unwrap();
    assert_eq!(bench.part.borrow().frames, [vec![0x48, 0, 0, 0]]);
    assert_eq!((sample.status, sample.temp), (None, None));
}

#[test]
fn a_stale_edge_gives_no_sample_and_loses_none() {
    let mut bench = Bench::new(SamplerConfig::new());
    bench.edge(1, 0x08).unwrap().unwrap();
    bench.edge(2, 0x08).unwrap().unwrap();
    assert_eq!(bench.edge(3, 0x02), Ok(None), "negative and read");
    assert_eq!(bench.edge(4, 0x00), Ok(None), "positive and read, on a link that was looked at");
    assert_eq!(bench.edge(5, 0x08).unwrap().unwrap().lost, 2, "but two periods have gone by");
}

#[test]
fn samples_overtaken_by_a_late_first_one_are_not_lost() {
    let mut bench = Bench::new(SamplerConfig::new());
    bench.edge(1, 0x08).unwrap().unwrap();
    assert_eq!(bench.edge(2, 0x02), Ok(None), "the reading before took it");
    assert_eq!(bench.edge(3, 0x08).unwrap().unwrap().lost, 0);
    assert_eq!(bench.edge(5, 0x08).unwrap().unwrap().lost, 1);
}

#[test]
fn a_failed_read_is_counted_at_the_next_success() {
    let mut bench = Bench::new(SamplerConfig::new());
    bench.edge(1, 0x08).unwrap().unwrap();
    bench.part.borrow_mut().fails_after = Some(1);
    let failed = BusError::Transfer { register: Address::RateData, error: ErrorKind::Other };
    assert_eq!(bench.edge(2, 0x08), Err(SampleError::Bus(failed)));
    bench.part.borrow_mut().fails_after = None;
    let interrupted = BusError::Interrupted { register: Address::RateData };
    assert_eq!(bench.edge(3, 0x08), Err(SampleError::Bus(interrupted)), "the part may be in the middle of it");
    bench.gyro.restart().unwrap();
    bench.sampler.restarted();
    bench.part.borrow_mut().set(0x08, RATE);
    bench.part.borrow_mut().set(0x0A, TEMP);
    assert_eq!(bench.edge(4, 0x08).unwrap().unwrap().lost, 2);
    assert_eq!(bench.edge(5, 0x08).unwrap().unwrap().lost, 0, "once only");
}

#[test]
fn faults_are_diagnosed() {
    for (line, matches) in [
        (Line::High, (|fault| matches!(fault, Fault::StuckHigh(_))) as fn(&Fault) -> bool),
        (Line::Low, |fault| matches!(fault, Fault::StuckLow(_))),
        (Line::Flip(0x20, 0x60), |fault| matches!(fault, Fault::Unexpected(_))),
    ] {
        for read_status in [true, false] {
            let mut bench = Bench::new(SamplerConfig::new().with_read_status(read_status));
            bench.edge(1, 0x08).unwrap().unwrap();
            bench.part.borrow_mut().line = line;
            let result = bench.edge(2, 0x08);
            if !read_status && matches!(line, Line::Flip(..)) {
                assert!(result.unwrap().is_some(), "the status was not read");
            } else {
                assert!(matches!(&result, Err(SampleError::Fault(fault)) if matches(fault)), "{line:?}: {result:?}");
            }
        }
    }
}

#[test]
fn a_dead_sdo_makes_no_storm_of_frames() {
    for line in [Line::Low, Line::High] {
        let mut bench = Bench::new(SamplerConfig::new());
        bench.edge(1, 0x08).unwrap().unwrap();
        bench.part.borrow_mut().line = line;
        // a simulated second of edges, one for each conversion, and a loop that initialises after each failure
        for n in 2..11_387 {
            let edge = Edge { t_ns: u64::from(n) * PAIR_NS / 2, seq: n };
            if bench.gyro.sample(&mut bench.sampler, edge).is_err() {
                bench.gyro.reset().unwrap();
                bench.gyro.init().unwrap();
                bench.sampler.restarted();
            }
        }
        let frames = bench.part.borrow().frames.len();
        assert!(frames < 500, "{line:?}: {frames} frames in a second");
    }
}

#[test]
fn out_of_range_is_in_the_status_not_an_error() {
    for (read_status, status) in [(true, 0x09), (false, 0x09), (false, 0x0B)] {
        let mut bench = Bench::new(SamplerConfig::new().with_read_status(read_status));
        bench.part.borrow_mut().set(0x08, 0xFF_FFFF);
        let sample = bench.edge(1, status).unwrap().unwrap();
        assert!(sample.rate.is_at_rail());
        assert!(sample.status.unwrap().out_of_range(), "read although it was not due");
    }
}

#[test]
fn a_temperature_at_the_rail_is_out_of_range() {
    let mut bench = Bench::new(SamplerConfig::new());
    bench.part.borrow_mut().set(0x0A, 0);
    let result = bench.edge(1, 0x08);
    assert!(
        matches!(result, Err(SampleError::OutOfRange(reading)) if reading.register == Address::TempData),
        "{result:?}"
    );
}
