//! Sources of bytes for readers. The caller opens them.

use bytes::Bytes;
use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Cursor, ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;

/// Block size of a search, bytes.
const BLOCK: u64 = 1 << 16;

/// A source of bytes and its read position: an open file, memory, or [`RemoteBytes`].
#[derive(Debug)]
pub struct Input {
    kind: Kind,
    /// Number of bytes in holes of a sparse file, which take no space on disk.
    holes: u64,
}

/// Bytes that are neither in a local file nor in memory, such as a file in a browser.
pub trait RemoteBytes: Debug + Send + Sync {
    /// The number of bytes.
    fn length(&self) -> u64;

    /// Fills the start of `into` with the bytes at offset `at` and behind it. Returns the number of bytes read, which
    /// may be less than `into` holds; 0 means the end.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read.
    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize>;
}

#[derive(Debug)]
enum Kind {
    File(File),
    /// A file without a name, such as a spooled pipe. It cannot be opened again.
    Nameless(File),
    Memory(Cursor<Bytes>),
    Remote {
        bytes: Arc<dyn RemoteBytes>,
        at: u64,
    },
}

impl From<File> for Input {
    fn from(file: File) -> Self {
        Self::of(Kind::File(file))
    }
}

impl From<Vec<u8>> for Input {
    fn from(bytes: Vec<u8>) -> Self {
        Self::of(Kind::Memory(Cursor::new(bytes.into())))
    }
}

impl Input {
    const fn of(kind: Kind) -> Self {
        Self { kind, holes: 0 }
    }

    /// Sets how many of the bytes lie in holes of a sparse file, which take no space on disk.
    #[must_use]
    pub fn with_holes(self, holes: u64) -> Self {
        Self { holes, ..self }
    }

    /// The number of bytes that are stored, without holes.
    pub fn stored(&self) -> io::Result<u64> {
        Ok(self.length()?.saturating_sub(self.holes))
    }

    /// The number of bytes, holes included.
    pub fn length(&self) -> io::Result<u64> {
        match &self.kind {
            Kind::File(file) | Kind::Nameless(file) => Ok(file.metadata()?.len()),
            Kind::Memory(bytes) => Ok(bytes.get_ref().len() as u64),
            Kind::Remote { bytes, .. } => Ok(bytes.length()),
        }
    }

    /// An input of remote bytes. The first read starts at their first byte.
    #[must_use]
    pub fn remote(bytes: Arc<dyn RemoteBytes>) -> Self {
        Self::of(Kind::Remote { bytes, at: 0 })
    }

    /// An input of a file without a name, such as a spooled pipe.
    #[must_use]
    pub fn nameless(file: File) -> Self {
        Self::of(Kind::Nameless(file))
    }

    /// True if the bytes are in a file. [`Self::unpacked`] then writes to a temporary file instead of memory.
    pub fn is_file(&self) -> bool {
        matches!(self.kind, Kind::File(_) | Kind::Nameless(_))
    }

    /// True if this is a file that can be opened again by name.
    pub fn has_name(&self) -> bool {
        matches!(self.kind, Kind::File(_))
    }

    /// True if the file is a directory, which can be opened but not read.
    pub fn is_directory(&self) -> io::Result<bool> {
        match &self.kind {
            Kind::File(file) => Ok(file.metadata()?.is_dir()),
            Kind::Nameless(_) | Kind::Memory(_) | Kind::Remote { .. } => Ok(false),
        }
    }

    /// Another input of the same bytes. Inputs of the same file share one position.
    pub fn try_clone(&self) -> io::Result<Self> {
        let kind = match &self.kind {
            Kind::File(file) => Kind::File(file.try_clone()?),
            Kind::Nameless(file) => Kind::Nameless(file.try_clone()?),
            Kind::Memory(bytes) => Kind::Memory(bytes.clone()),
            Kind::Remote { bytes, at } => Kind::Remote { bytes: bytes.clone(), at: *at },
        };
        Ok(Self { kind, holes: self.holes })
    }

    /// Another input of the same bytes, at the first of them. Moves the read position of a file.
    pub fn rewound(&self) -> io::Result<Self> {
        let mut again = self.try_clone()?;
        again.rewind()?;
        Ok(again)
    }

    /// The first bytes, at most `length`. The read position is then the first byte.
    pub fn start(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut start = Vec::new();
        self.take(length).read_to_end(&mut start)?;
        self.rewind()?;
        Ok(start)
    }

    /// Reads `length` bytes from `start` on. Returns an error if there are fewer. Moves the read position of a file.
    pub fn bytes_at(&self, start: u64, length: usize) -> io::Result<Bytes> {
        let outside = || io::Error::new(ErrorKind::UnexpectedEof, format!("{length} bytes at {start} are not there"));
        if let Kind::Memory(bytes) = &self.kind {
            let bytes = bytes.get_ref();
            let range = usize::try_from(start).ok().and_then(|start| Some(start..start.checked_add(length)?));
            let range = range.filter(|range| range.end <= bytes.len()).ok_or_else(outside)?;
            return Ok(bytes.slice(range));
        }
        let mut input = self.try_clone()?;
        input.seek(SeekFrom::Start(start))?;
        let mut found = Vec::new();
        input.take(length as u64).read_to_end(&mut found)?;
        if found.len() == length { Ok(found.into()) } else { Err(outside()) }
    }

