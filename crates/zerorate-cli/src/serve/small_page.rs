//! A minimal page for a program that was built without the live page. It shows the metrics.

use super::answer::{self, Answer};
use super::metrics;
use super::server::Server;
use hyper::StatusCode;

const PAGE: &str = include_str!("small_page.html");
/// A file of its own, because the content security policy forbids scripts inside a page.
const SCRIPT: &str = include_str!("small_page.js");

pub async fn small_page(server: &Server) -> Answer {
    let text = metrics::text_of(server).await;
    answer::typed(StatusCode::OK, "text/html; charset=utf-8", filled(text.as_deref()))
}

pub fn script() -> Answer {
    answer::typed(StatusCode::OK, "text/javascript; charset=utf-8", SCRIPT)
}

/// The page with these metrics. `None` means that the session has ended.
fn filled(metrics: Option<&str>) -> String {
    let Some(metrics) = metrics else { return PAGE.replace("{numbers}", "The device is not read any more.") };
    let numbers = metrics.lines().filter_map(|line| line.strip_prefix("zerorate_")).map(rounded);
    // the name of an axis comes from a file, so it may contain HTML
    let escaped = |line: String| line.replace('&', "&amp;").replace('<', "&lt;");
    PAGE.replace("{numbers}", &numbers.map(escaped).collect::<Vec<_>>().join("\n"))
}

/// The line of a metric, with a number that is not whole rounded to six significant digits, five decimals at most.
fn rounded(line: &str) -> String {
    let Some((name, value)) = line.rsplit_once(' ') else { return line.to_owned() };
    match value.parse::<f64>() {
        Ok(value) if value.is_finite() && value.fract() != 0.0 => {
            let before = value.abs().log10().floor().clamp(0.0, 5.0) as usize;
            format!("{name} {value:.*}", 5 - before)
        }
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_and_names_escaped() {
        let page = filled(Some("# HELP zerorate_up 1\nzerorate_up 1\nzerorate_rate_dps{axis=\"<b>\"} -0.251234567\n"));
        assert!(page.contains("<pre>up 1\nrate_dps{axis=\"&lt;b>\"} -0.25123</pre>"), "{page}");
        assert!(page.contains("cargo xtask web") && !page.contains("HELP"), "{page}");
        assert_eq!(rounded("sample_rate_hertz 5692.512345"), "sample_rate_hertz 5692.51");
        assert!(filled(None).contains("not read any more"));
    }
}
