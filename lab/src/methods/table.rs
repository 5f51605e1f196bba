//! The tables of docs/reference/methods.md, in Markdown.

use super::campaign::METHODS;
use super::comparison::{Coverage, Summary};
use super::unit::Kind;
use std::fmt::Write;

fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}", heads.join(" | "), "---|".repeat(heads.len()));
    for row in rows {
        // writing to a string cannot fail
        let _ = write!(text, "\n| {} |", row.join(" | "));
    }
    text
}

/// The residual bias of all methods for all kinds of units, with and without the mean over the temperatures.
pub fn overview(methods: &[Vec<Summary>]) -> String {
    let heads: Vec<&str> =
        std::iter::once("residual, °/h (without the level)").chain(Kind::ALL.map(Kind::name)).collect();
    let cell = |summary: &Summary| format!("{:.1} ({:.1})", summary.residual_dph, summary.shape_dph);
    let row = |(index, method): (usize, &super::campaign::Method)| {
        let cells = methods.iter().map(|of_kind| cell(&of_kind[index]));
        std::iter::once(method.name.to_owned()).chain(cells).collect()
    };
    table(&heads, METHODS.iter().enumerate().map(row))
}

/// How well the 95 % intervals hold, and the chosen orders, for the methods that have them.
pub fn intervals(methods: &[Vec<Summary>]) -> String {
    let rows = METHODS.iter().enumerate().flat_map(|(index, method)| {
        let of_kinds = Kind::ALL.into_iter().zip(methods).map(move |(kind, of_kind)| (kind, &of_kind[index]));
        of_kinds.filter_map(|(kind, summary)| {
            let Coverage { everywhere, ratio, .. } = summary.coverage?;
            let (mean, worst) = (summary.coverage?.mean(), summary.coverage?.worst());
            let orders = summary.orders?.map(|share| format!("{share:.0}")).join(" / ");
            let [mean, worst, everywhere] = [mean, worst, everywhere].map(|share| format!("{share:.1}"));
            let names = [method.name, kind.name(), verdict(summary.coverage?.mean())].map(str::to_owned);
            Some(names.into_iter().chain([mean, worst, everywhere, format!("{ratio:.2}"), orders]).collect())
        })
    });
    let heads = [
        "method",
        "units",
        "the intervals are",
        "inside, % (mean of nine)",
        "farthest from 95",
        "all nine at once",
        "rms(error/u)",
        "order 0 / 1 / 2 / 3, %",
    ];
    table(&heads, rows)
}

/// The verdict on 95 % intervals that contain the truth for this share of the units, %.
const fn verdict(inside: f64) -> &'static str {
    match inside {
        ..93.5 => "too narrow",
        93.5..=96.5 => "as stated",
        _ => "too wide",
    }
}

/// The duration of a fit by each method, ms: the mean over the kinds of units.
pub fn times(methods: &[Vec<Summary>]) -> String {
    let mean = |index: usize| methods.iter().map(|of_kind| of_kind[index].fit_ms).sum::<f64>() / methods.len() as f64;
    let row = |(index, method): (usize, &super::campaign::Method)| {
        vec![method.name.to_owned(), format!("{:.1}", mean(index))]
    };
    table(&["method", "time of a fit, ms"], METHODS.iter().enumerate().map(row))
}

/// The results of the warm-up method by the length of the recording.
pub fn lengths(lengths_min: &[f64], kinds: &[Vec<Summary>]) -> String {
    let heads: Vec<&str> = std::iter::once("ended after, min").chain(Kind::ALL.map(Kind::name)).collect();
    let row = |(index, minutes): (usize, &f64)| {
        let cells = kinds.iter().map(|of_kind| with_coverage(&of_kind[index]));
        std::iter::once(format!("{minutes:.0}")).chain(cells).collect()
    };
    table(&heads, lengths_min.iter().enumerate().map(row))
}

/// The results of the warm-up method by the rate random walk, with the lower bound.
pub fn walks(factors: &[f64], summaries: &[Summary], bounds_dph: &[f64]) -> String {
    let row = |((factor, summary), bound_dph): ((&f64, &Summary), &f64)| {
        let Summary { residual_dph, shape_dph, .. } = summary;
        let cells = [
            format!("{factor} × M-04"),
            format!("{bound_dph:.1}"),
            with_coverage(summary),
            format!("{shape_dph:.1}"),
            format!("{:.2}", residual_dph / bound_dph),
        ];
        cells.to_vec()
    };
    let heads = ["rate random walk", "bound, °/h", "warmup, °/h", "without the level, °/h", "warmup/bound"];
    table(&heads, factors.iter().zip(summaries).zip(bounds_dph).map(row))
}

fn with_coverage(summary: &Summary) -> String {
    let inside = summary.coverage.map_or(String::new(), |coverage| format!(", {:.0} % inside", coverage.mean()));
    format!("{:.1}{inside}", summary.residual_dph)
}

pub struct Goal {
    pub what: String,
    pub goal: String,
    pub measured: String,
    pub is_met: bool,
}

pub fn goals(goals: &[Goal]) -> String {
    let row = |goal: &Goal| {
        let verdict = if goal.is_met { "met" } else { "**missed**" };
        vec![goal.what.clone(), goal.goal.clone(), goal.measured.clone(), verdict.to_owned()]
    };
    table(&["what", "goal", "measured", ""], goals.iter().map(row))
}
