//! Metrics for Prometheus about the device and its viewers, from the same snapshot that a page gets.

use super::answer::{self, Answer};
use super::server::Server;
use super::watch;
use hyper::StatusCode;
use serde_json::Value;
use std::fmt::Write as _;

pub async fn metrics(server: &Server) -> Answer {
    match text_of(server).await {
        Some(text) => answer::typed(StatusCode::OK, "text/plain; version=0.0.4; charset=utf-8", text),
        None => answer::text(StatusCode::SERVICE_UNAVAILABLE, "the device is not read any more\n"),
    }
}

/// The metrics as text; `None` if the session has ended.
pub async fn text_of(server: &Server) -> Option<String> {
    let subscription = watch::subscribe(&server.requests).await?;
    Some(text(&head(&subscription.snapshot)?, server.watchers()))
}

/// Parses the header of a frame (docs/formats/page.md); `None` if it is malformed.
fn head(frame: &[u8]) -> Option<Value> {
    let (length, rest) = frame.split_first_chunk()?;
    serde_json::from_slice(rest.get(..u32::from_le_bytes(*length) as usize)?).ok()
}

/// Metrics of the device: name, kind, help, and JSON pointer into the header.
const OF_THE_DEVICE: [(&str, &str, &str, &str); 8] = [
    ("samples_total", "counter", "Samples read since the device was opened.", "/ledger/samples"),
    ("samples_lost_total", "counter", "Samples lost, as the part and the host count them.", "/ledger/lost"),
    ("samples_missed_total", "counter", "Samples read but not shown on the page.", "/ledger/missed"),
    ("impossible_readings_total", "counter", "Readings that the part cannot have made.", "/ledger/impossible"),
    ("out_of_range_readings_total", "counter", "Readings beyond the range.", "/ledger/out_of_range"),
    ("sample_rate_hertz", "gauge", "Samples a second.", "/ledger/rate_hz"),
    ("data_ready_hertz", "gauge", "Edges of data ready a second.", "/ledger/rdy_hz"),
    ("temperature_celsius", "gauge", "Mean of the last second.", "/now/temp_c"),
];

/// Metrics of each axis: name, help, and JSON pointer into the axis's values.
const OF_AN_AXIS: [(&str, &str, &str); 2] = [
    ("rate_dps", "Mean angular rate of the last second, degrees per second.", "/rate_dps"),
    ("corrected_rate_dps", "The same with the calibration that is applied.", "/corrected_dps"),
];

fn text(head: &Value, watchers: usize) -> String {
    let mut text = String::new();
    let mut declare = |name: &str, kind: &str, help: &str, rows: &[(String, f64)]| {
        if rows.is_empty() {
            return;
        }
        let _ = writeln!(text, "# HELP zerorate_{name} {help}\n# TYPE zerorate_{name} {kind}");
        for (labels, value) in rows {
            let _ = writeln!(text, "zerorate_{name}{labels} {value}");
        }
    };
    let state = head.pointer("/device/state/is").and_then(Value::as_str);
    let up = if state == Some("reading") { 1.0 } else { 0.0 };
    declare("up", "gauge", "1 while samples come.", &[(String::new(), up)]);
    declare("watchers", "gauge", "Pages that look on.", &[(String::new(), watchers as f64)]);
    for (name, kind, help, at) in OF_THE_DEVICE {
        let value = head.pointer(at).and_then(Value::as_f64);
        let rows: Vec<_> = value.map(|value| (String::new(), value)).into_iter().collect();
        declare(name, kind, help, &rows);
    }
    let list = |at| head.pointer(at).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    for (name, help, at) in OF_AN_AXIS {
        let named = list("/device/axes").iter().zip(list("/now/axes"));
        let rows: Vec<_> = named
            .filter_map(|(about, now)| {
                let axis = about["name"].as_str()?;
                Some((format!("{{axis=\"{}\"}}", escaped(axis)), now.pointer(at)?.as_f64()?))
            })
            .collect();
        declare(name, "gauge", help, &rows);
    }
    text
}

/// Escapes the name of an axis, which comes from a file.
fn escaped(label: &str) -> String {
    label.replace('\\', r"\\").replace('"', "\\\"").replace('\n', r"\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn known_values_are_listed_and_unknown_ones_left_out() {
        let header = json!({
            "device": {"state": {"is": "reading"}, "axes": [{"name": "y\"aw"}]},
            "ledger": {"samples": 12, "lost": 1, "rate_hz": 5692.5},
            "now": {"temp_c": null, "axes": [{"rate_dps": -0.25, "corrected_dps": null}]},
        });
        let json = header.to_string();
        let frame = [&(json.len() as u32).to_le_bytes(), json.as_bytes(), &[0; 8]].concat();
        let text = text(&head(&frame).unwrap(), 3);
        for line in ["up 1", "watchers 3", "samples_total 12", "samples_lost_total 1", "sample_rate_hertz 5692.5"] {
            assert!(text.contains(&format!("\nzerorate_{line}\n")), "{line}\n{text}");
        }
        assert!(text.contains("zerorate_rate_dps{axis=\"y\\\"aw\"} -0.25\n"), "{text}");
        assert!(!text.contains("corrected") && !text.contains("celsius"), "{text}");
        assert!(head(&[1, 0, 0]).is_none() && head(&[255, 255, 255, 255, b'{']).is_none());
    }
}
