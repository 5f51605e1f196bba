//! A guided calibration: the procedure, what to do now, and what would be refused.

use super::axis::AxisState;
use super::shelf::entry;
use crate::message::{
    AxisResult, CalibrateWish, Calibrating, CalibrationResult, CurvePoint, MethodName, Running, Step,
};
use adis16130_twin::Truth;
use zerorate::calibration::CalibratedAxis;
use zerorate::{
    Action, AxisRefusal, Calibration, Event, Method, Outcome, Part, PartProcedure, Plan, Say, Scan, Setting, State,
    resonance,
};
use zerorate_data::capture::{CaptureInfo, Row, SampleHash};

/// How often what would be refused is looked at, s of part time.
const LOOK_EVERY_S: f64 = 2.0;
/// The same for how well a curve is known: that takes about 0.1 s.
const REACH_EVERY_S: f64 = 60.0;
/// Points of a curve.
const POINTS: u8 = 9;

/// A calibration under way.
#[derive(Debug)]
pub struct Guide {
    pub method: MethodName,
    serial: Option<String>,
    procedure: PartProcedure,
    hash: SampleHash,
    temps_c: Option<[f64; 4]>,
    threats: Vec<String>,
    u_dps: Option<f64>,
    look_s: f64,
    reach_s: f64,
}

impl Guide {
    /// Before the first reading of a part that was just initialised.
    pub fn new(wish: &CalibrateWish, part: &Part, info: &CaptureInfo) -> Result<Self, String> {
        let procedure = PartProcedure::new(part, plan(wish)).map_err(|error| error.with(label).to_string())?;
        Ok(Self {
            method: wish.method,
            serial: wish.serial.clone().filter(|serial| !serial.trim().is_empty()),
            procedure,
            hash: SampleHash::new(&info.layout),
            temps_c: None,
            threats: Vec::new(),
            u_dps: None,
            look_s: 0.0,
            reach_s: 0.0,
        })
    }

    /// Takes a reading; true where the procedure is done with it.
    #[inline]
    pub fn take(&mut self, row: &Row, scan: &Scan) -> Result<bool, String> {
        if self.procedure.next() == Action::Initialise {
            self.handle(Event::Initialised { t_ns: row.t_ns })?;
        }
        self.hash.update(row);
        self.handle(Event::Reading(scan))?;
        Ok(self.procedure.next() == Action::Done)
    }

    /// Ends a recording here; false where the method has steps that are still to come.
    pub fn end_recording(&mut self) -> Result<bool, String> {
        self.procedure.end_recording().map_err(|refusal| worded(&refusal))
    }

    /// Once in a while: the temperature, and what would be refused.
    pub fn look(&mut self, temp_c: Option<f64>) {
        if let Some(now_c) = temp_c {
            let [first, _, low, high] = self.temps_c.unwrap_or([now_c; 4]);
            self.temps_c = Some([first, now_c, low.min(now_c), high.max(now_c)]);
        }
        let elapsed_s = self.procedure.progress().elapsed_s;
        if elapsed_s >= self.look_s {
            self.look_s = elapsed_s + LOOK_EVERY_S.max(elapsed_s / 100.0);
            self.threats = self.procedure.threats().map(|refusal| worded(&refusal)).collect();
        }
        if elapsed_s >= self.reach_s + REACH_EVERY_S {
            self.reach_s = elapsed_s;
            self.u_dps = self.procedure.reached().map(|reached| reached.u_dps);
        }
    }

    pub fn shown(&self) -> Calibrating {
        let progress = self.procedure.progress();
        let steps: Vec<Step> = self
            .procedure
            .plan()
            .steps()
            .map(|(state, from_s, to_s)| Step { name: state.to_string(), from_s, to_s })
            .collect();
        Calibrating::Running(Running {
            method: self.method,
            steps,
            elapsed_s: progress.elapsed_s,
            left_s: (progress.total_s - progress.elapsed_s).max(0.0),
            advice: self.advice(progress.state),
            threats: self.threats.clone(),
            temps_c: self.temps_c,
            u_dps: self.u_dps,
            can_finish: progress.state == State::Recording && progress.elapsed_s > REACH_EVERY_S,
        })
    }

    fn advice(&self, state: State) -> String {
        let warmed_c = self.temps_c.map_or(0.0, |[first, now, ..]| now - first);
        match (state, self.method) {
            (State::Start, _) => "Leave the part where it is: it is being initialised.".to_owned(),
            (State::Recording, MethodName::Cycle) => {
                "Heat the part, then let it cool, as far as it will see in use; do not move it.".to_owned()
            }
            (State::WarmUp | State::Recording, _) => format!(
                "Leave the part alone while it warms itself; it is {warmed_c:+.2} °C from where it began. No draught, \
                 no touch, no load on its supply that switches."
            ),
            (State::Settle, _) => "Leave the part alone until its temperature has settled.".to_owned(),
            _ => "Do not touch the table: the part is being averaged at rest.".to_owned(),
        }
    }

