//! Results that must stay as they are, bit for bit.
//!
//! A difference is either a defect or an intended change of a result, which CHANGELOG.md must state. After an intended
//! change, `ZERORATE_GOLDEN=write cargo test -p zerorate --all-features` writes the files anew.

use std::fs;
use std::path::Path;

/// Asserts that `now` equals the golden file `name`. With ZERORATE_GOLDEN=write, first writes `now` to that file.
#[track_caller]
pub fn unchanged(name: &str, now: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/core/golden/{name}"));
    if std::env::var_os("ZERORATE_GOLDEN").is_some_and(|value| value == "write") {
        fs::write(&path, now).unwrap();
    }
    assert_eq!(now, fs::read_to_string(&path).unwrap(), "{name} has changed");
}
