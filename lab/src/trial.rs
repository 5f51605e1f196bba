//! Calibrates twins and compares the results with the truth, for ordinary units and for units that are disturbed
//! during the calibration.

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, MCLK_HZ, Sample, Sampler, SamplerConfig};
use adis16130_twin::{Motion, Roa, Spec, Truth, Twin, TwinRdy, TwinSpi};
use anyhow::{Context, anyhow};
use zerorate::{
    Action, Axis, Correction, Event, Method, Outcome, Plan, Procedure, Reading, Refusal, State, Uncertainty,
};

/// Time without an edge after which the part counts as failed, ns.
const NO_EDGE_NS: u64 = 100_000_000;
/// Duration of the procedure of AN-1042 from the start of the twin, s.
pub const HOUR_S: f64 = 3171.0;

/// The plan for a method. The plan for a cycle takes 70 minutes, after which the part is in thermal equilibrium again.
pub fn plan(method: Method) -> Plan {
    let settle_s = if method == Method::Cycle { 3429.0 } else { Plan::default().settle_s };
    Plan { method, settle_s, ..Plan::default() }
}

/// The air temperature of a cycle: start of each change, s, and the temperature relative to the initial one, °C.
const CYCLE: [(f64, f64); 2] = [(1200.0, -8.0), (2400.0, 0.0)];
/// Duration of each change of the air temperature, s.
const RAMP_S: f64 = 480.0;

pub struct Rig {
    pub twin: Twin,
    pub gyro: Adis16130<TwinSpi, TwinRdy>,
    axis: Axis,
    mclk_hz: u32,
    ambient_c: f64,
    pub sampler: Sampler,
    /// Time, s, and true temperature, °C, every ten seconds of a calibration.
    pub temps: Vec<(f64, f64)>,
}

/// Time between two of [`Rig::temps`], s.
const TEMPS_S: f64 = 10.0;

impl Rig {
    pub fn new(spec: Spec) -> Self {
        // a host knows the nominal clock, or the actual clock if it slowed the part's clock down itself
        let is_nominal = (spec.mclk_hz / f64::from(MCLK_HZ) - 1.0).abs() < 0.05;
        let mclk_hz = if is_nominal { MCLK_HZ } else { spec.mclk_hz as u32 };
        let bandwidth_hz = match spec.roa {
            Roa::TenNanofarad => Some(Axis::ADIS16130_ROA_10NF_HZ),
            Roa::Open => Axis::ADIS16130.bandwidth_hz,
        };
        let ambient_c = spec.ambient_c;
        let twin = Twin::new(spec);
        let gyro = Adis16130::new(twin.spi(), twin.rdy(), Config::default());
        Self {
            twin,
            gyro,
            axis: Axis { bandwidth_hz, ..Axis::ADIS16130 },
            mclk_hz,
            ambient_c,
            sampler: new_sampler(mclk_hz),
            temps: Vec::new(),
        }
    }

    pub fn initialise(&mut self) -> anyhow::Result<u64> {
        self.sampler = new_sampler(self.mclk_hz);
        self.gyro.init().map_err(|error| anyhow!("{error}"))?;
        Ok(self.twin.now_ns())
    }

    pub fn read(&mut self) -> anyhow::Result<Sample> {
        loop {
            let edge = self.twin.next_falling_edge(NO_EDGE_NS).context("no data ready")?;
            let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
            if let Some(sample) = self.gyro.sample(&mut self.sampler, edge).map_err(|error| anyhow!("{error}"))? {
                return Ok(sample);
            }
        }
    }

