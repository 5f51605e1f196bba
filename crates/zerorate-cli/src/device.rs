//! Where samples come from: the simulated part, or a recording of one.

use crate::capture::{CaptureInfo, CaptureReader};
use crate::cli::SamplingArgs;
use crate::exit::Usage;
use adis16130::blocking::Adis16130;
use adis16130::{Config, ConversionTime, Edge, Fault, MCLK_HZ, Sample, SampleError, Sampler, SamplerConfig};
use adis16130_twin::{Spec, Truth, Twin, TwinRdy, TwinSpi};
use anyhow::{Result, anyhow};
use std::convert::Infallible;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// What `--device` names.
#[derive(Clone, Debug)]
pub enum DeviceSpec {
    /// `twin:KEY=VALUE,…`
    Twin {
        /// As it was given.
        keys: String,
        /// What it says.
        spec: Box<Spec>,
    },
    /// `replay:FILE`
    Replay(PathBuf),
}

/// Kinds that the command line names and a later version reads.
const NOT_YET: [&str; 4] = ["spi", "bridge", "tcp", "iio"];
const TODAY: &str = "today there are twin:, twin:KEY=VALUE,… and replay:FILE";

impl FromStr for DeviceSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            Some(("twin", keys)) => {
                let spec = Spec::parse_keys(keys).map_err(|error| error.to_string())?;
                Ok(Self::Twin { keys: keys.to_owned(), spec: Box::new(spec) })
            }
            Some(("replay", "")) => Err("replay: needs the file, as in replay:unit.arrows".to_owned()),
            Some(("replay", path)) => Ok(Self::Replay(path.into())),
            Some((kind, _)) if NOT_YET.contains(&kind) => {
                Err(format!("this version cannot read {kind}: devices yet; {TODAY}"))
            }
            _ if text == "twin" => Err("write twin: with the colon".to_owned()),
            _ if std::path::Path::new(text).is_file() => {
                Err(format!("that is a file; to replay it write replay:{text}"))
            }
            _ => Err(format!("no such kind of device; {TODAY}")),
        }
    }
}

impl fmt::Display for DeviceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Twin { keys, .. } => write!(f, "twin:{keys}"),
            Self::Replay(path) => write!(f, "replay:{}", path.display()),
        }
    }
}

/// A source of samples, opened.
pub enum Device {
    Twin(Box<TwinDevice>),
    Replay(Box<Replay>),
}

impl Device {
    /// Opens the device; sends nothing yet.
    pub fn open(spec: &DeviceSpec, sampling: SamplingArgs) -> Result<Self> {
        match spec {
            DeviceSpec::Twin { spec: unit, .. } => {
                let twin = TwinDevice::new(spec.to_string(), (**unit).clone(), sampling);
                Ok(Self::Twin(Box::new(twin)))
            }
            DeviceSpec::Replay(path) => {
                if sampling.every_temp.is_some() || sampling.divider.is_some() {
                    let why = "--every-temp and --divider were decided when the recording was made; leave them out";
                    return Err(Usage(why.to_owned()).into());
                }
                let reader = CaptureReader::open(path)?;
                Ok(Self::Replay(Box::new(Replay { reader, warned: false })))
            }
        }
    }

    /// Resets the part, initialises it, and reads everything back. Returns the revision; a recording has none.
    pub fn initialise(&mut self) -> Result<Option<u8>> {
        match self {
            Self::Twin(twin) => twin.initialise().map(Some),
            Self::Replay(_) => Ok(None),
        }
    }

    /// The next sample; `None` at the end of a recording.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Sample>> {
        match self {
            Self::Twin(twin) => twin.next().map(Some),
            Self::Replay(replay) => replay.next(),
        }
    }

    /// How the samples are taken; the serial number and the note are those given, or else those of the recording.
    pub fn info(&self, serial: Option<&str>, supply_note: Option<&str>) -> CaptureInfo {
        let mut info = match self {
            Self::Twin(twin) => twin.info(),
            Self::Replay(replay) => replay.reader.info().clone(),
        };
        info.serial = serial.map(str::to_owned).or(info.serial);
        info.supply_note = supply_note.map(str::to_owned).or(info.supply_note);
        info
    }

    /// What is being read.
    pub fn name(&self) -> String {
        match self {
            Self::Twin(twin) => twin.name.clone(),
            Self::Replay(replay) => format!("recording of {}", replay.reader.info().device),
        }
    }

    /// The twin's truth about its slow bias now.
    pub fn truth(&self) -> Option<Truth> {
        match self {
            Self::Twin(twin) => Some(twin.twin.truth()),
            Self::Replay(_) => None,
        }
    }

    /// Rate samples per second at the nominal master clock: one of 2/(N + 1) conversion pairs with a divider of N (F-31, F-56).
    pub fn nominal_rate_hz(&self) -> f64 {
        let info = self.info(None, None);
        let cycles = [info.rate_conversion, info.temp_conversion].map(|bits| ConversionTime::new(bits).cycles(true));
        let pairs_hz = f64::from(MCLK_HZ) / f64::from(cycles[0] + cycles[1]);
        pairs_hz * 2.0 / (f64::from(info.divider) + 1.0)
    }
}

