//! Runs a command in a child process with limited memory.
//!
//! The readers limit the memory for a file, and catch panics of the decoders. For the Parquet library that is not
//! enough:
//!
//! * It parses a schema recursively, so that 20 000 nested groups (160 kB) overflow the stack.
//! * It decompresses a whole page before it returns a row, so that a file of 50 kB took 470 MiB, and may take more.
//!
//! A process cannot handle either failure itself. So a command that reads files from untrusted sources runs in a
//! child process, and the parent reports how the child ended.

use crate::interrupt::is_ignored;
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
use zerorate_input::limits::{self, Bytes};

/// The environment variable that marks a child process.
const MARK: &str = "ZERORATE_CONFINED";

/// The environment variable with the settings of glibc's allocator. Other C libraries ignore it.
const TUNABLES: &str = "GLIBC_TUNABLES";
/// Uses large pages for large arrays. Otherwise, getting new memory takes longer than reading the file into it.
const LARGE_PAGES: &str = "glibc.malloc.hugetlb=1";

/// Memory of the program apart from the content of the files, bytes. It covers threads, tables and results.
const PROGRAM_BYTES: u64 = 256 << 20;

/// Exit code of a child process in which this program could not be started, if starting the child seemed to succeed,
/// as in QEMU's user mode. The program itself never exits with this code.
const NOT_STARTED: i32 = 127;

pub enum Role {
    /// This process runs the command.
    Worker,
    /// A child ran the command and ended with this code.
    Supervisor(ExitCode),
}

/// Runs the command line `args` in a child process, unless `files`, the untrusted files that it reads, is empty or
/// this process is that child.
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
        // without /proc, or if no process can be started, the command runs in this process
        _ => Role::Worker,
    }
}

fn limit(files: &[&Path]) -> Bytes {
    let sizes = files.iter().map(|path| on_disk::log_length(path)).fold(0, u64::saturating_add);
    Bytes(limits::for_size(sizes).saturating_add(PROGRAM_BYTES - limits::FREE_BYTES).min(limits::max_memory()))
}

/// Limits the memory of this process, turns off its core dump, and ends it when its parent ends. Private writable
/// memory counts. Address space that is reserved without access does not. If the limit cannot be set, the readers' own
/// limits still apply.
fn confine(Bytes(limit): Bytes) {
    let _ = setrlimit(Resource::Data, Rlimit { current: Some(limit), maximum: Some(limit) });
    let _ = setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) });
    let _ = set_parent_process_death_signal(Some(Signal::TERM));
}

/// Starts the child and waits for its end. The child has the standard streams of this process. The kernel sends Ctrl-C
/// to both processes, but the parent must pass on SIGINT and SIGTERM from other processes, and each SIGHUP, which the
/// kernel may send to the parent alone. The child starts before the handlers are installed, so that it ignores the
/// same signals as this process.
fn supervise(args: &[OsString]) -> io::Result<ExitStatus> {
    let (name, rest) = args.split_first().ok_or(io::ErrorKind::InvalidInput)?;
    let mut command = Command::new("/proc/self/exe");
    command.arg0(name).args(rest).env(MARK, "1");
    if std::env::var_os(TUNABLES).is_none() {
        command.env(TUNABLES, LARGE_PAGES);
    }
    let mut child = command.spawn()?;
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    let handled = [SIGINT, SIGTERM].into_iter().chain((!is_ignored(SIGHUP)).then_some(SIGHUP));
    if let (Some(pid), Ok(mut signals)) = (pid, SignalsInfo::<WithOrigin>::new(handled)) {
        thread::spawn(move || {
            for origin in signals.forever() {
                let passed_on = match origin.signal {
                    SIGHUP => Signal::HUP,
                    _ if origin.cause == Cause::Kernel => continue,
                    SIGINT => Signal::INT,
                    _ => Signal::TERM,
                };
                let _ = kill_process(pid, passed_on);
            }
        });
    }
    child.wait()
}

/// The exit code of the child. If a signal such as SIGKILL or SIGSEGV ended it, prints the probable reason.
fn ended(status: ExitStatus, files: &[&Path], limit: Bytes) -> ExitCode {
    match (status.code(), status.signal()) {
        (Some(code), _) => ExitCode::from(u8::try_from(code).unwrap_or(1)),
        (None, Some(signal @ (SIGHUP | SIGINT | SIGPIPE | SIGTERM))) => ExitCode::from(128 + signal as u8),
        (None, _) => {
            let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
            say(format_args!(
                "error: {}: reading it takes more memory than the limit of {limit} (--max-memory, and {} plus {} \
                 times the size of the file). The file is damaged or hostile; if it is neither, raise --max-memory",
                names.join(", "),
                Bytes(PROGRAM_BYTES),
                limits::FACTOR
            ));
            ExitCode::FAILURE
        }
    }
}
