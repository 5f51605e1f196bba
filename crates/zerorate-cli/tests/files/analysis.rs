//! `zerorate allan` beyond the table: statistics, fit, pictures, pages, files for other programs.

use super::{Bench, number_of, raw, white};
use serde_json::Value;
use zerorate_allan::Stat;

const LOG: &str = "white.f64 --raw f64 --rate 100";

/// Makes a folder with white noise: 15 minutes at 100 Hz. N is the standard deviation times `√(1 / 100 Hz)`.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("white.f64", raw(&white(90_000, 0.06, 1)));
    bench.write("other.f64", raw(&white(90_000, 0.12, 2)));
    bench
}

#[test]
fn the_contract_of_json() {
    let bench = bench();
    let report = bench.zerorate(&format!("allan {LOG} --scale 1 --fit --json")).ended_with(0).json();
    assert_eq!((&report["rate_hz"], &report["samples"]), (&100.0.into(), &90_000.into()));
    let first = &report["points"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    assert_eq!((&first["tau_s"], &first["m"]), (&0.01.into(), &1.into()));
    assert_eq!((&first["n"], &first["alpha"]), (&89_999.into(), &0.into()));
    assert!((number(&first["dev"]) / 0.06 - 1.0).abs() < 0.02, "white noise of 0.06 °/s");
    assert!(number(&first["lo"]) < number(&first["dev"]) && number(&first["dev"]) < number(&first["hi"]));
    let n = &report["fit"]["n"];
    assert_eq!((&n["unit"], &n["identified"]), (&"°/√s".into(), &true.into()));
    assert!((number(&n["value"]) / 0.006 - 1.0).abs() < 0.02, "N = 0.06 °/s · √0.01 s");
    for letter in ["b", "k"] {
        let coefficient = &report["fit"][letter];
        assert_eq!(coefficient["identified"], false, "there is no {letter} in white noise");
        assert!(number(&coefficient["value"]) >= 0.0 && number(&coefficient["needed_s"]) > 900.0);
    }
}

#[test]
fn every_statistic_works_at_every_spacing() {
    let bench = bench();
    let help = bench.zerorate("allan --help").ok().split_whitespace().collect::<Vec<_>>().join(" ");
    for stat in Stat::ALL {
        assert!(help.contains(&format!("{stat} ({})", stat.title())), "{help}");
        let report =
            bench.zerorate(&format!("allan {LOG} --stat {stat} --taus 0.01,1,10 --json")).ended_with(0).json();
        assert_eq!(report["stat"], stat.name());
        assert_eq!(report["points"].as_array().unwrap().len(), 3, "{stat}");
    }
    for (taus, points) in [("octave", 16), ("decade", 15), ("log:20", 20)] {
        let report = bench.zerorate(&format!("allan {LOG} --taus {taus} --json")).ended_with(0).json();
        assert_eq!(report["points"].as_array().unwrap().len(), points, "{taus}");
    }
}

#[test]
fn deviations_that_are_not_computed_are_listed() {
    let bench = bench();
    let table = bench.zerorate(&format!("allan {LOG} --taus 1,1000000")).ok();
    assert!(table.lines().last().unwrap().contains("not computed"), "{table}");
    let report = bench.zerorate(&format!("allan {LOG} --taus 1,1000000 --json")).ended_with(0).json();
    assert_eq!(report["unavailable"][0]["tau_s"], 1e6);
}

/// A log of white noise at 100 Hz. `changed` maps the index, time (s) and rate of each sample to a new time and rate.
fn log_with(samples: usize, changed: impl Fn(usize, f64, f64) -> (f64, f64)) -> String {
    let noise = white(samples, 0.05, 4).into_iter().enumerate();
    let rows = noise.map(|(at, rate_dps)| changed(at, at as f64 / 100.0, rate_dps));
    rows.fold("t_s,gz_dps\n".to_owned(), |log, (t_s, rate_dps)| log + &format!("{t_s:.2},{rate_dps:e}\n"))
}

/// Too few samples, 99 % missing samples, or a single impossible value: the model is refused.
#[test]
fn a_record_without_a_model_is_refused_in_every_mode() {
    let bench = Bench::new();
    bench.write("short.csv", log_with(40, |_, t_s, rate_dps| (t_s, rate_dps)));
    let late = |at, t_s| if at < 1800 { t_s } else { t_s + 3600.0 };
    bench.write("gap.csv", log_with(4000, |at, t_s, rate_dps| (late(at, t_s), rate_dps)));
    for cell in [1e150, -1e200] {
        bench.write(
            "huge.csv",
            log_with(60_000, |at, t_s, rate_dps| (t_s, if at == 30_000 { cell } else { rate_dps })),
        );
        for (file, why) in [("short.csv", "record longer"), ("gap.csv", "losses"), ("huge.csv", "check the unit")] {
            for output in ["", " --csv", " --json --column all"] {
                let run = bench.zerorate(&format!("allan {file} --fit{output}")).ended_with(3);
                assert!(run.stderr.contains(why) && run.stderr.contains("code: no-model"), "{output}: {run:?}");
            }
            let report = bench.zerorate(&format!("allan {file} --fit --json")).ended_with(3).json();
            for letter in ["n", "b", "k"] {
                let coefficient = &report["fit"][letter];
                assert!(["value", "lo", "hi"].iter().all(|name| coefficient[name].is_null()), "{coefficient}");
                assert_eq!(coefficient["identified"], false);
            }
            assert!(report["fit_error"].as_str().unwrap().contains(why), "{report}");
        }
    }
    let report = bench.zerorate("allan short.csv --json").ended_with(0).json();
    assert!(report["fit"].is_null() && report["points"][0]["model"].is_null(), "{report}");
}

#[test]
fn the_fit_is_printed_in_words() {
    let bench = bench();
    let text = bench.zerorate(&format!("allan {LOG} --unit dps --fit")).ok();
    assert!(text.contains("N  angle random walk") && text.contains("°/√h"), "{text}");
    assert!(text.contains("not identified: a value of this order takes"), "{text}");
    assert!(text.contains("To find the bias, average"), "{text}");
}

#[test]
fn several_logs_are_compared() {
    let bench = bench();
    let line = format!("allan other.f64 {LOG} --scale 1");
    let report = bench.zerorate(&format!("{line} --json")).ended_with(0).json();
    assert_eq!(report["files"][1]["file"], "white.f64");
    let csv = bench.zerorate(&format!("{line} --csv")).ok();
    assert!(csv.starts_with("file,tau_s,m,dev_dps,lo_dps,hi_dps,edf,alpha,n\nother.f64,0.01,1,"), "{csv}");
    assert_eq!(csv.lines().filter(|row| row.starts_with("white.f64,")).count(), 16);
    bench.zerorate(&format!("{line} --plot both.svg --report both.html")).ok();
    let svg = bench.text("both.svg");
    assert!(svg.contains("other.f64") && svg.contains("white.f64") && !svg.contains("AN-1042"));
    let page = bench.text("both.html");
    assert!(page.contains("angle random walk") && page.contains("<svg") && !page.contains("http-equiv"));
}

#[test]
fn kalibr_reads_n_and_k_in_radians() {
    let bench = bench();
    bench.zerorate(&format!("allan other.f64 {LOG} --unit rad/s --imu-yaml imu.yaml")).ok();
    let yaml = bench.text("imu.yaml");
    let n = number_of(&yaml, "gyroscope_noise_density");
    assert!((0.98..1.3).contains(&(n / 0.012)), "the larger of the two, to cover its curve: {yaml}");
    assert_eq!(number_of(&yaml, "update_rate"), 100.0);
    bench.zerorate(&format!("allan {LOG} --imu-yaml other.yaml")).saying(&["imu.yaml needs rad/s"]);
    assert!(!bench.path("other.yaml").exists());
}
