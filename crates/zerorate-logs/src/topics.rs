//! The topics with an IMU in a bag, a PX4 log or an ArduPilot log, as a table to choose from.

use crate::error::LogError;
use crate::query::ColumnQuery;
use crate::setting::Setting;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Debug, Default)]
pub struct Survey(pub(super) BTreeMap<String, Topic>);

/// A topic, as far as its messages were read.
#[derive(Debug, Default)]
pub struct Topic {
    pub kind: String,
    pub frame: Option<String>,
    pub messages: u64,
    /// Stamps of the first and the last message, in a bag the least and the largest stamp, ns.
    pub span_ns: Option<(i64, i64)>,
}

impl Survey {
    /// Adds a topic whose messages were counted elsewhere, with the times of the first and the last message.
    pub fn counted(&mut self, name: &str, kind: &str, messages: u64, [first_ns, last_ns]: [i64; 2]) {
        let span_ns = (messages > 0).then_some((first_ns, last_ns));
        self.0.insert(name.to_owned(), Topic { kind: kind.to_owned(), frame: None, messages, span_ns });
    }

    pub fn table(&self) -> Vec<String> {
        let head = ["topic", "type", "messages", "rate", "duration", "frame_id"].map(str::to_owned);
        let rows: Vec<[String; 6]> = self.0.iter().map(|(name, topic)| topic.row(name)).collect();
        let all = || std::iter::once(&head).chain(&rows);
        let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..head.len()).map(width).collect();
        let line = |row: &[String; 6]| {
            let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
            format!("  {}", cells.collect::<Vec<_>>().join("  ").trim_end())
        };
        all().map(line).collect()
    }
}

/// The error for several IMUs if none of them was chosen, or if the chosen topic has no IMU.
pub fn several(path: &Path, asked: &ColumnQuery<'_>, survey: &Survey) -> LogError {
    let (path, option) = (path.display(), asked.args.names.of(Setting::Topic));
    let why = match &asked.args.topic {
        Some(topic) => format!("has no IMU on a topic `{topic}`"),
        None => "has several IMUs".to_owned(),
    };
    let topics = survey.0.keys().cloned().collect();
    LogError::Choose { question: format!("{path} {why}; choose one with {option}:"), table: survey.table(), topics }
}

impl Topic {
    fn row(&self, name: &str) -> [String; 6] {
        let unknown = || "?".to_owned();
        let span_s = self.span_ns.map(|(first, last)| last.saturating_sub(first) as f64 * 1e-9).filter(|s| *s > 0.0);
        let rate = span_s.map(|span_s| format!("{:.2} Hz", self.messages.saturating_sub(1) as f64 / span_s));
        let printable = |text: &str| text.escape_debug().to_string();
        [
            printable(name),
            printable(&self.kind),
            self.messages.to_string(),
            rate.unwrap_or_else(unknown),
            span_s.map_or_else(unknown, |span_s| format!("{span_s:.1} s")),
            self.frame.as_deref().filter(|frame| !frame.is_empty()).map_or_else(unknown, printable),
        ]
    }
}
