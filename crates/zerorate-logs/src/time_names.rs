//! Recognises columns of times by their names.

use zerorate_input::{TimeUnit, states_factor};

/// True if a column may hold the time, by its name.
pub fn is_like_time(name: &str) -> bool {
    let name = name.to_lowercase();
    name == "t" || name.contains("time") || name.contains("stamp")
}

/// True if the name of a column means the time and nothing else: `field.header.stamp`, but not `runtime`.
pub fn is_named_time(name: &str) -> bool {
    let words = "t ts time timestamp stamp unix epoch utc header field system sys sample sensor ros imu";
    let name = name.to_lowercase();
    let mut parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    is_like_time(&name) && parts.all(|part| words.split(' ').any(|word| word == part))
}

/// True if a name that states a unit of time is this unit alone, such as `ms`. The column may then be a part of
/// another time.
pub fn is_bare_unit(name: &str) -> bool {
    name.chars().all(char::is_alphanumeric) && !name.to_lowercase().contains("time")
}

/// True if the name of a column states a time in minutes or hours. Another time of the log may have more digits.
pub fn is_in_longer_unit(name: &str) -> bool {
    ticks(name).is_some_and(|(unit, step)| unit == TimeUnit::S && step >= 60.0)
}

/// Name of the time column of Xsens's sensors. The unit of the times depends on the sensor.
pub const SAMPLE_TIME_FINE: &str = "SampleTimeFine";

/// True if the name of a column states a time with its unit, or is [`SAMPLE_TIME_FINE`].
pub fn states_time(name: &str) -> bool {
    !is_duration(name) && is_in_time_unit(name)
}

/// True if a column, by its name, holds a duration and not the time of its row: `latency_us`.
fn is_duration(name: &str) -> bool {
    let words =
        ["latency", "exposure", "age", "period", "loop", "cpu", "delay", "duration", "jitter", "timeout", "lag"];
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
}

fn is_in_time_unit(name: &str) -> bool {
    TimeUnit::of_column(name).or(ticks(name).map(|(unit, _)| unit)).is_some()
        || name.eq_ignore_ascii_case(SAMPLE_TIME_FINE)
}

/// If the name of a time states a step other than one unit, returns the unit and the size of the step in it: 0.1 ms
/// for `time [0.1 ms]`, 100 µs for `ticks_100us`, 60 s for `Time (min)`, 1/32768 s for `ticks_32768Hz`. `None` for
/// other factors, as in `time_x10_us`.
pub fn ticks(name: &str) -> Option<(TimeUnit, f64)> {
    let name = name.to_lowercase();
    let is_short =
        ["ts", "t"].iter().any(|t| name.strip_prefix(t).is_some_and(|rest| rest.starts_with(['_', ' ', '[', '('])));
    let is_time = is_short || is_like_time(&name) || name.contains("tick");
    let text = name.trim_end_matches([']', ')']);
    let text = text.strip_suffix("/lsb").unwrap_or(text);
    // the number of a step stands in the bracket
    if states_factor(&text.replace(['[', '('], " ")) {
        return None;
    }
    let longer = [(60.0, &["min", "mins", "minutes"][..]), (3600.0, &["h", "hr", "hrs", "hours"])];
    let ends = |word: &&str| text.strip_suffix(*word).is_some_and(|rest| rest.ends_with(['[', '(']));
    if let Some((step, _)) = longer.into_iter().find(|(_, words)| is_time && words.iter().any(ends)) {
        return Some((TimeUnit::S, step));
    }
    // `ms` also ends with `s`, so seconds come last
    let units =
        [(TimeUnit::Ms, "ms"), (TimeUnit::Us, "us"), (TimeUnit::Us, "µs"), (TimeUnit::Ns, "ns"), (TimeUnit::S, "s")];
    let rates = [("khz", 1e3), ("mhz", 1e6), ("hz", 1.0)];
    let number = |rest: &str| {
        let rest = rest.trim_end_matches([' ', '_']);
        let number = &rest[rest.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len()..];
        let is_apart = rest[..rest.len() - number.len()].ends_with(['[', '(', '_', ' ']);
        number.parse().ok().filter(|number: &f64| is_time && is_apart && *number > 0.0)
    };
    if let Some((rest, per_s)) = rates.into_iter().find_map(|(word, per_s)| Some((text.strip_suffix(word)?, per_s))) {
        return Some((TimeUnit::S, 1.0 / (number(rest)? * per_s)));
    }
    let (unit, rest) = units.into_iter().find_map(|(unit, word)| Some((unit, text.strip_suffix(word)?)))?;
    Some((unit, number(rest).filter(|step| *step != 1.0)?))
}

/// True if a column may hold the time since the row before: `dt_ms`.
pub fn is_step(name: &str) -> bool {
    let name = name.to_lowercase();
    let mut words = name.split(['_', ' ', '[', '(']);
    let is_interval = words.clone().any(|word| word == "interval");
    let stem = words.next().unwrap_or_default();
    is_interval
        || matches!(stem, "dt" | "deltat" | "Δt" | "δt")
        || name.starts_with("delta_t")
        || name.starts_with("time_step")
}

