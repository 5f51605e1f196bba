//! Decodes `sensor_msgs/Imu`, the ROS message of gyroscopes, and `sensor_msgs/Temperature`, and collects their numbers
//! into columns.

use super::clock::Times;
use super::message::{Body, Encoding, is_imu, is_temperature};
use super::nested::{self, Place};
use super::series::SeriesBuilder;
use super::topics::{Survey, Topic, several};
use crate::choice::ColumnSelection;
use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::query::ColumnQuery;
use crate::raw_columns::{Clock, RawColumn, RawColumns};
use crate::sample::Sampled;
use crate::setting::{Names, Setting};
use crate::warning::LogWarning;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
#[cfg(not(feature = "zstd"))]
use zerorate_input::NotBuiltIn;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{InputError, InputWarning, Quantity, TimeUnit, Unit};

/// The quantities of an IMU message: the name in ROS, and the index among the numbers after the header. Orientation
/// and its covariance are 13 numbers, and a covariance of 9 numbers follows each vector.
const QUANTITIES: [(&str, usize); 6] = [
    ("angular_velocity.x", 13),
    ("angular_velocity.y", 14),
    ("angular_velocity.z", 15),
    ("linear_acceleration.x", 25),
    ("linear_acceleration.y", 26),
    ("linear_acceleration.z", 27),
];

/// The quantity of a temperature message, and its index among the numbers after the header. Its variance follows it.
const TEMPERATURE: [(&str, usize); 1] = [("temperature", 0)];

/// Number of numbers after the header of an IMU message, and of a temperature message.
const NUMBERS_OF_IMU: usize = 37;
const NUMBERS_OF_TEMPERATURE: usize = 2;

/// The first bytes of Zstandard data. A bag may compress each message.
const ZSTD: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// Limit on the size of an unpacked message in bytes. A frame name and 37 numbers (296 bytes) are far shorter.
#[cfg(feature = "zstd")]
const MAX_MESSAGE: usize = 1 << 16;

/// An IMU or a temperature sensor in a bag: its data are all messages of a topic, or a field in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    pub topic: String,
    /// The field with the IMU, if the messages are of another type.
    place: Option<Place>,
    is_temperature: bool,
}

impl Source {
    fn quantities(&self) -> &'static [(&'static str, usize)] {
        if self.is_temperature { &TEMPERATURE } else { &QUANTITIES }
    }

    fn kind(&self) -> &'static str {
        if self.is_temperature { "sensor_msgs/Temperature" } else { "sensor_msgs/Imu" }
    }

    /// The body of a message, with its start at the stamp of this IMU or temperature.
    fn body<'a>(&self, encoding: Encoding, message: &'a [u8]) -> Option<Body<'a>> {
        let body = Body::of(encoding, message)?;
        let start = self.place.as_ref().map_or(Some(0), |place| place.start(&body))?;
        body.at(start)
    }
}

/// The IMUs and temperature sensors of a bag by name: `/imu`, or `/bundle.imu` for a field of another message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sources(BTreeMap<String, Source>);

