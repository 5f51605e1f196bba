//! Tracks the bias: learns it whenever the part is at rest.

use crate::boundary::{self, Object};
use crate::correction::Correction;
use crate::status::{self, Status, ZERORATE_E_ARGUMENT};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use zerorate::Axis;
use zerorate::track::{COVARIANCES, Counts, Filter, Phase, Prior, RestPrior, STATES, Saved, TrackerConfig};

/// Tracks the bias: learns it whenever the part is at rest. The caller owns the memory, and the contents are private.
/// Begin it with zerorate_tracker_begin or zerorate_tracker_resume. It needs no tear-down.
#[repr(C)]
pub struct Tracker {
    /// Private.
    pub opaque: [u64; 304],
}

impl Object for Tracker {
    type State = zerorate::track::Tracker;
    const MARK: u32 = 0x7A72_7431;
}

/// The uncertainties of the calibration, from `uncertainty` in the calibration file, and the noise of the part.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TrackerPrior {
    /// Standard uncertainty of PBC, deg/s.
    pub u_pbc_dps: f64,
    /// Standard uncertainty of BTC, deg/s per deg C.
    pub u_btc_dps_per_c: f64,
    /// Covariance of PBC and BTC, (deg/s)^2 per deg C.
    pub cov_pbc_btc: f64,
    /// One-sided white noise density, deg/s per root Hz: `noise` of the calibration file, typically 0.0125 (F-02).
    pub white_dps_per_rt_hz: f64,
}

/// The learned bias in plain numbers. Store it while the power is off.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TrackerState {
    /// Bias: offset (deg/s), slope (deg/s per deg C), curvature (deg/s per (deg C)^2), three flicker states (deg/s).
    pub state: [f32; 6],
    /// Lower triangle of the covariance of `state`, row by row.
    pub covariance: [f32; 21],
    /// T - T3 at the last mean from which the tracker learned, deg C.
    pub at_c: f32,
    /// Number of rests and number of rotations among the quiet periods, each plus one. Old periods fade out.
    pub odds: [f32; 2],
    /// Seconds of rest from which the tracker learned, quiet seconds that may be a slow rotation, and number of times
    /// that a rotation began within a rest.
    pub counts: [u32; 3],
    /// CRC-32 of all fields above, in which zerorate_tracker_resume finds damage.
    pub check: u32,
}

impl TrackerState {
    fn crc(&self) -> u32 {
        let Self { state, covariance, at_c, odds, counts, check: _ } = self;
        let numbers = state.iter().chain(covariance).chain([at_c]).chain(odds);
        let mut digest = CRC.digest();
        numbers.map(|number| number.to_bits()).chain(*counts).for_each(|word| digest.update(&word.to_le_bytes()));
        digest.finalize()
    }
}

/// Without a table, which would take a kilobyte of a small controller's flash.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

const _: () = assert!(STATES == 6 && COVARIANCES == 21);

/// The present estimate of the bias.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Tracked {
    /// The bias beyond the correction, deg/s: subtract it from corrected rates.
    pub change_dps: f64,
    /// Standard uncertainty of `change_dps`, deg/s.
    pub u_dps: f64,
    /// Motion of the part: 0 = moving, 1 = quiet, 2 = at rest, bias learned, 3 = quiet, but perhaps slowly rotating.
    pub phase: u8,
}

impl TrackerPrior {
    /// Whether the uncertainties can belong to one calibration: of NaN none is.
    fn is_possible(&self) -> bool {
        let &Self { u_pbc_dps, u_btc_dps_per_c, cov_pbc_btc, white_dps_per_rt_hz } = self;
        // of the rounded numbers of a calibration file, the correlation may exceed 1 by a little
        let most = 1.001 * u_pbc_dps * u_btc_dps_per_c;
        let is_positive = u_pbc_dps >= 0.0 && u_btc_dps_per_c >= 0.0 && white_dps_per_rt_hz > 0.0;
        is_positive && most.is_finite() && white_dps_per_rt_hz.is_finite() && cov_pbc_btc.abs() <= most
    }
}

fn config(correction: &Correction, prior: &TrackerPrior) -> Result<TrackerConfig, Status> {
    if !prior.is_possible() {
        return Err(ZERORATE_E_ARGUMENT);
    }
    const ADIS16130: Axis = Axis::ADIS16130;
    let u_curvature_dps_per_c2 = ADIS16130.bias.curvature_dps_per_c2.unwrap_or(0.0);
    let known = Prior {
        u_pbc_dps: prior.u_pbc_dps,
        u_btc_dps_per_c: prior.u_btc_dps_per_c,
        cov_pbc_btc_dps2_per_c: prior.cov_pbc_btc,
        u_curvature_dps_per_c2,
    };
    let mut config = TrackerConfig::of(&ADIS16130, correction.checked()?, known);
    config.noise.white_dps_per_rt_hz = prior.white_dps_per_rt_hz;
    Ok(config)
}

