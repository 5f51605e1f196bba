//! The texts of warnings about records: each in full, or one line for each code, the most important first.

use zerorate_imu::{ImuWarning, Record};
use zerorate_logs::LogWarning;
use zerorate_view::noise;

/// Codes of warnings about the noise model, the most serious first. Warnings with any other code, such as those about
/// the log, come before them.
const BY_WEIGHT: [&str; 18] = [
    "model-rejected",
    "follows-temperature",
    "short-record",
    "leakage",
    "off-curve",
    "many-steps",
    "step",
    "glitches",
    "warm-up",
    "drift",
    "unsteady",
    "gaps",
    "lines",
    "memory-or-filter",
    "memory-or-flicker",
    "drift-or-walk",
    "quantisation-limited",
    "not-identified",
];

/// A line about an axis's model with more characters than this loses its advice, which `zerorate explain` also gives.
const MOST_CHARS: usize = 100;

/// Formats motion that appears on several axes of one log. Moving spans, jumps and knocks get one line each.
pub fn of_motion(axes: &[Record]) -> Vec<String> {
    Record::motion(axes).iter().map(ImuWarning::coded).collect()
}

/// Formats the warnings about all records, one line for each code except [`EACH`].
pub fn condensed(records: &[Record]) -> Vec<String> {
    let is_of_one_log = records.len() == 1 || noise::are_axes(records);
    let of_record = |record: &Record| -> Vec<String> {
        let name = noise::name(is_of_one_log, record);
        let named = |line: String| line.replacen(": ", &format!(": {name}: "), 1);
        let of_axis = record.noise_warnings().map(named);
        record.notes.iter().map(LogWarning::coded).chain(of_axis).collect()
    };
    let mut lines: Vec<String> = records.iter().flat_map(of_record).collect();
    lines.sort_by_key(|line| BY_WEIGHT.iter().position(|known| *known == code(line)).map_or(0, |place| place + 1));
    first_of_each(&lines)
}

/// The code in a line `code: text`.
pub fn code(line: &str) -> &str {
    line.split_once(": ").map_or("", |(code, _)| code)
}

/// The code whose lines are all shown, because their causes and remedies differ.
const EACH: &str = "implausible";

/// The first line of each warning code, with the number of other lines of the code. Of the code [`EACH`], each line is
/// kept. Repeated lines count once.
pub fn first_of_each(lines: &[String]) -> Vec<String> {
    let mut firsts: Vec<(&String, Vec<&String>)> = Vec::new();
    for line in lines {
        let is_same = |first: &String| code(first) == code(line) && (code(line) != EACH || first == line);
        match firsts.iter_mut().find(|(first, _)| is_same(first)) {
            Some((first, others)) if *first != line && !others.contains(&line) => others.push(line),
            Some(_) => {}
            None => firsts.push((line, Vec::new())),
        }
    }
    firsts.into_iter().map(|(first, others)| counted(first, others.len())).collect()
}

fn counted(line: &str, others: usize) -> String {
    let more = if others == 0 { String::new() } else { format!(" (+ {others} more)") };
    let is_long = line.chars().count() + more.chars().count() > MOST_CHARS && BY_WEIGHT.contains(&code(line));
    let seen = line.rsplit_once("; ").filter(|_| is_long).map_or(line, |(seen, _advice)| seen);
    format!("{seen}{more}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_one_line_that_leaves_out_advice_where_it_is_long() {
        let of = |axis: &str, tau_s: u32| {
            format!("off-curve: {axis}: at {tau_s} s the curve is 1.23 times the model; do not use the model there")
        };
        let [x, y] = [of("gyro_x_dps", 12), of("gyro_y_dps", 34)];
        let drift = "drift: gx: the rate drifts; let the sensor settle".to_owned();
        assert_eq!(
            first_of_each(&[x.clone(), x.clone(), drift.clone(), y]),
            ["off-curve: gyro_x_dps: at 12 s the curve is 1.23 times the model (+ 1 more)", &drift]
        );
        assert_eq!(first_of_each(&[x.clone(), x.clone()]), [x]);
    }
}
