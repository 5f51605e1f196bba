//! Chambers that take lines of text over TCP or a serial port.

use super::{Chamber, name_and_options, patience};
use crate::bridge::Wire;
use crate::error::{Cause, Told};
use crate::options::number;
use crate::{DeviceError, Result};
use anyhow::Context;
use std::collections::VecDeque;
use std::fmt;
use std::thread;
use std::time::{Duration, Instant};

/// The commands of one kind of chamber. `{}` is the temperature in °C with a decimal; `¶` goes out as byte B6h.
#[derive(Debug, PartialEq)]
pub struct Dialect {
    /// What `set=` calls it.
    pub name: &'static str,
    /// Whose it is.
    pub of: &'static str,
    /// TCP port, where the address states none.
    pub port: u16,
    /// Baud rate, where the address states none.
    pub baud: u32,
    /// Behind each command.
    pub end: &'static str,
    /// Told first.
    pub start: &'static [&'static str],
    /// Tells the set point.
    pub set: &'static str,
    /// Asks for the air.
    pub read: &'static str,
    /// Which field of the answer is the air, and what is between fields.
    pub field: (usize, char),
    /// How the answer to a command that is no question begins, if there is one.
    pub accepted: Option<&'static str>,
    /// Told last, after the safe set point.
    pub stop: &'static [&'static str],
}

/// The kinds that are known. From their documentation; none was tried on a chamber.
pub const DIALECTS: [Dialect; 3] = [
    Dialect {
        name: "espec",
        of: "Espec P300, SCP-220",
        port: 10_001,
        baud: 19_200,
        end: "\r\n",
        start: &["MODE, CONSTANT"],
        set: "TEMP, S{}",
        read: "TEMP?",
        field: (0, ','),
        accepted: Some("OK"),
        stop: &["MODE, STANDBY"],
    },
    Dialect {
        name: "f4t",
        of: "Watlow F4T (TestEquity, Espec): SCPI",
        port: 5025,
        baud: 38_400,
        end: "\n",
        start: &[":UNIT:TEMPERATURE C", ":SOURCE:CLOOP1:RACTION OFF"],
        set: ":SOURCE:CLOOP1:SPOINT {}",
        read: ":SOURCE:CLOOP1:PVALUE?",
        field: (0, ','),
        accepted: None,
        stop: &[],
    },
    Dialect {
        name: "simserv",
        of: "Weiss, Vötsch (S!MPAC, SimServ)",
        port: 2049,
        baud: 19_200,
        end: "\r",
        start: &["14001¶1¶1¶1"],
        set: "11001¶1¶1¶{}",
        read: "11004¶1¶1",
        field: (1, '¶'),
        accepted: Some("1"),
        stop: &["14001¶1¶1¶0"],
    },
];

/// Where such a chamber is.
#[derive(Clone, Debug, PartialEq)]
pub struct LineAddress {
    place: Place,
    dialect: &'static Dialect,
    patience: Duration,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Tcp(String),
    Serial { path: String, baud: u32 },
}

/// A lost connection is made anew for so long, unless the address says otherwise.
const PATIENCE: Duration = Duration::from_secs(60);
/// A chamber answers within this.
const ANSWER: Duration = Duration::from_secs(2);
/// First wait before a connection is made anew; it doubles each time.
const FIRST_WAIT: Duration = Duration::from_millis(100);
const LONGEST_WAIT: Duration = Duration::from_secs(5);
/// Letters of an answer at most.
const LONGEST_LINE: usize = 1000;

impl LineAddress {
    pub(super) fn parse(text: &str, is_serial: bool) -> Result<Self, String> {
        let (name, options) = name_and_options(text);
        if name.is_empty() {
            return Err(
                "where is it? As in tcp:192.168.0.7:10001?set=espec or serial:/dev/ttyUSB0?set=espec".to_owned()
            );
        }
        let (mut dialect, mut baud, mut wait) = (None, None, PATIENCE);
        for (key, value) in options {
            match key {
                "set" => dialect = Some(dialect_of(value)?),
                "baud" if is_serial => baud = Some(number("baud", value, 300..=1_000_000)?),
                "patience_s" => wait = patience(value)?,
                _ => {
                    let also = if is_serial { ", baud=N" } else { "" };
                    return Err(format!("`{key}`: options are set={}, patience_s=N{also}", names()));
                }
            }
        }
        let dialect = dialect.ok_or_else(|| format!("say which commands it takes: set={}", names()))?;
        let place = match (is_serial, name.rsplit_once(':')) {
            (true, _) => Place::Serial { path: name.to_owned(), baud: baud.unwrap_or(dialect.baud) },
            (false, Some(_)) => Place::Tcp(name.to_owned()),
            (false, None) => Place::Tcp(format!("{name}:{}", dialect.port)),
        };
        Ok(Self { place, dialect, patience: wait })
    }

    fn connect(&self) -> anyhow::Result<Wire> {
        match &self.place {
            Place::Tcp(address) => Wire::connect(address).with_context(|| format!("no chamber answers at {address}")),
            Place::Serial { path, baud } => {
                let port = serialport::new(path, *baud).timeout(ANSWER).open();
                Ok(Wire::Serial(
                    port.with_context(|| format!("the serial port {path} of the chamber cannot be opened"))?,
                ))
            }
        }
    }
}

impl fmt::Display for LineAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, dialect, .. } = self;
        match place {
            Place::Tcp(address) => write!(f, "the chamber at {address} ({})", dialect.name),
            Place::Serial { path, .. } => write!(f, "the chamber at {path} ({})", dialect.name),
        }
    }
}

