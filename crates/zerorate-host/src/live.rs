//! Reads a part while it converts, through its driver and a source of data-ready edges.

use crate::Stop;
use crate::edges::Edges;
use crate::error::{Cause, UserError};
use crate::pin::{Pause, Ready};
use crate::source::Registers;
use adis16130::blocking::Adis16130;
use adis16130::{
    Config, Fault, MAX_SCLK_HZ, RdyEdge, Sample, SampleError, Sampler, SamplerConfig, SelfTest, SelfTestPlan,
};
use anyhow::{Result, ensure};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;
use std::cell::RefCell;
use std::fmt::Debug;

pub struct Live<S, E> {
    part: Adis16130<S, ()>,
    pub edges: E,
    pub config: Config,
    pub sampling: SamplerConfig,
    sampler: Sampler,
    mclk_hz: u32,
    stop: Stop,
    /// Time of the last sample, or of the first edge after the initialisation, ns; `None` before that edge.
    alive_ns: Option<u64>,
}

/// SPI clocks that are tested, Hz, up to the part's fastest (F-21).
const CLOCKS_HZ: [u32; 7] = [1_000_000, 2_000_000, 4_000_000, 5_000_000, 6_000_000, 8_000_000, MAX_SCLK_HZ];
/// Number of times that the whole configuration must be read back correctly at each clock.
const READ_BACKS: u32 = 20;

/// Number of rates that are averaged without the self-test, and again with it. They form 16 batches of 64 rates. A
/// batch takes 11 ms at the full rate.
const SELF_TEST_SAMPLES: u16 = 1024;

/// Time without a sample that is an error, ns, unless sampling is slow ([`SILENT_PERIODS`]).
const SILENCE_NS: u64 = 1_000_000_000;

/// A silence of this many sample periods is an error if it is longer than [`SILENCE_NS`].
const SILENT_PERIODS: f64 = 20.0;

/// Time in which an initialised part produces many edges (F-32), ns.
const SIGN_OF_LIFE_NS: u64 = 100_000_000;

