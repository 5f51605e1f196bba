//! The export formats, with the names and help texts that every front end shows.

/// A format in which a calibration is exported.
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

/// The names, file type and help text of a format.
#[derive(Clone, Copy, Debug)]
pub struct FormRow {
    /// The name by which options select the format, such as `px4`.
    pub name: &'static str,
    /// The name that people read, such as `PX4`.
    pub label: &'static str,
    /// The file extension, without a dot.
    pub extension: &'static str,
    /// The media type of the file.
    pub media_type: &'static str,
    /// A one-line description.
    pub help: &'static str,
}

impl ExportForm {
    /// All formats, in the order in which front ends list them.
    pub const ALL: [Self; 6] = [Self::C, Self::Rust, Self::Csv, Self::Json, Self::Px4, Self::Ardupilot];

    /// Finds the format with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|form| form.row().name == name)
    }

    /// True if the format is source code, whose identifiers can have a prefix.
    #[must_use]
    pub const fn is_code(self) -> bool {
        matches!(self, Self::C | Self::Rust)
    }

    /// True if the format holds parameters for one gyroscope of a flight controller.
    #[must_use]
    pub const fn is_autopilot(self) -> bool {
        matches!(self, Self::Px4 | Self::Ardupilot)
    }

    /// The names, file type and help text of this format.
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
