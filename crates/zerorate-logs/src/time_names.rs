//! The names of columns with times.

use zerorate_input::TimeUnit;

/// Whether a column may hold the time, by its name.
pub fn is_like_time(name: &str) -> bool {
    let name = name.to_lowercase();
    name == "t" || name.contains("time") || name.contains("stamp")
}

/// Whether a column is called the time and nothing else: `timestamp`, `field.header.stamp`, but not `runtime`.
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

/// Whether a column is called by its unit alone, as `ms`, which may also be a part of a time.
pub fn is_bare_unit(name: &str) -> bool {
    name.chars().all(char::is_alphanumeric) && !name.to_lowercase().contains("time")
}

/// Whether a column may hold the time since the row before: `dt_ms`.
pub fn is_step(name: &str) -> bool {
    let name = name.to_lowercase();
    let stem = name.split(['_', ' ', '[', '(']).next().unwrap_or_default();
    matches!(stem, "dt" | "deltat" | "Δt" | "δt") || name.starts_with("delta_t") || name.starts_with("time_step")
}

/// Whether a column holds the nanoseconds of the stamps whose whole seconds stand in another: `stamp.nsecs` and
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
