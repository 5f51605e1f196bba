//! Parses dates and times of day, as people and programs write them.

use jiff::civil::{Date, DateTime};
use jiff::tz::TimeZone;
use std::borrow::Cow;
use std::ops::Range;

/// The order of day and month in a date of numbers, such as 10/19/2023.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateOrder {
    DayFirst,
    MonthFirst,
}

/// The facts about times in a column, from its first cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DateColumn {
    /// True if nearly all cells are times of day, with or without a date, and they rise and hardly ever fall.
    pub are_times: bool,
    pub format: DateFormat,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DateFormat {
    /// The order of day and month, if a day above 12 or the points of a German date show it.
    pub order: Option<DateOrder>,
    /// The number of digits to which a fraction of a second must be filled with zeros in front: 3 if 5 ms are written
    /// as `12:00:01.5`, and 6 if the fraction counts µs. `None` for usual fractions.
    unpadded: Option<usize>,
    /// True if the field behind the third colon counts the frames of a second, as in a timecode. Such times are not
    /// read, because the number of frames is not known.
    has_frames: bool,
    /// True if no date stands beside the times, so that they may count more than 24 hours from the start of a log.
    counts_hours: bool,
}

/// Share of the cells that must be times, and of the rows, besides one, at which times may go back, as at midnight.
const TIMES: f64 = 0.95;
const FALLS: f64 = 0.01;

const DAY_NS: i64 = 86_400_000_000_000;

/// Largest number of digits of hours.
const HOUR_DIGITS: usize = 4;

/// The end of a duration of MATLAB, and a bound for durations, s, whose ns an i64 holds.
const SECONDS: &str = " sec";
const MAX_S: f64 = 9e9;

/// Least number of the last frame of a second in a timecode, which has 24 frames or more.
const FEWEST_FRAMES: i64 = 20;

impl DateColumn {
    pub fn of<'a>(cells: impl Iterator<Item = &'a str> + Clone) -> Self {
        let decided = cells.clone().find_map(order_of);
        let order = decided.or_else(|| cells.clone().find_map(dotted).map(|_| DateOrder::DayFirst));
        let has_frames = have_frames(cells.clone());
        let counts_hours = cells.clone().find_map(parts).is_some_and(|(date, _)| date.is_empty());
        let count = cells.clone().count() as f64;
        let with = |unpadded| {
            let format = DateFormat { order, unpadded, has_frames, counts_hours };
            let clear = cells.clone().filter(|cell| is_clear(cell));
            let times: Vec<i64> = clear.filter_map(|cell| nanoseconds(cell, format)).collect();
            let falls = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
            let rises = times.windows(2).any(|pair| pair[1] > pair[0]) && falls as f64 <= 1.0 + FALLS * count;
            (falls, Self { are_times: rises && times.len() as f64 >= TIMES * count, format })
        };
        let (falls, found) = with(None);
        let longest = cells.clone().filter_map(|cell| fraction(cell).map(|place| place.len())).max();
        let digits = longest.filter(|_| falls > 0).map(|longest| if longest <= 3 { 3 } else { 6 });
        let unpadded = digits.map(|digits| with(Some(digits))).filter(|(others, _)| others * 2 < falls);
        unpadded.map_or(found, |(_, unpadded)| unpadded)
    }
}

/// True if the fields behind the third colon count frames: two digits that stay below 60, leave few numbers out, and
/// fall where a second begins. Hundredths of a second reach higher numbers.
fn have_frames<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let frames: Vec<i64> = cells.filter_map(frame).collect();
    let last = frames.iter().max().copied().unwrap_or_default();
    let numbers = (0..=last).filter(|number| frames.contains(number)).count() as i64;
    (FEWEST_FRAMES..60).contains(&last) && 2 * numbers > last + 1 && frames.windows(2).any(|pair| pair[1] < pair[0])
}

/// The field of two digits behind the third colon of a time.
fn frame(cell: &str) -> Option<i64> {
    let field = cell.splitn(4, ':').nth(3).filter(|field| field.len() == 2 && parts(cell).is_some())?;
    number(field, 2)
}

