//! Uncertainties of PBC, BTC and T3.

/// Standard uncertainties and covariances (k = 1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Uncertainty of B1 as the bias during step 4, by white noise and flicker, °/s.
    pub u_b1_dps: f64,
    /// Uncertainty of B2 as the bias during step 6, °/s.
    pub u_b2_dps: f64,
    /// Uncertainty of T1 by noise alone, °C.
    pub u_t1_c: f64,
    /// Uncertainty of T2 by noise alone, °C.
    pub u_t2_c: f64,
    /// Uncertainty of PBC, °/s. PBC is minus the slowly varying bias, at T3 and at the end of step 8.
    pub u_pbc_dps: f64,
    /// Uncertainty of BTC, °/s/°C. BTC is minus the slope of the bias at T3.
    pub u_btc_dps_per_c: f64,
    /// The part of the uncertainty of BTC that allows for curvature and hysteresis, °/s/°C. It is zero for a curve
    /// and under [`Plan::assume_linear`](crate::Plan::assume_linear).
    pub u_curvature_dps_per_c: f64,
    /// Uncertainty of T3 by noise alone, °C.
    pub u_t3_c: f64,
    /// Covariance of PBC and BTC, (°/s)²/°C.
    pub cov_pbc_btc: f64,
    /// Covariance of PBC and T3, °C·°/s.
    pub cov_pbc_t3: f64,
    /// A part of [`u_pbc_dps`](Self::u_pbc_dps) with a known sign, °/s. As AN-1042 computes it, PBC belongs to the
    /// mean temperature of step 8. So it is above its value at T3 by −BTC × (T3 − mean temperature).
    pub drift_dps: f64,
}

impl Uncertainty {
    /// Probability that the interval `value ± FACTOR · u` covers the truth.
    pub const COVERAGE: f64 = 0.95;
    /// Half width of the 95 % interval of a normal distribution, in standard deviations.
    pub const FACTOR: f64 = 1.959_963_984_540_054;
}
