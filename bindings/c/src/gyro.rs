//! The gyroscope: set-up, initialisation, readings, samples and diagnosis.

use crate::boundary::{self, Object};
use crate::bus::{Bus, Delay, Line, Port};
use crate::status::{
    self, Status, StatusNumber, ZERORATE_E_ARGUMENT, ZERORATE_E_NULL, ZERORATE_E_PIN, ZERORATE_E_TIMEOUT,
    ZERORATE_NOTHING, ZERORATE_OK,
};
use adis16130::blocking::Adis16130;
use adis16130::{
    ChannelStatus, Config, Edge, Framing, MCLK_HZ, RateCode, RdyEdge, Sample as DriverSample, Sampler, SamplerConfig,
    TempCode, WaitBound, Width,
};

/// A gyroscope. The memory is the caller's, the contents are private; set it up with zerorate_gyro_set_up. It needs no
/// tear-down.
#[repr(C)]
pub struct Gyro {
    /// Private.
    pub opaque: [u64; 48],
}

/// The contents of a [`Gyro`], which C sees as opaque memory.
pub struct State {
    /// The Rust driver on the caller's functions.
    pub driver: Adis16130<Port, Line>,
    sampler: Sampler,
    /// The caller's functions, as given at set-up.
    pub bus: Bus,
}

impl Object for Gyro {
    type State = State;
    const MARK: u32 = 0x7A72_6731;
}

/// Configuration and sampling of the part. Start from zerorate_settings_default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Settings {
    /// Nominal master clock of the part, Hz: 6000000.
    pub mclk_hz: u32,
    /// Read the temperature with every n-th sample (F-55): 1 = with each, 0 = never.
    pub every_temp: u16,
    /// Read on every n-th edge of RDY (F-56): 1 = on each.
    pub divider: u16,
    /// Width of the data registers: 24 or 16.
    pub bits: u8,
    /// 1 = CS rises between all bytes, as the note prescribes, and `transfer` is called once per byte. With 0 CS
    /// stays low for a whole command, which is faster and works too (F-22).
    pub per_byte_framing: u8,
    /// Which edge of the line says "new data": 0 = falling, 1 = rising, as behind an inverting level shifter.
    pub rdy_rises: u8,
    /// 1 = read the status of the rate channel with every sample, 0 = only where an edge is doubtful.
    pub read_status: u8,
    /// Divisor n of a counter in the RDY line, which passes every n-th edge to the host (F-56). 0 and 1 = no counter.
    pub divided: u16,
}

/// Rate and temperature, as codes of 24 bits; with 16-bit registers they are multiples of 256.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Codes {
    /// Rate = (code - 2^23) / 23488 deg/s (F-40).
    pub rate_code: u32,
    /// Temperature = (code - 2^23) / 14093 + 25 deg C (F-41).
    pub temp_code: u32,
}

/// A sample of the rate, with the temperature where that was due.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Sample {
    /// Time of the sample's edge, ns.
    pub t_ns: u64,
    /// Number of the sample's edge.
    pub seq: u32,
    /// The rate, as a code of 24 bits.
    pub rate_code: u32,
    /// The temperature, as a code of 24 bits, if `has_temp`.
    pub temp_code: u32,
    /// Rate samples lost since the sample before.
    pub lost: u32,
    /// Width in which the codes were read: 24 or 16.
    pub bits: u8,
    /// True if the temperature was read.
    pub has_temp: u8,
    /// True if the status of the rate channel was read.
    pub has_status: u8,
    /// The status of the rate channel, as read; bit 0 = out of range (F-35).
    pub status: u8,
}

impl Sample {
    fn new(sample: &DriverSample) -> Self {
        Self {
            t_ns: sample.t_ns,
            seq: sample.seq,
            rate_code: sample.rate.code24(),
            temp_code: sample.temp.map_or(0, TempCode::code24),
            lost: sample.lost,
            bits: sample.rate.width().bits() as u8,
            has_temp: sample.temp.is_some().into(),
            has_status: sample.status.is_some().into(),
            status: sample.status.map_or(0, ChannelStatus::bits),
        }
    }

    /// Converts the sample to the driver's type. It fails if `bits` is neither 16 nor 24.
    pub fn to_driver(self) -> Result<DriverSample, Status> {
        let width = width(self.bits)?;
        let raw = |code24: u32| code24 >> (24 - width.bits());
        Ok(DriverSample {
            t_ns: self.t_ns,
            seq: self.seq,
            rate: RateCode::new(raw(self.rate_code), width),
            status: (self.has_status != 0).then_some(ChannelStatus::new(self.status)),
            temp: (self.has_temp != 0).then_some(TempCode::new(raw(self.temp_code), width)),
            lost: self.lost,
        })
    }
}

fn width(bits: u8) -> Result<Width, Status> {
    match bits {
        24 => Ok(Width::Bits24),
        16 => Ok(Width::Bits16),
        _ => Err(ZERORATE_E_ARGUMENT),
    }
}

impl Settings {
    fn config(&self) -> Result<Config, Status> {
        let framing = if self.per_byte_framing == 0 { Framing::Command } else { Framing::PerByte };
        let edge = if self.rdy_rises == 0 { RdyEdge::Falling } else { RdyEdge::Rising };
        Ok(Config::new().with_width(width(self.bits)?).with_framing(framing).with_rdy_edge(edge))
    }

    fn sampling(&self) -> SamplerConfig {
        let sampling = SamplerConfig::new().with_every_temp(self.every_temp).with_divider(self.divider);
        sampling.with_divided(self.divided).with_read_status(self.read_status != 0)
    }
}

