//! Reports features that this build lacks.

use std::fmt;

/// A part of the program that is not in this build, and the feature of `zerorate-cli` that adds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotBuiltIn {
    /// The name of the missing part, as in "built without …".
    pub what: &'static str,
    /// The Cargo feature that adds the part.
    pub feature: &'static str,
}

impl NotBuiltIn {
    /// Parquet captures and logs.
    pub const PARQUET: Self = Self { what: "Parquet", feature: "parquet" };
    /// Zstandard compression of a whole file or inside a file.
    pub const ZSTD: Self = Self { what: "Zstandard", feature: "zstd" };
}

impl fmt::Display for NotBuiltIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, feature } = self;
        if cfg!(target_family = "wasm") {
            return write!(f, "the page in a browser does not read {what}; the program zerorate does");
        }
        write!(
            f,
            "this program was built without {what} (feature `{feature}`): `cargo install --path crates/zerorate-cli \
             --features full` adds it"
        )
    }
}
