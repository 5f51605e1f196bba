//! `cargo xtask bench-serve`: `zerorate serve` with everybody looking on at once, in real time: pages, clients of
//! libiio, and a recording, which must lose nothing.

use crate::tools::{self, Tool};
use crate::venv::{done, printed};
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

const CAPTURE: &str = "target/bench-serve.arrows";
const PROGRAM: &str = "target/release/zerorate";
/// Pairs of conversions a second at the nominal clock (F-31): 11 385 conversions, of the rate and the temperature in
/// turn.
const PAIRS_HZ: f64 = 5692.6;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// How long, s
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Pages that look on
    #[arg(long, default_value_t = 20)]
    watchers: usize,
    /// Clients of libiio (iio_readdev, where libiio-utils is installed or can be)
    #[arg(long, default_value_t = 4)]
    clients: usize,
    /// The program, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// Starts the server, lets everybody look on, and prints what that costs.
pub fn run(args: &Args) -> Result<()> {
    let program = program(args)?;
    let clients = if has_iio(&program, args)? { args.clients } else { 0 };
    // another recording is never overwritten by the program
    drop(fs::remove_file(CAPTURE));
    let mut served = Served::start(&program, clients > 0)?;
    let over = AtomicBool::new(false);
    let seen = thread::scope(|scope| -> Result<Seen> {
        let pages: Vec<_> = (0..args.watchers).map(|_| scope.spawn(|| watch(served.port, &over))).collect();
        let readers = (0..clients).map(|_| read_iio(served.iio_port)).collect::<Result<Vec<_>>>();
        let share = served.share_over(Duration::from_secs(args.seconds));
        over.store(true, Ordering::Relaxed);
        let (share, readers) = (share?, readers?);
        let readers = readers.into_iter().map(end_reader).collect::<Result<Vec<u64>>>()?;
        let pages = pages.into_iter().map(|page| page.join().unwrap_or_else(|_| bail!("a page died")));
        Ok(Seen { share, pages: pages.collect::<Result<_>>()?, readers })
    })?;
    let peak_mb = served.peak_mb()?;
    served.end()?;
    report(args, &program, &seen, peak_mb)
}

/// What came of it.
struct Seen {
    /// Of one core.
    share: f64,
    /// Frames and bytes of each page.
    pages: Vec<(u64, u64)>,
    /// Bytes of each client of libiio.
    readers: Vec<u64>,
}

fn program(args: &Args) -> Result<PathBuf> {
    if let Some(program) = &args.program {
        return Ok(std::path::absolute(program)?);
    }
    done(Command::new("cargo").args(["build", "--release", "--quiet", "-p", "zerorate-cli"]))?;
    Ok(std::path::absolute(PROGRAM)?)
}

/// Whether clients of libiio can take part.
fn has_iio(program: &Path, args: &Args) -> Result<bool> {
    let has_option = printed(Command::new(program).args(["serve", "--help"]))?.contains("--iio");
    if args.clients == 0 || !has_option {
        println!("no clients of libiio: none wanted, or this program serves none");
        return Ok(false);
    }
    tools::available(&[Tool { program: "iio_readdev", package: "libiio-utils" }], "clients of libiio")
}

/// The server, ended with this.
struct Served {
    child: Child,
    port: u16,
    iio_port: u16,
}

impl Served {
    fn start(program: &Path, with_iio: bool) -> Result<Self> {
        let iio_port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let mut command = Command::new(program);
        command.args(["serve", "--device", "twin:seed=1", "--listen", "127.0.0.1:0", "-o", CAPTURE]);
        if with_iio {
            command.arg(format!("--iio=127.0.0.1:{iio_port}"));
        }
        let mut child = command.stderr(Stdio::piped()).spawn()?;
        let mut lines = BufReader::new(child.stderr.take().context("no stderr")?).lines();
        let port = lines.by_ref().map_while(Result::ok).find_map(|line| {
            let rest = line.split_once("open http://127.0.0.1:")?.1;
            rest.split('/').next()?.parse().ok()
        });
        thread::spawn(move || lines.map_while(Result::ok).for_each(|line| eprintln!("{line}")));
        let port = port.context("the server did not start")?;
        Ok(Self { child, port, iio_port })
    }

    /// Time of the processor in so much time, as a share of one core.
    fn share_over(&self, time: Duration) -> Result<f64> {
        let (begun, cpu_s) = (Instant::now(), self.cpu_s()?);
        thread::sleep(time);
        Ok((self.cpu_s()? - cpu_s) / begun.elapsed().as_secs_f64())
    }

