//! Counts instructions by SysTick, which runs on virtual time. The emulator gives every instruction the same share of
//! that time.

use crate::bus::{Answers, Bus};
use adis16130::blocking::Adis16130;
use adis16130::registers::Address;
use adis16130::{Config, Edge, Framing, MCLK_HZ, RateCode, Sampler, SamplerConfig, TempCode, Width};
use core::hint::black_box;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use firmware_qemu::scenario::{Corrections, Reading, corrected_dps};
use firmware_qemu::tracking::{self, Mean};

/// Time from one rate reading to the next with F-30: 1054 cycles of MCLK (F-31), ns.
const PERIOD_NS: u64 = 175_667;

/// Number of means per second that the tracker takes.
const BLOCKS_PER_S: usize = 10;

/// Registers of a part that runs with F-30 and has a reading of each channel waiting (docs/facts.md section 3).
const READY: [(Address, u8); 3] = [(Address::RateStatus, 0x08), (Address::TempStatus, 0x48), (Address::Mode, 0x22)];

type Counts = [(&'static str, Ticks); 14];

/// Smallest and largest number of ticks of an operation over all its counted calls.
#[derive(Clone, Copy)]
pub struct Ticks {
    pub least: u32,
    pub most: u32,
}

impl Ticks {
    const NONE: Self = Self { least: u32::MAX, most: 0 };

    fn with(self, ticks: u32) -> Self {
        Self { least: self.least.min(ticks), most: self.most.max(ticks) }
    }

    fn some(self) -> Option<Self> {
        (self.most > 0).then_some(self)
    }
}

/// Counts the ticks of every operation, for each reading or each mean of the tracker. Returns `None` without readings.
///
/// Each operation is a function that is called through a pointer unknown to the compiler, with its operands in memory.
/// So the compiler cannot move anything out of the function, and the count includes call, operands and return.
pub fn all(readings: &[Reading], corrections: &Corrections, seed: u64, systick: SYST) -> Option<Counts> {
    let mut bench = Bench { counter: Counter::new(systick), readings };
    let Corrections { integer, curve, single, .. } = *corrections;
    let table = corrections.table();
    let [within, second, learned, motion, tracked] = bench.tracker(seed)?;
    Some([
        ("empty", bench.over(|counter, _| counter.ticks_of_nothing())?),
        ("integer_correction", bench.corrections(integer, |(integer, it)| integer.apply(it.rate_code, it.temp_code))?),
        ("integer_curve", bench.corrections(curve, |(curve, it)| curve.apply(it.rate_code, it.temp_code))?),
        ("table_look_up", bench.corrections(table, |(table, it)| table.look_up_udps(it.temp_code))?),
        ("f32_correction", bench.corrections(single, |(single, it)| single.apply(it.rate_dps, it.temp_c))?),
        (
            "f32_correction_of_codes",
            bench.corrections(single, |(single, it)| corrected_dps(single, it.rate, it.temp))?,
        ),
        ("read_rate", bench.reads(|on| on.gyro.read_rate().is_ok_and(|rate| rate.code() != 0))?),
        ("read_both", bench.reads(|on| on.gyro.read_both().is_ok_and(|(rate, temp)| rate.code() != temp.code()))?),
        ("sample", bench.reads(|on| on.gyro.sample(&mut on.sampler, on.edge).is_ok_and(|it| it.is_some()))?),
        ("tracker_within_second", within),
        ("tracker_second", second),
        ("tracker_learned", learned),
        ("tracker_motion", motion),
        ("tracker_bias", tracked),
    ])
}

struct Counter(SYST);

impl Counter {
    fn new(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(0x00FF_FFFF);
        systick.enable_counter();
        Self(systick)
    }

    /// Counts the ticks of `work`, including the ticks of reading the clock. `ticks` is never inlined, so that
    /// reading the clock takes the same number of ticks around any work.
    #[inline(never)]
    fn ticks<I, T>(&mut self, work: fn(&mut I) -> T, operands: &mut I) -> u32 {
        let work = black_box(work);
        self.0.clear_current();
        cortex_m::asm::isb();
        let start = SYST::get_current();
        let done = work(operands);
        let end = SYST::get_current();
        assert!(!self.0.has_wrapped(), "the work took longer than the clock counts");
        black_box(done);
        start.wrapping_sub(end) & 0x00FF_FFFF
    }

    /// Counts the ticks of reading the clock.
    #[inline(never)]
    fn ticks_of_nothing(&mut self) -> u32 {
        self.0.clear_current();
        cortex_m::asm::isb();
        let start = SYST::get_current();
        let end = SYST::get_current();
        start.wrapping_sub(end) & 0x00FF_FFFF
    }
}

/// A reading in every form that a correction takes.
struct Operand {
    rate_code: u32,
    temp_code: u32,
    rate: RateCode,
    temp: TempCode,
    rate_dps: f32,
    temp_c: f32,
}

impl Operand {
    fn new(reading: &Reading) -> Self {
        let &Reading { rate_code, temp_code, .. } = reading;
        let (rate, temp) = (RateCode::new(rate_code, Width::Bits24), TempCode::new(temp_code, Width::Bits24));
        Self { rate_code, temp_code, rate, temp, rate_dps: rate.to_dps(), temp_c: temp.to_celsius() }
    }
}

/// A driver whose bus has prepared answers, and the arguments of its sampler.
struct Reader<'a> {
    gyro: Adis16130<Bus<'a>, ()>,
    sampler: Sampler,
    edge: Edge,
}

struct Bench<'a> {
    counter: Counter,
    readings: &'a [Reading],
}

