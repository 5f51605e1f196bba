//! Damaged logs of a part: reading never panics, and each row that it returns is valid. The harness of
//! `zerorate-record` says how to replay a failure.

#[path = "../../../zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../zerorate-record/src/fuzz/harness.rs"]
mod harness;

use super::{open, part};
use harness::edited;
use zerorate_logs::ColumnOptions;
use zerorate_record::Row;

/// Reads the log of a part, and checks that times increase and that every code of a rate is within its range.
fn read(bytes: &[u8]) {
    let Ok(log) = open(bytes, &part(), &ColumnOptions::default()) else { return };
    let rows: Vec<Row> = log.collect();
    assert!(rows.is_sorted_by(|one, next| one.t_ns < next.t_ns));
    let code = |code: &i64| (-32_768..=32_767).contains(code);
    assert!(rows.iter().all(|row| row.codes().len() == 3 && row.codes().iter().all(code)));
}

#[test]
fn rows_of_a_damaged_log_keep_their_order_and_range() {
    let texts = [
        "t_ms,x,y,z,temp\n0,1,-2,3,4\n10,5,,-7,8\n40,9,10,11,\n50,12,13,14,15\n",
        "time [s];x_dps;y [rad/s];z;temp_c\n0;0,05;0,0001;3;25,5\n0,01;-1,5;-0,002;4;26\n0,02;1;0;5;27\n",
    ];
    edited(1500, &texts.map(|text| text.as_bytes().to_vec()), read);
}
