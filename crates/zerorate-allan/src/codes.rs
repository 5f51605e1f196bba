//! Short stable names of what can be said, for scripts and for whoever looks them up.

/// Gives an enum `code()` and `CODES` from one table, so that neither can lack a variant. Variants that take
/// theirs from what is in them stand behind a semicolon.
#[doc(hidden)]
#[macro_export]
macro_rules! codes {
    ($name:ident { $($variant:ident => $code:literal),+ $(,)? $(; $pattern:pat => $inner:expr)? }) => {
        impl $name {
            /// All codes of its own, in the order of the variants; the same code may stand for several of them.
            pub const CODES: &'static [&'static str] = &[$($code),+];

            /// Short stable name, for scripts.
            #[must_use]
            pub fn code(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $code,)+
                    $($pattern => $inner,)?
                }
            }
        }
    };
}
