//! Compares the results of the driver with the twin's truth.

use adis16130::{Channels, Config, ConversionTime, MIN_SCLK_HZ, RateCode, Sample, SamplerConfig, TempCode, Width};
use adis16130_twin::{Conversion, Fault, Reading, Twin};

use crate::bus::Trouble;
use crate::ledger::{Ledger, SampleRecord};

/// The result of a check. The error names the broken rule.
pub type Verdict = Result<(), String>;

pub struct Judge {
    twin: Twin,
    mclk_hz: f64,
    period_ns: f64,
    sampling: SamplerConfig,
    /// Whether the SPI clock is at least [`MIN_SCLK_HZ`] (F-33).
    is_fast: bool,
    /// Whether `lost` is checked: there is no divider, the bus is fast, and each conversion takes at least a quarter
    /// of the period. The edges of a shorter conversion cannot be told from those of the other channel before the
    /// period is learned.
    counts: bool,
    /// Whether the sampler can find out which edges announce rates.
    knows_edges: bool,
    ledger: Ledger,
    /// Numbers of the latest conversions of the rate and of the temperature that a sample has contained.
    handed: (u64, u64),
    fault: Fault,
    /// Whether bits were flipped, or bytes sent without this driver. Part and driver may disagree until a restart.
    spoiled: bool,
    /// Whether conversions stopped or began anew, or an edge was false, without a call that tells the sampler. `lost`
    /// may have any value until a restart.
    uncounted: bool,
    /// Whether the line lost edges, or a reading outside the sampler took their data.
    edges_missing: bool,
    /// Whether the sampler got edges while `uncounted`, or false information, so that a new sampler is needed.
    bewildered: bool,
    /// Whether a call was cut short, so that nothing may be sent until a reset.
    interrupted: bool,
    /// Whether a fault set in during this call. The driver cannot detect a fault that begins within a reading.
    struck: bool,
    /// Start of the present call if it may send nothing, in ns of the twin's time.
    silent_from_ns: Option<u64>,
}

impl Judge {
    pub fn new(twin: &Twin, mclk_hz: f64, config: &Config, sampling: SamplerConfig) -> Self {
        let mut judge = Self {
            twin: twin.clone(),
            mclk_hz,
            period_ns: 0.0,
            sampling,
            is_fast: false,
            counts: false,
            knows_edges: false,
            ledger: Ledger::default(),
            handed: (0, 0),
            fault: Fault::None,
            spoiled: false,
            uncounted: true,
            edges_missing: false,
            bewildered: false,
            interrupted: false,
            struck: false,
            silent_from_ns: None,
        };
        judge.configure(config, sampling);
        judge
    }

    // ---- events ----

    pub fn configure(&mut self, config: &Config, sampling: SamplerConfig) {
        let (rate, temp) = cycles(config);
        self.period_ns = (rate + temp) * 1e9 / self.mclk_hz;
        self.is_fast = self.twin.spec().sclk_hz >= f64::from(MIN_SCLK_HZ);
        self.counts = self.is_fast && sampling.divider <= 1 && (temp == 0.0 || 4.0 * rate.min(temp) >= rate + temp);
        self.sampling = sampling;
        self.knows_edges = temp == 0.0 || config.rdyfn() && rate == temp;
        self.ledger = Ledger::new(self.knows_edges);
        self.uncounted = true;
        self.bewildered = false;
    }

    pub fn count_nothing(&mut self) {
        self.uncounted = true;
    }

    /// Notes that the sampler got false information, so that a new sampler is needed.
    pub fn bewilder(&mut self) {
        self.uncounted = true;
        self.bewildered = true;
    }

    /// Notes that a call outside the sampler may have taken a reading, so that edges are missing.
    pub fn read_beside(&mut self) {
        self.edges_missing = true;
        self.ledger.read_beside();
    }

    pub fn spoil(&mut self) {
        self.spoiled = true;
        self.uncounted = true;
    }

    pub fn fault(&mut self, fault: Fault) {
        self.fault = fault;
        match fault {
            Fault::BitErrors => self.spoil(),
            Fault::Brownout | Fault::Unplug => self.count_nothing(),
            Fault::RdyLost | Fault::RdyStutter => self.edges_missing = true,
            _ => {}
        }
    }

    /// Notes that a new driver has the bus. This driver does not know what was written to the part.
    pub fn released(&mut self) {
        self.interrupted = false;
        self.spoil();
    }

    /// Notes that the part was restarted. Returns `false` if a new sampler is needed.
    pub fn restarted(&mut self) -> bool {
        let is_fit = !std::mem::take(&mut self.bewildered);
        if !is_fit {
            self.ledger = Ledger::new(self.knows_edges);
        }
        self.ledger.restarted();
        self.edges_missing = matches!(self.fault, Fault::RdyLost | Fault::RdyStutter);
        self.spoiled = self.fault == Fault::BitErrors;
        self.uncounted = self.spoiled;
        is_fit
    }

