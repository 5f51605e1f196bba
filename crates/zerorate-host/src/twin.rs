//! The twin as a device: an ADIS16130 simulated in this process, on simulated time.

use crate::address::Address;
use crate::chamber::ProfileFollower;
use crate::edges::Edges;
use crate::error::UserError;
use crate::live::Live;
use crate::options::PartOptions;
use crate::source::{DeviceInfo, Registers, Setup, Source, no_self_test, part_of};
use crate::warning::SourceWarning;
use crate::{Result, Stop};
use adis16130::{Edge, MCLK_HZ, RdyEdge, Sample, SelfTest, Width};
use adis16130_twin::{Profile, Roa, Spec, SpecError, Truth, Twin, TwinSpi};
use std::borrow::Cow;
use zerorate::calibration::Notes;
use zerorate::{Axis, NamedAxis, Part, Scale, Setting, SettingNames};
use zerorate_record::{CaptureInfo, Layout, Row};

/// The address `twin:KEY=VALUE,…`: the simulated units, and their configuration by the driver.
#[derive(Clone, Debug)]
pub struct TwinAddress {
    /// The simulated unit of each axis.
    units: Vec<Spec>,
    part: PartOptions,
}

/// The names of the axes if there are several.
const AXES: [&str; 3] = ["x", "y", "z"];

impl TwinAddress {
    pub fn read(keys: &str) -> Result<Self, String> {
        let (mut part, mut axes, mut unit) = (PartOptions::new(), 1, Vec::new());
        for item in keys.split(',') {
            if let Some(text) = item.trim().strip_prefix("axes=") {
                let count = text.parse().ok().filter(|count| (1..=AXES.len()).contains(count));
                axes = count.ok_or_else(|| format!("`axes={text}`: a twin has 1, 2 or 3 axes"))?;
                continue;
            }
            // these keys set the real bandwidth of the simulated unit
            let of_unit = ["roa=", "bandwidth_hz="].iter().any(|key| item.trim().starts_with(key));
            let changed = if of_unit { None } else { part.with(item.trim())? };
            match changed {
                Some(changed) => part = changed,
                None => unit.push(item),
            }
        }
        let units = (0..axes).map(|axis| unit_of(axis, axes, &unit)).collect::<Result<Vec<_>, _>>();
        let units = units.map_err(|error| match error {
            // `axes` is a key of the address and not of a unit
            SpecError::UnknownKey { nearest: None, .. } => format!("{error} axes"),
            _ => error.to_string(),
        })?;
        part.bandwidth_hz = (units[0].roa == Roa::TenNanofarad).then_some(Axis::ADIS16130_ROA_10NF_HZ);
        Ok(Self { units, part })
    }

    fn live(&self, axis: usize, setup: &Setup, stop: &Stop) -> Live<TwinSpi, TwinEdges> {
        let sampling = setup.sampling.config(self.part.divided);
        let twin = Twin::new(self.units[axis].clone());
        let rising = self.part.config.rdy_edge() == RdyEdge::Rising;
        let edges = TwinEdges { rising, divided: sampling.divided.max(1).into(), counted: 0, twin };
        Live::new(edges.twin.spi(), edges, self.part.config, sampling, self.mclk_hz(), stop)
    }

    /// The master clock that the driver assumes, Hz: nominal (F-31), or the unit's own if that differs by 5 % or more.
    fn mclk_hz(&self) -> u32 {
        let (own_hz, nominal_hz) = (self.units[0].mclk_hz, f64::from(MCLK_HZ));
        if (own_hz / nominal_hz - 1.0).abs() < 0.05 { MCLK_HZ } else { own_hz.round() as u32 }
    }
}

