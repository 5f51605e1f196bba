//! Checks that a part responds, is wired correctly, and delivers plausible samples.

use crate::acquisition::Acquisition;
use crate::proposal::proposal;
use crate::warning::{CodedWarning, JobWarning};
use adis16130::{Framing, SelfTest};
use anyhow::{Result, ensure};
use serde::Serialize;
use zerorate::{Axis, Checkup, NamedAxis, SettingNames};
use zerorate_host::Bus;
use zerorate_view::Seconds;

/// The JSON object of `probe --json`. The field names must not change.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct Findings {
    pub device: String,
    /// The revision register; `None` if it is unknown, as for a replay or a kernel driver.
    pub revision: Option<u8>,
    /// The framing of the bytes by CS (F-22): per byte or per command. `None` if this program does not control CS.
    pub framing: Option<&'static str>,
    pub self_test: Option<SelfTestResult>,
    /// The SPI clock, Hz; `None` without an SPI bus.
    pub sclk_hz: Option<u32>,
    /// The highest of the tested clocks at which the configuration reads back correctly, Hz; `None` if there is none,
    /// or without an SPI bus.
    pub fastest_clean_sclk_hz: Option<u32>,
    pub read_us: Option<f64>,
    /// Share of the part's samples that the host read, 0 to 1.
    pub taken: f64,
    /// Settings that would lose fewer samples; `None` if hardly any are lost, if the time of a read is unknown, or if
    /// no divider suffices.
    pub proposal: Option<String>,
    pub rdy_hz: f64,
    pub rate_hz: f64,
    pub samples: u64,
    pub lost_samples: u64,
    pub longest_gap_ms: f64,
    pub duration_s: f64,
    /// The findings of a part with one axis. `None` for a part with several axes, whose findings are in `axes`.
    #[serde(flatten)]
    pub only: Option<AxisFindings>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<AxisFindings>,
    pub temp_c: Option<f64>,
    pub warnings: Vec<CodedWarning>,
}

/// The findings about an axis.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct AxisFindings {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    pub rate_dps: f64,
    pub white_dps_per_rt_hz: Option<f64>,
    #[serde(skip)]
    pub typical_white_dps_per_rt_hz: Option<f64>,
}

/// The change of the rate under self-test.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct SelfTestResult {
    pub shift_dps: f32,
    /// Standard uncertainty of `shift_dps`, °/s.
    pub u_dps: f32,
    /// Number of samples averaged with the self-test on. The same number is averaged with the self-test off.
    pub samples: u32,
}

/// Resets the part, initialises it and reads samples for `duration`. Also runs the self-test by the line `gpio`, if
/// given. Calls `see` with the seconds read, every 4096 samples. Messages use `names` for the settings.
///
/// # Errors
/// Returns an error if the part cannot be read, the self-test cannot be run, or the probe is interrupted.
pub fn probe(
    mut acquisition: Acquisition,
    duration: Seconds,
    gpio: Option<&str>,
    names: SettingNames,
    see: &mut dyn FnMut(f64),
) -> Result<Findings> {
    let (revision, bus) = (acquisition.initialise()?, acquisition.try_bus()?);
    let self_test = gpio.map(|gpio| acquisition.self_test(gpio, names)).transpose()?;
    let checkups = read(&mut acquisition, duration, see)?;
    ensure!(acquisition.tally().samples > 0, "no samples were read");
    Ok(Findings::new(acquisition, (revision, bus, self_test), &checkups, names))
}

fn read(acquisition: &mut Acquisition, duration: Seconds, see: &mut dyn FnMut(f64)) -> Result<Vec<Checkup>> {
    let mut checkups = vec![Checkup::default(); acquisition.part().axes.len()];
    let mut judged = Vec::new();
    let mut first_ns = None;
    while acquisition.next_judged(&mut judged)? {
        checkups.iter_mut().zip(&judged).for_each(|(checkup, judged)| checkup.push(judged));
        let t_ns = judged.first().map_or(0, |first| first.reading.t_ns);
        let elapsed_ns = t_ns.saturating_sub(*first_ns.get_or_insert(t_ns));
        if elapsed_ns >= duration.nanos() {
            break;
        }
        if acquisition.is_time_to_show() {
            see(elapsed_ns as f64 * 1e-9);
        }
    }
    ensure!(!acquisition.is_stopped(), "interrupted");
    Ok(checkups)
}

