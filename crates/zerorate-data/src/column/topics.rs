//! What a bag with several IMUs has to choose from, as a table.

use super::imu::{Encoding, Head};
use std::collections::BTreeMap;

/// What was seen of the topics with an IMU, by name.
#[derive(Debug, Default)]
pub struct Survey(BTreeMap<String, Topic>);

/// What was seen of one.
#[derive(Debug, Default)]
struct Topic {
    kind: String,
    frame: Option<String>,
    messages: u64,
    /// Stamps of the first and the last message.
    span_ns: Option<(i64, i64)>,
}

impl Survey {
    /// A topic that is there, with messages or without.
    pub fn topic(&mut self, name: &str, kind: &str) {
        self.0.entry(name.to_owned()).or_insert_with(|| Topic { kind: kind.to_owned(), ..Topic::default() });
    }

    /// A topic whose messages were counted elsewhere, with the times of the first and the last.
    pub fn counted(&mut self, name: &str, kind: &str, messages: u64, [first_ns, last_ns]: [i64; 2]) {
        let span_ns = (messages > 0).then_some((first_ns, last_ns));
        self.0.insert(name.to_owned(), Topic { kind: kind.to_owned(), frame: None, messages, span_ns });
    }

    /// A message of a topic; one that makes no sense is counted.
    pub fn message(&mut self, name: &str, kind: &str, encoding: Option<Encoding>, message: &[u8]) {
        let head = encoding.and_then(|encoding| Head::of(encoding, message));
        self.topic(name, kind);
        let Some(topic) = self.0.get_mut(name) else { return };
        topic.messages += 1;
        let Some(Head { stamp_ns, frame }) = head else { return };
        let (first, last) = topic.span_ns.unwrap_or((stamp_ns, stamp_ns));
        topic.span_ns = Some((first.min(stamp_ns), last.max(stamp_ns)));
        topic.frame.get_or_insert(frame);
    }

    /// A head, and a row for each topic.
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
