//! A result with numbers that need up to 17 digits to be read back exactly.

use zerorate::{Axis, Correction, Measured, Noise, Outcome, Plan, Uncertainty, Warning};

pub fn outcome() -> Outcome {
    Outcome {
        curve: None,
        means: Some(Measured { b1_dps: 0.123_456_789_012_345_67, t1_c: 25.2, b2_dps: 0.37, t2_c: 31.3 }),
        correction: Correction::line(-0.253_712_345_678_901_2, -0.040_1, 1.0 / 3.0 + 32.0),
        uncertainty: Uncertainty {
            u_b1_dps: 0.004,
            u_b2_dps: 0.004,
            u_t1_c: 0.0002,
            u_t2_c: 0.0002,
            u_pbc_dps: 0.0026,
            u_btc_dps_per_c: 0.0048,
            u_curvature_dps_per_c: 0.0047,
            u_t3_c: 0.0007,
            cov_pbc_btc: 1e-8,
            cov_pbc_t3: 2e-8,
            drift_dps: 0.0004,
        },
        noise: Noise { model: Axis::ADIS16130.typical_noise(), flicker_measured: false, walk_measured: false },
        rdy_hz: 5692.6,
        rate_hz: 5692.6,
        samples: 18_051_234,
        lost_samples: 3,
        impossible_readings: 0,
        duration_s: 3171.0,
        temp_min_c: 25.1,
        temp_max_c: 33.2,
        plan: Plan { earth_dps: Some(0.003), ..Plan::default() },
        warnings: vec![Warning::Lost { lost: 3, fraction: 1.7e-7 }],
    }
}
