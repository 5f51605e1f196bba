//! Repairs rows whose times are out of order. It unwraps a counter that wrapped around, sorts rows that were swapped,
//! drops duplicate rows, and follows a clock that was set back. Each repair is counted and reported. If repairs are
//! too frequent, the log is refused, and the error names the place.

use super::clock::Times;
use super::middle::median;
use crate::raw_columns::RawColumn;
use zerorate_input::TimeUnit;

/// The values at which counters wrap around, in their own unit, with the text about it: counters of 16, 24 and 32
/// bits, 32-bit counters of µs that were written in s or ms, and the times of an hour, a day and a week.
const MODULI: [(&str, &[f64]); 4] = [
    (COUNTER, &[65_536.0, 16_777_216.0, 4_294_967_296.0, 4_294.967_296, 4_294_967.296]),
    ("the time of the hour starts again", &[3.6e12]),
    ("the time of day passes midnight", &[86_400.0, 8.64e7, 8.64e10, 8.64e13]),
    ("the time of the week starts again", &[604_800.0, 6.048e8, 6.048e11]),
];
const COUNTER: &str = "the counter wraps around at";

/// A step back in time is a wrap only if the rows around it are within this many intervals of the place of the wrap.
const AT_WRAP: f64 = 1000.0;

/// Largest distance of these rows from the place of the wrap, as a share of the modulus. A log that was started again
/// may end anywhere.
const AT_MOST: f64 = 1.0 / 16.0;

/// Largest number of rows by which a row may be late. The queue of a bag reorders rows by up to this number.
const NEAR: usize = 64;

/// Largest share of the rows that may be out of order.
const MAX_SWAPPED: f64 = 0.05;

/// Largest share of the rows whose stamps may be wrong, for example because of a bad cable.
const MAX_STRAY: f64 = 0.01;

/// Largest step back of a clock, as a share of the whole time. A larger step probably begins another log.
const MAX_STEP: f64 = 0.01;

/// Largest share of the rows at which a clock may be set back.
const MAX_STEPS: f64 = 0.001;

/// Share of the rows that repeat the stamp of the row before, above which the clock counts as coarse.
const COARSE: f64 = 0.05;

/// The reason for a refusal if more rows are late than are sorted.
pub const UNSORTED: &str = "rows are not in the order of their times";

/// Puts rows in the order of their times. Returns the texts about the repairs, or the reason why repair is impossible.
pub fn repair_times(times: &mut Times, columns: &mut [RawColumn]) -> Result<Vec<String>, String> {
    if times.since_first().is_sorted_by(|one, next| one < next) {
        return Ok(Vec::new());
    }
    let Some(interval) = times.interval() else {
        let all = times.since_first();
        let falls = all.windows(2).position(|pair| pair[1] < pair[0]);
        return Err(match falls {
            Some(at) => {
                format!("the time goes back by {}, at row {}", lapse(all[at] - all[at + 1], times.unit), at + 1)
            }
            None => format!("the time stands still at {}", times.first()),
        });
    };
    let first = times.first();
    let mut said = Vec::new();
    let mut rows = timed_rows(times);
    said.extend(restamp(&mut rows, interval));
    said.extend(unwrap(&mut rows, first, interval));
    said.extend(sort(&mut rows, (first, times.unit), interval)?);
    said.extend(separate(&mut rows, columns, interval)?);
    let start = rows.first().map_or(0.0, |first| first.time);
    times.replace(rows.iter().map(|row| row.time - start).collect());
    let order: Vec<usize> = rows.iter().map(|row| row.row).collect();
    if !order.iter().copied().eq(0..columns.first().map_or(0, |column| column.values.rows() as usize)) {
        columns.iter_mut().for_each(|column| column.values.reorder(&order));
    }
    Ok(said)
}

/// Unwraps a counter of ticks, in its own steps. Returns the text about it.
pub fn unwrap_ticks(times: &mut Times) -> Option<String> {
    let (mut rows, first, interval) = (timed_rows(times), times.first(), times.interval()?);
    // a wrong stamp is not a wrap
    let stray = restamp(&mut rows, interval);
    let wraps = unwrap(&mut rows, first, interval)?;
    times.replace(rows.iter().map(|row| row.time).collect());
    Some(stray.into_iter().chain([wraps]).collect::<Vec<_>>().join("; "))
}

