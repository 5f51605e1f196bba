//! The gyroscope: set-up, initialisation, readings, samples and diagnosis.

use crate::boundary::{self, Object};
use crate::bus::Bus;
use crate::status::{
    self, Status, StatusNumber, ZERORATE_E_ARGUMENT, ZERORATE_E_NULL, ZERORATE_E_PIN, ZERORATE_E_STATE,
    ZERORATE_E_TIMEOUT, ZERORATE_NOTHING, ZERORATE_OK,
};
use core::ops::RangeInclusive;

use adis16130::blocking::Adis16130;
use adis16130::{
    ChannelStatus, Config, Edge, Framing, MCLK_HZ, RateCode, RdyEdge, ReadError, Sample as DriverSample, Sampler,
    SamplerConfig, TempCode, WaitBound, Width,
};

/// A gyroscope. The caller owns the memory, and the contents are private. Set it up with zerorate_gyro_set_up. It
/// needs no tear-down.
#[repr(C)]
pub struct Gyro {
    /// Private.
    pub opaque: [u64; 48],
}

pub struct State {
    pub driver: Adis16130<Bus, Bus>,
    sampler: Sampler,
    pub bus: Bus,
    /// True from the first initialisation on, even if that failed.
    is_begun: bool,
}

impl Object for Gyro {
    type State = State;
    const MARK: u32 = 0x7A72_6731;
}

/// Configuration and sampling of the part. Start from zerorate_settings_default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Settings {
    /// Nominal master clock of the part, Hz: 1000 to 10000000. Default: 6000000. A wrong clock makes `lost` wrong.
    pub mclk_hz: u32,
    /// Read the temperature with every n-th sample (F-55): 1 = with each sample, 0 = never.
    pub every_temp: u16,
    /// Read on every n-th edge of RDY (F-56): 0 or 1 = on each edge.
    pub divider: u16,
    /// Width of the data registers, bits: 24 or 16.
    pub bits: u8,
    /// 1 = CS rises between all bytes, as AN-1042 prescribes, and `transfer` is called once per byte. 0 = CS stays low
    /// for a whole command, which is faster and works too (F-22).
    pub per_byte_framing: u8,
    /// The edge of RDY that announces new data: 0 = falling, 1 = rising, as behind an inverting level shifter.
    pub rdy_rises: u8,
    /// 1 = read the status of the rate channel with every sample. 0 = only where it is doubtful whether an edge
    /// announces new data, and for a few samples after that. With `divided` above 1, every edge is doubtful.
    pub read_status: u8,
    /// Divisor n of a counter in the RDY line, which passes every n-th edge to the host (F-56). 0 or 1 = no counter.
    pub divided: u16,
}

/// Rate and temperature as 24-bit codes. With 16-bit registers the codes are multiples of 256.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Codes {
    /// Rate = (code - 2^23) / 23488 deg/s (F-40).
    pub rate_code: u32,
    /// Temperature = (code - 2^23) / 14093 + 25 deg C (F-41).
    pub temp_code: u32,
}

/// A sample of the rate, with the temperature if it was due.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Sample {
    /// Time of the edge of RDY that announced the sample, ns.
    pub t_ns: u64,
    /// Number of that edge.
    pub seq: u32,
    /// The rate as a 24-bit code.
    pub rate_code: u32,
    /// The temperature as a 24-bit code. 0 if `has_temp` is 0.
    pub temp_code: u32,
    /// Number of rate samples lost since the previous sample.
    pub lost: u32,
    /// Width in which the codes were read, bits: 24 or 16.
    pub bits: u8,
    /// 1 = the temperature was read, otherwise 0.
    pub has_temp: u8,
    /// 1 = the status of the rate channel was read, otherwise 0.
    pub has_status: u8,
    /// The status register of the rate channel. Bit 0 = the rate is out of range (F-35). 0 if `has_status` is 0.
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

/// Smallest and largest master clock, Hz.
const MCLK_RANGE_HZ: RangeInclusive<u32> = 1_000..=10_000_000;

impl Settings {
    fn config(&self) -> Result<Config, Status> {
        let switches = [self.per_byte_framing, self.rdy_rises, self.read_status];
        if switches.iter().any(|switch| *switch > 1) || !MCLK_RANGE_HZ.contains(&self.mclk_hz) {
            return Err(ZERORATE_E_ARGUMENT);
        }
        let framing = if self.per_byte_framing == 0 { Framing::Command } else { Framing::PerByte };
        let edge = if self.rdy_rises == 0 { RdyEdge::Falling } else { RdyEdge::Rising };
        Ok(Config::new().with_width(width(self.bits)?).with_framing(framing).with_rdy_edge(edge))
    }

    fn sampling(&self) -> SamplerConfig {
        let sampling = SamplerConfig::new().with_every_temp(self.every_temp).with_divider(self.divider);
        sampling.with_divided(self.divided).with_read_status(self.read_status != 0)
    }
}

/// Writes the default settings: those of F-30, per-byte framing (F-22), temperature and status with every sample.
///
/// # Safety
/// `settings` is null or points to writable memory of its type.
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

