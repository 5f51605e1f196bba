//! Chambers that take lines of text over TCP or a serial port.

use super::{Chamber, Left, name_and_options, patience};
use crate::error::{Cause, UserError};
use crate::options::number;
use crate::wire::Wire;
use crate::{DeviceError, Result, Stop};
use anyhow::Context;
use std::collections::VecDeque;
use std::fmt;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// The commands of one kind of chamber. `{}` is the temperature in °C with a decimal; `¶` goes out as byte B6h.
#[derive(Debug, PartialEq)]
pub struct Dialect {
    /// Name of the command set in `set=`.
    pub name: &'static str,
    /// Whose it is.
    pub of: &'static str,
    /// TCP port, where the address states none.
    pub port: u16,
    /// Baud rate, where the address states none.
    pub baud: u32,
    /// Behind each command.
    pub end: &'static str,
    /// Told first, whenever it is connected to: how it is spoken to. Heats and cools nothing.
    pub manners: &'static [&'static str],
    /// Told then: sets it going.
    pub start: &'static [&'static str],
    /// Tells the set point.
    pub set: &'static str,
    /// Asks for the air.
    pub read: &'static str,
    /// Index of the field of the answer that holds the air temperature, and the separator of fields.
    pub field: (usize, char),
    /// Asks for the set point, and where it is in the answer.
    pub read_set: &'static str,
    /// The same for the set point.
    pub set_field: (usize, char),
    /// Start of the answer to a command that is not a question, if the chamber answers one.
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
        manners: &[],
        start: &["MODE, CONSTANT"],
        set: "TEMP, S{}",
        read: "TEMP?",
        field: (0, ','),
        read_set: "TEMP?",
        set_field: (1, ','),
        accepted: Some("OK"),
        stop: &["MODE, STANDBY"],
    },
    Dialect {
        name: "f4t",
        of: "Watlow F4T (TestEquity, Espec): SCPI",
        port: 5025,
        baud: 38_400,
        end: "\n",
        manners: &[":UNIT:TEMPERATURE C", ":SOURCE:CLOOP1:RACTION OFF"],
        start: &[],
        set: ":SOURCE:CLOOP1:SPOINT {}",
        read: ":SOURCE:CLOOP1:PVALUE?",
        field: (0, ','),
        read_set: ":SOURCE:CLOOP1:SPOINT?",
        set_field: (0, ','),
        accepted: None,
        stop: &[],
    },
    Dialect {
        name: "simserv",
        of: "Weiss, Vötsch (S!MPAC, SimServ)",
        port: 2049,
        baud: 19_200,
        end: "\r",
        manners: &[],
        start: &["14001¶1¶1¶1"],
        set: "11001¶1¶1¶{}",
        read: "11004¶1¶1",
        field: (1, '¶'),
        read_set: "11002¶1¶1",
        set_field: (1, '¶'),
        accepted: Some("1"),
        stop: &["14001¶1¶1¶0"],
    },
];

/// The connection to such a chamber.
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
/// A connection is made within this, the look-up of a name included.
const CONNECTION: Duration = Duration::from_secs(4);
/// Time between two checks whether a wait was asked to stop.
const SLICE: Duration = Duration::from_millis(50);
/// A chamber that is left is told again and again for so long, s, as long as it has not confirmed.
pub const ENDING_S: u64 = 10;
/// The same, where somebody waits for the program to end.
const HURRIED: Duration = Duration::from_secs(2);
/// The longest wait between two attempts then.
const LONGEST_ENDING_WAIT: Duration = Duration::from_secs(1);
/// An answer comes within this where somebody waits.
const HURRIED_ANSWER: Duration = Duration::from_secs(1);
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
    /// It was asked to stop.
    Stopped,
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Lost(error)
    }
}

impl Failure {
    fn words(&self) -> String {
        match self {
            Self::Lost(error) => format!("{error:#}"),
            Self::Refused(what) => what.clone(),
            Self::Stopped => "it was asked to stop".to_owned(),
        }
    }
}

