//! Checks that wasm-bindgen has the same version in Cargo.lock, for the module of the page, and in
//! lab/tools/Cargo.lock, for the tool that makes its bindings.

use std::fs;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The line `version = "…"` of each entry of a crate in a lock file.
fn locked(lock: &str, name: &str) -> Vec<String> {
    let text = fs::read_to_string(project().join(lock)).expect("a lock file");
    let lines: Vec<&str> = text.lines().collect();
    let named = format!("name = \"{name}\"");
    lines.windows(2).filter(|pair| pair[0] == named).map(|pair| pair[1].to_owned()).collect()
}

/// The WebAssembly module and the program that makes its bindings must use the same version of wasm-bindgen, because
/// the format between them changes with every version.
#[test]
fn bindings_are_made_by_the_version_that_the_module_has() {
    let module = locked("Cargo.lock", "wasm-bindgen");
    assert_eq!(module.len(), 1);
    assert_eq!(module, locked("lab/tools/Cargo.lock", "wasm-bindgen-cli-support"));
}
