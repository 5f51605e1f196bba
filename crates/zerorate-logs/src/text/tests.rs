//! Tests with texts such as users have: headers that do not fit, decimal commas, serial logs.

use super::super::tests::{self, fails, numbers, there};
use crate::column::Column;
use crate::series::Series;
use crate::warning::LogWarning;
use zerorate_input::Quantity;

fn read(text: &str, options: &str) -> Column {
    tests::read_file(text, options).unwrap_or_else(|error| panic!("{text:?}: {error}"))
}

/// R's `write.table(data.frame(gx, gy), …)` names one column less than it writes.
#[test]
fn a_header_with_one_name_too_few() {
    for (header, quote, cut) in [("gx,gy", "", ','), ("\"gx\" \"gy\"", "\"", ' '), ("gx\tgy", "", '\t')] {
        let rows: String =
            (1..40).map(|row| format!("{quote}{row}{quote}{cut}{}.5{cut}{}.25\n", row % 3, row % 5)).collect();
        let text = format!("{header}\n{rows}");
        let column = read(&text, "--column gy --rate 10");
        assert_eq!((column.name.as_str(), numbers(&column)[4]), ("gy", 0.25), "{header}");
        assert_eq!(numbers(&read(&text, "--column 0 --rate 10"))[4], 2.5, "{header}");
        // a column that does not count the rows is not an index
        let text = text.replacen("\n", "\n9", 1);
        let said = fails(text.replace("\n9\"1\"", "\n\"9\""), "--column gy --rate 10");
        assert!(said.contains("the header has 2 names, and the rows below have 3 cells"), "{said}");
    }
    // a header with too many names, or with far too few
    let said = fails("t,x,y,z\n0,1,2\n1,2,3\n", "--column x --rate 10");
    assert!(said.contains("line 1: the header has 4 names, and the rows below have 3 cells"), "{said}");
    let said = fails("t,x\n0,1,2,4\n1,2,3,5\n", "--column x --rate 10");
    assert!(said.contains("the header has 2 names, and the rows below have 4 cells"), "{said}");
    // a delimiter at the end of each row, or of the header, does not make a cell
    for text in ["t,x\n0,1,\n1,2,\n2,4,\n", "t,x,\n0,1\n1,2\n2,4\n", "t,x,\n0,1,\n1,2,\n2,4,\n"] {
        assert_eq!(numbers(&read(text, "--column x --rate 10")), [1.0, 2.0, 4.0], "{text:?}");
    }
    // the index of pandas has no name, and is not a column either
    let column = read(",0\n0,0.5\n1,0.25\n2,1.5\n", "--column 1 --rate 10");
    assert_eq!(numbers(&column), [0.5, 0.25, 1.5]);
}

