//! The calibration of F-51, on fixed memory.

use crate::boundary::{self, Object};
use crate::correction::Correction;
use crate::gyro::Sample;
use crate::status::{
    self, Status, StatusNumber, ZERORATE_DONE, ZERORATE_E_NULL, ZERORATE_E_PLAN, ZERORATE_E_STATE,
    ZERORATE_INITIALISE, ZERORATE_SAMPLE,
};
use zerorate::{
    Action, Axis, Event, FixedProcedure, Measured, Outcome as CoreOutcome, Plan as CorePlan, Reading, Refusal, Remedy,
    State as CoreState, Warning, WindowWarnings,
};

/// A calibration in progress. The caller owns the memory, and the contents are private. Begin it with
/// zerorate_procedure_begin. It needs no tear-down.
#[repr(C)]
pub struct Procedure {
    /// Private.
    pub opaque: [u64; 512],
}

pub struct State {
    procedure: FixedProcedure,
    /// The refusal that ended the calibration early. Each later event, `next` and `outcome` return its status.
    refused: Option<Refusal>,
}

impl Object for Procedure {
    type State = State;
    const MARK: u32 = 0x7A72_7031;
}

/// Durations and limits of a calibration. Start from zerorate_plan_default, the procedure of AN-1042 (F-51).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Plan {
    /// Duration of each of the averages in steps 4 and 6, s. Default: 10.
    pub average_s: f64,
    /// Duration of the warm-up by self-heating in step 5, s. Default: 600.
    pub warmup_s: f64,
    /// Duration of the settling in step 7, s. Default: 2400.
    pub settle_s: f64,
    /// Duration of the average of the rate in step 8, s. Default: 150.
    pub offset_s: f64,
    /// Duration of the average of TEMP in step 9, s. Default: 1.
    pub final_temp_s: f64,
    /// Largest accepted share of lost samples in an average, 0 to 1. Default: 0.001.
    pub max_lost: f64,
    /// Largest accepted standard uncertainty of BTC, deg/s per deg C. Default: 0.01.
    pub max_u_btc_dps_per_c: f64,
    /// The component of the Earth's rotation on the part's axis, deg/s (not deg/h), from -0.00418 to 0.00418 (F-16).
    /// It is subtracted from the measured rate. NaN if it is not known.
    pub earth_dps: f64,
    /// 1 = assume a bias that is linear over temperature: the uncertainties allow for no curvature or hysteresis.
    pub assume_linear: u8,
}

/// The result of a calibration.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Outcome {
    /// PBC, BTC and T3.
    pub correction: Correction,
    /// Standard uncertainty of PBC, deg/s.
    pub u_pbc_dps: f64,
    /// Standard uncertainty of BTC, deg/s per deg C.
    pub u_btc_dps_per_c: f64,
    /// Standard uncertainty of T3 from the noise alone, deg C.
    pub u_t3_c: f64,
    /// Mean rate of step 4, deg/s.
    pub b1_dps: f64,
    /// Mean rate of step 6, deg/s.
    pub b2_dps: f64,
    /// Mean temperature of step 4, deg C.
    pub t1_c: f64,
    /// Mean temperature of step 6, deg C.
    pub t2_c: f64,
    /// Lowest temperature of the calibration, deg C.
    pub temp_min_c: f64,
    /// Highest temperature of the calibration, deg C.
    pub temp_max_c: f64,
    /// One-sided density of the white noise, deg/s per root Hz.
    pub white_dps_per_rt_hz: f64,
    /// Measured number of rate samples per second.
    pub rate_hz: f64,
    /// Number of rate samples read.
    pub samples: u64,
    /// Number of rate samples lost.
    pub lost: u64,
    /// Warnings about the numbers: a sum of ZERORATE_WARNING_...
    pub warnings: u32,
}

/// The Earth's rotation was not subtracted. PBC contains up to 0.00418 deg/s of it (F-16).
pub const ZERORATE_WARNING_EARTH_INCLUDED: u32 = 1;
/// Two temperatures show no curvature. The uncertainty of BTC allows for a typical curvature.
pub const ZERORATE_WARNING_CURVATURE_UNSEEN: u32 = 2;
/// The temperature changed between the average of the rate in step 8 and T3 in step 9.
pub const ZERORATE_WARNING_DRIFTING: u32 = 4;
/// PBC was averaged for less than half of the best averaging time.
pub const ZERORATE_WARNING_SHORT_AVERAGE: u32 = 8;
/// The rate was sampled at less than twice the bandwidth, so noise folds into the band.
pub const ZERORATE_WARNING_ALIASED: u32 = 16;
/// Samples were lost, but no more than `max_lost` allows.
pub const ZERORATE_WARNING_LOST: u32 = 32;
/// The bias wanders more than the typical flicker noise of the part.
pub const ZERORATE_WARNING_WANDERING: u32 = 64;
/// A warning for which this version of the interface has no number.
pub const ZERORATE_WARNING_OTHER: u32 = 128;
/// The Earth rotation `earth_dps` was subtracted. PBC contains any other constant rotation.
pub const ZERORATE_WARNING_EARTH_SUBTRACTED: u32 = 256;
/// BTC is close to zero. A wide hysteresis or a long lag would look the same.
pub const ZERORATE_WARNING_FLAT: u32 = 512;
/// Always set. Steps, lag, curvature, hysteresis and slow motion between the averages were not looked for. That takes
/// a record of every second, which does not fit into the memory of a controller. `zerorate recalibrate` looks at
/// recorded samples.
pub const ZERORATE_WARNING_HOUR_UNCHECKED: u32 = 1024;

