//! `zerorate serve`: serves the live page.

use super::correct::load;
use super::serial::{self, one_line};
use crate::device::{SamplingArgs, SourceArgs};
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, say, warn};
use crate::serve::{self, EndsAll, Folder, Guard, Libiio, Opener, Recordings, SessionThread, Token};
use crate::wording::coded;
use anyhow::{Context, Result, anyhow, ensure};
use clap::Args;
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::thread;
use zerorate::Calibration;
use zerorate_host::iiod;
use zerorate_input::limits;
use zerorate_view::SessionWarning;
use zerorate_web::session::{About, NoticeText};

/// Show a sensor live in the browser, and calibrate it as a guided run
///
/// Open the address that the command prints. All viewers see the same page, and no viewer slows the sensor or the
/// recording. Simulated and recorded time runs at the speed of the clock, or faster where the page asks for it. An
/// unplugged sensor is opened again when it comes back. Ctrl-C ends the server, and the recording is complete.
///
/// Other machines cannot reach the server unless --listen names an address of the network. A token is then required,
/// which is printed once. docs/serve.md describes what the server protects.
///
/// Clients of libiio (iio_info, iio_readdev, pyadi-iio) see the sensor as a device with a buffer: docs/libiio.md.
#[derive(Args, Debug)]
pub struct ServeArgs {
    #[command(flatten)]
    source: SourceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// A calibration to have on file; the first is applied. The option can be repeated.
    #[arg(long = "cal", value_name = "FILE")]
    cals: Vec<PathBuf>,

    /// The serial number of the sensor: calibrations must have it, and it is stored with the samples.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    /// The address and port to serve at; port 0 takes a free port.
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:8130", value_parser = address)]
    listen: SocketAddr,

    /// Record every sample to this file meanwhile. When the device is opened again, NAME-2 follows, and so on.
    #[arg(short, long, value_name = "CAPTURE")]
    output: Option<PathBuf>,

    /// Keep calibrations in this folder: read all files there, and write those made on the page.
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,

    /// Take the token from the first line of this file, instead of a new token for each run.
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,

    /// A name by which browsers reach this machine, beside its IP addresses and localhost. The option can be repeated.
    #[arg(long = "host", value_name = "NAME")]
    hosts: Vec<String>,

    /// Serve clients of libiio at this address of this machine, with the corrected rate of the first --cal
    /// [default: 127.0.0.1:30431, if it is free].
    #[arg(long, value_name = "IP:PORT")]
    iio: Option<SocketAddr>,

    /// Do not serve clients of libiio.
    #[arg(long, conflicts_with_all = ["iio", "allow_write"])]
    no_iio: bool,

    /// Let clients of libiio write calibbias, which shifts the corrected rate that they see.
    #[arg(long)]
    allow_write: bool,
}

impl ServeArgs {
    /// The input file that may come from an untrusted source, if the device is a recording.
    pub fn file(&self) -> Option<&Path> {
        self.source.file()
    }
}

fn address(text: &str) -> Result<SocketAddr, String> {
    let number = text.strip_prefix("localhost:").map(|port| format!("{}:{port}", Ipv4Addr::LOCALHOST));
    let wrong = |_| "give a number and a port: 127.0.0.1:8130, or 0.0.0.0:8130 for the whole network".to_owned();
    number.as_deref().unwrap_or(text).parse().map_err(wrong)
}

pub fn run(args: &ServeArgs) -> Result<()> {
    let stop = interrupt::stop();
    let mut outputs = Outputs::without_force();
    let calibrations = args.cals.iter().map(|cal| load(cal, &mut outputs)).collect::<Result<Vec<_>>>()?;
    let token = token(args, &mut outputs)?;
    let listener = listen(args.listen)?;
    let address = listener.local_addr().context("the server")?;
    let spec = args.source.device.clone();
    let (setup, serial) = (args.source.setup(args.sampling, &mut outputs)?, args.serial.clone());
    let opener = Opener { spec, setup, serial, stop: stop.clone() };
    interrupt::listen();
    let opened = opener.open()?;
    ensure!(!stop.asked(), "interrupted");
    if let Some((calibration, cal)) = calibrations.first().zip(args.cals.first()) {
        let About { name, info, .. } = &opened.about;
        let doubt = serial::check(calibration, cal, (name, info.serial.as_deref()))?;
        warn(doubt.map(coded).as_slice());
    }
    let recordings = Recordings::new(args.output.clone(), outputs);
    let (mut session_thread, requests) =
        SessionThread::new(opener, opened, recordings, Folder::new(args.folder.clone()));
    shelve(args, &mut session_thread)?;
    session_thread.libiio = libiio(args, calibrations.into_iter().next())?;
    let at = session_thread.libiio.as_ref().map(Libiio::address).transpose()?;
    session_thread.begin()?;
    announce(address, token.as_ref(), args.token_file.as_deref());
    if let Some(at) = at {
        say(format_args!("libiio: iio_info -u ip:{at}"));
    }
    let guard = Guard::new(address, token, args.hosts.clone());
    let session = thread::Builder::new().name("session".to_owned()).spawn(move || {
        let _ends = EndsAll(stop.clone());
        session_thread.run(stop)
    });
    let session = session.context("starting the session")?;
    let served = serve::run(listener, guard, requests, stop);
    // the recording must be completed, however the server ended
    stop.ask();
    served.and(session.join().unwrap_or_else(|_| Err(anyhow!("the session died"))))
}

