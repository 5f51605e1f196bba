//! Writes docs/reference/methods.md and its plots.

use super::an1042::Difference;
use super::campaign::{AN1042, CHAMBER, CYCLE, METHODS, WARMUP};
use super::comparison::Summary;
use super::picture;
use super::table::{self, Goal};
use super::unit::Kind;
use crate::tracking::Tracking;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::ops::RangeInclusive;
use zerorate::Uncertainty;

const PAGE: &str = "docs/reference/methods.md";
const TEMPLATE: &str = include_str!("methods.md.in");
const RESIDUALS: &str = "docs/pictures/methods-residual.svg";
const COVERAGE: &str = "docs/pictures/methods-coverage.svg";

/// Lengths of the warm-up, min.
pub const LENGTHS_MIN: [f64; 5] = [5.0, 10.0, 20.0, 53.0, 90.0];
/// Rate random walks, as multiples of M-04.
pub const WALKS: [f64; 4] = [0.0, 0.3, 1.0, 3.0];

pub struct Results {
    /// The results by kind, then by method.
    pub methods: Vec<Vec<Summary>>,
    /// The results of the warm-up by kind, then by length.
    pub lengths: Vec<Vec<Summary>>,
    /// The results of the warm-up by rate random walk.
    pub walks: Vec<Summary>,
    pub bounds_dph: Vec<f64>,
    /// The bound for a quadratic bias with the rate random walk M-04, °/h.
    pub curved_bound_dph: f64,
    pub tracking: Tracking,
    pub checked: Vec<Difference>,
    pub seeds: RangeInclusive<u64>,
    /// The seeds of the units in the additional tables.
    pub side: RangeInclusive<u64>,
    pub lag_s: f64,
}

pub fn write(results: &Results) -> Result<()> {
    for (path, text) in [
        (RESIDUALS, picture::residuals(&results.methods)),
        (COVERAGE, picture::coverage(&results.methods)),
        (PAGE, page(results)?),
    ] {
        fs::write(path, text).context(path)?;
        println!("{path} is written");
    }
    Ok(())
}

fn page(results: &Results) -> Result<String> {
    let seeds = |range: &RangeInclusive<u64>| format!("{}..{}", range.start(), range.end());
    let (units, covered) = (results.seeds.end() - results.seeds.start() + 1, Uncertainty::COVERAGE);
    // the smallest error that any method can reach for a bias that is known to be linear, with the random walk M-04
    let bound_dph = WALKS.iter().zip(&results.bounds_dph).find(|(factor, _)| **factor == 1.0);
    let (_, bound_dph) = bound_dph.context("no bound for M-04")?;
    let most = |of: fn(&Difference) -> f64| results.checked.iter().map(of).map(f64::abs).fold(0.0, f64::max);
    let entries = [
        ("@SEEDS@", seeds(&results.seeds)),
        ("@UNITS@", units.to_string()),
        ("@SCATTER@", format!("{:.1}", 100.0 * (covered * (1.0 - covered) / units as f64).sqrt())),
        ("@SIDE@", seeds(&results.side)),
        ("@LAG@", results.lag_s.to_string()),
        ("@OVERVIEW@", table::overview(&results.methods)),
        ("@GOALS@", table::goals(&goals(results))),
        ("@INTERVALS@", table::intervals(&results.methods)),
        ("@STATIC@", format!("{:.1}", results.tracking.static_dph)),
        ("@TRACKED@", format!("{:.1}", results.tracking.tracked_dph)),
        ("@TRACKED_INSIDE@", format!("{:.1}", results.tracking.inside)),
        ("@TIMES@", table::times(&results.methods)),
        ("@LENGTHS@", table::lengths(&LENGTHS_MIN, &results.lengths)),
        ("@WALKS@", table::walks(&WALKS, &results.walks, &results.bounds_dph)),
        ("@BOUND@", format!("{bound_dph:.1}")),
        ("@CURVED_BOUND@", format!("{:.1}", results.curved_bound_dph)),
        ("@CHECKED@", results.checked.len().to_string()),
        ("@CHECKED_PBC@", format!("{:.2}", 3600.0 * most(|difference| difference.pbc_dps))),
        ("@CHECKED_BTC@", format!("{:.2}", 3600.0 * most(|difference| difference.btc_dps_per_c))),
    ];
    let text = entries.iter().fold(TEMPLATE.to_owned(), |text, (key, value)| text.replace(key, value));
    ensure!(!text.contains('@'), "the template of {PAGE} has an unknown mark");
    Ok(text)
}

