//! Defines the code and the text of each warning and refusal in one row. docs/codes.md explains the codes.

/// Makes `code()`, `text()` and `codes()` of an enum from one row for each variant.
///
/// The rows are the arms of a `match`: rustfmt formats them, and the compiler reports a variant without a row.
/// * `code`: a literal, or an expression in braces that uses a field of the variant.
/// * `text`: `format_args!` with the fields of the variant.
///
/// `match Name as Display` also implements `Display`, by the text.
#[doc(hidden)]
#[macro_export]
macro_rules! rows {
    (match $name:ident as Display { $($rows:tt)+ }) => {
        $crate::rows!(match $name { $($rows)+ });

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                self.text(f)
            }
        }
    };
    (match $name:ident {
        $($variant:pat => Row { code: $code:tt, text: $text:expr $(,)? },)+
    }) => {
        #[allow(unused_variables, reason = "not every part of a row uses every field of its variant")]
        impl $name {
            /// The codes that are literals, in the order of the rows. Several rows may share a code.
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
