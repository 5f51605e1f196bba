//! A part on this computer's bus or behind a bridge. Before sampling, requests go through the driver. The first
//! request of a sample starts a thread that reads the part.

use crate::edges::Edges;
use crate::live::Live;
use crate::pin::HalError;
use crate::reader::Reader;
use crate::source::{Bus, DeviceInfo, Losses, Registers, Source};
use crate::warning::SourceWarning;
use adis16130::{Sample, SelfTest};
use anyhow::{Result, bail};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{self, SpiDevice};
use std::time::Instant;
use zerorate::SettingNames;
use zerorate_record::Row;

const TIMED_READS: u32 = 200;

pub trait Connection {
    type Error: spi::Error + Send + Sync + 'static;
    type Spi: SpiDevice<Error = Self::Error>;
    type Edges: Edges;
    type Pin: OutputPin<Error = HalError>;

    /// True if reads go directly over an SPI bus of this computer, so that timing them is meaningful.
    const IS_BUS: bool;

    /// The requested SPI clock, Hz.
    fn hz(&self) -> u32;

    /// Sets the SPI clock, and returns the actual clock, Hz.
    fn set_clock(&self, hz: u32) -> Result<u32>;

    /// The self-test pins. `gpio` names their line if this computer drives them.
    fn self_test_pin(&self, gpio: &str, names: SettingNames) -> Result<Self::Pin>;

    fn start(&self, live: Box<Live<Self::Spi, Self::Edges>>) -> Result<Reader>;

    /// Adds advice to an error that the connection caused.
    fn explain(&self, error: anyhow::Error) -> anyhow::Error;

    /// Number of frames that arrived damaged from a bridge; 0 on a bus.
    fn damaged(&self) -> u64 {
        0
    }

    fn take_notes(&self) -> Vec<SourceWarning> {
        Vec::new()
    }
}

/// A part and, once sampling, the thread that reads it. Dropping this value ends the thread before the connection.
pub struct ConnectedPart<C: Connection> {
    state: State<C>,
    connection: C,
    facts: DeviceInfo,
}

enum State<C: Connection> {
    Ready(Box<Live<C::Spi, C::Edges>>),
    Reading(Reader),
    Ended,
}

impl<C: Connection> State<C> {
    fn ready(&mut self) -> Result<&mut Live<C::Spi, C::Edges>> {
        match self {
            Self::Ready(live) => Ok(live),
            _ => bail!("the part is being read already"),
        }
    }
}

impl<C: Connection> ConnectedPart<C> {
    pub fn new(connection: C, live: Live<C::Spi, C::Edges>, facts: DeviceInfo) -> Self {
        Self { state: State::Ready(Box::new(live)), connection, facts }
    }

    fn ask<T>(&mut self, ask: impl FnOnce(&mut Live<C::Spi, C::Edges>, &C) -> Result<T>) -> Result<T> {
        let live = self.state.ready()?;
        ask(live, &self.connection).map_err(|error| self.connection.explain(error))
    }

    fn next_sample(&mut self) -> Result<Sample> {
        if let State::Ready(_) = self.state
            && let State::Ready(live) = std::mem::replace(&mut self.state, State::Ended)
        {
            self.state = State::Reading(self.connection.start(live)?);
        }
        match &self.state {
            State::Reading(reader) => reader.next(),
            _ => bail!("the part is no longer read"),
        }
    }
}

/// Tests increasing clock rates. On this computer's bus, times a read at the requested clock. Configures the part.
fn try_bus<C: Connection>(live: &mut Live<C::Spi, C::Edges>, connection: &C) -> Result<Bus> {
    let fastest_clean_hz = live.fastest_clean_hz(|hz| connection.set_clock(hz))?;
    let sclk_hz = connection.set_clock(connection.hz())?;
    live.initialise()?;
    let mut read_s = None;
    if C::IS_BUS {
        let started = Instant::now();
        live.read_often(TIMED_READS)?;
        read_s = Some(started.elapsed().as_secs_f64() / f64::from(TIMED_READS));
    }
    Ok(Bus { sclk_hz, fastest_clean_hz, read_s })
}

impl<C: Connection> Source for ConnectedPart<C> {
    fn facts(&self) -> DeviceInfo {
        self.facts.clone()
    }

    fn initialise(&mut self) -> crate::Result<Option<u8>> {
        Ok(self.ask(|live, _| live.initialise()).map(Some)?)
    }

    fn next(&mut self) -> crate::Result<Option<Row>> {
        Ok(self.next_sample().map(|sample| Some(Row::from(&sample)))?)
    }

    fn try_bus(&mut self) -> crate::Result<Option<Bus>> {
        Ok(self.ask(try_bus).map(Some)?)
    }

    fn registers(&mut self) -> crate::Result<Option<Registers>> {
        Ok(self.ask(|live, _| live.registers()).map(Some)?)
    }

    fn self_test(&mut self, gpio: &str, names: SettingNames) -> crate::Result<SelfTest> {
        self.state.ready()?;
        let mut pin = self.connection.self_test_pin(gpio, names)?;
        Ok(self.ask(|live, _| live.self_test(&mut pin))?)
    }

    fn losses(&self) -> Losses {
        let overflowed = match &self.state {
            State::Reading(reader) => reader.overflowed(),
            _ => 0,
        };
        Losses { overflowed, damaged: self.connection.damaged() }
    }

    fn take_notes(&mut self) -> Vec<SourceWarning> {
        self.connection.take_notes()
    }
}
