//! The header of a NumPy array: a literal of Python with the type of the elements, their order and the shape (NEP 1).

use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{alt, delimited, opt, separated, separated_pair, terminated};
use winnow::error::ContextError;
use winnow::token::take_till;
use winnow::{Parser, Result};
use zerorate_input::TimeUnit;

pub struct Header {
    pub element: Element,
    /// True if the first index runs fastest.
    pub is_fortran: bool,
    pub shape: Vec<u64>,
}

pub struct Element {
    /// The size of the element in bytes, if it is fixed.
    pub size: Option<u64>,
    pub form: Form,
}

pub enum Form {
    /// One value. `kind` is `None` if the value is not a supported number.
    Value { kind: Option<Kind>, big_endian: bool, time_unit: Option<TimeUnit> },
    /// Fields, one behind the other without padding.
    Fields(Vec<(String, Element)>),
    /// Several values of one type.
    Array,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Signed,
    Unsigned,
    Float,
    /// A date or a duration: a signed number of time units.
    Time,
}

impl Header {
    /// Parses the text of a header; `None` if NumPy does not write a header like it.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let Literal::Table(entries) = literal.parse(str::from_utf8(text).ok()?).ok()? else { return None };
        let entry = |key| entries.iter().rfind(|(name, _)| name == key).map(|(_, value)| value);
        let Literal::Truth(is_fortran) = entry("fortran_order")? else { return None };
        let (element, shape) = (Element::of(entry("descr")?)?, shape(entry("shape")?)?);
        Some(Self { element, is_fortran: *is_fortran, shape })
    }
}

impl Element {
    fn of(literal: &Literal) -> Option<Self> {
        match literal {
            Literal::Text(code) => Self::value(code),
            Literal::Sequence(fields) => {
                let fields = fields.iter().map(Self::field).collect::<Option<Vec<_>>>()?;
                let size = fields.iter().try_fold(0u64, |size, (_, field)| size.checked_add(field.size?));
                Some(Self { size, form: Form::Fields(fields) })
            }
            _ => None,
        }
    }

    /// Parses the code of a value, such as `<f8` or `<M8[us]`.
    fn value(code: &str) -> Option<Self> {
        let (code, unit) = match code.strip_suffix(']') {
            Some(code) => code.split_once('[').map(|(code, unit)| (code, Some(unit)))?,
            None => (code, None),
        };
        let mut letters = code.chars();
        let (order, letter) = (letters.next()?, letters.next()?);
        if !"<>|".contains(order) {
            return None;
        }
        if letter == 'O' {
            return Some(Self { size: None, form: Form::Value { kind: None, big_endian: false, time_unit: None } });
        }
        let number: u64 = letters.as_str().parse().ok()?;
        let kind = match (letter, number) {
            ('i', 1 | 2 | 4 | 8) => Some(Kind::Signed),
            ('u', 1 | 2 | 4 | 8) => Some(Kind::Unsigned),
            ('f', 4 | 8) => Some(Kind::Float),
            ('M' | 'm', 8) => Some(Kind::Time),
            _ => None,
        };
        let time_unit = TimeUnit::ALL.into_iter().find(|known| unit == Some(known.name()));
        // a Unicode character has four bytes
        let size = number.checked_mul(if letter == 'U' { 4 } else { 1 });
        Some(Self { size, form: Form::Value { kind, big_endian: order == '>', time_unit } })
    }

    /// Parses a field: its name, its type, and its shape, if it has several values.
    fn field(literal: &Literal) -> Option<(String, Self)> {
        let Literal::Sequence(parts) = literal else { return None };
        let (name, kind, several) = match parts.as_slice() {
            [Literal::Text(name), kind] => (name, kind, None),
            [Literal::Text(name), kind, several] => (name, kind, Some(shape(several)?)),
            _ => return None,
        };
        let one = Self::of(kind)?;
        let element = match several {
            None => one,
            Some(several) => {
                let size = several.iter().try_fold(one.size?, |size, length| size.checked_mul(*length));
                Self { size, form: Form::Array }
            }
        };
        Some((name.clone(), element))
    }
}

fn shape(literal: &Literal) -> Option<Vec<u64>> {
    let Literal::Sequence(lengths) = literal else { return None };
    let length = |length: &Literal| if let Literal::Number(number) = length { Some(*number) } else { None };
    lengths.iter().map(length).collect()
}

#[derive(Clone)]
enum Literal {
    Text(String),
    Number(u64),
    Truth(bool),
    Sequence(Vec<Self>),
    Table(Vec<(String, Self)>),
}

fn literal(input: &mut &str) -> Result<Literal> {
    let literal = alt((
        text.map(Literal::Text),
        digit1.parse_to().map(Literal::Number),
        "True".value(Literal::Truth(true)),
        "False".value(Literal::Truth(false)),
        delimited('(', list(literal), ')').map(Literal::Sequence),
        delimited('[', list(literal), ']').map(Literal::Sequence),
        delimited('{', list(separated_pair(spaced(text), ':', literal)), '}').map(Literal::Table),
    ));
    spaced(literal).parse_next(input)
}

/// Parses a quoted text without escapes.
fn text(input: &mut &str) -> Result<String> {
    let quoted = |quote| delimited(quote, take_till(0.., quote), quote);
    alt((quoted('\''), quoted('"'))).map(str::to_owned).parse_next(input)
}

/// Parses items between commas. A comma may follow the last item.
fn list<'a, T>(item: impl Parser<&'a str, T, ContextError>) -> impl Parser<&'a str, Vec<T>, ContextError> {
    terminated(separated(0.., item, ','), (opt(','), multispace0))
}

fn spaced<'a, T>(inner: impl Parser<&'a str, T, ContextError>) -> impl Parser<&'a str, T, ContextError> {
    delimited(multispace0, inner, multispace0)
}
