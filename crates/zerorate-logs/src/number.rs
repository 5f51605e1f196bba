//! Parses numbers as people write them: with a decimal point or a decimal comma. A cell may also be empty, or hold a
//! word for a missing value.

use zerorate_allan::SettingName;

/// A decimal mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Decimal {
    /// 1.5
    Point,
    /// 1,5
    Comma,
}

/// The minus sign of Unicode.
const MINUS: char = '\u{2212}';

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// An empty cell, or a word for a missing value.
    Missing,
    Integer(i64),
    /// Any other number; it may be infinite, but is not NaN.
    Decimal(f64),
}

impl Number {
    pub fn is_there(self) -> bool {
        self != Self::Missing
    }
}

/// Reads numbers, and learns from them which decimal mark the text uses.
#[derive(Clone, Debug, Default)]
pub struct Numerals {
    decimal: Option<Decimal>,
    /// The line and the text of the first cell whose comma may be decimal or may separate thousands.
    doubtful: Option<(u64, String)>,
}

impl Numerals {
    /// Reads a text with this decimal mark; `None` if the mark is not known.
    pub fn new(decimal: Option<Decimal>) -> Self {
        Self { decimal, doubtful: None }
    }

    pub fn decimal(&self) -> Option<Decimal> {
        self.decimal
    }

    pub fn read(&mut self, cell: &str, line: u64) -> Result<Number, String> {
        if let Some(number) = plain(cell.as_bytes()) {
            return match number {
                Number::Decimal(_) => self.with_point(cell).map(|()| number),
                _ => Ok(number),
            };
        }
        let number = self.read_unusual(cell, line);
        // Excel in Swedish and Norwegian writes the minus sign of typesetting
        if number.is_err() && cell.contains(MINUS) {
            return self.read_unusual(&cell.replace(MINUS, "-"), line);
        }
        match without_separators(cell).filter(|_| number.is_err()) {
            Some(cell) => self.read_unusual(&cell, line),
            None => number,
        }
    }

    /// Reads what [`plain`] does not.
    fn read_unusual(&mut self, cell: &str, line: u64) -> Result<Number, String> {
        if let Ok(integer) = cell.parse() {
            return Ok(Number::Integer(integer));
        }
        if cell.contains(',') {
            return self.with_comma(cell, line);
        }
        if is_missing(cell) {
            return Ok(Number::Missing);
        }
        if let Some(code) = of_hexadecimal(cell) {
            return Ok(Number::Integer(code));
        }
        let number = cell.parse().ok().or_else(|| of_fortran(cell)).ok_or_else(|| not_a_number(cell))?;
        if cell.contains('.') {
            self.with_point(cell)?;
        }
        Ok(Number::Decimal(number))
    }

    /// Adds the findings of `other`, whose first line is `lines` lines behind the first line of `self`. Returns false
    /// if the two found different decimal marks.
    pub fn join(&mut self, other: Self, lines: u64) -> bool {
        if self.doubtful.is_none() {
            self.doubtful = other.doubtful.map(|(line, cell)| (line + lines, cell));
        }
        let differ = matches!((self.decimal, other.decimal), (Some(one), Some(other)) if one != other);
        self.decimal = self.decimal.or(other.decimal);
        !differ
    }

    /// The line of an ambiguous cell, and what to do about it; `option` is the name of the setting of the decimal
    /// mark.
    pub fn doubt(&self, option: SettingName) -> Option<(u64, String)> {
        let (line, cell) = self.doubtful.as_ref().filter(|_| self.decimal.is_none())?;
        let (decimal, thousand) = (cell.replace(',', "."), cell.replace(',', ""));
        Some((
            *line,
            format!(
                "`{cell}` is {decimal} or {thousand}; give {option} comma if it is {decimal}, else remove the comma"
            ),
        ))
    }

    fn with_point(&mut self, cell: &str) -> Result<(), String> {
        if self.decimal == Some(Decimal::Comma) {
            return Err(format!("`{cell}` has a decimal point where other numbers have a decimal comma"));
        }
        self.decimal = Some(Decimal::Point);
        Ok(())
    }