    /// Runs a calibration. Returns the result, and the truth at the end of step 8 or of the recording. A refusal is an
    /// error that can be downcast to `Refusal`.
    pub fn calibrate(&mut self, plan: Plan) -> anyhow::Result<(Outcome, Truth)> {
        let mut air = if plan.method == Method::Cycle { &CYCLE[..] } else { &[] };
        let mut procedure = Procedure::new(&self.axis, plan)?;
        let mut truth = None;
        loop {
            match procedure.next() {
                Action::Initialise => procedure.handle(Event::Initialised { t_ns: self.initialise()? })?,
                Action::Read => procedure.handle(Event::Reading(&Reading::from(&self.read()?)))?,
                Action::Done => break,
            }
            if procedure.progress().elapsed_s >= self.temps.len() as f64 * TEMPS_S {
                let now = self.twin.truth();
                self.temps.push((now.t_ns as f64 * 1e-9, now.element_c));
            }
            if let [(at_s, by_c), rest @ ..] = air
                && procedure.progress().elapsed_s >= *at_s
            {
                self.twin.set_ambient(self.ambient_c + by_c, RAMP_S);
                air = rest;
            }
            if truth.is_none() && procedure.progress().state == State::FinalTemperature {
                truth = Some(self.twin.truth());
            }
        }
        let truth = truth.unwrap_or_else(|| self.twin.truth());
        Ok((procedure.finish()?, truth))
    }

    /// Calibrates. Returns an error if the bus fails or the plan is invalid.
    pub fn run(&mut self, plan: Plan) -> anyhow::Result<TrialEnd> {
        match self.calibrate(plan) {
            Ok((outcome, truth)) => {
                let of_events = outcome.warnings.iter().filter(|warning| !warning.is_standing());
                let codes = of_events.map(zerorate::Warning::code);
                // this warning says that a longer average would be better, not that the result may be wrong
                let warnings = codes.filter(|code| *code != "short-average").collect();
                Ok(TrialEnd::Calibrated { unit: judge(&outcome, &truth), warnings })
            }
            Err(error) => error.downcast::<Refusal>().map(|_| TrialEnd::Refused),
        }
    }
}

fn new_sampler(mclk_hz: u32) -> Sampler {
    Sampler::new(SamplerConfig::default(), &Config::default(), mclk_hz)
}

/// The error of an estimate, and its stated standard uncertainty.
#[derive(Clone, Copy, Debug)]
pub struct EstimateError {
    pub error: f64,
    pub u: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Unit {
    pub pbc: EstimateError,
    pub btc: EstimateError,
}

pub fn judge(outcome: &Outcome, truth: &Truth) -> Unit {
    let Correction { pbc_dps, btc_dps_per_c, t3_c, .. } = outcome.correction;
    let uncertainty = &outcome.uncertainty;
    Unit {
        pbc: EstimateError { error: pbc_dps - truth.pbc_dps(t3_c), u: uncertainty.u_pbc_dps },
        btc: EstimateError { error: btc_dps_per_c - truth.btc_dps_per_c(t3_c), u: uncertainty.u_btc_dps_per_c },
    }
}

#[derive(Clone, Debug)]
pub enum TrialEnd {
    /// There is a result. `warnings` are the codes of warnings that report an event, except `short-average`.
    Calibrated {
        unit: Unit,
        warnings: Vec<&'static str>,
    },
    Refused,
}

impl TrialEnd {
    /// The larger ratio of error to standard uncertainty of PBC and BTC; 0 if the measurement was refused.
    pub fn worst(&self) -> f64 {
        match self {
            Self::Calibrated { unit, .. } => {
                (unit.pbc.error / unit.pbc.u).abs().max((unit.btc.error / unit.btc.u).abs())
            }
            Self::Refused => 0.0,
        }
    }

    /// True if there is a result without a warning.
    pub fn is_silent(&self) -> bool {
        matches!(self, Self::Calibrated { warnings, .. } if warnings.is_empty())
    }

