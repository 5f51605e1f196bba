//! A minimal page for a program that was built without the live page. It shows the metrics.

use super::answer::{self, Answer};
use super::metrics;
use super::server::Server;
use hyper::StatusCode;

const PAGE: &str = include_str!("small_page.html");

/// Answers `GET /`.
pub async fn small_page(server: &Server) -> Answer {
    let text = metrics::text_of(server).await;
    answer::typed(StatusCode::OK, "text/html; charset=utf-8", filled(text.as_deref()))
}

/// The page with these metrics. `None` means that the session has ended.
fn filled(metrics: Option<&str>) -> String {
    let Some(metrics) = metrics else { return PAGE.replace("{numbers}", "The device is not read any more.") };
    let numbers = metrics.lines().filter_map(|line| line.strip_prefix("zerorate_"));
    // the name of an axis comes from a file, so it may contain HTML
    let escaped = |line: &str| line.replace('&', "&amp;").replace('<', "&lt;");
    PAGE.replace("{numbers}", &numbers.map(escaped).collect::<Vec<_>>().join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_and_names_escaped() {
        let page = filled(Some("# HELP zerorate_up 1\nzerorate_up 1\nzerorate_rate_dps{axis=\"<b>\"} -0.25\n"));
        assert!(page.contains("<pre>up 1\nrate_dps{axis=\"&lt;b>\"} -0.25</pre>"), "{page}");
        assert!(page.contains("cargo xtask web") && !page.contains("HELP"), "{page}");
        assert!(filled(None).contains("not read any more"));
    }
}