    fn with_comma(&mut self, cell: &str, line: u64) -> Result<Number, String> {
        let not_with_point = || format!("`{cell}` is not a number with a decimal point, as the others are");
        if let Some((mark, number)) = in_thousands(cell) {
            match (mark, self.decimal) {
                (Decimal::Point, _) => self.with_point(cell)?,
                (Decimal::Comma, Some(Decimal::Point)) => return Err(not_with_point()),
                (Decimal::Comma, _) => self.decimal = Some(Decimal::Comma),
            }
            return Ok(Number::Decimal(number));
        }
        if self.decimal == Some(Decimal::Point) {
            return Err(not_with_point());
        }
        let number = cell.replacen(',', ".", 1).parse();
        let number = number.ok().filter(|_| !cell.contains('.')).ok_or_else(|| not_a_number(cell))?;
        if !could_be_thousands(cell) {
            self.decimal = Some(Decimal::Comma);
        } else if self.doubtful.is_none() {
            self.doubtful = Some((line, cell.to_owned()));
        }
        Ok(Number::Decimal(number))
    }
}

/// The largest integer up to which an f64 holds every integer exactly.
const EXACT: u64 = 1 << 53;

/// Powers of ten that an f64 holds exactly.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
    1e20, 1e21, 1e22,
];

/// Largest number of digits that always fit an i64.
const DIGITS: usize = 18;

/// Reads a number that consists of a sign, digits and a point only, as nearly all do. An integer over a power of ten,
/// both exact, is rounded once, so the result is that of `str::parse` (W. D. Clinger, How to read floating point
/// numbers accurately, PLDI 1990).
fn plain(cell: &[u8]) -> Option<Number> {
    let (negative, digits) = match cell {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, cell),
    };
    let (mut all, mut point) = (0u64, None);
    for (at, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => all = all.wrapping_mul(10).wrapping_add(u64::from(byte - b'0')),
            b'.' if point.is_none() => point = Some(digits.len() - 1 - at),
            _ => return None,
        }
    }
    let count = digits.len() - usize::from(point.is_some());
    if count == 0 || count > DIGITS {
        return None;
    }
    match point {
        None => Some(Number::Integer(if negative { -(all as i64) } else { all as i64 })),
        Some(decimals) if all <= EXACT => {
            let number = all as f64 / TENS[decimals];
            Some(Number::Decimal(if negative { -number } else { number }))
        }
        Some(_) => None,
    }
}

/// Parses a number with a thousands separator and a decimal mark, such as 1,234.5 or 1.234,5. Returns the mark and the
/// number.
fn in_thousands(cell: &str) -> Option<(Decimal, f64)> {
    let (mark, thousand) =
        if cell.rfind('.') > cell.rfind(',') { (Decimal::Point, ',') } else { (Decimal::Comma, '.') };
    let (whole, decimals) = cell.split_once(if mark == Decimal::Point { '.' } else { ',' })?;
    let mut groups = whole.trim_start_matches(['+', '-']).split(thousand);
    let is_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let head = groups.next().filter(|head| (1..=3).contains(&head.len()) && is_digits(head));
    let tail: Vec<&str> = groups.collect();
    let fits = head.is_some() && !tail.is_empty() && tail.iter().all(|group| group.len() == 3 && is_digits(group));
    let number = format!("{}.{decimals}", whole.replace(thousand, ""));
    number.parse().ok().filter(|_| fits).map(|number| (mark, number))
}

/// Separators of thousands of French and Swiss programs, beside points and commas.
const SEPARATORS: [char; 4] = ['\u{A0}', '\u{202F}', '\u{2009}', '’'];

/// A number without its separators of thousands: 1234.5 of 1’234.5.
fn without_separators(cell: &str) -> Option<String> {
    let whole = cell.trim_start_matches(['+', '-']).split(['.', ',']).next()?;
    let groups: Vec<&str> = whole.split(SEPARATORS).collect();
    let is_group = |at: usize| if at == 0 { (1..=3).contains(&groups[0].len()) } else { groups[at].len() == 3 };
    let are_digits = groups.iter().all(|group| group.bytes().all(|byte| byte.is_ascii_digit()));
    (groups.len() > 1 && are_digits && (0..groups.len()).all(is_group)).then(|| cell.replace(SEPARATORS, ""))
}

/// Parses a number that Fortran printed in double precision, such as 1.5D-03.
fn of_fortran(cell: &str) -> Option<f64> {
    let is_one = cell.contains('.') && cell.contains(['d', 'D']);
    is_one.then(|| cell.replacen(['d', 'D'], "e", 1).parse().ok())?
}

/// Parses a hexadecimal code without a sign, such as 0x1F2A.
fn of_hexadecimal(cell: &str) -> Option<i64> {
    let digits = cell.strip_prefix("0x").or_else(|| cell.strip_prefix("0X"))?;
    i64::from_str_radix(digits, 16).ok().filter(|_| digits.starts_with(|c: char| c.is_ascii_hexdigit()))
}