/// The default settings: F-30, the note's framing (F-22), temperature and status with every sample.
///
/// # Safety
/// `settings` is null or points to writable memory for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_settings_default(settings: *mut Settings) -> Status {
    let default = Settings {
        mclk_hz: MCLK_HZ,
        every_temp: 1,
        divider: 1,
        bits: 24,
        per_byte_framing: 1,
        rdy_rises: 0,
        read_status: 1,
        divided: 1,
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::output(settings, default) })
}

/// Sets a gyroscope up. Copies `bus` and `settings`, sends nothing: initialise it next.
///
/// # Safety
/// Each pointer is null or points to memory of its type; what `bus` points to may be called and used as its
/// documentation says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_set_up(gyro: *mut Gyro, bus: *const Bus, settings: *const Settings) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { set_up(gyro, bus, settings) })
}

unsafe fn set_up(gyro: *mut Gyro, bus: *const Bus, settings: *const Settings) -> Result<(), Status> {
    // SAFETY: by the contract.
    let (bus, settings) = unsafe { (*boundary::input(bus)?, boundary::input(settings)?) };
    if bus.transfer.is_none() {
        return Err(ZERORATE_E_NULL);
    }
    let config = settings.config()?;
    let sampler = Sampler::new(settings.sampling(), &config, settings.mclk_hz);
    let driver = Adis16130::new(Port(bus), Line(bus), config);
    // SAFETY: by the contract.
    unsafe { boundary::set_up(gyro, State { driver, sampler, bus }) }
}

/// Resets the part, writes its configuration (F-30) and reads it back. 13 commands, no wait. Call it again after an
/// error of the bus: samples go on, and the next one says what was lost.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_initialise(gyro: *mut Gyro) -> Status {
    let initialise = |State { driver, sampler, .. }: &mut State| {
        driver.restart().map_err(|error| error.status())?;
        sampler.restarted();
        Ok(())
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(initialise))
}

/// Reads rate, its status, and temperature now, whether they are new or not: 3 commands. ZERORATE_E_OUT_OF_RANGE where
/// the rate is beyond its range, also where its code has wrapped (F-35); ZERORATE_E_NO_READING before the first
/// conversion. Up to 9 more commands where an answer is doubtful or a conversion ends in between.
///
/// # Safety
/// Each pointer is null or points to memory of its type; nothing else uses the gyroscope meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_read(gyro: *mut Gyro, reading: *mut Codes) -> Status {
    let read = |state: &mut State| {
        let (rate, temp) = state.driver.read_in_range().map_err(|error| error.status())?;
        Ok(Codes { rate_code: rate.code24(), temp_code: temp.code24() })
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro).and_then(read).and_then(|value| boundary::output(reading, value)) })
}

/// Waits for new data: looks at RDY every 5 us, for `timeout_us` and a little more at most. Needs `rdy` and
/// `delay_us`.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_wait_ready(gyro: *mut Gyro, timeout_us: u32) -> Status {
    let wait = |State { driver, bus, .. }: &mut State| {
        if bus.delay_us.is_none() {
            return Err(ZERORATE_E_PIN);
        }
        driver.wait_ready(&mut Delay(*bus), WaitBound::from_us(timeout_us)).map_err(|error| error.status())
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(wait))
}

/// Handles an edge of RDY: reads what is due, 1 to 3 commands, and counts the samples that were lost.
///
/// `t_ns` is the time of the edge by a clock that runs evenly, `seq` its running number, which counts also the edges
/// that were not handled; it may wrap. Returns ZERORATE_NOTHING and writes nothing where nothing was due or the edge
/// was stale.
///
/// # Safety
/// Each pointer is null or points to memory of its type; nothing else uses the gyroscope meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_sample(gyro: *mut Gyro, t_ns: u64, seq: u32, sample: *mut Sample) -> Status {
    let edge = Edge { t_ns, seq };
    let read =
        |State { driver, sampler, .. }: &mut State| driver.sample(sampler, edge).map_err(|error| error.status());
    // SAFETY: by the contract.
    match unsafe { boundary::state(gyro) }.and_then(read) {
        // SAFETY: by the contract.
        Ok(Some(value)) => status::of(unsafe { boundary::output(sample, Sample::new(&value)) }),
        Ok(None) => ZERORATE_NOTHING,
        Err(status) => status,
    }
}

/// Checks that edges of RDY still come. Returns ZERORATE_OK, or ZERORATE_E_TIMEOUT if none has been handed to
/// zerorate_gyro_sample for 64 periods of the rate (11.2 ms with F-30). Then the part has lost its supply or its
/// configuration, or RDY is cut: zerorate_gyro_diagnose says which, zerorate_gyro_initialise starts anew. Sends
/// nothing.
///
/// `now_ns` is the time now by the clock of the edges. Before the first edge, and after an initialisation, the time
/// counts from the first call on, so call it regularly, and at least once before you go to sleep.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_silent(gyro: *mut Gyro, now_ns: u64) -> Status {
    let check = |State { sampler, .. }: &mut State| match sampler.silent_since(now_ns) {
        None => Ok(()),
        Some(_) => Err(ZERORATE_E_TIMEOUT),
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(check))
}

/// Looks at the link: ZERORATE_OK if it works and the part is configured as written, else what is wrong. 2 commands.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_diagnose(gyro: *mut Gyro) -> Status {
    // SAFETY: by the contract.
    let seen = unsafe { boundary::state(gyro) }
        .and_then(|State { driver, .. }| driver.diagnose().map_err(|error| error.status()));
    match seen {
        Ok(None) => ZERORATE_OK,
        Ok(Some(fault)) => fault.status(),
        Err(status) => status,
    }
}
