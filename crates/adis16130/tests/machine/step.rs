//! The steps of a run, drawn at random. If a run fails, proptest removes steps and reduces numbers while it still
//! fails.

use std::fmt;

use adis16130::{Channels, Config, ConversionTime, Framing, RdyEdge, SamplerConfig, Width};
use adis16130_twin::{Fault, RdyOutput};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::bus::Trouble;
use crate::gyro::Form;

/// A call, a fault, or time that passes.
#[derive(Clone, Debug)]
pub enum Step {
    /// Waits for an edge, then for this time, and takes the sample.
    Sample {
        late_ns: u32,
    },
    /// Takes this many samples, each at its edge.
    Samples(u16),
    /// Passes the newest edge to the driver again.
    SameEdge,
    /// Passes an edge that the part did not make.
    Glitch,
    Pass {
        ns: u64,
    },
    Wait {
        us: u16,
    },
    Read(ReadCall),
    Start(Start),
    /// Removes all faults and initialises the part, as a host does after an error.
    Recover,
    /// Sets another configuration, and makes a sampler for it.
    Configure(Config, SamplerConfig),
    SelfTest,
    Write(WritableRegister, u8),
    /// Sends these bytes on the bus without the driver's knowledge.
    Raw(Vec<u8>),
    /// Replaces the driver by a new one on the same bus.
    Release,
    Fault(Fault),
    Power(bool),
    Replug,
    Sync(bool),
    /// Plans this trouble after this many bytes.
    Ahead(u8, Trouble),
}

#[derive(Copy, Clone, Debug)]
pub enum ReadCall {
    Rate,
    Temp,
    Both,
    RateInRange,
    InRange,
    RateStatus,
    TempStatus,
    AdcStatus,
    Revision,
    All,
    Raw,
    Verify,
    Diagnose,
}

const READS: [ReadCall; 13] = {
    use ReadCall::*;
    [Rate, Temp, Both, RateInRange, InRange, RateStatus, TempStatus, AdcStatus, Revision, All, Raw, Verify, Diagnose]
};

#[derive(Copy, Clone, Debug)]
pub enum Start {
    Restart,
    /// A restart without a call of `Sampler::restarted`.
    RestartInSecret,
    Reset,
    Init,
    InitVerified,
    InitChecksummed,
}

#[derive(Copy, Clone, Debug)]
pub enum WritableRegister {
    Mode,
    Iop,
    RateConv,
    TempCs,
}

#[derive(Clone)]
pub struct Plan {
    pub form: Form,
    pub seed: u64,
    pub rotation_dps: f64,
    pub clock_ppm: i32,
    pub sclk_hz: f64,
    pub bit_error_rate: f64,
    pub rdy: RdyOutput,
    pub config: Config,
    pub sampling: SamplerConfig,
    /// Start value of the host's clock. `seq` is the start value of its count of edges.
    pub t_ns: u64,
    pub seq: u32,
    pub steps: Vec<Step>,
}

/// Prints one step per line, since a failure prints all steps.
impl fmt::Debug for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { form, seed, rotation_dps, clock_ppm, sclk_hz, bit_error_rate, rdy, .. } = self;
        writeln!(
            f,
            "{form:?}, seed {seed}, {rotation_dps} °/s, {clock_ppm} ppm, {sclk_hz} Hz, {bit_error_rate} of bits"
        )?;
        writeln!(f, "{rdy:?}, t_ns {}, seq {}", self.t_ns, self.seq)?;
        writeln!(f, "{:?}", self.config)?;
        writeln!(f, "{:?}", self.sampling)?;
        (0..).zip(&self.steps).try_for_each(|(index, step): (usize, _)| writeln!(f, "{index:4} {step:?}"))
    }
}

pub fn plan() -> impl Strategy<Value = Plan> {
    let rotation = prop_oneof![6 => Just(0.0), 1 => Just(330.0), 1 => Just(400.0), 1 => Just(-400.0)];
    let sclk = prop_oneof![4 => Just(4.0e6), 2 => Just(1.0e7), 1 => Just(1.1e6), 1 => Just(2.0e5)];
    let rdy = prop_oneof![4 => Just(RdyOutput::Level), 1 => Just(RdyOutput::Inverted), 1 => Just(RdyOutput::Pulse)];
    let unit = (form(), any::<u64>(), rotation, -60_000..=60_000, sclk, prop_oneof![Just(1e-2), Just(1e-4)], rdy);
    let clock = prop_oneof![Just((0, 0)), Just((u64::MAX - 1_000_000, u32::MAX - 9)), any::<(u64, u32)>()];
    let steps = vec(step(), 1..=200);
    (unit, config(), sampling(), clock, steps).prop_map(|(unit, config, sampling, (t_ns, seq), steps)| {
        let (form, seed, rotation_dps, clock_ppm, sclk_hz, bit_error_rate, rdy) = unit;
        Plan { form, seed, rotation_dps, clock_ppm, sclk_hz, bit_error_rate, rdy, config, sampling, t_ns, seq, steps }
    })
}

