//! Warnings about an export.

use zerorate_allan::rows;

/// A warning about an export. The file was written.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows, with their units")]
pub enum ExportWarning {
    /// The calibration does not state its temperature range. T3 ± `assumed_c` is assumed.
    NoValidity { temp_min_c: f64, temp_max_c: f64, assumed_c: f64 },
    /// The table stops at `span_c` from T3, inside the calibrated range, and is wrong by up to `wrong_dps` beyond.
    /// `axis` is the name of the axis if there are several.
    TableShort { axis: Option<String>, span_c: f64, temp_min_c: f64, temp_max_c: f64, wrong_dps: f64 },
}

rows!(match ExportWarning as Display {
    Self::NoValidity { temp_min_c, temp_max_c, assumed_c } => Row {
        code: "no-validity",
        text: format_args!(
            "the file states no [validity]; {temp_min_c:.1} … {temp_max_c:.1} °C (T3 ± {assumed_c}) is assumed; \
             state it"
        ),
    },
    Self::TableShort { ref axis, span_c, temp_min_c, temp_max_c, wrong_dps } => Row {
        code: "table-short",
        text: format_args!(
            "{}the table ends {span_c} °C from T3, wrong by up to {wrong_dps:.2} °/s beyond; omit the span",
            axis.as_ref().map(|name| format!("{name}: ")).unwrap_or_default()
        ),
    },
});
