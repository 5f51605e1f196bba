//! A check of times in the format of RFC 3339.

/// Whether a text is a time as in RFC 3339, section 5.6, such as `2026-03-01T12:00:00Z`, on an existing day.
#[must_use]
pub fn is_rfc3339(text: &str) -> bool {
    text.split_once(['T', 't', ' ']).is_some_and(|(date, time)| is_date(date) && is_time(time))
}

fn is_date(date: &str) -> bool {
    let Some((year, rest)) = date.split_once('-') else { return false };
    match (number(year, 4), pairs(rest, '-')) {
        (Some(year), Some([month, day])) => (1..=days(year, month)).contains(&day),
        _ => false,
    }
}

/// Number of days of a month, or 0 if there is no such month.
const fn days(year: u32, month: u32) -> u32 {
    match month {
        2 if year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400)) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => 0,
    }
}

fn is_time(time: &str) -> bool {
    let Some(at) = time.find(['Z', 'z', '+', '-']) else { return false };
    let (clock, offset) = time.split_at(at);
    let (clock, fraction) = clock.split_once('.').unwrap_or((clock, "0"));
    // second 60 is a leap second
    let is_clock = matches!(pairs(clock, ':'), Some([0..24, 0..60, 0..=60]));
    let is_offset =
        matches!(offset, "Z" | "z") || matches!(offset.get(1..).and_then(|of| pairs(of, ':')), Some([0..24, 0..60]));
    is_clock && is_offset && number(fraction, fraction.len()).is_some()
}

/// Reads `N` two-digit numbers that are separated by `mark`.
fn pairs<const N: usize>(text: &str, mark: char) -> Option<[u32; N]> {
    let mut parts = text.split(mark);
    let mut numbers = [0; N];
    for slot in &mut numbers {
        *slot = number(parts.next()?, 2)?;
    }
    parts.next().is_none().then_some(numbers)
}

/// Reads a number of exactly `digits` digits. A number beyond 32 bits becomes the largest one.
fn number(text: &str, digits: usize) -> Option<u32> {
    let is_number = digits > 0 && text.len() == digits && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u32::MAX))
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