    // ---- calls ----

    pub fn begin(&mut self) {
        self.struck = false;
        self.silent_from_ns = self.interrupted.then(|| self.twin.now_ns());
    }

    pub fn begin_reset(&mut self) {
        self.interrupted = false;
        self.begin();
    }

    pub fn end(&mut self, trouble: Option<Trouble>) -> Verdict {
        self.struck(trouble);
        match self.silent_from_ns {
            Some(from_ns) if from_ns != self.twin.now_ns() => {
                Err("bytes were sent behind a call cut short".to_owned())
            }
            _ => Ok(()),
        }
    }

    pub fn struck(&mut self, trouble: Option<Trouble>) {
        match trouble {
            Some(Trouble::Cut) => self.interrupted = true,
            Some(Trouble::Fault(fault)) => {
                self.struck = true;
                self.fault(fault);
            }
            None => {}
        }
    }

    // ---- verdicts ----

    pub fn readings(&self, rate: Option<RateCode>, in_range: Option<RateCode>, temp: Option<TempCode>) -> Verdict {
        if self.spoiled || self.struck {
            return Ok(());
        }
        let last = self.twin.last_read();
        if let Some(rate) = rate.or(in_range) {
            measured("rate", last.rate, rate.code(), rate.width())?;
        }
        if let Some(temp) = temp {
            measured("temperature", last.temp, temp.code(), temp.width())?;
        }
        if in_range.is_some() && last.rate.is_some_and(|reading| reading.out_of_range) {
            return Err("a rate out of range passes for one in range".to_owned());
        }
        Ok(())
    }

    /// Checks the sample of an edge. `learned_ns` is the sampler's period before the edge.
    pub fn sample(&mut self, sample: Option<Sample>, edge_ns: u64, learned_ns: f64) -> Verdict {
        self.ledger.period(self.period_ns, learned_ns);
        self.bewildered |= self.uncounted;
        let Some(sample) = sample else { return Ok(()) };
        if self.spoiled || self.struck {
            self.bewilder();
            return Ok(());
        }
        let last = self.twin.last_read();
        let conversion = measured("rate of a sample", last.rate, sample.rate.code(), sample.rate.width())?;
        self.is_new(conversion)?;
        if let Some(temp) = sample.temp {
            let conversion = measured("temperature of a sample", last.temp, temp.code(), temp.width())?;
            if conversion.number < self.handed.1 {
                return Err("the temperature is older than the one before".to_owned());
            }
            self.handed.1 = conversion.number;
        }
        if self.uncounted || !self.counts {
            return Ok(());
        }
        self.ledger.enter(SampleRecord { lost: sample.lost, edge_ns, conversion }, self.period_ns)
    }

    /// Checks that a sample is not an old conversion. If the status is not read, the driver relies on the edges. Then
    /// the check applies only if `lost` can be trusted, no edge is missing and the bus is fast enough.
    fn is_new(&mut self, conversion: Conversion) -> Verdict {
        let before = std::mem::replace(&mut self.handed.0, conversion.number);
        let unbelievable = !self.sampling.read_status && (self.uncounted || self.edges_missing || !self.is_fast);
        if conversion.number > before {
            return Ok(());
        }
        if unbelievable {
            self.bewilder();
            return Ok(());
        }
        Err(format!("conversion {} is a sample again, after {before}", conversion.number))
    }
}

/// Returns the conversion that a code comes from, or an error if the part did not give this code or never measured it.
fn measured(what: &str, read: Option<Reading>, code: u32, width: Width) -> Result<Conversion, String> {
    let read = read.ok_or_else(|| format!("a {what} came without being read"))?;
    let expected = if width == Width::Bits16 { in_16_bits(read.code) } else { read.code };
    if code != expected {
        return Err(format!("a {what} is {code:06X}h, where the part gave {expected:06X}h"));
    }
    read.conversion.ok_or_else(|| format!("a {what} was never measured"))
}

/// The 16-bit code of a 24-bit code: rounded to nearest, ties away from 2¹⁵, limited to 65 535 (F-43).
fn in_16_bits(code24: u32) -> u32 {
    let middle = (f64::from(code24) - f64::from(1 << 23)) / 256.0;
    (32_768.0 + middle.round()).min(65_535.0) as u32
}

/// MCLK cycles of a conversion of the rate and of the temperature (F-31). The latter is 0 unless both are converted.
fn cycles(config: &Config) -> (f64, f64) {
    let both = config.channels() == Channels::Both;
    let cycles = |conversion: ConversionTime| {
        let word = f64::from(conversion.bits() & 0x7F);
        let alone = if conversion.bits() & 0x80 != 0 { 128.0 * word + 248.0 } else { 64.0 * word + 206.0 };
        alone + f64::from(u8::from(both))
    };
    (cycles(config.rate_conversion()), if both { cycles(config.temp_conversion()) } else { 0.0 })
}