impl Plan {
    fn new(plan: &CorePlan) -> Self {
        Self {
            average_s: plan.average_s,
            warmup_s: plan.warmup_s,
            settle_s: plan.settle_s,
            offset_s: plan.offset_s,
            final_temp_s: plan.final_temp_s,
            max_lost: plan.max_lost,
            max_u_btc_dps_per_c: plan.max_u_btc_dps_per_c,
            earth_dps: plan.earth_dps.unwrap_or(f64::NAN),
            assume_linear: plan.assume_linear.into(),
        }
    }

    fn to_core(self) -> CorePlan {
        CorePlan {
            average_s: self.average_s,
            warmup_s: self.warmup_s,
            settle_s: self.settle_s,
            offset_s: self.offset_s,
            final_temp_s: self.final_temp_s,
            max_lost: self.max_lost,
            max_u_btc_dps_per_c: self.max_u_btc_dps_per_c,
            earth_dps: (!self.earth_dps.is_nan()).then_some(self.earth_dps),
            assume_linear: self.assume_linear != 0,
            ..CorePlan::default()
        }
    }
}

impl Outcome {
    fn new(outcome: &CoreOutcome<WindowWarnings>) -> Self {
        // the procedure on fixed memory is that of AN-1042, which always has these means
        const NONE: Measured = Measured { b1_dps: f64::NAN, t1_c: f64::NAN, b2_dps: f64::NAN, t2_c: f64::NAN };
        let means = outcome.means.unwrap_or(NONE);
        Self {
            correction: Correction::from_core(outcome.correction),
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            u_t3_c: outcome.uncertainty.u_t3_c,
            b1_dps: means.b1_dps,
            b2_dps: means.b2_dps,
            t1_c: means.t1_c,
            t2_c: means.t2_c,
            temp_min_c: outcome.temp_min_c,
            temp_max_c: outcome.temp_max_c,
            white_dps_per_rt_hz: outcome.noise.model.white_dps_per_rt_hz,
            rate_hz: outcome.rate_hz,
            samples: outcome.samples,
            lost: outcome.lost_samples,
            warnings: outcome.warnings.iter().map(flag).fold(0, |all, flag| all | flag),
        }
    }
}

fn flag(warning: &Warning) -> u32 {
    match warning {
        Warning::EarthIncluded => ZERORATE_WARNING_EARTH_INCLUDED,
        Warning::CurvatureUnseen { .. } => ZERORATE_WARNING_CURVATURE_UNSEEN,
        Warning::Drifting { .. } => ZERORATE_WARNING_DRIFTING,
        Warning::ShortAverage { .. } => ZERORATE_WARNING_SHORT_AVERAGE,
        Warning::Aliased { .. } => ZERORATE_WARNING_ALIASED,
        Warning::Lost { .. } => ZERORATE_WARNING_LOST,
        Warning::Wandering { .. } => ZERORATE_WARNING_WANDERING,
        Warning::EarthSubtracted { .. } => ZERORATE_WARNING_EARTH_SUBTRACTED,
        Warning::Flat { .. } => ZERORATE_WARNING_FLAT,
        Warning::HourUnchecked => ZERORATE_WARNING_HOUR_UNCHECKED,
        _ => ZERORATE_WARNING_OTHER,
    }
}

impl State {
    fn handle(&mut self, event: Event<'_>) -> Result<(), Status> {
        if let Some(refused) = &self.refused {
            return Err(refused.status());
        }
        self.procedure.handle(event).map_err(|refusal| self.refused.insert(refusal).status())
    }
}

/// Writes the durations of AN-1042 and the default limits. `earth_dps` is NaN, and `assume_linear` is 0.
///
/// # Safety
/// `plan` is null or points to writable memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_plan_default(plan: *mut Plan) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::output(plan, Plan::new(&CorePlan::default())) })
}

/// Begins a calibration. Returns ZERORATE_E_PLAN if a duration or limit of the plan is not valid.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the procedure during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_begin(procedure: *mut Procedure, plan: *const Plan) -> Status {
    // SAFETY: by the contract.
    let begun = unsafe { boundary::input(plan) }.and_then(|plan| {
        FixedProcedure::on_fixed_memory(&Axis::ADIS16130, plan.to_core()).map_err(|_| ZERORATE_E_PLAN)
    });
    // SAFETY: by the contract.
    status::of(
        begun.and_then(|begun| unsafe { boundary::set_up(procedure, State { procedure: begun, refused: None }) }),
    )
}