/// The range of the digits of the fraction of a second in a time.
fn fraction(cell: &str) -> Option<Range<usize>> {
    let colon = cell.find(':')?;
    let rest = &cell[colon..];
    let mark = rest.find(['.', ',']).or_else(|| rest.match_indices(':').nth(2).map(|(at, _)| at))? + colon + 1;
    let digits = cell[mark..].bytes().take_while(u8::is_ascii_digit).count();
    (digits > 0).then_some(mark..mark + digits)
}

/// False for most cells without a colon, and for 12:30 alone: hours and minutes, or minutes and seconds.
fn is_clear(cell: &str) -> bool {
    let has_more = |c: char| !c.is_ascii_digit() && c != ':';
    cell.matches(':').count() > 1 || cell.contains(':') && cell.contains(has_more) || cell.ends_with(SECONDS)
}

/// Time in ns: of a date with a time of day since the epoch, or of a time of day alone since midnight. A date without
/// a zone is taken as UTC, which no interval depends on. If the order of day and month is not known, only the time of
/// day counts.
pub fn nanoseconds(cell: &str, format: DateFormat) -> Option<i64> {
    let DateFormat { order, unpadded, has_frames, counts_hours } = format;
    if has_frames && frame(cell).is_some() {
        return None;
    }
    if let Some((digits, place)) = unpadded.zip(fraction(cell)) {
        let padded = format!("{}{:0>digits$}{}", &cell[..place.start], &cell[place.clone()], &cell[place.end..]);
        return nanoseconds(&padded, DateFormat { unpadded: None, ..format });
    }
    of_duration(cell).or_else(|| of_iso(cell)).or_else(|| {
        let (fields, clock_ns) = parts(cell)?;
        let is_of_day = clock_ns < DAY_NS;
        match fields.is_empty() {
            true => Some(clock_ns).filter(|_| is_of_day || counts_hours),
            false => date_ns(&fields, order)?.checked_add(clock_ns).filter(|_| is_of_day),
        }
    })
}

/// The reason why a cell that looks like a time cannot be read.
pub fn reason(cell: &str) -> Option<&'static str> {
    let looks_like_time = cell.starts_with(|c: char| c.is_ascii_digit()) && cell.contains(':');
    looks_like_time.then_some(match minutes(cell) {
        Some(_) => {
            "lacks the hour and all digits behind the tenths, as Excel shows times; format the column as yyyy-mm-dd \
             hh:mm:ss.000 and export it again"
        }
        None if frame(cell).is_some() => "is a timecode that ends with a number of frames; write decimals of a second",
        None => "is not a time such as 2026-03-01 12:00:00.25 or 12:00:00.25",
    })
}

/// The tenths of a time in Excel's form `mm:ss.0`; `None` for any other cell.
fn minutes(cell: &str) -> Option<&str> {
    let (minutes, seconds) = cell.split_once(':')?;
    let (seconds, tenths) = seconds.split_once(['.', ','])?;
    let all_digits = [minutes, seconds, tenths].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()));
    (all_digits && seconds.len() == 2 && tenths.len() == 1).then_some(tenths)
}

/// The time in ns of a duration as MATLAB writes it: `0.01 sec`.
fn of_duration(cell: &str) -> Option<i64> {
    let s: f64 = cell.strip_suffix(SECONDS)?.parse().ok()?;
    (0.0..MAX_S).contains(&s).then(|| (s * 1e9).round() as i64)
}

/// The time, ns since the epoch, of a date such as 2026-03-01T12:00:00Z or 2026/03/01 12:00:00Z.
fn of_iso(cell: &str) -> Option<i64> {
    let is_slashed = cell.get(4..5) == Some("/") && cell.get(7..8) == Some("/");
    let cell = if is_slashed { Cow::Owned(cell.replacen('/', "-", 2)) } else { Cow::Borrowed(cell) };
    let cell = [" UTC", " GMT"].iter().find_map(|zone| cell.strip_suffix(zone)).unwrap_or(&cell);
    let stamp: jiff::Timestamp = cell.parse().ok().or_else(|| {
        let local: DateTime = cell.parse().ok()?;
        Some(local.to_zoned(TimeZone::UTC).ok()?.timestamp())
    })?;
    i64::try_from(stamp.as_nanosecond()).ok()
}

