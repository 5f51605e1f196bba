//! The exports agree with the core, in every language.

use super::{Bench, calibration, installed, run};
use std::fmt::Write;
use zerorate::calibration::CalibratedAxis;
use zerorate::{Axis, Calibration, Correction, CurveForm, IntegerForm, Validity};

/// The table of F-52, all thirteen rows as text.
#[test]
fn csv_is_the_table_of_the_note() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    let expected = "delta_c,correction_dps\n0.12,-0.0048\n0.1,-0.004\n0.08,-0.0032\n0.06,-0.0024\n0.04,-0.0016\n\
                    0.02,-0.0008\n0,0\n\
        -0.02,0.0008\n-0.04,0.0016\n-0.06,0.0024\n-0.08,0.0032\n-0.1,0.004\n-0.12,0.0048\n";
    assert_eq!(bench.zerorate("export unit.toml --format csv --step-c 0.02 --span-c 0.12").ok(), expected);
    assert_eq!(bench.zerorate("export unit.toml --format csv --span-c 0.12").ok(), expected);
    assert_eq!(bench.zerorate("export unit.toml --format csv --span-c 0.12 -o table.csv").ok(), "");
    assert_eq!(bench.text("table.csv"), expected);
}

/// In JSON, a curve has quadratic and cubic terms and an integer form of order 3, which a line lacks. The table
/// follows the curve.
#[test]
fn json_and_csv_hold_a_curve() {
    let bench = Bench::new();
    let correction = CORRECTIONS[3];
    bench.write("unit.toml", measured(&correction));
    let text = bench.zerorate("export unit.toml --format json --step-c 0.5 --span-c 4").ok();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&json["btc2_dps_per_c2"], &json["btc3_dps_per_c3"]), (&0.0005.into(), &(-3e-6).into()));
    let integer = correction.to_integer_curve(&Axis::ADIS16130.rate, &Axis::ADIS16130.temp).unwrap();
    assert_eq!(json["integer"]["terms"], serde_json::json!(integer.terms));
    assert_eq!((&json["integer"]["fraction"], &json["integer"]["temp_shift"]), (&integer.fraction.into(), &10.into()));
    assert_eq!(json["integer"]["t3_code"], integer.t3_code);
    let csv = bench.zerorate("export unit.toml --format csv --step-c 0.5 --span-c 4");
    let csv = csv.saying(&["by up to 3.4e-5 °/s, the nearest row by up to 1.1e-2 °/s"]).ok();
    let rows = json["table"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), csv.lines().count(), csv.lines().next()), (17, 18, Some("delta_c,correction_dps")));
    for (row, line) in rows.iter().zip(csv.lines().skip(1)) {
        let d = row["delta_c"].as_f64().unwrap();
        let wanted = -0.04 * d + 0.0005 * d * d - 3e-6 * d * d * d;
        let found: f64 = line.split(',').nth(1).unwrap().parse().unwrap();
        assert!((found - wanted).abs() < 1e-11 && row["correction_dps"] == found, "{line}: {wanted}");
    }
    // the nearest row is up to 0.25 °C away, and the steepest slope is 0.044144 °/s/°C; interpolation between rows
    // that are 0.5 °C apart leaves step²/8 times the largest second derivative, 0.001072 °/s/°C²
    assert!((json["table"]["nearest_dps"].as_f64().unwrap() - 0.25 * 0.044_144).abs() < 1e-6, "{}", json["table"]);
    assert!((json["table"]["linear_dps"].as_f64().unwrap() - 0.25 / 8.0 * 0.001_072).abs() < 1e-9, "{text}");
    bench.write("line.toml", measured(&CORRECTIONS[0]));
    let line = bench.zerorate("export line.toml --format json --span-c 4").ok();
    assert!(!line.contains("btc2") && !line.contains("_dps\": 0.0000"), "{line}");
}