/// A row of the file, and its time since the first row, in the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimedRow {
    row: usize,
    time: f64,
}

fn timed_rows(times: &Times) -> Vec<TimedRow> {
    times.since_first().iter().enumerate().map(|(row, time)| TimedRow { row, time: *time }).collect()
}

/// Replaces the time of a row that is not between its neighbours, if exactly one row fits between them.
fn restamp(rows: &mut [TimedRow], interval: f64) -> Option<String> {
    let is_stray = |around: &[TimedRow]| {
        let [before, time, next] = [around[0].time, around[1].time, around[2].time];
        let room = (next - before) / interval;
        (1.5..2.5).contains(&room) && (time < before - 0.5 * interval || time > next + 0.5 * interval)
    };
    let stray: Vec<usize> = (1..rows.len().saturating_sub(1)).filter(|at| is_stray(&rows[at - 1..at + 2])).collect();
    let first = stray.first().filter(|_| stray.len() as f64 <= (MAX_STRAY * rows.len() as f64).max(1.0))?;
    stray.iter().for_each(|at| rows[*at].time = 0.5 * (rows[at - 1].time + rows[at + 1].time));
    let rows = rows_that(stray.len(), "has a wrong stamp", "have a wrong stamp");
    Some(format!("{rows}, which is replaced (the first: row {first})"))
}

fn rows_that(count: usize, one: &str, many: &str) -> String {
    if count == 1 { format!("1 row {one}") } else { format!("{count} rows {many}") }
}

/// Unwraps a counter that counts from zero, or from minus to plus half of its modulus.
fn unwrap(rows: &mut [TimedRow], first: f64, interval: f64) -> Option<String> {
    let margin = AT_WRAP * interval;
    let (mut added, mut found) = (0.0, Vec::new());
    let mut before = rows.first()?.time;
    for row in rows {
        let now = row.time;
        if now < before {
            let mut all = MODULI.iter().flat_map(|(what, moduli)| moduli.iter().map(move |modulus| (*what, *modulus)));
            let wrap = all.find(|(_, modulus)| {
                let margin = margin.min(modulus * AT_MOST);
                let from = |start: f64| {
                    let (before, now) = (first + before - start, first + now - start);
                    before <= *modulus && before > modulus - margin && (-interval..margin).contains(&now)
                };
                (from(0.0) || from(-modulus / 2.0)) && now + modulus > before
            });
            if let Some((what, modulus)) = wrap {
                added += modulus;
                found.push((row.row, what, modulus));
            }
        }
        before = now;
        row.time += added;
    }
    let (row, what, modulus) = *found.first()?;
    let times = found.len();
    let what = if what == COUNTER { format!("{what} {modulus}") } else { what.to_owned() };
    Some(match times {
        1 => format!("{what} (once, at row {row})"),
        _ => format!("{what} ({times} times, first at row {row})"),
    })
}

/// Sorts rows that are late, and follows a clock that was set back.
fn sort(rows: &mut [TimedRow], (first, unit): (f64, Option<TimeUnit>), interval: f64) -> Result<Vec<String>, String> {
    let span = rows.iter().fold(0.0_f64, |most, row| most.max(row.time.abs()));
    let (mut swapped, mut steps) = (Vec::new(), Vec::new());
    let mut row = 1;
    while row < rows.len() {
        let step = rows[row - 1].time - rows[row].time;
        if step <= 0.0 {
            row += 1;
        } else if let Some((from, to)) = late(rows, row, interval) {
            swapped.push((to - row, rows[row].row));
            rows[from..to].sort_by(|one, other| one.time.total_cmp(&other.time));
            row = to;
        } else {
            let at = rows[row].row;
            let place = match unit {
                Some(_) => format!("at row {at}"),
                None => format!("at row {at} from {} to {}", first + rows[row - 1].time, first + rows[row].time),
            };
            steps.push((step, place));
            if step > MAX_STEP * span || steps.len() as f64 > (MAX_STEPS * rows.len() as f64).max(1.0) {
                return Err(set_back(&steps, unit));
            }
            rows[row..].iter_mut().for_each(|row| row.time += step + interval);
            row += 1;
        }
    }
    let moved: usize = swapped.iter().map(|(rows, _)| rows).sum();
    if moved as f64 > MAX_SWAPPED * rows.len() as f64 + 1.0 {
        return Err(format!("{moved} of {} {UNSORTED}", rows.len()));
    }
    let late = rows_that(moved, "comes too late and is sorted", "come too late and are sorted");
    let sorted = swapped.first().map(|(_, row)| format!("{late} (the first: row {row})"));
    let followed = (!steps.is_empty()).then(|| set_back(&steps, unit));
    Ok(sorted.into_iter().chain(followed).collect())
}