#[test]
fn a_binary_file_is_not_read_as_text() {
    let codes: Vec<u8> = (0..20_000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let said = fails(codes, "--rate 10");
    assert!(said.contains("is not UTF-8 text; raw numbers need their type (--raw)"), "{said}");
}

#[test]
fn one_column_with_decimal_commas() {
    let expected = [Some(0.5), Some(-1.25), Some(3.0), Some(2.0)];
    assert_eq!(there(&read("gz\n0,5\n-1,25\n3\n2,0\n", "--rate 10")), expected);
    assert_eq!(there(&read("gz\n0,5\n-1,25\n3\n2,0\n", "--column 0 --rate 10")), expected);
    // without a header, and with commas that can only be decimal commas
    assert_eq!(there(&read("-0,5\n-0,25\n0,125\n", "--rate 10")), [Some(-0.5), Some(-0.25), Some(0.125)]);
    // the commas may mark decimals or separate two columns
    for text in ["3,5\n1,25\n2,7\n", "3,5\n4\n2,7\n"] {
        let said = fails(text, "--column 0 --rate 10");
        assert!(said.contains("give --decimal comma or --decimal point"), "{said}");
        assert_eq!(read(text, "--decimal comma --rate 10").series.len(), 3);
    }
    assert_eq!(numbers(&read("0,5\n1,25\n2,7\n", "--column 0 --rate 10")), [0.0, 1.0, 2.0], "a time before a code");
    assert_eq!(numbers(&read("3,5\n1,25\n2,7\n", "--column 1 --rate 10")), [5.0, 25.0, 7.0]);
    // the commas may mark decimals or separate the row's number from a code
    assert!(fails("gz\n1,5\n2,7\n3,9\n", "--rate 10").contains("the header has one name, `gz`"));
    // the points can only be decimal points, so that the commas separate columns
    assert!(fails("gz\n7,0.5\n9,0.7\n8,0.9\n", "--rate 10").contains("has 1 names, and the rows below have 2 cells"));
    assert_eq!(numbers(&read("gz\n1,0.5\n2,0.7\n3,0.9\n", "--rate 10")), [0.5, 0.7, 0.9]);
    assert!(fails("gz\n1,234\n5,678\n", "--rate 10").contains("`1,234` is 1.234 or 1234; give --decimal comma"));
}

#[test]
fn decimal_commas_between_commas() {
    let clash = "decimal commas and comma separators clash in this file. Export it with \";\" or with decimal points";
    let cut = |number: f64, decimals: usize| format!("{number:.decimals$}").replace('.', ",");
    let row = |at: i32| format!("{},{},{}\n", cut(at.into(), 3), cut(-0.05 + 0.01 * f64::from(at), 3), cut(0.5, 1));
    let rows: String = (0..40).map(row).collect();
    let said = fails(format!("t_s,gx,gy\n{rows}"), "--column gx --rate 10");
    assert!(
        said.contains("the header has 3 names, and the rows below have 6 cells") && said.ends_with(clash),
        "{said}"
    );
    for (text, options) in [
        (rows.clone(), "--column 1 --rate 10"),
        (format!("t_s,gx,gy\n{rows}"), "--column gx --rate 10 --decimal comma"),
        // a counter before a number, as the index of a table
        ("n,gx\n0,0,125\n1,0,0625\n2,0,25\n".to_owned(), "--column gx --rate 10"),
        // some numbers without decimals
        ("n,gx,gy\n0,0,125,0,05\n1,0,0625,0,5\n2,0,25,0,1\n".to_owned(), "--column gx --rate 10"),
    ] {
        let said = fails(&text, options);
        assert!(said.ends_with(clash), "{text}: {said}");
    }
    // columns of integers, with and without padding
    for text in ["a,b,c,d\n1,05,2,3\n2,06,2,4\n", "1,5,2,3\n2,6,2,4\n", "1,05,-2,-3\n2,06,2,4\n"] {
        assert_eq!(numbers(&read(text, "--column 1 --rate 10")), [5.0, 6.0]);
    }
}

#[test]
fn a_header_without_rows() {
    for text in ["t_s,gx,gy\n", "t_s,gx,gy", "gx_dps;gy_dps\n"] {
        let said = fails(text, "--column 1 --rate 10");
        assert!(said.contains("it has a header and no rows"), "{text}: {said}");
    }
}

#[test]
fn thousands_beside_decimals() {
    let rows: String = (0..300).map(|row| format!("{row},\"1,{:03}.5\"\n", row * 3)).collect();
    let column = read(&format!("t_s,gz\n{rows}"), "--column gz");
    assert_eq!((column.rate_hz, numbers(&column)[2]), (1.0, 1006.5));
    // a header is a header even if no column below it holds numbers only
    let said = fails("t_s,gz\n900,901\n1'000,2'000\n2'000,2'001\n3'000,2'002\n", "--column gz");
    assert!(said.contains("holds no numbers in `gz`"), "{said}");
}

/// pandas' `to_csv` writes the index without a name.
#[test]
fn an_index_without_a_name_is_not_asked_for() {
    let text = ",t_ms,gz\n0,0,0.5\n1,10,0.25\n2,20,1.5\n";
    assert_eq!(numbers(&read(text, "")), [0.5, 0.25, 1.5]);
    assert_eq!(numbers(&read(text, "--column 0")), [0.0, 1.0, 2.0]);
}

#[test]
fn names_in_a_comment_above_others() {
    let text = "# made yesterday\n# t_s,gz\n# of sensor 7\n0,0.5\n1,0.25\n2,1.5\n";
    assert_eq!(numbers(&read(text, "--column gz")), [0.5, 0.25, 1.5]);
}

/// Excel writes Latin-1 unless asked for UTF-8.
#[test]
fn names_in_latin_1() {
    let bytes: Vec<u8> = b"Zeit (s);Rate (\xB0/s)\n0;0,5\n1;0,25\n2;1,5\n".to_vec();
    let column = tests::read_file(bytes, "--column 1").unwrap();
    assert_eq!((column.name.as_str(), column.scale, numbers(&column)[1]), ("Rate (°/s)", 1.0, 0.25));
    assert!(column.warnings.is_empty(), "{:?}", column.warnings);
}

#[test]
fn times_as_clocks_show_them() {
    for times in [
        ["2026/03/01 23:59:59.99", "2026/03/02 00:00:00.00", "2026/03/02 00:00:00.01"],
        ["2026-03-01 23:59:59.99 UTC", "2026-03-02 00:00:00 UTC", "2026-03-02 00:00:00.01 UTC"],
        ["23:59:59.99", "00:00:00", "0:00:00.01"],
    ] {
        let rows: String = times.iter().map(|time| format!("{time},0.5\n")).collect();
        let column = read(&format!("time,gz\n{rows}"), "--column gz --time-column time");
        assert!((column.rate_hz - 100.0).abs() < 1e-6 && column.missing() == 0, "{times:?}");
    }
    let said = fails("time,gz\nyesterday,1\ntoday,2\n", "--column gz --time-column time");
    assert!(said.contains("is not a number, and no time such as 2026-03-01 12:00:00.25"), "{said}");
}

/// Dates of MATLAB, German dates, dates with AM and PM, and clock times without a date.
#[test]
fn the_only_column_of_clock_times_is_the_time() {
    let date = |at: i32, before: &str, after: &str| {
        let (s, cs) = (57 + at / 100, at % 100);
        let date = if s < 60 { before } else { after };
        let (date, clock) = date.split_once('@').unwrap();
        format!("{date} {clock}:{:02}.{cs:02}0", s % 60)
    };
    for (before, after, half) in [
        ("31-Oct-2023@23:59", "01-Nov-2023@00:00", ["", ""]),
        ("31.10.2023@23:59", "01.11.2023@00:00", ["", ""]),
        ("10/31/2023@11:59", "11/01/2023@12:00", [" PM", " AM"]),
        ("10/11/2023@11:59", "10/12/2023@12:00", [" PM", " AM"]),
        ("10/11/2023@11:59", "11/11/2023@12:00", [" PM", " AM"]),
        ("10/11/2023@11:59", "10/11/2023@12:00", [" AM", " PM"]),
        ("@23:59", "@0:00", ["", ""]),
    ] {
        let row = |at: i32| format!("{}{},0.{}\n", date(at, before, after), half[usize::from(at >= 300)], at % 7);
        let column = read(&format!("When,gz\n{}", (0..600).map(row).collect::<String>()), "");
        assert!((column.rate_hz - 100.0).abs() < 1e-6 && column.missing() == 0, "{before}: {}", column.rate_hz);
    }
    // a time that stands still, such as the start of the log, is not the time
    let said = fails("12:00:00,0.5\n12:00:00,0.25\n".repeat(20), "--column 1");
    assert!(said.contains("does not say how fast"), "{said}");
}

#[test]
fn names_above_units() {
    let text = "Time,Gyro_X,Gyro_Z,Temp\n(ms),(deg/s),[rad/s],°C\n0,0.5,1.5,20\n10,0.25,2.5,20\n20,1,3.5,20\n";
    let column = read(text, "--column 2 --time-column 0");
    assert_eq!((column.name.as_str(), column.rate_hz), ("Gyro_Z [rad/s]", 100.0));
    assert_eq!((column.scale, numbers(&column)), (1f64.to_degrees(), vec![1.5, 2.5, 3.5]));
    assert!(column.warnings.is_empty(), "{:?}", column.warnings);
}

/// Lines that a board prints while it starts, and lines that a bad cable corrupted.
#[test]
fn a_serial_log() {
    let mut lines: Vec<String> = (0..2000).map(|row| format!("{},{}.5,-3", row * 10, row % 7)).collect();
    lines[700] = "7000,0.5".to_owned();
    lines[900] = "9000,4.5,-39010,5.5,-3".to_owned();
    lines[1000] = "1\u{FFFD}0,4.5,-3".to_owned();
    let boot = "ets Jun  8 2016 00:22:57\nrst:0x1 (POWERON_RESET),boot:0x13\nIMU ready\n0,1.5\n";
    let text = format!("{boot}{}\n", lines.join("\n"));
    let column = read(&text, "--column 1 --rate 100");
    assert_eq!((column.series.len(), column.missing()), (2000, 2));
    let said = column.warnings.iter().map(LogWarning::to_string).collect::<Vec<_>>().join("; ");
    let codes: Vec<&str> = column.warnings.iter().map(LogWarning::code).collect();
    assert_eq!(codes, ["lines-skipped", "lines-broken", "unit-unknown"]);
    assert!(said.contains("4 lines above the data are not a header; skipped: `ets Jun"), "{said}");
    assert!(said.contains("2 of 2000 lines are broken and skipped"), "{said}");
    assert!(said.contains("the first: line 705, it has 2 cells, and the others have 3)"), "{said}");
    // with a time column, the times show the missing samples
    let column = read(&text, "--column 1 --time-column 0 --time-unit ms");
    assert_eq!((column.rate_hz, column.missing(), column.series.len()), (100.0, 3, 2000));
    let bytes = text.replace('\u{FFFD}', "\0").into_bytes();
    let bytes: Vec<u8> = bytes.into_iter().map(|byte| if byte == 0 { 0xFE } else { byte }).collect();
    assert_eq!(tests::read_file(bytes, "--column 1 --rate 100").unwrap().missing(), 2);
    // 1 % may be broken unless told otherwise
    for row in (0..2000).step_by(50) {
        lines[row] = "x".to_owned();
    }
    let text = lines.join("\n");
    let said = fails(&text, "--column 1 --rate 100");
    assert!(said.contains("lines are broken, and 1 % may be (--max-bad)"), "{said}");
    assert!(read(&text, "--column 1 --rate 100 --max-bad 0.03").missing() > 30);
}

#[test]
fn choices_that_a_file_offers() {
    assert!(
        fails("0.5\n0.25\n1.5\n", "--column gz --rate 1").contains("has no column `gz`: it has one column, without")
    );
    assert!(fails("gz\n0.25\n1.5\n", "--column gx --rate 1").contains("has no column `gx`: its only column is `gz`"));
    let near = fails("t,gy_dps,gz_dps\n1,2,3\n2,3,4\n", "--column GZ --rate 1");
    assert!(near.contains("has no column `GZ` (did you mean `gz_dps`?); choose with --column"), "{near}");
    assert!(fails("1,2.5\n3,4.5\n", "--rate 1").contains("choose with --column one of: 0, 1"));
    assert!(fails("gx,gy\r1,2\r3,4\r", "--column gy --rate 1").contains("tr '\\r' '\\n' < FILE"));
    let said = fails("hello\nworld, this is\nno log\n", "--rate 1");
    assert!(said.contains("none of its first 3 lines has a cell that is a number (`hello`): is it"), "{said}");
    let said = fails("[00010] GYRO X=312 Y=7\n[00020] GYRO X=311 Y=5\n", "--rate 1");
    assert!(said.contains("(`[00010] GYRO X=312 Y=7`: `[00010]` is not one): is it a log?"), "{said}");
    let said = fails("t_s,gx\n0.0,5 V\n0.1,6 V\n", "--rate 1 --time-column t_s");
    assert!(said.ends_with("has no column of numbers that is not a time; it has: 0 `t_s`, 1 `gx`"), "{said}");
}

/// A text is read in blocks of whole lines. The rows are the same wherever one block ends and the next begins.
#[test]
fn a_text_in_many_blocks() {
    let rows: Vec<i32> = (0..30_000).map(|row| row * 7919 % 65_521 - 30_000).collect();
    let text: String = rows.iter().map(|code| format!("{},{code}\n", code % 13)).collect();
    assert_eq!(read(&format!("a,b\n{text}"), "--column b --rate 1").series, Series::Codes(rows.clone()));
    let numbered: String = rows.iter().map(|code| format!("{code}.25\n")).collect();
    let expected: Vec<f64> = rows.iter().map(|code| format!("{code}.25").parse().unwrap()).collect();
    assert_eq!(numbers(&read(&numbered, "--rate 1")), expected);
    // a code among numbers, and numbers behind codes
    let mixed = format!("{}0.5\n{}", "7\n".repeat(3000), "8\n".repeat(3000));
    assert_eq!(read(&mixed, "--rate 1").series.len(), 6001);
    assert!(
        fails(format!("{}1,5\n{}2.5\n", "7;\n".repeat(2000), "8\n".repeat(3000)), "--column 0 --rate 1").len() > 10
    );
}

/// The example of VectorNav's manual (VN-100 User Manual, 5.3.9) and sentences of a receiver in between.
#[test]
fn sentences_are_checked_and_lose_their_checksum() {
    let imu = "$VNYMR,-034.378,-040.667,+046.804,+01.0673,-00.2482,+03.0143,-06.293,-05.317,-05.655,+00.001117,\
               +00.000241,-00.001017";
    let good = format!("{imu}*{:02X}\n", sum(&imu[1..]));
    let receiver = "$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76\n";
    let text = format!("{}{receiver}", good.repeat(3)).repeat(40);
    let column = read(&text, "--column 12 --rate 40 --unit rad/s");
    assert_eq!((column.series.len(), numbers(&column)[0]), (120, -0.001_017));
    assert!(column.warnings.is_empty(), "{:?}", column.warnings);
    // a line in which a bit was flipped is a missing sample
    let flipped = text.replacen("-00.001017", "-00.001016", 1);
    let column = read(&flipped, "--column 12 --rate 40 --unit rad/s");
    assert_eq!((column.series.len(), there(&column)[0]), (120, None));
    let said = format!("{:?}", column.warnings);
    assert!(said.contains("its checksum is") && said.contains("1 of 120 lines is broken"), "{said}");
}

/// CRC-16 of VectorNav: the check value of the algorithm for `123456789` is 31C3.
#[test]
fn a_sentence_may_have_a_crc() {
    let text = "$123456789*31C3\n".to_owned() + &format!("$x,1.5*{:02X}\n", sum("x,1.5")).repeat(9);
    assert_eq!(read(&text, "--column 1 --rate 10").series.len(), 9);
    assert_eq!(super::sentence::checked("$123456789*31C3"), Ok("$123456789"));
    assert!(super::sentence::checked("$123456789*31C4").is_err());
}

fn sum(body: &str) -> u8 {
    body.bytes().fold(0, |sum, byte| sum ^ byte)
}

/// Loggers of ROS nodes and of some phones print the time on a line of its own. The text has several blocks.
#[test]
fn a_stamp_may_have_a_line_of_its_own() {
    for (cut, head) in [(",", ""), (" ", ""), (", ", "# gyro log\n\n"), ("\t", "gyro log\n")] {
        let row = |at: u32| format!("{:.2}\r\n0.{}{cut}{at}{cut}-0.5\r\n", 100.0 + f64::from(at) * 0.01, at % 7);
        let text = head.to_owned() + &(0..2000).map(row).collect::<String>();
        let column = read(&text, "--column 2 --time-column 0 --time-unit s");
        assert_eq!(numbers(&column), (0..2000).map(f64::from).collect::<Vec<_>>(), "{cut:?}");
        assert!((column.rate_hz - 100.0).abs() < 1e-6, "{cut:?}");
    }
    // one line with two cells in a column of numbers does not make the other lines stamps
    let text = "1.5\n".repeat(60) + "1.5,2\n" + &"1.5\n".repeat(60);
    assert_eq!(read(&text, "--rate 10").series.len(), 121);
}

/// A C program may end each line with `;`.
#[test]
fn a_semicolon_at_the_end_of_lines_is_dropped() {
    let text: String = (0..40).map(|at| format!("{at},{}.5,{}.25;\n", at % 3, at % 5)).collect();
    assert_eq!(numbers(&read(&text, "--column 2 --rate 10"))[4], 4.25);
    // here `;` separates cells, some of which are empty
    let text: String = (0..40).map(|at| format!("0,{at:02};{}\n", if at % 3 == 0 { "25,5" } else { "" })).collect();
    assert_eq!(numbers(&read(&format!("gz_dps;temp_c\n{text}"), "--column gz_dps --rate 10"))[4], 0.04);
}

#[test]
fn units_stand_below_names_that_end_with_a_comma() {
    let rows: String = (0..40).map(|at| format!("{},{}.5,\n", 10 * at, at % 3)).collect();
    for unit in ["m/(s^2)", "(m/(s^2))", "[m/s^2]"] {
        let column = read(&format!("\"sep=,\"\nClock,Accel_X,\nms,{unit},\n{rows}"), "--column 1");
        assert_eq!((column.rate_hz, column.quantity), (100.0, Some(Quantity::Acceleration)), "{unit}");
    }
    // a title is not a row of names
    let column = read(&format!("Arduino Nano,,\nms,gx_dps,\n{rows}"), "--column gx_dps");
    assert_eq!((column.rate_hz, column.quantity), (100.0, Some(Quantity::AngularRate)));
}

/// LabVIEW names a column `Comment`, and writes no cell for an empty comment.
#[test]
fn the_empty_comment_of_labview_is_dropped() {
    let rows: String = (0..40).map(|at| format!("{:.2}\t{}.5\n", f64::from(at) / 100.0, at % 3)).collect();
    let column = read(&format!("X_Value\tGyro_X\tComment\n{rows}"), "--column Gyro_X --time-column 0 --time-unit s");
    assert!((column.rate_hz - 100.0).abs() < 1e-6);
    let head = "LabVIEW Measurement\n***End_of_Header***\nDelta_X\t0.010000\n***End_of_Header***\n";
    let column = read(&format!("{head}X_Value\tGyro_X\tComment\n{rows}"), "--column Gyro_X");
    assert!((column.rate_hz - 100.0).abs() < 1e-6);
}

#[test]
fn files_that_are_not_logs_get_advice() {
    for (start, advice) in [
        (&b"{\"t\":0,\n\"gz\":1}\n"[..], "in Python `pandas.read_json('FILE').to_csv('log.csv')`"),
        (b"\xA3\x95\x80\x80\x59FMT", "a log of ArduPilot without messages IMU, GYR or ACC"),
        (b"FMT, 128, 89, FMT, BBnNZ, Type,Length\n", "`mavlogdump.py --format csv --types IMU FILE > imu.csv`"),
        (b"[{\"t\":0}]", "it is JSON"),
        (b"# A zerorate calibration (docs", "`zerorate report` shows it"),
        (b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1....", "save the sheet as CSV"),
        (b"\x80\x05\x95....", "a pickle of Python"),
        (b"\xB5\x62\x10\x02....", "pyubx2"),
        (b"TDSm\x0E\0\0\0", "nptdms"),
        (b"RDX3\nX\n....", "`write.csv("),
        (b"H Product:Blackbox flight data recorder by", "`blackbox_decode FILE`"),
        (b"\xFA\xFF\x36....", "MT Manager"),
        (b"%RAWIMUSA,1815,407771.985;1815,1,77,1,2,3,4,5,6*69e4a62c\n", "messages of NovAtel"),
        (b"%RAWIMUSXA,1105,150000.000;00,11,1105,150000.0,00000077,1,2,3,4,5,6*1234abcd\n", "the manual of the IMU"),
        (b"%CORRIMUDATASA,1,2;1105,150000.0,1e-7,2e-7,3e-7,0.1,0.1,9.8*1234abcd\n", "in rad and m/s"),
        (b"#INSPVAXA,COM1,0,73.5,FINESTEERING,1695,309428.0;51.1,-114.0*e877c178\n", "without rates"),
        (b"header:\n  stamp:\n    sec: 1\n    nanosec: 0\n", "`ros2 topic echo --csv TOPIC"),
        (b"header: \n  seq: 0\nangular_velocity: \n  x: 0.1\n", "`rostopic echo -p TOPIC"),
        (b" can0  188   [2]  00 1F\n can0  188   [2]  01 1F\n", "cantools"),
        (b"{\n  \"rotations\": [\n    {\"x\": 0.1}\n", "it is JSON"),
    ] {
        let why = fails(start, "--rate 10");
        assert!(why.contains(advice), "{why}");
    }
}

/// Arduino's serial monitor writes the time of each line, and its plotter needs labels.
#[test]
fn a_serial_monitor_writes_times_and_labels() {
    let row = |at: i32, one: &str, other: &str| {
        format!("15:23:4{}.{:02}0 -> {one}0.{}, {other}-0.5\n", 5 + at / 100, at % 100, at % 7)
    };
    for (one, other, name) in [("", "", "1"), ("gx:", "gy:", "gx"), ("gx = ", "gy = ", "gx")] {
        let text: String = (0..300).map(|at| row(at, one, other)).collect();
        let column = read(&format!("15:23:44.100 -> IMU ready\n{text}"), &format!("--column {name}"));
        assert!((column.rate_hz - 100.0).abs() < 1e-6 && column.series.len() == 300, "{name}: {}", column.rate_hz);
        assert_eq!((column.name.as_str(), numbers(&column)[2]), (name, 0.2));
        // a header that the board prints
        let text = format!("15:23:44.990 -> wx,wy\n{text}");
        assert_eq!(read(&text, "--column 1").name, if name == "1" { "wx" } else { "gx" });
    }
    // an ESP32 writes milliseconds since its start
    let row = |at: u32| format!("\x1b[0;32mI ({}) imu: gx: 0.{} gy: -0.5\x1b[0m\n", 321 + 10 * at, at % 7);
    let column = read(&(0..300).map(row).collect::<String>(), "--column gx");
    assert_eq!((column.rate_hz.round(), column.series.len(), numbers(&column)[2]), (100.0, 300, 0.2));
    // a row with labels in another order is broken
    let rows = "gx:1,gy:2\n".repeat(200);
    let text = format!("{rows}gy:1,gx:2\n{rows}");
    let column = read(&text, "--column gx --rate 10");
    assert_eq!((column.missing(), there(&column)[0]), (1, Some(1.0)));
}

/// `ros2 topic echo --csv` writes the fields of a message without their names.
#[test]
fn the_fields_of_a_ros_message_have_names() {
    let row = |at: u32| {
        let vector = |first: f64| format!("{first},0.25,0.5,{}", ["0.0"; 9].join(","));
        let stamp = format!("1770000000,{},imu_link", at * 10_000_000);
        format!("{stamp},0.0,{},{},{}\n", vector(0.0), vector(f64::from(at)), vector(9.5))
    };
    let text: String = (0..90).map(row).collect();
    let column = read(&text, "--column angular_velocity.x");
    assert_eq!(
        (column.rate_hz.round(), numbers(&column)[7], column.quantity),
        (100.0, 7.0, Some(Quantity::AngularRate))
    );
    assert_eq!(numbers(&read(&text, "--column linear_acceleration.x"))[0], 9.5);
}

/// Programs print negative codes of registers in two's complement: -400 as `0xFE70`.
#[test]
fn hexadecimal_codes_have_a_sign() {
    let text: String = (0..300i16).map(|at| format!("0x{:04X}\n", (at % 9 - 4) * 100)).collect();
    assert_eq!(numbers(&read(&text, "--rate 100"))[..3], [-400.0, -300.0, -200.0]);
}

#[test]
fn each_line_may_be_an_object_of_json() {
    let row = |at: u32| format!("{{\"t_ms\":{},\"gyro\":{{\"x\":{at}.5,\"y\":[1,2]}}}}", 10 * at);
    let rows: Vec<String> = (0..90).map(row).collect();
    for text in [rows.join("\n"), format!("[\n{}\n]\n", rows.join(",\n"))] {
        let column = read(&text, "--column gyro.x");
        assert_eq!((column.rate_hz.round(), numbers(&column)[7]), (100.0, 7.5));
        assert_eq!(numbers(&read(&text, "--column gyro.y.1"))[0], 2.0);
    }
}

#[test]
fn a_board_may_speak_between_names_and_rows() {
    let rows: String = (0..90).map(|at| format!("{},{at}.5\n", 10 * at)).collect();
    // or its first rows are broken
    for line in ["MPU6050 connected", "0,ERR", "0,0.\u{FFFD}\n0,OVF", "0,0.50,0.5", "12:00:00.000,ERR"] {
        let column = read(&format!("t_ms,gx\n{line}\n{rows}"), "");
        let found = (column.name.as_str(), column.rate_hz.round(), numbers(&column)[1]);
        assert_eq!(found, ("gx", 100.0, 1.5), "{line}");
    }
}

/// A logger that restarts writes its header again. Another header begins another log.
#[test]
fn a_header_may_come_again_but_not_another_one() {
    let rows = |from: u32| (from..from + 40).map(|at| format!("{},{}.5,0.25\n", 10 * at, at % 3)).collect::<String>();
    let text = |again: &str| format!("t_ms,gx_dps,gy_dps\n{}{again}\n{}", rows(0), rows(40));
    for (options, is_warned) in [("--column gx_dps", false), ("--column gx_dps --rate 100", true)] {
        let column = read(&text("t_ms,gx_dps,gy_dps"), options);
        assert_eq!((column.series.len(), column.missing()), (80, 0), "{options}");
        let said = column.warnings.iter().map(LogWarning::to_string).collect::<Vec<_>>().join("; ");
        assert_eq!(said.contains("line 42 is the header again"), is_warned, "{said}");
        assert!(!said.contains("broken and skipped"), "{said}");
    }
    for other in ["t_ms,gy_dps,gx_dps", "t_ms,gx_rad_s,gy_rad_s"] {
        let said = fails(text(other), "--column gx_dps --max-bad 0.1");
        let named = format!("line 42: the header `{other}` begins another log than `t_ms,gx_dps,gy_dps` in line 1");
        assert!(said.contains(&named), "{said}");
    }
}

#[test]
fn lists_and_tables_in_markdown_are_read() {
    for (head, open, cut, close) in
        [("", "[", ", ", "],"), ("", "(", ", ", "),"), ("| t | gx |\n|---|:-:|\n", "| ", " | ", " |")]
    {
        let rows = (0..50).map(|row| format!("{open}0.{row:02}{cut}{}.5{close}\n", row % 3));
        let text = format!("{head}{}", rows.collect::<String>());
        let name = if head.is_empty() { "1" } else { "gx" };
        let column = read(&text, &format!("--column {name} --rate 10"));
        assert_eq!(numbers(&column)[..3], [0.5, 1.5, 2.5], "{text}");
    }
}

#[test]
fn units_in_cells_are_named() {
    let said = fails("t_s,gx\n0.0,5 V\n0.1,6 V\n", "--rate 1 --column gx");
    assert!(said.starts_with("`5 V` is not a number; write the unit into the header. "), "{said}");
    let said = fails("t,gx\n0s,5V\n1s,6V\n", "--rate 1 --column gx");
    assert!(said.contains("(`0s,5V`: `0s` is not one; write the unit into the header): is it a log?"), "{said}");
}