fn goals(results: &Results) -> Vec<Goal> {
    let summary = |kind: Kind, name: &str| {
        let index = METHODS.iter().position(|method| method.name == name).unwrap_or_default();
        &results.methods[kind as usize][index]
    };
    let times_better = |worse: &str, better: &str, kind: Kind, least: f64| {
        let (from_dph, to_dph) = (summary(kind, worse).residual_dph, summary(kind, better).residual_dph);
        Goal {
            what: format!("residual of {worse} over residual of {better}, {} units", kind.name()),
            goal: format!("at least {least}"),
            measured: format!("{:.1} ({from_dph:.1}/{to_dph:.1} °/h)", from_dph / to_dph),
            is_met: from_dph / to_dph >= least,
        }
    };
    let covered = |name: &'static str, kind: Kind| {
        let coverage = summary(kind, name).coverage?;
        let (low, high) =
            coverage.at_temps.iter().fold((100.0, 0.0), |(low, high), share| (share.min(low), share.max(high)));
        Some(Goal {
            what: format!("{name}, {} units inside their 95 % intervals, at each of nine temperatures", kind.name()),
            goal: "93 to 97 %".to_owned(),
            measured: format!("{low:.1} to {high:.1} %"),
            is_met: low >= 93.0 && high <= 97.0,
        })
    };
    let ratios = [
        times_better(AN1042, WARMUP, Kind::Linear, 2.5),
        times_better(AN1042, WARMUP, Kind::Curved, 6.0),
        times_better(WARMUP, CYCLE, Kind::Lagging, 2.0),
    ];
    let intervals = [WARMUP, CYCLE, CHAMBER]
        .into_iter()
        .flat_map(|name| Kind::ALL.into_iter().filter_map(move |kind| covered(name, kind)));
    ratios.into_iter().chain(intervals).chain(tracked(&results.tracking)).collect()
}

fn tracked(tracking: &Tracking) -> [Goal; 2] {
    let Tracking { static_dph, tracked_dph, ratios, .. } = tracking;
    [
        Goal {
            what: "a day with 5 % of rest: residual of the calibration alone over residual of track".to_owned(),
            goal: "at least 3".to_owned(),
            measured: format!("{:.1} ({static_dph:.1}/{tracked_dph:.1} °/h)", tracking.ratio()),
            is_met: tracking.ratio() >= 3.0,
        },
        Goal {
            what: "units that track makes worse".to_owned(),
            goal: "none".to_owned(),
            measured: format!("{} of {}", tracking.worse(), ratios.len()),
            is_met: tracking.worse() == 0,
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed page contains the texts between the template's marks, in their order.
    #[test]
    fn the_page_is_the_templates() {
        let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/methods.md")).unwrap();
        let mut rest = page.as_str();
        // every second piece is a text; the pieces between them are the names of marks
        let pieces: Vec<&str> = TEMPLATE.split('@').step_by(2).collect();
        for (index, piece) in pieces.iter().enumerate() {
            let at = if index + 1 == pieces.len() { rest.rfind(piece) } else { rest.find(piece) };
            let at = at.unwrap_or_else(|| panic!("not in the page, or not in its place: {piece:?}"));
            assert!(index > 0 || at == 0, "the page begins with something else");
            rest = &rest[at + piece.len()..];
        }
        assert_eq!(rest, "", "the page goes on");
        let first = METHODS.iter().all(|method| page.contains(&format!("\n| {} | ", method.name)));
        assert!(first, "a method is missing: run `cargo xtask methods`");
    }
}
