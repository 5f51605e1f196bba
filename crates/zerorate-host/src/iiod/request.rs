//! Parses the requests of clients. `docs/libiio.md` lists them all.

use std::str::SplitAsciiWhitespace;
use std::time::Duration;

/// The reason of a refusal, as a Linux error number. The client receives its negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Errno(pub i32);

impl Errno {
    /// There is no attribute, channel or trigger of this name.
    pub const NOT_FOUND: Self = Self(2);
    /// No buffer is open, so none can be closed.
    pub const NOT_OPENED: Self = Self(6);
    /// No buffer is open, so none can be read.
    pub const NOT_OPEN: Self = Self(9);
    /// There is no valid reading at this time.
    pub const TRY_AGAIN: Self = Self(11);
    /// The request would take too much memory.
    pub const TOO_LARGE: Self = Self(12);
    /// The attribute cannot be written, or writing is not allowed.
    pub const DENIED: Self = Self(13);
    /// A buffer is open already.
    pub const BUSY: Self = Self(16);
    /// There is no such device, or it has disappeared.
    pub const NO_DEVICE: Self = Self(19);
    /// The request is malformed.
    pub const NONSENSE: Self = Self(22);
    /// This server does not support the request.
    pub const NOT_DONE: Self = Self(38);
    /// No sample came before the timeout.
    pub const TIMED_OUT: Self = Self(110);
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request<'a> {
    Nothing,
    Help,
    Exit,
    Version,
    Print,
    /// Sets the longest wait for samples; `None` removes the limit.
    Timeout(Option<Duration>),
    Read {
        device: &'a str,
        place: Place<'a>,
        /// The name of the attribute; `None` for all attributes.
        attribute: Option<&'a str>,
    },
    /// A value of this many bytes follows, even if the request is refused.
    Write {
        device: &'a str,
        place: Place<'a>,
        attribute: &'a str,
        bytes: usize,
    },
    Open {
        device: &'a str,
        samples: usize,
        mask: u32,
    },
    Close {
        device: &'a str,
    },
    ReadBuffer {
        device: &'a str,
        bytes: usize,
    },
    Trigger {
        device: &'a str,
    },
    SetTrigger {
        device: &'a str,
        trigger: Option<&'a str>,
    },
    BuffersCount {
        device: &'a str,
    },
}

/// The object that an attribute belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place<'a> {
    Device,
    Debug,
    Buffer,
    Input(&'a str),
    Output(&'a str),
}

impl<'a> Request<'a> {
    /// Parses a line, which may end in any white space.
    pub fn parse(line: &'a [u8]) -> Result<Self, Errno> {
        let text = std::str::from_utf8(line).map_err(|_| Errno::NONSENSE)?;
        let mut words = Words(text.split_ascii_whitespace());
        let Some(command) = words.0.next() else { return Ok(Self::Nothing) };
        let request = Self::of(&keyword(command), &mut words)?;
        words.end()?;
        Ok(request)
    }

    fn of(command: &str, words: &mut Words<'a>) -> Result<Self, Errno> {
        Ok(match command {
            "HELP" => Self::Help,
            "EXIT" => Self::Exit,
            "VERSION" => Self::Version,
            "PRINT" => Self::Print,
            "TIMEOUT" => Self::Timeout(words.timeout()?),
            "READ" => {
                let (device, (place, first)) = (words.next()?, words.place()?);
                Self::Read { device, place, attribute: first.or_else(|| words.0.next()) }
            }
            "WRITE" => {
                let (device, (place, first)) = (words.next()?, words.place()?);
                let attribute = first.map_or_else(|| words.next(), Ok)?;
                Self::Write { device, place, attribute, bytes: words.number()? }
            }
            "OPEN" => Self::Open { device: words.next()?, samples: words.number()?, mask: words.mask()? },
            "CLOSE" => Self::Close { device: words.next()? },
            "READBUF" => Self::ReadBuffer { device: words.next()?, bytes: words.number()? },
            "WRITEBUF" => return Err(Errno::NOT_DONE),
            "GETTRIG" => Self::Trigger { device: words.next()? },
            "SETTRIG" => Self::SetTrigger { device: words.next()?, trigger: words.0.next() },
            "SET" => words.buffers_count()?,
            _ => return Err(Errno::NONSENSE),
        })
    }
}

/// Converts a word of lower-case letters, which may be a keyword, to upper case. Any other word stays as it is.
fn keyword(word: &str) -> String {
    let is_small = word.bytes().all(|byte| byte.is_ascii_lowercase());
    if is_small { word.to_ascii_uppercase() } else { word.to_owned() }
}

struct Words<'a>(SplitAsciiWhitespace<'a>);

impl<'a> Words<'a> {
    fn next(&mut self) -> Result<&'a str, Errno> {
        self.0.next().ok_or(Errno::NONSENSE)
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result<T, Errno> {
        self.next()?.parse().map_err(|_| Errno::NONSENSE)
    }

