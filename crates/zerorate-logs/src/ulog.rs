//! Reads PX4 logs in ULog format (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>): formats that name the
//! fields of messages, subscriptions that name topics, and data. Times are µs since the start of the controller.

use super::binary::{BinaryNumber, Coding};
use super::clock::Times;
use super::open::{BUFFER, Log, ULOG};
use super::series::SeriesBuilder;
use super::topics::{Survey, several};
use crate::choice::{ColumnSelection, ColumnSpec, TEMPERATURE_COLUMN};
use crate::error::{LogError, Result};
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::setting::Setting;
use crate::warning::LogWarning;
use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use zerorate_input::{Input, InputError, InputWarning, Quantity, TimeUnit, Unit};

/// Size of the file header in bytes: the magic number, a version and a time.
const HEAD: usize = 16;

/// Number of rows between two checks of the memory limit.
const PIECE: u64 = 1024;

const MAX_DEPTH: usize = 8;

/// Largest number of fields of a topic; the longest topics of PX4 have some hundreds.
const MAX_FIELDS: usize = 4096;

/// Topics with the readings of an IMU: the name of the topic, the start of the names of its axes, and their unit.
const IMUS: [(&str, &str, Unit); 6] = [
    ("sensor_gyro", "", Unit::RadPerS),
    ("sensor_accel", "", Unit::MPerS2),
    ("sensor_combined", "gyro_rad", Unit::RadPerS),
    ("sensor_combined", "accelerometer_m_s2", Unit::MPerS2),
    ("vehicle_angular_velocity", "xyz", Unit::RadPerS),
    ("vehicle_acceleration", "xyz", Unit::MPerS2),
];

/// The topic of a gyroscope driver's own readings.
const GYRO: &str = "sensor_gyro";

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input, room, .. } = log;
    let mut messages = Messages::new(path, BufReader::with_capacity(BUFFER, input))?;
    let mut topics = Topics::default();
    let (mut pending, mut of_end) = (None, None);
    // most formats and subscriptions are before all data, but others may follow anywhere, so all messages are read
    let all = messages.all(&mut of_end, |kind, body| topics.take(kind, body).is_some())?;
    let chosen = topics.choose(path, asked)?;
    let mut times = Times::new();
    times.unit = Some(TimeUnit::Us);
    let mut values: Vec<_> = chosen.fields.iter().map(|_| SeriesBuilder::sharing(room, chosen.fields.len())).collect();
    let mut again = Messages::new(path, BufReader::with_capacity(BUFFER, all))?;
    let (mut row, mut full) = (0u64, None);
    again.all(&mut pending, |kind, body| {
        let Some(data) = body.strip_prefix(&chosen.id.to_le_bytes()[..]).filter(|_| kind == b'D') else { return true };
        let Some(BinaryNumber::Integer(time)) = chosen.time.value(data) else { return true };
        let numbers: Option<Vec<BinaryNumber>> = chosen.fields.iter().map(|(_, field)| field.value(data)).collect();
        let Some(numbers) = numbers else { return true };
        row += 1;
        times.push_integer(time);
        for (values, number) in values.iter_mut().zip(numbers) {
            // a value that is not finite is a missing sample
            if !number.add_to(values) {
                values.push_number(f64::NAN);
            }
        }
        if row.is_multiple_of(PIECE) {
            full = values.first().and_then(|values| values.check_room(PIECE).err());
        }
        full.is_none()
    })?;
    full.map_or(Ok(()), |why| Err(InputError::over_budget(path, why)))?;
    let name = format!("{}.{}", chosen.topic, chosen.time.name);
    let columns = chosen.fields.into_iter().zip(values).map(|((name, field), values)| RawColumn {
        stated: stated(&chosen.topic, &field.name).or_else(|| temperature(&chosen.topic, &field.name)),
        ..RawColumn::new(name, values)
    });
    Ok(RawColumns::new(columns, Some((name, times)), of_end.map(LogWarning::File)))
}