#[test]
fn a_curve_that_does_not_fit_codes_is_refused() {
    let bench = Bench::new();
    let steep = Correction { btc3_dps_per_c3: 0.01, ..CORRECTIONS[0] };
    bench.write("unit.toml", measured(&steep));
    for form in ["c", "rust", "json"] {
        bench
            .zerorate(&format!("export unit.toml --format {form} --span-c 4"))
            .fails(1, &["btc3_dps_per_c3 does not fit the integer correction of a curve"]);
    }
    bench.zerorate("export unit.toml --format csv --span-c 4").ok();
}

/// Lines and curves, with positive and negative terms and with large ones.
const CORRECTIONS: [Correction; 5] = [
    Correction::line(-0.25, -0.04, 31.5),
    Correction::line(1.2345, 0.0317, -12.75),
    Correction::line(-249.9, 1.19, 85.0),
    Correction { btc2_dps_per_c2: 0.0005, btc3_dps_per_c3: -3e-6, ..Correction::line(-0.25, -0.04, 31.5) },
    Correction { btc2_dps_per_c2: -0.01, btc3_dps_per_c3: 1e-4, ..Correction::line(249.9, -0.9, -40.0) },
];

/// A calibration that holds from 3.2 °C below T3 to 0.7 °C above T3. In [`tried`], its table spans 2 °C on each side.
fn measured(correction: &Correction) -> String {
    let text = calibration(correction.pbc_dps, correction.btc_dps_per_c, correction.t3_c);
    let (mut calibration, _) = Calibration::parse(&text).unwrap();
    calibration.axes[0].correction = *correction;
    let t3_c = correction.t3_c;
    calibration.validity = Some(Validity { temp_min_c: t3_c - 3.2, temp_max_c: t3_c + 0.7, margin_c: 0.5 });
    calibration.to_toml()
}

/// A calibration of three axes: x is a line, y has a quadratic and a cubic term, z only a cubic term.
fn curved_axes() -> String {
    let file = super::AXES.replace("schema = 2", "schema = 3");
    let file = file.replace("t3_c = 31.25", "t3_c = 31.25, btc2_dps_per_c2 = 0.0015, btc3_dps_per_c3 = -2e-5");
    let file = file.replace("-0.01, t3_c = 31.5", "-0.01, t3_c = 31.5, btc3_dps_per_c3 = 3e-6");
    // with T3 = 31.5 °C, the code of 25 °C would lie half-way between two rows of the table
    file.replace("t3_c = 31.5", "t3_c = 31.53")
}

/// An export and the codes to test it with.
struct Trial {
    file: String,
    /// The prefix of each axis's functions.
    axes: &'static [&'static str],
    step_c: f64,
    span_c: f64,
    /// The types of codes in C and in Rust.
    types: [&'static str; 2],
    /// Rows of codes: the temperature, then the rate of each axis.
    codes: Vec<Vec<i64>>,
}

/// One export for each correction, and one for three axes.
fn tried() -> Vec<Trial> {
    let one = |correction: &Correction| Trial {
        file: measured(correction),
        axes: &[""],
        step_c: 0.02,
        span_c: 2.0,
        types: ["uint32_t", "u32"],
        codes: codes(),
    };
    let three = Trial {
        file: curved_axes(),
        axes: &["x_", "y_", "z_"],
        step_c: 0.2,
        span_c: 16.0,
        types: ["int32_t", "i32"],
        codes: codes_of_axes(),
    };
    CORRECTIONS.iter().map(one).chain([three]).collect()
}

fn random() -> impl FnMut() -> i64 {
    let mut state = 99_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as i64
    }
}