impl<S: SpiDevice<Error: Debug + Send + Sync + 'static>, E: Edges> Live<S, E> {
    /// A part whose master clock is nominally `mclk_hz`. Sends nothing to the part.
    pub fn new(spi: S, edges: E, config: Config, sampling: SamplerConfig, mclk_hz: u32, stop: &Stop) -> Self {
        let part = Adis16130::new(spi, (), config);
        let sampler = Sampler::new(sampling, &config, mclk_hz);
        Self { part, edges, config, sampling, sampler, mclk_hz, stop: stop.clone(), alive_ns: None }
    }

    /// Resets the part, initialises it, and reads everything back. Returns the revision.
    pub fn initialise(&mut self) -> Result<u8> {
        self.alive_ns = None;
        match self.start() {
            Ok(revision) => Ok(revision),
            Err(error) if self.edges.next(SIGN_OF_LIFE_NS * u64::from(self.sampling.divided.max(1)))?.is_some() => {
                Err(error.context(
                    "data ready comes (pin 10), so the part is alive and hears, but does not answer as it should",
                ))
            }
            Err(error) => Err(error.context(UserError::new(Cause::Gone, Fault::UNPLUGGED))),
        }
    }

    fn start(&mut self) -> Result<u8> {
        self.part.restart()?;
        Ok(self.part.revision()?.bits())
    }

    /// Finds the fastest tested clock at which, as at all slower ones, the configuration reads back correctly. `set`
    /// sets a clock and returns the actual clock, Hz.
    pub fn fastest_clean_hz(&mut self, mut set: impl FnMut(u32) -> Result<u32>) -> Result<Option<u32>> {
        let mut fastest = None;
        for hz in CLOCKS_HZ {
            ensure!(!self.stop.asked(), UserError::new(Cause::Stopped, "interrupted"));
            let hz = set(hz)?;
            if fastest == Some(hz) {
                continue;
            }
            if !(0..READ_BACKS).all(|_| self.start().is_ok()) {
                break;
            }
            fastest = Some(hz);
        }
        Ok(fastest)
    }

    /// Measures the change of the rate under self-test (F-11). The pin is released in any case, also after Ctrl-C. If
    /// the test succeeds, the part is configured afterwards.
    pub fn self_test<P>(&mut self, pin: &mut P) -> Result<SelfTest>
    where
        P: OutputPin<Error: Debug + Send + Sync + 'static>,
    {
        let edges = RefCell::new(&mut self.edges);
        // the setting of the edge has no effect here, because `Ready` derives the level of RDY from edges
        let config = self.config.with_rdy_edge(RdyEdge::Falling);
        let mut part = Adis16130::new(self.part.bus_mut(), Ready { edges: &edges, stop: &self.stop }, config);
        part.reset()?;
        part.init()?;
        let tested = part.self_test(pin, &mut Pause(&edges), SelfTestPlan::new(SELF_TEST_SAMPLES))?;
        self.initialise()?;
        Ok(tested)
    }

    /// Reads a register `times` times, so that the caller can time the reads.
    pub fn read_often(&mut self, times: u32) -> Result<()> {
        for _ in 0..times {
            self.part.adc_status()?;
        }
        Ok(())
    }

    /// Reads all registers. The reads use up one edge, which gives no sample.
    pub fn registers(&mut self) -> Result<Registers> {
        Ok(Registers { config: self.config, values: self.part.read_all()?.to_vec() })
    }

    /// Waits for an edge, and reads the next sample. A read that fails for a temporary reason counts as a lost
    /// sample.
    #[inline]
    pub fn next(&mut self) -> Result<Sample> {
        loop {
            let Some(edge) = self.edges.next(self.silence_ns())? else {
                return Err(self.why_silent());
            };
            match self.part.sample(&mut self.sampler, edge) {
                Ok(Some(sample)) => {
                    self.alive_ns = Some(sample.t_ns);
                    return Ok(sample);
                }
                Ok(None) if self.is_alive(edge.t_ns) => {}
                // edges that bring no new samples for long: the part may be gone and its RDY line floating
                Ok(None) => return Err(self.why_silent()),
                Err(error) => self.require_transient(error, edge.t_ns)?,
            }
        }
    }

    /// Counts a failed read as a lost sample if the cause was temporary, and returns any other error.
    #[cold]
    fn require_transient(&mut self, error: SampleError<S::Error>, now_ns: u64) -> Result<()> {
        if matches!(error, SampleError::Bus(_)) && self.is_alive(now_ns) {
            // the part may be in the middle of a command
            self.part.restart().map_err(|_| self.at(error.into()))?;
            self.sampler.restarted();
            return Ok(());
        }
        match self.part.diagnose()? {
            None if self.is_alive(now_ns) => Ok(()),
            None => Err(self.at(error.into())),
            Some(fault) => Err(self.at(fault.into())),
        }
    }

    /// True if there was a sample recently. The first edge after an initialisation counts as a sample.
    fn is_alive(&mut self, now_ns: u64) -> bool {
        let alive_ns = *self.alive_ns.get_or_insert(now_ns);
        now_ns.saturating_sub(alive_ns) < self.silence_ns()
    }

    /// Time without a sample that is an error, ns, for the current sampling.
    pub fn silence_ns(&self) -> u64 {
        let edges = u64::from(self.sampling.divider.max(1)) * u64::from(self.sampling.divided.max(1));
        // 1024 edges at 11.4 kHz take 0.09 s, so this time is more than ten times the sample period
        let nominal_ns = SILENCE_NS * (1 + edges / 1024);
        let (rate, temp) = self.config.conversion_cycles();
        let period_ns = f64::from(rate + temp) * 1e9 / f64::from(self.mclk_hz);
        nominal_ns.max((SILENT_PERIODS * period_ns * edges as f64) as u64)
    }

    /// The error if no sample came in time, with the part's diagnosis.
    #[cold]
    pub fn why_silent(&mut self) -> anyhow::Error {
        let fault = match self.part.diagnose() {
            Ok(None) => UserError::new(Cause::Silent, Fault::NO_NEW_DATA).into(),
            Ok(Some(fault @ (Fault::StuckHigh(_) | Fault::StuckLow(_)))) => {
                anyhow::Error::new(fault).context(UserError::new(Cause::Gone, Fault::UNPLUGGED))
            }
            Ok(Some(fault)) => fault.into(),
            Err(error) => error.into(),
        };
        self.at(fault)
    }

    fn at(&self, error: anyhow::Error) -> anyhow::Error {
        error.context(self.edges.now())
    }
}
