//! Finds a `sensor_msgs/Imu` inside a message of another type, by the definition of that type in the bag.
//!
//! A definition begins with the text of the message's own file. The texts of the types that it uses follow, each
//! behind `===` and `MSG: name`.

use super::message::{Body, is_imu};
use std::collections::BTreeMap;

/// Limits of a definition: depth of nested messages, number of fields, and number of IMUs in one message.
const DEPTH: usize = 16;
const FIELDS: usize = 10_000;
const IMUS: usize = 64;

/// An IMU inside a message of another type.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The names of the fields that lead to the IMU: `state.imu`.
    pub path: String,
    before: Vec<Field>,
}

/// A field before the IMU. The variants show how to find the length of the field.
#[derive(Clone, Debug, PartialEq)]
enum Field {
    /// `count` numbers of `size` bytes each.
    Numbers {
        size: usize,
        count: usize,
    },
    Text,
    /// A number of elements that the type states, each with these fields.
    Array(usize, Vec<Field>),
    /// Elements with these fields. The message states their number in front of them.
    Sequence(Vec<Field>),
}

/// The IMUs in messages of type `kind`; none if the definition is invalid or exceeds a limit. IMUs in arrays do not
/// count.
pub fn places(kind: &str, definition: &str) -> Vec<Place> {
    let mut definitions = Definitions { by_name: BTreeMap::new(), fields: 0 };
    for (at, part) in definition.split("\n===").enumerate() {
        let (name, text) = match part.split_once("MSG: ") {
            Some((_, rest)) if at > 0 => rest.split_once('\n').unwrap_or((rest, "")),
            _ => (kind, part),
        };
        definitions.by_name.insert(short(name.trim()), text);
    }
    let mut found = Vec::new();
    let whole = definitions.follow(&short(kind), "", &mut Vec::new(), &mut found, DEPTH);
    if whole.is_some() { found } else { Vec::new() }
}

/// The type name without `msg/`: `package/Type` for both `package/Type` and `package/msg/Type`.
fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

struct Definitions<'a> {
    by_name: BTreeMap<String, &'a str>,
    fields: usize,
}

impl Definitions<'_> {
    /// Appends the fields of the type `kind` to `before`, and adds the IMUs among them to `found`. Returns `None` if a
    /// definition is missing or wrong, or a limit is exceeded.
    fn follow(
        &mut self,
        kind: &str,
        path: &str,
        before: &mut Vec<Field>,
        found: &mut Vec<Place>,
        depth: usize,
    ) -> Option<()> {
        let (text, depth) = (*self.by_name.get(kind)?, depth.checked_sub(1)?);
        let package = kind.split('/').next().unwrap_or_default().to_owned();
        for (field, name) in text.lines().filter_map(declaration) {
            self.fields += 1;
            (self.fields < FIELDS && found.len() < IMUS).then_some(())?;
            let (element, many) = split_array(field)?;
            let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
            let Some(plain) = plain(element) else {
                let kind = self.resolve(element, &package)?;
                match many {
                    None => {
                        if is_imu(&kind) {
                            found.push(Place { path: path.clone(), before: before.clone() });
                        }
                        self.follow(&kind, &path, before, found, depth)?;
                    }
                    Some(many) => {
                        let mut inside = Vec::new();
                        self.follow(&kind, &path, &mut inside, &mut Vec::new(), depth)?;
                        before.push(many.of(inside));
                    }
                }
                continue;
            };
            before.push(match many {
                None => plain,
                Some(many) => many.of(vec![plain]),
            });
        }
        Some(())
    }

    /// The full name of a type. One without a package is of the package that uses it or, like `Header`, of `std_msgs`.
    fn resolve(&self, name: &str, package: &str) -> Option<String> {
        let name = short(name);
        let candidates = [name.clone(), format!("{package}/{name}"), format!("std_msgs/{name}")];
        candidates.into_iter().find(|name| self.by_name.contains_key(name))
    }
}

/// Type and name of a field; `None` for constants, comments and empty lines.
fn declaration(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next()?.trim();
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let name = rest.split_whitespace().next()?;
    let is_constant = rest.contains('=') && !kind.contains('=');
    (!is_constant).then_some((kind, name))
}

/// The number of elements of an array: a known number, or a number that the message states.
enum Many {
    Known(usize),
    Stated,
}

