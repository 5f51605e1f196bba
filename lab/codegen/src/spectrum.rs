//! Plots spectra of the twin at rest. Four ways of sampling show the effects of bandwidth, capacitor and divider.

use crate::bandwidth::fold;
use adis16130::blocking::Adis16130;
use adis16130::{Config, Edge, MCLK_HZ, Sampler, SamplerConfig};
use adis16130_twin::facts::{POLE_HZ, POLE_ROA_10NF_HZ, RESONANCE_HZ, UPPER_POLE_HZ, WHITE_DPS_PER_RT_HZ};
use adis16130_twin::{Roa, Spec, Twin};
use anyhow::{Context, Result, anyhow};
use zerorate::Axis;
use zerorate_allan::welch;
use zerorate_view::plot::{Spectrum, Tone, spectra};

/// The unit does not heat itself, so that only its noise varies. Its clock is nominal, so that the resonance aliases
/// to the frequency that the facts state (F-07).
const UNIT: &str = "seed=4,warmup_c=0";
/// Number of samples of a record at the full rate. Welch's estimate divides them into segments of a quarter of this
/// length, so that the spectrum begins at 0.35 Hz.
const SAMPLES: usize = 1 << 17;
/// Number of samples of a record at less than a twentieth of the full rate. The full number would take minutes.
const SAMPLES_DIVIDED: usize = 1 << 14;
/// Time without an edge after which the part counts as failed, ns.
const NO_EDGE_NS: u64 = 100_000_000;
/// Number of multiples of the sampling rate, on either side of zero, around which aliased noise is added. The poles
/// suppress the noise at higher frequencies.
const IMAGES: i32 = 64;

#[derive(Clone, Copy)]
struct Setup {
    name: &'static str,
    roa: Roa,
    divider: u16,
    samples: usize,
    /// The bandwidth to mark in the plot, Hz (F-03, F-04).
    bandwidth_hz: Option<f64>,
}

pub fn draw() -> Result<String> {
    let (open, filtered) = (Axis::ADIS16130.bandwidth_hz, Some(Axis::ADIS16130_ROA_10NF_HZ));
    let roa = Roa::TenNanofarad;
    let every = Setup { name: "every edge", roa: Roa::Open, divider: 1, samples: SAMPLES, bandwidth_hz: open };
    let few = Setup { name: "every 50th edge", divider: 50, samples: SAMPLES_DIVIDED, bandwidth_hz: None, ..every };
    let ways = [
        every,
        Setup { name: "every edge, 0.01 µF", roa, bandwidth_hz: filtered, ..every },
        few,
        Setup { name: "every 50th edge, 0.01 µF", roa, bandwidth_hz: filtered, ..few },
    ];
    let all = ways.iter().map(Setup::spectrum).collect::<Result<Vec<_>>>()?;
    Ok(spectra("A part at rest, read in four ways (twin, seed 4, at the nominal clock)", &all, "°/s/√Hz") + "\n")
}

impl Setup {
    fn spectrum(&self) -> Result<Spectrum> {
        let (rate_dps, rate_hz) = self.record()?;
        let densities = welch(&rate_dps, rate_hz).map_err(|error| anyhow!("{error}"))?;
        let points: Vec<(f64, f64)> =
            densities.iter().map(|one| (one.frequency_hz, (2.0 * one.density).sqrt())).collect();
        let folded_hz = fold(RESONANCE_HZ, rate_hz);
        let resonance =
            Tone { frequency_hz: folded_hz, rms: 1.0, label: format!("resonance, folded to {folded_hz:.0} Hz") };
        let bandwidth = self.bandwidth_hz.map(|frequency_hz| Tone {
            frequency_hz,
            rms: 2.0,
            label: format!("bandwidth {frequency_hz:.0} Hz"),
        });
        Ok(Spectrum {
            label: format!("{}: {rate_hz:.1}/s", self.name),
            model: points.iter().map(|&(hz, _)| (hz, self.expected(hz, rate_hz))).collect(),
            points,
            tones: bandwidth.into_iter().chain([resonance]).collect(),
        })
    }

    /// Samples the twin. Returns the measured rates, °/s, and the sampling frequency, Hz.
    fn record(&self) -> Result<(Vec<f64>, f64)> {
        let twin = Twin::new(Spec { roa: self.roa, mclk_hz: f64::from(MCLK_HZ), ..Spec::parse_keys(UNIT)? });
        let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), Config::default());
        let config = SamplerConfig { divider: self.divider, ..SamplerConfig::default() };
        let mut sampler = Sampler::new(config, &Config::default(), MCLK_HZ);
        gyro.init().map_err(|error| anyhow!("{error}"))?;
        let mut samples = Vec::with_capacity(self.samples);
        while samples.len() < self.samples {
            let edge = twin.next_falling_edge(NO_EDGE_NS).context("no data ready")?;
            let edge = Edge { t_ns: edge.t_ns, seq: edge.seq };
            samples.extend(gyro.sample(&mut sampler, edge).map_err(|error| anyhow!("{error}"))?);
        }
        let span_ns = samples[samples.len() - 1].t_ns - samples[0].t_ns;
        let rate_hz = (samples.len() - 1) as f64 / (span_ns as f64 * 1e-9);
        Ok((samples.iter().map(|sample| f64::from(sample.rate.to_dps())).collect(), rate_hz))
    }

    /// The expected density at `hz`, °/s/√Hz: white noise filtered by two poles (F-02, F-03, F-04), with its aliases.
    fn expected(&self, hz: f64, rate_hz: f64) -> f64 {
        let pole_hz = match self.roa {
            Roa::Open => POLE_HZ,
            Roa::TenNanofarad => POLE_ROA_10NF_HZ,
        };
        let power = |hz: f64| 1.0 / ((1.0 + (hz / pole_hz).powi(2)) * (1.0 + (hz / UPPER_POLE_HZ).powi(2)));
        let images = (-IMAGES..=IMAGES).map(|k| power(hz + f64::from(k) * rate_hz));
        WHITE_DPS_PER_RT_HZ * images.sum::<f64>().sqrt()
    }
}