impl Findings {
    fn new(
        mut acquisition: Acquisition,
        (revision, bus, self_test): (Option<u8>, Option<Bus>, Option<SelfTest>),
        checkups: &[Checkup],
        names: SettingNames,
    ) -> Self {
        let of_the_samples = acquisition.warnings();
        let tally = *acquisition.tally();
        let facts = acquisition.facts();
        let frozen = acquisition.healths().map(|health| health.frozen_at_end().is_some());
        let several = checkups.len() > 1;
        let named = facts.part.axes.iter().zip(checkups).zip(frozen);
        let mut axes: Vec<AxisFindings> = named
            .map(|((named, checkup), frozen)| AxisFindings::new(several, named, checkup, tally.rate_hz(), frozen))
            .collect();
        let first = checkups.first().zip(facts.part.axes.first());
        let of_the_part = first.map(|(first, _)| first.warnings(&tally, facts.rate_hz));
        let of_the_part = of_the_part.into_iter().flatten().map(JobWarning::from);
        let of_the_noise: Vec<JobWarning> =
            axes.iter().zip(&*facts.part.axes).filter_map(|(found, named)| found.noise_warning(&named.axis)).collect();
        let warnings = of_the_samples.into_iter().chain(of_the_noise).chain(of_the_part);
        let temp_c = first.and_then(|(first, named)| first.temp_c(&named.axis));
        let taken = tally.samples as f64 / (tally.samples + tally.lost) as f64;
        Self {
            device: facts.name.clone(),
            revision,
            framing: facts.framing.map(|framing| match framing {
                Framing::PerByte => "byte",
                Framing::Command => "command",
            }),
            self_test: self_test.map(|SelfTest { shift_dps, u_dps, n }| SelfTestResult {
                shift_dps,
                u_dps,
                samples: n,
            }),
            sclk_hz: bus.map(|bus| bus.sclk_hz),
            fastest_clean_sclk_hz: bus.and_then(|bus| bus.fastest_clean_hz),
            read_us: bus.and_then(|bus| bus.read_s).map(|read_s| read_s * 1e6),
            taken,
            proposal: bus.and_then(|bus| bus.read_s).and_then(|read_s| proposal(taken, read_s, facts.mclk_hz, names)),
            rdy_hz: tally.rdy_hz(),
            rate_hz: tally.rate_hz(),
            samples: tally.samples,
            lost_samples: tally.lost,
            longest_gap_ms: tally.longest_gap_ms(),
            duration_s: tally.duration_s(),
            only: if several { None } else { axes.pop() },
            axes,
            temp_c,
            warnings: warnings.map(|warning| warning.coded(names)).collect(),
        }
    }
}

impl AxisFindings {
    fn new(several: bool, named: &NamedAxis, checkup: &Checkup, rate_hz: f64, is_frozen: bool) -> Self {
        Self {
            name: several.then(|| named.name.to_string()),
            rate_dps: checkup.rate_dps(&named.axis).unwrap_or_default(),
            white_dps_per_rt_hz: checkup.white_dps_per_rt_hz(&named.axis, rate_hz).filter(|_| !is_frozen),
            typical_white_dps_per_rt_hz: named.axis.noise.map(|noise| noise.white_dps_per_rt_hz),
        }
    }

    fn noise_warning(&self, axis: &Axis) -> Option<JobWarning> {
        let warning = Checkup::noise_warning(axis, self.white_dps_per_rt_hz?)?;
        Some(match &self.name {
            Some(name) => JobWarning::OfAxis(name.clone(), warning),
            None => warning.into(),
        })
    }
}