/// Begins from the calibration, which was made `age_s` seconds ago. Returns ZERORATE_E_ARGUMENT if `prior` is not
/// possible, or `age_s` is negative or not finite, and ZERORATE_E_COEFFICIENT if a coefficient is not finite.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_tracker_begin(
    tracker: *mut Tracker,
    correction: *const Correction,
    prior: *const TrackerPrior,
    age_s: f64,
) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(correction) }.and_then(|correction| {
        // SAFETY: by the contract.
        let config = config(correction, unsafe { boundary::input(prior) }?)?;
        if !(age_s >= 0.0 && age_s.is_finite()) {
            return Err(ZERORATE_E_ARGUMENT);
        }
        let begun = zerorate::track::Tracker::new(config).aged(age_s);
        // SAFETY: by the contract.
        unsafe { boundary::set_up(tracker, begun) }
    }))
}

/// Begins from the saved state, after `off_s` seconds without power. Returns ZERORATE_E_ARGUMENT if the state is
/// damaged, it or `prior` is not possible, or `off_s` is negative or not finite.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_tracker_resume(
    tracker: *mut Tracker,
    correction: *const Correction,
    prior: *const TrackerPrior,
    state: *const TrackerState,
    off_s: f64,
) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(correction) }.and_then(|correction| {
        // SAFETY: by the contract.
        let config = config(correction, unsafe { boundary::input(prior) }?)?;
        // SAFETY: by the contract.
        let kept = unsafe { boundary::input(state) }?;
        let &TrackerState { state, covariance, at_c, odds: [rests, rotations], counts, check } = kept;
        if check != kept.crc() {
            return Err(ZERORATE_E_ARGUMENT);
        }
        let [learned_s, doubtful_s, rolled_back] = counts;
        let filter = Filter { state, covariance, at_c };
        let counts = Counts { learned_s, doubtful_s, rolled_back };
        let saved = Saved { filter, rest_prior: RestPrior { rests, rotations }, counts };
        let resumed = zerorate::track::Tracker::resume(config, &saved, off_s).map_err(|_| ZERORATE_E_ARGUMENT)?;
        // SAFETY: by the contract.
        unsafe { boundary::set_up(tracker, resumed) }
    }))
}

/// Passes the mean rate, deg/s, and the mean temperature, deg C, of the next 0.1 s. The rate is the one that was read,
/// not a corrected one. Pass NaN for a missing mean. Refuses infinite numbers with ZERORATE_E_ARGUMENT.
///
/// # Safety
/// `tracker` is null or points to a tracker.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_tracker_push(tracker: *mut Tracker, rate_dps: f64, temp_c: f64) -> Status {
    if rate_dps.is_infinite() || temp_c.is_infinite() {
        return ZERORATE_E_ARGUMENT;
    }
    let known = |value: f64| Some(value).filter(|value| !value.is_nan());
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(tracker) }.map(|tracker| {
        tracker.push(known(rate_dps), known(temp_c), true);
    }))
}

/// Writes the bias at the temperature `temp_c`, deg C. Returns ZERORATE_E_ARGUMENT if that is not finite.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_tracker_bias(tracker: *mut Tracker, temp_c: f64, tracked: *mut Tracked) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(tracker) }.and_then(|tracker| {
        if !temp_c.is_finite() {
            return Err(ZERORATE_E_ARGUMENT);
        }
        let zerorate::track::Tracked { change_dps, u_dps, phase } = tracker.tracked(temp_c);
        let phase = match phase {
            Phase::Moving => 0,
            Phase::Quiet => 1,
            Phase::Rest => 2,
            Phase::Doubtful => 3,
        };
        // SAFETY: by the contract.
        unsafe { boundary::output(tracked, Tracked { change_dps, u_dps, phase }) }
    }))
}

/// Writes the state to keep while the power is off.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_tracker_save(tracker: *mut Tracker, state: *mut TrackerState) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::state(tracker) }.and_then(|tracker| {
        let Saved { filter: Filter { state: numbers, covariance, at_c }, rest_prior, counts } = tracker.save();
        let odds = [rest_prior.rests, rest_prior.rotations];
        let counts = [counts.learned_s, counts.doubtful_s, counts.rolled_back];
        let mut kept = TrackerState { state: numbers, covariance, at_c, odds, counts, check: 0 };
        kept.check = kept.crc();
        // SAFETY: by the contract.
        unsafe { boundary::output(state, kept) }
    }))
}