/// 10 000 random pairs of codes of 24 bits, and all pairs of extreme codes.
fn codes() -> Vec<Vec<i64>> {
    let mut random = random();
    let extremes = [0, 1, 8_388_607, 8_388_608, 8_388_609, 16_777_214, 16_777_215];
    let corners = extremes.iter().flat_map(|rate| extremes.map(|temp| vec![temp, *rate]));
    let mut code = move || random() % 16_777_216;
    // temperatures from 25 to 39 °C, which include the rows of tables around 31.5 °C, then over the whole range
    let near: Vec<_> = (0..5_000).map(|_| vec![8_388_608 + code() % 200_000, code()]).collect();
    corners.chain(near).chain((0..5_000).map(|_| vec![code(), code()])).collect()
}

/// Every temperature code with rates over the whole scale, and codes beyond the scales.
fn codes_of_axes() -> Vec<Vec<i64>> {
    let mut random = random();
    let mut of = |first: i64, last: i64| first + random() % (last - first + 1);
    let scales = [(-32_768, 32_767), (-8_192, 8_191), (0, 16_777_215)];
    (-2060..2060).map(|temp| [temp].into_iter().chain(scales.map(|(a, b)| of(a - 9, b + 9))).collect()).collect()
}

impl Trial {
    /// The expected output, a line for each row of codes. It begins with 1 if the temperature is a code of the part
    /// that the calibration covers, otherwise with 0. For each axis follow the corrected code, the nearest row of the
    /// table, 1 if that row is valid, and the corrected code at the nearest temperature that the calibration covers.
    /// Codes come from the core, which is tested against exact arithmetic. No temperature code lies half-way between
    /// two rows.
    fn expected(&self) -> String {
        let (calibration, _) = Calibration::parse(&self.file).unwrap();
        let (temp_scale, validity) = (calibration.temp.unwrap(), calibration.validity.unwrap());
        let (first, last) = temp_scale.codes();
        let is_line = calibration.axes.len() == 1 && calibration.axes[0].correction.is_line();
        let exact = |temp_c: f64| temp_scale.code(temp_c);
        let (low, high) = match is_line {
            // the margin of 0.5 °C in codes
            true => (exact(validity.temp_min_c).round() - 7047.0, exact(validity.temp_max_c).round() + 7047.0),
            false => (exact(validity.temp_min_c - 0.5).ceil(), exact(validity.temp_max_c + 0.5).floor()),
        };
        let tables = calibration.axes.iter().map(|axis| axis.correction.table(self.step_c, self.span_c).unwrap());
        let axes: Vec<_> = calibration.axes.iter().zip(tables).collect();
        let mut text = String::new();
        for codes in &self.codes {
            let temp = codes[0].clamp(first, last);
            let in_range = validity.covers(temp_scale.value(temp - temp_scale.zero_code)) && temp == codes[0];
            write!(text, "{}", i32::from(in_range)).unwrap();
            for ((axis, table), rate) in axes.iter().zip(&codes[1..]) {
                let below_c = (temp_scale.code(axis.correction.t3_c) - temp as f64) / temp_scale.lsb_per_unit;
                let row = ((self.span_c + below_c) / self.step_c + 0.5).floor();
                let nearest = &table[row.clamp(0.0, table.len() as f64 - 1.0) as usize];
                let udps = (nearest.correction_dps * 1e6).round() as i64;
                let inside = in_range && (0.0..table.len() as f64).contains(&row);
                let [by_itself, held] = [codes[0], codes[0].clamp(low as i64, high as i64)]
                    .map(|temp| by_the_core(&calibration, axis, *rate, temp));
                write!(text, " {by_itself} {udps} {} {held}", i32::from(inside)).unwrap();
            }
            text.push('\n');
        }
        text
    }

    /// The code of a program in C or Rust for all axes; `of` gets the number and the prefix of each axis.
    fn each(&self, of: impl Fn(usize, &str) -> String) -> String {
        self.axes.iter().enumerate().map(|(index, axis)| of(index + 1, axis)).collect()
    }

    /// The rows of codes as array literals, with the brackets of C or Rust.
    fn literals(&self, [open, close]: [&str; 2]) -> String {
        let row = |codes: &Vec<i64>| codes.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
        self.codes.iter().map(|codes| format!("{open}{}{close},\n", row(codes))).collect()
    }

