//! The forms of an export, as the table that every front end lists.

/// A form in which a calibration is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "their rows say what they are")]
pub enum ExportForm {
    C,
    Rust,
    Csv,
    Json,
    Px4,
    Ardupilot,
}

/// The names, file type and help text of a form.
#[derive(Clone, Copy, Debug)]
pub struct FormRow {
    /// Its name as an option.
    pub name: &'static str,
    /// Its name as people write it.
    pub label: &'static str,
    /// The ending of its files, without a point.
    pub extension: &'static str,
    /// The media type of its files.
    pub media_type: &'static str,
    /// A one-line description.
    pub help: &'static str,
}

impl ExportForm {
    /// All forms.
    pub const ALL: [Self; 6] = [Self::C, Self::Rust, Self::Csv, Self::Json, Self::Px4, Self::Ardupilot];

    /// The form with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|form| form.row().name == name)
    }

    /// Whether the form is source code, whose names take a prefix.
    #[must_use]
    pub const fn is_code(self) -> bool {
        matches!(self, Self::C | Self::Rust)
    }

    /// Whether the form holds parameters for one gyroscope of a flight controller.
    #[must_use]
    pub const fn is_autopilot(self) -> bool {
        matches!(self, Self::Px4 | Self::Ardupilot)
    }

    /// The form's row of the table.
    #[must_use]
    pub const fn row(self) -> FormRow {
        let (name, label, extension, media_type, help) = match self {
            Self::C => ("c", "C", "h", "text/x-c", "A C99 header that needs nothing but <stdbool.h> and <stdint.h>"),
            Self::Rust => ("rust", "Rust", "rs", "text/rust", "A Rust module without dependencies, no_std"),
            Self::Csv => (
                "csv",
                "CSV",
                "csv",
                "text/csv",
                "The table: delta_c,correction_dps; several axes: delta_c,x_correction_dps,y_correction_dps,…",
            ),
            Self::Json => ("json", "JSON", "json", "application/json", "Coefficients and table"),
            Self::Px4 => (
                "px4",
                "PX4",
                "params",
                "text/plain",
                "Parameters of PX4, TC_Gn_…: the bias of three axes, cubic about the middle of the temperatures",
            ),
            Self::Ardupilot => (
                "ardupilot",
                "ArduPilot",
                "param",
                "text/plain",
                "Parameters of ArduPilot, INS_TCALn_…: the same about its 35 °C",
            ),
        };
        FormRow { name, label, extension, media_type, help }
    }
}
