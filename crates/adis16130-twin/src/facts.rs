//! Every number that the twin takes from `docs/facts.md`, with its fact id.

/// Rate scale, codes on the 24-bit scale per °/s (F-40).
pub const RATE_LSB_PER_DPS: f64 = 23_488.0;
/// Temperature scale, codes on the 24-bit scale per °C (F-41).
pub const TEMP_LSB_PER_C: f64 = 14_093.0;
/// The code of 0 °/s and of [`TEMP_AT_ZERO_CODE_C`] (F-40, F-41).
pub const ZERO_CODE: u32 = 1 << 23;
/// The temperature of code 2²³, in °C (F-41).
pub const TEMP_AT_ZERO_CODE_C: f64 = 25.0;
/// The largest 24-bit code.
pub const MAX_CODE: u32 = (1 << 24) - 1;

/// MCLK cycles of the scaling time, during which RDY is high (F-32).
pub const SCALING_CYCLES: u32 = 163;
/// Nominal supply voltage, in mV (F-01).
pub const SUPPLY_NOMINAL_MV: f64 = 5000.0;
/// Change of the bias per change of the supply voltage, in °/s/mV (F-01).
pub const SUPPLY_DPS_PER_MV: f64 = 0.0002;
/// One-sided density of the white rate noise, in °/s/√Hz (F-02).
pub const WHITE_DPS_PER_RT_HZ: f64 = 0.0125;
/// Lower pole of the rate's bandwidth without a capacitor across ROA1 and ROA2, in Hz (F-03).
pub const POLE_HZ: f64 = 327.0;
/// Lower pole of the rate's bandwidth with 10 nF across ROA1 and ROA2, in Hz (F-04).
pub const POLE_ROA_10NF_HZ: f64 = 50.0;
/// Upper pole of the rate's bandwidth, in Hz (F-03).
pub const UPPER_POLE_HZ: f64 = 1000.0;
/// Frequency of the mechanical resonance, in Hz (F-07).
pub const RESONANCE_HZ: f64 = 14_300.0;
/// Rms of the resonance at the output before sampling, in °/s (M-08).
pub const RESONANCE_DPS_RMS: f64 = 0.02;

/// Standard deviation between parts of the initial bias at 25 °C, in °/s (M-01).
pub const BIAS_SD_DPS: f64 = 1.0;
/// Mean of the bias's temperature coefficient over all parts, in °/s/°C (F-05, M-02).
pub const TEMPCO_DPS_PER_C: f64 = 0.04;
/// Standard deviation between parts of the temperature coefficient, in °/s/°C (M-02).
pub const TEMPCO_SD_DPS_PER_C: f64 = 0.01;
/// Standard deviation between parts of the curvature of the bias over temperature, in °/s/°C² (M-02).
pub const CURVATURE_SD_DPS_PER_C2: f64 = 0.0005;
/// Half width of the hysteresis loop of the bias over temperature, in °/s (M-02).
pub const HYSTERESIS_DPS: f64 = 0.002;
/// Mean of the self-heating in thermal balance over all parts, in °C (M-03).
pub const WARMUP_C: f64 = 8.0;
/// Standard deviation between parts of the self-heating, in °C (M-03).
pub const WARMUP_SD_C: f64 = 1.0;
/// Share of the self-heating with the fast time constant, 0 to 1 (M-03).
pub const WARMUP_FAST_SHARE: f64 = 0.4;
/// Time constant of the fast share, in s (M-03).
pub const WARMUP_FAST_S: f64 = 90.0;
/// Time constant of the slow share, in s (M-03).
pub const WARMUP_SLOW_S: f64 = 600.0;
/// Floor of the Allan deviation of the flicker alone, in °/s (M-04).
pub const FLICKER_FLOOR_DPS: f64 = 0.0016;
/// Floor of the flicker's Allan deviation, in units of its coefficient B: √(2 ln 2/π), rounded to 0.664 (M-04).
pub const FLOOR_PER_B: f64 = 0.664;
/// Frequency below which the spectrum of the flicker is flat, in Hz (M-04).
pub const FLICKER_HZ: f64 = 1e-4;
/// Rate random walk, in °/s/√s (M-04).
pub const RRW_DPS_PER_RT_S: f64 = 1e-4;
/// One-sided density of the temperature channel's noise, in °C/√Hz (M-05).
pub const TEMP_NOISE_C_PER_RT_HZ: f64 = 0.001;
/// Mean ambient temperature, in °C (M-05).
pub const AMBIENT_C: f64 = 25.0;
/// Rms of the random wander of the ambient temperature, in °C (M-05).
pub const WANDER_C: f64 = 0.05;
/// Time constant of the wander of the ambient temperature, in s (M-05).
pub const WANDER_S: f64 = 600.0;
/// Nominal master clock, in Hz (M-06).
pub const MCLK_HZ: f64 = 6.0e6;
/// Largest relative deviation of the master clock. A part's deviation is uniform between minus and plus this (M-06).
pub const MCLK_TOLERANCE: f64 = 0.01;
/// Standard deviation between parts of the relative sensitivity error (M-07, F-06).
pub const SENSITIVITY_SD: f64 = 0.03;

/// The chamber profile of F-57 as points (minutes from the start, °C): linear between the points, constant outside.
pub const OVEN_MIN_C: [(f64, f64); 7] =
    [(0.0, 25.0), (5.0, 25.0), (37.5, -40.0), (67.5, -40.0), (130.0, 85.0), (145.0, 85.0), (175.0, 25.0)];
