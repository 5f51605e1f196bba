//! The wall-clock time and the host name, for the description of a capture.

use jiff::{Timestamp, Unit};
use std::time::SystemTime;

/// The wall-clock time; `None` outside of the range of [`Timestamp`], the years −9999 to 9999.
#[must_use]
pub fn now() -> Option<Timestamp> {
    stamp(SystemTime::now())
}

/// The wall-clock time as text, rounded to the second; empty outside of the range of [`Timestamp`].
pub(crate) fn text() -> String {
    now().map_or_else(String::new, to_second)
}

/// The host name; `None` if there is none, if it is not UTF-8, or on systems other than Linux.
pub(crate) fn host() -> Option<String> {
    #[cfg(target_os = "linux")]
    return rustix::system::uname().nodename().to_str().ok().map(str::to_owned).filter(|name| !name.is_empty());
    #[cfg(not(target_os = "linux"))]
    None
}

fn stamp(time: SystemTime) -> Option<Timestamp> {
    Timestamp::try_from(time).ok()
}

/// Rounds to the second. The very last time cannot be rounded and stays as it is.
fn to_second(time: Timestamp) -> String {
    time.round(Unit::Second).unwrap_or(time).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Seconds from 1970 to the year 10000, by the calendar: 8030 years with 1947 leap days.
    const YEAR_10000_S: u64 = (8030 * 365 + 1947) * 86_400;

    #[test]
    fn a_clock_beyond_the_calendar_has_no_time() {
        let at = |s: u64| stamp(SystemTime::UNIX_EPOCH + Duration::from_secs(s));
        assert_eq!(at(0).map(to_second).as_deref(), Some("1970-01-01T00:00:00Z"));
        assert_eq!(at(YEAR_10000_S - 7 * 86_400).map(to_second).as_deref(), Some("9999-12-25T00:00:00Z"));
        for beyond in [YEAR_10000_S, 2 * YEAR_10000_S, i64::MAX as u64] {
            assert_eq!(at(beyond), None, "{beyond}");
        }
        assert_eq!(stamp(SystemTime::UNIX_EPOCH - Duration::from_secs(2 * YEAR_10000_S)), None);
        let last = Timestamp::MAX;
        assert!(to_second(last).starts_with("9999-12-30T"), "{}", to_second(last));
    }
}