    #[track_caller]
    fn is_printed(&self, printed: &str) {
        let expected = self.expected();
        for ((found, wanted), codes) in printed.lines().zip(expected.lines()).zip(&self.codes) {
            assert_eq!(found, wanted, "{codes:?}\n{}", self.file);
        }
        assert_eq!(printed.lines().count(), expected.lines().count());
    }

    fn in_c(&self) -> String {
        let axis = |index, axis: &str| {
            format!(
                "inside = zerorate_{axis}table_lookup_udps(it[0], &row);\n\
                 printf(\" %ld %ld %d %ld\",\n\
                 (long)zerorate_{axis}correct_code(it[{index}], it[0]), (long)row, inside,\n\
                 (long)zerorate_{axis}correct_code(it[{index}], zerorate_hold_in_range(it[0])));\n"
            )
        };
        let (code, cells) = (self.types[0], self.axes.len() + 1);
        format!(
            "#include \"unit.h\"\n#include \"unit.h\"\n#include <stdio.h>\n\
             static const {code} codes[][{cells}] = {{\n{}}};\n\
             int main(void)\n{{\nfor (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {{\n\
             const {code} *it = codes[i];\nint32_t row;\nbool inside;\n\
             printf(\"%d\", zerorate_in_range(it[0]));\n{}printf(\"\\n\");\n}}\nreturn 0;\n}}\n",
            self.literals(["{", "}"]),
            self.each(axis)
        )
    }

    fn in_rust(&self) -> String {
        let axis = |index, axis: &str| {
            format!(
                "let row = unit::{axis}table_lookup_held_udps(it[0]);\n\
                 let found = unit::{axis}table_lookup_udps(it[0]);\n\
                 assert!(found.map_or(true, |found| found == row));\n\
                 let held = unit::{axis}correct_code(it[{index}], unit::hold_in_range(it[0]));\n\
                 print!(\" {{}} {{row}} {{}} {{held}}\", unit::{axis}correct_code(it[{index}], it[0]), \
                 i32::from(found.is_some()));\n"
            )
        };
        format!(
            "mod unit;\nconst CODES: &[[{}; {}]] = &[{}];\nfn main() {{\nfor it in CODES {{\n\
             print!(\"{{}}\", i32::from(unit::in_range(it[0])));\n{}println!();\n}}\n}}\n",
            self.types[1],
            self.axes.len() + 1,
            self.literals(["[", "]"]),
            self.each(axis)
        )
    }
}

fn by_the_core(calibration: &Calibration, axis: &CalibratedAxis, rate: i64, temp: i64) -> i64 {
    let (rate_scale, temp_scale) = (axis.rate.unwrap(), calibration.temp.unwrap());
    match axis.correction.is_line() {
        true => {
            let integer = axis.correction.to_integer(&rate_scale, &temp_scale).unwrap();
            integer.apply_as(&IntegerForm::new(&rate_scale, &temp_scale), rate, temp)
        }
        false => {
            let integer = axis.correction.to_integer_curve(&rate_scale, &temp_scale).unwrap();
            integer.apply_as(&CurveForm::new(&rate_scale, &temp_scale), rate, temp)
        }
    }
}

#[test]
fn exported_c_computes_what_the_core_computes() {
    if !installed("gcc") {
        return;
    }
    for tried in tried() {
        let bench = Bench::new();
        bench.write("unit.toml", &tried.file);
        bench.write("main.c", tried.in_c());
        // a header that is included alone and not used must not cause warnings either
        bench.write("alone.c", "#include \"unit.h\"\nint nothing;\n");
        bench.zerorate(&format!("export unit.toml --format c --span-c {} -o unit.h", tried.span_c)).ok();
        let flags = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic", "-Wconversion", "-O1", "-ftrapv"];
        run("gcc", &[&flags[..], &["-c", "alone.c", "-o", "alone.o"]].concat(), bench.dir.path());
        run("gcc", &[&flags[..], &["main.c", "-o", "main"]].concat(), bench.dir.path());
        tried.is_printed(&run(bench.path("main"), &[], bench.dir.path()));
    }
}

