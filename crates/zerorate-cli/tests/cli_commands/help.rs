//! Help, typing errors, completions and the manual page.

use super::zerorate;

const COMMANDS: &str = "probe capture calibrate recalibrate chamber stream correct verify repair export report allan \
    imu serve twin explain parts help completions man";

#[test]
fn every_command_is_listed_and_has_help() {
    let overview = zerorate(&["--help"]).ended_with(0).stdout;
    for command in COMMANDS.split_whitespace() {
        assert!(overview.contains(&format!("\n  {command}")), "{command} in\n{overview}");
        let help = zerorate(&[command, "--help"]).ended_with(0).stdout;
        assert!(help.contains("Usage: zerorate"), "{help}");
    }
}

#[test]
fn commands_are_listed_in_groups() {
    for overview in [zerorate(&["--help"]), zerorate(&["-h"]), zerorate(&["help"])] {
        let text = overview.ended_with(0).stdout;
        let calibrate = text.find("\nCalibrate it:\n  calibrate ").expect("a group");
        assert!(calibrate < text.find("\nAnalyse a log:\n  allan ").expect("another"), "{text}");
        assert!(text.contains("--max-memory") && text.contains("Exit code: 0 done"), "{text}");
    }
}

#[test]
fn help_knows_commands_and_topics() {
    let of_command = zerorate(&["help", "calibrate"]).ended_with(0).stdout;
    assert_eq!(of_command, zerorate(&["calibrate", "--help"]).ended_with(0).stdout);
    let device = zerorate(&["help", "device"]).ended_with(0).stdout;
    for address in ["twin:KEY=VALUE", "replay:FILE", "spi:/dev/", "iio:iio:", "bridge:/dev/ttyACM0", "tcp:HOST:PORT"] {
        assert!(device.contains(&format!("\n  {address}")), "{address} in\n{device}");
        assert!(!of_command.contains(address) || address == "replay:FILE", "{address} in\n{of_command}");
    }
    assert!(of_command.contains("`zerorate help device`"), "{of_command}");
    assert!(zerorate(&["man"]).ended_with(0).stdout.contains(".SH DEVICES\n"));
    zerorate(&["help", "calibrat"]).ended_with(2).saying(&["'calibrate'"]);
}

#[test]
fn without_arguments_the_first_steps_are_five_lines() {
    let run = zerorate(&[]).ended_with(2);
    assert_eq!((run.stdout.as_str(), run.stderr.lines().count()), ("", 5), "{}", run.stderr);
    assert!(run.stderr.contains("zerorate allan log.csv --fit") && run.stderr.contains("zerorate help"));
}

#[test]
fn every_unit_is_listed() {
    let units = |command: &str, option: &str| {
        let help = zerorate(&[command, "--help"]).ended_with(0).stdout;
        let rest = help.split_once(&format!("{option} <UNIT>")).expect("the option").1;
        rest.split("[default").next().unwrap_or_default().to_owned()
    };
    for unit in zerorate_input::Unit::ALL {
        let is_rate = unit.quantity() == zerorate_input::Quantity::AngularRate;
        let of_kind = units("imu", if is_rate { "--gyro-unit" } else { "--accel-unit" });
        for listed in [of_kind, units("allan", "--unit")] {
            let listed: Vec<&str> = listed.split([' ', ',', '.', '\n']).collect();
            assert!(listed.contains(&unit.name()), "{} in {listed:?}", unit.name());
        }
    }
}

#[test]
fn calibrate_states_its_defaults() {
    let help = zerorate(&["calibrate", "--help"]).ended_with(0).stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for default in ["twin:", "10s", "10m", "40m", "2m30s", "an1042", "0.001", "0.01", "1"] {
        assert!(help.contains(&format!("[default: {default}]")), "{default} in\n{help}");
    }
}