/// The driver, reading the twin.
pub struct TwinDevice {
    name: String,
    twin: Twin,
    part: Adis16130<TwinSpi, TwinRdy>,
    sampling: SamplerConfig,
    sampler: Sampler,
    /// Time of the last sample, or of the initialisation.
    alive_ns: u64,
}

/// So long without a data-ready edge is a failure.
const SILENCE_NS: u64 = 1_000_000_000;

/// An initialised part shows many edges in this time (F-32).
const SIGN_OF_LIFE_NS: u64 = 100_000_000;
const UNPLUGGED: &str = "the part is unplugged or has no power: data ready (pin 10) is silent and SDO (pin 12) is dead; check the cable and the 5 V supply (pins 11, 13, 15)";

impl TwinDevice {
    fn new(name: String, unit: Spec, sampling: SamplingArgs) -> Self {
        let twin = Twin::new(unit);
        let config = Config::new();
        let part = Adis16130::new(twin.spi(), twin.rdy(), config);
        let sampling = SamplerConfig::new()
            .with_every_temp(sampling.every_temp.unwrap_or(1))
            .with_divider(sampling.divider.unwrap_or(1));
        let sampler = Sampler::new(sampling, &config, MCLK_HZ);
        Self { name, twin, part, sampling, sampler, alive_ns: 0 }
    }

    fn initialise(&mut self) -> Result<u8> {
        let revision = self.start().map_err(|error| match self.twin.next_falling_edge(SIGN_OF_LIFE_NS) {
            Some(_) => error
                .context("data ready comes (pin 10), so the part is alive and hears, but does not answer as it should"),
            None => error.context(UNPLUGGED),
        })?;
        self.alive_ns = self.twin.now_ns();
        Ok(revision)
    }

    fn start(&mut self) -> Result<u8> {
        self.part.reset()?;
        self.part.init_verified()?;
        Ok(self.part.revision()?.bits())
    }

    #[inline]
    fn next(&mut self) -> Result<Sample> {
        loop {
            let Some(edge) = self.twin.next_falling_edge(SILENCE_NS) else {
                return Err(self.why_silent());
            };
            let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
            match self.part.sample(&mut self.sampler, edge) {
                Ok(Some(sample)) => {
                    self.alive_ns = sample.t_ns;
                    return Ok(sample);
                }
                Ok(None) => self.require_alive(edge.t_ns)?,
                Err(error) => self.require_transient(error, edge.t_ns)?,
            }
        }
    }

    fn info(&self) -> CaptureInfo {
        let config = self.part.config();
        CaptureInfo {
            device: self.name.clone(),
            serial: None,
            width: config.width(),
            rate_conversion: config.rate_conversion().bits(),
            temp_conversion: config.temp_conversion().bits(),
            every_temp: self.sampling.every_temp,
            divider: self.sampling.divider,
            software: crate::SOFTWARE.to_owned(),
            created: String::new(),
            supply_note: None,
        }
    }

    /// A failed read whose cause is gone is a lost sample, and the sampler counts it; anything else ends the measurement.
    #[cold]
    fn require_transient(&mut self, error: SampleError<Infallible>, now_ns: u64) -> Result<()> {
        match self.part.diagnose()? {
            None if now_ns.saturating_sub(self.alive_ns) < self.silence_ns() => Ok(()),
            None => Err(self.at(error.into())),
            Some(fault) => Err(self.at(fault.into())),
        }
    }

    /// Edges without new data: the part may be gone, and its line float.
    #[inline]
    fn require_alive(&mut self, now_ns: u64) -> Result<()> {
        if now_ns.saturating_sub(self.alive_ns) < self.silence_ns() { Ok(()) } else { Err(self.why_silent()) }
    }

    fn silence_ns(&self) -> u64 {
        // 1024 edges at 11.4 kHz are 0.09 s, so this is ten times the time from one sample to the next
        SILENCE_NS * (1 + u64::from(self.sampling.divider) / 1024)
    }

    #[cold]
    fn why_silent(&mut self) -> anyhow::Error {
        let fault = match self.part.diagnose() {
            Ok(None) => anyhow!(
                "no data ready: the part answers and is configured, but RDY (pin 10) brought no new data for a second; check the RDY wire"
            ),
            Ok(Some(fault @ (Fault::StuckHigh(_) | Fault::StuckLow(_)))) => {
                anyhow::Error::new(fault).context(UNPLUGGED)
            }
            Ok(Some(fault)) => fault.into(),
            Err(error) => error.into(),
        };
        self.at(fault)
    }

    fn at(&self, error: anyhow::Error) -> anyhow::Error {
        error.context(format!("{:.1} s after power-on", self.twin.now_ns() as f64 * 1e-9))
    }
}

/// A recording.
pub struct Replay {
    reader: CaptureReader,
    warned: bool,
}

impl Replay {
    #[inline]
    fn next(&mut self) -> Result<Option<Sample>> {
        let sample = self.reader.next().transpose()?;
        if sample.is_none() {
            self.warn_once();
        }
        Ok(sample)
    }

    #[cold]
    fn warn_once(&mut self) {
        if let Some(warning) = self.reader.warning().filter(|_| !self.warned) {
            eprintln!("warning: {warning}");
        }
        self.warned = true;
    }
}
