//! Warnings about an export.

use std::fmt;
use zerorate_allan::{Says, rows};

/// A warning about an export that was made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows, with their units")]
pub enum ExportWarning {
    /// The calibration does not state its range: `assumed_c` on both sides of T3 is assumed.
    NoValidity { temp_min_c: f64, temp_max_c: f64, assumed_c: f64 },
    /// The table ends before the range of the calibration. `axis` is the name of the axis if there are several.
    TableShort { axis: Option<String>, span_c: f64, temp_min_c: f64, temp_max_c: f64, wrong_dps: f64 },
}

rows!(match ExportWarning {
    Self::NoValidity { temp_min_c, temp_max_c, assumed_c } => Row {
        code: "no-validity",
        text: format_args!(
            "the file states no [validity]; {temp_min_c:.1} … {temp_max_c:.1} °C (T3 ± {assumed_c}) is assumed; \
             state it"
        ),
        says: Says::Warning,
        by: &["export"],
        seen: "A calibration file states no [validity].",
        matters: "Nothing says at which temperatures the calibration holds. The export assumes a range around T3.",
        remedy: "State temp_min_c and temp_max_c under [validity] in the file, or calibrate again: every measured \
            calibration states them.",
    },
    Self::TableShort { ref axis, span_c, temp_min_c, temp_max_c, wrong_dps } => Row {
        code: "table-short",
        text: format_args!(
            "{}the table ends {span_c} °C from T3, wrong by up to {wrong_dps:.2} °/s beyond; omit the span",
            axis.as_ref().map(|name| format!("{name}: ")).unwrap_or_default()
        ),
        says: Says::Warning,
        by: &["export"],
        seen: "The table of an export ends before the temperature range of the calibration, which is in its \
            [validity].",
        matters: "Beyond the table, the look-up takes the row at its end and reports that it is outside. That row is \
            wrong by as much as the warning says.",
        remedy: "Leave the span out, and the table covers the whole range. Larger steps keep it small.",
        command: "zerorate export unit.toml --format c -o unit.h",
    },
});

impl fmt::Display for ExportWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_warning_is_one_short_line() {
        let (temp_min_c, temp_max_c) = (22.5, 40.5);
        let axis = Some("gyro_z".to_owned());
        for warning in [
            ExportWarning::NoValidity { temp_min_c, temp_max_c, assumed_c: 9.0 },
            ExportWarning::TableShort { axis: None, span_c: 0.12, temp_min_c, temp_max_c, wrong_dps: 0.31 },
            ExportWarning::TableShort { axis, span_c: 0.12, temp_min_c, temp_max_c, wrong_dps: 0.31 },
        ] {
            let line = format!("{}: {warning}", warning.code());
            assert!(line.chars().count() <= 100, "{} characters: {line}", line.chars().count());
        }
    }
}