#[test]
fn exported_rust_computes_what_the_core_computes() {
    if !installed("rustc") {
        return;
    }
    // a program that uses no item of the module, and one module with both units
    let unused = "mod unit;\nmod both {\ninclude!(\"left.rs\");\ninclude!(\"right.rs\");\n}\nfn main() {}\n";
    let library =
        "#![no_std]\n#![deny(missing_docs, warnings)]\n//! The module alone.\n/// Exported.\npub mod unit;\n";
    for (index, tried) in tried().iter().enumerate() {
        let bench = Bench::new();
        bench.write("unit.toml", &tried.file);
        bench.write("main.rs", tried.in_rust());
        bench.write("lib.rs", library);
        bench.write("unused.rs", unused);
        for (prefix, file) in [("", "unit.rs"), (" --prefix left", "left.rs"), (" --prefix Right_2", "right.rs")] {
            bench
                .zerorate(&format!("export unit.toml --format rust --span-c {}{prefix} -o {file}", tried.span_c))
                .ok();
        }
        // the export of a line, of a curve, and of three axes
        if [0, 3, 5].contains(&index) {
            has_no_warning(&bench);
        }
        run("rustc", &["--edition=2021", "-Copt-level=1", "main.rs"], bench.dir.path());
        tried.is_printed(&run(bench.path("main"), &[], bench.dir.path()));
    }
}

/// Checks with compiler, clippy and rustfmt that the module has no warning: alone, unused, and twice in one module.
fn has_no_warning(bench: &Bench) {
    let check = ["--emit=metadata", "-Dwarnings", "-Dunused"];
    for edition in ["--edition=2018", "--edition=2021", "--edition=2024"] {
        run("rustc", &[&check[..], &[edition, "--crate-type=lib", "lib.rs"]].concat(), bench.dir.path());
        run("rustc", &[&check[..], &[edition, "unused.rs"]].concat(), bench.dir.path());
    }
    if installed("clippy-driver") {
        run(
            "clippy-driver",
            &[&check[..], &["-Dclippy::all", "--edition=2021", "unused.rs"]].concat(),
            bench.dir.path(),
        );
    }
    if installed("rustfmt") {
        run("rustfmt", &["--check", "--edition=2021", "unit.rs"], bench.dir.path());
    }
}

/// Two units fit into one source file. Two units with the same prefix are an error.
#[test]
fn two_units_fit_into_one_program() {
    if !installed("gcc") {
        return;
    }
    let bench = Bench::new();
    bench.write("left.toml", calibration(-0.25, -0.04, 31.5));
    bench.write("right.toml", calibration(1.5, 0.03, 40.0));
    bench.zerorate("export left.toml --format c --prefix left -o left.h").ok();
    bench.zerorate("export right.toml --format c --prefix Right_2 -o right.h").ok();
    bench.write(
        "main.c",
        "#include \"left.h\"\n#include \"right.h\"\n#include \"left.h\"\n#include <stdio.h>\n\
         int main(void)\n{\nint32_t row = 0;\n\
         const bool inside = left_table_lookup_udps(RIGHT_2_TEMP_MAX_CODE, &row);\n\
         printf(\"%u %u %d %ld\\n\", (unsigned)left_correct_code(8388608, LEFT_T3_CODE), \
         (unsigned)Right_2_correct_code(8388608, RIGHT_2_T3_CODE),\n\
         inside, (long)row);\nreturn LEFT_TEMP_MIN_C < RIGHT_2_TEMP_MIN_C ? 0 : 1;\n}\n",
    );
    let flags = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic"];
    run("gcc", &[&flags[..], &["main.c", "-o", "main"]].concat(), bench.dir.path());
    // −0.25 °/s and 1.5 °/s in codes of 1/23 488 °/s; the left table ends 9.5 °C above T3, with −0.38 °/s
    assert_eq!(run(bench.path("main"), &[], bench.dir.path()), "8382736 8423840 0 -380000\n");
    for unit in ["left", "right"] {
        bench.zerorate(&format!("export {unit}.toml --format c -o {unit}.h --force")).ok();
    }
    let refused =
        std::process::Command::new("gcc").args(["-c", "main.c"]).current_dir(bench.dir.path()).output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("two calibrations under one prefix"));
}

