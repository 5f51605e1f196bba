//! Hostile files: each ends in an error that states the cause, in bounded time and memory.

#[cfg(feature = "full")]
mod forms;

use super::{Bench, PROGRAM, Run, calibration, capture};
use std::fs::File;
use std::io::Write;
use std::process::Command;

/// Limit on the address space of the program, KiB. It leaves room for threads and for a file.
const ADDRESS_SPACE_KIB: u64 = 3 << 20;

impl Bench {
    /// Runs the program with limited address space, so that a hostile file cannot exhaust the machine.
    fn caged(&self, line: &str) -> Run {
        let script = format!("ulimit -v {ADDRESS_SPACE_KIB}; exec \"$0\" \"$@\"");
        let mut sh = Command::new("sh");
        sh.args(["-c", &script, PROGRAM]).args(line.split(' ')).current_dir(self.path("."));
        Run::of(&mut sh)
    }

    #[track_caller]
    fn refuses(&self, line: &str, reason: &str) {
        let said = self.caged(line).fails(1, &[reason]);
        assert!(!said.contains("panicked"), "zerorate {line}: {said}");
    }
}

fn npy(header: &[u8]) -> Vec<u8> {
    [b"\x93NUMPY\x02\x00", (header.len() as u32).to_le_bytes().as_slice(), header].concat()
}

#[test]
fn headers_of_npy_are_bounded() {
    let bench = Bench::new();
    let nested = format!("{{'descr': {}{}, }}", "(".repeat(60), ")".repeat(60));
    bench.write("nested.npy", npy(nested.as_bytes()));
    bench
        .refuses("allan nested.npy --rate 10", "nested.npy, as an NPY file: its header has brackets more than 6 deep");
    let hidden = format!("{{'descr': '\\N{{'}}', {}{}, }}", "[".repeat(60), "]".repeat(60));
    bench.write("hidden.npy", npy(hidden.as_bytes()));
    bench.refuses("allan hidden.npy --rate 10", "or a backslash");
    bench.write("long.npy", b"\x93NUMPY\x02\x00\xFF\xFF\xFF\xFF{}");
    bench.refuses("allan long.npy --rate 10", "its header would have 4294967295 bytes");
    let shape = "{'descr': '<f8', 'fortran_order': True, 'shape': (1152921504606846976, 16), }";
    bench.write("shape.npy", npy(shape.as_bytes()));
    bench.refuses("allan shape.npy --rate 10 --column 3", "shape.npy, as an NPY file: its header");
}

#[test]
fn the_memory_of_a_large_log_is_a_choice() {
    let bench = Bench::new();
    bench.write("huge.bin", vec![0; 40 << 20]);
    bench.refuses(
        "allan huge.bin --raw i16 --rate 10 --max-memory 256M",
        "huge.bin: it takes more memory than the 256 MiB of max_memory: give more, or cut the log",
    );
    // a hole takes no space on the disk, so it gets only the memory of the smallest file
    File::create(bench.path("hole.bin")).unwrap().set_len(20 << 30).unwrap();
    bench.refuses("allan hole.bin --raw i16 --rate 10 --max-memory 2G", "hole.bin: it grows to more than 64 MiB in");
    for size in ["1", "63M", "many", "1.5G"] {
        bench.zerorate(&format!("allan huge.bin --raw i16 --rate 10 --max-memory {size}")).fails(2, &["--max-memory"]);
    }
    File::create(bench.path("some.bin")).unwrap().write_all(&[1, 0, 2, 0].repeat(50_000)).unwrap();
    bench.caged("allan some.bin --raw i16 --rate 10 --max-memory 256M --json").ok();
}

#[test]
fn losses_take_no_memory() {
    let bench = Bench::new();
    let rows: String = (0..1000u64)
        .map(|i| {
            format!("{},{i},{},8,,{}\n", i * 1_000_000_000_000, 8_388_608 + i % 7, if i == 500 { u32::MAX } else { 0 })
        })
        .collect();
    bench.write("lost.csv", capture("A17", &rows));
    bench.caged("allan lost.csv --json").ok();
    bench
        .caged("allan lost.csv --data phase --json")
        .fails(3, &["lost.csv: 4294967295 samples are missing between its rows"]);
}

/// Control sequences in a file or its name do not reach the terminal.
#[test]
fn escapes_for_terminals_are_shown() {
    let bench = Bench::new();
    bench.write("log\x1b[31m.csv", "t,\x1b]0;owned\x07\n0,1\n1,2\n2,3\n");
    let said = [
        bench.zerorate("allan log\x1b[31m.csv").fails(2, &[]),
        bench.zerorate("allan missing\x1b[2J.csv --rate 10").fails(1, &[]),
        {
            let run = bench.zerorate("allan log\x1b[31m.csv --column 1 --rate 10 --fit").ended_with(3);
            run.stdout + &run.stderr
        },
    ];
    assert!(said[0].contains(r"log\u{1b}[31m.csv") && said[0].contains(r"\u{1b}]0;owned\u{7}"), "{}", said[0]);
    for said in &said {
        assert!(!said.contains('\x1b') && !said.contains('\x07'), "{said:?}");
    }
}