/// A stamp may be split: its whole seconds are in column `seconds`, and the rest is in column `name`. Returns the
/// number of seconds in one unit of the rest: 1e-9 for `stamp.nsecs` beside `stamp.secs`, 1e-3 for `millisecond`
/// beside `second`. `None` if the columns are not such a pair.
pub fn fraction_s(name: &str, seconds: &str) -> Option<f64> {
    let parted = |name: &str| {
        let name = name.to_lowercase();
        let end = name.trim_end_matches(char::is_alphanumeric).len();
        (name[..end].to_owned(), name[end..].to_owned())
    };
    let ((stem, word), (stem_of_seconds, second)) = (parted(name), parted(seconds));
    let are_seconds = stem == stem_of_seconds && ["sec", "secs", "second", "seconds"].contains(&&*second);
    let unit_s = FRACTIONS.iter().find_map(|(unit_s, words)| words.contains(&&*word).then_some(*unit_s));
    unit_s.or((stem.is_empty() && word == "ms").then_some(1e-3)).filter(|_| are_seconds)
}

/// A time of day in whole seconds may have the rest in column `name`. Returns the number of seconds in one unit of the
/// rest: 1e-3 for `ms` beside `time`.
pub fn fraction_of_clock_s(name: &str) -> Option<f64> {
    fraction_s(name, "seconds").filter(|unit_s| *unit_s < 1.0)
}

/// Words for the rest of a stamp behind its whole seconds: the number of seconds in one unit, and the words.
const FRACTIONS: [(f64, &[&str]); 4] = [
    (1e-9, &["nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds"]),
    (1e-6, &["usec", "usecs", "microsec", "microsecond", "microseconds"]),
    (1e-3, &["msec", "msecs", "millisec", "millisecond", "milliseconds"]),
    (1.0, &["fraction", "frac", "subsec", "subsecond", "subseconds"]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_belongs_to_the_seconds_of_the_same_stamp() {
        let cases = [
            ("header.stamp.nsecs", "header.stamp.secs", Some(1e-9)),
            ("nsec", "sec", Some(1e-9)),
            ("stamp_nanosec", "stamp_sec", Some(1e-9)),
            ("tv_usec", "tv_sec", Some(1e-6)),
            ("millisecond", "second", Some(1e-3)),
            ("ms", "seconds", Some(1e-3)),
            ("fraction", "seconds", Some(1.0)),
            ("b.nsecs", "a.secs", None),
            ("t_ns", "t_s", None),
            ("t_ms", "t_sec", None),
            ("secs", "nsecs", None),
        ];
        cases.into_iter().for_each(|(name, of, expected)| assert_eq!(fraction_s(name, of), expected, "{name}"));
        assert_eq!((fraction_of_clock_s("ms"), fraction_of_clock_s("fraction")), (Some(1e-3), None));
    }

    #[test]
    fn ticks_have_a_number_before_their_unit() {
        let cases = [
            ("time [0.1 ms]", Some((TimeUnit::Ms, 0.1))),
            ("Time (100us)", Some((TimeUnit::Us, 100.0))),
            ("Time (min)", Some((TimeUnit::S, 60.0))),
            ("t [h]", Some((TimeUnit::S, 3600.0))),
            ("Elapsed Time (hr)", Some((TimeUnit::S, 3600.0))),
            ("loop_time_min", None),
            ("ticks_0.1_ms", Some((TimeUnit::Ms, 0.1))),
            ("timestamp_10ns", Some((TimeUnit::Ns, 10.0))),
            ("time_ms", None),
            ("time2_ms", None),
            ("gyro_avg_100ms", None),
            ("gyro [0.1 ms]", None),
            ("time_1_s", None),
            ("timestamp (25us/LSB)", Some((TimeUnit::Us, 25.0))),
            ("ts[25 us]", Some((TimeUnit::Us, 25.0))),
            ("ticks_32768Hz", Some((TimeUnit::S, 1.0 / 32_768.0))),
            ("time [40 kHz]", Some((TimeUnit::S, 1.0 / 40_000.0))),
            ("gyro [200 Hz]", None),
            ("time_hz", None),
            ("time_x10_us", None),
            ("time x 10 us", None),
            ("time*1000 (min)", None),
        ];
        cases.into_iter().for_each(|(name, expected)| assert_eq!(ticks(name), expected, "{name}"));
    }

    #[test]
    fn steps_are_not_times() {
        assert!(["dt", "dt_ms", "dt [s]", "delta_t_us", "Delta_T", "sample_interval_us"].into_iter().all(is_step));
        assert!(!["t_s", "time", "dtheta_x", "date"].into_iter().any(is_step));
    }

    #[test]
    fn a_time_is_called_so_in_words() {
        assert!(
            ["time", "%time", "t", "timestamp", "field.header.stamp", "Unix_Timestamp"].into_iter().all(is_named_time)
        );
        assert!(
            !["runtime", "lifetime", "start_time", "last_sync_time", "centimeters"].into_iter().any(is_named_time)
        );
    }
}
