//! No command destroys its inputs or existing files, under any name.

use super::{Bench, Run, SHORT, calibration, capture};
use std::fs;
use std::path::{Path, PathBuf};

const ROWS: &str = "1000,1,8623488,8,8402701,0\n2000,2,8388608,8,,0\n3000,5,8153728,,8388608,1\n";
const LOG: &str = "gz\n1\n2\n1\n3\n2\n1\n2\n3\n";

/// A part of one axis, with the names of its columns in logs.
const PART: &str = r#"schema = 1
name = "G1"
axis = [{ name = "z", column = "gz_dps" }]
[rate]
lsb_per_dps = 1000
zero_code = 0
width_bits = 24
[temperature]
lsb_per_c = 100
zero_code = 0
zero_c = 25
width_bits = 16
column = "temp_c"
"#;
const SHEET: &str = "schema = 1\nname = \"G1\"\nsource = \"its maker\"\n[gyroscope]\nnoise_density = { \
    typical = 0.05, unit = \"°/s/√Hz\" }\n";
const PLAN: &str = "schema = 1\nname = \"up\"\n[[step]]\nto_c = 25\n[[step]]\nto_c = 40\nc_per_min = 2\n\
    [[step]]\nto_c = 25\nc_per_min = 2\n";

/// Makes a folder with a calibration, two captures, two logs, a part, a data sheet and a plan.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", ROWS));
    bench.write("log.csv", LOG);
    bench.write("part.toml", PART);
    bench.write("sheet.toml", SHEET);
    bench.write("plan.toml", PLAN);
    let rows: String = (0..400).map(|k| format!("{}.{},0.{},25.1\n", k / 10, k % 10, 1 + k * 7 % 9)).collect();
    bench.write("part.csv", format!("t_s,gz_dps,temp_c\n{rows}"));
    bench.zerorate("correct rest.csv --cal unit.toml -o corrected.csv").ok();
    bench
}

fn content(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        entries.filter(|path| path.is_file()).map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    files.sort();
    files
}

/// Checks that the run ends with 2 and this reason, and that no file was changed or added.
#[track_caller]
fn refused(bench: &Bench, line: &str, reason: &str) {
    let before = content(bench.dir.path());
    bench.zerorate(line).fails(2, &[reason]);
    assert_eq!(content(bench.dir.path()), before, "zerorate {line} changed a file");
}

/// Commands with an output, written as `OUT`, and the inputs that each command reads. The recordings are too short for
/// the calibrations, but a wrong output must be refused before that is noticed.
fn commands() -> Vec<(String, &'static [&'static str])> {
    let line = |line: &str| line.to_owned();
    vec![
        (line("capture --device replay:rest.csv -o OUT"), &["rest.csv"]),
        (format!("calibrate --device replay:rest.csv {SHORT} -o OUT"), &["rest.csv"]),
        (format!("calibrate --device replay:rest.csv {SHORT} --log OUT"), &["rest.csv"]),
        (format!("recalibrate rest.csv {SHORT} -o OUT"), &["rest.csv"]),
        (line("correct rest.csv --cal unit.toml -o OUT"), &["rest.csv", "unit.toml"]),
        (line("correct rest.csv --cal unit.toml --part adis16130 -o OUT"), &["rest.csv", "unit.toml"]),
        (line("capture --device replay:part.csv --part part.toml -o OUT"), &["part.csv", "part.toml"]),
        (format!("calibrate --device replay:part.csv --part part.toml {SHORT} -o OUT"), &["part.csv", "part.toml"]),
        (format!("calibrate --device replay:part.csv --part part.toml {SHORT} --log OUT"), &["part.csv", "part.toml"]),
        (format!("recalibrate rest.csv --part part.toml {SHORT} -o OUT"), &["rest.csv", "part.toml"]),
        (line("chamber plan.toml --device replay:rest.csv -o OUT"), &["rest.csv", "plan.toml"]),
        (line("chamber plan.toml --device replay:rest.csv --report OUT"), &["rest.csv", "plan.toml"]),
        (line("chamber plan.toml --device twin:seed=1 --log OUT"), &["plan.toml"]),
        (line("imu part.csv --gyro-unit dps --datasheet sheet.toml --report OUT"), &["part.csv", "sheet.toml"]),
        (line("imu part.csv --gyro-unit dps --datasheet sheet.toml --format ros -o OUT"), &["part.csv", "sheet.toml"]),
        (line("export unit.toml --format c -o OUT"), &["unit.toml"]),
        (line("report unit.toml -o OUT"), &["unit.toml"]),
        (line("allan log.csv --rate 10 --unit dps --report OUT"), &["log.csv"]),
        (line("allan log.csv --rate 10 --unit dps --imu-yaml OUT"), &["log.csv"]),
    ]
}

/// True if `OUT` is a capture, whose extension states its form.
fn records(command: &str) -> bool {
    command.contains("--log OUT") || command.starts_with("capture") || command.starts_with("correct")
}

