//! One unit: every parameter of the twin, drawn from a seed or set by hand.

use crate::facts;
use crate::fault::Fault;
use crate::normal::{Normal, Process};

/// Ambient temperature over time, without the wander.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Profile {
    /// The temperature is [`Spec::ambient_c`] all the time.
    Constant,
    /// A ramp from [`Spec::ambient_c`] with the slope [`Spec::ramp_c_per_min`], which stops at −40 °C or +85 °C.
    Ramp,
    /// The chamber profile F-57, 25 → −40 → +85 → 25 °C in 175 min. [`Spec::ambient_c`] is ignored.
    Oven,
}

/// The shape of the RDY line, as the host sees it (F-32).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum RdyOutput {
    /// High during the scaling time, low from the update until the data is read. The falling edge announces new data.
    Level,
    /// Low only during the scaling time, as AN-1042 says ("pulses low for 26 µs"). The rising edge announces new data.
    Pulse,
    /// [`RdyOutput::Level`] behind an inverting level shifter. The rising edge announces new data.
    Inverted,
}

/// The component between ROA1 and ROA2 (F-04).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Roa {
    /// Nothing: the bandwidth is 300 Hz (F-03).
    Open,
    /// A capacitor of 10 nF: the bandwidth is 50 Hz (F-04).
    TenNanofarad,
}

/// Unwanted motion of the platform.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The platform is at rest.
    None,
    /// A sine with peak [`Spec::sway_dps`] and frequency [`Spec::sway_hz`].
    Sway,
    /// A half-sine of 0.2 s with peak [`Spec::bump_dps`], at [`Spec::event_s`] and every 60 s after that.
    Bump,
}

/// One unit, its surroundings and its faults.
///
/// [`Spec::from_seed`] draws the unit (M-01…M-08). Every field can be set afterwards, and setting one does not change
/// another. The fields are not checked: keep each in the range that [`KEYS`](crate::KEYS) states.
///
/// ```
/// use adis16130_twin::Spec;
///
/// let mut spec = Spec::from_seed(7);
/// spec.bias_dps = 0.8;
/// assert_eq!(spec, Spec::parse_keys("seed=7,bias_dps=0.8").unwrap());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// The seed of all random numbers.
    pub seed: u64,
    /// Bias at 25 °C and 5 V, in °/s (M-01).
    pub bias_dps: f64,
    /// Linear temperature coefficient of the bias at 25 °C, in °/s/°C (M-02).
    pub tempco_dps_per_c: f64,
    /// Quadratic coefficient of the bias over (T − 25 °C), in °/s/°C² (M-02).
    pub curvature_dps_per_c2: f64,
    /// Half width of the hysteresis loop of the bias over temperature, in °/s (M-02).
    pub hysteresis_dps: f64,
    /// Time constant by which the sensing element's temperature follows the temperature sensor's, in s.
    pub lag_s: f64,
    /// Ambient temperature at the start, in °C (M-05). [`Profile::Oven`] ignores it.
    pub ambient_c: f64,
    /// Rms of the random wander of the ambient temperature, in °C (M-05).
    pub ambient_wander_c: f64,
    /// Ambient temperature over time.
    pub profile: Profile,
    /// Slope of [`Profile::Ramp`], in °C/min.
    pub ramp_c_per_min: f64,
    /// Self-heating in thermal balance, in °C (M-03).
    pub warmup_c: f64,
    /// Time constant of the slow share of the self-heating, in s. The fast time constant is 90/600 of this (M-03).
    pub warmup_s: f64,
    /// Master clock, in Hz (M-06).
    pub mclk_hz: f64,
    /// Shape of the RDY line.
    pub rdy: RdyOutput,
    /// The capacitor between ROA1 and ROA2.
    pub roa: Roa,
    /// Supply voltage, in mV (F-01).
    pub supply_mv: f64,
    /// Step of the supply at [`Spec::event_s`], in mV (F-01).
    pub supply_step_mv: f64,
    /// `false` switches off white noise, resonance, flicker, random walk, ambient wander and temperature noise. Only
    /// the deterministic bias and the quantisation remain. The unit is still the one that the seed draws.
    pub noise: bool,
    /// Floor of the flicker's Allan deviation, 0.664·B, in °/s (M-04).
    pub flicker_floor_dps: f64,
    /// Frequency below which the spectrum of the flicker is flat, in Hz (M-04).
    pub flicker_hz: f64,
    /// Rate random walk, in °/s/√s (M-04).
    pub rrw_dps_per_rt_s: f64,
    /// One-sided density of the white noise at the output, in °/s/√Hz (F-02).
    pub white_dps_per_rt_hz: f64,
    /// One-sided density of the temperature channel's noise, in °C/√Hz (M-05).
    pub temp_noise_c_per_rt_hz: f64,
    /// Rms of the resonance at the output before sampling, in °/s (M-08).
    pub resonance_dps_rms: f64,
    /// Frequency of the resonance, in Hz (F-07).
    pub resonance_hz: f64,
    /// Constant rotation about the sensitive axis, in °/s. It is motion, so the truth about the bias leaves it out.
    pub rotation_dps: f64,
    /// Motion of the platform.
    pub motion: Motion,
    /// Peak rate of [`Motion::Sway`], in °/s.
    pub sway_dps: f64,
    /// Frequency of [`Motion::Sway`], in Hz.
    pub sway_hz: f64,
    /// Peak rate of [`Motion::Bump`], in °/s.
    pub bump_dps: f64,
    /// Probability that a bit on SDI or SDO flips. With [`Fault::BitErrors`], zero means 10⁻⁶. Without a fault, a
    /// value above zero turns bit errors on. With other faults the value has no effect.
    pub bit_error_rate: f64,
    /// The fault. It begins at [`Spec::fault_at_s`].
    pub fault: Fault,
    /// Time when faults, bumps and the supply step begin, in s from the start. With `None`, faults begin at 0, bumps
    /// and the supply step at 60 s.
    pub fault_at_s: Option<f64>,
    /// Relative error of the sensitivity (M-07). It scales the input of the sensing element (rotation, slow bias,
    /// flicker, random walk, self-test). White noise and resonance are stated at the output and not scaled.
    pub sensitivity_error: f64,
    /// Shift by an active self-test pin, in °/s. F-11 states no value, so this one is a choice.
    pub self_test_dps: f64,
    /// SPI clock, in Hz.
    pub sclk_hz: f64,
    /// Time that CS stays high after each frame, in ns.
    pub cs_gap_ns: u32,
}

