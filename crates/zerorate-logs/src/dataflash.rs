//! Reads ArduPilot logs in DataFlash format (`.bin`). FMT messages name the fields of the other messages.
//! <https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html> lists the letters of the field types.

use super::binary::{BinaryNumber, Coding};
use super::clock::Times;
use super::open::{ARDUPILOT, BUFFER, Log};
use super::series::SeriesBuilder;
use super::topics::{Survey, several};
use crate::choice::ColumnSelection;
use crate::error::{LogError, Result};
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::setting::Setting;
use crate::warning::LogWarning;
use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};
use std::path::Path;
use zerorate_input::{Input, InputError, InputWarning, Quantity, TimeUnit, Unit};

/// The type number of an FMT message.
const FMT: u8 = 128;
/// Size of the head of a message in bytes: two marker bytes, and the type number.
const HEAD: usize = 3;
/// Size of the fields of an FMT message in bytes.
const FMT_BODY: usize = 86;
/// Number of messages between two checks of the memory limit.
const PIECE: u64 = 1024;

/// Reads fields of one type of message, and of one instance of the sensor.
pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input, room, .. } = log;
    let mut topics = Topics::default();
    let mut messages = Messages::new(path, input);
    messages.all(|id, form, body| {
        topics.take(id, form, body);
        true
    })?;
    let chosen = topics.choose(path, asked)?;
    let mut times = Times::new();
    times.unit = Some(chosen.time.1);
    let mut values: Vec<_> = chosen.fields.iter().map(|_| SeriesBuilder::sharing(room, chosen.fields.len())).collect();
    let (mut row, mut full) = (0u64, None);
    let input = messages.file.get_ref().rewound().map_err(|error| InputError::io("read", path, error))?;
    let mut again = Messages::new(path, input);
    again.all(|id, form, body| {
        if id != chosen.id || form.instance(body) != chosen.instance {
            return true;
        }
        let Some(time) = chosen.time.0.number(body) else { return true };
        times.push_integer(time as i64);
        for (values, field) in values.iter_mut().zip(&chosen.fields) {
            // a value that is not finite is a missing sample
            let number = field.number(body).filter(|number| number.is_finite()).unwrap_or(f64::NAN);
            values.push_number(number);
        }
        row += 1;
        if row.is_multiple_of(PIECE) {
            full = values.first().and_then(|values| values.check_room(PIECE).err());
        }
        full.is_none()
    })?;
    full.map_or(Ok(()), |why| Err(InputError::over_budget(path, why)))?;
    let lost = (again.skipped > 0).then(|| {
        let (path, bytes, places) = (path.display(), again.skipped, again.places);
        let plural = if places == 1 { "" } else { "s" };
        let text = format!("{path}: skipped {bytes} unreadable bytes in {places} place{plural}");
        LogWarning::File(InputWarning::Torn(text))
    });
    let columns = chosen.fields.iter().zip(values).map(|(field, values)| RawColumn {
        stated: stated(&field.name),
        ..RawColumn::new(format!("{}.{}", chosen.topic, field.name), values)
    });
    let time = (format!("{}.{}", chosen.topic, chosen.time.0.name), times);
    Ok(RawColumns::new(columns, Some(time), lost))
}

/// The quantity of a field, and the size of its unit in the unit of results. Rates are in rad/s and accelerations in
/// m/s² in all versions of ArduPilot.
fn stated(field: &str) -> Option<(Quantity, f64)> {
    let unit = match field {
        "GyrX" | "GyrY" | "GyrZ" => Unit::RadPerS,
        "AccX" | "AccY" | "AccZ" => Unit::MPerS2,
        "T" | "Temp" => return Some((Quantity::Temperature, 1.0)),
        _ => return None,
    };
    Some((unit.quantity(), unit.in_results()))
}

fn is_axis(field: &Field) -> bool {
    stated(&field.name).is_some_and(|(quantity, _)| quantity != Quantity::Temperature)
}

pub struct Messages<'a> {
    path: &'a Path,
    file: BufReader<Input>,
    forms: BTreeMap<u8, Form>,
    /// Number of skipped bytes, and number of places with such bytes.
    skipped: u64,
    places: u64,
}

impl<'a> Messages<'a> {
    pub fn new(path: &'a Path, input: Input) -> Self {
        let file = BufReader::with_capacity(BUFFER, input);
        Self { path, file, forms: BTreeMap::new(), skipped: 0, places: 0 }
    }

