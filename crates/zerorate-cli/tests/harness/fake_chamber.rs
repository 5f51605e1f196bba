//! A temperature chamber at a socket that fails in a way of its own, and knows what it was left at. The campaign of
//! `cargo xtask trust` includes this file too.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// The set point at which the plans of these tests leave a chamber, °C. None of their steps goes there.
pub const SAFE_C: f64 = 25.0;
/// The air of a chamber that is stuck, when a plan of these tests ends, °C. It harms no part.
const STUCK_C: f64 = 70.0;

/// Its commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speech {
    /// Answers each command, and can be stopped.
    Espec,
    /// Answers questions only, and cannot be stopped.
    F4t,
}

pub const SPEECHES: [Speech; 2] = [Speech::Espec, Speech::F4t];

/// How it fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Its sensor says 500 °C.
    Hot,
    /// Its air stays at 70 °C.
    Stuck,
    /// It hears nothing and says nothing.
    Silent,
    /// It hangs up, and again at each new connection.
    Closes,
    /// It takes no set point.
    Refuses,
    /// It hangs up, and at the next two connections; then all is well.
    AcceptsAgain,
    /// It obeys, and its answers get lost.
    Unheard,
}

pub const FAULTS: [Fault; 7] =
    [Fault::Hot, Fault::Stuck, Fault::Silent, Fault::Closes, Fault::Refuses, Fault::AcceptsAgain, Fault::Unheard];

/// When the fault begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Onset {
    /// From the first command on.
    Start,
    /// From this question on.
    Question(usize),
    /// From the safe set point on.
    End,
}

/// The state of the chamber.
#[derive(Debug)]
pub struct World {
    speech: Speech,
    fault: Fault,
    from: Onset,
    pub set_c: f64,
    pub is_on: bool,
    air_c: f64,
    questions: usize,
    connections: usize,
    /// The fault is there.
    pub is_faulty: bool,
    /// The lines that it received.
    pub heard: Vec<String>,
}

impl World {
    /// Whether it heats or cools to nothing but the safe set point.
    pub fn is_safe(&self) -> bool {
        !self.is_on || self.set_c == SAFE_C
    }

    /// Takes in a line; what it answers, and whether it stays on the line.
    fn hear(&mut self, line: &str) -> (Option<String>, bool) {
        self.heard.push(line.to_owned());
        let set_c = ["TEMP, S", ":SOURCE:CLOOP1:SPOINT "].iter().find_map(|head| line.strip_prefix(head));
        let set_c: Option<f64> = set_c.and_then(|text| text.parse().ok());
        let is_question = line.ends_with('?');
        self.questions += usize::from(is_question);
        self.is_faulty |= match self.from {
            Onset::Start => true,
            Onset::Question(number) => self.questions >= number,
            Onset::End => set_c == Some(SAFE_C),
        };
        if self.is_faulty {
            match self.fault {
                Fault::Silent => return (None, true),
                Fault::Closes => return (None, false),
                Fault::AcceptsAgain if self.connections <= 3 => return (None, false),
                Fault::Refuses if set_c.is_some() => {
                    return ((self.speech == Speech::Espec).then(|| "NA:DATA OUT OF RANGE".to_owned()), true);
                }
                _ => {}
            }
        }
        match line {
            "MODE, CONSTANT" => self.is_on = true,
            "MODE, STANDBY" => self.is_on = false,
            _ => {}
        }
        self.set_c = set_c.unwrap_or(self.set_c);
        let answer = if is_question { Some(self.answer(line)) } else { self.acknowledgement(line) };
        (answer.filter(|_| !self.is_faulty || self.fault != Fault::Unheard), true)
    }

    fn acknowledgement(&self, line: &str) -> Option<String> {
        (self.speech == Speech::Espec).then(|| format!("OK:{line}"))
    }

    /// A second passes with each question about the air.
    fn answer(&mut self, line: &str) -> String {
        if line == ":SOURCE:CLOOP1:SPOINT?" {
            return format!("{:.3}", self.set_c);
        }
        if self.is_on {
            self.air_c += (self.set_c - self.air_c) / 15.0;
        }
        let air_c = match self.fault {
            Fault::Hot if self.is_faulty => 500.0,
            Fault::Stuck if self.is_faulty => STUCK_C,
            _ => self.air_c,
        };
        match self.speech {
            Speech::Espec => format!("{air_c:.1},{:.1},150.0,-75.0", self.set_c),
            Speech::F4t => format!("{air_c:.3}"),
        }
    }
}

/// The chamber, for as long as the process lives.
pub struct FakeChamber {
    address: String,
    world: Arc<Mutex<World>>,
}

impl FakeChamber {
    pub fn new(speech: Speech, fault: Fault, from: Onset) -> std::io::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let address = listener.local_addr()?.to_string();
        let world = Arc::new(Mutex::new(World {
            speech,
            fault,
            from,
            // what it was used for before
            set_c: 60.0,
            // one that cannot be stopped always goes
            is_on: speech == Speech::F4t,
            air_c: 25.0,
            questions: 0,
            connections: 0,
            is_faulty: false,
            heard: Vec::new(),
        }));
        let inner = world.clone();
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let world = inner.clone();
                thread::spawn(move || serve(&stream, &world));
            }
        });
        Ok(Self { address, world })
    }

    /// The address for `--chamber`.
    pub fn argument(&self, patience_s: u32) -> String {
        let set = match self.world().speech {
            Speech::Espec => "espec",
            Speech::F4t => "f4t",
        };
        format!("tcp:{}?set={set}&patience_s={patience_s}", self.address)
    }

    pub fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns an error in the last word of a program that drove the chamber. There is none if the word is true, and
    /// the chamber is safe or the user knows that it may not be.
    pub fn complaint(&self, stderr: &str) -> Option<String> {
        let world = self.world();
        let last = stderr.lines().last().unwrap_or_default();
        let (left, stopped) = (last.contains("was left at 25.0 °C"), last.contains("stopped"));
        if world.heard.is_empty() || last.starts_with("warning: chamber-left: ") {
            return None;
        }
        let why = match () {
            () if !left && !stopped => "the last line does not say what it was left at",
            () if left && world.set_c != SAFE_C => "it was not left at 25 °C",
            () if stopped && world.is_on => "it was not stopped",
            () if !world.is_safe() => "it is not safe",
            () => return None,
        };
        Some(format!("{why}: {world:?}"))
    }
}

fn serve(stream: &TcpStream, world: &Mutex<World>) {
    let world = || world.lock().unwrap_or_else(PoisonError::into_inner);
    world().connections += 1;
    let Ok(mut writer) = stream.try_clone() else { return };
    for line in BufReader::new(stream).lines() {
        let Ok(line) = line else { return };
        let (answer, stays) = world().hear(line.trim());
        if !stays || answer.is_some_and(|answer| writer.write_all(format!("{answer}\r\n").as_bytes()).is_err()) {
            return;
        }
    }
}
