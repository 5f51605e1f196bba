//! Opens a log, recognises it by its content, and unpacks it.

use std::io::{self, BufReader, Read};
use std::path::Path;
use zerorate_input::catch_panic::catch_panic;
use zerorate_input::limits::{MemoryBudget, OverBudget};
use zerorate_input::{Input, InputError, NotBuiltIn};

/// Number of bytes at the start of a file that are read to recognise its format.
const MARK: u64 = 16;

/// Size of the buffer in front of a file, bytes.
pub const BUFFER: usize = 1 << 18;

pub struct Log<'a> {
    pub path: &'a Path,
    /// The content of the log, from the start.
    pub input: Input,
    pub room: MemoryBudget,
    pub start: Vec<u8>,
}

pub fn open(path: &Path, mut input: Input) -> Result<Log<'_>, InputError> {
    let failed = |error| InputError::io("read", path, error);
    if input.is_directory().map_err(failed)? {
        return Err(InputError::not_a_log(path, "it is a directory and no bag of ROS 2; name the file"));
    }
    let room = MemoryBudget::of(input.stored().map_err(failed)?);
    let start = input.start(MARK).map_err(failed)?;
    let Some(packing) = Packing::of(&start) else {
        return Ok(Log { path, input, room, start });
    };
    if let Some(missing) = packing.missing() {
        return Err(InputError::not_built_in(path, missing));
    }
    let unpacked = packing.unpack(&input, room).map_err(|why| why.in_file(path, &format!("as {packing:?}")));
    let mut input = unpacked?;
    let start = input.start(MARK).map_err(failed)?;
    match Packing::of(&start) {
        Some(_) => Err(InputError::not_a_log(path, "it is packed twice; unpack it once")),
        None => Ok(Log { path, input, room, start }),
    }
}

/// Reads the first bytes of an input, without unpacking it.
pub fn looked_at(path: &Path, mut input: Input) -> Result<Log<'_>, InputError> {
    let start = input.start(MARK).map_err(|error| InputError::io("read", path, error))?;
    Ok(Log { path, input, room: MemoryBudget::of(0), start })
}

/// The compression of a file in words, by its first bytes; `None` if the file is not compressed.
pub fn packing(start: &[u8]) -> Option<String> {
    Packing::of(start).map(|packing| format!("packed by {packing:?}"))
}

impl Log<'_> {
    /// Refuses a file that is empty, or of a common format that is not supported.
    pub fn check(&self) -> Result<(), InputError> {
        let foreign = FOREIGN.iter().find(|(marks, _)| marks.iter().any(|mark| self.start.starts_with(mark)));
        match foreign {
            Some((_, JSON)) if has_object_in_line(&self.start) => Ok(()),
            Some((_, advice)) => Err(InputError::not_a_log(self.path, *advice)),
            None if self.start.is_empty() => Err(InputError::not_a_log(self.path, "it is empty")),
            None => Ok(()),
        }
    }
}

/// True if the first object of a JSON file is alone in its line, and ends in it, as far as `start` shows.
fn has_object_in_line(start: &[u8]) -> bool {
    let Some(first) = start.iter().position(|byte| *byte == b'{') else { return false };
    let line = start[first..].split(|byte| *byte == b'\n').next().unwrap_or_default();
    let is_alone = start[..first].iter().all(|byte| b"[\r\n ".contains(byte)) && !start.starts_with(b"[{");
    let is_whole = line.trim_ascii_end().ends_with(b"}") || line.trim_ascii_end().ends_with(b"},");
    is_alone && line.get(1) != Some(&b'\r') && (is_whole || first + line.len() == start.len())
}

/// The start of every message of ArduPilot's logs.
pub const ARDUPILOT: [u8; 2] = [0xA3, 0x95];

/// The start of a MATLAB file of version 5 to 7.2.
pub const MATLAB: &[u8] = b"MATLAB 5.0 MAT";

pub const ULOG: &[u8] = b"ULog\x01\x12\x35";

pub const ROS_BAG: &[u8] = b"#ROSBAG V2.0\n";

