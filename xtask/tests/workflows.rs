//! Compares the workflows with the steps of `cargo xtask ci` and of `cargo xtask night`.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

#[test]
fn each_step_of_ci_is_in_one_job() {
    let listed = printed(&["ci", "--list"]);
    let steps: BTreeSet<&str> = listed.lines().collect();
    assert!(steps.contains("clippy") && steps.contains("test"), "{listed}");
    let workflow = workflow("ci.yml");
    let jobs = workflow.split(" steps: ").skip(1).map(|job| job.split("- name:").next().unwrap());
    let jobs = jobs.map(|job| job.split("\n    steps:").next().unwrap().trim_start_matches(">-"));
    let run: Vec<&str> = jobs.flat_map(str::split_whitespace).collect();
    assert_eq!(run.iter().copied().collect::<BTreeSet<_>>(), steps);
    assert_eq!(run.len(), steps.len(), "a step is in two jobs");
    assert!(workflow.contains("- run: cargo xtask test\n"));
}

#[test]
fn the_night_runs_by_cron_and_shares_no_step_with_the_gate() {
    let nightly = workflow("nightly.yml");
    assert!(nightly.contains("- cron: ") && nightly.contains("- run: cargo xtask night "));
    let (gate, night) = (printed(&["ci", "--list"]), printed(&["night", "--list"]));
    assert!(night.lines().count() > 10, "{night}");
    assert!(night.lines().all(|step| gate.lines().all(|other| other != step)), "{night}");
}

#[test]
fn crates_that_are_published_are_those_that_are_tried() {
    let crates = "-p adis16130 -p zerorate-allan\n";
    assert!(workflow("release.yml").contains(&format!("cargo publish {crates}")));
    let help = printed(&["night", "--help"]);
    assert!(help.contains(&format!("cargo publish --dry-run --allow-dirty {crates}")), "{help}");
}

fn printed(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

fn workflow(name: &str) -> String {
    fs::read_to_string(format!("{}/../.github/workflows/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}
