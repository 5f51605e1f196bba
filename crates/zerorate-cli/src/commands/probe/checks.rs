//! What the probe of a part comes to, as checks that are well or not, for those who look on while it is read.

use super::{AxisFindings, host};
use crate::acquire::lost_on_the_way;
use crate::commands::{coded, flag};
use crate::judged::JudgedAxis;
use zerorate::{Checkup, Limits, NamedAxis, Say, Tally};
use zerorate_data::believed;
use zerorate_data::capture::{Layout, Row};
use zerorate_host::{Bus, Facts, Losses};
use zerorate_web::message::CheckResult;

/// How long samples are looked at, as by `zerorate probe`, ns.
const DURATION_NS: u64 = 5_000_000_000;

fn check(what: &str, ok: bool, text: impl Into<String>) -> CheckResult {
    CheckResult { what: what.to_owned(), ok, text: text.into() }
}

/// What opening a device has shown.
pub fn connection_checks(revision: Option<u8>, bus: Option<Bus>) -> Vec<CheckResult> {
    let answers = revision.map(|revision| {
        check("part", true, format!("answers, revision {revision:02X}h; every register written reads back"))
    });
    let bus = bus.map(|bus| {
        let mhz = |hz: u32| f64::from(hz) * 1e-6;
        let (ok, fastest) = match bus.fastest_clean_hz {
            Some(hz) => (hz >= bus.sclk_hz, format!("up to {} MHz", mhz(hz))),
            None => (false, "at none of the clocks tried".to_owned()),
        };
        check("SPI", ok, format!("{} MHz; reads back {fastest}", mhz(bus.sclk_hz)))
    });
    answers.into_iter().chain(bus).collect()
}

/// The first seconds of samples, on their way elsewhere.
pub struct Examination {
    layout: Layout,
    named: Vec<NamedAxis>,
    axes: Vec<JudgedAxis>,
    checkups: Vec<Checkup>,
    tally: Tally,
    nominal_hz: Option<f64>,
    mclk_hz: u32,
    bus: Option<Bus>,
    start_ns: Option<u64>,
}

impl Examination {
    /// Of a device, before its first sample.
    pub fn new(facts: &Facts, bus: Option<Bus>) -> Self {
        let named = facts.part.axes.to_vec();
        Self {
            layout: facts.info.layout.clone(),
            axes: named.iter().map(JudgedAxis::new).collect(),
            checkups: vec![Checkup::default(); named.len()],
            named,
            tally: Tally::default(),
            nominal_hz: facts.rate_hz,
            mclk_hz: facts.mclk_hz,
            bus,
            start_ns: None,
        }
    }

    /// Takes samples in; what they have shown once there are enough.
    pub fn push(&mut self, rows: &[Row], losses: Losses) -> Option<Vec<CheckResult>> {
        for row in rows {
            for (index, (axis, checkup)) in self.axes.iter_mut().zip(&mut self.checkups).enumerate() {
                let Some(reading) = self.layout.reading(row, index) else { continue };
                if index == 0 {
                    self.tally.count(&reading);
                }
                axis.health.push(&reading).iter().for_each(|judged| checkup.push(judged));
            }
            if row.t_ns - *self.start_ns.get_or_insert(row.t_ns) >= DURATION_NS {
                return Some(self.checks(losses));
            }
        }
        None
    }

    fn checks(&self, losses: Losses) -> Vec<CheckResult> {
        let tally = &self.tally;
        let first = self.checkups.first();
        let of_the_part = first.map(|first| first.warnings(tally, self.nominal_hz, &Limits::default()));
        let mut wrong: Vec<String> = of_the_part.iter().flatten().map(coded).collect();
        let healths = self.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
        wrong.extend(believed::of_axes(healths, tally, self.start_ns.unwrap_or_default()));
        wrong.extend(lost_on_the_way(losses));
        wrong.extend(self.proposal().map(|options| format!("this host would lose fewer with {options}")));
        let counted =
            format!("{:.1} a second, {} lost; data ready {:.1} Hz", tally.rate_hz(), tally.lost, tally.rdy_hz());
        let samples = check("samples", wrong.is_empty(), [vec![counted], wrong].concat().join("; "));
        [samples].into_iter().chain(self.noise()).collect()
    }

    fn proposal(&self) -> Option<String> {
        let taken = self.tally.samples as f64 / (self.tally.samples + self.tally.lost) as f64;
        host::proposal(taken, self.bus?.read_s?, self.mclk_hz)
    }

    fn noise(&self) -> impl Iterator<Item = CheckResult> {
        let several = self.named.len() > 1;
        let all = self.named.iter().zip(&self.checkups).zip(&self.axes);
        all.filter_map(move |((named, checkup), judged)| {
            let frozen = judged.health.frozen_at_end().is_some();
            let found = AxisFindings::new(several, named, checkup, self.tally.rate_hz(), frozen);
            let white = found.white_dps_per_rt_hz?;
            let warning = Checkup::noise_warning(&named.axis, white, &Limits::default());
            let what = if several { format!("noise of {}", named.name) } else { "noise".to_owned() };
            let typical = found.typical_white_dps_per_rt_hz;
            let typical = typical.map_or(String::new(), |typical| format!(" (typical {typical})"));
            let measured = format!("{white:.4} °/s/√Hz{typical}");
            Some(match warning {
                None => check(&what, true, measured),
                Some(warning) => {
                    check(&what, false, format!("{measured}; {}: {}", warning.code(), warning.with(flag)))
                }
            })
        })
    }
}
