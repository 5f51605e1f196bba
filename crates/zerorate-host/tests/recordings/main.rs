//! A part file suffices to read a log of a gyroscope with three axes as rows of a capture.

mod captures;
mod damaged;
#[cfg(feature = "full")]
mod real;

use std::path::Path;
use zerorate::Part;
use zerorate_host::PartLog;
use zerorate_logs::ColumnOptions;
use zerorate_record::Row;

/// A part file with the scales of the data sheet. The reference recordings have no temperature, so the tests invent
/// one.
const ADIS16405: &str = r#"
    schema = 1
    name = "ADIS16405"
    axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
    rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, signed = true }
    temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12, signed = true }
"#;

fn part() -> Part {
    Part::parse(ADIS16405).unwrap()
}

fn open(content: impl AsRef<[u8]>, part: &Part, args: &ColumnOptions) -> zerorate_logs::Result<PartLog> {
    PartLog::open(Path::new("log"), content.as_ref().to_vec().into(), part, args)
}

fn rows(content: impl AsRef<[u8]>) -> Vec<Row> {
    open(content, &part(), &ColumnOptions::default()).unwrap().collect()
}

#[track_caller]
fn fails(content: impl AsRef<[u8]>, reason: &str) {
    let error = open(content, &part(), &ColumnOptions::default()).unwrap_err().to_string();
    assert!(error.contains(reason), "{error}");
}

#[test]
fn codes_times_and_losses_become_rows() {
    let found = rows("t_ms,temp,z,x,y\n100,5,3,1,-2\n110,,6,4,-5\n140,7,9,7,-8\n150,8,,0,0\n160,9,12,10,-11\n");
    let row = |t_ms: u64, seq, codes: &[i64]| Row::new(t_ms * 1_000_000, seq, codes).unwrap();
    let expected = [
        row(100, 0, &[1, -2, 3]).with_temp_code(Some(5)),
        row(110, 1, &[4, -5, 6]),
        // the rows of 120 and 130 ms are missing; the row of 150 ms lacks an axis
        row(140, 4, &[7, -8, 9]).with_temp_code(Some(7)).with_lost(2),
        row(160, 6, &[10, -11, 12]).with_temp_code(Some(9)).with_lost(1),
    ];
    assert_eq!(found, expected);
    let log = open("t_ms,temp,z,x,y\n0,5,3,1,-2\n10,5,nan,1,2\n20,5,1,1,2\n", &part(), &ColumnOptions::default());
    let log = log.unwrap();
    let (code, text) = (log.warnings()[0].code(), log.warnings()[0].to_string());
    assert_eq!(code, "rows-incomplete");
    assert!(text.contains("1 of 3 rows lack the value of an axis; they count as lost"), "{text}");
}

#[test]
fn a_rate_replaces_the_times() {
    let options = ColumnOptions { rate: Some(3.0), ..ColumnOptions::default() };
    let found: Vec<u64> =
        open("x,y,z,temp\n1,2,3,4\n1,2,3,4\n1,2,3,4\n", &part(), &options).unwrap().map(|row| row.t_ns).collect();
    assert_eq!(found, [0, 333_333_333, 666_666_667]);
}

#[test]
fn values_become_codes() {
    let log = |text: &str| open(text, &part(), &ColumnOptions::default()).unwrap();
    let exact =
        log("t_s,x_dps,y [deg/h],z (rad/s),temp_c\n0,0.05,180,0.0008726646,25\n1,-1.5,-360,0.0017453293,25.14006\n");
    assert_eq!(exact.warnings(), []);
    let codes: Vec<Vec<i64>> = exact.map(|row| [row.codes(), &[row.temp_code.unwrap()]].concat()).collect();
    assert_eq!(codes, [[1, 1, 1, 0], [-30, -2, 2, 1]]);
    let rounded = log("t_s,x_dps,y,z,temp\n0,0.07,0,0,0\n1,0.049,0,0,0\n");
    let said = &rounded.warnings()[0].coded();
    assert!(said.contains("column x_dps") && said.contains("by up to 2.0e-2 °/s (0.40 codes)"), "{said}");
    assert_eq!(rounded.map(|row| row.codes()[0]).collect::<Vec<_>>(), [1, 1]);
}

#[test]
fn columns_may_have_other_names() {
    let text = ADIS16405
        .replace("{ name = \"x\" }", "{ name = \"x\", column = \"gx [rad/s]\" }")
        .replace("zero_c = 25", "zero_c = 25, column = \"T (°C)\"");
    let (part, options) = (Part::parse(&text).unwrap(), ColumnOptions::default());
    let log = open("T (°C);x;gx [rad/s];y;z;stamp [us]\n25;9;0.0;1;2;0\n25;9;0.1;1;2;500\n", &part, &options).unwrap();
    assert_eq!(log.map(|row| (row.t_ns, row.codes()[0])).collect::<Vec<_>>(), [(0, 0), (500_000, 115)]);
    let error = open("temp,x,y,z,t_s\n1,2,3,4,0\n1,2,3,4,1\n", &part, &options).unwrap_err().to_string();
    assert!(error.contains("has no column `gx [rad/s]` for the axis x") && error.contains("column = "), "{error}");
}

#[test]
fn hostile_logs_are_refused_with_the_place() {
    fails("t_s,x,y,temp\n0,1,2,3\n1,1,2,3\n", "has no column `z` for the axis z");
    fails("t_s,x,y,z\n0,1,2,3\n1,1,2,3\n", "has no column `temp` for the temperature");
    fails("t_s,x,y,z_code,z_dps,temp\n0,1,2,3,4,5\n", "several columns that may be the axis z");
    fails("t_s,x,y,z,temp\n0,1,2,3,\n1,1,2,3,nan\n", "no temperature in any row");
    fails("t_s,x,y,z,temp\n0,1,2,nan,1\n1,1,,3,2\n", "no row with all axes");
    fails("t_s,x,y,z,temp\n0,1,2,3,4\n2,1,2,3,4\n1,1,2,3,4\n", "the time goes back");
    fails("t_s,x,y,z,temp\n0,1,2,32768,4\n1,1,2,3,4\n", "column z, row 0: 32768 is beyond the codes of the part");
    fails("t_s,x,y,z_dps,temp\n0,1,2,2000,4\n1,1,2,3,4\n", "16 bits and go from -32768 to 32767");
    fails("t_s,x,y,z,temp\n0,1,2,3,2048\n1,1,2,3,4\n", "column temp, row 0: 2048 is beyond");
    fails("t_s,x,y,z,temp\n0,1,2,0.5,4\n1,1,2,3,4\n", "column z, row 0: 0.5 is not a code, and no unit is stated");
    fails("t_s,x,y,z,temp\n0,1,2,inf,4\n1,1,2,3,4\n", "infinite");
    fails("x,y,z,temp\n1,2,3,4\n1,2,3,4\n", "does not say how fast it was sampled");
    fails("t,x,y,z,temp\n1,1,2,3,4\n2,1,2,3,4\n", "does not say how fast it was sampled");
    fails("", "empty");
    let built_in = open("t_s,rate,temp\n0,1,2\n1,1,2\n", &Part::ADIS16130, &ColumnOptions::default());
    assert!(built_in.unwrap_err().to_string().contains("is built in"));
}
