//! A log that was dropped on the page: its content, its noise, its bias over temperature, and files made from them.
//!
//! [`LogReader::look`] reads the log and keeps its columns. They are then analysed one by one, so that the caller can
//! show progress.

#[cfg(feature = "readers")]
mod axis;
#[cfg(feature = "readers")]
mod bias;
pub mod message;
#[cfg(feature = "readers")]
mod settings;

#[cfg(feature = "readers")]
pub use reader::LogReader;

#[cfg(feature = "readers")]
mod reader {
    use super::bias::Bias;
    use super::message::{
        LogAbout, LogAxis, LogBias, LogInspection, LogSetting, LogSettings, LogSummary, NoiseFileCommand,
    };
    use super::settings::{LABELS, asked_for, combine, format};
    use super::{axis, settings};
    use crate::message::Download;
    use std::path::{Path, PathBuf};
    use std::vec::IntoIter;
    use zerorate_allan::{FitOptions, Options, Taus};
    use zerorate_imu::{AnalysisOptions, Detrending, Record};
    use zerorate_imu::{Axes, ImuOptions, ImuWarning, NoNoiseFile, NoiseFileOptions, Rule};
    use zerorate_input::Input;
    use zerorate_logs::{Column, ColumnSelection, LogError, LogWarning, Setting};

    /// A log that was read.
    pub struct LogReader {
        path: PathBuf,
        topic: Option<String>,
        warnings: Vec<String>,
        temperature: Option<Column>,
        bias: Option<Bias>,
        waiting: IntoIter<Column>,
        analysed: Vec<Record>,
    }

    impl LogReader {
        /// Reads the log of this name. Returns its facts and a reader, or else a question or a refusal. `open` opens
        /// the log from its start.
        pub fn look(name: &str, open: impl Fn() -> Input, said: &LogSettings) -> (LogInspection, Option<Self>) {
            let path = Path::new(name);
            match read(path, &open, said) {
                Ok((about, reader)) => (LogInspection::Log(about), Some(reader)),
                Err(LogError::Choose { question: text, table: choices, .. }) => {
                    let settings = asked_for(&text);
                    (LogInspection::Question { text, choices, settings }, None)
                }
                Err(LogError::Ask(text)) if !asked_for(&text).is_empty() => {
                    let text = with_next(text, path, &open, said);
                    let settings = asked_for(&text);
                    (LogInspection::Question { text, choices: Vec::new(), settings }, None)
                }
                Err(error) => (LogInspection::Refused { text: error.to_string() }, None),
            }
        }

        /// Number of columns that remain to be analysed.
        #[must_use]
        pub fn left(&self) -> usize {
            self.waiting.len()
        }

        /// Analyses the next column; `None` if none is left.
        ///
        /// # Errors
        /// Returns the reason why the noise of the column cannot be analysed.
        pub fn analyse(&mut self) -> Result<Option<LogAxis>, String> {
            let Some(column) = self.waiting.next() else { return Ok(None) };
            let options = AnalysisOptions {
                deviations: Options { taus: Taus::Fine, ..Options::default() },
                fit: Some(FitOptions::default()),
                draws: true,
                detrending: Detrending { order: None, names: LABELS },
                ..AnalysisOptions::default()
            };
            let record = Record::of(column, &self.path, &options, self.temperature.as_ref());
            let record = record.map_err(|error| error.to_string())?;
            let message = axis::message(&record);
            self.analysed.push(record);
            Ok(Some(message))
        }

        /// The bias over temperature, or the reason why there is none. `None` if the log has no temperature that
        /// changes enough, and in each call but the first.
        pub fn bias(&mut self) -> Option<LogBias> {
            self.bias.take().map(|bias| bias.message(&self.path, &self.warnings))
        }

        /// The summary of all axes. Call it after the last column was analysed.
        #[must_use]
        pub fn summary(&self) -> LogSummary {
            let doubts = Record::doubts(&self.analysed);
            let no_noise_file = match doubts.code() {
                Some(_) => Some(doubts.to_string()),
                None => Record::axes(&self.analysed).is_empty().then(|| NoNoiseFile::NoAxis.to_string()),
            };
            LogSummary { pictures: axis::pictures(&self.analysed), warnings: self.findings(), no_noise_file }
        }

        /// Warnings about several axes.
        fn findings(&self) -> Vec<String> {
            Record::motion(&self.analysed).iter().map(ImuWarning::coded).collect()
        }

        /// Warnings about single axes, with the name of the axis in each.
        fn of_axes(&self) -> impl Iterator<Item = String> {
            let of_axis = |record: &Record| -> Vec<String> {
                let named = |line: String| line.replacen(": ", &format!(": {}: ", record.column), 1);
                record.notes.iter().map(LogWarning::coded).chain(record.noise_warnings().map(named)).collect()
            };
            self.analysed.iter().flat_map(of_axis)
        }