/// Returns what to do next: ZERORATE_INITIALISE, ZERORATE_SAMPLE, ZERORATE_DONE, or the negative status of a refusal.
///
/// # Safety
/// `procedure` is null or points to a procedure that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_next(procedure: *mut Procedure) -> Status {
    // SAFETY: by the contract.
    match unsafe { boundary::state(procedure) } {
        Ok(State { refused: Some(refused), .. }) => refused.status(),
        Ok(State { procedure, .. }) => match procedure.next() {
            Action::Initialise => ZERORATE_INITIALISE,
            Action::Read => ZERORATE_SAMPLE,
            Action::Done => ZERORATE_DONE,
        },
        Err(status) => status,
    }
}

/// Returns a remedy for the refusal that ended the calibration, a ZERORATE_REMEDY_.... The remedy with index 0 is the
/// best one. Returns 0 if nothing was refused, or if no remedy has this index.
///
/// # Safety
/// `procedure` is null or points to a procedure that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_remedy(procedure: *mut Procedure, index: usize) -> u8 {
    // SAFETY: by the contract.
    let refused = unsafe { boundary::state(procedure) }.ok().and_then(|state| state.refused);
    refused.and_then(|refusal| refusal.remedies().get(index).copied()).map_or(0, Remedy::code)
}

/// Tells the procedure that the part was initialised at the time `t_ns`, ns, by the clock of the samples. This
/// function and the next two return the status of the refusal if the calibration is refused.
///
/// # Safety
/// `procedure` is null or points to a procedure that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_initialised(procedure: *mut Procedure, t_ns: u64) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(procedure) }.and_then(|state| state.handle(Event::Initialised { t_ns })))
}

/// Passes a sample to the procedure. At the end of a step the call takes some thousand floating-point operations,
/// otherwise about a hundred integer operations.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the procedure during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_sample(procedure: *mut Procedure, sample: *const Sample) -> Status {
    // SAFETY: by the contract.
    let sample = unsafe { boundary::input(sample) }.and_then(|sample| sample.to_driver());
    // SAFETY: by the contract.
    let state = unsafe { boundary::state(procedure) };
    status::of(state.and_then(|state| state.handle(Event::Reading(&Reading::from(&sample?)))))
}

/// Tells the procedure that no sample came up to the time `t_ns`, ns, by the clock of the samples.
///
/// # Safety
/// `procedure` is null or points to a procedure that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_time(procedure: *mut Procedure, t_ns: u64) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(procedure) }.and_then(|state| state.handle(Event::Time { t_ns })))
}

/// Returns the step of AN-1042, 3 (initialise) to 9 (final temperature), or 10 at the end. Negative for an error.
///
/// # Safety
/// `procedure` is null or points to a procedure that nothing else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_step(procedure: *mut Procedure) -> Status {
    // SAFETY: by the contract.
    match unsafe { boundary::state(procedure) } {
        Ok(state) => match state.procedure.progress().state {
            CoreState::Start => 3,
            CoreState::FirstAverage => 4,
            CoreState::WarmUp => 5,
            CoreState::SecondAverage => 6,
            CoreState::Settle => 7,
            CoreState::Offset => 8,
            CoreState::FinalTemperature => 9,
            CoreState::Recording => 11,
            CoreState::Done => 10,
        },
        Err(status) => status,
    }
}

/// Writes the time since the initialisation to `elapsed_s` and the duration of the procedure to `total_s`, both in s.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the procedure during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_progress(
    procedure: *mut Procedure,
    elapsed_s: *mut f64,
    total_s: *mut f64,
) -> Status {
    // SAFETY: by the contract.
    let state = unsafe { boundary::state(procedure) };
    status::of(state.and_then(|state| {
        let progress = state.procedure.progress();
        if total_s.is_null() {
            return Err(ZERORATE_E_NULL);
        }
        // SAFETY: by the contract.
        unsafe { boundary::output(elapsed_s, progress.elapsed_s) }?;
        // SAFETY: by the contract.
        unsafe { boundary::output(total_s, progress.total_s) }
    }))
}

/// Writes the result, once zerorate_procedure_next returns ZERORATE_DONE. Returns ZERORATE_E_STATE before that, or the
/// status of the refusal that ended the calibration.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the procedure during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_procedure_outcome(procedure: *mut Procedure, outcome: *mut Outcome) -> Status {
    // SAFETY: by the contract.
    let state = unsafe { boundary::state(procedure) };
    status::of(state.and_then(|State { procedure, refused }| {
        if let Some(refused) = refused {
            return Err(refused.status());
        }
        if procedure.next() != Action::Done {
            return Err(ZERORATE_E_STATE);
        }
        let core = procedure.outcome().map_err(|refusal| refusal.status())?;
        // SAFETY: by the contract.
        unsafe { boundary::output(outcome, Outcome::new(&core)) }
    }))
}