/// The simulated unit of an axis. It has its own random values, but shares clock and temperature with the first
/// axis. With several axes, the temperature has no random part.
fn unit_of(axis: usize, axes: usize, keys: &[&str]) -> Result<Spec, SpecError> {
    let first = Spec::parse_keys(&keys.join(","))?;
    if axes == 1 {
        return Ok(first);
    }
    let seed = format!("seed={}", first.seed.wrapping_add(axis as u64));
    let others = keys.iter().copied().filter(|key| !key.trim().starts_with("seed="));
    let own = Spec::parse_keys(&others.chain([seed.as_str()]).collect::<Vec<_>>().join(","))?;
    Ok(Spec {
        mclk_hz: first.mclk_hz,
        ambient_c: first.ambient_c,
        ambient_wander_c: 0.0,
        warmup_c: first.warmup_c,
        warmup_s: first.warmup_s,
        ..own
    })
}

impl Address for TwinAddress {
    fn is_simulated(&self) -> bool {
        true
    }

    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>> {
        let axes = self.units.len();
        let sampling = setup.sampling.config(self.part.divided);
        let known = setup.part.as_ref().filter(|_| axes == 1);
        let facts = DeviceInfo::of_part(name, &self.part, sampling, self.mclk_hz(), known)?;
        // a recording of a twin states neither time nor computer, so that it depends on the address only
        let info = CaptureInfo { created: String::new(), notes: Notes::default(), ..facts.info };
        let facts = DeviceInfo { info, is_real: false, ..facts };
        let notes = beyond_limits(&self.units[0], &facts.part).into_iter().collect();
        let follower = setup.ambient.clone().map(|profile| ProfileFollower::new(profile, stop));
        let units = (0..axes).map(|axis| self.live(axis, setup, stop)).collect();
        if axes == 1 {
            return Ok(Box::new(Twins { facts, units, follower, notes }));
        }
        let part = several(axes, self.part.config.width());
        let layout = Layout::of_part(&part).map_err(|error| UserError::request(error.to_string()))?;
        let info = CaptureInfo { converter: None, layout, ..facts.info };
        let part = part_of(&info, Some(setup.part.as_ref().unwrap_or(&part)))?;
        Ok(Box::new(Twins { facts: DeviceInfo { info, part, ..facts }, units, follower, notes }))
    }
}

/// A part with several axes, each like an ADIS16130, with codes of this width.
fn several(axes: usize, width: Width) -> Part {
    let in_width = |scale: Scale| scale.without_low_bits(width.dropped_bits() as u8);
    let one = &Part::ADIS16130.axes[0];
    let axis = Axis { rate: in_width(one.axis.rate), temp: in_width(one.axis.temp), ..one.axis };
    let named = |name: &&'static str| NamedAxis { name: Cow::Borrowed(name), axis, ..one.clone() };
    let axes: Vec<NamedAxis> = AXES[..axes].iter().map(named).collect();
    Part { name: format!("ADIS16130x{}", axes.len()).into(), axes: axes.into(), ..Part::ADIS16130 }
}

/// Twins on one clock, one for each axis of the part. The first twin gives the temperature and other common values.
struct Twins {
    facts: DeviceInfo,
    units: Vec<Live<TwinSpi, TwinEdges>>,
    follower: Option<ProfileFollower>,
    notes: Vec<SourceWarning>,
}

impl Source for Twins {
    fn facts(&self) -> DeviceInfo {
        self.facts.clone()
    }

    fn initialise(&mut self) -> Result<Option<u8>> {
        let mut revision = None;
        for unit in &mut self.units {
            revision = Some(unit.initialise()?);
        }
        Ok(revision)
    }

    #[inline]
    fn next(&mut self) -> Result<Option<Row>> {
        if let (Some(follower), Some((first, others))) = (&mut self.follower, self.units.split_first()) {
            follower.before_sample(&first.edges.twin, others.iter().map(|unit| &unit.edges.twin));
        }
        let row = match &mut self.units[..] {
            [unit] => Some(Row::from(&unit.next()?)),
            units => next_of_all(units)?,
        };
        if let (Some(follower), Some(row)) = (&mut self.follower, &row) {
            follower.after_sample(row.t_ns);
        }
        Ok(row)
    }

