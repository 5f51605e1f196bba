//! A run in a child process with a limit on its memory.
//!
//! The decoders of foreign formats are other people's, and no check of ours foresees everything that they do with a
//! damaged file. What they panic on is caught where they are called; but where memory or stack is used up the process
//! ends, and there is nothing to catch. Therefore a command that reads files of unknown origin runs in a child, and
//! its parent says what became of it.

use crate::output::say;
use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process, set_parent_process_death_signal, setrlimit};
use signal_hook::consts::{SIGHUP, SIGINT, SIGPIPE, SIGTERM};
use signal_hook::iterator::SignalsInfo;
use signal_hook::iterator::exfiltrator::WithOrigin;
use signal_hook::low_level::siginfo::Cause;
use std::ffi::OsString;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Command, ExitCode, ExitStatus};
use std::{io, thread};
use zerorate_host::files as on_disk;
use zerorate_record::limits::{self, Bytes};

/// Tells the child that it is one.
const MARK: &str = "ZERORATE_CONFINED";

/// Where glibc reads how it is to get memory, and what it reads: large arrays in large pages, without which new memory
/// takes longer than what is read into it. Other C libraries do not look there.
const TUNABLES: &str = "GLIBC_TUNABLES";
const LARGE_PAGES: &str = "glibc.malloc.hugetlb=1";

/// What the program takes beside what is in the files: threads, tables, the result.
const PROGRAM_BYTES: u64 = 256 << 20;

/// How a child ends that could not become this program, where its parent is not told: in QEMU's user mode. We end with
/// no such code.
const NOT_STARTED: i32 = 127;

/// What happens where.
pub enum Role {
    /// The command is to be run here.
    Worker,
    /// It was run in a child that ended like this.
    Supervisor(ExitCode),
}

/// Runs the command line `args` in a child if it reads `files` and this is no such child yet.
pub fn run(args: &[OsString], files: &[&Path]) -> Role {
    let limit = limit(files);
    if files.is_empty() {
        return Role::Worker;
    }
    if std::env::var_os(MARK).is_some() {
        confine(limit);
        return Role::Worker;
    }
    match supervise(args) {
        Ok(status) if status.code() != Some(NOT_STARTED) => Role::Supervisor(ended(status, files, limit)),
        // no /proc, or no process to be had: the command itself may still do
        _ => Role::Worker,
    }
}

/// What all the files together may take.
fn limit(files: &[&Path]) -> Bytes {
    let sizes = files.iter().map(|path| on_disk::log_length(path)).fold(0, u64::saturating_add);
    Bytes(limits::for_size(sizes).saturating_add(PROGRAM_BYTES - limits::FREE_BYTES).min(limits::max_memory()))
}

/// Memory that is written to counts, address space that is only reserved does not. A limit that cannot be set is none:
/// the checks of the readers still hold.
fn confine(Bytes(limit): Bytes) {
    let _ = setrlimit(Resource::Data, Rlimit { current: Some(limit), maximum: Some(limit) });
    let _ = setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) });
    let _ = set_parent_process_death_signal(Some(Signal::TERM));
}

/// The child's standard streams are ours. Ctrl-C reaches both by itself, from the kernel; what a process sends us is
/// passed on. The child is there before we listen, so that what we ignore it ignores too.
fn supervise(args: &[OsString]) -> io::Result<ExitStatus> {
    let (name, rest) = args.split_first().ok_or(io::ErrorKind::InvalidInput)?;
    let mut command = Command::new("/proc/self/exe");
    command.arg0(name).args(rest).env(MARK, "1");
    if std::env::var_os(TUNABLES).is_none() {
        command.env(TUNABLES, LARGE_PAGES);
    }
    let mut child = command.spawn()?;
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    if let (Some(pid), Ok(mut signals)) = (pid, SignalsInfo::<WithOrigin>::new([SIGINT, SIGTERM])) {
        thread::spawn(move || {
            for signal in signals.forever().filter(|origin| origin.cause != Cause::Kernel) {
                let passed_on = if signal.signal == SIGINT { Signal::INT } else { Signal::TERM };
                let _ = kill_process(pid, passed_on);
            }
        });
    }
    child.wait()
}

/// The child's exit code, or the reason why it has none.
fn ended(status: ExitStatus, files: &[&Path], limit: Bytes) -> ExitCode {
    match (status.code(), status.signal()) {
        (Some(code), _) => ExitCode::from(u8::try_from(code).unwrap_or(1)),
        (None, Some(signal @ (SIGHUP | SIGINT | SIGPIPE | SIGTERM))) => ExitCode::from(128 + signal as u8),
        (None, _) => {
            let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
            say(format_args!(
                "error: {}: reading took more than the {limit} of memory that it may take (--max-memory, and {} plus \
                 {} times the size of the file): it is damaged, or made to fill a machine; if it is neither, give \
                 more with --max-memory",
                names.join(", "),
                Bytes(PROGRAM_BYTES),
                limits::FACTOR
            ));
            ExitCode::FAILURE
        }
    }
}