/// A line break in a name cannot add a line to the file.
#[test]
fn a_name_adds_nothing_to_imu_yaml() {
    let bench = Bench::new();
    let next = |state: &u64| Some(16_807 * state % 2_147_483_647);
    let rows: String =
        std::iter::successors(Some(1), next).skip(9).take(4000).map(|state| format!("{}\n", state % 1009)).collect();
    let name = "log\nevil:\n#.csv";
    bench.write(name, format!("x_dps\n{rows}"));
    bench.zerorate(&format!("allan {name} --rate 100 --imu-yaml imu.yaml")).ok();
    let yaml = bench.text("imu.yaml");
    let lines = yaml.split(['\n', '\r']).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let keys: Vec<&str> = lines.map(|line| line.split(':').next().unwrap()).collect();
    assert_eq!(keys, ["gyroscope_noise_density", "gyroscope_random_walk", "rostopic", "update_rate"], "{yaml}");
}

#[test]
fn a_serial_number_is_one_line() {
    let bench = Bench::new();
    for command in
        ["calibrate --serial A\n17", "capture --serial A\x1b17 -o x.arrows", "stream --serial A\r17 --cal x.toml"]
    {
        bench.zerorate(command).fails(2, &["it must be one line of plain text"]);
    }
    let file = format!("{}\n", calibration(-0.25, -0.04, 31.5)).replace("[corr", "serial = \"A\\u001B[2J17\"\n[corr");
    bench.write("escape.toml", file);
    bench.zerorate("report escape.toml").fails(1, &["line 3: `serial` holds control characters"]);
}

/// Commands that read a text file.
#[cfg(target_os = "linux")]
const TEXTS: &[&str] = &[
    "export FILE --format c",
    "report FILE",
    "correct rest.csv --cal FILE -o out",
    "stream --cal FILE",
    "stream --cal unit.toml --track --state FILE",
    "capture --part FILE -o out",
    "recalibrate rest.csv --part FILE",
    "chamber FILE",
    "imu rest.csv --datasheet FILE",
    #[cfg(feature = "serve")]
    "serve --listen 127.0.0.1:0 --cal FILE",
    #[cfg(feature = "serve")]
    "serve --listen 127.0.0.1:0 --token-file FILE",
];

/// Commands that read a log.
#[cfg(target_os = "linux")]
const LOGS: &[&str] = &[
    "allan FILE",
    "imu FILE",
    "verify FILE",
    "repair FILE -o out",
    "correct FILE --cal unit.toml -o out",
    "recalibrate FILE",
    "probe --device replay:FILE",
    "capture --device replay:FILE -o out",
    "calibrate --device replay:FILE",
    "stream --device replay:FILE --cal unit.toml",
    "chamber f57 --device replay:FILE",
    #[cfg(feature = "serve")]
    "serve --listen 127.0.0.1:0 --device replay:FILE",
];

/// A path may lead to an endless device, or to a file that is one large hole. Each exceeds the run's address space.
#[cfg(target_os = "linux")]
#[test]
fn whatever_is_read_whole_has_a_bound() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", "1000,1,8623488,8,8402701,0\n"));
    File::create(bench.path("hole")).unwrap().set_len(10 << 30).unwrap();
    for line in TEXTS.iter().chain(LOGS) {
        for file in ["/dev/zero", "/dev/urandom", "hole"] {
            let line = line.replace("FILE", file);
            let run = bench.caged(&line);
            assert!(matches!(run.code, Some(1 | 2)), "{line}: {run:?}");
            let names_it = run.stderr.contains(file) || run.stdout.contains(file);
            assert!(run.stderr.contains("error: ") && names_it, "{line}: {}", run.stderr);
            assert!(!bench.path("out").exists(), "{line}");
        }
    }
}

/// A log must not be a pipe, because opening it would wait for its other end. A text file may be one.
#[cfg(target_os = "linux")]
#[test]
fn a_pipe_in_place_of_a_file_is_refused_or_read_within_bounds() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", "1000,1,8623488,8,8402701,0\n"));
    assert!(Command::new("mkfifo").arg(bench.path("never")).status().unwrap().success());
    let _socket = std::os::unix::net::UnixListener::bind(bench.path("socket")).unwrap();
    for (line, file) in LOGS.iter().flat_map(|line| ["never", "socket"].map(|file| (line.replace("FILE", file), file)))
    {
        let run = bench.caged(&line);
        assert_eq!(run.code, Some(1), "{line}: {run:?}");
        let said = format!("cannot read {file}: it is a pipe or a device");
        assert!(run.stderr.contains(&said) || run.stdout.contains(&said), "{line}: {run:?}");
    }
    for line in TEXTS.iter().filter(|line| !line.contains("--state")) {
        let _ = std::fs::remove_file(bench.path("pipe"));
        assert!(Command::new("mkfifo").arg(bench.path("pipe")).status().unwrap().success());
        let mut endless =
            Command::new("sh").args(["-c", "yes 1 > pipe"]).current_dir(bench.path(".")).spawn().unwrap();
        let run = bench.caged(&line.replace("FILE", "pipe"));
        assert!(matches!(run.code, Some(1 | 2)) && run.stderr.contains("it has more than"), "{line}: {run:?}");
        endless.wait().unwrap();
    }
}
