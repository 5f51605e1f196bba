//! What the user says of the axes of an IMU, and which N and K the file of a filter has.

use super::imu::{LINE, bench};

/// N and K cover the curve, unless they are asked for as they were fitted. The file says which.
#[test]
fn the_file_says_by_which_rule_n_and_k_were_made() {
    let bench = bench();
    for (options, said) in [
        ("--as-fitted", "N and K are as they were fitted (--as-fitted)"),
        ("--horizon 20", "covers the curve up to 20 s; fitted: "),
        ("--combine worst", "--as-fitted gives N and K"),
    ] {
        bench.zerorate(&format!("{LINE} {options} -o imu.yaml --force")).ok();
        let yaml = std::fs::read_to_string(bench.path("imu.yaml")).unwrap();
        assert!(yaml.contains(said), "{options}: {yaml}");
    }
    bench.zerorate(&format!("{LINE} --horizon 0.5")).fails(2);
    bench.zerorate(&format!("{LINE} --horizon 20 --as-fitted")).fails(2);
}

#[test]
fn columns_without_names_are_axes_by_number() {
    let bench = bench();
    let log = std::fs::read_to_string(bench.path("imu.csv")).unwrap();
    let (_, rows) = log.split_once('\n').unwrap();
    bench.write("plain.csv", format!("t_s,c1,c2,c3,c4,c5,c6,c7,c8\n{rows}"));
    let units = "--gyro-unit dps --accel-unit m/s^2";
    let said = bench.zerorate(&format!("imu plain.csv {units}")).fails(2);
    assert!(said.contains("Say which are axes with --gyro and --accel"), "{said}");
    let run = bench.zerorate(&format!("imu plain.csv --gyro 1,2,c3 --accel 4,5,6 {units} --json"));
    let report = run.ended_with(0).json();
    let kinds: Vec<_> = report["axes"].as_array().unwrap().iter().map(|axis| axis["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, [["gyroscope"; 3], ["accelerometer"; 3]].concat());
    let wrong = bench.zerorate("imu imu.csv --gyro 4").fails(2);
    assert!(wrong.contains("is in m/s², which is no unit of gyroscopes"), "{wrong}");
    bench.zerorate("imu imu.csv --gyro 1 --column 2").fails(2);
}
