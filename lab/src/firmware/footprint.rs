//! The figures of `docs/reference/footprint.md`: compares them with goals and committed figures, and writes the page.

use anyhow::{Context, Result, ensure};
use std::fmt::Write;
use std::fs;

pub const PAGE: &str = "docs/reference/footprint.md";

/// Relative rise of a figure that is not yet an error.
const TOLERANCE: f64 = 0.05;

pub struct Figure {
    /// Name of the measured quantity on the page.
    pub what: &'static str,
    pub value: u64,
    /// The unit: instructions or bytes.
    pub unit: &'static str,
    pub goal: Option<u64>,
}

pub fn missed_goals(figures: &[Figure]) -> Vec<String> {
    let missed = figures.iter().filter_map(|figure| {
        let goal = figure.goal.filter(|goal| figure.value > *goal)?;
        Some(format!("{}: {} {}, the goal is {goal}", figure.what, figure.value, figure.unit))
    });
    missed.collect()
}

/// Describes every figure that rose by more than 5 % since the page was written.
pub fn risen(figures: &[Figure], page: &str) -> Vec<String> {
    let risen = figures.iter().filter_map(|figure| {
        let before = committed(figure.what, page)?;
        let limit = before as f64 * (1.0 + TOLERANCE);
        let text = || format!("{}: {} {}, {before} before", figure.what, figure.value, figure.unit);
        (figure.value as f64 > limit).then(text)
    });
    risen.collect()
}

pub fn changed(figures: &[Figure], page: &str) -> Vec<String> {
    let changed = figures.iter().filter_map(|figure| match committed(figure.what, page) {
        Some(before) if before == figure.value => None,
        Some(before) => Some(format!("{}: {} {}, {before} before", figure.what, figure.value, figure.unit)),
        None => Some(format!("{}: {} {}, not on the page before", figure.what, figure.value, figure.unit)),
    });
    changed.collect()
}

/// The figure in a row of the page; `None` if there is no such row.
fn committed(what: &str, page: &str) -> Option<u64> {
    let mut rows = page.lines().map(|line| line.split('|').map(str::trim).collect::<Vec<_>>());
    let row = rows.find(|cells| cells.get(1) == Some(&what))?;
    row.get(2)?.parse().ok()
}

pub fn read() -> Result<String> {
    fs::read_to_string(PAGE).context(PAGE)
}

/// Writes the page, with the versions of compiler and emulator.
pub fn write(figures: &[Figure], rustc: &str, qemu: &str) -> Result<()> {
    let page = include_str!("footprint.md.in");
    let entries = [
        ("@INSTRUCTIONS@", table(figures, "instructions")),
        ("@BYTES@", table(figures, "bytes")),
        ("@RUSTC@", rustc.to_owned()),
        ("@QEMU@", qemu.to_owned()),
    ];
    let text = entries.iter().fold(page.to_owned(), |text, (key, value)| text.replace(key, value));
    ensure!(!text.contains('@'), "the template of {PAGE} has an unknown mark");
    fs::write(PAGE, text).context(PAGE)
}

fn table(figures: &[Figure], unit: &str) -> String {
    let mut text = format!("| what | {unit} | goal: at most |\n|---|---|---|");
    for figure in figures.iter().filter(|figure| figure.unit == unit) {
        let goal = match figure.goal {
            Some(goal) if figure.value > goal => format!("{goal}: GOAL MISSED"),
            Some(goal) => goal.to_string(),
            None => String::new(),
        };
        // writing to a string cannot fail
        let _ = write!(text, "\n| {} | {} | {goal} |", figure.what, figure.value);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "| what | bytes | goal |\n|---|---|---|\n| a | 100 | 120 |\n| b | 7 |  |\n";

    fn figure(what: &'static str, value: u64, goal: Option<u64>) -> Figure {
        Figure { what, value, unit: "bytes", goal }
    }

    #[test]
    fn five_percent_are_tolerated_and_no_more() {
        assert!(risen(&[figure("a", 105, None), figure("b", 7, None), figure("new", 9, None)], PAGE).is_empty());
        assert_eq!(risen(&[figure("a", 106, None)], PAGE), ["a: 106 bytes, 100 before"]);
        assert_eq!(risen(&[figure("b", 8, None)], PAGE).len(), 1);
    }

    #[test]
    fn changes_and_goals_are_named() {
        assert!(changed(&[figure("a", 100, None)], PAGE).is_empty());
        assert_eq!(changed(&[figure("a", 99, None), figure("new", 1, None)], PAGE).len(), 2);
        assert_eq!(missed_goals(&[figure("a", 121, Some(120))]), ["a: 121 bytes, the goal is 120"]);
        assert!(missed_goals(&[figure("a", 120, Some(120)), figure("b", 1, None)]).is_empty());
    }

    #[test]
    fn the_table_is_read_back() {
        let figures = [figure("a", 3, Some(4)), figure("b", 5, None), figure("c", 7, Some(6))];
        let page = table(&figures, "bytes");
        assert!(changed(&figures, &page).is_empty());
        assert!(page.contains("| a | 3 | 4 |") && page.contains("| c | 7 | 6: GOAL MISSED |"), "{page}");
    }
}
