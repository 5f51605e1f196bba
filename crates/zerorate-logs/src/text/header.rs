//! Tells a header in the midst of a log from broken rows: the header of the log again, or another log's header.

use super::head::{is_word, shortened};
use std::collections::HashSet;
use zerorate_input::Unit;
use zerorate_input::delimited::Delimiter;

/// The lines of the header, each with its number: the names and, if they have a line of their own, the units.
pub type Header = [(u64, String)];

/// True if a line is a line of the header again. A logger writes it when it restarts.
pub fn is_again(line: &str, header: &Header, delimiter: Delimiter) -> bool {
    header.iter().any(|(_, known)| cells(line, delimiter).eq(cells(known, delimiter)))
}

/// The error for a line that names other columns, or the same ones in another order or unit.
pub fn other(line: &str, header: &Header, delimiter: Delimiter) -> Option<String> {
    let names: Vec<&str> = cells(line, delimiter).collect();
    let is_as_wide = |known: &str| cells(known, delimiter).take(names.len() + 1).count() == names.len();
    let mut as_wide = header.iter().filter(|(_, known)| is_as_wide(known));
    let (number, known) = as_wide.find(|(_, known)| differ(&names, &cells(known, delimiter).collect::<Vec<_>>()))?;
    let mut seen = HashSet::new();
    let are_names = names.iter().all(|name| !name.contains('\u{FFFD}') && is_word(name) && seen.insert(*name));
    let (line, known) = (shortened(line), shortened(known));
    let what = format!("the header `{line}` begins another log than `{known}` in line {number}; cut the log there");
    are_names.then_some(what)
}

/// True if two lines of as many cells differ in several of them, and have the same first cell or the same names in
/// another order, or if they state two units of one column. A name that a bad cable changed does not count.
fn differ(names: &[&str], known: &[&str]) -> bool {
    let pairs = || names.iter().zip(known).filter(|(name, known)| name != known);
    let are_units = |(name, known): (&&str, &&str)| {
        Unit::of_column(name).zip(Unit::of_column(known)).is_some_and(|(unit, known)| unit != known)
    };
    let of_log: HashSet<&str> = known.iter().copied().collect();
    let is_shared = names.first() == known.first() || names.iter().all(|name| of_log.contains(name));
    is_shared && pairs().count() > 1 || pairs().any(are_units)
}

fn cells(line: &str, delimiter: Delimiter) -> impl Iterator<Item = &str> {
    delimiter.cells(line.trim_start_matches('\u{FEFF}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_told_from_broken_rows() {
        let header = [(3, "t_s,gx_dps,gy_dps".to_owned()), (4, "s,°/s,°/s".to_owned())];
        for (line, again, another) in [
            ("t_s, gx_dps,\"gy_dps\"", true, false),
            ("\u{FEFF}t_s,gx_dps,gy_dps", true, false),
            ("s,°/s,°/s", true, false),
            ("t_s,gy_dps,gx_dps", false, true),
            ("t_s,gx_dps,gy_rad_s", false, true),
            ("t_s,ax,ay", false, true),
            ("t_s,gx_dps", false, false),
            ("event,start,gx_dps", false, false),
            ("t_s,gx_dps,gy_dqs", false, false),
            ("t_s,gx_\u{FFFD},g_dps", false, false),
            ("t_s,t_s,gx_dps", false, false),
            ("ERR,ERR,ERR", false, false),
            ("t_s,ERR,0.5", false, false),
            ("12:00:00,gx_dps,n/a", false, false),
        ] {
            let delimiter = Delimiter::Comma;
            let found = (is_again(line, &header, delimiter), other(line, &header, delimiter).is_some());
            assert_eq!(found, (again, another), "{line}");
        }
    }
}