fn set_back(steps: &[(f64, String)], unit: Option<TimeUnit>) -> String {
    let (step, place) = &steps[steps.len() - 1];
    let step = lapse(*step, unit);
    match steps.len() {
        1 => format!("the time goes back by {step}, {place}"),
        several => format!("the time goes back {several} times, last by {step}, {place}"),
    }
}

/// A time between rows as text: in seconds if its unit is known, or else as in the file.
fn lapse(time: f64, unit: Option<TimeUnit>) -> String {
    // the last digits come from the subtraction
    let rounded = |time: f64| format!("{time:.8e}").parse().unwrap_or(time);
    unit.map_or_else(|| rounded(time).to_string(), |unit| format!("{} s", rounded(time / unit.per_s())))
}

/// The range of rows to sort, if `row` and the rows behind it are late: they fill a hole in the times before them. A
/// clock that was set back leaves no hole.
fn late(rows: &[TimedRow], row: usize, interval: f64) -> Option<(usize, usize)> {
    let latest = rows[row - 1].time;
    let behind = &rows[row..rows.len().min(row + NEAR)];
    let length = behind.iter().position(|row| row.time > latest);
    let length = length.or_else(|| (row + behind.len() == rows.len()).then_some(behind.len()))?;
    let to = row + length;
    let earliest = behind[..length].iter().fold(f64::INFINITY, |least, row| least.min(row.time));
    let before = &rows[row.saturating_sub(NEAR)..row];
    let from = row - before.iter().rev().position(|row| row.time <= earliest)?;
    let end = rows.get(to).map_or(latest, |row| row.time);
    let intervals = (to - from) as f64 + if to < rows.len() { 1.0 } else { 0.0 };
    let has_hole = end - rows[from - 1].time >= (intervals - 0.5) * interval;
    has_hole.then_some((from, to))
}

/// Drops duplicate rows, and gives other rows that share a stamp times of their own.
fn separate(rows: &mut Vec<TimedRow>, columns: &[RawColumn], interval: f64) -> Result<Vec<String>, String> {
    let shared = rows.windows(2).filter(|pair| pair[0].time == pair[1].time).count();
    if shared == 0 {
        return Ok(Vec::new());
    }
    let values: Vec<Vec<f64>> = columns.iter().map(|column| column.values.rows_as_numbers()).collect();
    let same = |one: TimedRow, other: TimedRow| {
        let equal = |column: &Vec<f64>| {
            let [one, other] = [one, other].map(|row| column[row.row]);
            one == other || one.is_nan() && other.is_nan()
        };
        values.iter().all(equal)
    };
    let equal = rows.windows(2).filter(|pair| pair[0].time == pair[1].time && same(pair[0], pair[1])).count();
    let is_coarse = shared as f64 > COARSE * rows.len() as f64 && (equal as f64) < 0.9 * shared as f64;
    let fine = if is_coarse { fine_interval(rows) } else { Some(interval) };
    let fine = fine.ok_or("its clock makes fewer than two whole steps, which tell no rate")?;
    if let Some(said) = is_coarse.then(|| spread_evenly(rows, fine)).flatten() {
        return Ok(said);
    }
    let mut kept: Vec<TimedRow> = Vec::with_capacity(rows.len());
    let (mut dropped, mut wrong) = (Vec::new(), Vec::new());
    let mut start = 0;
    while start < rows.len() {
        let time = rows[start].time;
        let end = start + rows[start..].iter().take_while(|row| row.time == time).count();
        let last = if is_coarse { fine * (end - start) as f64 } else { interval };
        let until = rows.get(end).map_or(last, |next| next.time - time);
        let room = ((until / interval).round().max(1.0)).min((end - start) as f64) as usize;
        let mut surplus = if is_coarse { 0 } else { end - start - room };
        let first = kept.len();
        for row in start..end {
            if row > start && surplus > 0 && same(rows[row - 1], rows[row]) {
                surplus -= 1;
                dropped.push(rows[row].row);
            } else {
                kept.push(rows[row]);
            }
        }
        let own = kept.len() - first;
        let step = Some(until / own as f64).filter(|step| *step < 1.5 * fine).unwrap_or(fine);
        // a coarse clock had begun its first step before the log began
        let begin = if is_coarse && start == 0 { (until - fine * own as f64).max(0.0) } else { 0.0 };
        let step = if begin > 0.0 { fine } else { step };
        for (at, row) in kept[first..].iter_mut().enumerate() {
            row.time = time + begin + step * at as f64;
        }
        wrong.extend(kept[first..].iter().skip(1).map(|row| row.row));
        start = end;
    }
    *rows = kept;
    Ok(said_of(&dropped, &wrong, is_coarse))
}

