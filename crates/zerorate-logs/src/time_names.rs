//! The names of columns with times.

use zerorate_input::TimeUnit;

/// True if a column may hold the time, by its name.
pub fn is_like_time(name: &str) -> bool {
    let name = name.to_lowercase();
    name == "t" || name.contains("time") || name.contains("stamp")
}

/// True if the name of a column means the time and nothing else: `field.header.stamp`, but not `runtime`.
pub fn is_named_time(name: &str) -> bool {
    let words = [
        "t",
        "ts",
        "time",
        "timestamp",
        "stamp",
        "unix",
        "epoch",
        "utc",
        "header",
        "field",
        "system",
        "sys",
        "sample",
        "sensor",
        "ros",
        "imu",
    ];
    let name = name.to_lowercase();
    let mut parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    is_like_time(&name) && parts.all(|part| words.contains(&part))
}

/// True if a name that states a unit of time is this unit alone, such as `ms`. The column may then be a part of
/// another time.
pub fn is_bare_unit(name: &str) -> bool {
    name.chars().all(char::is_alphanumeric) && !name.to_lowercase().contains("time")
}

/// The time of Xsens's sensors, whose unit depends on the sensor.
pub const SAMPLE_TIME_FINE: &str = "SampleTimeFine";

/// True if the name of a column states that it is a time in a known unit.
pub fn states_time(name: &str) -> bool {
    !is_duration(name) && is_in_time_unit(name)
}

/// True if a column holds a duration, and not the time of its row: `latency_us`.
fn is_duration(name: &str) -> bool {
    let words =
        ["latency", "exposure", "age", "period", "loop", "cpu", "delay", "duration", "jitter", "timeout", "lag"];
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
}

fn is_in_time_unit(name: &str) -> bool {
    TimeUnit::of_column(name).or(ticks(name).map(|(unit, _)| unit)).is_some()
        || name.eq_ignore_ascii_case(SAMPLE_TIME_FINE)
}

/// The unit of a time and the size of its step in that unit, if the name states a step other than one unit: 0.1 ms
/// of `time [0.1 ms]` and `ticks_100us`, 60 s of `Time (min)`.
pub fn ticks(name: &str) -> Option<(TimeUnit, f64)> {
    let name = name.to_lowercase();
    let is_bare_t = name.strip_prefix('t').is_some_and(|rest| rest.starts_with(['_', ' ', '[', '(']));
    let is_time = is_bare_t || is_like_time(&name) || name.contains("tick");
    let text = name.trim_end_matches([']', ')']);
    let longer = [("min", 60.0), ("minutes", 60.0), ("h", 3600.0), ("hours", 3600.0)];
    let ends = |word: &str| text.strip_suffix(word).is_some_and(|rest| rest.ends_with(['[', '(']));
    if let Some((_, step)) = longer.into_iter().find(|(word, _)| is_time && ends(word)) {
        return Some((TimeUnit::S, step));
    }
    let units =
        [(TimeUnit::Ms, "ms"), (TimeUnit::Us, "us"), (TimeUnit::Us, "µs"), (TimeUnit::Ns, "ns"), (TimeUnit::S, "s")];
    let (unit, rest) = units.into_iter().find_map(|(unit, word)| Some((unit, text.strip_suffix(word)?)))?;
    let rest = rest.trim_end_matches([' ', '_']);
    let number = &rest[rest.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len()..];
    let is_apart = rest[..rest.len() - number.len()].ends_with(['[', '(', '_', ' ']);
    let step = number.parse().ok().filter(|step| is_time && is_apart && *step > 0.0 && *step != 1.0)?;
    Some((unit, step))
}

/// True if a column may hold the time since the row before: `dt_ms`.
pub fn is_step(name: &str) -> bool {
    let name = name.to_lowercase();
    let stem = name.split(['_', ' ', '[', '(']).next().unwrap_or_default();
    matches!(stem, "dt" | "deltat" | "Δt" | "δt") || name.starts_with("delta_t") || name.starts_with("time_step")
}

/// True if a column holds the nanoseconds of the stamps whose whole seconds stand in another: `stamp.nsecs` and
/// `stamp.secs`.
pub fn is_fraction(name: &str, seconds: &str) -> bool {
    let stem = |name: &str, unit: TimeUnit| {
        let name = name.to_lowercase();
        let end = name.trim_end_matches(char::is_alphanumeric).len();
        let word = &name[end..];
        let is_known = match unit {
            TimeUnit::S => ["sec", "secs"].contains(&word),
            _ => ["nsec", "nsecs", "nanosec", "nanosecs"].contains(&word),
        };
        is_known.then(|| name[..end].to_owned())
    };
    stem(name, TimeUnit::Ns).is_some_and(|of| stem(seconds, TimeUnit::S) == Some(of))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_belong_to_the_seconds_of_the_same_stamp() {
        assert!(is_fraction("header.stamp.nsecs", "header.stamp.secs") && is_fraction("nsec", "sec"));
        assert!(is_fraction("stamp_nanosec", "stamp_sec"));
        assert!(!is_fraction("b.nsecs", "a.secs") && !is_fraction("t_ns", "t_s") && !is_fraction("secs", "nsecs"));
    }

    #[test]
    fn ticks_have_a_number_before_their_unit() {
        let cases = [
            ("time [0.1 ms]", Some((TimeUnit::Ms, 0.1))),
            ("Time (100us)", Some((TimeUnit::Us, 100.0))),
            ("Time (min)", Some((TimeUnit::S, 60.0))),
            ("t [h]", Some((TimeUnit::S, 3600.0))),
            ("loop_time_min", None),
            ("ticks_0.1_ms", Some((TimeUnit::Ms, 0.1))),
            ("timestamp_10ns", Some((TimeUnit::Ns, 10.0))),
            ("time_ms", None),
            ("time2_ms", None),
            ("gyro_avg_100ms", None),
            ("gyro [0.1 ms]", None),
            ("time_1_s", None),
        ];
        cases.into_iter().for_each(|(name, expected)| assert_eq!(ticks(name), expected, "{name}"));
    }

    #[test]
    fn steps_are_not_times() {
        assert!(["dt", "dt_ms", "dt [s]", "delta_t_us", "Delta_T"].into_iter().all(is_step));
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