#[test]
fn twin_lists_every_key_of_the_contract() {
    let keys = "seed bias_dps tempco_dps_per_c curvature hysteresis lag_s ambient_c profile warmup_c warmup_s mclk_hz \
        roa supply_step_mv noise flicker_hz rotation_dps motion sway_dps sway_hz bit_error_rate fault fault_at_s";
    for help in [zerorate(&["twin", "--help"]), zerorate(&["twin"])] {
        let text = help.ended_with(0).stdout;
        for key in keys.split_whitespace() {
            assert!(text.contains(&format!("\n  {key} ")), "{key} in\n{text}");
        }
    }
}

#[test]
fn typos_are_usage_errors_with_a_suggestion() {
    let cases: [(&[&str], &str); 18] = [
        (&["fleet", "run", "a", "b"], "`fleet` is in the Python package"),
        (&["calibrat"], "'calibrate'"),
        (&["calibrate", "--warmpup", "3"], "'--warmup'"),
        (&["calibrate", "--device", "twin:sed=7"], "`seed`"),
        (&["calibrate", "--device", "twin:axs=3"], "fault_at_s axes"),
        (&["probe", "--device", "twin:fault=sdo"], "sdo_low"),
        (&["probe", "--device", "tiwn:"], "twin:"),
        (&["probe", "--device", "replay:"], "replay:unit.arrows"),
        (&["calibrate", "--average", "2x"], "10s, 10m, 1h30m"),
        (&["calibrate", "--average", "0"], "--average"),
        (&["calibrate", "--max-u-btc", "0"], "--max-u-btc"),
        (&["calibrate", "--max-lost", "1.5"], "--max-lost"),
        (&["calibrate", "--target-dph", "2,5"], "use a decimal point: 2.5"),
        (&["calibrate", "--target-dph", "50"], "--target-dph is for --method warmup or cycle"),
        (&["calibrate", "--earth-dps", "15.04"], "if that was °/h, give 0.00418"),
        (&["probe", "--duration", "0"], "above zero"),
        (&["capture", "-o", "x.arrows", "--duration", "0"], "above zero"),
        (&["capture", "-o", "x.arrows", "--duration", "1s", "--samples", "3"], "--samples"),
    ];
    for (args, hint) in cases {
        zerorate(args).ended_with(2).saying(&[hint]);
    }
}

#[test]
fn completions_and_the_manual_know_every_command() {
    let shells = ["bash", "zsh", "fish"].map(|shell| zerorate(&["completions", shell]));
    for run in shells.into_iter().chain([zerorate(&["man"])]) {
        let text = run.ended_with(0).stdout;
        for command in COMMANDS.split_whitespace() {
            assert!(text.contains(command), "{command}");
        }
    }
    let page = zerorate(&["man"]).stdout;
    assert!(page.contains(".SH \"ZERORATE CALIBRATE\"") && page.contains("max\\-u\\-btc"), "{page}");
}

#[test]
fn explain_says_what_a_code_means() {
    let all = zerorate(&["explain"]).ended_with(0).stdout;
    assert!(all.contains("Of noise:\n") && all.contains("\n  aliased "), "{all}");
    let one = zerorate(&["explain", "aliased"]).ended_with(0).stdout;
    for part in ["aliased: a warning of", "Seen: ", "Matters: ", "Do: ", "As in: "] {
        assert!(one.contains(part), "{part} in\n{one}");
    }
    let line = zerorate(&["explain", "warning:", "aliased:", "228", "rate", "samples"]).ended_with(0).stdout;
    assert_eq!(line, one);
    let json = zerorate(&["explain", "frozen", "--json"]).ended_with(0).json();
    assert_eq!((&json["code"], &json["says"]), (&"frozen".into(), &"warning or refusal".into()));
    let json = zerorate(&["explain", "--json"]).ended_with(0).json();
    assert!(json["codes"].as_array().is_some_and(|codes| codes.len() > 80));
    zerorate(&["explain", "aliasd"]).ended_with(2).saying(&["did you mean aliased"]);
    zerorate(&["explain", "\u{1b}[31m"]).ended_with(2).saying(&["no warning and no refusal"]);
}
