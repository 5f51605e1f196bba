//! A check of times in the format of RFC 3339.

use toml::value::Datetime;

/// Whether a text is a time as in RFC 3339, section 5.6, such as `2026-03-01T12:00:00Z`, on an existing day.
#[must_use]
pub fn is_rfc3339(text: &str) -> bool {
    // TOML also has times without a date, without seconds or without an offset
    match text.parse::<Datetime>() {
        Ok(Datetime { date: Some(_), time: Some(time), offset: Some(_) }) => time.second.is_some(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four examples of RFC 3339, section 5.8, and a leap day.
    #[test]
    fn the_times_of_rfc_3339_are_valid() {
        for time in [
            "1985-04-12T23:20:50.52Z",
            "1996-12-19T16:39:57-08:00",
            "1990-12-31T23:59:60Z",
            "1937-01-01T12:00:27.87+00:20",
            "2024-02-29 00:00:00z",
        ] {
            assert!(is_rfc3339(time), "{time}");
        }
    }

    #[test]
    fn a_day_that_does_not_exist_is_refused() {
        for time in [
            "2026-13-01T12:00:00Z",
            "2026-00-01T12:00:00Z",
            "2026-02-29T12:00:00Z",
            "2100-02-29T12:00:00Z",
            "2026-04-31T12:00:00Z",
            "2026-04-30T24:00:00Z",
            "2026-04-30T12:60:00Z",
            "2026-04-30T12:00:00+24:00",
            "2026-04-30T12:00:00",
            "2026-04-30T12:00Z",
            "12:00:00Z",
            "2026-04-30T12:00:00.Z",
            "2026-04-30T12:00:00é",
            "2026-4-30T12:00:00Z",
            "2026-04-30",
            "yesterday",
            "",
        ] {
            assert!(!is_rfc3339(time), "{time}");
        }
    }
}