fn said_of(dropped: &[usize], wrong: &[usize], is_coarse: bool) -> Vec<String> {
    let dropped = dropped.first().map(|row| {
        let rows = rows_that(dropped.len(), "repeats the row before and is", "repeat the row before and are");
        format!("{rows} dropped (the first: row {row})")
    });
    let wrong = wrong.first().map(|row| {
        let why = if is_coarse { "coarse clock, or several sensors?" } else { "a wrong one" };
        let rows = rows_that(wrong.len(), "repeats", "repeat");
        format!("{rows} a stamp ({why}), but no row is dropped (the first: row {row})")
    });
    dropped.into_iter().chain(wrong).collect()
}

/// Largest share of the rows whose stamps may disagree with evenly spaced times under a coarse clock.
const UNEVEN: f64 = 0.002;

/// Gives rows under a coarse clock even times, if its stamps agree with them. Returns the text about it.
fn spread_evenly(rows: &mut [TimedRow], fine: f64) -> Option<Vec<String>> {
    let times = even_times(rows, fine)?;
    let wrong: Vec<usize> =
        rows.windows(2).filter(|pair| pair[0].time == pair[1].time).map(|pair| pair[1].row).collect();
    rows.iter_mut().zip(times).for_each(|(row, time)| row.time = time);
    Some(said_of(&[], &wrong, true))
}

/// Evenly spaced times that agree with the stamps of a coarse clock. A stamp is the time of the last step of the clock
/// before the row. `None` if too many stamps disagree, because samples are lost or come unevenly.
fn even_times(rows: &[TimedRow], fine: f64) -> Option<Vec<f64>> {
    let step = clock_step(rows);
    let slack = fine / 2.0;
    let (mut time, mut misfits) = (rows.first()?.time, 0);
    let mut even = |(at, row): (usize, &TimedRow)| {
        let next = if at == 0 { time } else { time + fine };
        time = next.clamp(row.time - slack, row.time + step + slack);
        misfits += usize::from(time != next);
        time
    };
    let times: Vec<f64> = rows.iter().enumerate().map(&mut even).collect();
    (misfits as f64 <= UNEVEN * rows.len() as f64 + 1.0).then_some(times)
}

fn clock_step(rows: &[TimedRow]) -> f64 {
    let steps = rows.windows(2).map(|pair| pair[1].time - pair[0].time).filter(|step| *step > 0.0);
    median(&mut steps.collect::<Vec<f64>>())
}

/// The interval of the samples under a clock of coarse steps: the total time of the steps of usual length over the
/// number of rows in them. The first and the last step do not count, because they may not be whole. `None` without
/// other steps.
fn fine_interval(rows: &[TimedRow]) -> Option<f64> {
    let starts: Vec<usize> =
        (0..rows.len()).filter(|at| *at == 0 || rows[*at].time > rows[at - 1].time).skip(1).collect();
    let steps = || starts.windows(2).map(|pair| (rows[pair[1]].time - rows[pair[0]].time, pair[1] - pair[0]));
    let usual = median(&mut steps().map(|(time, _)| time).collect::<Vec<f64>>());
    let whole = steps().filter(|(time, _)| *time < 1.5 * usual);
    let (time, count) = whole.fold((0.0, 0), |(time, count), (more, rows)| (time + more, count + rows));
    (count > 0).then(|| time / count as f64)
}

