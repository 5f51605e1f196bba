//! What there is to know of an export.

use std::fmt;
use zerorate_allan::{Says, rows};

/// The export stands, but there is something to know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows, with their units")]
pub enum ExportWarning {
    /// The calibration does not state where it holds: so far from T3 was assumed.
    NoValidity { temp_min_c: f64, temp_max_c: f64, assumed_c: f64 },
    /// The table ends before the calibration; `axis` names the axis where there are several.
    TableShort { axis: Option<String>, span_c: f64, temp_min_c: f64, temp_max_c: f64, wrong_dps: f64 },
}

rows!(match ExportWarning {
    Self::NoValidity { temp_min_c, temp_max_c, assumed_c } => Row {
        code: "no-validity",
        text: format_args!(
            "the calibration states no [validity], so nothing says where it holds: the export takes {temp_min_c:.1} … \
             {temp_max_c:.1} °C, T3 ± {assumed_c} °C, as valid; state temp_min_c and temp_max_c in the file"
        ),
        says: Says::Warning,
        by: &["export"],
        seen: "A calibration states no [validity].",
        matters: "Nothing says at which temperatures it holds; the export takes a range around T3 that is an \
            assumption.",
        remedy: "State temp_min_c and temp_max_c in the file, or calibrate anew: every calibration that is measured \
            states them.",
    },
    Self::TableShort { ref axis, span_c, temp_min_c, temp_max_c, wrong_dps } => Row {
        code: "table-short",
        text: format_args!(
            "{}the table ends {span_c} °C from T3, the calibration holds for {temp_min_c:.1} … {temp_max_c:.1} °C: \
             beyond the table the row at its end is wrong by up to {wrong_dps:.2} °/s, and the look-up says that it \
             is outside; leave the span out to cover the range",
            axis.as_ref().map(|name| format!("axis {name}: ")).unwrap_or_default()
        ),
        says: Says::Warning,
        by: &["export"],
        seen: "The table of an export ends before the calibration does.",
        matters: "Beyond the table the row at its end is used, which is wrong by as much as the text says; the \
            look-up says that it is outside.",
        remedy: "Leave the span out, and the table covers the whole range; or take larger steps.",
        command: "zerorate export unit.toml --format c -o unit.h",
    },
});

impl fmt::Display for ExportWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}
