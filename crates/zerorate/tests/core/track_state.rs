//! States that older versions of the program wrote can be read.

use zerorate::Calibration;
use zerorate::track::{Counts, TrackFile};

const UNIT: &str = "schema = 1\npart = \"ADIS16130\"\nserial = \"SN17\"\n\
                    [correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 33.0\n";

/// The program before schema 2 wrote this after ten minutes of `stream --track` with the calibration `UNIT`.
const STATE: &str = include_str!("track/schema-1.state");

#[test]
fn a_state_of_schema_1_has_seen_one_rest_and_one_rotation() {
    let (calibration, _) = Calibration::parse(UNIT).unwrap();
    let saved = TrackFile::parse(STATE).unwrap().of(&calibration, "rate").unwrap();
    assert_eq!((saved.rest_prior.rests, saved.rest_prior.rotations), (1.0, 1.0));
    assert_eq!(saved.counts, Counts { learned_s: 0, doubtful_s: 512, rolled_back: 1 });
    assert!((saved.filter.covariance[0] - 0.002_605_99).abs() < 1e-9);
}