#[cfg(test)]
mod tests {
    use super::super::series::{Series, SeriesBuilder};
    use super::*;
    use zerorate_input::limits::MemoryBudget;

    /// Repairs times and values as a file has them. Returns the times, the values and the texts.
    fn mended(rows: &[(f64, f64)]) -> Result<(Vec<f64>, Vec<f64>, String), String> {
        let mut times = Times::new();
        let mut values = SeriesBuilder::sharing(MemoryBudget::of(0), 1);
        for (time, value) in rows {
            times.push_number(*time)?;
            values.push_number(*value);
        }
        let mut columns = [RawColumn::new("x".to_owned(), values)];
        let said = repair_times(&mut times, &mut columns)?;
        let [column] = columns;
        let Ok((Series::Numbers(values), _)) = column.values.finish(&[]) else { panic!("numbers") };
        Ok((times.since_first().to_vec(), values, said.join("; ")))
    }

    fn even(rows: usize) -> Vec<(f64, f64)> {
        (0..rows).map(|row| (10.0 + row as f64, 0.5 * row as f64)).collect()
    }

    fn is_even(times: &[f64], rows: usize) -> bool {
        times.len() == rows && times.windows(2).all(|pair| (pair[1] - pair[0] - 1.0).abs() < 1e-9)
    }

    /// Samples at 100 Hz, stamped by the clock of Windows, which steps by 15.625 ms.
    #[test]
    fn rows_under_a_clock_of_15_6_ms_are_even() {
        let rows: Vec<(f64, f64)> = (0..6000)
            .map(|k| ((0.01 * f64::from(k) / 0.015_625).floor() * 0.015_625, 0.1 * f64::from(k % 7)))
            .collect();
        let (times, _, said) = mended(&rows).unwrap();
        let off = times.windows(2).map(|pair| (pair[1] - pair[0] - 0.01).abs()).fold(0.0, f64::max);
        assert!(times.len() == 6000 && off < 1e-4, "{off}: {said}");
    }

    #[test]
    fn a_row_that_is_there_twice_is_dropped() {
        let mut rows = even(100);
        rows.insert(40, rows[39]);
        let (times, values, said) = mended(&rows).unwrap();
        assert!(is_even(&times, 100) && values[40] == 20.0, "{times:?}");
        assert!(
            said.contains("1 row repeats the row before and is dropped") && said.contains("first: row 40"),
            "{said}"
        );
        let twice: Vec<_> = even(50).into_iter().flat_map(|row| [row, row]).collect();
        assert!(is_even(&mended(&twice).unwrap().0, 50));
    }

    /// A stamp is repeated, but the sample with it belongs to the next stamp.
    #[test]
    fn a_sample_with_a_wrong_stamp_counts() {
        let mut rows = even(100);
        rows[40].0 = rows[39].0;
        let (times, values, said) = mended(&rows).unwrap();
        assert!(is_even(&times, 100) && values[40] == 20.0, "{times:?}");
        assert!(said.contains("1 row repeats a stamp (a wrong one)"), "{said}");
        // values that are equal by chance do not make a row a duplicate if there is time for a sample
        rows[40].1 = rows[39].1;
        assert_eq!(mended(&rows).unwrap().0.len(), 100);
        // 1.6 samples to a step of the clock
        let coarse: Vec<_> = (0..160).map(|row| ((f64::from(row) / 1.6).floor(), f64::from(row % 2))).collect();
        let (times, _, said) = mended(&coarse).unwrap();
        assert!(times.len() == 160 && said.contains("coarse clock"), "{said}");
    }

    #[test]
    fn rows_that_are_late_are_sorted() {
        let mut rows = even(100);
        rows.swap(40, 41);
        let late = rows.remove(60);
        rows.insert(65, late);
        rows.swap(98, 99);
        let (times, values, said) = mended(&rows).unwrap();
        assert!(is_even(&times, 100) && values.is_sorted(), "{said}");
        assert!(said.contains("3 rows come too late and are sorted (the first: row 41)"), "{said}");
    }