    /// True if PBC or BTC is outside its 95 % interval without a warning.
    pub fn is_wrong_and_silent(&self) -> bool {
        self.is_silent() && self.worst() > Uncertainty::FACTOR
    }
}

/// A kind of disturbance. The unit's seed determines the details.
pub struct Fault {
    pub name: &'static str,
    pub spec: fn(u64) -> Spec,
}

/// Disturbances that the procedure has to detect. The first entry has none. The seed sets sizes, times and signs.
pub const FAULTS: [Fault; 12] = [
    Fault { name: "none", spec: Spec::from_seed },
    Fault { name: "supply step of 20 to 400 mV at any time", spec: |seed| step(seed, 0.0, HOUR_S) },
    Fault { name: "the same in step 4", spec: |seed| step(seed, 0.0, 10.5) },
    Fault { name: "the same around step 6", spec: |seed| step(seed, 600.0, 625.0) },
    Fault { name: "the same in step 8, but for its last 10 s", spec: |seed| step(seed, 3015.0, 3160.0) },
    Fault { name: "the same in the last 10 s of step 8", spec: |seed| step(seed, 3160.0, 3170.0) },
    Fault { name: "sway of 0.02 to 0.5 °/s, 0.001 to 0.05 Hz", spec: |seed| sway(seed, 1e-3, 0.05) },
    Fault { name: "the same, 0.0002 to 0.001 Hz", spec: |seed| sway(seed, 2e-4, 1e-3) },
    Fault { name: "the same, 0.00001 to 0.0002 Hz", spec: |seed| sway(seed, 1e-5, 2e-4) },
    Fault {
        name: "lag of 30 to 3000 s",
        spec: |seed| Spec { lag_s: draw(seed, 1).between_logs(30.0, 3000.0), ..Spec::from_seed(seed) },
    },
    Fault {
        name: "curvature of 0.002 to 0.01 °/s/°C²",
        spec: |seed| {
            let curvature_dps_per_c2 = draw(seed, 1).sign() * draw(seed, 2).between_logs(0.002, 0.01);
            Spec { curvature_dps_per_c2, ..Spec::from_seed(seed) }
        },
    },
    Fault {
        name: "hysteresis of 0.02 to 0.5 °/s",
        spec: |seed| Spec { hysteresis_dps: draw(seed, 1).between_logs(0.02, 0.5), ..Spec::from_seed(seed) },
    },
];

/// A unit on a base that sways slowly, with a period of 1000 to 10 000 s. The uncertainty of the methods that use the
/// whole recording must include this motion.
pub fn slow_sway(seed: u64) -> Spec {
    let (sway_dps, sway_hz) = (draw(seed, 1).between_logs(0.01, 0.2), draw(seed, 2).between_logs(1e-4, 1e-3));
    Spec { motion: Motion::Sway, sway_dps, sway_hz, ..Spec::from_seed(seed) }
}

fn step(seed: u64, from_s: f64, to_s: f64) -> Spec {
    let supply_step_mv = draw(seed, 1).sign() * draw(seed, 2).between(20.0, 400.0);
    Spec { supply_step_mv, fault_at_s: Some(draw(seed, 3).between(from_s, to_s)), ..Spec::from_seed(seed) }
}

fn sway(seed: u64, from_hz: f64, to_hz: f64) -> Spec {
    let (sway_dps, sway_hz) = (draw(seed, 1).between_logs(0.02, 0.5), draw(seed, 2).between_logs(from_hz, to_hz));
    Spec { motion: Motion::Sway, sway_dps, sway_hz, ..Spec::from_seed(seed) }
}

/// A random number from 0 to 1 that depends only on the seed and on `which`, the number of the draw (splitmix64).
struct Draw(f64);

fn draw(seed: u64, which: u64) -> Draw {
    let mut state = (seed << 8 | which).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    state = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    state = (state ^ (state >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    Draw(((state ^ (state >> 31)) >> 11) as f64 / (1u64 << 53) as f64)
}

impl Draw {
    fn between(&self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0
    }

    fn between_logs(&self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.0)
    }

    fn sign(&self) -> f64 {
        if self.0 < 0.5 { -1.0 } else { 1.0 }
    }
}