fn not_a_number(cell: &str) -> String {
    let is_code = matches!(cell.len(), 2 | 4 | 6 | 8) && cell.bytes().all(|byte| byte.is_ascii_hexdigit());
    let rest = cell.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.,".contains(c));
    let begins = cell[..cell.len() - rest.len()].replace(',', ".").parse::<f64>().is_ok();
    let remedy = match rest.trim_start().chars().next().filter(|_| begins) {
        _ if is_code => "; write hexadecimal codes with 0x in front",
        Some('x' | 'X') if cell.starts_with('-') => "; write negative codes in decimal",
        Some(next) if next.is_ascii_digit() => "; write one number in a cell, without blanks",
        Some('\'') => "; remove the apostrophes",
        // `0o0052` and `002Ah` are codes
        _ if rest.contains(|c: char| c.is_ascii_digit()) || cell.starts_with("00") => "",
        Some(next) if next.is_alphabetic() || next == '°' => "; write the unit into the header",
        _ => "",
    };
    format!("`{cell}` is not a number{remedy}")
}

/// True if a comma may separate thousands. It may in 1,234, but not in 0,123, 1,5 or 1,234e5.
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

/// The words for a missing number, in small letters. C prints a NaN with its sign, and Windows with its kind as well.
/// Excel writes `#N/A`.
const MISSING: &str = "nan -nan +nan nan(ind) -nan(ind) 1.#qnan -1.#ind na n/a #n/a null none - --";