    /// Calls `take` with each message but FMT until `take` returns false. Skips bytes outside messages.
    pub fn all(&mut self, mut take: impl FnMut(u8, &Form, &[u8]) -> bool) -> Result<(), InputError> {
        let (mut head, mut body) = ([0; HEAD], [0; u8::MAX as usize]);
        let mut is_lost = false;
        let mut goes_on = self.fill(&mut head)?;
        while goes_on {
            let id = head[2];
            let length = if id == FMT { Some(FMT_BODY) } else { self.forms.get(&id).map(|form| form.length) };
            let Some(length) = length.filter(|_| head[..2] == ARDUPILOT) else {
                self.places += u64::from(!is_lost);
                self.skipped += 1;
                is_lost = true;
                head.rotate_left(1);
                goes_on = self.fill(&mut head[2..])?;
                continue;
            };
            is_lost = false;
            let body = &mut body[..length];
            if !self.fill(body)? {
                break;
            }
            match self.forms.get(&id).filter(|_| id != FMT) {
                Some(form) if !take(id, form, body) => break,
                Some(_) => {}
                None => self.forms.extend(Form::parse(body)),
            }
            goes_on = self.fill(&mut head)?;
        }
        Ok(())
    }

    /// Fills the buffer; false if the file has too few bytes.
    fn fill(&mut self, bytes: &mut [u8]) -> Result<bool, InputError> {
        match self.file.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(InputError::io("read", self.path, error)),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Form {
    pub name: String,
    /// Length of the message behind its head, in bytes.
    length: usize,
    fields: Vec<Field>,
}

#[derive(Clone, Debug, PartialEq)]
struct Field {
    name: String,
    /// The letter of the field's type in the FMT message.
    kind: u8,
    at: usize,
}

impl Form {
    /// Parses the fields of FMT: number, length, name, letters, labels. Returns `None` if they contradict each other
    /// or have an unknown letter.
    fn parse(body: &[u8]) -> Option<(u8, Self)> {
        let text = |range: std::ops::Range<usize>| until_zero(body.get(range)?);
        let (id, length) = (*body.first()?, usize::from(*body.get(1)?).checked_sub(HEAD)?);
        let (name, letters, labels) = (text(2..6)?, text(6..22)?, text(22..86)?);
        let (mut fields, mut at) = (Vec::new(), 0);
        for (kind, label) in letters.bytes().zip(labels.split(',')) {
            fields.push(Field { name: label.to_owned(), kind, at });
            at += size(kind)?;
        }
        (at <= length && id != FMT && !name.is_empty()).then(|| (id, Self { name: name.to_owned(), length, fields }))
    }

    fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    pub fn number(&self, name: &str, body: &[u8]) -> Option<f64> {
        self.field(name)?.number(body)
    }

    pub fn text(&self, name: &str, body: &[u8]) -> Option<String> {
        let field = self.field(name)?;
        until_zero(body.get(field.at..field.at + size(field.kind)?)?).map(str::to_owned)
    }

    /// The number of the sensor; `None` if the message does not state it.
    fn instance(&self, body: &[u8]) -> Option<u8> {
        let field = self.field("I").filter(|field| size(field.kind) == Some(1))?;
        body.get(field.at).copied()
    }

    /// The time at which the sensor was read or, if that is not logged, at which the message was made.
    fn time(&self) -> Option<(Field, TimeUnit)> {
        let units = [("SampleUS", TimeUnit::Us), ("TimeUS", TimeUnit::Us), ("TimeMS", TimeUnit::Ms)];
        units.into_iter().find_map(|(name, unit)| Some((self.field(name)?.clone(), unit)))
    }
}

fn until_zero(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes.split(|byte| *byte == 0).next()?).ok()
}

fn size(kind: u8) -> Option<usize> {
    Some(match kind {
        b'b' | b'B' | b'M' => 1,
        b'h' | b'H' | b'c' | b'C' | b'g' => 2,
        b'i' | b'I' | b'e' | b'E' | b'L' | b'f' | b'n' => 4,
        b'q' | b'Q' | b'd' => 8,
        b'N' => 16,
        b'a' | b'Z' => 64,
        _ => return None,
    })
}

impl Field {
    /// The value of the field; `None` for text, arrays and half-precision numbers. The letters c, C, e and E stand for
    /// hundredths.
    fn number(&self, body: &[u8]) -> Option<f64> {
        let coding = match self.kind {
            b'f' | b'd' => Coding::Float,
            b'b' | b'h' | b'i' | b'L' | b'q' | b'c' | b'e' => Coding::Signed,
            b'B' | b'M' | b'H' | b'I' | b'Q' | b'C' | b'E' => Coding::Unsigned,
            _ => return None,
        };
        let bytes = body.get(self.at..)?.get(..size(self.kind)?)?;
        let number = BinaryNumber::decode(coding, bytes, false).as_f64();
        Some(if matches!(self.kind, b'c' | b'C' | b'e' | b'E') { number / 100.0 } else { number })
    }
}

/// The messages with an IMU by topic: the name of the type and, in brackets, the number of the sensor.
#[derive(Default)]
struct Topics(BTreeMap<String, Topic>);

#[derive(Clone)]
struct Topic {
    id: u8,
    instance: Option<u8>,
    form: Form,
    messages: u64,
    span_ns: [i64; 2],
}

struct Chosen {
    topic: String,
    id: u8,
    instance: Option<u8>,
    time: (Field, TimeUnit),
    fields: Vec<Field>,
}

impl Topics {
    fn take(&mut self, id: u8, form: &Form, body: &[u8]) {
        let Some((field, unit)) = form.time().filter(|_| form.fields.iter().any(is_axis)) else { return };
        let Some(time) = field.number(body) else { return };
        let (instance, time_ns) = (form.instance(body), (time * 1e9 / unit.per_s()) as i64);
        let name = instance.map_or_else(|| form.name.clone(), |instance| format!("{}[{instance}]", form.name));
        let new = || Topic { id, instance, form: form.clone(), messages: 0, span_ns: [time_ns; 2] };
        let topic = self.0.entry(name).or_insert_with(new);
        topic.messages += 1;
        topic.span_ns[1] = time_ns;
    }