/// The starts of common files that are not supported, and what to do with them. JSON is supported if each line is an
/// object.
const FOREIGN: &[(&[&[u8]], &str)] = &[
    (&[b"#ROSBAG V1"], "it is a bag of ROS 1 in its old version 1; convert it with `rosbag fix FILE NEW.bag`"),
    (&[b"7z\xBC\xAF\x27\x1C"], "it is a 7z archive; unpack it and name a file in it"),
    (&[b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"], "it is a workbook of Excel; save the sheet as CSV"),
    (&[b"FMT, 128, "], DATAFLASH),
    (&[b"# A zerorate "], "it is a calibration; `zerorate report` shows it"),
    (&[b"{\"", b"{\n", b"{\r", b"[{", b"[\n{", b"[\n  {"], JSON),
    (&[b"header: \n  seq", b"header:\n  seq"], ECHO),
    (&[b"header:\n  stamp"], ECHO_2),
    (&[b"%RAWIMUSA,", b"%RAWIMUSXA,", b"#RAWIMUA,", b"#RAWIMUXA,"], NOVATEL),
    (&[b"%CORRIMUSA,", b"%CORRIMUDATASA,", b"#CORRIMUDATAA,"], NOVATEL_CORRECTED),
    (&[b"%INSPVASA,", b"#INSPVAA,", b"#INSPVAXA,"], NOVATEL_POSITIONS),
    (&[b"\xB5\x62"], "it is a log of u-blox (UBX); in Python pyubx2 reads it, and writes a table"),
    (&[b"TDSm"], "it is a TDMS file; in Python `nptdms.TdmsFile('FILE').as_dataframe().to_csv('log.csv')`"),
    (&[b"RDX2\n", b"RDX3\n"], RDA),
    (&[b"H Product:Black"], "it is a log of Betaflight; `blackbox_decode FILE` writes a table"),
    (&[b"\xFA\xFF"], "it holds messages of Xsens (MTB); export it as text in MT Manager"),
    (&[b"\x89PNG", b"\xFF\xD8\xFF", b"GIF8"], "it is a picture; take the numbers from the program that drew it"),
    (&[b"%PDF"], "it is a PDF; take the numbers from the program that made it"),
    (&[b"\x7FELF"], "it is a program"),
    (&[b"\x80\x04\x95", b"\x80\x05\x95"], PICKLE),
];

const DATAFLASH: &str = "it is a log of ArduPilot as text; name the .bin file, or convert it with pymavlink: \
                         `mavlogdump.py --format csv --types IMU FILE > imu.csv`, in which column `I` is the sensor";

const ECHO: &str = "it is the output of `rostopic echo`; record a bag, or write a table with `rostopic echo -p TOPIC \
                    > log.csv`";

const ECHO_2: &str = "it is the output of `ros2 topic echo`; record a bag, or write a table with `ros2 topic echo \
                      --csv TOPIC > log.csv`";

const NOVATEL: &str = "it holds messages of NovAtel, whose increments are counts of its IMU; convert it to columns of \
                       rates with the scales in the manual of the IMU";

const NOVATEL_CORRECTED: &str = "it holds messages of NovAtel, with the increment of each sample in rad and m/s; \
                                 convert it to columns of rates: each increment times the rate of the messages";

const NOVATEL_POSITIONS: &str = "it holds messages of NovAtel with positions and attitudes, and without rates; record \
                                 RAWIMUSX as well";

pub const JSON: &str = "it is JSON; convert it to a table: in Python `pandas.read_json('FILE').to_csv('log.csv')`, \
                        with `lines=True` if each line is an object";

const RDA: &str = "it is a workspace of R; save a table there: `write.csv(DATA, 'log.csv', row.names = FALSE)`";

const PICKLE: &str = "it is a pickle of Python, which runs what is in it; save a table there: `to_csv`, `numpy.save`";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    Bzip2,
    Gzip,
    Lz4,
    Xz,
    Zstd,
}

impl Packing {
    fn of(start: &[u8]) -> Option<Self> {
        match start {
            [0x1F, 0x8B, 8, flags, ..] if *flags < 0x20 => Some(Self::Gzip),
            [b'B', b'Z', b'h', b'1'..=b'9', ..] => Some(Self::Bzip2),
            [0x04, 0x22, 0x4D, 0x18, ..] => Some(Self::Lz4),
            [0xFD, b'7', b'z', b'X', b'Z', 0, ..] => Some(Self::Xz),
            [0x28, 0xB5, 0x2F, 0xFD, ..] => Some(Self::Zstd),
            _ => None,
        }
    }

    const fn missing(self) -> Option<NotBuiltIn> {
        match self {
            Self::Zstd if cfg!(feature = "zstd") => None,
            Self::Zstd => Some(NotBuiltIn::ZSTD),
            _ if cfg!(feature = "packed") => None,
            Self::Bzip2 => Some(NotBuiltIn { what: "bzip2", feature: "packed" }),
            Self::Gzip => Some(NotBuiltIn { what: "gzip", feature: "packed" }),
            Self::Lz4 => Some(NotBuiltIn { what: "LZ4", feature: "packed" }),
            Self::Xz => Some(NotBuiltIn { what: "xz", feature: "packed" }),
        }
    }

    /// Unpacks the whole file, because the readers of some formats seek in it.
    fn unpack(self, packed: &Input, room: MemoryBudget) -> Result<Input, Unpacking> {
        let most = if packed.is_file() { room.bytes_on_disk() } else { room.bytes() };
        packed.unpacked(|unpacked| {
            let copied = catch_panic(|| {
                let content = self.content(BufReader::with_capacity(BUFFER, packed.try_clone()?))?;
                io::copy(&mut content.take(most.saturating_add(1)), unpacked)
            });
            let bytes = copied.unwrap_or_else(|| Err(io::Error::other("its content makes no sense")))?;
            if packed.is_file() { room.check_on_disk(bytes) } else { room.check(bytes) }.map_err(Unpacking::OverBudget)
        })
    }

    fn content(self, packed: BufReader<Input>) -> io::Result<Box<dyn Read>> {
        match self {
            #[cfg(feature = "packed")]
            Self::Bzip2 => Ok(Box::new(bzip2::read::MultiBzDecoder::new(packed))),
            #[cfg(feature = "packed")]
            Self::Gzip => Ok(Box::new(flate2::read::MultiGzDecoder::new(packed))),
            #[cfg(feature = "packed")]
            Self::Lz4 => Ok(Box::new(Lz4Frames(lz4_flex::frame::FrameDecoder::new(packed)))),
            #[cfg(feature = "packed")]
            Self::Xz => Ok(Box::new(lzma_rust2::XzReader::new_mem_limit(packed, true, MAX_WINDOW_KB))),
            // zstd's decoder has the same limit
            #[cfg(feature = "zstd")]
            Self::Zstd => Ok(Box::new(zstd::Decoder::with_buffer(packed)?)),
            #[cfg(not(all(feature = "packed", feature = "zstd")))]
            _ => Err(io::Error::new(io::ErrorKind::Unsupported, format!("no reader of it in {packed:?}"))),
        }
    }
}

/// Decodes all frames of a file. The library's decoder stops behind each frame.
#[cfg(feature = "packed")]
struct Lz4Frames(lz4_flex::frame::FrameDecoder<BufReader<Input>>);

#[cfg(feature = "packed")]
impl Read for Lz4Frames {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        loop {
            let count = self.0.read(bytes)?;
            let packed: &mut dyn io::BufRead = self.0.get_mut();
            if count > 0 || bytes.is_empty() || packed.fill_buf()?.is_empty() {
                return Ok(count);
            }
        }
    }
}

/// The reason why a file could not be unpacked.
pub enum Unpacking {
    OverBudget(OverBudget),
    /// The file is damaged, or cannot be read.
    Failed(io::Error),
}

impl Unpacking {
    pub fn in_file(self, path: &Path, place: &str) -> InputError {
        match self {
            Self::OverBudget(why) => InputError::over_budget(path, why),
            Self::Failed(error) => {
                InputError::damaged(path, place, format!("it cannot be unpacked ({error}); was it cut short?"))
            }
        }
    }
}

impl From<io::Error> for Unpacking {
    fn from(error: io::Error) -> Self {
        Self::Failed(error)
    }
}

/// Largest window of a compressor, KiB: twice the window of `xz -9`, and the default limit of the `zstd` decoder.
#[cfg(feature = "packed")]
const MAX_WINDOW_KB: u32 = 128 << 10;
