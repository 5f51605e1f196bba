//! Notices of a measurement: warnings about its result, and refusals, which end it.

mod deviation;
mod refusal;
mod remedy;
mod warning;

pub use deviation::{Deviation, Finding};
pub use refusal::Refusal;
pub use remedy::Remedy;
pub use warning::{Warning, standing_place};

/// Generates `remedies()` in addition to the items of [`zerorate_allan::rows!`].
macro_rules! rows_with_remedies {
    (match $name:ident {
        $($variant:pat => Row {
            code: $code:tt,
            text: $text:expr,
            remedies: $remedies:expr $(,)?
        },)+
    }) => {
        zerorate_allan::rows!(match $name {
            $($variant => Row { code: $code, text: $text },)+
        });

        #[allow(unused_variables, reason = "few remedies depend on a field of the variant")]
        impl $name {
            /// The remedies, the best first.
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

/// The remedies for a temperature that was not read.
const fn more_temperatures(wrong_edge: bool) -> &'static [Remedy] {
    if wrong_edge { &[Remedy::OtherEdge] } else { &[Remedy::ReadTemperatureMore] }
}

/// The reason why no temperature was read, if the edges of data ready show it.
pub(crate) const fn because_of(wrong_edge: bool) -> &'static str {
    if wrong_edge { ", since data ready has two edges for each sample" } else { "" }
}