    fn choose(&self, path: &Path, asked: &ColumnQuery<'_>) -> Result<Chosen> {
        let wanted: Option<Vec<&str>> = match asked.wanted {
            ColumnSelection::One(Some(name)) => Some(vec![name]),
            ColumnSelection::Listed(names) | ColumnSelection::First(names) => {
                Some(names.iter().map(String::as_str).collect())
            }
            ColumnSelection::Described(columns) => Some(columns.iter().map(|column| column.name.as_str()).collect()),
            ColumnSelection::One(None) | ColumnSelection::All => None,
        };
        let of_name = |name: &&str| self.0.iter().find(|(topic, _)| name.starts_with(&format!("{topic}.")));
        let named = wanted.as_ref().and_then(|names| names.iter().find_map(of_name));
        let by_option = asked.args.topic.as_ref().and_then(|topic| self.0.get_key_value(topic));
        let only = self.0.iter().next().filter(|_| self.0.len() == 1 && asked.args.topic.is_none());
        let Some((name, topic)) = by_option.or(named).or(only) else {
            return Err(if self.0.is_empty() { without_imu(path) } else { several(path, asked, &self.survey()) });
        };
        let axes = || topic.form.fields.iter().filter(|field| is_axis(field));
        let fields = match &wanted {
            None if matches!(asked.wanted, ColumnSelection::One(_)) => {
                return Err(unknown(path, asked, None, name, topic));
            }
            None => axes().cloned().collect(),
            Some(names) => names
                .iter()
                .map(|wanted| {
                    let field =
                        wanted.strip_prefix(name.as_str()).and_then(|rest| rest.strip_prefix('.')).unwrap_or(wanted);
                    let found = topic.form.field(field).filter(|field| field.number(&[0; u8::MAX as usize]).is_some());
                    found.cloned().ok_or_else(|| unknown(path, asked, Some(wanted), name, topic))
                })
                .collect::<Result<Vec<Field>>>()?,
        };
        let time = topic.form.time().ok_or_else(|| without_imu(path))?;
        Ok(Chosen { topic: name.clone(), id: topic.id, instance: topic.instance, time, fields })
    }

    fn survey(&self) -> Survey {
        let mut survey = Survey::default();
        for (name, topic) in &self.0 {
            survey.counted(name, &topic.form.name, topic.messages, topic.span_ns);
        }
        survey
    }
}

fn unknown(path: &Path, asked: &ColumnQuery<'_>, wanted: Option<&str>, name: &str, topic: &Topic) -> LogError {
    let why = wanted.map_or_else(|| "has several columns".to_owned(), |wanted| format!("has no column `{wanted}`"));
    let all = topic.form.fields.iter().filter(|field| stated(&field.name).is_some());
    let all: Vec<String> = all.map(|field| format!("{name}.{}", field.name)).collect();
    let option = asked.args.names.of(Setting::Column);
    LogError::Ask(format!("{} {why}; choose with {option} one of: {}", path.display(), all.join(", ")))
}

fn without_imu(path: &Path) -> LogError {
    // TCLR messages are not read: they hold one mean per 0.5 °C, which shows neither noise nor lag
    let why = "it is a log of ArduPilot without messages IMU, GYR or ACC; set LOG_BITMASK so that it logs them";
    InputError::not_a_log(path, why.to_owned()).into()
}