impl Sources {
    /// The IMUs or the temperature sensor of a topic. `kind` is the name of its type, and `definition` the text that
    /// defines the type.
    pub fn of(topic: &str, kind: &str, definition: &str) -> Self {
        let source = |place| Source { topic: topic.to_owned(), place, is_temperature: is_temperature(kind) };
        if is_imu(kind) || is_temperature(kind) {
            return Self([(topic.to_owned(), source(None))].into());
        }
        let of_fields = nested::places(kind, definition).into_iter();
        Self(of_fields.map(|place| (format!("{topic}.{}", place.path), source(Some(place)))).collect())
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    pub fn imus(&self) -> impl Iterator<Item = (&String, &Source)> {
        self.0.iter().filter(|(_, source)| !source.is_temperature)
    }

    pub fn has_imu(&self) -> bool {
        self.imus().next().is_some()
    }

    /// The temperature topic `wanted`, with or without `.temperature` behind it. Plain `temperature` means the only
    /// temperature topic of the bag, or the only one in the folder of the chosen IMU topic.
    fn temperature(&self, path: &Path, wanted: &str, asked: &ColumnQuery<'_>) -> Result<Option<Quantities>> {
        let [(quantity, _)] = TEMPERATURE;
        let all = || self.0.iter().filter(|(_, source)| source.is_temperature);
        let of_topic = |(name, _): &(&String, &Source)| {
            wanted.strip_prefix(name.as_str()).is_some_and(|rest| rest.is_empty() || rest == ".temperature")
        };
        let found = |(name, source): (&String, &Source)| {
            Some(Quantities { name: name.clone(), source: source.clone(), all: TEMPERATURE.to_vec() })
        };
        if wanted != quantity {
            return Ok(all().find(of_topic).and_then(found));
        }
        let beside = folder(asked.args.topic.as_deref().unwrap_or_default());
        let near = || all().filter(|(name, _)| !beside.is_empty() && name.starts_with(&format!("{beside}/")));
        match (all().count(), near().count()) {
            (1, _) => Ok(all().next().and_then(found)),
            (_, 1) => Ok(near().next().and_then(found)),
            (0, _) => Ok(None),
            _ => {
                let topics: Vec<String> = all().map(|(name, _)| name.clone()).collect();
                let table = topics.iter().map(|name| format!("  {}", name.escape_debug())).collect();
                let (path, option) = (path.display(), asked.args.names.of(Setting::TempColumn));
                let question = format!("{path} has several temperatures; choose one with {option}:");
                Err(LogError::Choose { question, table, topics })
            }
        }
    }
}

/// The name of a topic up to its last part: `/front` of `/front/imu`.
fn folder(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// The wanted quantities of one IMU or one temperature sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantities {
    name: String,
    pub source: Source,
    /// The quantities by name, each with its index among the numbers of a message.
    all: Vec<(&'static str, usize)>,
}

impl Quantities {
    /// Chooses the requested quantities. If the request leaves the topic open, the error lists the topics of `survey`.
    pub fn choose(
        path: &Path,
        topics: &Sources,
        asked: &ColumnQuery<'_>,
        survey: impl FnOnce() -> Survey,
    ) -> Result<Self> {
        let names: Vec<Option<&str>> = match asked.wanted {
            ColumnSelection::One(name) => vec![name],
            ColumnSelection::Listed(names) | ColumnSelection::First(names) => {
                names.iter().map(|name| Some(name.as_str())).collect()
            }
            ColumnSelection::Described(columns) => columns.iter().map(|column| Some(column.name.as_str())).collect(),
            ColumnSelection::All => QUANTITIES.iter().map(|(name, _)| Some(*name)).collect(),
        };
        if let [Some(only)] = names[..]
            && let Some(temperature) = topics.temperature(path, only, asked)?
        {
            return Ok(temperature);
        }
        let only = match &asked.args.topic {
            Some(topic) => topics.imus().find(|(name, _)| *name == topic),
            None => topics.imus().next().filter(|_| topics.imus().count() == 1),
        };
        let only = only.map(|(name, _)| name.as_str());
        let chosen = names.iter().map(|name| Self::choose_one(topics, only, *name).ok_or(*name));
        let chosen: Vec<Self> = match chosen.collect() {
            Ok(chosen) => chosen,
            Err(_) if only.is_none() => return Err(several(path, asked, &survey())),
            Err(wanted) => return Err(unknown(path, only.unwrap_or_default(), wanted, asked.args.names)),
        };
        let Some(Self { name, source, .. }) = chosen.first().cloned() else {
            return Err(several(path, asked, &survey()));
        };
        if let Some(other) = chosen.iter().find(|one| one.name != name) {
            let why =
                format!("the columns are of two topics, `{name}` and `{}`, which keep different time", other.name);
            return Err(LogError::Ask(format!("{}: {why}; read one at a time", path.display())));
        }
        Ok(Self { name, source, all: chosen.into_iter().flat_map(|one| one.all).collect() })
    }

    /// Finds a quantity of an IMU, with or without the topic in its name. The names x, y and z mean angular_velocity.
    fn choose_one(topics: &Sources, only: Option<&str>, wanted: Option<&str>) -> Option<Self> {
        let wanted = wanted?;
        let of_topic = topics
            .imus()
            .find_map(|(topic, _)| Some((topic.as_str(), wanted.strip_prefix(topic.as_str())?.strip_prefix('.')?)));
        let (name, quantity) = of_topic.or_else(|| Some((only?, wanted)))?;
        let long = if quantity.len() == 1 { format!("angular_velocity.{quantity}") } else { quantity.to_owned() };
        let source = topics.0.get(name)?.clone();
        let chosen = *source.quantities().iter().find(|(name, _)| *name == long)?;
        Some(Self { name: name.to_owned(), source, all: vec![chosen] })
    }
}

/// `others` maps the topics of the bag to their types.
pub fn without_imu(path: &Path, others: &BTreeMap<String, String>) -> LogError {
    /// Largest number of topics that are named: a bag may have thousands.
    const NAMED: usize = 20;
    let named = others.iter().take(NAMED).map(|(topic, kind)| format!("{topic} ({kind})").escape_debug().to_string());
    let mut named: Vec<String> = named.collect();
    if others.len() > NAMED {
        named.push(format!("and {} more", others.len() - NAMED));
    }
    let has = match named.is_empty() {
        true => "it has no messages".to_owned(),
        false => format!("it has {}", named.join(", ")),
    };
    InputError::not_a_log(path, format!("it is a bag without a topic of type sensor_msgs/msg/Imu; {has}")).into()
}

/// The error for a quantity that an IMU message does not have, or for a request without a quantity.
fn unknown(path: &Path, topic: &str, wanted: Option<&str>, names: Names) -> LogError {
    if wanted == Some(crate::choice::TEMPERATURE_COLUMN) {
        return LogError::Ask(format!(
            "{}: a message of sensor_msgs/Imu holds no temperature, and a part is calibrated over its temperature; \
             join the temperature of another topic to it in a table, such as CSV or Parquet",
            path.display()
        ));
    }
    let why = match wanted {
        Some(wanted) => format!("has no column `{wanted}`"),
        None => "has several columns".to_owned(),
    };
    let all = QUANTITIES.map(|(name, _)| format!("{topic}.{name}"));
    let option = names.of(Setting::Column);
    LogError::Ask(format!("{} {why}; choose with {option} one of: {}", path.display(), all.join(", ")))
}

impl Survey {
    /// Adds a topic, even if it has no messages.
    pub fn topic(&mut self, name: &str, kind: &str) {
        self.0.entry(name.to_owned()).or_insert_with(|| Topic { kind: kind.to_owned(), ..Topic::default() });
    }

    /// Counts a message with an IMU, even if it cannot be decoded.
    pub fn message(
        &mut self,
        (name, source): (&str, &Source),
        kind: &str,
        encoding: Option<Encoding>,
        message: &[u8],
    ) {
        let head = encoding.and_then(|encoding| head(encoding, source, message));
        self.topic(name, kind);
        let Some(topic) = self.0.get_mut(name) else { return };
        topic.messages += 1;
        let Some((stamp_ns, frame)) = head else { return };
        let (first, last) = topic.span_ns.unwrap_or((stamp_ns, stamp_ns));
        topic.span_ns = Some((first.min(stamp_ns), last.max(stamp_ns)));
        topic.frame.get_or_insert(frame);
    }
}

pub struct Collector<'a> {
    path: &'a Path,
    wanted: Quantities,
    values: Vec<SeriesBuilder>,
    messages: u64,
    times: Times,
    /// The times at which the bag recorded the messages.
    recorded: Times,
    /// True if a rate was given. The stamps of the messages are then only compared with the rate.
    has_rate: bool,
}

impl<'a> Collector<'a> {
    pub fn new(path: &'a Path, wanted: Quantities, room: MemoryBudget, args: &ColumnOptions) -> Self {
        let values = wanted.all.iter().map(|_| SeriesBuilder::sharing(room, wanted.all.len())).collect();
        let has_rate = args.rate.is_some();
        Self { path, wanted, values, messages: 0, times: Times::new(), recorded: Times::new(), has_rate }
    }