    /// The number of bytes after `end`, the end of the content; 0 if all of them are zeros, which are padding. Moves
    /// the read position of a file.
    pub fn bytes_behind(&self, end: u64) -> io::Result<u64> {
        let behind = self.length()?.saturating_sub(end);
        let mut input = self.try_clone()?;
        input.seek(SeekFrom::Start(end))?;
        let mut block = Vec::new();
        while (&mut input).take(BLOCK).read_to_end(&mut block)? > 0 {
            if block.iter().any(|byte| *byte != 0) {
                return Ok(behind);
            }
            block.clear();
        }
        Ok(0)
    }

    /// Offset of the first `mark` from `start` on; `None` if there is none. Moves the read position of a file.
    pub fn find(&self, mark: &[u8], start: u64) -> io::Result<Option<u64>> {
        let mut input = self.try_clone()?;
        input.seek(SeekFrom::Start(start))?;
        let (mut seen, mut at) = (Vec::new(), start);
        while (&mut input).take(BLOCK).read_to_end(&mut seen)? > 0 {
            if let Some(found) = seen.windows(mark.len()).position(|window| window == mark) {
                return Ok(Some(at + found as u64));
            }
            // a mark may span two blocks
            let done = seen.len().saturating_sub(mark.len() - 1);
            seen.drain(..done);
            at += done as u64;
        }
        Ok(None)
    }

    /// Returns the bytes that `fill` writes, in a nameless temporary file if this input is a file, otherwise in
    /// memory.
    pub fn unpacked<E: From<io::Error>>(
        &self,
        fill: impl FnOnce(&mut dyn io::Write) -> Result<(), E>,
    ) -> Result<Self, E> {
        #[cfg(not(target_family = "wasm"))]
        if self.is_file() {
            let mut file = io::BufWriter::new(tempfile::tempfile()?);
            fill(&mut file)?;
            let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.rewind()?;
            return Ok(Self::nameless(file));
        }
        let mut bytes = Vec::new();
        fill(&mut bytes)?;
        Ok(bytes.into())
    }
}

impl Read for Input {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        match &mut self.kind {
            Kind::File(file) | Kind::Nameless(file) => file.read(buf),
            Kind::Memory(bytes) => bytes.read(buf),
            Kind::Remote { bytes, at } => {
                let read = bytes.read_at(*at, buf)?;
                *at += read as u64;
                Ok(read)
            }
        }
    }
}

impl Seek for Input {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.kind {
            Kind::File(file) | Kind::Nameless(file) => file.seek(to),
            Kind::Memory(bytes) => bytes.seek(to),
            Kind::Remote { bytes, at } => {
                let place = match to {
                    SeekFrom::Start(place) => Some(place),
                    SeekFrom::Current(by) => at.checked_add_signed(by),
                    SeekFrom::End(by) => bytes.length().checked_add_signed(by),
                };
                *at = place.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "a place before the first byte"))?;
                Ok(*at)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns at most three bytes per read, as a browser may.
    #[derive(Debug)]
    struct Slices(Vec<u8>);

    impl RemoteBytes for Slices {
        fn length(&self) -> u64 {
            self.0.len() as u64
        }

        fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
            let rest = self.0.get(at as usize..).unwrap_or_default();
            let read = rest.len().min(into.len()).min(3);
            into[..read].copy_from_slice(&rest[..read]);
            Ok(read)
        }
    }

    #[test]
    fn memory_file_and_remote_input_read_the_same_bytes() {
        let packed = |input: &Input| input.unpacked(|out| out.write_all(b"0123456789")).map_err(|e: io::Error| e);
        let memory = packed(&Vec::new().into()).expect("memory");
        let file = packed(&tempfile::tempfile().expect("a file").into()).expect("a file");
        assert!(file.is_file() && !memory.is_file());
        let elsewhere = Input::remote(Arc::new(Slices(b"0123456789".to_vec())));
        assert!(!elsewhere.is_file() && elsewhere.try_clone().expect("a copy").seek(SeekFrom::Current(-1)).is_err());
        for mut input in [memory, file, elsewhere] {
            assert_eq!((input.length().expect("bytes"), input.bytes_at(3, 4).expect("bytes")), (10, "3456".into()));
            assert!(input.bytes_at(8, 3).is_err() && input.bytes_at(u64::MAX, 1).is_err());
            let mut read = String::new();
            input.seek(SeekFrom::Start(7)).expect("a place");
            input.read_to_string(&mut read).expect("text");
            input.seek(SeekFrom::End(-2)).expect("a place");
            input.read_to_string(&mut read).expect("text");
            assert_eq!(read, "78989");
        }
    }
}