/// Runs in which a call is dropped after this many bytes. More calls follow, before a restart and after it.
#[cfg(feature = "async")]
pub fn dropped(bytes: u8) -> impl Iterator<Item = Plan> {
    let per_byte = Config::new();
    let configs = [per_byte, per_byte.with_framing(Framing::Command), per_byte.with_width(Width::Bits16)];
    configs.into_iter().flat_map(move |config| {
        let starts = [Start::Restart, Start::Reset, Start::Init, Start::InitVerified, Start::InitChecksummed];
        let write = Step::Write(WritableRegister::Mode, config.mode().bits());
        let calls = READS.map(Step::Read).into_iter().chain(starts.map(Step::Start)).chain([Step::Samples(1), write]);
        calls.map(move |call| Plan {
            form: Form::Async,
            seed: 5,
            rotation_dps: 0.0,
            clock_ppm: 0,
            sclk_hz: 4.0e6,
            bit_error_rate: 1e-4,
            rdy: RdyOutput::Level,
            config,
            sampling: SamplerConfig::new(),
            t_ns: 0,
            seq: 0,
            steps: vec![
                Step::Start(Start::Restart),
                Step::Samples(2),
                Step::Ahead(bytes, Trouble::Cut),
                call,
                Step::Read(ReadCall::Both),
                Step::Samples(2),
                Step::Recover,
                Step::Samples(2),
                Step::Read(ReadCall::Both),
            ],
        })
    })
}

fn form() -> BoxedStrategy<Form> {
    #[cfg(feature = "async")]
    return prop_oneof![Just(Form::Blocking), Just(Form::Async)].boxed();
    #[cfg(not(feature = "async"))]
    Just(Form::Blocking).boxed()
}

fn config() -> impl Strategy<Value = Config> {
    let channels = prop_oneof![8 => Just(Channels::Both), 3 => Just(Channels::Rate), 1 => Just(Channels::Temp)];
    let conversion = || prop_oneof![6 => Just(ConversionTime::new(5)), 1 => any::<u8>().prop_map(ConversionTime::new)];
    let flags = (any::<bool>(), prop::bool::weighted(0.8), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    (channels, conversion(), conversion(), flags).prop_map(|(channels, rate, temp, flags)| {
        let (narrow, rdyfn, clamp, command, rising, sync) = flags;
        Config::new()
            .with_channels(channels)
            .with_rate_conversion(rate)
            .with_temp_conversion(temp)
            .with_width(if narrow { Width::Bits16 } else { Width::Bits24 })
            .with_rdyfn(rdyfn)
            .with_clamp(clamp)
            .with_framing(if command { Framing::Command } else { Framing::PerByte })
            .with_rdy_edge(if rising { RdyEdge::Rising } else { RdyEdge::Falling })
            .with_sync(sync)
    })
}

fn sampling() -> impl Strategy<Value = SamplerConfig> {
    let every_temp = prop_oneof![4 => Just(1), 2 => Just(4), 1 => Just(0), 1 => any::<u16>()];
    let divider = prop_oneof![6 => Just(1), 1 => 0..8_u16];
    (every_temp, divider, prop::bool::weighted(0.6)).prop_map(|(every_temp, divider, read_status)| {
        SamplerConfig::new().with_every_temp(every_temp).with_divider(divider).with_read_status(read_status)
    })
}

fn step() -> impl Strategy<Value = Step> {
    let samples = prop_oneof![
        20 => late_ns().prop_map(|late_ns| Step::Sample { late_ns }),
        8 => (1..40_u16).prop_map(Step::Samples),
        1 => (40..1_000_u16).prop_map(Step::Samples),
        1 => Just(Step::SameEdge),
    ];
    let time = prop_oneof![
        8 => (0..2_000_000_u64).prop_map(|ns| Step::Pass { ns }),
        1 => (0..3_000_000_000_u64).prop_map(|ns| Step::Pass { ns }),
        3 => (0..3_000_u16).prop_map(|us| Step::Wait { us }),
    ];
    let calls = prop_oneof![
        12 => read().prop_map(Step::Read),
        3 => start().prop_map(Step::Start),
        2 => (config(), sampling()).prop_map(|(config, sampling)| Step::Configure(config, sampling)),
        1 => Just(Step::SelfTest),
        1 => (writable(), any::<u8>()).prop_map(|(writable, value)| Step::Write(writable, value)),
    ];
    let strange = prop_oneof![
        2 => Just(Step::Glitch),
        1 => vec(any::<u8>(), 1..6).prop_map(Step::Raw),
        1 => Just(Step::Release),
        2 => any::<bool>().prop_map(Step::Sync),
    ];
    let faults = prop_oneof![
        8 => fault().prop_map(Step::Fault),
        2 => any::<bool>().prop_map(Step::Power),
        1 => Just(Step::Replug),
        4 => (0..40_u8, trouble()).prop_map(|(bytes, trouble)| Step::Ahead(bytes, trouble)),
    ];
    prop_oneof![60 => samples, 12 => time, 14 => calls, 1 => strange, 4 => faults, 4 => Just(Step::Recover)]
}

/// Draws the delay of the host: none, up to 90 µs (about a conversion), up to 2 ms, or up to 50 ms.
fn late_ns() -> impl Strategy<Value = u32> {
    prop_oneof![10 => Just(0), 4 => 0..90_000_u32, 4 => 0..2_000_000_u32, 1 => 0..50_000_000_u32]
}

fn trouble() -> impl Strategy<Value = Trouble> {
    prop_oneof![Just(Trouble::Cut), fault().prop_map(Trouble::Fault)]
}

fn fault() -> impl Strategy<Value = Fault> {
    use Fault::*;
    prop::sample::select(&[None, SdoLow, SdoHigh, Frozen, RdyLost, RdyStutter, BitErrors, Brownout, Unplug][..])
}

fn read() -> impl Strategy<Value = ReadCall> {
    prop::sample::select(READS.to_vec())
}

fn start() -> impl Strategy<Value = Start> {
    use Start::*;
    let weighed = [Restart, Restart, Restart, RestartInSecret, Reset, Init, InitVerified, InitChecksummed];
    prop::sample::select(weighed.to_vec())
}

fn writable() -> impl Strategy<Value = WritableRegister> {
    prop::sample::select(
        &[WritableRegister::Mode, WritableRegister::Iop, WritableRegister::RateConv, WritableRegister::TempCs][..],
    )
}
