//! The distribution fits together: versions agree, and the files of `packaging/` name existing files.

mod tree;

use std::fs;
use std::process::Command;
use tree::{files_below, root};

#[test]
fn everything_that_is_handed_out_has_the_version_of_the_workspace() {
    for manifest in ["bindings/c/Cargo.toml", "firmware/Cargo.toml", "lab/tools/Cargo.toml"] {
        let text = read(manifest);
        let version = text.lines().find_map(|line| line.strip_prefix("version = ")).unwrap();
        assert_eq!(version.trim_matches('"'), env!("CARGO_PKG_VERSION"), "{manifest}");
    }
    assert!(read("bindings/python/pyproject.toml").contains("dynamic = [\"version\"]"));
    assert!(read("bindings/c/zerorate.pc").contains(&format!("Version: {}\n", env!("CARGO_PKG_VERSION"))));
    assert!(read("packaging/c/trial/CMakeLists.txt").contains(&format!("find_package(zerorate {} ", minor())));
}

/// A user who only reads logs builds neither the driver nor the core, not even for the tests.
#[test]
fn reading_a_log_compiles_no_driver() {
    for package in ["zerorate-logs", "zerorate-imu"] {
        let tree = ["tree", "--locked", "--all-features", "--prefix", "none", "--package", package];
        let tree = Command::new(env!("CARGO")).args(tree).current_dir(root()).output().unwrap();
        let tree = String::from_utf8(tree.stdout).unwrap();
        let names: Vec<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
        assert!(names.contains(&"zerorate-allan"), "{tree}");
        assert!(!names.iter().any(|name| ["adis16130", "zerorate"].contains(name)), "{package}: {tree}");
    }
}

#[test]
fn every_file_of_packaging_goes_somewhere() {
    let code: String = ["deb", "c_library", "mod"].map(|name| read(&format!("lab/src/dist/{name}.rs"))).concat();
    for path in files_below(&root().join("packaging")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let folder = path.parent().unwrap().file_name().unwrap().to_str().unwrap();
        let used =
            code.contains(&format!("{folder}/{name}")) || code.contains(&format!("\"{name}\"")) || folder == "trial";
        assert!(used, "nothing takes {}", path.display());
    }
}

#[test]
fn packages_agree_with_the_program() {
    let unit = read("packaging/systemd/zerorate@.service");
    let advice = "AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK";
    assert!(unit.lines().any(|line| line == advice), "the unit lets the program read in real time");
    let told = read("docs/codes.md").contains(advice);
    assert!(told, "the program names those capabilities where it lacks them");
    let rules = read("packaging/udev/60-zerorate.rules");
    assert!(rules.contains("ATTRS{idVendor}==\"1209\", ATTRS{idProduct}==\"0001\""));
    let bridge = files_below(&root().join("firmware/bridge/src"));
    let bridge: String = bridge.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    assert!(bridge.contains("0x1209, 0x0001"), "the bridge has the USB ID that the rules know it by");
    assert!(read("packaging/c/zerorate.pc").contains("-lzerorate_c"));
    assert!(read("packaging/c/zerorate-config.cmake").contains("libzerorate_c.a"));
    assert!(read("bindings/c/Cargo.toml").contains("name = \"zerorate_c\""));
}

#[test]
fn files_of_trials_and_licences_exist() {
    let trial = read("lab/src/dist/trial.rs");
    let cited = trial.split('"').filter(|text| text.starts_with("crates/"));
    assert_eq!(cited.filter(|path| root().join(path).is_file()).count(), 1, "the log that every machine reads");
    for licence in ["LICENSE-MIT", "LICENSE-APACHE", "LICENSE-OFL-Inter.txt"] {
        assert!(root().join("bindings/python").join(licence).is_file(), "{licence} of the wheel leads nowhere");
    }
}

/// The WebAssembly module and the program that makes its bindings must use the same version of wasm-bindgen, because
/// the format between them changes with every version.
#[test]
fn bindings_are_made_by_the_version_that_the_module_has() {
    let module = locked("Cargo.lock", "wasm-bindgen");
    assert_eq!(module.len(), 1);
    assert_eq!(module, locked("lab/tools/Cargo.lock", "wasm-bindgen-cli-support"));
}

/// The line `version = "…"` of each entry of a crate in a lock file.
fn locked(lock: &str, name: &str) -> Vec<String> {
    let text = read(lock);
    let lines: Vec<&str> = text.lines().collect();
    let named = format!("name = \"{name}\"");
    lines.windows(2).filter(|pair| pair[0] == named).map(|pair| pair[1].to_owned()).collect()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

fn minor() -> &'static str {
    env!("CARGO_PKG_VERSION").rsplit_once('.').unwrap().0
}