    /// Time of the processor by now, s.
    fn cpu_s(&self) -> Result<f64> {
        /// `getconf CLK_TCK`
        const TICKS_PER_S: f64 = 100.0;
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.child.id()))?;
        let (_, rest) = stat.rsplit_once(')').context("/proc/PID/stat")?;
        let ticks = rest.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
        Ok(ticks.sum::<Result<f64, _>>()? / TICKS_PER_S)
    }

    fn peak_mb(&self) -> Result<f64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id()))?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).context("/proc/PID/status")?;
        Ok(line.trim().trim_end_matches(" kB").parse::<f64>()? / 1024.0)
    }

    /// As Ctrl-C does.
    fn end(&mut self) -> Result<()> {
        done(Command::new("kill").args(["-INT", &self.child.id().to_string()]))?;
        let status = self.child.wait()?;
        ensure!(status.success(), "the server ended with {status}");
        Ok(())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // it may have ended
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Frames and bytes that a page gets until it is over.
fn watch(port: u16, over: &AtomicBool) -> Result<(u64, u64)> {
    let mut stream = BufReader::new(TcpStream::connect(("127.0.0.1", port))?);
    let ask = "GET /ws HTTP/1.1\r\nhost: localhost\r\nconnection: upgrade\r\nupgrade: websocket\r\n\
        sec-websocket-version: 13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    stream.get_mut().write_all(ask.as_bytes())?;
    let mut line = String::new();
    stream.read_line(&mut line)?;
    ensure!(line.contains(" 101 "), "no WebSocket: {line}");
    while line.trim() != "" {
        line.clear();
        stream.read_line(&mut line)?;
    }
    let (mut frames, mut bytes) = (0, 0);
    while !over.load(Ordering::Relaxed) {
        bytes += skip_frame(&mut stream)?;
        frames += 1;
    }
    Ok((frames, bytes))
}

/// Reads a message of the server, which has no mask (RFC 6455, 5.2).
fn skip_frame(stream: &mut impl Read) -> Result<u64> {
    let mut head = [0; 2];
    stream.read_exact(&mut head)?;
    let length = match head[1] {
        126 => {
            let mut length = [0; 2];
            stream.read_exact(&mut length)?;
            u16::from_be_bytes(length).into()
        }
        127 => {
            let mut length = [0; 8];
            stream.read_exact(&mut length)?;
            u64::from_be_bytes(length)
        }
        short => short.into(),
    };
    let read = std::io::copy(&mut stream.take(length), &mut std::io::sink())?;
    ensure!(read == length, "the server hung up");
    Ok(length)
}

fn read_iio(port: u16) -> Result<(Child, thread::JoinHandle<std::io::Result<u64>>)> {
    let uri = format!("ip:127.0.0.1:{port}");
    let mut command = Command::new("iio_readdev");
    let mut child = command.args(["-u", &uri, "-b", "1024", "iio:device0"]).stdout(Stdio::piped()).spawn()?;
    let mut out = child.stdout.take().context("no stdout")?;
    Ok((child, thread::spawn(move || std::io::copy(&mut out, &mut std::io::sink()))))
}

fn end_reader((mut child, bytes): (Child, thread::JoinHandle<std::io::Result<u64>>)) -> Result<u64> {
    child.kill()?;
    child.wait()?;
    Ok(bytes.join().map_err(|_| anyhow::anyhow!("a client died"))??)
}

fn report(args: &Args, program: &Path, seen: &Seen, peak_mb: f64) -> Result<()> {
    let verified = printed(Command::new(program).args(["verify", "--json", CAPTURE]))?;
    let recorded: Value = serde_json::from_str(&verified)?;
    let number = |name: &str| recorded["files"][0][name].as_f64().with_context(|| format!("no {name}: {verified}"));
    let (rows, lost) = (number("rows")?, number("lost")?);
    let span_s = (number("last_ns")? - number("first_ns")?) * 1e-9;
    let least = |values: &mut dyn Iterator<Item = u64>| values.min().unwrap_or_default();
    let frames_per_s = least(&mut seen.pages.iter().map(|page| page.0)) as f64 / args.seconds as f64;
    let page_kb_per_s =
        seen.pages.iter().map(|page| page.1).max().unwrap_or_default() as f64 / 1e3 / args.seconds as f64;
    println!(
        "recorded      {rows} samples over {span_s:.1} s of twin time, {:.1} a second, {lost} lost",
        rows / span_s
    );
    println!("pages         {}, at least {frames_per_s:.1} frames/s, {page_kb_per_s:.0} KB/s each", seen.pages.len());
    println!(
        "libiio        {} clients, at least {} bytes",
        seen.readers.len(),
        least(&mut seen.readers.iter().copied())
    );
    println!("processor     {:.1} % of a core", seen.share * 100.0);
    println!("memory        {peak_mb:.1} MB at most");
    fs::remove_file(CAPTURE)?;
    let expected = span_s * PAIRS_HZ;
    ensure!(lost == 0.0, "samples were lost");
    // F-31: within 2 % at any clock
    ensure!((rows / expected - 1.0).abs() < 0.03, "{rows} samples are not those of {span_s:.1} s");
    ensure!(seen.readers.iter().all(|bytes| *bytes > 0), "a client of libiio got nothing");
    Ok(())
}
