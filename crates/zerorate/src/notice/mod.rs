//! What a measurement has to say beside its numbers: warnings, and the refusals that end it.

mod deviation;
mod refusal;
mod warning;

pub use refusal::Refusal;
pub use warning::Warning;

use crate::remedy::Remedy;

/// Makes `remedies()` as well of rows that are otherwise those of [`zerorate_allan::rows!`].
macro_rules! rows_with_remedies {
    (match $name:ident {
        $($variant:pat => Row {
            code: $code:tt,
            text: $text:expr,
            remedies: $remedies:expr
            $(, $part:ident: $value:expr)* $(,)?
        },)+
    }) => {
        zerorate_allan::rows!(match $name {
            $($variant => Row { code: $code, text: $text $(, $part: $value)* },)+
        });

        #[allow(unused_variables, reason = "few remedies depend on a field of the variant")]
        impl $name {
            /// What to do about it, the best first.
            #[must_use]
            pub fn remedies(&self) -> &'static [Remedy] {
                match *self {
                    $($variant => $remedies,)+
                }
            }
        }
    };
}
use rows_with_remedies;

/// What to do where no temperature was read.
const fn more_temperatures(wrong_edge: bool) -> &'static [Remedy] {
    if wrong_edge { &[Remedy::OtherEdge] } else { &[Remedy::ReadTemperatureMore] }
}

/// Why no temperature was read, as far as the edges tell.
pub(crate) const fn because_of(wrong_edge: bool) -> &'static str {
    if wrong_edge { ": two edges of data ready were heard for each sample, each before its data" } else { "" }
}
