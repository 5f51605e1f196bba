//! How well PBC, BTC and T3 are known.

/// Standard uncertainties and covariances (k = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Of B1 as the bias during step 4: white noise and flicker, °/s.
    pub u_b1_dps: f64,
    /// Of B2 as the bias during step 6, °/s.
    pub u_b2_dps: f64,
    /// Of T1, noise alone, °C.
    pub u_t1_c: f64,
    /// Of T2, noise alone, °C.
    pub u_t2_c: f64,
    /// Of PBC as minus the slow bias at T3 at the end of step 8, °/s.
    pub u_pbc_dps: f64,
    /// Of BTC as minus the slope of the bias at T3, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// The part of it that stands for curvature and hysteresis, °/s/°C; zero under
    /// [`Plan::assume_linear`](crate::Plan::assume_linear).
    pub u_curvature_dps_per_c: f64,
    /// Of T3, noise alone, °C.
    pub u_t3_c: f64,
    /// Covariance of PBC and BTC, (°/s)²/°C.
    pub cov_pbc_btc: f64,
    /// Covariance of PBC and T3, °C·°/s.
    pub cov_pbc_t3: f64,
    /// A part of [`u_pbc_dps`](Self::u_pbc_dps) with a known sign, °/s: PBC belongs to the mean temperature of step 8,
    /// as AN-1042 takes it, and is that much above what it would be at T3: −BTC × (T3 − mean temperature).
    pub drift_dps: f64,
}

impl Uncertainty {
    /// Probability that the interval `value ± FACTOR · u` covers the truth.
    pub const COVERAGE: f64 = 0.95;
    /// Factor of that interval, of the normal distribution.
    pub const FACTOR: f64 = 1.959_963_984_540_054;
}
