//! The byte stream to a bridge: a serial port (USB CDC or UART) or a TCP connection.

use crate::error::no_permission;
use anyhow::{Context, Result};
use serial2::SerialPort;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Time limit for connecting, and for sending a request.
const PATIENCE: Duration = Duration::from_secs(3);

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// A serial port. USB ports ignore the baud rate.
    Serial {
        /// The path of the port, or its name on systems without port files.
        path: String,
        baud: u32,
    },
    /// A TCP connection to HOST:PORT.
    Tcp(String),
}

pub enum Wire {
    Serial(SerialPort),
    Tcp(TcpStream),
}

impl Wire {
    pub fn open(port: &Port) -> Result<Self> {
        match port {
            Port::Serial { path, baud } => Self::serial(path, *baud).map_err(|error| why_no_port(path, error)),
            Port::Tcp(address) => connect(address).map(Self::Tcp).with_context(|| {
                format!("nothing answers at {address}: is the bridge, or the emulator with it, running there?")
            }),
        }
    }

    /// Opens a serial port exclusively.
    fn serial(path: &str, baud: u32) -> io::Result<Self> {
        let mut serial = SerialPort::open(path, baud)?;
        #[cfg(unix)]
        claim(&serial)?;
        serial.set_write_timeout(PATIENCE)?;
        // USB bridges wait for DTR, which not all systems set. An error means that the port has no DTR line, so it is
        // not a USB port.
        let _ = serial.set_dtr(true);
        Ok(Self::Serial(serial))
    }

    /// Waits for bytes, for `patience` at most, and reads up to 4096 bytes that have arrived.
    pub fn read(&mut self, patience: Duration, into: &mut VecDeque<u8>) -> io::Result<()> {
        let mut bytes = [0; 4096];
        let read = match self {
            Self::Serial(serial) => serial.set_read_timeout(patience).and_then(|()| serial.read(&mut bytes)),
            Self::Tcp(stream) => stream.set_read_timeout(Some(patience)).and_then(|()| stream.read(&mut bytes)),
        };
        match read {
            Ok(0) => Err(io::Error::new(ErrorKind::UnexpectedEof, "the other end closed the connection")),
            Ok(length) => {
                into.extend(&bytes[..length]);
                Ok(())
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted) =>
            {
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Serial(serial) => serial.write_all(bytes),
            Self::Tcp(stream) => stream.write_all(bytes),
        }
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Locks the port against other programs, and ignores its modem lines, which a bridge with three wires lacks.
#[cfg(unix)]
fn claim(serial: &SerialPort) -> io::Result<()> {
    use rustix::fs::{FlockOperation, flock};
    use rustix::termios::{ControlModes, OptionalActions, ioctl_tiocexcl, tcgetattr, tcsetattr};
    ioctl_tiocexcl(serial)?;
    // the lock of `ioctl_tiocexcl` does not apply to root
    flock(serial, FlockOperation::NonBlockingLockExclusive)?;
    let mut settings = tcgetattr(serial)?;
    settings.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
    Ok(tcsetattr(serial, OptionalActions::Now, &settings)?)
}

fn why_no_port(path: &str, error: io::Error) -> anyhow::Error {
    let remedy = match error.kind() {
        ErrorKind::PermissionDenied if cfg!(unix) => no_permission(path, "dialout"),
        ErrorKind::NotFound => {
            format!("no {path}: plug the bridge in, and look with ls /dev/ttyACM* /dev/ttyUSB*")
        }
        ErrorKind::PermissionDenied | ErrorKind::ResourceBusy | ErrorKind::WouldBlock => {
            format!("{path} is busy: end what has it open (fuser {path})")
        }
        _ => format!("cannot open {path} as a serial port"),
    };
    anyhow::Error::new(error).context(remedy)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use std::fs::File;

    const SOON: Duration = Duration::from_secs(5);

    /// Opens a pseudo-terminal. Returns its far end, and the path of its near end.
    fn pair() -> (File, String) {
        let far = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pair of ports");
        grantpt(&far).expect("a near end");
        unlockpt(&far).expect("a near end");
        let near = ptsname(&far, Vec::new()).expect("a name").into_string().expect("text");
        (far.into(), near)
    }

    fn serial(path: &str) -> Result<Wire> {
        Wire::open(&Port::Serial { path: path.to_owned(), baud: 115_200 })
    }

    #[test]
    fn a_serial_port_carries_bytes_until_its_end_is_gone() {
        let (mut far, near) = pair();
        let mut wire = serial(&near).expect("a port");
        wire.write(b"TEMP?").expect("it is sent");
        let mut asked = [0; 5];
        far.read_exact(&mut asked).expect("it comes");
        assert_eq!(&asked, b"TEMP?");

        let mut received = VecDeque::new();
        wire.read(Duration::from_millis(1), &mut received).expect("silence is no failure");
        assert!(received.is_empty());
        far.write_all(b"23.0").expect("it is sent");
        while received.len() < 4 {
            wire.read(SOON, &mut received).expect("it comes");
        }
        assert_eq!(received, *b"23.0");

        drop(far);
        assert!(wire.read(SOON, &mut received).is_err());
        assert!(wire.write(b"TEMP?").is_err());
    }

    #[test]
    fn a_port_that_cannot_be_opened_says_what_to_do() {
        let why = |path| format!("{:#}", serial(path).err().expect("no port"));
        assert!(why("/dev/no-such-port").contains("plug the bridge in"), "{}", why("/dev/no-such-port"));
        assert!(why("/dev/null").contains("as a serial port"), "{}", why("/dev/null"));
        let (_far, path) = pair();
        let _taken = serial(&path).expect("a port");
        assert!(why(&path).contains("fuser"), "{}", why(&path));
    }
}