/// The tests of `zerorate-jobs` cover links and other names of a file, and captures that only captures may replace.
#[test]
fn no_input_of_a_command_is_its_output() {
    let bench = bench();
    for (command, inputs) in commands() {
        for input in inputs {
            let name = format!("./{input}");
            let has_form = command.contains("--format") || !records(&command);
            let is_named = has_form || !name.ends_with(".toml");
            let reason = if is_named { "same file as the input" } else { "has no ending of a capture" };
            refused(&bench, &(command.replace("OUT", &name) + " --force"), reason);
        }
    }
}

#[cfg(unix)]
#[test]
fn no_input_of_a_command_is_its_stdout() {
    let bench = bench();
    let before = content(bench.dir.path());
    for (line, input) in [("export unit.toml --format csv", "unit.toml"), ("allan log.csv --rate 10 --csv", "log.csv")]
    {
        let appending = fs::OpenOptions::new().append(true).open(bench.path(input)).unwrap();
        let run = Run::of(bench.command(line).stdout(appending));
        assert_eq!(run.code, Some(2), "{line} >> {input}");
    }
    assert_eq!(content(bench.dir.path()), before);
}

#[test]
fn only_force_overwrites_a_file() {
    let bench = bench();
    bench.write("mine", "mine");
    for (command, _) in commands() {
        refused(&bench, &command.replace("OUT", "mine"), "--force");
    }
    bench.write("mine.svg", "mine");
    refused(&bench, "allan log.csv --rate 10 --plot mine.svg", "--force");
    refused(&bench, "capture --samples 10 -o mine", "--force");
    for command in
        ["export unit.toml --format csv -o mine", "report unit.toml -o mine", "capture --samples 10 -o mine"]
    {
        bench.write("mine", "mine");
        bench.zerorate(&format!("{command} --force")).ok();
        assert_ne!(fs::read(bench.path("mine")).unwrap(), b"mine", "{command} --force");
    }
}

/// A name with a text extension must not hide a binary file.
#[test]
fn an_unknown_ending_is_not_a_form() {
    let bench = bench();
    let why = "x.txt has no ending of a capture: name it .arrows, .parquet or .csv";
    for command in ["capture --samples 10", "correct rest.csv --cal unit.toml", "repair rest.csv"] {
        refused(&bench, &format!("{command} -o x.txt"), &format!("{why}, or give --format\n"));
    }
    refused(&bench, &format!("calibrate {SHORT} --log x.txt"), &format!("{why}\n"));
    bench.zerorate("capture --samples 10 --format csv -o x.txt").ok();
    assert!(bench.text("x.txt").starts_with("# zerorate"));
}

#[test]
fn two_outputs_are_two_files() {
    let bench = bench();
    for (line, force) in [
        (format!("calibrate {SHORT} -o out --log out"), ""),
        (format!("calibrate {SHORT} -o out --log ./out"), " --force"),
        ("allan log.csv --rate 10 --unit dps --plot a.svg --report a.svg".to_owned(), ""),
        ("allan log.csv --rate 10 --unit dps --report a --imu-yaml ./a".to_owned(), " --force"),
    ] {
        refused(&bench, &(line + force), "same file as");
    }
    if cfg!(unix) {
        refused(&bench, "capture --samples 10 -o /dev/stdout", "same file as stdout");
        refused(&bench, &format!("calibrate {SHORT} --log /dev/stdout"), "same file as stdout");
        let printed = bench.zerorate("export unit.toml --format csv").ok();
        assert_eq!(bench.zerorate("export unit.toml --format csv -o /dev/stdout").ok(), printed);
    }
}

/// Some commands replace a file without `--force`, and the program itself makes the names of some files. These files
/// must not be inputs either.
#[test]
fn no_input_of_a_command_is_its_state_its_recording_or_a_file_beside_its_output() {
    let bench = bench();
    bench.write("token", "0123456789abcdef\n");
    fs::hard_link(bench.path("unit.toml"), bench.path("unit.arrows")).unwrap();
    let serve = "serve --listen 127.0.0.1:0 --no-iio --cal unit.toml --token-file token -o";
    let stream = "stream --device replay:rest.csv --cal unit.toml --track --state";
    for line in [
        #[cfg(feature = "serve")]
        format!("{serve} unit.arrows"),
        #[cfg(feature = "serve")]
        format!("{serve} token"),
        format!("{stream} unit.toml"),
        format!("{stream} rest.csv"),
    ] {
        refused(&bench, &line, "same file as the input");
    }
    fs::rename(bench.path("plan.toml"), bench.path("out.toml.chamber")).unwrap();
    refused(&bench, "chamber out.toml.chamber --device twin:seed=1 -o out.toml", "same file as the input");
    refused(
        &bench,
        "chamber f57 --device twin:seed=1 -o new.toml --log new.toml.chamber",
        "has no ending of a capture",
    );
    if cfg!(feature = "serve") {
        let said = bench.zerorate(&format!("{serve} log.csv")).fails(2, &[]);
        assert!(said.contains("exists") && !said.contains("--force"), "{said}");
    }
}