/// A chamber at the end of a wire.
pub(super) struct Lines {
    address: LineAddress,
    /// Either ends every wait: the stop of the user, and the stop of the owner of the chamber.
    stops: [Stop; 2],
    wire: Option<Wire>,
    received: VecDeque<u8>,
    /// Something was sent to it, which it may have obeyed.
    is_touched: bool,
    /// The set point sent last, °C: told again at each new connection.
    wanted_c: Option<f64>,
    /// It is being left. Nothing but time ends a wait then.
    is_leaving: bool,
    /// An answer comes within this.
    answer: Duration,
}

impl Lines {
    pub fn new(address: &LineAddress, stop: &Stop) -> Self {
        Self {
            address: address.clone(),
            stops: [stop.clone(), Stop::default()],
            wire: None,
            received: VecDeque::new(),
            is_touched: false,
            wanted_c: None,
            is_leaving: false,
            answer: ANSWER,
        }
    }

    /// A new connection in place of the old one, with all that the chamber has to know; one that is being left is not
    /// started again.
    fn connect(&mut self) -> Result<(), Failure> {
        self.received.clear();
        self.wire = None;
        self.wire = Some(self.new_wire()?);
        let Dialect { manners, start, .. } = self.address.dialect;
        let told = self.tell_all(manners).and_then(|()| match (self.is_leaving, self.wanted_c) {
            (true, _) => Ok(()),
            (false, wanted_c) => self.tell_all(start).and_then(|()| wanted_c.map_or(Ok(()), |c| self.tell(c))),
        });
        self.unless_lost(told)
    }

    /// Names are looked up, and addresses tried, in a thread that is left to itself where it takes too long.
    fn new_wire(&self) -> Result<Wire, Failure> {
        if matches!(self.address.place, Place::Serial { .. }) {
            return Ok(self.address.connect()?);
        }
        let (address, (made, wire)) = (self.address.clone(), mpsc::channel());
        thread::Builder::new()
            .name("connection".to_owned())
            .spawn(move || made.send(address.connect()))
            .map_err(anyhow::Error::from)?;
        let until = Instant::now() + CONNECTION;
        loop {
            self.heed()?;
            match wire.recv_timeout(SLICE) {
                Ok(wire) => return Ok(wire?),
                Err(RecvTimeoutError::Timeout) if Instant::now() < until => {}
                Err(_) => return Err(anyhow::anyhow!("no connection within {} s", CONNECTION.as_secs()).into()),
            }
        }
    }

    /// Whether nobody asked to stop.
    fn heed(&self) -> Result<(), Failure> {
        match !self.is_leaving && self.stops.iter().any(Stop::asked) {
            true => Err(Failure::Stopped),
            false => Ok(()),
        }
    }

    fn pause(&self, wait: Duration) -> Result<(), Failure> {
        let until = Instant::now() + wait;
        loop {
            self.heed()?;
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            thread::sleep(left.min(SLICE));
        }
    }

    /// A connection on which something got lost is not used again: what comes late would answer the next question.
    fn unless_lost<T>(&mut self, done: Result<T, Failure>) -> Result<T, Failure> {
        if matches!(done, Err(Failure::Lost(_))) {
            self.wire = None;
        }
        done
    }

    fn tell_all(&mut self, commands: &[&str]) -> Result<(), Failure> {
        commands.iter().try_for_each(|command| self.command(command))
    }