/// The fields of the date of a cell, without the day of the week, and its time of day in ns.
fn parts(cell: &str) -> Option<(Vec<&str>, i64)> {
    let mut words: Vec<&str> = cell.split_whitespace().map(|word| word.trim_end_matches(',')).collect();
    let at = words.iter().position(|word| word.contains(':'))?;
    let half = words.get(at + 1).and_then(|word| Half::of(word));
    let clock_ns = clock_ns(words[at], half)?;
    words.drain(at..=at + usize::from(half.is_some()));
    let is_date = |word: &&&str| !is_weekday(word) && !["UTC", "GMT"].contains(*word);
    Some((words.iter().filter(is_date).flat_map(|word| word.split(['/', '-', '.'])).collect(), clock_ns))
}

/// AM or PM of a twelve-hour clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    Morning,
    Afternoon,
}

impl Half {
    fn of(word: &str) -> Option<Self> {
        match &*word.replace('.', "").to_lowercase() {
            "am" => Some(Self::Morning),
            "pm" => Some(Self::Afternoon),
            _ => None,
        }
    }
}

/// A time of day in ns since midnight, or a time since the start of a log, whose hours may exceed 23: 7:05,
/// 7:05:01.25, 7:05:01,25 or 7:05:01:250, or 05:01.250 since the hour.
fn clock_ns(word: &str, half: Option<Half>) -> Option<i64> {
    let end = word.trim_end_matches(|c: char| c.is_alphabetic());
    let half = if end.len() < word.len() { Some(Half::of(&word[end.len()..])?) } else { half };
    let fields: Vec<&str> = end.split([':', '.', ',']).collect();
    let colons = end.matches(':').count();
    let (whole, rest) = match (colons, &fields[..]) {
        (1, [h, m]) => ([*h, *m, "0"], ""),
        (1, [m, s, rest]) if rest.len() > 1 => (["0", *m, *s], *rest),
        (2, [h, m, s]) => ([*h, *m, *s], ""),
        (2, [h, m, s, rest]) | (3, [h, m, s, rest]) => ([*h, *m, *s], *rest),
        _ => return None,
    };
    let [h, m, s] = [(0, HOUR_DIGITS), (1, 2), (2, 2)].map(|(at, digits)| number(whole[at], digits));
    let (h, m, s) = (h?, m.filter(|m| *m < 60)?, s.filter(|s| *s < 60)?);
    let h = match half {
        None => h,
        Some(half) => Some(h).filter(|h| (1..=12).contains(h))? % 12 + if half == Half::Afternoon { 12 } else { 0 },
    };
    let digits = rest.get(..9).unwrap_or(rest);
    let fraction_ns = if rest.is_empty() { 0 } else { number(digits, 9)? * 10i64.pow(9 - digits.len() as u32) };
    Some((h * 3600 + m * 60 + s) * 1_000_000_000 + fraction_ns)
}

/// The start of a day in ns since the epoch, or 0 if the order of day and month, or the century, is not known.
fn date_ns(fields: &[&str], order: Option<DateOrder>) -> Option<i64> {
    let &[one, two, three] = fields else { return None };
    let (year, month, day) = match (month(one), month(two)) {
        (Some(month), _) => (three, month, number(two, 2)?),
        (None, Some(month)) if one.len() == 4 => (one, month, number(three, 2)?),
        (None, Some(month)) => (three, month, number(one, 2)?),
        (None, None) if one.len() == 4 => (one, number(two, 2)?, number(three, 2)?),
        (None, None) => {
            let (one, two) = (number(one, 2)?, number(two, 2)?);
            match order {
                Some(DateOrder::DayFirst) => (three, two, one),
                Some(DateOrder::MonthFirst) => (three, one, two),
                None => return number(three, 4).filter(|_| one <= 12 && two <= 12).map(|_| 0),
            }
        }
    };
    let year = if year.len() == 4 { number(year, 4)? } else { return number(year, 2).map(|_| 0) };
    let date = Date::new(year as i16, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()?;
    i64::try_from(date.to_zoned(TimeZone::UTC).ok()?.timestamp().as_nanosecond()).ok()
}

/// The order of day and month, if the numbers of this date decide it.
fn order_of(cell: &str) -> Option<DateOrder> {
    let fields = parts(cell)?.0;
    let [one, two] = [fields.first()?, fields.get(1)?].map(|field| number(field, 2));
    match (one?, two?) {
        (13.., _) => Some(DateOrder::DayFirst),
        (_, 13..) => Some(DateOrder::MonthFirst),
        _ => None,
    }
}

/// A date with points between its numbers, which Germans write with the day first.
fn dotted(cell: &str) -> Option<&str> {
    cell.split_whitespace().find(|word| !word.contains(':') && word.matches('.').count() == 2)
}

fn number(field: &str, digits: usize) -> Option<i64> {
    let is_number = (1..=digits).contains(&field.len()) && field.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| field.parse().ok())?
}

