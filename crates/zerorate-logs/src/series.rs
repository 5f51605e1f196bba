//! The samples of a column: codes or numbers, some of which are missing.

use zerorate_allan::{Gap, Input};
use zerorate_input::limits::{MemoryBudget, OverBudget};

/// Largest number of missing samples that are filled in: a bound on memory if a clock leaps.
const MAX_FILLED: u64 = 10_000_000;

/// Memory that the budget counts per row, in bytes: a code and its result of 4 bytes each, twice while vectors grow.
/// A number with a time needs twice as much, which only the memory limit of the process bounds.
pub const ROW_BYTES: u64 = 16;

/// A series of numbers: 32-bit integer codes, or floating-point numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Series {
    /// Integer codes without the missing samples, which a separate list of gaps marks.
    Codes(Vec<i32>),
    /// Other numbers: finite, or NaN where a sample is missing.
    Numbers(Vec<f64>),
}

impl Series {
    /// The number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Codes(codes) => codes.len(),
            Self::Numbers(numbers) => numbers.len(),
        }
    }

    /// True if the series has no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The samples as input of the Allan analysis. `gaps` are the gaps among codes; other numbers hold NaN instead.
    pub fn input<'a>(&'a self, gaps: &'a [Gap]) -> Input<'a> {
        match self {
            Self::Codes(codes) => Input::Codes { codes, gaps },
            Self::Numbers(numbers) => Input::Rate(numbers),
        }
    }
}

/// A series to which samples are added. It holds codes until a floating-point number or a larger integer than 32 bits
/// is added.
pub struct SeriesBuilder {
    series: Series,
    /// The gaps among codes. Other numbers hold NaN instead.
    gaps: Vec<Gap>,
    rows: u64,
    room: MemoryBudget,
    /// The number of series that share the memory limit.
    sharing: u64,
}

impl SeriesBuilder {
    /// Creates one of `series` series that share the memory limit.
    pub fn sharing(room: MemoryBudget, series: usize) -> Self {
        let sharing = series.max(1) as u64;
        Self { series: Series::Codes(Vec::new()), gaps: Vec::new(), rows: 0, room, sharing }
    }

    /// Bytes of a row of all series that share the limit.
    fn row_bytes(&self) -> u64 {
        ROW_BYTES.saturating_mul(self.sharing)
    }

    /// Checks whether there is memory for `more` rows. Call it before rows are added that may take fewer bytes in the
    /// file than in memory.
    pub fn check_room(&self, more: u64) -> Result<(), OverBudget> {
        self.room.check(self.rows.saturating_add(more).saturating_mul(self.row_bytes()))
    }

