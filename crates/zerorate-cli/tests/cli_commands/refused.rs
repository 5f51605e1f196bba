//! Requests that cannot be met. The error gives the reason, no data are printed, and no file is left.

use crate::harness::{Bench, calibration};

/// Makes a folder with a calibration of a part without a serial number, a log, and a file of unknown content.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(0.1, 0.01, 25.0));
    bench.write("log.csv", "t_s,gz_dps\n0.00,0.1\n0.01,0.2\n0.02,0.1\n0.03,0.3\n");
    bench.write("noise.bin", [0x5a; 100]);
    bench
}

#[track_caller]
fn refused(cases: &[(&str, i32, &str)]) {
    let bench = bench();
    let before = bench.names();
    for (line, code, why) in cases {
        bench.zerorate(line).fails(*code, &[why]);
    }
    assert_eq!(bench.names(), before, "a file is left");
}

#[test]
fn requests_about_an_analysis_are_refused() {
    refused(&[
        ("allan log.csv --column gz_dps --fit --max-freq abc", 2, "must be a frequency above 0, in Hz"),
        ("allan log.csv --column gz_dps --fit --max-freq -1", 2, "must be a frequency above 0, in Hz"),
        ("allan log.csv --column gz_dps --data phase --detrend temp", 2, "--detrend works on a rate"),
        ("allan log.csv --column gz_dps --detrend gx", 2, "must be temp, temp:2 or temp:3"),
        ("allan log.csv --column gz_dps --confidence 1", 2, "below 1"),
        ("allan log.csv --column gz_dps --plot plot.jpg", 2, ".svg or .png"),
        ("imu log.csv --horizon -1", 2, "must be more than 1, in seconds"),
        ("imu log.csv --datasheet nosuch", 1, "`zerorate parts` lists those"),
    ]);
}

#[test]
fn requests_about_a_calibrated_rate_are_refused() {
    let stream = "stream --cal unit.toml --device twin:seed=4";
    refused(&[
        (&format!("{stream} --serial A7"), 1, "a part without a serial number, not of part A7"),
        (&format!("{stream} --track --least-turn-dps 0"), 2, "between 0.000001 and 100"),
        (&format!("{stream} --track --power-up-dps 1000"), 2, "--power-up-dps is 1000"),
        ("chamber f57 --device twin: --earth-dps 5", 2, "-0.00418 to 0.00418"),
        ("report unit.toml -o unit.pdf", 2, "zerorate writes no PDF"),
    ]);
}

#[cfg(feature = "serve")]
#[test]
fn requests_about_a_server_are_refused() {
    refused(&[
        ("serve --device twin: --listen 192.0.2.1:8080", 1, "this machine has another address"),
        ("serve --device twin: --listen 127.0.0.1:0 --folder noise.bin", 1, "--folder noise.bin: it is a file"),
    ]);
}