    /// Adds a message, which the bag recorded at `recorded_ns`, ns since 1970.
    pub fn push(&mut self, encoding: Encoding, message: &[u8], recorded_ns: i64) -> Result<(), InputError> {
        let number = self.messages;
        let at = |what: String| {
            InputError::damaged(self.path, format!("topic {}, message {number}", self.wanted.name), what)
        };
        let room = self.values.first().map_or(Ok(()), |first| first.check_room(1));
        room.map_err(|why| InputError::over_budget(self.path, why))?;
        let message = unpacked(message).map_err(at)?;
        let source = &self.wanted.source;
        let (stamp_ns, numbers) = decode(encoding, source, &message)
            .ok_or_else(|| at(format!("its {} bytes are not a {} in {encoding:?}", message.len(), source.kind())))?;
        self.times.push_integer(stamp_ns);
        self.recorded.push_integer(recorded_ns);
        for ((quantity, position), values) in self.wanted.all.iter().zip(&mut self.values) {
            if !values.push_number(numbers[*position]) {
                return Err(at(format!("{quantity} is infinite, which cannot be averaged")));
            }
        }
        self.messages += 1;
        Ok(())
    }

    /// The columns, after all messages were read. `of_end` is the warning about the end of the file. `stated` is the
    /// number of messages that the file states.
    pub fn finish(self, of_end: Option<InputWarning>, stated: Option<u64>) -> RawColumns {
        let Self { path, wanted, values, mut times, recorded, messages, has_rate } = self;
        let miscounted = match (&of_end, stated) {
            (None, Some(stated)) if stated != messages => {
                Some(LogWarning::miscounted(path, &wanted.name, stated, messages))
            }
            _ => None,
        };
        let stamps = format!("{}.header.stamp", wanted.name);
        let are_zero = messages > 1 && times.first() == 0.0 && times.since_first().iter().all(|since| *since == 0.0);
        let unstamped = are_zero.then(|| {
            times = recorded;
            let how = "all stamps are 0; the times at which the bag recorded the messages are used".to_owned();
            LogWarning::TimesRepaired { path: path.display().to_string(), column: stamps.clone(), how }
        });
        times.unit = Some(TimeUnit::Ns);
        let (clock, sample) = match has_rate {
            true => (Clock::Silent, vec![Sampled::of_times(&stamps, &times)]),
            false => (Clock::Column(stamps, times), Vec::new()),
        };
        let column = |((quantity, _), values): ((&str, usize), SeriesBuilder)| RawColumn {
            // the units are those of REP-103 of ROS
            stated: Some(match quantity.split('_').next() {
                Some("angular") => (Quantity::AngularRate, Unit::RadPerS.in_results()),
                Some("linear") => (Quantity::Acceleration, Unit::MPerS2.in_results()),
                _ => (Quantity::Temperature, 1.0),
            }),
            ..RawColumn::new(format!("{}.{quantity}", wanted.name), values)
        };
        let columns = wanted.all.into_iter().zip(values).map(column).collect();
        let warnings = of_end.map(LogWarning::File).into_iter().chain(miscounted).chain(unstamped).collect();
        RawColumns { columns, clock, warnings, sample, stated_rate: None }
    }
}

fn unpacked(message: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    if !message.starts_with(&ZSTD) {
        return Ok(Cow::Borrowed(message));
    }
    #[cfg(feature = "zstd")]
    let unpacked = zstd::bulk::decompress(message, MAX_MESSAGE).map_err(|error| error.to_string());
    #[cfg(not(feature = "zstd"))]
    let unpacked: Result<Vec<u8>, String> = Err(NotBuiltIn::ZSTD.to_string());
    unpacked.map(Cow::Owned)
}

/// The stamp of a message, ns, and the frame name in its header; `None` if the message does not hold this IMU.
fn head(encoding: Encoding, source: &Source, message: &[u8]) -> Option<(i64, String)> {
    let message = unpacked(message).ok()?;
    let body = source.body(encoding, &message)?;
    let (frame, _) = body.frame()?;
    // a CDR string includes its final zero byte
    let frame = String::from_utf8_lossy(frame.strip_suffix(&[0]).unwrap_or(frame)).into_owned();
    Some((body.stamp_ns()?, frame))
}

/// The stamp of a message, ns, and the numbers after its header, in `std_msgs/Header header; Quaternion orientation;
/// float64[9]; Vector3 angular_velocity; float64[9]; Vector3 linear_acceleration; float64[9]`, or `std_msgs/Header
/// header; float64 temperature; float64 variance`.
fn decode(encoding: Encoding, source: &Source, message: &[u8]) -> Option<(i64, [f64; NUMBERS_OF_IMU])> {
    let body = source.body(encoding, message)?;
    let (_, start) = body.frame()?;
    let mut numbers = [0.0; NUMBERS_OF_IMU];
    let count = if source.is_temperature { NUMBERS_OF_TEMPERATURE } else { NUMBERS_OF_IMU };
    for (number, at) in numbers[..count].iter_mut().zip((start..).step_by(8)) {
        *number = body.f64_at(at)?;
    }
    Some((body.stamp_ns()?, numbers))
}
