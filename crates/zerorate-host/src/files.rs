//! Opens captures and logs, and reads small text files.

use crate::RowReader;
use std::fs::File;
use std::io::{ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate_input::limits::Bytes;
use zerorate_input::{Input, InputError};
use zerorate_logs::{ColumnOptions, LogError, Parts};
use zerorate_record::{CaptureError, CaptureReader};

/// Opens a regular file; a folder fails when it is opened or read. Pipes, sockets and devices are refused before
/// opening, because opening them may block forever, and because they have no length and maybe no end.
pub fn open(path: &Path) -> Result<Input, InputError> {
    open_advising(path, "")
}

/// Opens a file like [`open`]. `or` follows the advice to copy a pipe into a file.
fn open_advising(path: &Path, or: &str) -> Result<Input, InputError> {
    let failed = |error| InputError::io("read", path, error);
    let metadata = path.metadata().map_err(|error| failed(not_a_path(path, error)))?;
    if !metadata.is_file() && !metadata.is_dir() {
        let how = format!("it is a pipe or a device: copy it into a file{or}");
        return Err(failed(std::io::Error::other(how)));
    }
    let file = File::open(path).map_err(failed)?;
    let holes = if metadata.is_file() { holes(&file).map_err(failed)? } else { 0 };
    Ok(Input::from(file).with_holes(holes))
}

/// Largest number of data areas of a file between which holes are searched. The rest of the file counts as one hole.
#[cfg(any(target_os = "linux", target_os = "macos"))]
const STRETCHES: usize = 1 << 16;

/// Number of bytes in the holes of a file. Holes read as zeros and take no space on the disk.
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn holes(mut file: &File) -> std::io::Result<u64> {
    use rustix::fs::{SeekFrom, seek};
    let length = file.metadata()?.len();
    let (mut at, mut stored) = (0, 0);
    for _ in 0..STRETCHES {
        let start = match seek(file, SeekFrom::Data(at)) {
            Ok(start) => start,
            // no data after `at`
            Err(rustix::io::Errno::NXIO) => break,
            // a file system without support for holes
            Err(_) => return file.rewind().map(|()| 0),
        };
        at = seek(file, SeekFrom::Hole(start))?;
        stored += at.saturating_sub(start);
    }
    file.rewind()?;
    Ok(length.saturating_sub(stored))
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn holes(_: &File) -> std::io::Result<u64> {
    Ok(0)
}

/// Reads a small text file completely. A device, a pipe or a sparse file may be endless, so at most `most` bytes are
/// read, and one more to detect a larger file.
///
/// # Errors
/// Returns [`ErrorKind::FileTooLarge`] for a larger file, [`ErrorKind::InvalidData`] if it is not UTF-8, or the error
/// of the file system.
pub fn text(path: &Path, most: Bytes) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most.0.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most.0 {
        let why = format!("it has more than {most}, and is not read as text");
        return Err(std::io::Error::new(ErrorKind::FileTooLarge, why));
    }
    let not_text = |_| std::io::Error::new(ErrorKind::InvalidData, "it is not text in UTF-8");
    let text = String::from_utf8(bytes).map_err(not_text)?;
    // editors for Windows write a byte order mark
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// The path that means standard input.
pub const STDIN: &str = "-";

/// Opens a log: a file, standard input (`-`), or a folder with a ROS 2 bag or a split ROS 1 bag. Returns each file
/// with its path, and the numbers of messages that the description of a ROS 2 bag states.
pub fn log(path: &Path) -> Result<Parts, InputError> {
    let failed = |error| InputError::io("read", path, error);
    if path == Path::new(STDIN) {
        return Ok(vec![(path.to_owned(), spooled(std::io::stdin().lock()).map_err(failed)?)].into());
    }
    if !path.is_dir() {
        let file = open_advising(path, ", or pipe it into this command, with `-` in its place")?;
        return Ok(vec![(path.to_owned(), file)].into());
    }
    let description = description(path)?;
    let files = parts(path, &description)?.into_iter().map(|part| Ok((part.clone(), open(&part)?)));
    Ok(Parts { files: files.collect::<Result<_, InputError>>()?, messages: stated(&description) })
}

/// The files behind the path of a log: the log itself, or the entries of a folder.
#[must_use]
pub fn listed(path: &Path) -> Vec<PathBuf> {
    match path.read_dir() {
        Ok(entries) => entries.filter_map(|entry| Some(entry.ok()?.path())).collect(),
        Err(_) => vec![path.to_owned()],
    }
}

/// Length of a log on disk, without holes, bytes. It is `u64::MAX` for standard input, and 0 for a log that cannot be
/// opened.
pub fn log_length(path: &Path) -> u64 {
    let length = |path: &Path| open(path).ok().and_then(|input| input.stored().ok()).unwrap_or(0);
    match path {
        _ if path == Path::new(STDIN) => u64::MAX,
        _ if path.is_dir() => {
            let parts = description(path).and_then(|description| parts(path, &description));
            parts.iter().flatten().map(|part| length(part)).fold(0, u64::saturating_add)
        }
        _ => length(path),
    }
}

/// Replaces the error of a path that does not exist by advice, if the path is a URL or means standard input.
fn not_a_path(path: &Path, error: std::io::Error) -> std::io::Error {
    match path.to_str() {
        Some(STDIN) => std::io::Error::other("this command does not read stdin; give it a file"),
        Some(text) if text.contains("://") => {
            std::io::Error::other("addresses are not fetched; download the file first")
        }
        _ => error,
    }
}

/// Copies a pipe to a temporary file, because several formats are not read sequentially.
fn spooled(mut piped: impl Read) -> std::io::Result<Input> {
    let mut file = tempfile::tempfile()?;
    std::io::copy(&mut piped, &mut file)?;
    file.rewind()?;
    Ok(Input::nameless(file))
}

/// The name of the description file in the folder of a ROS 2 bag.
const METADATA: &str = "metadata.yaml";

/// Largest number of bytes of the description that are read.
const MAX_METADATA: u64 = 1 << 20;

/// The description of a ROS 2 bag; empty if it cannot be opened.
fn description(folder: &Path) -> Result<String, InputError> {
    let mut text = String::new();
    if let Ok(file) = open(&folder.join(METADATA)) {
        let read = file.take(MAX_METADATA).read_to_string(&mut text);
        read.map_err(|error| InputError::io("read", folder, error))?;
    }
    Ok(text)
}

/// The files of a ROS 2 bag in the order of its description. If it names none, the only bag, or a split ROS 1 bag.
fn parts(folder: &Path, description: &str) -> Result<Vec<PathBuf>, InputError> {
    let failed = |error| InputError::io("read", folder, error);
    let listed: Vec<PathBuf> = described(description).map(|name| folder.join(name)).collect();
    if !listed.is_empty() {
        return Ok(listed);
    }
    let all = folder.read_dir().map_err(failed)?.map(|entry| Ok(entry?.path()));
    let all: Vec<PathBuf> = all.collect::<std::io::Result<_>>().map_err(failed)?;
    let is_bag = |path: &PathBuf| path.extension().is_some_and(|end| end == "mcap" || end == "db3" || end == "bag");
    let bags: Vec<PathBuf> = all.into_iter().filter(is_bag).collect();
    if let Some(split) = split_bags(&bags) {
        return Ok(split);
    }
    let why = match bags.len() {
        1 => return Ok(bags),
        0 => "it is a directory and no bag of ROS 2 (it has neither a metadata.yaml nor a bag); name the file",
        _ => "it is a directory with several bags and without a metadata.yaml that orders them; name one of them",
    };
    Err(InputError::not_a_log(folder, why))
}

/// Sorts split bags by their numbers, if these are consecutive and the rest of the names differs in digits only.
/// `rosbag record --split` writes NAME_0.bag, NAME_1.bag …, with a date in NAME. `None` for other names or one bag.
fn split_bags(bags: &[PathBuf]) -> Option<Vec<PathBuf>> {
    let numbered = |path: &PathBuf| {
        path.extension().filter(|ending| *ending == "bag")?;
        let (start, number) = path.file_stem()?.to_str()?.rsplit_once('_')?;
        let letters: String = start.chars().filter(|c| !c.is_ascii_digit()).collect();
        Some((number.parse::<usize>().ok()?, letters, path.clone()))
    };
    let mut all: Vec<(usize, String, PathBuf)> = bags.iter().map(numbered).collect::<Option<_>>()?;
    all.sort();
    let is_next = |pair: &[(usize, String, PathBuf)]| pair[1].0 == pair[0].0 + 1 && pair[1].1 == pair[0].1;
    (all.len() > 1 && all.windows(2).all(is_next)).then(|| all.into_iter().map(|(.., path)| path).collect())
}

/// The file names in the description of a bag: the list `relative_file_paths`. Folders in the paths are dropped,
/// since all files are in the folder of the bag.
fn described(metadata: &str) -> impl Iterator<Item = &str> {
    let lines = metadata.lines().map(str::trim).skip_while(|line| *line != "relative_file_paths:").skip(1);
    let names = lines.map_while(|line| line.strip_prefix("- "));
    let bare = names.map(|name| name.trim().trim_matches(['"', '\'']));
    bare.filter_map(|name| Path::new(name).file_name()?.to_str())
}

/// The number of messages of each topic, by the description of a bag: the list `topics_with_message_count`. Topic
/// name and count may come in either order.
fn stated(metadata: &str) -> Vec<(String, u64)> {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let mut lines = metadata.lines().skip_while(|line| line.trim() != "topics_with_message_count:").skip(1).peekable();
    let of_list = lines.peek().map_or(0, |first| indent(first));
    let is_item = |line: &str| indent(line) == of_list && line.trim_start().starts_with("- ");
    let mut found = Vec::new();
    let (mut topic, mut count) = (None, None);
    for line in lines.take_while(|line| indent(line) > of_list || is_item(line)) {
        if is_item(line) {
            (topic, count) = (None, None);
        }
        let line = line.trim().trim_start_matches("- ");
        if let Some(name) = line.strip_prefix("name: ") {
            topic = Some(name.trim_matches(['"', '\'']).to_owned());
        } else if let Some(Ok(stated)) = line.strip_prefix("message_count: ").map(str::parse) {
            count = Some(stated);
        }
        if let (Some(_), Some(stated)) = (&topic, count) {
            found.extend(topic.take().map(|topic| (topic, stated)));
        }
    }
    found
}

/// Opens a capture in any supported format.
///
/// # Errors
/// Returns an error if the file cannot be opened, or if its description is not valid.
pub fn capture(path: &Path) -> Result<CaptureReader, CaptureError> {
    CaptureReader::open(path, open(path)?)
}

/// Opens a capture, or a log of the given part (docs/formats/part.md).
///
/// # Errors
/// Returns an error if the file cannot be opened, or if its content is not valid.
pub fn rows(path: &Path, part: Option<&Part>) -> Result<RowReader, LogError> {
    RowReader::open(path, open(path)?, part, &ColumnOptions::default())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::io::{SeekFrom, Write};

    #[test]
    fn bags_of_consecutive_numbers_are_one_log() {
        let split = |names: &[&str]| split_bags(&names.iter().map(PathBuf::from).collect::<Vec<_>>());
        let names = ["r_2026-03-01-12-10-00_10.bag", "r_2026-03-01-12-05-00_9.bag"];
        assert_eq!(split(&names).unwrap(), [names[1], names[0]].map(PathBuf::from));
        let others = [&["a_0.bag", "b_1.bag"][..], &["a_0.bag", "a_2.bag"], &["a.bag", "b.bag"], &["a_0.bag"]];
        assert!(others.into_iter().all(|names| split(names).is_none()));
    }

    #[test]
    fn what_is_not_a_recording_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let contents: [(&str, &[u8]); 4] = [
            ("a.png", b"\x89PNG\r\n"),
            ("unit.toml", b"# A zerorate calibration"),
            ("log.csv", b"t,x\n"),
            ("empty", b""),
        ];
        for (name, content) in contents {
            std::fs::write(path(name), content).expect("room");
        }
        let no_part = "name its part";
        for (path, says, advises) in [
            (path("a.png"), "it is a picture", false),
            (path("unit.toml"), "it is a calibration", false),
            (path("empty"), "it is empty", false),
            (path("log.csv"), "is not a capture of zerorate", true),
            (folder.path().to_owned(), "it is a directory", false),
            (STDIN.into(), "does not read stdin", false),
            ("/dev/null".into(), "copy it into a file", false),
        ] {
            let error = anyhow::Error::from(rows(&path, None).map(drop).expect_err("no rows"));
            let text = format!("{error:#}");
            assert!(text.contains(says) && text.contains(no_part) == advises, "{text}");
        }
        let error = anyhow::Error::from(log(Path::new("/dev/null")).map(drop).expect_err("no log"));
        assert!(format!("{error:#}").ends_with("with `-` in its place"), "{error:#}");
    }

    #[test]
    fn holes_do_not_count_as_bytes_of_a_log() {
        let mut file = tempfile::NamedTempFile::new().expect("a file");
        let middle = 1 << 30;
        file.as_file().set_len(4 << 30).expect("a hole");
        for at in [0, middle] {
            file.seek(SeekFrom::Start(at)).expect("a place");
            file.write_all(b"zerorate").expect("room");
        }
        let length = log_length(file.path());
        assert!((16..1 << 20).contains(&length), "{length}");
        let mut input = open(file.path()).expect("a file");
        assert_eq!((input.length().expect("a length"), input.stored().expect("a length")), (4 << 30, length));
        let mut start = [0; 8];
        input.read_exact(&mut start).expect("bytes");
        assert_eq!(&start, b"zerorate", "it is read from its start");
        file.as_file().set_len(0).expect("no hole");
        assert_eq!(log_length(file.path()), 0);
    }
}