impl Spec {
    /// Draws the unit of this seed from the distributions of M-01 to M-08.
    pub fn from_seed(seed: u64) -> Self {
        let mut unit = Normal::new(seed, Process::Unit);
        // Do not change the order of these draws: another order would give each seed another unit.
        let bias = unit.sample();
        let tempco = unit.sample();
        let curvature = unit.sample();
        let warmup = unit.sample();
        let sensitivity = unit.sample();
        let mclk = 2.0 * unit.random.sample() - 1.0;
        Self {
            seed,
            bias_dps: facts::BIAS_SD_DPS * bias,
            tempco_dps_per_c: facts::TEMPCO_DPS_PER_C + facts::TEMPCO_SD_DPS_PER_C * tempco,
            curvature_dps_per_c2: facts::CURVATURE_SD_DPS_PER_C2 * curvature,
            warmup_c: facts::WARMUP_C + facts::WARMUP_SD_C * warmup,
            sensitivity_error: facts::SENSITIVITY_SD * sensitivity,
            mclk_hz: facts::MCLK_HZ * (1.0 + facts::MCLK_TOLERANCE * mclk),
            ..Self::typical()
        }
    }

    /// The unit without any spread: zero bias, typical coefficients, 6.000 MHz, seed 1.
    pub fn typical() -> Self {
        Self {
            seed: 1,
            bias_dps: 0.0,
            tempco_dps_per_c: facts::TEMPCO_DPS_PER_C,
            curvature_dps_per_c2: 0.0,
            hysteresis_dps: facts::HYSTERESIS_DPS,
            lag_s: 0.0,
            ambient_c: facts::AMBIENT_C,
            ambient_wander_c: facts::WANDER_C,
            profile: Profile::Constant,
            ramp_c_per_min: 1.0,
            warmup_c: facts::WARMUP_C,
            warmup_s: facts::WARMUP_SLOW_S,
            mclk_hz: facts::MCLK_HZ,
            rdy: RdyOutput::Level,
            roa: Roa::Open,
            supply_mv: facts::SUPPLY_NOMINAL_MV,
            supply_step_mv: 0.0,
            noise: true,
            flicker_floor_dps: facts::FLICKER_FLOOR_DPS,
            flicker_hz: facts::FLICKER_HZ,
            rrw_dps_per_rt_s: facts::RRW_DPS_PER_RT_S,
            white_dps_per_rt_hz: facts::WHITE_DPS_PER_RT_HZ,
            temp_noise_c_per_rt_hz: facts::TEMP_NOISE_C_PER_RT_HZ,
            resonance_dps_rms: facts::RESONANCE_DPS_RMS,
            resonance_hz: facts::RESONANCE_HZ,
            rotation_dps: 0.0,
            motion: Motion::None,
            sway_dps: 0.5,
            sway_hz: 0.2,
            bump_dps: 3.0,
            bit_error_rate: 0.0,
            fault: Fault::None,
            fault_at_s: None,
            sensitivity_error: 0.0,
            self_test_dps: 20.0,
            sclk_hz: 4.0e6,
            cs_gap_ns: 200,
        }
    }

    /// Time at which bumps and the supply step begin, in s: [`Spec::fault_at_s`], or 60.
    pub fn event_s(&self) -> f64 {
        self.fault_at_s.unwrap_or(60.0)
    }
}

impl Default for Spec {
    fn default() -> Self {
        Self::from_seed(1)
    }
}