    fn registers(&mut self) -> Result<Option<Registers>> {
        Ok(self.units.first_mut().map(Live::registers).transpose()?)
    }

    fn self_test(&mut self, gpio: &str, names: SettingNames) -> Result<SelfTest> {
        let [live] = &mut self.units[..] else { return Err(no_self_test(names)) };
        if !gpio.is_empty() {
            let why = "takes no GPIO with the twin, whose pins are its own";
            let option = names(Setting::SelfTest);
            return Err(UserError::request(format!("{option} {why}: leave `{gpio}` out")).into());
        }
        let mut pin = live.edges.twin.self_test_pin();
        Ok(live.self_test(&mut pin)?)
    }

    fn truths(&self) -> Vec<Truth> {
        self.units.iter().map(|unit| unit.edges.twin.truth()).collect()
    }

    fn take_notes(&mut self) -> Vec<SourceWarning> {
        std::mem::take(&mut self.notes)
    }
}

/// Reads the next row of several twins. If one twin lost samples, the other twins' samples of the same time count as
/// lost too.
fn next_of_all(units: &mut [Live<TwinSpi, TwinEdges>]) -> Result<Option<Row>> {
    let mut samples = Vec::with_capacity(units.len());
    for unit in units.iter_mut() {
        samples.push(unit.next()?);
    }
    while let Some(latest_ns) = samples.iter().map(|sample| sample.t_ns).max()
        && samples.iter().any(|sample| sample.t_ns < latest_ns)
    {
        for (unit, sample) in units.iter_mut().zip(&mut samples).filter(|(_, one)| one.t_ns < latest_ns) {
            let next = unit.next()?;
            *sample = Sample { lost: sample.lost.saturating_add(next.lost).saturating_add(1), ..next };
        }
    }
    let codes: Vec<i64> = samples.iter().map(|sample| sample.rate.code().into()).collect();
    let first = Row::from(&samples[0]);
    let row = Row::new(first.t_ns, first.edge_seq, &codes);
    Ok(row.map(|row| row.with_status(first.status).with_temp_code(first.temp_code).with_lost(first.lost)))
}

/// A warning if the ambient temperature is outside of the part's operating range. `None` for the oven's profile.
fn beyond_limits(unit: &Spec, part: &Part) -> Option<SourceWarning> {
    let (low_c, high_c) = part.operating_c?;
    let is_beyond = unit.profile != Profile::Oven && !(low_c..=high_c).contains(&unit.ambient_c);
    let part = part.name.to_string();
    is_beyond.then_some(SourceWarning::BeyondLimits { ambient_c: unit.ambient_c, part, low_c, high_c })
}

/// The RDY line of the twin, optionally with a counter.
struct TwinEdges {
    twin: Twin,
    rising: bool,
    /// Number of edges of the part for each edge that the counter passes.
    divided: u32,
    /// Number of edges that the counter has passed.
    counted: u32,
}

impl Edges for TwinEdges {
    #[inline]
    fn next(&mut self, timeout_ns: u64) -> anyhow::Result<Option<Edge>> {
        let until_ns = self.twin.now_ns().saturating_add(timeout_ns);
        loop {
            let left_ns = until_ns.saturating_sub(self.twin.now_ns());
            let Some(edge) = self.twin.next_edge(self.rising, left_ns) else { return Ok(None) };
            let given = edge.seq / self.divided;
            if self.divided == 1 || std::mem::replace(&mut self.counted, given) != given {
                return Ok(Some(Edge { t_ns: edge.t_ns, seq: given }));
            }
        }
    }

    fn pause(&mut self, ns: u64) {
        self.twin.advance_ns(ns);
    }

    fn now(&self) -> String {
        format!("{:.1} s after power-on", self.twin.now_ns() as f64 * 1e-9)
    }
}