/// The quantity of an IMU's field, and the size of its unit in the unit of results, by PX4's definition.
fn stated(topic: &str, field: &str) -> Option<(Quantity, f64)> {
    let topic = topic.split('#').next().unwrap_or(topic);
    let is_axis = |rest: &str| matches!(rest, "x" | "y" | "z" | "[0]" | "[1]" | "[2]");
    let found = IMUS.iter().find(|(name, start, _)| *name == topic && field.strip_prefix(start).is_some_and(is_axis));
    found.map(|(_, _, unit)| (unit.quantity(), unit.in_results()))
}

/// The quantity of a sensor's temperature field, and the size of its unit: 1, for °C.
fn temperature(topic: &str, field: &str) -> Option<(Quantity, f64)> {
    (topic.starts_with("sensor_") && field == "temperature").then_some((Quantity::Temperature, 1.0))
}

/// The name of the field that a description means. A name that is not exact means a field of `sensor_gyro`.
fn of_driver(column: &ColumnSpec) -> String {
    match (column.is_exact, column.name.as_str()) {
        (true, name) => name.to_owned(),
        (false, TEMPERATURE_COLUMN) => format!("{GYRO}.temperature"),
        (false, name) => format!("{GYRO}.{name}"),
    }
}

/// The messages of a log: length, kind, body.
struct Messages<'a> {
    path: &'a Path,
    file: BufReader<Input>,
}

impl<'a> Messages<'a> {
    fn new(path: &'a Path, mut file: BufReader<Input>) -> Result<Self, InputError> {
        let mut head = [0; HEAD];
        file.read_exact(&mut head).map_err(|_| InputError::damaged(path, "as a PX4 log", "it ends in its head"))?;
        Ok(Self { path, file })
    }

    /// Calls `take` with each message until `take` returns false. Returns the input, from its start. `of_end` receives
    /// the warning if a body is cut off, if `take` returned false, or if another log follows.
    fn all(
        &mut self,
        of_end: &mut Option<InputWarning>,
        mut take: impl FnMut(u8, &[u8]) -> bool,
    ) -> Result<Input, InputError> {
        let failed = |error| InputError::io("read", self.path, error);
        let torn = |why| InputWarning::Torn(format!("{}: {why}; the rest is dropped", self.path.display()));
        let (mut body, mut end) = (Vec::new(), HEAD as u64);
        loop {
            if self.file.fill_buf().map_err(failed)?.is_empty() {
                break;
            }
            let mut head = [0; 3];
            match self.file.read_exact(&mut head) {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    *of_end = Some(torn("it ends inside a message"));
                    break;
                }
                Err(error) => return Err(failed(error)),
            }
            let length = u16::from_le_bytes([head[0], head[1]]).into();
            body.clear();
            (&mut self.file).take(length).read_to_end(&mut body).map_err(failed)?;
            if head == ULOG[..3] && body.starts_with(&ULOG[3..]) {
                *of_end = InputWarning::behind_end(self.path, self.file.get_ref(), end)?;
                break;
            }
            if (body.len() as u64) < length {
                *of_end = Some(torn("it ends inside a message"));
                break;
            }
            if !take(head[2], &body) {
                *of_end = Some(torn("a message makes no sense"));
                break;
            }
            end += head.len() as u64 + length;
        }
        self.file.get_ref().rewound().map_err(failed)
    }
}

#[derive(Default)]
struct Topics {
    /// The fields of each format, as they are written, by the name of the format.
    formats: BTreeMap<String, Vec<(String, String)>>,
    /// Name and instance of each topic, by its number in messages.
    logged: BTreeMap<u16, (String, u8)>,
    /// The number of messages of each topic, and the times of the first and the last, µs.
    seen: BTreeMap<u16, (u64, i64, i64)>,
}

#[derive(Clone, Debug, PartialEq)]
struct Field {
    name: String,
    coding: Coding,
    at: usize,
    size: usize,
}

struct Chosen {
    id: u16,
    topic: String,
    time: Field,
    fields: Vec<(String, Field)>,
}

