//! One row for each warning and refusal: its code, its text, and what `zerorate explain` says about the code.

use core::fmt;

/// The meaning of a code, for any numbers of the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// The code that a warning begins with, and that a refusal names.
    pub code: &'static str,
    /// How severe it is.
    pub says: Says,
    /// The commands of `zerorate` that print it.
    pub by: &'static [&'static str],
    /// The observation.
    pub seen: &'static str,
    /// Why it matters.
    pub matters: &'static str,
    /// The remedy.
    pub remedy: &'static str,
    /// An example of a command that helps or looks further; empty where there is none.
    pub command: &'static str,
}

/// How severe a code is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Says {
    /// The result stands.
    Warning,
    /// There is no result.
    Refusal,
    /// A warning or a refusal, depending on the size of the problem.
    Either,
}

impl fmt::Display for Says {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Refusal => "refusal",
            Self::Either => "warning or refusal",
        })
    }
}

/// Makes `code()`, `text()`, `codes()` and `EXPLANATIONS` of an enum from one row for each variant.
///
/// The rows are the arms of a `match`: rustfmt formats them, and the compiler asks for the row of a new variant.
/// * `code`: a literal, or in braces an expression with a field of the variant.
/// * `text`: `format_args!` with the fields of the variant.
/// * From `says` on: the fields of [`Explanation`], of which `command` may be left out. One of the rows of a code has
///   them.
#[doc(hidden)]
#[macro_export]
macro_rules! rows {
    (match $name:ident {
        $($variant:pat => Row {
            code: $code:tt,
            text: $text:expr
            $(, says: $says:expr, by: $by:expr, seen: $seen:expr, matters: $matters:expr, remedy: $remedy:expr
                $(, command: $command:expr)?)? $(,)?
        },)+
    }) => {
        #[allow(unused_variables, reason = "not every part of a row uses every field of its variant")]
        impl $name {
            /// The meaning of each code.
            pub const EXPLANATIONS: &'static [$crate::Explanation] = &[$($($crate::Explanation {
                code: $code,
                says: $says,
                by: $by,
                seen: $seen,
                matters: $matters,
                remedy: $remedy,
                command: concat!("" $(, $command)?),
            },)?)+];

            /// The codes of the rows, in their order; several rows may share one.
            pub fn codes() -> impl Iterator<Item = &'static str> {
                [$($crate::rows!(@literal $code)),+].into_iter().flatten()
            }

            /// Short stable name, for scripts.
            #[must_use]
            pub fn code(&self) -> &'static str {
                match *self {
                    $($variant => $code,)+
                }
            }

            fn text(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match *self {
                    $($variant => f.write_fmt($text),)+
                }
            }
        }
    };
    (@literal $code:literal) => { Some($code) };
    (@literal $of_a_field:tt) => { None };
}