    /// Sends a command that is not a question.
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
        self.is_touched |= self.wire.is_some();
        let Some(wire) = &mut self.wire else { return Err(anyhow::anyhow!("there is no connection").into()) };
        Ok(wire.write(&bytes).context("sending a command")?)
    }

    /// The next line that is not empty.
    fn answer(&mut self) -> Result<String, Failure> {
        let until = Instant::now() + self.answer;
        loop {
            self.heed()?;
            while let Some(end) = self.received.iter().position(|byte| matches!(byte, b'\r' | b'\n')) {
                let line: String = self.received.drain(..=end).map(char::from).collect();
                if !line.trim().is_empty() {
                    return Ok(line.trim().to_owned());
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            let Some(wire) = self.wire.as_mut().filter(|_| !left.is_zero() && self.received.len() < LONGEST_LINE)
            else {
                return Err(anyhow::anyhow!("no answer within {} s", self.answer.as_secs()).into());
            };
            wire.read(left.min(SLICE), &mut self.received).context("waiting for an answer")?;
        }
    }

    fn ask_air(&mut self) -> Result<f64, Failure> {
        self.ask(self.address.dialect.read, self.address.dialect.field)
    }

    fn ask_set(&mut self) -> Result<f64, Failure> {
        self.ask(self.address.dialect.read_set, self.address.dialect.set_field)
    }

    /// A temperature, °C, in a field of an answer.
    fn ask(&mut self, question: &str, (index, between): (usize, char)) -> Result<f64, Failure> {
        self.send(question)?;
        let answer = self.answer()?;
        let number = answer.split(between).nth(index).and_then(|text| text.trim().parse::<f64>().ok());
        let sensible = number.filter(|temp_c| (-273.0..=1000.0).contains(temp_c));
        sensible
            .ok_or_else(|| Failure::Refused(format!("it answers {answer:?} to {question:?}, where °C were expected")))
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
                    let paused = self.pause(wait);
                    wait = (wait * 2).min(LONGEST_WAIT);
                    done = paused.and_then(|()| self.connect()).and_then(|()| what(self));
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
                anyhow::Error::from(UserError::new(Cause::Part, words)).into()
            }
            Failure::Lost(error) => {
                let patience_s = address.patience.as_secs();
                let words = format!(
                    "{address} is lost, and was not found again within {patience_s} s; check its cable, and that \
                     nobody else is connected (patience_s=… waits longer)"
                );
                error.context(UserError::new(Cause::Gone, words)).into()
            }
            Failure::Stopped => {
                let words = format!("{address} was waited for, and it was asked to stop");
                anyhow::Error::from(UserError::new(Cause::Stopped, words)).into()
            }
        }
    }

    /// Does something once, by a new connection where there is none.
    fn attempt<T>(&mut self, what: impl FnOnce(&mut Self) -> Result<T, Failure>) -> Result<T, Failure> {
        if self.wire.is_none() {
            self.connect()?;
        }
        let done = what(self);
        self.unless_lost(done)
    }

    /// Tries the set point and the stop, each by itself, and asks what came of them.
    fn leave(&mut self, safe_c: f64) -> Left {
        let &Dialect { accepted, stop, .. } = self.address.dialect;
        let set = self.attempt(|lines| lines.tell(safe_c));
        let stopped = self.attempt(|lines| lines.tell_all(stop));
        let is_confirmed = accepted.is_some() && set.is_ok();
        let held = if is_confirmed { Ok(safe_c) } else { self.attempt(Self::ask_set) };
        let air_c = if held.is_ok() || stopped.is_ok() { self.attempt(Self::ask_air).ok() } else { None };
        Left {
            set_c: held.as_ref().ok().copied(),
            is_stopped: accepted.is_some() && !stop.is_empty() && stopped.is_ok(),
            air_c,
            why: set.err().or(stopped.err()).or(held.err()).map(|failure| failure.words()),
        }
    }
}

impl Chamber for Lines {
    fn start(&mut self) -> Result<()> {
        let started = self.connect().and_then(|()| self.ask_air());
        started.map(drop).map_err(|failure| match failure {
            Failure::Lost(error) => {
                let words = format!(
                    "{} does not answer; check that it is on, its cable, and which commands it takes (set=…)",
                    self.address
                );
                error.context(UserError::new(Cause::Gone, words)).into()
            }
            failure => self.told(failure),
        })
    }

    fn set(&mut self, temp_c: f64) -> Result<()> {
        self.wanted_c = Some(temp_c);
        self.persist(|lines| lines.tell(temp_c))
    }

    fn read_c(&mut self) -> Result<Option<f64>> {
        self.persist(Self::ask_air).map(Some)
    }

    fn halt(&self) -> Stop {
        self.stops[1].clone()
    }

    fn end(&mut self, safe_c: f64) -> Option<Left> {
        if !self.is_touched {
            return None;
        }
        self.is_leaving = true;
        let (began, mut wait) = (Instant::now(), FIRST_WAIT);
        loop {
            let mut most = Duration::from_secs(ENDING_S);
            if self.stops[0].asked() {
                (most, self.answer) = (HURRIED, HURRIED_ANSWER);
            }
            let left = self.leave(safe_c);
            if left.is_safe(safe_c) || began.elapsed() + wait >= most {
                return Some(left);
            }
            thread::sleep(wait);
            wait = (wait * 2).min(LONGEST_ENDING_WAIT);
        }
    }
}