#[test]
fn the_default_table_covers_the_calibration() {
    let bench = Bench::new();
    let range = "[validity]\ntemp_min_c = 25.0\ntemp_max_c = 32.5\n";
    bench.write("unit.toml", calibration(-0.25, -0.04, 32.4) + range);
    bench.write("hand.toml", calibration(-0.25, -0.04, 32.4));
    let json = |line: &str| serde_json::from_str::<serde_json::Value>(&bench.zerorate(line).ok()).unwrap();
    let export = json("export unit.toml --format json");
    let rows = export["table"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &export["table"]["step_c"]), (791, &0.02.into()));
    // T3 = 32.4 °C is row 395, so 25 °C, 370 steps of 0.02 °C below T3, is row 765
    assert_eq!((&rows[765]["delta_c"], &rows[765]["correction_dps"]), (&(-7.4).into(), &0.296.into()));
    assert_eq!(export["valid"]["temp_min_code"], 8_388_608);
    assert_eq!((&export["valid"]["stated"], &export["valid"]["temp_max_c"]), (&true.into(), &32.5.into()));
    let hand = json("export hand.toml --format json");
    assert_eq!((&hand["valid"]["stated"], &hand["table"]["span_c"]), (&false.into(), &9.5.into()));
    assert_eq!(hand["temp_min_c"], serde_json::Value::Null);
}

#[test]
fn text_of_the_calibration_stays_in_its_comment() {
    let bench = Bench::new();
    let hostile = "serial = \"*/ int x; /* ; #error @TABLE@ ä \\\\\"\n[correction]";
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5).replace("[correction]", hostile));
    let header = bench.zerorate("export unit.toml --format c").ok();
    assert!(header.contains("serial       ./ int x; /. ; #error .TABLE. . ."), "{header}");
    assert!(header.is_ascii());
    let module = bench.zerorate("export unit.toml --format rust").ok();
    assert!(module.lines().filter(|line| line.contains("int x")).all(|line| line.starts_with("//")));
}

#[test]
fn an_export_names_the_warnings_of_its_calibration() {
    let bench = Bench::new();
    let warned = "warnings = [\"earth-included: it is part\", \"turning: it may be rotation\"]\n[correction]";
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5).replace("[correction]", warned));
    for format in ["c", "rust"] {
        let code = bench.zerorate(&format!("export unit.toml --format {format}")).ok();
        assert!(code.contains(", warned of turning\n") && !code.contains("earth-included"), "{code}");
    }
    let json: serde_json::Value = bench.zerorate("export unit.toml --format json").json();
    assert_eq!(json["warnings"], serde_json::json!(["turning: it may be rotation"]));
}

#[test]
fn an_impossible_export_is_explained() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    bench.write("steep.toml", calibration(-0.25, 2.0, 31.5));
    bench.write("broken.toml", "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = x\n");
    bench.zerorate("export unit.toml --format csv --step-c 0.05 --span-c 0.12").fails(2, &["whole number of steps"]);
    bench
        .zerorate("export unit.toml --format c --step-c 0.0000001 --span-c 0.000001")
        .fails(2, &["not a whole number of millionths"]);
    bench.zerorate("export steep.toml --format c").fails(1, &["btc_dps_per_c"]);
    bench.zerorate("export broken.toml --format c").fails(1, &["broken.toml: line 4"]);
    bench.zerorate("export unit.toml --format c --prefix 2nd").fails(2, &["--prefix", "2nd"]);
    bench.zerorate("export unit.toml --format csv --prefix left").fails(2, &["--prefix"]);
    bench.zerorate("export unit.toml --format pdf").fails(2, &["pdf"]);
}