    #[test]
    fn counters_are_unwrapped() {
        for (modulus, step) in [(65_536.0, 100.0), (4_294_967_296.0, 5000.0), (4_294.967_296, 0.005)] {
            let time = |row: i32| (modulus - 300.5 * step + f64::from(row) * step) % modulus;
            let rows: Vec<_> = (0..600).map(|row| (time(row), f64::from(row))).collect();
            let (times, _, said) = mended(&rows).unwrap();
            assert!(times.windows(2).all(|pair| ((pair[1] - pair[0]) / step - 1.0).abs() < 1e-6), "{modulus}");
            assert!(said.contains(&format!("wraps around at {modulus} (once, at row 301)")), "{said}");
        }
    }

    #[test]
    fn counters_wrap_below_zero_and_at_midnight() {
        for (start, modulus, what) in [
            (-32_768.0, 65_536.0, "wraps around at 65536 (once"),
            (-2_147_483_648.0, 4_294_967_296.0, "wraps around at 4294967296 (once"),
            (0.0, 86_400.0, "the time of day passes midnight (once"),
        ] {
            let rows: Vec<_> =
                (0..600).map(|row| (start + (modulus - 300.5 + f64::from(row)) % modulus, f64::from(row))).collect();
            let (times, _, said) = mended(&rows).unwrap();
            assert!(is_even(&times, 600) && said.contains(what), "{said}");
        }
    }

    /// A digit of a stamp was corrupted or lost by a cable.
    #[test]
    fn an_impossible_stamp_is_not_a_leap_of_the_clock() {
        for stray in [0.0, 5.0, 1e9, 300.0] {
            let mut rows = even(400);
            rows[100].0 = stray;
            let (times, values, said) = mended(&rows).unwrap();
            assert!(is_even(&times, 400) && values.is_sorted(), "{said}");
            assert!(said.contains("1 row has a wrong stamp") && said.contains("row 100"), "{said}");
        }
    }

    /// A clock in whole seconds over 200 samples a second. The log begins and ends in the middle of a second. In the
    /// second case, two seconds are missing.
    #[test]
    fn a_coarse_clock_loses_nothing() {
        let of = |rows: std::ops::Range<i32>| rows.map(|row| ((f64::from(row) / 200.0).floor(), f64::from(row)));
        let times = |rows: Vec<(f64, f64)>| mended(&rows).unwrap().0;
        let steps = |times: &[f64]| times.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
        let all = steps(&times(of(24..2130).collect()));
        assert!(all.len() == 2105 && all.iter().all(|step| (step - 0.005).abs() < 1e-9), "{all:?}");
        let gapped = steps(&times(of(24..1000).chain(of(1400..2130)).collect()));
        let longest = gapped.iter().copied().fold(0.0, f64::max);
        assert!((longest - 2.005).abs() < 1e-6 && gapped.iter().filter(|step| **step > 0.0051).count() == 1);
    }

    #[test]
    fn a_clock_without_a_whole_step_tells_no_rate() {
        let rows: Vec<(f64, f64)> = (0..4000).map(|row| (f64::from(row / 2000), f64::from(row))).collect();
        assert!(mended(&rows).unwrap_err().contains("fewer than two whole steps"));
    }

    #[test]
    fn a_clock_that_was_set_back_is_followed_or_refused() {
        let mut rows = even(1000);
        rows[600..].iter_mut().for_each(|row| row.0 -= 4.0);
        let (times, values, said) = mended(&rows).unwrap();
        assert!(is_even(&times, 1000) && values.is_sorted());
        assert!(said.contains("goes back by 3, at row 600 from 609 to 606"), "{said}");
        rows[600..].iter_mut().for_each(|row| row.0 -= 400.0);
        assert!(mended(&rows).unwrap_err().contains("goes back by 403, at row 600 from 609 to 206"));
        let back: Vec<_> = even(50).into_iter().rev().collect();
        assert!(mended(&back).unwrap_err().contains("goes back"));
        assert_eq!(lapse(0.03 - 0.01999, None), "0.01001");
        assert_eq!(lapse(3_599_990_000_000.0, Some(TimeUnit::Ns)), "3599.99 s");
        assert!(mended(&[(1.0, 0.0), (1.0, 1.0)]).unwrap_err().contains("stands still at 1"));
    }
}
