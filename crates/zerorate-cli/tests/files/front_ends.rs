//! A calibration shows the same numbers in the terminal, in JSON, in its file, on the page and in the exports.

use super::{Bench, white};
use adis16130::Width;
use serde_json::Value;
use zerorate::Axis;
use zerorate::calibration::{CalibratedAxis, Calibration};
use zerorate_record::{CaptureInfo, CaptureWriter, Converter, Format, Row};
use zerorate_view::PlusMinus;

/// Length of the recordings, s, and samples per second.
const LENGTH_S: usize = 600;
const RATE_HZ: usize = 10;

/// Records a part with a curved bias. It warms by 8 °C with a time constant of 150 s. If `cools` is true, it instead
/// warms evenly for five minutes and cools for five.
fn record(bench: &Bench, name: &str, cools: bool) {
    let path = bench.path(name);
    let info = CaptureInfo::adis16130(Converter { width: Width::Bits24, rate_conversion: 5, temp_conversion: 5 });
    let out = Box::new(std::fs::File::create(&path).unwrap());
    let mut writer = CaptureWriter::create(&path, out, Format::Arrows, &info).unwrap();
    for (k, noise_dps) in white(LENGTH_S * RATE_HZ, 0.03, 5).into_iter().enumerate() {
        let part_of_way = 2.0 * k as f64 / (LENGTH_S * RATE_HZ) as f64;
        let warmed_c = 8.0 * if cools { 1.0 - (1.0 - part_of_way).abs() } else { 1.0 - (-2.0 * part_of_way).exp() };
        let rate_dps = 0.4 - 0.04 * warmed_c + 0.0008 * warmed_c * warmed_c + noise_dps;
        let code = |value: f64, lsb: f64| 8_388_608 + (value * lsb).round() as i64;
        let t_ns = k as u64 * 1_000_000_000 / RATE_HZ as u64;
        let row = Row::new(t_ns, k as u32, &[code(rate_dps, Axis::ADIS16130.rate.lsb_per_unit)]).unwrap();
        writer.push(&row.with_temp_code(Some(code(warmed_c, Axis::ADIS16130.temp.lsb_per_unit)))).unwrap();
    }
    writer.finish().unwrap();
}

/// The standard uncertainties of PBC and BTC in the file.
fn stated(axis: &CalibratedAxis) -> [f64; 2] {
    match (&axis.curve, &axis.uncertainty) {
        (Some(curve), None) => [curve.covariance[0][0].sqrt(), curve.covariance[1][1].sqrt()],
        (None, Some(u)) => [u.u_pbc_dps, u.u_btc_dps_per_c],
        _ => panic!("a curve or a line: {axis:?}"),
    }
}

/// True if both numbers are equal to twelve digits. The JSON parser of these tests may be off in the last bit.
fn is_same(found: &Value, stated: f64) -> bool {
    found.as_f64().is_some_and(|found| (found - stated).abs() <= 1e-12 * stated.abs())
}

#[test]
fn every_front_end_states_the_numbers_of_the_file() {
    let bench = Bench::new();
    record(&bench, "up.arrows", false);
    record(&bench, "up-and-down.arrows", true);
    let steps = "--average 10s --warmup 200s --settle 200s --offset 60s";
    for (method, capture, plan) in [("an1042", "up", steps), ("warmup", "up", ""), ("cycle", "up-and-down", "")] {
        let line = format!("recalibrate {capture}.arrows --method {method} --max-u-btc 0.2 {plan}").trim().to_owned();
        let json = bench.zerorate(&format!("{line} -o {method}.toml --json")).ended_with(0).json();
        let text = bench.zerorate(&line).ok();
        let file = bench.text(&format!("{method}.toml"));
        let axis = Calibration::parse(&file).unwrap().0.axes.remove(0);
        let (of, u) = (axis.correction, stated(&axis));
        let exported = bench.zerorate(&format!("export {method}.toml --format json")).ended_with(0).json();
        for (key, value) in [("pbc_dps", of.pbc_dps), ("btc_dps_per_c", of.btc_dps_per_c), ("t3_c", of.t3_c)] {
            assert!(is_same(&json[key], value) && is_same(&exported[key], value), "{method}: {key} and {value}");
        }
        for (value, u) in [(&json["u_pbc_dps"], u[0]), (&json["u_btc_dps_per_c"], u[1])] {
            assert!(is_same(value, u), "{method}: {value} and {u}");
        }
        for point in json["curve"].as_array().unwrap() {
            let u_dps = axis.u_correction_dps(point["temp_c"].as_f64().unwrap()).unwrap();
            assert!(is_same(&point["u_dps"], u_dps), "{method}: {point} and {u_dps}");
        }
        let factor = json["coverage_factor"].as_f64().unwrap();
        let interval = |value, u| PlusMinus { value, half: factor * u };
        for said in
            [format!("PBC  {}", interval(of.pbc_dps, u[0])), format!("BTC  {}", interval(of.btc_dps_per_c, u[1]))]
        {
            assert!(text.contains(&said), "{method}: {said} in\n{text}");
        }
        let page = bench.zerorate(&format!("report {method}.toml")).ok();
        let header = bench.zerorate(&format!("export {method}.toml --format c")).ok();
        for said in [format!("{:.5}", u[0]), format!("{:.6}", u[1])] {
            assert!(page.contains(&format!("<td class=\"number\">{said}</td>")), "{method}: {said} in\n{page}");
        }
        for said in [format!("PBC = {} deg/s", of.pbc_dps), format!("BTC = {} deg/s", of.btc_dps_per_c)] {
            assert!(header.contains(&said), "{method}: {said} in\n{header}");
        }
    }
}
