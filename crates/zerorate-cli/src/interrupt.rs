//! Ctrl-C, SIGTERM and SIGHUP. The first signal requests a clean end if a loop listens for it; otherwise, and until a
//! reader has opened a pipe that is written, it ends the program. A second signal ends the program at once, or
//! within two seconds while a chamber is being set to its safe temperature. Signals within half a second count as one,
//! because programs such as `timeout` send two. Temporary files are always removed. On Linux, a program that was
//! started by `nohup` continues when its terminal is closed.

use crate::{exit_message, output};
use anyhow::Context;
use std::io;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use zerorate_host::Stop;

static HANDLED: OnceLock<()> = OnceLock::new();
static LISTENED_TO: AtomicBool = AtomicBool::new(false);
static STOP: OnceLock<Stop> = OnceLock::new();
static FIRST: OnceLock<Instant> = OnceLock::new();

/// Base of the exit code of a program that a signal ended: this plus the signal's number, as in shells.
const BY_SIGNAL: i32 = 128;

/// Signals within this time after the first signal count as one signal.
const SAME: Duration = Duration::from_millis(500);

/// Time after a second signal for work that must not be interrupted.
const GRACE: Duration = Duration::from_secs(2);

/// Installs the signal handler, before a command runs. Until [`listen`] is called, a signal ends the program.
pub fn handle() -> anyhow::Result<()> {
    // a process such as Python may run several command lines, but installs the handler only once
    if HANDLED.set(()).is_ok() {
        handle_signals().context("installing the handler of Ctrl-C")?;
    }
    Ok(())
}

/// The stop that the first signal requests. A loop that checks it must have called [`listen`].
pub fn stop() -> &'static Stop {
    STOP.get_or_init(Stop::default)
}

/// After this call, the first signal does not end the program, but only requests [`stop`].
pub fn listen() {
    LISTENED_TO.store(true, Ordering::Relaxed);
}

fn heed(signal: i32) {
    let again = FIRST.get_or_init(Instant::now).elapsed() > SAME;
    stop().ask();
    if !LISTENED_TO.load(Ordering::Relaxed) || output::opens_stream() || again {
        exit_message::wait(GRACE);
        output::remove_all_for_good();
        exit_message::exit(BY_SIGNAL + signal);
    }
}

#[cfg(unix)]
fn handle_signals() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    let hang_up = (!is_ignored(SIGHUP)).then_some(SIGHUP);
    let mut signals = Signals::new([SIGINT, SIGTERM].into_iter().chain(hang_up))?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || signals.forever().for_each(heed))?;
    Ok(())
}

/// True if the parent process made this program ignore the signal. Always false outside of Linux.
#[cfg(unix)]
pub fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(not(unix))]
fn handle_signals() -> io::Result<()> {
    use signal_hook::consts::SIGINT;
    use std::sync::Arc;
    /// Ctrl-Break, or a closed console window.
    const SIGBREAK: i32 = 21;
    const POLL: Duration = Duration::from_millis(50);
    let caught = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGBREAK] {
        signal_hook::flag::register(signal, Arc::clone(&caught))?;
    }
    let watch = move || {
        loop {
            if caught.swap(false, Ordering::Relaxed) {
                heed(SIGINT);
            }
            std::thread::sleep(POLL);
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(watch)?;
    Ok(())
}
