//! A log that is dropped on the page: what is in it, its noise, and the file for the filter that takes it.
//!
//! Read once by [`LogReader::look`]; then a column at a time, so that whoever calls can say how far it is.

#[cfg(feature = "readers")]
mod axis;
pub mod message;
#[cfg(feature = "readers")]
mod pictures;
#[cfg(feature = "readers")]
mod settings;

#[cfg(feature = "readers")]
pub use reader::LogReader;

#[cfg(feature = "readers")]
mod reader {
    use super::axis::Analysed;
    use super::message::{LogAbout, LogAxis, LogSettings, LogSummary, Looked, NoiseFileCommand};
    use super::settings::{LABELS, asked_for, combine, format};
    use super::{axis, pictures, settings};
    use crate::message::Download;
    use std::path::{Path, PathBuf};
    use std::vec::IntoIter;
    use zerorate_allan as allan;
    use zerorate_logs::imu::{Axes, Axis, Choice, ImuOptions, Kind, Numbers};
    use zerorate_logs::{Column, LogError, LogWarning, Wanted};
    use zerorate_record::Input;

    /// A log that was read.
    pub struct LogReader {
        path: PathBuf,
        topic: Option<String>,
        waiting: IntoIter<Column>,
        analysed: Vec<Analysed>,
    }

    impl LogReader {
        /// Reads the log of this name, and says what is in it, or what it has to be told. `open` gives its bytes, each
        /// time from their start.
        pub fn look(name: &str, open: impl Fn() -> Input, said: &LogSettings) -> (Looked, Option<Self>) {
            let path = Path::new(name);
            match read(path, &open, said) {
                Ok((about, reader)) => (Looked::Log(about), Some(reader)),
                Err(LogError::Choose(text, choices)) => {
                    let settings = asked_for(&text);
                    (Looked::Question { text, choices, settings }, None)
                }
                Err(LogError::Ask(text)) if !asked_for(&text).is_empty() => {
                    let settings = asked_for(&text);
                    (Looked::Question { text, choices: Vec::new(), settings }, None)
                }
                Err(error) => (Looked::Refused { text: error.to_string() }, None),
            }
        }

        /// Columns that are not yet analysed.
        #[must_use]
        pub fn left(&self) -> usize {
            self.waiting.len()
        }

        /// Analyses the next column; none: all are.
        ///
        /// # Errors
        /// Why there is no noise in it that could be analysed.
        pub fn analyse(&mut self) -> Result<Option<LogAxis>, String> {
            let Some(column) = self.waiting.next() else { return Ok(None) };
            let analysed = axis::analyse(&self.path, column)?;
            let message = analysed.message();
            self.analysed.push(analysed);
            Ok(Some(message))
        }

        /// What all axes come to, once all are analysed.
        #[must_use]
        pub fn summary(&self) -> LogSummary {
            let no_noise_file = if self.axes().is_empty() {
                Some("no column is stated to be an axis of a gyroscope or an accelerometer".to_owned())
            } else {
                self.doubts().into_iter().reduce(|all, more| format!("{all}; {more}"))
            };
            LogSummary { pictures: pictures::of(&self.path, &self.analysed), warnings: self.motion(), no_noise_file }
        }

        /// The file for a filter.
        ///
        /// # Errors
        /// Its numbers would be no result, or the log has not the axes for it.
        pub fn noise_file(&self, command: &NoiseFileCommand) -> Result<Download, String> {
            let (format, combine) = (format(&command.format)?, combine(&command.combine)?);
            let (axes, doubts) = (self.axes(), self.doubts());
            if axes.is_empty() {
                return Err(self.summary().no_noise_file.unwrap_or_default());
            }
            if !(command.inflate > 0.0 && command.inflate.is_finite()) {
                return Err("the factor on all noise must be a number above zero".to_owned());
            }
            if !doubts.is_empty() && !command.force {
                return Err(doubts.join("; "));
            }
            let counts = Kind::ALL.map(|kind| axes.iter().filter(|axis| axis.kind == kind).count());
            if format.is_by_axis() && counts.iter().any(|count| !matches!(count, 0 | 3)) {
                return Err(format!("{} takes three axes of a kind; choose three columns", format.reader()));
            }
            let log = self.path.display().to_string();
            let (topic, inflate, names) = (self.topic.clone(), command.inflate, LABELS);
            let choice = Choice { log, topic, combine, inflate, doubts, names };
            Ok(Download {
                name: format!("imu-{}.yaml", format.name()),
                media_type: "application/yaml".to_owned(),
                text: format.text(&Numbers::new(choice, &axes)),
            })
        }