/// Opens the listener for libiio clients; `None` with `--no-iio`, or if the default address cannot be used. No
/// password protects the listener, so other machines must not reach it.
fn libiio(args: &ServeArgs, calibration: Option<Calibration>) -> Result<Option<Libiio>> {
    if args.no_iio {
        return Ok(None);
    }
    let address = args.iio.unwrap_or(SocketAddr::new(Ipv4Addr::LOCALHOST.into(), iiod::PORT));
    if !address.ip().is_loopback() {
        let why = format!(
            "--iio {address}: libiio knows no password, so it is served to this machine alone: forward the port, \
             ssh -L {0}:localhost:{0} HOST",
            address.port()
        );
        return Err(Usage(why).into());
    }
    let listener = match TcpListener::bind(address) {
        Ok(listener) => listener,
        Err(error) if args.iio.is_none() => {
            warn(&[NoticeText::from(SessionWarning::LibiioUnserved { address, why: error.to_string() })]);
            return Ok(None);
        }
        Err(error) => return Err(error).with_context(|| format!("cannot listen at {address} (--iio)")),
    };
    Ok(Some(Libiio::new(listener, calibration, args.allow_write)))
}

/// Stores the calibrations of the folder and of the command line in the session, and applies the first `--cal`.
fn shelve(args: &ServeArgs, session_thread: &mut SessionThread) -> Result<()> {
    let SessionThread { session, folder, .. } = session_thread;
    folder.read(session)?;
    for (index, cal) in args.cals.iter().enumerate() {
        let id = folder.add(cal, session)?;
        if index == 0 {
            session.apply(Some(&id)).map_err(|why| Usage(format!("--cal {}: {why}", cal.display())))?;
        }
    }
    Ok(())
}

/// The token; `None` if only this machine can reach the address and no token was given.
fn token(args: &ServeArgs, outputs: &mut Outputs) -> Result<Option<Token>> {
    match &args.token_file {
        Some(path) => Token::of_file(path, &outputs.text(path, limits::TEXT)?).map(Some),
        None if args.listen.ip().is_loopback() => Ok(None),
        None => Token::random().map(Some),
    }
}

fn listen(address: SocketAddr) -> Result<TcpListener> {
    TcpListener::bind(address).map_err(|error| {
        let what_to_do = match error.kind() {
            ErrorKind::AddrInUse => format!(
                "something serves there already (another zerorate?): end it, or take another port, as in --listen \
                 {}:{}",
                address.ip(),
                address.port().checked_add(1).unwrap_or_default()
            ),
            ErrorKind::AddrNotAvailable => "this machine has another address; 127.0.0.1 works".to_owned(),
            ErrorKind::PermissionDenied => "ports below 1024 are the system's: take a larger one".to_owned(),
            _ => error.to_string(),
        };
        anyhow!("cannot listen at {address}: {what_to_do}")
    })
}

/// A token from a file is not printed, because the output of a service goes to a journal that others can read.
fn announce(address: SocketAddr, token: Option<&Token>, of_file: Option<&Path>) {
    if !serve::has_page() {
        warn(&[NoticeText::from(SessionWarning::NoPage)]);
    }
    let ip = match address.ip() {
        IpAddr::V4(Ipv4Addr::UNSPECIFIED) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(Ipv6Addr::UNSPECIFIED) => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    let url = format!("http://{}/", SocketAddr::new(ip, address.port()));
    let Some(token) = token else { return say(format_args!("open {url}")) };
    match of_file {
        Some(path) => say(format_args!("open {url} with the token of {}", path.display())),
        // browsers do not send the part after # to a server
        None => say(format_args!("open {url}#token={}", token.reveal())),
    }
    if !address.ip().is_loopback() {
        say("others on the network reach it by this machine's address; they can read what is sent, the token too");
    }
}