impl Topics {
    fn take(&mut self, kind: u8, body: &[u8]) -> Option<()> {
        match kind {
            b'F' => {
                let text = std::str::from_utf8(body).ok()?;
                let (name, fields) = text.split_once(':')?;
                let fields = fields.split(';').filter(|field| !field.is_empty());
                let fields =
                    fields.map(|field| field.split_once(' ').map(|(kind, name)| (kind.to_owned(), name.to_owned())));
                self.formats.insert(name.to_owned(), fields.collect::<Option<_>>()?);
            }
            b'A' => {
                let (head, name) = body.split_first_chunk::<3>()?;
                let id = u16::from_le_bytes([head[1], head[2]]);
                self.logged.insert(id, (std::str::from_utf8(name).ok()?.to_owned(), head[0]));
            }
            // the time comes first in every message
            b'D' => {
                if let Some((id, data)) = body.split_first_chunk::<2>() {
                    let time = data.first_chunk::<8>().map_or(0, |bytes| i64::from_le_bytes(*bytes));
                    let seen = self.seen.entry(u16::from_le_bytes(*id)).or_insert((0, time, time));
                    *seen = (seen.0 + 1, seen.1, time);
                }
            }
            _ => {}
        }
        Some(())
    }

    /// The number of each topic by its name, which includes the instance if the topic has several: `sensor_gyro#1`.
    fn names(&self) -> BTreeMap<String, u16> {
        let several = |topic: &str| self.logged.values().filter(|(name, _)| name == topic).count() > 1;
        let named = self.logged.iter().map(|(id, (topic, instance))| match several(topic) {
            true => (format!("{topic}#{instance}"), *id),
            false => (topic.clone(), *id),
        });
        named.collect()
    }

    /// The fields of a topic that are numbers.
    fn fields(&self, id: u16) -> Option<Vec<Field>> {
        let mut fields = Vec::new();
        self.expand(&self.logged.get(&id)?.0, "", &mut 0, MAX_DEPTH, &mut fields)?;
        Some(fields)
    }

    /// The fields of a topic with readings of an IMU, each with its full name.
    fn axes(&self, topic: &str, id: u16) -> Vec<(String, Field)> {
        let fields = self.fields(id).unwrap_or_default().into_iter();
        let axes = fields.filter(|field| stated(topic, &field.name).is_some());
        axes.map(|field| (format!("{topic}.{}", field.name), field)).collect()
    }