        /// Makes the file for a filter.
        ///
        /// # Errors
        /// Returns an error if the command is invalid, the numbers are not a valid result, or the log lacks axes.
        pub fn noise_file(&self, command: &NoiseFileCommand) -> Result<Download, String> {
            let (format, combine) = (format(&command.format)?, combine(&command.combine)?);
            let (axes, doubts) = (Record::axes(&self.analysed), Record::doubts(&self.analysed));
            let (log, topic) = (self.path.display().to_string(), self.topic.clone());
            let (inflate, rule) = (command.inflate, Rule::Covers(None));
            let all = self.warnings.iter().cloned().chain(self.findings()).chain(self.of_axes());
            let warnings = NoiseFileOptions::mattering(all);
            let choice = NoiseFileOptions { log, topic, combine, rule, inflate, names: LABELS, warnings };
            Ok(Download {
                name: format!("imu-{}.yaml", format.name()),
                media_type: "application/yaml".to_owned(),
                text: format.file(choice, &axes, &doubts, command.accept_rejected).map_err(|why| why.to_string())?,
            })
        }
    }

    /// Appends the next question to a question about the time, so that the user answers both at once.
    fn with_next(text: String, path: &Path, open: &impl Fn() -> Input, said: &LogSettings) -> String {
        let of_time = [LogSetting::RateHz, LogSetting::TimeColumn, LogSetting::TimeUnit];
        if said.rate_hz.is_some() || !asked_for(&text).iter().all(|setting| of_time.contains(setting)) {
            return text;
        }
        let with_rate = LogSettings { rate_hz: Some(1.0), ..said.clone() };
        match read(path, open, &with_rate) {
            Err(LogError::Ask(next)) if !asked_for(&next).is_empty() => format!("{text}. {next}"),
            _ => text,
        }
    }

    fn read(
        path: &Path,
        open: &impl Fn() -> Input,
        said: &LogSettings,
    ) -> zerorate_logs::Result<(LogAbout, LogReader)> {
        let form = zerorate_logs::kind(path, open())?;
        let options = settings::options(said)?;
        let wanted = options.columns.as_deref().map_or(ColumnSelection::All, ColumnSelection::Listed);
        let columns = zerorate_logs::read_all(path, open(), wanted, &options.log);
        let named = said.temp_column.as_deref();
        let temperature = zerorate_logs::temperature(named, Some(open()), |names| {
            zerorate_logs::read_all(path, open(), ColumnSelection::Listed(names), &options.log)
        });
        if let (Some(name), None) = (named, &temperature) {
            let of = LABELS.of(Setting::TempColumn);
            return Err(LogError::Ask(format!("{of}: the log has no column {name:?} of numbers")));
        }
        let axes = match columns {
            // several topics or interleaved rows may belong to the sensors of one IMU, which this call joins
            Err(LogError::Choose { .. } | LogError::Merged { .. }) => {
                Axes::read(path, vec![(path.to_owned(), open())], &options)?
            }
            columns => of_imu_or_any(path, columns?, &options)?,
        };
        let of_axes = of_bias(&axes).filter(|_| named.is_none());
        let bias = of_axes.or(temperature.as_ref()).and_then(|temperature| {
            let bias = Bias::of(path, open, &axes.columns, temperature, &options.log);
            let bias = bias.unwrap_or_else(|error| Some(Bias::Elsewhere(error.to_string())));
            bias.or_else(|| named.map(Bias::unfit))
        });
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
        let warnings = about.warnings.clone();
        let waiting = axes.columns.into_iter();
        let (path, topic, analysed) = (path.to_owned(), axes.topic, Vec::new());
        let reader = LogReader { path, topic, warnings, temperature, bias, waiting, analysed };
        Ok((about, reader))
    }

    /// The temperature that is logged with the axes, if there is exactly one.
    fn of_bias(axes: &Axes) -> Option<&Column> {
        <&[Column; 1]>::try_from(&axes.temperatures[..]).ok().map(|[only]| only)
    }

    /// The axes of an IMU. If the log has none, all its columns in their own units.
    fn of_imu_or_any(path: &Path, mut columns: Vec<Column>, options: &ImuOptions) -> zerorate_logs::Result<Axes> {
        if Axes::are_among(&columns) {
            return Axes::of(path, columns, options);
        }
        let warnings = columns.iter_mut().flat_map(|column| std::mem::take(&mut column.warnings)).collect();
        Ok(Axes { columns, temperatures: Vec::new(), topic: None, warnings })
    }

    /// The number of samples, including missing ones.
    fn length(column: &Column) -> u64 {
        match column.series {
            zerorate_logs::Series::Codes(ref codes) => codes.len() as u64 + column.missing(),
            zerorate_logs::Series::Numbers(ref numbers) => numbers.len() as u64,
        }
    }
}
