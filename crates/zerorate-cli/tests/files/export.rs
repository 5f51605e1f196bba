//! The exports agree with the core, in every language.

use super::{Bench, calibration, installed, run};
use std::fmt::Write;
use zerorate::Correction;

/// F-52, all thirteen rows, as text.
#[test]
fn csv_is_the_table_of_the_note() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    let expected = "delta_c,correction_dps\n0.12,-0.0048\n0.1,-0.004\n0.08,-0.0032\n0.06,-0.0024\n0.04,-0.0016\n0.02,-0.0008\n0,0\n\
        -0.02,0.0008\n-0.04,0.0016\n-0.06,0.0024\n-0.08,0.0032\n-0.1,0.004\n-0.12,0.0048\n";
    assert_eq!(bench.zerorate("export unit.toml --format csv --step-c 0.02 --span-c 0.12").ok(), expected);
    assert_eq!(bench.zerorate("export unit.toml --format csv").ok(), expected, "the note's table is the default");
    assert_eq!(bench.zerorate("export unit.toml --format csv -o table.csv").ok(), "");
    assert_eq!(std::fs::read_to_string(bench.path("table.csv")).unwrap(), expected);
}

#[test]
fn json_has_coefficients_and_table() {
    let bench = Bench::new();
    let correction = Correction { pbc_dps: 0.7312, btc_dps_per_c: 0.0387, t3_c: 33.125 };
    bench.write("unit.toml", calibration(0.7312, 0.0387, 33.125));
    let json: serde_json::Value =
        serde_json::from_str(&bench.zerorate("export unit.toml --format json --span-c 0.2").ok()).unwrap();
    let integer = correction.to_integer().unwrap();
    assert_eq!(json["integer"]["offset_q"], integer.offset_q);
    assert_eq!(json["integer"]["slope_q"], integer.slope_q);
    assert_eq!(json["integer"]["t3_code"], integer.t3_code);
    assert_eq!(json["integer"]["q"], 30);
    assert_eq!(
        (&json["pbc_dps"], &json["btc_dps_per_c"], &json["t3_c"]),
        (&0.7312.into(), &0.0387.into(), &33.125.into())
    );
    let rows = json["table"]["rows"].as_array().unwrap();
    let table = correction.table(0.02, 0.2).unwrap();
    assert_eq!(rows.len(), table.len());
    for (row, expected) in rows.iter().zip(table) {
        assert!((row["delta_c"].as_f64().unwrap() - expected.delta_c).abs() < 1e-12);
        assert!((row["correction_dps"].as_f64().unwrap() - expected.correction_dps).abs() < 1e-12);
    }
}

/// Corrections with both signs, with large coefficients and with none.
const CORRECTIONS: [(f64, f64, f64); 4] =
    [(-0.25, -0.04, 31.5), (1.2345, 0.0317, -12.75), (-249.9, 1.19, 85.0), (0.0, 0.0, 25.0)];

/// 10 000 random codes with all extremes among them: rate and temperature.
fn codes() -> Vec<(u32, u32)> {
    let mut state = 0x9E37_79B9_7F4A_7C15u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as u32
    };
    let extremes = [0, 1, 8_388_607, 8_388_608, 8_388_609, 16_777_214, 16_777_215];
    let corners = extremes.iter().flat_map(|rate| extremes.map(|temp| (*rate, temp)));
    // temperatures near T3, where the table has its rows, and all over the range
    let near: Vec<(u32, u32)> = (0..5_000).map(|_| (random(), 8_388_608 + random() % 200_000)).collect();
    corners.chain(near).chain((0..5_000).map(|_| (random(), random()))).collect()
}

/// What the exported functions must print for `codes`: the core's corrected code, and the row of its table nearest to the temperature.
fn expected((pbc_dps, btc_dps_per_c, t3_c): (f64, f64, f64)) -> String {
    let correction = Correction { pbc_dps, btc_dps_per_c, t3_c };
    let integer = correction.to_integer().unwrap();
    let table = correction.table(0.02, 2.0).unwrap();
    let mut text = String::new();
    for (rate, temp) in codes() {
        let delta_c = f64::from(temp as i32 - integer.t3_code) / 14_093.0;
        let row = ((2.0 - delta_c) / 0.02).round().clamp(0.0, 200.0) as usize;
        let udps = (table[row].correction_dps * 1e6).round() as i32;
        writeln!(text, "{} {udps}", integer.apply(rate, temp)).unwrap();
    }
    text
}