    /// The number of rows, including empty ones.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    pub fn push_missing(&mut self) {
        self.rows += 1;
        match &mut self.series {
            Series::Codes(codes) => join(&mut self.gaps, Gap { at: codes.len(), missing: 1 }),
            Series::Numbers(numbers) => numbers.push(f64::NAN),
        }
    }

    pub fn push_integer(&mut self, value: i64) {
        self.rows += 1;
        match (&mut self.series, i32::try_from(value)) {
            (Series::Codes(codes), Ok(code)) => codes.push(code),
            _ => self.numbers().push(value as f64),
        }
    }

    /// Adds a number; NaN is a missing sample. Returns false and adds nothing if the number is infinite.
    pub fn push_number(&mut self, value: f64) -> bool {
        if value.is_infinite() {
            return false;
        }
        self.rows += 1;
        self.numbers().push(value);
        true
    }

    /// Adds numbers that are finite, or NaN where one is missing; `are_codes` tells whether all of them are codes.
    pub fn extend_cells(&mut self, added: &[f64], are_codes: bool) {
        self.rows += added.len() as u64;
        if !are_codes {
            return self.numbers().extend_from_slice(added);
        }
        match &mut self.series {
            Series::Numbers(numbers) => numbers.extend_from_slice(added),
            Series::Codes(codes) => {
                for number in added {
                    match number.is_nan() {
                        true => join(&mut self.gaps, Gap { at: codes.len(), missing: 1 }),
                        false => codes.push(*number as i32),
                    }
                }
            }
        }
    }

    pub fn extend_codes(&mut self, added: impl ExactSizeIterator<Item = i32>) {
        self.rows += added.len() as u64;
        match &mut self.series {
            Series::Codes(codes) => codes.extend(added),
            Series::Numbers(numbers) => numbers.extend(added.map(f64::from)),
        }
    }

    /// Adds numbers. If one is infinite, adds nothing and returns the index of the first.
    pub fn extend_numbers(&mut self, added: impl ExactSizeIterator<Item = f64>) -> Result<(), usize> {
        let (rows, numbers) = (added.len() as u64, self.numbers());
        let before = numbers.len();
        numbers.extend(added);
        // a loop without an early exit is faster
        if numbers[before..].iter().fold(false, |found, number| found | number.is_infinite()) {
            let first = numbers[before..].iter().position(|number| number.is_infinite());
            numbers.truncate(before);
            return Err(first.unwrap_or_default());
        }
        self.rows += rows;
        Ok(())
    }

    /// Reserves memory for `additional` rows of codes or, if they are not integers, of numbers.
    pub fn reserve(&mut self, additional: usize, integers: bool) {
        let additional = additional.min((self.room.bytes() / self.row_bytes()) as usize);
        if !integers {
            self.numbers();
        }
        match &mut self.series {
            Series::Codes(codes) => codes.reserve_exact(additional),
            Series::Numbers(numbers) => numbers.reserve_exact(additional),
        }
    }

    /// Returns the series and the gaps among codes. `between_rows` are the samples that were lost between rows:
    /// `missing` samples before row `at`, where empty rows count. If too many samples are missing to be filled in, the
    /// error is their number.
    pub fn finish(mut self, between_rows: &[Gap]) -> Result<(Series, Vec<Gap>), u64> {
        let row_bytes = self.row_bytes();
        let gaps = match &mut self.series {
            Series::Codes(codes) => inner(merged(&self.gaps, between_rows), codes.len()),
            Series::Numbers(_) if between_rows.is_empty() => Vec::new(),
            Series::Numbers(numbers) => {
                *numbers = filled(numbers, between_rows, self.room, row_bytes)?;
                Vec::new()
            }
        };
        Ok((self.series, gaps))
    }

    pub fn are_codes(&self) -> bool {
        matches!(self.series, Series::Codes(_))
    }

    /// A number for each row, NaN for an empty row.
    pub fn rows_as_numbers(&self) -> Vec<f64> {
        match &self.series {
            Series::Numbers(numbers) => numbers.clone(),
            Series::Codes(codes) => spread(codes, &self.gaps),
        }
    }

    /// The first rows as numbers, NaN for an empty row.
    pub fn first_rows(&self, most: usize) -> Vec<f64> {
        match &self.series {
            Series::Numbers(numbers) => numbers[..numbers.len().min(most)].to_vec(),
            Series::Codes(codes) => {
                let codes = &codes[..codes.len().min(most)];
                let within = self.gaps.partition_point(|gap| gap.at < codes.len());
                let mut rows = spread(codes, &self.gaps[..within]);
                rows.truncate(most);
                rows
            }
        }
    }

    /// Keeps the rows from `first` up to, but not including, `end`.
    pub fn keep(&mut self, first: usize, end: usize) {
        self.rows = (end - first) as u64;
        if let Series::Numbers(numbers) = &mut self.series {
            numbers.truncate(end);
            numbers.drain(..first);
            return;
        }
        let rows: Vec<usize> = (first..end).collect();
        self.reorder(&rows);
    }

    /// Keeps only these rows, in this order.
    pub fn reorder(&mut self, order: &[usize]) {
        let are_codes = self.are_codes();
        let all = self.rows_as_numbers();
        let rows: Vec<f64> = order.iter().map(|row| all[*row]).collect();
        self.series = Series::Codes(Vec::new());
        self.gaps.clear();
        self.rows = 0;
        self.extend_cells(&rows, are_codes);
    }

    /// All rows as numbers, NaN for an empty row.
    pub fn into_rows(mut self) -> Vec<f64> {
        std::mem::take(self.numbers())
    }

    /// The numbers of the series. Codes are converted to floating-point numbers first.
    fn numbers(&mut self) -> &mut Vec<f64> {
        if let Series::Codes(codes) = &self.series {
            let mut numbers = spread(codes, &self.gaps);
            numbers.reserve_exact(codes.capacity() - codes.len());
            self.series = Series::Numbers(numbers);
            self.gaps.clear();
        }
        match &mut self.series {
            Series::Numbers(numbers) => numbers,
            Series::Codes(_) => unreachable!("codes became numbers just now"),
        }
    }
}

/// Values as numbers, NaN in each gap.
fn spread<T: Copy + Into<f64>>(values: &[T], gaps: &[Gap]) -> Vec<f64> {
    let number = |value: &T| -> f64 { (*value).into() };
    let mut numbers = Vec::with_capacity(values.len() + missing_in(gaps) as usize);
    let mut done = 0;
    for gap in gaps {
        numbers.extend(values[done..gap.at].iter().map(number));
        numbers.extend((0..gap.missing).map(|_| f64::NAN));
        done = gap.at;
    }
    numbers.extend(values[done..].iter().map(number));
    numbers
}

/// Adds a gap at or after the last one.
pub fn join(gaps: &mut Vec<Gap>, gap: Gap) {
    match gaps.last_mut().filter(|last| last.at == gap.at) {
        Some(last) => last.missing = last.missing.saturating_add(gap.missing),
        None => gaps.push(gap),
    }
}

pub fn missing_in(gaps: &[Gap]) -> u64 {
    gaps.iter().fold(0, |sum, gap| sum.saturating_add(gap.missing))
}

