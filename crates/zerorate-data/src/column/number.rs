//! Numbers as people write them: with a decimal point or a decimal comma, or not there at all.

use super::Decimal;

/// What a cell of text holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Nothing, or a word for nothing.
    Missing,
    /// An integer.
    Integer(i64),
    /// Any other number; perhaps infinite.
    Decimal(f64),
}

/// Reads numbers, and learns from them which decimal mark the text uses.
pub struct Numerals {
    decimal: Option<Decimal>,
    /// A line and a cell in it that may have either mark, as long as no other cell tells.
    doubtful: Option<(u64, String)>,
}

impl Numerals {
    /// A text with this decimal mark, if it is known.
    pub fn new(decimal: Option<Decimal>) -> Self {
        Self { decimal, doubtful: None }
    }

    /// Reads a cell; `Err` tells why it is no number.
    pub fn read(&mut self, cell: &str, line: u64) -> Result<Number, String> {
        if let Ok(integer) = cell.parse() {
            return Ok(Number::Integer(integer));
        }
        if cell.contains(',') {
            return self.with_comma(cell, line);
        }
        if is_missing(cell) {
            return Ok(Number::Missing);
        }
        let number = cell.parse().map_err(|_| format!("`{cell}` is no number"))?;
        if cell.contains('.') {
            match self.decimal {
                Some(Decimal::Comma) => {
                    return Err(format!("`{cell}` has a decimal point where other numbers have a decimal comma"));
                }
                _ => self.decimal = Some(Decimal::Point),
            }
        }
        Ok(Number::Decimal(number))
    }

    /// A cell that could be read in two ways, with what to do about it.
    pub fn doubt(&self) -> Option<(u64, String)> {
        let (line, cell) = self.doubtful.as_ref().filter(|_| self.decimal.is_none())?;
        let (decimal, thousand) = (cell.replace(',', "."), cell.replace(',', ""));
        Some((
            *line,
            format!(
                "`{cell}` is {decimal} or {thousand}; give --decimal comma if it is {decimal}, else remove the comma"
            ),
        ))
    }

    fn with_comma(&mut self, cell: &str, line: u64) -> Result<Number, String> {
        if self.decimal == Some(Decimal::Point) {
            return Err(format!("`{cell}` is no number with a decimal point, as the others are"));
        }
        let number = cell.replacen(',', ".", 1).parse();
        let number = number.ok().filter(|_| !cell.contains('.')).ok_or_else(|| format!("`{cell}` is no number"))?;
        if !could_be_thousands(cell) {
            self.decimal = Some(Decimal::Comma);
        } else if self.doubtful.is_none() {
            self.doubtful = Some((line, cell.to_owned()));
        }
        Ok(Number::Decimal(number))
    }
}

/// 1,234 could be; 0,123 and 1,5 and 1,234e5 could not.
fn could_be_thousands(cell: &str) -> bool {
    let is_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    cell.trim_start_matches(['+', '-']).split_once(',').is_some_and(|(before, after)| {
        is_digits(before)
            && !before.starts_with('0')
            && (1..=3).contains(&before.len())
            && is_digits(after)
            && after.len() == 3
    })
}

fn is_missing(cell: &str) -> bool {
    cell.is_empty()
        || ["nan", "na", "n/a", "null", "none", "-", "--"].iter().any(|word| cell.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    type Numbers = Vec<Result<Number, String>>;

    fn read(cells: &[&str]) -> (Numbers, Option<(u64, String)>) {
        let mut numerals = Numerals::new(None);
        let numbers = cells.iter().zip(1..).map(|(cell, line)| numerals.read(cell, line)).collect();
        (numbers, numerals.doubt())
    }

    #[test]
    fn all_that_is_missing() {
        for cell in ["", "nan", "NaN", "NA", "null", "None", "-"] {
            assert_eq!(read(&[cell]).0, [Ok(Number::Missing)], "{cell}");
        }
    }

    #[test]
    fn a_decimal_comma_where_it_can_be_nothing_else() {
        let number = |value| Ok(Number::Decimal(value));
        assert_eq!(read(&["1,5", "-2,125", "7"]), (vec![number(1.5), number(-2.125), Ok(Number::Integer(7))], None));
        assert_eq!(read(&["1,125", "0,125"]), (vec![number(1.125), number(0.125)], None));
        assert_eq!(read(&["1,125e3"]), (vec![number(1125.0)], None));
        assert_eq!(read(&["1e3", "1.5"]), (vec![number(1000.0), number(1.5)], None));
    }

    #[test]
    fn both_marks_are_a_mistake() {
        assert!(read(&["1.5", "1,5"]).0[1].as_ref().unwrap_err().contains("`1,5` is no number with a decimal point"));
        assert!(read(&["1,5", "1.5"]).0[1].as_ref().unwrap_err().contains("decimal comma"));
        assert!(read(&["1.234,5"]).0[0].as_ref().unwrap_err().contains("no number"));
        assert!(read(&["1,2,3"]).0[0].as_ref().unwrap_err().contains("no number"));
    }

    #[test]
    fn what_could_be_thousands_is_asked_about() {
        let (_, doubt) = read(&["5", "1,234", "-56,789"]);
        let (line, what) = doubt.unwrap();
        assert_eq!(line, 2);
        assert!(what.contains("`1,234` is 1.234 or 1234") && what.contains("--decimal comma"), "{what}");
        let mut declared = Numerals::new(Some(Decimal::Comma));
        assert_eq!((declared.read("1,234", 1), declared.doubt()), (Ok(Number::Decimal(1.234)), None));
    }
}