    fn expand(&self, format: &str, before: &str, at: &mut usize, depth: usize, fields: &mut Vec<Field>) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        for (kind, name) in self.formats.get(format)? {
            let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
                Some((kind, count)) => (kind, Some(count.parse::<usize>().ok()?)),
                None => (kind.as_str(), None),
            };
            for index in 0..count.unwrap_or(1) {
                let index = count.map_or_else(String::new, |_| format!("[{index}]"));
                let name = format!("{before}{name}{index}");
                match basic_type(kind) {
                    Some((Some(coding), size)) => {
                        fields.push(Field { name, coding, at: *at, size });
                        *at += size;
                    }
                    Some((None, size)) => *at += size,
                    None => {
                        let before = *at;
                        self.expand(kind, &format!("{name}."), at, depth, fields)?;
                        // an array whose elements have no bytes may state any length
                        if *at == before {
                            return None;
                        }
                    }
                }
                if fields.len() > MAX_FIELDS || *at > usize::from(u16::MAX) {
                    return None;
                }
            }
        }
        Some(())
    }

    fn choose(&self, path: &Path, asked: &ColumnQuery<'_>) -> Result<Chosen> {
        let names = self.names();
        let wanted: Vec<String> = match asked.wanted {
            ColumnSelection::One(Some(name)) => vec![name.to_owned()],
            ColumnSelection::Listed(names) | ColumnSelection::First(names) => names.to_vec(),
            ColumnSelection::Described(columns) => columns.iter().map(of_driver).collect(),
            ColumnSelection::One(None) | ColumnSelection::All => Vec::new(),
        };
        let ask = |why: String| {
            let option = asked.args.names.of(Setting::Column);
            LogError::Ask(format!("{} {why}; choose with {option} one of: {}", path.display(), self.offered()))
        };
        if wanted.is_empty() {
            if !matches!(asked.wanted, ColumnSelection::All) {
                return Err(ask("has several columns".to_owned()));
            }
            let topic = asked.args.topic.as_deref().unwrap_or("sensor_combined");
            let chosen = names.get(topic).map(|id| (*id, self.axes(topic, *id))).filter(|(_, axes)| !axes.is_empty());
            let Some((id, fields)) = chosen else { return Err(self.several(path, asked)) };
            return self.chosen(path, topic, id, fields);
        }
        let mut found: Vec<(String, u16, (String, Field))> = Vec::new();
        for wanted in &wanted {
            let split = names.iter().find_map(|(topic, id)| {
                let of_topic = || wanted.strip_prefix(topic.as_str())?.strip_prefix('.');
                let is_chosen = asked.args.topic.as_ref() == Some(topic);
                let field = of_topic().or(is_chosen.then_some(wanted.as_str()))?;
                let field = self.fields(*id)?.into_iter().find(|one| one.name == field)?;
                Some((topic.clone(), *id, (wanted.to_owned(), field)))
            });
            found.push(split.ok_or_else(|| ask(format!("has no column `{wanted}`")))?);
        }
        let Some((topic, id, _)) = found.first().cloned() else { return Err(ask("has several columns".to_owned())) };
        if let Some((other, ..)) = found.iter().find(|(_, other, _)| *other != id) {
            let why = format!("the columns are of two topics, `{topic}` and `{other}`, which keep different time");
            return Err(LogError::Ask(format!("{}: {why}; read one at a time", path.display())));
        }
        self.chosen(path, &topic, id, found.into_iter().map(|(_, _, field)| field).collect())
    }

    /// The chosen fields, with the time of the sensor's reading or, if that is not logged, the time of the message.
    fn chosen(&self, path: &Path, topic: &str, id: u16, fields: Vec<(String, Field)>) -> Result<Chosen> {
        let all = self.fields(id).unwrap_or_default();
        let named = |name: &str| all.iter().find(|field| field.name == name).cloned();
        let time = named("timestamp_sample").or_else(|| named("timestamp"));
        let time = time.ok_or_else(|| InputError::damaged(path, format!("topic {topic}"), "it has no timestamp"))?;
        Ok(Chosen { id, topic: topic.to_owned(), time, fields })
    }

    /// The error for a request that selects no topic with an IMU.
    fn several(&self, path: &Path, asked: &ColumnQuery<'_>) -> LogError {
        let mut survey = Survey::default();
        for (topic, id) in self.names() {
            let kind = topic.split('#').next().unwrap_or(&topic);
            if IMUS.iter().any(|(name, ..)| *name == kind) {
                let (messages, first, last) = self.seen.get(&id).copied().unwrap_or_default();
                survey.counted(&topic, kind, messages, [first, last].map(|time_us| time_us.saturating_mul(1000)));
            }
        }
        several(path, asked, &survey)
    }

    /// Lists the fields with readings of IMUs or, without any, the topics. A request may name any other field as well.
    fn offered(&self) -> String {
        let axes = |(topic, id): (&String, &u16)| self.axes(topic, *id).into_iter().map(|(name, _)| name);
        let offered: Vec<String> = self.names().iter().flat_map(axes).collect();
        match offered.is_empty() {
            true => format!("TOPIC.FIELD of its topics {}", self.names().into_keys().collect::<Vec<_>>().join(", ")),
            false => offered.join(", "),
        }
    }
}

/// Looks up a basic type. Returns its coding, which `bool` and `char` do not have, and its size in bytes.
fn basic_type(name: &str) -> Option<(Option<Coding>, usize)> {
    Some(match name {
        "int8_t" => (Some(Coding::Signed), 1),
        "int16_t" => (Some(Coding::Signed), 2),
        "int32_t" => (Some(Coding::Signed), 4),
        "int64_t" => (Some(Coding::Signed), 8),
        "uint8_t" => (Some(Coding::Unsigned), 1),
        "uint16_t" => (Some(Coding::Unsigned), 2),
        "uint32_t" => (Some(Coding::Unsigned), 4),
        "uint64_t" => (Some(Coding::Unsigned), 8),
        "float" => (Some(Coding::Float), 4),
        "double" => (Some(Coding::Float), 8),
        "bool" | "char" => (None, 1),
        _ => return None,
    })
}

impl Field {
    fn value(&self, data: &[u8]) -> Option<BinaryNumber> {
        Some(BinaryNumber::decode(self.coding, data.get(self.at..)?.get(..self.size)?, false))
    }
}