/// Merges both kinds of gaps. The result counts places in codes; in `between_rows`, places also count empty rows.
fn merged(empty_rows: &[Gap], between_rows: &[Gap]) -> Vec<Gap> {
    let mut all = Vec::with_capacity(empty_rows.len() + between_rows.len());
    let mut empty = empty_rows.iter().copied().peekable();
    let mut rows_empty = 0;
    for gap in between_rows {
        while let Some(next) = empty.next_if(|next| (next.at as u64) + rows_empty < gap.at as u64) {
            rows_empty += next.missing;
            join(&mut all, next);
        }
        // a gap within a run of empty rows may as well be at the end of the run
        let at = (gap.at as u64).saturating_sub(rows_empty) as usize;
        let at = at.max(all.last().map_or(0, |last| last.at));
        join(&mut all, Gap { at: at.min(empty.peek().map_or(at, |next| next.at)), missing: gap.missing });
    }
    empty.for_each(|gap| join(&mut all, gap));
    all
}

/// Keeps the inner gaps: missing samples before the first sample or after the last do not make a gap.
fn inner(mut gaps: Vec<Gap>, len: usize) -> Vec<Gap> {
    gaps.retain(|gap| gap.at > 0 && gap.at < len && gap.missing > 0);
    gaps
}

/// Codes as numbers, with a NaN for each missing sample. If too many samples are missing, the error is their number.
pub fn with_gaps(codes: &[i32], gaps: &[Gap]) -> Result<Vec<f64>, u64> {
    let numbers: Vec<f64> = codes.iter().map(|code| f64::from(*code)).collect();
    filled(&numbers, gaps, MemoryBudget::of(codes.len() as u64), ROW_BYTES)
}

fn filled(numbers: &[f64], between_rows: &[Gap], room: MemoryBudget, row_bytes: u64) -> Result<Vec<f64>, u64> {
    let missing = missing_in(between_rows);
    let all = missing.saturating_add(numbers.len() as u64);
    if missing > MAX_FILLED || room.check(all.saturating_mul(row_bytes)).is_err() {
        return Err(missing);
    }
    Ok(spread(numbers, between_rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(at: usize, missing: u64) -> Gap {
        Gap { at, missing }
    }

    /// Rows: empty, 10, empty, 11, 12, empty, empty and the `last` row, and samples lost between some of them.
    fn build(last: impl Fn(&mut SeriesBuilder)) -> (Series, Vec<Gap>) {
        let mut builder = SeriesBuilder::sharing(MemoryBudget::of(0), 1);
        builder.push_missing();
        builder.push_integer(10);
        builder.push_missing();
        builder.extend_codes([11, 12].into_iter());
        builder.push_missing();
        builder.push_missing();
        last(&mut builder);
        builder.finish(&[gap(2, 3), gap(4, 5), gap(6, 7)]).unwrap()
    }

    /// A series as a list of samples, lost ones included.
    fn samples(series: &Series, gaps: &[Gap]) -> Vec<Option<f64>> {
        match series {
            Series::Numbers(numbers) => numbers.iter().map(|number| Some(*number).filter(|n| !n.is_nan())).collect(),
            Series::Codes(codes) => {
                let mut all = Vec::new();
                for (i, code) in codes.iter().enumerate() {
                    let lost = gaps.iter().filter(|gap| gap.at == i).map(|gap| gap.missing).sum::<u64>();
                    all.extend((0..lost).map(|_| None));
                    all.push(Some(f64::from(*code)));
                }
                all
            }
        }
    }

    #[test]
    fn codes_and_numbers_have_the_same_gaps() {
        let (codes, gaps) = build(|builder| builder.push_integer(13));
        assert_eq!(codes, Series::Codes(vec![10, 11, 12, 13]));
        assert_eq!(gaps, [gap(1, 4), gap(2, 5), gap(3, 9)]);
        let (numbers, none) = build(|builder| assert!(builder.push_number(13.0)));
        assert!(none.is_empty());
        let mut expected = samples(&codes, &gaps);
        expected.insert(0, None);
        assert_eq!(samples(&numbers, &none), expected);
    }

    #[test]
    fn large_integers_are_numbers() {
        let mut builder = SeriesBuilder::sharing(MemoryBudget::of(0), 1);
        builder.push_integer(-7);
        builder.push_integer(1 << 40);
        assert_eq!(builder.finish(&[]).unwrap().0, Series::Numbers(vec![-7.0, 1_099_511_627_776.0]));
    }

    #[test]
    fn infinity_and_endless_gaps_are_refused() {
        let mut builder = SeriesBuilder::sharing(MemoryBudget::of(0), 1);
        assert!(!builder.push_number(f64::INFINITY));
        assert_eq!(builder.extend_numbers([1.0, f64::NEG_INFINITY].into_iter()), Err(1));
        builder.extend_numbers([1.0, 2.0].into_iter()).unwrap();
        assert_eq!(builder.finish(&[gap(1, MAX_FILLED + 1)]), Err(MAX_FILLED + 1));
    }
}