        fn axes(&self) -> Vec<Axis<'_>> {
            self.analysed.iter().filter_map(Analysed::axis).collect()
        }

        /// Why there is no result.
        fn doubts(&self) -> Vec<String> {
            self.analysed.iter().filter_map(|axis| Some(format!("{}: {}", axis.name, axis.doubt()?))).collect()
        }

        /// What happens to several axes at once.
        fn motion(&self) -> Vec<String> {
            let fitted: Vec<_> =
                self.analysed.iter().filter_map(|axis| Some((axis, axis.fit.as_ref().ok()?))).collect();
            let fits: Vec<_> = fitted.iter().map(|(_, fit)| *fit).collect();
            let moved = allan::motion(&fits);
            let words = |one: &allan::Motion| {
                let names: Vec<&str> = one.axes.iter().map(|axis| fitted[*axis].0.name.as_str()).collect();
                format!("{:.1} s ({})", one.at_s, names.join(", "))
            };
            let named: Vec<String> = moved.iter().take(NAMED).map(words).collect();
            let more = moved.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" and {more} times more") } else { String::new() };
            let line = || {
                format!(
                    "motion: several axes jump, or have a glitch, together at {}{more}: the sensor was moved or \
                     knocked, which is no noise of it; record where nothing moves, or cut the log there",
                    named.join(", ")
                )
            };
            (!moved.is_empty()).then(line).into_iter().collect()
        }
    }

    /// Moments that a line names.
    const NAMED: usize = 6;

    fn read(
        path: &Path,
        open: &impl Fn() -> Input,
        said: &LogSettings,
    ) -> zerorate_logs::Result<(LogAbout, LogReader)> {
        let form = zerorate_logs::kind(path, open())?;
        let options = settings::options(said)?;
        let wanted = options.columns.as_deref().map_or(Wanted::All, Wanted::Listed);
        let columns = zerorate_logs::read_all(path, open(), wanted, &options.log)?;
        let axes = of_imu_or_any(path, columns, &options)?;
        let first = axes.columns.first();
        let samples = first.map_or(0, length);
        let rate_hz = first.map_or(0.0, |first| first.rate_hz);
        let about = LogAbout {
            form,
            samples,
            rate_hz,
            duration_s: samples as f64 / rate_hz,
            topic: axes.topic.clone(),
            columns: axes.columns.iter().map(axis::column).collect(),
            warnings: axes.warnings.iter().map(LogWarning::coded).collect(),
        };
        let waiting = axes.columns.into_iter();
        let reader = LogReader { path: path.to_owned(), topic: axes.topic, waiting, analysed: Vec::new() };
        Ok((about, reader))
    }

    /// The axes of an IMU, or else all columns that there are, in units of their own.
    fn of_imu_or_any(path: &Path, mut columns: Vec<Column>, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
        if Axes::are_among(&columns) {
            return Axes::of(path, columns, options);
        }
        let warnings = columns.iter_mut().flat_map(|column| std::mem::take(&mut column.warnings)).collect();
        Ok(Axes { columns, topic: None, warnings })
    }

    /// With the samples that are missing.
    fn length(column: &Column) -> u64 {
        match column.series {
            zerorate_logs::Series::Codes(ref codes) => codes.len() as u64 + column.missing(),
            zerorate_logs::Series::Numbers(ref numbers) => numbers.len() as u64,
        }
    }
}