#[test]
fn csv_and_json_hold_three_axes() {
    let bench = Bench::new();
    bench.write("unit.toml", super::AXES);
    let expected = "delta_c,x_correction_dps,y_correction_dps,z_correction_dps\n0.4,-0.016,0.008,-0.004\n\
                    0.2,-0.008,0.004,-0.002\n0,0,0,0\n-0.2,0.008,-0.004,0.002\n-0.4,0.016,-0.008,0.004\n";
    assert_eq!(bench.zerorate("export unit.toml --format csv --span-c 0.4").ok(), expected);
    let text = bench.zerorate("export unit.toml --format json --span-c 0.4").ok();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let names: Vec<_> = json["axes"].as_array().unwrap().iter().map(|axis| axis["name"].clone()).collect();
    assert_eq!((names, &json["part"]), (vec!["x".into(), "y".into(), "z".into()], &"ADIS16405".into()));
    let y = &json["axes"][1];
    // with temperature codes of 12 bits, the coefficients have 12 + 6 = 18 fraction bits: BTC · 20 / 7.14 · 2¹⁸. The
    // offset is PBC · 20 · 2¹⁸, moved from T3 = 31.25 °C to the nearest temperature code
    let (slope, t3): (f64, f64) = (0.02 * 20.0 / 7.14 * 262_144.0, 6.25 * 7.14);
    assert_eq!((&y["integer"]["q"], &y["integer"]["t3_code"]), (&18.into(), &45.into()));
    assert_eq!(y["integer"]["slope_q"], slope.round() as i64);
    assert_eq!(y["integer"]["offset_q"], (0.75_f64 * 20.0 * 262_144.0 + (45.0 - t3) * slope).round() as i64);
    assert_eq!((&y["integer"]["rate_first_code"], &y["integer"]["rate_last_code"]), (&(-8192).into(), &8191.into()));
    assert_eq!((&json["valid"]["temp_min_code"], &json["valid"]["stated"]), (&0.into(), &true.into()));
}

#[test]
fn an_export_names_what_an_axis_lacks() {
    let bench = Bench::new();
    let rate = "rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 14 }\n";
    bench.write("bare.toml", super::AXES.replace(rate, ""));
    bench.zerorate("export bare.toml --format c").fails(1, &["scale of the codes of axis y", "the form csv"]);
    assert!(bench.zerorate("export bare.toml --format csv").ok().starts_with("delta_c,x_correction_dps,y_"));
    assert!(bench.zerorate("export bare.toml --format json").ok().contains("\"integer\": null"));
    bench.write("steeper.toml", super::AXES.replace("btc_dps_per_c = -0.01", "btc_dps_per_c = 7.0"));
    bench.zerorate("export steeper.toml --format c --span-c 16").fails(1, &["axis z: btc_dps_per_c does not fit"]);
    bench.write("same.toml", super::AXES.replace("\"y\"", "\"X\""));
    bench.zerorate("export same.toml --format rust").fails(1, &["axes x and X both become X"]);
    // zerorate_…_table_lookup_udps has 27 characters without the axis
    for (length, form, code) in [(36, "c", 0), (37, "c", 1), (37, "rust", 0)] {
        bench.write("long.toml", super::AXES.replace("\"y\"", &format!("\"{}\"", "y".repeat(length))));
        let run = bench.zerorate(&format!("export long.toml --format {form}")).ended_with(code);
        assert_eq!(run.stderr.contains("more than the 63 characters by which C tells names apart"), code == 1);
    }
}