impl Bench<'_> {
    fn over(&mut self, mut count: impl FnMut(&mut Counter, &Reading) -> u32) -> Option<Ticks> {
        let counter = &mut self.counter;
        self.readings.iter().fold(Ticks::NONE, |all, reading| all.with(count(counter, reading))).some()
    }

    fn corrections<C, T>(&mut self, correction: C, work: fn(&mut (C, Operand)) -> T) -> Option<Ticks>
    where
        C: Copy,
    {
        self.over(|counter, reading| counter.ticks(work, &mut (correction, Operand::new(reading))))
    }

    /// Counts a read with the settings of F-30 and command framing. A sample has status, rate and temperature. The
    /// first reading, which takes more commands, is not counted.
    fn reads(&mut self, work: fn(&mut Reader<'_>) -> bool) -> Option<Ticks> {
        let answers = Answers::new();
        READY.iter().for_each(|(register, value)| answers.set(*register, [*value, 0, 0]));
        let config = Config::new().with_framing(Framing::Command);
        let mut gyro = Adis16130::new(Bus(&answers), (), config);
        gyro.init().ok()?;
        let sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
        let mut reader = Reader { gyro, sampler, edge: Edge { t_ns: 0, seq: 0 } };
        let show = |reading: &Reading| {
            answers.set_code(Address::RateData, reading.rate_code);
            answers.set_code(Address::TempData, reading.temp_code);
        };
        show(self.readings.first()?);
        work(&mut reader);
        self.over(|counter, reading| {
            show(reading);
            reader.edge = Edge { t_ns: reader.edge.t_ns + PERIOD_NS, seq: reader.edge.seq + 1 };
            counter.ticks(work, &mut reader)
        })
    }

    /// Counts the ticks of the tracker for five cases: a mean within a second, a mean at the end of a second, a mean
    /// after which the tracker learns, a mean that shows a motion or a step, and a request for the bias.
    fn tracker(&mut self, seed: u64) -> Option<[Ticks; 5]> {
        let [mut within, mut second, mut learned, mut motion, mut tracked] = [Ticks::NONE; 5];
        let mut operands = (tracking::tracker(), Mean { rate_dps: None, temp_c: 0.0 });
        for (index, mean) in tracking::means(seed).enumerate() {
            let before = operands.0.counts();
            operands.1 = mean;
            let pushed = self.counter.ticks(|(on, it)| on.push(it.rate_dps, Some(it.temp_c), true), &mut operands);
            let kind = match &operands.0 {
                tracker if tracker.moves() => &mut motion,
                tracker if tracker.counts() != before => &mut learned,
                _ if index % BLOCKS_PER_S == BLOCKS_PER_S - 1 => &mut second,
                _ => &mut within,
            };
            *kind = kind.with(pushed);
            tracked = tracked.with(self.counter.ticks(|(on, it)| on.tracked(it.temp_c), &mut operands));
        }
        Some([within.some()?, second.some()?, learned.some()?, motion.some()?, tracked.some()?])
    }
}
