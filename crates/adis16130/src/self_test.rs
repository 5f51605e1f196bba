//! The self-test: measures by how much the self-test pins shift the rate (F-11).

use core::num::NonZeroU16;

use embedded_hal::digital::OutputPin;

use crate::RATE_LSB_PER_DPS;
use crate::codes::RateCode;
use crate::wait::WaitBound;

/// Number of batches at each level of the self-test pin. Neighbouring samples are correlated by the bandwidth (F-03),
/// but means of batches hardly are. So the scatter of the batch means gives a correct uncertainty. The scatter of the
/// samples would give one several times too small.
const BATCHES: u32 = 16;

/// How a self-test measures: number of samples, settling time, and longest wait for RDY.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SelfTestPlan {
    per_batch: NonZeroU16,
    settle_us: u32,
    bound: WaitBound,
}

impl SelfTestPlan {
    /// Averages `samples` rates, rounded up to a multiple of 16, without and with the self-test. They must take a
    /// second or more, since each of the 16 batches must be long compared with 1/(300 Hz).
    pub const fn new(samples: u16) -> Self {
        let per_batch = match NonZeroU16::new(samples.div_ceil(BATCHES as u16)) {
            Some(per_batch) => per_batch,
            None => NonZeroU16::MIN,
        };
        Self { per_batch, settle_us: 100_000, bound: WaitBound::from_us(20_000) }
    }

    /// Sets the wait after each change of the pin, in µs: 100 ms by default (a choice: no time is published).
    pub const fn with_settle_us(mut self, settle_us: u32) -> Self {
        self.settle_us = settle_us;
        self
    }

    /// Sets the bound of each wait for RDY: 20 ms by default, enough for the slowest conversion.
    pub const fn with_bound(mut self, bound: WaitBound) -> Self {
        self.bound = bound;
        self
    }

    /// The wait after each change of the pin, in µs.
    pub const fn settle_us(&self) -> u32 {
        self.settle_us
    }

    /// The bound of each wait for RDY.
    pub const fn bound(&self) -> WaitBound {
        self.bound
    }

    /// Number of rates averaged without the self-test. The same number is averaged with it.
    pub const fn samples(&self) -> u32 {
        BATCHES * self.per_batch.get() as u32
    }
}

/// The measured effect of the self-test. Its nominal size is not known, so the driver does not judge it (F-11).
#[derive(Copy, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SelfTest {
    /// Mean rate with the self-test less mean rate without the self-test, in °/s.
    pub shift_dps: f32,
    /// Standard uncertainty of `shift_dps` from the scatter of the rates, in °/s.
    pub u_dps: f32,
    /// Number of rates averaged without the self-test. The same number is averaged with it.
    pub n: u32,
}

impl SelfTest {
    pub(crate) fn from_levels(plan: &SelfTestPlan, off: &Level, on: &Level) -> Self {
        let n = plan.samples();
        let scale = 1.0 / (n as f32 * RATE_LSB_PER_DPS as f32);
        Self {
            shift_dps: (on.total - off.total) as f32 * scale,
            u_dps: sqrt(on.variance_of_total() + off.variance_of_total()) * scale,
            n,
        }
    }
}

/// The exact sum of the codes at one level of the self-test pin, and the scatter of the batch sums.
#[derive(Clone, Debug, Default)]
pub(crate) struct Level {
    total: i64,
    samples: u32,
    batch: i64,
    first_batch: Option<i64>,
    deviations: f32,
    squares: f32,
}

impl Level {
    pub(crate) fn push(&mut self, plan: &SelfTestPlan, rate: RateCode) {
        let code = i64::from(rate.code24());
        self.total += code;
        self.batch += code;
        self.samples += 1;
        if self.samples.is_multiple_of(u32::from(plan.per_batch.get())) {
            let first = *self.first_batch.get_or_insert(self.batch);
            let deviation = (self.batch - first) as f32;
            self.deviations += deviation;
            self.squares += deviation * deviation;
            self.batch = 0;
        }
    }

    /// Variance of `total`, a sum of 16 independent batches: 16 times the variance of a batch.
    fn variance_of_total(&self) -> f32 {
        let batches = BATCHES as f32;
        let variance = (self.squares - self.deviations * self.deviations / batches) / (batches - 1.0);
        (variance * batches).max(0.0)
    }
}

/// Square root to 2⁻⁸, enough for code sums. (`core` has no square root for floats.)
fn sqrt(x: f32) -> f32 {
    ((x * 65_536.0) as u64).isqrt() as f32 / 256.0
}

/// Holds the self-test pin active, and releases it at the latest when dropped: on an error, or with a cancelled
/// future.
pub(crate) struct Active<'a, P: OutputPin>(Option<&'a mut P>);

impl<'a, P: OutputPin> Active<'a, P> {
    /// Sets the pin high. The guard exists before the attempt, so that a failed attempt sets the pin low again.
    pub(crate) fn activate(pin: &'a mut P) -> Result<Self, P::Error> {
        let mut active = Self(Some(pin));
        active.0.as_mut().map_or(Ok(()), |pin| pin.set_high())?;
        Ok(active)
    }

    pub(crate) fn release(mut self) -> Result<(), P::Error> {
        self.0.take().map_or(Ok(()), OutputPin::set_low)
    }
}

impl<P: OutputPin> Drop for Active<'_, P> {
    fn drop(&mut self) {
        if let Some(pin) = self.0.take() {
            // An error here cannot be handled. The call that drops this guard returns another error or was cancelled.
            let _ = pin.set_low();
        }
    }
}