impl Many {
    fn of(self, element: Vec<Field>) -> Field {
        match self {
            Self::Known(count) => Field::Array(count, element),
            Self::Stated => Field::Sequence(element),
        }
    }
}

/// Splits a type into the type of an element and, in an array, their number: `float64`, `float64[9]`, `float64[]`,
/// `float64[<=9]`.
fn split_array(kind: &str) -> Option<(&str, Option<Many>)> {
    let Some((element, count)) = kind.strip_suffix(']').and_then(|kind| kind.rsplit_once('[')) else {
        return Some((kind, None));
    };
    let is_stated = count.is_empty() || count.starts_with("<=");
    Some((element, Some(if is_stated { Many::Stated } else { Many::Known(count.parse().ok()?) })))
}

/// The field of a built-in type of the message language; `None` for other types.
fn plain(kind: &str) -> Option<Field> {
    let size = match kind {
        "bool" | "byte" | "char" | "int8" | "uint8" => 1,
        "int16" | "uint16" => 2,
        "int32" | "uint32" | "float32" => 4,
        "int64" | "uint64" | "float64" => 8,
        // types of ROS 1, which consist of two numbers
        "time" | "duration" => return Some(Field::Numbers { size: 4, count: 2 }),
        _ if kind == "string" || kind.starts_with("string<=") => return Some(Field::Text),
        _ => return None,
    };
    Some(Field::Numbers { size, count: 1 })
}

impl Place {
    /// The offset in the body at which the IMU begins.
    pub fn start(&self, body: &Body<'_>) -> Option<usize> {
        skip(&self.before, body, 0)
    }
}

/// The offset behind these fields, which begin at `at`.
fn skip(fields: &[Field], body: &Body<'_>, mut at: usize) -> Option<usize> {
    for field in fields {
        at = match field {
            Field::Numbers { size, count } => body.aligned(at, *size).checked_add(size * count)?,
            Field::Text => {
                let at = body.aligned(at, 4);
                (at + 4).checked_add(body.u32_at(at)? as usize)?
            }
            Field::Array(count, element) => repeat(element, *count, body, at)?,
            Field::Sequence(element) => {
                let at = body.aligned(at, 4);
                repeat(element, body.u32_at(at)? as usize, body, at + 4)?
            }
        };
        body.holds(at).then_some(())?;
    }
    Some(at)
}

fn repeat(element: &[Field], count: usize, body: &Body<'_>, mut at: usize) -> Option<usize> {
    if let ([Field::Numbers { size, count: each }], 1..) = (element, count) {
        return body.aligned(at, *size).checked_add(size.checked_mul(*each)?.checked_mul(count)?);
    }
    for _ in 0..count {
        let next = skip(element, body, at)?;
        // elements of no bytes could be repeated billions of times
        (next > at).then_some(())?;
        at = next;
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMU: &str = "Header header\nfloat64[9] orientation_covariance\n===\nMSG: std_msgs/Header\nuint32 seq\ntime \
                       stamp\nstring frame_id\n";

    #[test]
    fn an_imu_is_found_by_the_definition() {
        let text = format!(
            "# a bundle\nstring NAME=front\nuint8 kind\nHeader header\nsensor_msgs/Imu imu  # the first\nPart[] \
             parts\nState state\n====\nMSG: my/Part\nfloat32 x\n====\nMSG: my/State\nfloat32[3] v\nsensor_msgs/Imu \
             imu\n====\nMSG: sensor_msgs/Imu\n{IMU}"
        );
        let found = places("my/Bundle", &text);
        assert_eq!(found.iter().map(|place| place.path.as_str()).collect::<Vec<_>>(), ["imu", "state.imu"]);
        let numbers = |size, count| Field::Numbers { size, count };
        assert_eq!(found[0].before, [numbers(1, 1), numbers(4, 1), numbers(4, 2), Field::Text]);
    }

    #[test]
    fn a_definition_without_sense_has_no_imu() {
        for text in ["sensor_msgs/Imu imu\n", "Loop loop\n", "wstring a\nsensor_msgs/Imu imu\n", ""] {
            let text = format!("{text}===\nMSG: my/Loop\nLoop loop\n");
            assert_eq!(places("my/Bundle", &text), [], "{text}");
        }
        assert_eq!(places("my/Loop", "Loop loop\n"), []);
    }
}