    /// What it came to, with the calibration itself.
    pub fn finish(self, source: &Measured<'_>) -> Result<(CalibrationResult, Calibration), String> {
        let plan = *self.procedure.plan();
        let part = self.procedure.part().clone();
        let mut outcomes = self.procedure.finish().map_err(|refusal| worded(&refusal))?;
        let average_s = plan.average_s.min(plan.offset_s);
        let first = part.axes.first();
        let tone = first.and_then(|first| {
            resonance::warning(&first.axis, source.rate_hz, source.info.edges_per_reading(), average_s)
        });
        outcomes.iter_mut().for_each(|outcome| outcome.warnings.extend(tone));
        let info = CaptureInfo { serial: self.serial.or_else(|| source.info.serial.clone()), ..source.info.clone() };
        let calibration = Calibration::new(&part, &outcomes, info.origin(self.hash.hex()));
        let axes = outcomes.iter().zip(&calibration.axes).enumerate();
        let result = CalibrationResult {
            method: self.method,
            entry: entry(&calibration, false),
            axes: axes.map(|(index, (outcome, axis))| source.axis(index, outcome, axis)).collect(),
            warnings: warnings(&outcomes),
        };
        Ok((result, calibration))
    }

    fn handle(&mut self, event: Event<'_, Scan>) -> Result<(), String> {
        self.procedure.handle(event).map_err(|refusal| worded(&refusal))
    }
}

/// What a calibration was measured with.
pub struct Measured<'a> {
    pub info: &'a CaptureInfo,
    pub rate_hz: f64,
    pub axes: &'a [AxisState],
    pub truths: &'a [Truth],
}

impl Measured<'_> {
    fn axis(&self, index: usize, outcome: &Outcome, axis: &CalibratedAxis) -> AxisResult {
        let truth = self.truths.get(index);
        let (low_c, high_c) = (outcome.temp_min_c, outcome.temp_max_c);
        let temps = (0..POINTS).map(|k| low_c + (high_c - low_c) * f64::from(k) / f64::from(POINTS - 1));
        let curve = temps.map(|temp_c| CurvePoint {
            temp_c,
            correction_dps: outcome.correction.at(temp_c),
            u_dps: axis.u_correction_dps(temp_c),
            truth_dps: truth.map(|truth| truth.pbc_dps(temp_c)),
        });
        let last = self.axes.get(index).and_then(AxisState::last_minute);
        AxisResult {
            name: axis.name.clone(),
            pbc_dps: outcome.correction.pbc_dps,
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            btc_dps_per_c: outcome.correction.btc_dps_per_c,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            t3_c: outcome.correction.t3_c,
            curve: curve.collect(),
            before_dps: last.map(|(rate_dps, _)| rate_dps),
            after_dps: last.map(|(rate_dps, temp_c)| outcome.correction.apply(rate_dps, temp_c)),
        }
    }
}

fn plan(wish: &CalibrateWish) -> Plan {
    let default = Plan::default();
    Plan {
        method: match wish.method {
            MethodName::An1042 => Method::An1042,
            MethodName::Warmup => Method::Warmup,
            MethodName::Cycle => Method::Cycle,
        },
        average_s: wish.average_s.unwrap_or(default.average_s),
        warmup_s: wish.warmup_s.unwrap_or(default.warmup_s),
        settle_s: wish.settle_s.unwrap_or(default.settle_s),
        offset_s: wish.offset_s.unwrap_or(default.offset_s),
        earth_dps: wish.earth_dps,
        ..default
    }
}

/// What the page calls a setting.
fn label(setting: Setting) -> &'static str {
    match setting {
        Setting::Average => "the two averages",
        Setting::WarmUp => "the warm-up",
        Setting::Settle => "settling",
        Setting::Offset => "the offset average",
        Setting::Earth => "the Earth's rotation",
        other => other.name(),
    }
}

fn worded(refusal: &AxisRefusal) -> String {
    refusal.with(label).to_string()
}

/// Each once, those of one axis with its name left out where there is but one.
fn warnings(outcomes: &[Outcome]) -> Vec<String> {
    let mut texts = Vec::new();
    for warning in outcomes.iter().flat_map(|outcome| &outcome.warnings) {
        let text = format!("{}: {}", warning.code(), warning.with(label));
        if !texts.contains(&text) {
            texts.push(text);
        }
    }
    texts
}