fn is_missing(cell: &str) -> bool {
    let is_word = || MISSING.split(' ').any(|word| cell.eq_ignore_ascii_case(word));
    cell.is_empty() || !cell.ends_with(|last: char| last.is_ascii_digit()) && is_word()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Numbers = Vec<Result<Number, String>>;

    fn read(cells: &[&str]) -> (Numbers, Option<(u64, String)>) {
        let mut numerals = Numerals::new(None);
        let numbers = cells.iter().zip(1..).map(|(cell, line)| numerals.read(cell, line)).collect();
        (numbers, numerals.doubt(SettingName::text("--decimal")))
    }

    #[test]
    fn empty_cells_and_words_for_nothing_are_missing() {
        for cell in ["", "nan", "NaN", "-nan", "-nan(ind)", "1.#QNAN", "NA", "#N/A", "null", "None", "-"] {
            assert_eq!(read(&[cell]).0, [Ok(Number::Missing)], "{cell}");
        }
    }

    #[test]
    fn a_comma_is_decimal_where_it_can_be_nothing_else() {
        let number = |value| Ok(Number::Decimal(value));
        assert_eq!(read(&["1,5", "-2,125", "7"]), (vec![number(1.5), number(-2.125), Ok(Number::Integer(7))], None));
        assert_eq!(read(&["1,125", "0,125"]), (vec![number(1.125), number(0.125)], None));
        assert_eq!(read(&["1,125e3"]), (vec![number(1125.0)], None));
        assert_eq!(read(&["1e3", "1.5"]), (vec![number(1000.0), number(1.5)], None));
    }

    #[test]
    fn a_minus_sign_may_be_that_of_typesetting() {
        let number = |value| Ok(Number::Decimal(value));
        let read = |cells: &str| read(&cells.replace('M', "\u{2212}").split(' ').collect::<Vec<_>>()).0;
        assert_eq!(read("M0.25 2.5eM3 M7"), [number(-0.25), number(2.5e-3), Ok(Number::Integer(-7))]);
        assert_eq!(read("M0,25 M1.234,5 M"), [number(-0.25), number(-1234.5), Ok(Number::Missing)]);
    }

    #[test]
    fn both_marks_are_a_mistake() {
        assert!(
            read(&["1.5", "1,5"]).0[1].as_ref().unwrap_err().contains("`1,5` is not a number with a decimal point")
        );
        assert!(read(&["1,5", "1.5"]).0[1].as_ref().unwrap_err().contains("decimal comma"));
        for cell in ["1.2345,6", "1234.567,5", "1,23.5", "1.234,5,6", ",123.5"] {
            assert!(read(&[cell]).0[0].as_ref().unwrap_err().contains("not a number"), "{cell}");
        }
        assert!(read(&["1,234.5", "1.234,5"]).0[1].is_err() && read(&["1.234,5", "1,234.5"]).0[1].is_err());
        assert!(read(&["1,2,3"]).0[0].as_ref().unwrap_err().contains("not a number"));
    }

    #[test]
    fn thousands_beside_decimals_can_be_nothing_else() {
        let number = |value| Ok(Number::Decimal(value));
        assert_eq!(read(&["1,234.5", "-12,345,678.25", "7"]).0[..2], [number(1234.5), number(-12_345_678.25)]);
        assert_eq!(read(&["0,5", "-1.234,5", "12.345.678,25"]).0[1..], [number(-1234.5), number(12_345_678.25)]);
    }

    #[test]
    fn blanks_and_apostrophes_separate_thousands() {
        let number = |value| Ok(Number::Decimal(value));
        assert_eq!(
            read(&["1’234.5", "-12’345’678", "0.5"]).0[..2],
            [number(1234.5), Ok(Number::Integer(-12_345_678))]
        );
        assert_eq!(read(&["1\u{202F}234,5", "0,25"]).0, [number(1234.5), number(0.25)]);
        let remedies =
            ["1 234.5", "1'234.5", "0.5 dps", "-0x1F", "5°/s"].map(|cell| read(&[cell]).0.remove(0).unwrap_err());
        let expected = ["without blanks", "the apostrophes", "into the header", "in decimal", "into the header"];
        assert!(remedies.iter().zip(expected).all(|(said, expected)| said.ends_with(expected)), "{remedies:?}");
        assert!(["0o0052", "002Ah"].iter().all(|cell| read(&[cell]).0[0].as_ref().unwrap_err().ends_with("number")));
        assert!(read(&["12’34"]).0[0].is_err() && read(&["'1'"]).0[0].is_err() && read(&["2026-03-01"]).0[0].is_err());
    }

    #[test]
    fn hexadecimal_codes_have_a_mark() {
        assert_eq!(read(&["0x1F", "0XfFfe"]).0, [Ok(Number::Integer(31)), Ok(Number::Integer(65_534))]);
        assert!(read(&["0x"]).0[0].is_err() && read(&["0x-1"]).0[0].is_err() && read(&["-0x1"]).0[0].is_err());
        assert!(read(&["000A"]).0[0].as_ref().unwrap_err().contains("0x"));
    }

    #[test]
    fn exponents_of_fortran_are_read() {
        assert_eq!(read(&["1.5D-03", "-2.5d+02"]).0, [Ok(Number::Decimal(1.5e-3)), Ok(Number::Decimal(-250.0))]);
        assert!(read(&["3D"]).0[0].is_err() && read(&["a.d"]).0[0].is_err());
    }

    #[test]
    fn a_possible_thousands_separator_is_asked_about() {
        let (_, doubt) = read(&["5", "1,234", "-56,789"]);
        let (line, what) = doubt.unwrap();
        assert_eq!(line, 2);
        assert!(what.contains("`1,234` is 1.234 or 1234") && what.contains("--decimal comma"), "{what}");
        let mut declared = Numerals::new(Some(Decimal::Comma));
        assert_eq!(
            (declared.read("1,234", 1), declared.doubt(SettingName::text("--decimal"))),
            (Ok(Number::Decimal(1.234)), None)
        );
    }

    /// The fast path gives the result of the standard library, to the last bit.
    #[test]
    fn plain_numbers_are_rounded_once() {
        let mut cells: Vec<String> =
            ["0.1", "-0.0", "+.5", "7.", "9007199254740993.0", "0.000000000000000001", "123456789.123456789"]
                .map(str::to_owned)
                .to_vec();
        let mut random = 1u64;
        for _ in 0..20_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let digits = (random >> 33).to_string();
            let at = (random >> 20) as usize % digits.len();
            cells.push(format!("{}.{}", &digits[..at], &digits[at..]));
        }
        for cell in cells {
            let slow: f64 = cell.parse().unwrap();
            let Ok(Number::Decimal(fast)) = read(&[&cell]).0[0] else { panic!("{cell}") };
            assert_eq!(fast.to_bits(), slow.to_bits(), "{cell}");
        }
        for (cell, integer) in [("-7", -7), ("+12", 12), ("999999999999999999", 999_999_999_999_999_999)] {
            assert_eq!(read(&[cell]).0, [Ok(Number::Integer(integer))]);
        }
        assert_eq!(read(&["-9223372036854775808"]).0, [Ok(Number::Integer(i64::MIN))]);
        assert!(read(&["."]).0[0].is_err() && read(&["+"]).0[0].is_err() && read(&["1.2.3"]).0[0].is_err());
    }
}