/// The number of an English or German month.
fn month(field: &str) -> Option<i64> {
    let months = "jan feb mar|mär|mrz apr may|mai jun jul aug sep oct|okt nov dec|dez";
    let field = field.to_lowercase();
    let at = months.split(' ').position(|names| names.split('|').any(|name| field.starts_with(name)))?;
    Some(at as i64 + 1)
}

fn is_weekday(word: &str) -> bool {
    let word = word.to_lowercase();
    let days = ["mon", "tue", "wed", "thu", "fri", "sat", "sun"];
    days.iter().any(|day| word == *day || word.starts_with(day) && word.ends_with("day"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2023-10-19 11:59:55.01 UTC.
    const NS: i64 = 1_697_716_795_010_000_000;

    #[test]
    fn the_same_moment_has_many_spellings() {
        for cell in [
            "2023-10-19T11:59:55.01Z",
            "2023-10-19 11:59:55.010",
            "2023-10-19 11:59:55.01 UTC",
            "2023/10/19 11:59:55.01",
            "2023/10/19 11:59:55:010",
            "19-Oct-2023 11:59:55.010",
            "19-Okt-2023 11:59:55,010",
            "19 October 2023 11:59:55.01",
            "Oct 19, 2023 11:59:55.01 AM",
            "Thu Oct 19 11:59:55.010 2023",
            "19.10.2023 11:59:55,010",
            "19.10.2023, 11:59:55,010",
            "19/10/2023 11:59:55.010",
            "10/19/2023 11:59:55.010 AM",
            "10/19/2023 11:59:55.010\u{202F}a.m.",
            "10/19/2023 11:59:55.01AM",
        ] {
            let column = DateColumn::of([cell].into_iter());
            assert_eq!(nanoseconds(cell, column.format), Some(NS), "{cell}");
        }
    }

    #[test]
    fn hours_of_twelve_begin_with_twelve() {
        let s = |cell| nanoseconds(cell, DateFormat::default()).map(|ns| ns / 1_000_000_000);
        let cases = [("12:00:01 AM", 1), ("1:00:00 am", 3600), ("12:00:00 PM", 43_200), ("11:59:59 pm", 86_399)];
        cases.into_iter().for_each(|(cell, expected)| assert_eq!(s(cell), Some(expected), "{cell}"));
        assert_eq!((s("13:00:00 PM"), s("0:30:00 AM"), s("24:00:00"), s("12:60:00")), (None, None, None, None));
    }

    /// The time of day is known even if 5/6 may be in May or in June.
    #[test]
    fn a_date_without_an_order_does_not_count() {
        let ns = |cell, order| nanoseconds(cell, DateFormat { order, ..DateFormat::default() });
        assert_eq!(ns("05/06/2026 07:08 PM", None), ns("19:08", None));
        assert_eq!(ns("13/06/2026 07:08", None), None);
        assert_eq!(ns("05/13/2026 07:08", Some(DateOrder::DayFirst)), None);
    }

    #[test]
    fn other_words_are_not_times() {
        let others = [
            "59:55.0",
            "2023-10-19",
            "1.2.3",
            "a:b",
            "12",
            "rst:0x1",
            "::",
            "1:2:3:4:5",
            "12:00:00 x",
            "00:1B:44:11",
            "Marked 12:00:00",
            "12:00:00.x",
        ];
        for other in others {
            assert!(other == "2023-10-19" || nanoseconds(other, DateFormat::default()).is_none(), "{other}");
        }
        assert!(reason("59:55.0").is_some_and(|why| why.contains("Excel")));
        assert!(reason("59:55.010").is_some_and(|why| !why.contains("Excel")));
    }

    /// `%d` writes 5 ms as 5. A program that drops zeros at the end writes half a second as 5, too.
    #[test]
    fn fractions_without_zeros_in_front_are_told_by_their_order() {
        let first_ms = |cells: &[&str]| {
            let column = DateColumn::of(cells.iter().copied());
            assert!(column.are_times, "{cells:?}");
            nanoseconds(cells[0], column.format).unwrap() % 1_000_000_000 / 1_000_000
        };
        let unpadded: Vec<String> = (0..200).map(|row| format!("12:00:{}.{}", row / 20, 5 + row % 20 * 50)).collect();
        let unpadded: Vec<&str> = unpadded.iter().map(String::as_str).collect();
        assert_eq!(first_ms(&unpadded), 5);
        assert_eq!(
            first_ms(&[
                "2026-03-01 12:00:00:90",
                "2026-03-01 12:00:00:100",
                "2026-03-01 12:00:00:110",
                "2026-03-01 12:00:01:0",
                "2026-03-01 12:00:01:10"
            ]),
            90
        );
        assert_eq!(first_ms(&["12:00:00.5", "12:00:00.75", "12:00:01", "12:00:01.25"]), 500);
    }

    /// A timecode of 25 frames a second, and hundredths of a second.
    #[test]
    fn frames_are_not_parts_of_a_second() {
        let read = |per_s: u32, step: u32| {
            let cell = |row: u32| format!("10:00:{:02}:{:02}", row * step / per_s, row * step % per_s);
            let cells: Vec<String> = (0..120).map(cell).collect();
            let cells: Vec<&str> = cells.iter().map(String::as_str).collect();
            let column = DateColumn::of(cells.iter().copied());
            (column.are_times, nanoseconds(cells[1], column.format).map(|ns| ns / 10_000_000 % 100))
        };
        assert_eq!([read(25, 1), read(60, 1)], [(false, None); 2]);
        assert_eq!([read(100, 1), read(100, 50)], [(true, Some(1)), (true, Some(50))]);
        assert!(reason("10:00:00:01").is_some_and(|why| why.contains("timecode")));
    }

    #[test]
    fn a_duration_of_matlab_is_a_time() {
        let ns = |cell| nanoseconds(cell, DateFormat::default());
        assert_eq!((ns("0 sec"), ns("12.345 sec")), (Some(0), Some(12_345_000_000)));
        assert_eq!((ns("1e30 sec"), ns("x sec")), (None, None));
    }

    #[test]
    fn a_column_of_times_rises() {
        let are_times = |cells: &[&str]| DateColumn::of(cells.iter().copied()).are_times;
        assert!(are_times(&["0 sec", "0.01 sec", "0.02 sec"]) && !are_times(&["1 sec", "1 sec", "1 sec"]));
        assert!(are_times(&["23:59:59.9", "00:00:00.0", "00:00:00.1"]));
        let long = DateColumn::of(["23:59:59.9", "24:00:00.0", "100:00:00.1"].into_iter());
        assert!(long.are_times && nanoseconds("25:00:00.5", long.format) == Some(90_000_500_000_000));
        assert!(!are_times(&["2026-03-01 24:00:01", "2026-03-01 24:00:02"]));
        assert!(are_times(&["1 Mar 2026 12:00", "1 Mar 2026 12:01"]) && !are_times(&["12:00", "12:01"]));
        assert!(!are_times(&["12:00:00", "12:00:00"]) && !are_times(&["2026-01-01", "2026-01-02"]));
        assert!(!are_times(&["00:00:02", "00:00:01", "00:00:03", "00:00:00"]), "a duration");
    }
}