    fn end(&mut self) -> Result<(), Errno> {
        self.0.next().map_or(Ok(()), |_| Err(Errno::NONSENSE))
    }

    fn timeout(&mut self) -> Result<Option<Duration>, Errno> {
        let ms: u32 = self.number()?;
        Ok((ms > 0).then(|| Duration::from_millis(ms.into())))
    }

    /// Parses the object of an attribute. Without a word for the object, the attribute belongs to the device and is
    /// returned as well.
    fn place(&mut self) -> Result<(Place<'a>, Option<&'a str>), Errno> {
        let Some(word) = self.0.next() else { return Ok((Place::Device, None)) };
        Ok(match keyword(word).as_str() {
            "DEBUG" => (Place::Debug, None),
            "BUFFER" => (Place::Buffer, None),
            "INPUT" => (Place::Input(self.next()?), None),
            "OUTPUT" => (Place::Output(self.next()?), None),
            _ => (Place::Device, Some(word)),
        })
    }

    /// Parses a channel mask: eight hexadecimal digits for 32 channels. No device has more channels.
    fn mask(&mut self) -> Result<u32, Errno> {
        let word = self.next()?;
        let is_mask = word.len() == 8 && word.bytes().all(|byte| byte.is_ascii_hexdigit());
        u32::from_str_radix(word, 16).ok().filter(|_| is_mask).ok_or(Errno::NONSENSE)
    }

    fn buffers_count(&mut self) -> Result<Request<'a>, Errno> {
        let device = self.next()?;
        if keyword(self.next()?) != "BUFFERS_COUNT" || self.number::<u32>()? == 0 {
            return Err(Errno::NONSENSE);
        }
        Ok(Request::BuffersCount { device })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The requests as libiio 0.24 sends them.
    #[test]
    fn requests_are_those_of_the_library() {
        let parse = |line: &'static str| Request::parse(line.as_bytes());
        assert_eq!(parse("\r\n"), Ok(Request::Nothing));
        assert_eq!(parse("PRINT\r\n"), Ok(Request::Print));
        assert_eq!(parse("TIMEOUT 2500\r\n"), Ok(Request::Timeout(Some(Duration::from_millis(2500)))));
        assert_eq!(parse("timeout 0"), Ok(Request::Timeout(None)));
        let device = "iio:device0";
        let read = |place, attribute| Ok(Request::Read { device, place, attribute });
        assert_eq!(parse("READ iio:device0 sampling_frequency\r\n"), read(Place::Device, Some("sampling_frequency")));
        assert_eq!(parse("READ iio:device0 INPUT anglvel_z raw\r\n"), read(Place::Input("anglvel_z"), Some("raw")));
        assert_eq!(parse("READ iio:device0 BUFFER watermark"), read(Place::Buffer, Some("watermark")));
        assert_eq!(parse("READ iio:device0"), read(Place::Device, None));
        assert_eq!(
            parse("WRITE iio:device0 INPUT anglvel_z calibbias 6\r\n"),
            Ok(Request::Write { device, place: Place::Input("anglvel_z"), attribute: "calibbias", bytes: 6 })
        );
        assert_eq!(
            parse("WRITE iio:device0 x 2"),
            Ok(Request::Write { device, place: Place::Device, attribute: "x", bytes: 2 })
        );
        assert_eq!(parse("OPEN iio:device0 256 0000001f\r\n"), Ok(Request::Open { device, samples: 256, mask: 0x1f }));
        assert_eq!(parse("READBUF iio:device0 1024\r\n"), Ok(Request::ReadBuffer { device, bytes: 1024 }));
        assert_eq!(parse("SET iio:device0 BUFFERS_COUNT 4\r\n"), Ok(Request::BuffersCount { device }));
        assert_eq!(parse("SETTRIG iio:device0"), Ok(Request::SetTrigger { device, trigger: None }));
    }

    #[test]
    fn malformed_requests_are_refused() {
        for line in [
            "Print",
            "PRINT 1",
            "NOISE",
            "READ",
            "READ d INPUT",
            "WRITE d a",
            "WRITE d a -1",
            "WRITE d 5",
            "OPEN d 4",
            "OPEN d 4 1f",
            "OPEN d 4 +000001f",
            "OPEN d 4 0000001f CYCLIC",
            "OPEN d -4 0000001f",
            "READBUF d",
            "READBUF d 99999999999999999999999",
            "TIMEOUT",
            "TIMEOUT x",
            "SET d BUFFERS_COUNT 0",
            "SET d OTHER 1",
            "ZPRINT",
            "BINARY",
            "OPEN d 4 0000001f0000001f",
        ] {
            assert_eq!(Request::parse(line.as_bytes()), Err(Errno::NONSENSE), "{line}");
        }
        assert_eq!(Request::parse(&[0xff, 0xfe, 0x00]), Err(Errno::NONSENSE));
        assert_eq!(Request::parse(b"WRITEBUF d 16"), Err(Errno::NOT_DONE));
    }
}