fn names() -> String {
    DIALECTS.iter().map(|dialect| dialect.name).collect::<Vec<_>>().join("|")
}

fn dialect_of(name: &str) -> Result<&'static Dialect, String> {
    let found = DIALECTS.iter().find(|dialect| dialect.name == name);
    found.ok_or_else(|| format!("`set={name}`: there are {} (docs/chamber.md)", names()))
}

/// Why an exchange failed.
enum Failure {
    /// The connection; a new one may do.
    Lost(anyhow::Error),
    /// The chamber understood, and said no.
    Refused(String),
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Lost(error)
    }
}

/// A chamber at the end of a wire.
pub(super) struct Lines {
    address: LineAddress,
    wire: Option<Wire>,
    received: VecDeque<u8>,
}

impl Lines {
    pub fn open(address: &LineAddress) -> Result<Self> {
        let mut lines = Self { address: address.clone(), wire: None, received: VecDeque::new() };
        lines.connect().map_err(|failure| lines.told(failure))?;
        Ok(lines)
    }

    fn connect(&mut self) -> Result<(), Failure> {
        self.received.clear();
        self.wire = Some(self.address.connect()?);
        self.address.dialect.start.iter().try_for_each(|command| self.command(command))
    }

    /// Tells it something that is no question.
    fn command(&mut self, command: &str) -> Result<(), Failure> {
        self.send(command)?;
        let Some(accepted) = self.address.dialect.accepted else { return Ok(()) };
        let answer = self.answer()?;
        if answer.starts_with(accepted) {
            return Ok(());
        }
        Err(Failure::Refused(format!("it answers {answer:?} to {command:?}")))
    }

    fn send(&mut self, command: &str) -> Result<(), Failure> {
        let bytes: Vec<u8> = command.chars().chain(self.address.dialect.end.chars()).map(|c| c as u8).collect();
        let Some(wire) = &mut self.wire else { return Err(anyhow::anyhow!("there is no connection").into()) };
        Ok(wire.write(&bytes).context("sending a command")?)
    }

    /// The next line that is not empty.
    fn answer(&mut self) -> Result<String, Failure> {
        let until = Instant::now() + ANSWER;
        loop {
            while let Some(end) = self.received.iter().position(|byte| matches!(byte, b'\r' | b'\n')) {
                let line: String = self.received.drain(..=end).map(char::from).collect();
                if !line.trim().is_empty() {
                    return Ok(line.trim().to_owned());
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            let Some(wire) = self.wire.as_mut().filter(|_| !left.is_zero() && self.received.len() < LONGEST_LINE)
            else {
                return Err(anyhow::anyhow!("no answer within {} s", ANSWER.as_secs()).into());
            };
            wire.read(left, &mut self.received).context("waiting for an answer")?;
        }
    }

    fn ask_air(&mut self) -> Result<f64, Failure> {
        let &Dialect { read, field: (index, between), .. } = self.address.dialect;
        self.send(read)?;
        let answer = self.answer()?;
        let number = answer.split(between).nth(index).and_then(|text| text.trim().parse::<f64>().ok());
        let sensible = number.filter(|air_c| (-273.0..=1000.0).contains(air_c));
        sensible.ok_or_else(|| Failure::Refused(format!("it answers {answer:?} to {read:?}, where °C were expected")))
    }

    fn tell(&mut self, temp_c: f64) -> Result<(), Failure> {
        let command = self.address.dialect.set.replace("{}", &format!("{temp_c:.1}"));
        self.command(&command)
    }

    /// Does something; where the connection is lost, makes a new one until the patience ends.
    fn persist<T>(&mut self, mut what: impl FnMut(&mut Self) -> Result<T, Failure>) -> Result<T> {
        let (until, mut wait) = (Instant::now() + self.address.patience, FIRST_WAIT);
        let mut done = what(self);
        loop {
            match done {
                Ok(done) => return Ok(done),
                Err(Failure::Lost(_)) if Instant::now() < until => {
                    thread::sleep(wait);
                    wait = (wait * 2).min(LONGEST_WAIT);
                    done = self.connect().and_then(|()| what(self));
                }
                Err(failure) => return Err(self.told(failure)),
            }
        }
    }

    fn told(&self, failure: Failure) -> DeviceError {
        let Self { address, .. } = self;
        match failure {
            Failure::Refused(what) => {
                let words = format!("{address}: {what}; check which commands it takes (set=…, docs/chamber.md)");
                anyhow::Error::from(Told::new(Cause::Part, words)).into()
            }
            Failure::Lost(error) => {
                let patience_s = address.patience.as_secs();
                let words = format!(
                    "{address} is lost, and was not found again within {patience_s} s; check its cable, and that \
                     nobody else is connected (patience_s=… waits longer)"
                );
                error.context(Told::new(Cause::Gone, words)).into()
            }
        }
    }
}

impl Chamber for Lines {
    fn set(&mut self, temp_c: f64) -> Result<()> {
        self.persist(|lines| lines.tell(temp_c))
    }

    fn read_c(&mut self) -> Result<Option<f64>> {
        self.persist(Self::ask_air).map(Some)
    }

    fn end(&mut self, safe_c: f64) -> Result<()> {
        let ended = (|| {
            if self.wire.is_none() {
                self.connect()?;
            }
            self.tell(safe_c)?;
            self.address.dialect.stop.iter().try_for_each(|command| self.command(command))
        })();
        ended.map_err(|failure| self.told(failure))
    }
}
