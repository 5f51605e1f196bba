//! The work that the controller and the host both do from a seed: read a unit of the twin through the driver, and
//! correct the readings in four ways.
//!
//! The host includes this file too (`lab/src/firmware/`).

use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, Framing, MCLK_HZ, RateCode, Sampler, SamplerConfig, TempCode};
use adis16130_twin::{Spec, Twin, TwinRdy, TwinSpi};
use zerorate::{Axis, CodeTable, Correction, CorrectionF32, IntegerCorrection, IntegerCurve};

const READINGS: usize = 2_000;

/// Step of the table, and span of the table on either side of T3, °C.
const TABLE_C: (f64, f64) = (0.02, 2.0);

const ROWS: usize = 201;

/// Quadratic and cubic coefficient of the curve, °/s/°C² and °/s/°C³. The quadratic one is the standard deviation of
/// M-02. The two terms are equally large 250 °C from T3.
const CURVE: (f64, f64) = (0.0005, -2e-6);

/// Time without an edge after which the part counts as failed, ns.
const NO_EDGE_NS: u64 = 100_000_000;

/// A reading and its corrected forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The rate code as the part gave it.
    pub rate_code: u32,
    /// The temperature code of the same sample.
    pub temp_code: u32,
    /// The corrected rate code, in integer arithmetic.
    pub corrected_code: u32,
    /// The rate code corrected by a curve of order 3, in integer arithmetic.
    pub curved_code: u32,
    /// The value of the table at this temperature, µ°/s.
    pub table_udps: i32,
    /// The bits of the corrected rate in single precision, °/s.
    pub corrected_f32_bits: u32,
}

/// The correction in the forms that a controller uses.
#[derive(Clone, Debug)]
pub struct Corrections {
    /// The linear correction of codes, in integer arithmetic.
    pub integer: IntegerCorrection,
    /// The correction of codes by a curve of order 3, in integer arithmetic.
    pub curve: IntegerCurve,
    /// The correction in single precision.
    pub single: CorrectionF32,
    rows_udps: [i32; ROWS],
    t3_c: f64,
}

impl Corrections {
    /// Makes the corrections from the coefficients that a perfect calibration of this unit would find.
    pub fn of(twin: &Twin) -> Option<Self> {
        let truth = twin.truth();
        let t3_c = truth.sensor_c;
        let correction = Correction::line(truth.pbc_dps(t3_c), truth.btc_dps_per_c(t3_c), t3_c);
        let curve = Correction { btc2_dps_per_c2: CURVE.0, btc3_dps_per_c3: CURVE.1, ..correction };
        let mut rows_udps = [0; ROWS];
        correction.fill_table(TABLE_C.0, TABLE_C.1, &mut rows_udps).ok()?;
        Some(Self {
            integer: correction.to_integer(&Axis::ADIS16130.rate, &Axis::ADIS16130.temp).ok()?,
            curve: curve.to_integer_curve(&Axis::ADIS16130.rate, &Axis::ADIS16130.temp).ok()?,
            single: correction.to_f32(),
            rows_udps,
            t3_c,
        })
    }

    /// Returns the table of the correction, in which a temperature code finds its row.
    pub fn table(&self) -> CodeTable<'_> {
        CodeTable::new(&self.rows_udps, TABLE_C.0, self.t3_c, &Axis::ADIS16130.temp)
    }
}

/// Converts codes to a corrected rate, °/s, in single precision.
#[inline]
pub fn corrected_dps(single: &CorrectionF32, rate: RateCode, temp: TempCode) -> f32 {
    single.apply(rate.to_dps(), temp.to_celsius())
}

/// Reads the twin with this seed and returns its corrections. `take` gets every reading. Returns `None` if the part
/// does not answer, or if a form of the correction cannot be made.
pub fn run(seed: u64, mut take: impl FnMut(Reading)) -> Option<Corrections> {
    let twin = Twin::new(Spec::from_seed(seed));
    let config = Config::new().with_framing(Framing::Command);
    let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), config);
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
    gyro.reset().ok()?;
    gyro.init_verified().ok()?;
    let corrections = Corrections::of(&twin)?;
    let table = corrections.table();
    for _ in 0..READINGS {
        let (rate, temp) = read(&twin, &mut gyro, &mut sampler)?;
        take(Reading {
            rate_code: rate.code24(),
            temp_code: temp.code24(),
            corrected_code: corrections.integer.apply(rate.code24(), temp.code24()),
            curved_code: corrections.curve.apply(rate.code24(), temp.code24()),
            table_udps: table.look_up_held_udps(temp.code24()),
            corrected_f32_bits: corrected_dps(&corrections.single, rate, temp).to_bits(),
        });
    }
    Some(corrections)
}

fn read(twin: &Twin, gyro: &mut Adis16130<TwinSpi, TwinRdy>, sampler: &mut Sampler) -> Option<(RateCode, TempCode)> {
    loop {
        let edge = twin.next_falling_edge(NO_EDGE_NS)?;
        let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
        if let Some(sample) = gyro.sample(sampler, edge).ok()? {
            return Some((sample.rate, sample.temp?));
        }
    }
}