#[test]
fn c_gives_what_rust_gives() {
    if !installed("gcc") {
        return;
    }
    let pairs: String = codes().iter().map(|(rate, temp)| format!("{{{rate}u, {temp}u}},\n")).collect();
    let main = format!(
        "#include \"unit.h\"\n#include \"unit.h\"\n#include <stdio.h>\nstatic const uint32_t codes[][2] = {{\n{pairs}}};\nint main(void)\n{{\n\
         for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)\n\
         printf(\"%u %d\\n\", (unsigned)zerorate_correct_code(codes[i][0], codes[i][1]), (int)zerorate_table_lookup_udps(codes[i][1]));\n\
         return 0;\n}}\n"
    );
    for (pbc, btc, t3) in CORRECTIONS {
        let bench = Bench::new();
        bench.write("unit.toml", calibration(pbc, btc, t3));
        bench.write("main.c", &main);
        // included alone and unused, the header must not warn either
        bench.write("alone.c", "#include \"unit.h\"\nint nothing;\n");
        bench.zerorate("export unit.toml --format c --span-c 2 -o unit.h").ok();
        let flags = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic", "-Wconversion", "-O1", "-ftrapv"];
        run("gcc", &[&flags[..], &["-c", "alone.c", "-o", "alone.o"]].concat(), bench.dir.path());
        run("gcc", &[&flags[..], &["main.c", "-o", "main"]].concat(), bench.dir.path());
        assert!(run(bench.path("main"), &[], bench.dir.path()) == expected((pbc, btc, t3)), "{pbc} {btc} {t3}");
    }
}

#[test]
fn rust_gives_what_rust_gives() {
    if !installed("rustc") {
        return;
    }
    let pairs: String = codes().iter().map(|(rate, temp)| format!("({rate}, {temp}),\n")).collect();
    let main = format!(
        "mod unit;\nconst CODES: &[(u32, u32)] = &[{pairs}];\nfn main() {{\nfor (rate, temp) in CODES {{\n\
         println!(\"{{}} {{}}\", unit::correct_code(*rate, *temp), unit::table_lookup_udps(*temp));\n}}\n\
         assert!(!unit::CALIBRATION_ID.is_empty() && unit::PBC_UDPS.abs() < 250_000_000);\n}}\n"
    );
    let library = "#![no_std]\n#![deny(missing_docs, warnings)]\n//! The module alone.\npub mod unit;\n";
    for (pbc, btc, t3) in CORRECTIONS {
        let bench = Bench::new();
        bench.write("unit.toml", calibration(pbc, btc, t3));
        bench.write("main.rs", &main);
        bench.write("lib.rs", library.replace("pub mod", "/// Exported.\npub mod"));
        bench.zerorate("export unit.toml --format rust --span-c 2 -o unit.rs").ok();
        run("rustc", &["--edition=2021", "--crate-type=lib", "--emit=metadata", "lib.rs"], bench.dir.path());
        run("rustc", &["--edition=2021", "-Copt-level=1", "main.rs"], bench.dir.path());
        assert!(run(bench.path("main"), &[], bench.dir.path()) == expected((pbc, btc, t3)), "{pbc} {btc} {t3}");
    }
}

/// A name in the file cannot become code.
#[test]
fn text_of_the_calibration_stays_in_its_comment() {
    let bench = Bench::new();
    let hostile = "serial = \"*/ int x; /* \\n #error @TABLE@ ä \\\\\"\n[correction]";
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5).replace("[correction]", hostile));
    let header = bench.zerorate("export unit.toml --format c").ok();
    assert!(header.contains("serial       ./ int x; /. . #error .TABLE. . ."), "{header}");
    assert!(header.is_ascii());
    let module = bench.zerorate("export unit.toml --format rust").ok();
    assert!(module.lines().filter(|line| line.contains("int x")).all(|line| line.starts_with("//")));
}

#[test]
fn what_cannot_be_exported_is_explained() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    bench.write("steep.toml", calibration(-0.25, 2.0, 31.5));
    bench.write("broken.toml", "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = x\n");
    assert!(bench.zerorate("export unit.toml --format csv --step-c 0.05").fails(2).contains("whole number of steps"));
    assert!(
        bench
            .zerorate("export unit.toml --format c --step-c 0.0000001 --span-c 0.000001")
            .fails(2)
            .contains("--step-c")
    );
    assert!(bench.zerorate("export steep.toml --format c").fails(1).contains("btc_dps_per_c"));
    assert!(bench.zerorate("export broken.toml --format c").fails(1).contains("broken.toml: line 4"));
    assert!(bench.zerorate("export absent.toml --format c").fails(1).contains("cannot read absent.toml"));
    assert!(bench.zerorate("export unit.toml --format pdf").fails(2).contains("pdf"));
}