/// Sets up a gyroscope. Copies `bus` and `settings`, and sends nothing. Call zerorate_gyro_initialise next. Returns
/// ZERORATE_E_ARGUMENT if a setting is out of its range.
///
/// # Safety
/// Each pointer is null or points to memory of its type. The functions and the context of `bus` may be used as its
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
    let driver = Adis16130::new(bus, bus, config);
    // SAFETY: by the contract.
    unsafe { boundary::set_up(gyro, State { driver, sampler, bus, is_begun: false }) }
}

/// Resets the part, writes its configuration (F-30) and reads it back, with 13 commands and no wait. Call it again
/// after an error of the bus. Sampling then goes on, and `lost` of the next sample counts the lost samples.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_initialise(gyro: *mut Gyro) -> Status {
    let initialise = |State { driver, sampler, is_begun, .. }: &mut State| {
        *is_begun = true;
        driver.restart().map_err(|error| error.status())?;
        sampler.restarted();
        Ok(())
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(initialise))
}

/// Reads the rate, its status and the temperature now, whether they are new or not. Returns ZERORATE_E_OUT_OF_RANGE if
/// the rate is beyond its range, also if its code has wrapped (F-35). Returns ZERORATE_E_NO_READING before the first
/// conversion.
///
/// Sends 3 commands, and up to 16 more if an answer could come from a dead line or from a part that was reset, if a
/// conversion ends between two reads, or at the first reading after an initialisation.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the gyroscope during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_read(gyro: *mut Gyro, reading: *mut Codes) -> Status {
    let read = |state: &mut State| {
        let (rate, temp) = state.driver.read_in_range().map_err(|error| error.status())?;
        Ok(Codes { rate_code: rate.code24(), temp_code: temp.code24() })
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro).and_then(read).and_then(|value| boundary::output(reading, value)) })
}

/// Waits for new data: calls `rdy` every 5 us, and reads the status of the part to confirm it. Returns
/// ZERORATE_E_TIMEOUT after `timeout_us`, plus the time of the calls. Needs `rdy` and `delay_us` of the bus:
/// ZERORATE_E_PIN without them.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_wait_ready(gyro: *mut Gyro, timeout_us: u32) -> Status {
    let wait = |State { driver, bus, .. }: &mut State| {
        if bus.delay_us.is_none() {
            return Err(ZERORATE_E_PIN);
        }
        driver.wait_ready(bus, WaitBound::from_us(timeout_us)).map_err(|error| error.status())
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(wait))
}

/// Handles an edge of RDY: reads the registers that are due, and counts the lost samples. Sends 1 to 3 commands if
/// something is due, and at most 10 at the first sample after an initialisation or if an answer could come from a dead
/// line.
///
/// `t_ns` is the time of the edge by a clock that runs evenly. `seq` is the running number of the edge, which also
/// counts the edges that were not handled and may wrap. Returns ZERORATE_NOTHING and writes nothing if nothing was
/// due, or if the data of the edge had been read before.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the gyroscope during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_sample(gyro: *mut Gyro, t_ns: u64, seq: u32, sample: *mut Sample) -> Status {
    let edge = Edge { t_ns, seq };
    let read = |State { driver, sampler, .. }: &mut State| {
        driver.sample(sampler, edge).map_err(|error| ReadError::from(error).status())
    };
    // SAFETY: by the contract.
    match unsafe { boundary::state(gyro) }.and_then(read) {
        // SAFETY: by the contract.
        Ok(Some(value)) => status::of(unsafe { boundary::output(sample, Sample::new(&value)) }),
        Ok(None) => ZERORATE_NOTHING,
        Err(status) => status,
    }
}

/// Checks that edges of RDY still come. Sends nothing. Returns ZERORATE_E_TIMEOUT if zerorate_gyro_sample has got no
/// edge for 64 periods of the rate (11.2 ms with F-30) or 64 intervals of divided edges, otherwise ZERORATE_OK. After
/// a timeout, the part has lost its supply or its configuration, or RDY is cut. zerorate_gyro_diagnose finds the
/// cause, and zerorate_gyro_initialise starts the part again.
///
/// `now_ns` is the present time of the clock of the edges. Before the first edge, and after an initialisation, the
/// time counts from the first call of this function. So call it regularly, and at least once before a sleep.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_silent(gyro: *mut Gyro, now_ns: u64) -> Status {
    let check = |State { sampler, .. }: &mut State| match sampler.silent_since(now_ns) {
        None => Ok(()),
        Some(_) => Err(ZERORATE_E_TIMEOUT),
    };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(gyro) }.and_then(check))
}

/// Checks the link with 2 commands. Returns ZERORATE_OK if the part is configured as written, and otherwise the fault,
/// or the reason why nothing was sent: ZERORATE_E_STATE before the first initialisation.
///
/// # Safety
/// `gyro` is null or points to a gyroscope that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_diagnose(gyro: *mut Gyro) -> Status {
    // SAFETY: by the contract.
    let seen = unsafe { boundary::state(gyro) }.and_then(|State { driver, is_begun, .. }| {
        if *is_begun { driver.diagnose().map_err(|error| error.status()) } else { Err(ZERORATE_E_STATE) }
    });
    match seen {
        Ok(None) => ZERORATE_OK,
        Ok(Some(fault)) => fault.status(),
        Err(status) => status,
    }
}
