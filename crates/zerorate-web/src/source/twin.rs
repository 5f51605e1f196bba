//! The twin as a source, read through the driver.

use super::{Next, Source, about_part};
use crate::registers;
use crate::session::About;
use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, MCLK_HZ, Sampler, SamplerConfig};
use adis16130_twin::{Roa, Spec, Truth, Twin, TwinSpi};
use zerorate_record::Row;

/// The twin, the simulated sensor. Its simulated time advances with each reading.
pub struct TwinSource {
    about: About,
    twin: Twin,
    part: Adis16130<TwinSpi, ()>,
    sampler: Sampler,
    /// Time of the last reading, ns; before the first, the time when the part was opened.
    alive_ns: u64,
}

/// If there is no reading for this time, ns, the device counts as failed.
const SILENCE_NS: u64 = 1_000_000_000;

impl TwinSource {
    /// Switches on a simulated unit. The keys have the syntax of `--device twin:`.
    ///
    /// # Errors
    /// Returns an error if a key is unknown, or the part does not answer.
    pub fn open(keys: &str) -> Result<Self, String> {
        let spec = Spec::parse_keys(keys).map_err(|error| error.to_string())?;
        let has_capacitor = spec.roa == Roa::TenNanofarad;
        let config = Config::new();
        let twin = Twin::new(spec);
        let mut part = Adis16130::new(twin.spi(), (), config);
        part.restart().map_err(|error| error.to_string())?;
        let values = part.read_all().map_err(|error| error.to_string())?;
        let mut about = about_part(&format!("twin:{keys}"), &config, true, has_capacitor);
        about.registers = registers::described(&config, &values);
        let sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
        let alive_ns = twin.now_ns();
        Ok(Self { about, twin, part, sampler, alive_ns })
    }

    /// Handles a failed reading. A single failed reading counts as lost. A fault of the part or a long silence is an
    /// error.
    fn require_alive(&mut self) -> Result<(), String> {
        match self.part.diagnose() {
            Ok(Some(fault)) => Err(fault.to_string()),
            Ok(None) if self.twin.now_ns() - self.alive_ns < SILENCE_NS => Ok(()),
            Ok(None) => {
                Err("no data ready: the part answers, but RDY (pin 10) has announced no new data for a second".into())
            }
            Err(error) => Err(error.to_string()),
        }
    }
}

impl Source for TwinSource {
    fn about(&self) -> About {
        self.about.clone()
    }

    #[inline]
    fn next(&mut self) -> Result<Next, String> {
        loop {
            let Some(edge) = self.twin.next_falling_edge(SILENCE_NS) else {
                self.require_alive()?;
                continue;
            };
            match self.part.sample(&mut self.sampler, Edge { t_ns: edge.t_ns, seq: edge.seq }) {
                Ok(Some(sample)) => {
                    self.alive_ns = sample.t_ns;
                    return Ok(Next::Row(Row::from(&sample)));
                }
                Ok(None) if edge.t_ns.saturating_sub(self.alive_ns) < SILENCE_NS => {}
                Ok(None) | Err(_) => self.require_alive()?,
            }
        }
    }

    fn truths(&self) -> Vec<Truth> {
        vec![self.twin.truth()]
    }
}
