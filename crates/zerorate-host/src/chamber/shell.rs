//! Runs a shell command of the user in its own process group, with limits on time and output.

use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

/// Largest number of bytes that are kept of each stream: the first of stdout, the last of stderr.
const KEPT: usize = 4096;
/// Largest number of characters of stderr that an error shows.
const SHOWN: usize = 200;
/// Longest time between two checks of the time limit.
const SLICE: Duration = Duration::from_millis(20);
/// Longest time for which the pipes are read after the end of the command. A child process may hold them open.
const AFTERMATH: Duration = Duration::from_secs(1);

#[derive(Debug, thiserror::Error)]
pub enum ShellError {
    #[error("the shell cannot be started: {0}")]
    Start(#[from] io::Error),
    #[error("{0}{1}")]
    Failed(ExitStatus, String),
    #[error("it did not end within {:.1} s, and was killed", .0.as_secs_f64())]
    Late(Duration),
}

/// Runs a command without input, and returns the first line of its stdout. `until` is called repeatedly and returns
/// the deadline, at which the command is killed, on Unix with its process group.
///
/// The command is not in the terminal's process group, so Ctrl-C does not reach it.
pub fn first_line(command: &str, mut until: impl FnMut() -> Instant) -> Result<String, ShellError> {
    let began = Instant::now();
    let mut child = shell(command).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let (chunks, mut output) = (chunks_of(&mut child)?, Output::default());
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if Instant::now() >= until() {
            kill(child);
            return Err(ShellError::Late(began.elapsed()));
        }
        match chunks.recv_timeout(SLICE) {
            Ok(chunk) => output.push(chunk),
            Err(RecvTimeoutError::Timeout) => {}
            // both pipes are closed, so wait until the command ends
            Err(RecvTimeoutError::Disconnected) => thread::sleep(Duration::from_millis(1)),
        }
    };
    let until = Instant::now() + AFTERMATH;
    while Instant::now() < until
        && let Ok(chunk) = chunks.recv_timeout(until.saturating_duration_since(Instant::now()))
    {
        output.push(chunk);
    }
    match status.success() {
        true => Ok(output.first_line()),
        false => Err(ShellError::Failed(status, output.last_line())),
    }
}

#[cfg(unix)]
fn shell(command: &str) -> Command {
    use std::os::unix::process::CommandExt;
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(command).process_group(0);
    shell
}

#[cfg(windows)]
fn shell(command: &str) -> Command {
    use std::os::windows::process::CommandExt;
    const CREATE_NEW_PROCESS_GROUP: u32 = 0x200;
    let mut shell = Command::new("cmd");
    shell.arg("/C").raw_arg(command).creation_flags(CREATE_NEW_PROCESS_GROUP);
    shell
}

fn kill(mut child: Child) {
    #[cfg(unix)]
    let _ =
        rustix::process::kill_process_group(rustix::process::Pid::from_child(&child), rustix::process::Signal::KILL);
    let _ = child.kill();
    // reaps the process in a thread, since the kernel may take a while
    let _ = thread::Builder::new().spawn(move || child.wait());
}

enum Chunk {
    Stdout(Vec<u8>),
    Stderr(Vec<u8>),
}

/// Reads stdout and stderr, each in its own thread. A thread ends when its pipe or the receiver is closed.
fn chunks_of(child: &mut Child) -> io::Result<Receiver<Chunk>> {
    let (sender, chunks) = mpsc::sync_channel(16);
    if let Some(pipe) = child.stdout.take() {
        forward(pipe, Chunk::Stdout, sender.clone())?;
    }
    if let Some(pipe) = child.stderr.take() {
        forward(pipe, Chunk::Stderr, sender)?;
    }
    Ok(chunks)
}

fn forward(
    mut pipe: impl Read + Send + 'static,
    chunk: fn(Vec<u8>) -> Chunk,
    chunks: SyncSender<Chunk>,
) -> io::Result<()> {
    let body = move || {
        let mut bytes = [0; KEPT];
        while let Ok(length @ 1..) = pipe.read(&mut bytes)
            && chunks.send(chunk(bytes[..length].to_vec())).is_ok()
        {}
    };
    thread::Builder::new().name("pipe".to_owned()).spawn(body).map(drop)
}

#[derive(Default)]
struct Output {
    stdout: Vec<u8>,
    stderr: Vec<u8>,
}

impl Output {
    fn push(&mut self, chunk: Chunk) {
        match chunk {
            Chunk::Stdout(bytes) => {
                let room = KEPT - self.stdout.len();
                self.stdout.extend(bytes.iter().take(room));
            }
            Chunk::Stderr(bytes) => {
                self.stderr.extend(bytes);
                let surplus = self.stderr.len().saturating_sub(KEPT);
                self.stderr.drain(..surplus);
            }
        }
    }

    fn first_line(&self) -> String {
        String::from_utf8_lossy(&self.stdout).lines().next().unwrap_or_default().trim().to_owned()
    }

    /// Returns `: ` and the start of the last non-blank line of stderr, or an empty text if there is none.
    fn last_line(&self) -> String {
        let text = String::from_utf8_lossy(&self.stderr);
        let line = text.lines().map(str::trim).rfind(|line| !line.is_empty());
        line.map_or(String::new(), |line| format!(": {}", line.chars().take(SHOWN).collect::<String>()))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn run(command: &str, limit_ms: u64) -> Result<String, String> {
        let until = Instant::now() + Duration::from_millis(limit_ms);
        first_line(command, || until).map_err(|error| error.to_string())
    }

    #[test]
    fn the_first_line_of_stdout_is_returned() {
        assert_eq!(run("echo ' 23.4 '; echo 5", 60_000), Ok("23.4".to_owned()));
        assert_eq!(run("true", 60_000), Ok(String::new()));
    }

    #[test]
    fn a_failed_command_is_reported_with_its_status_and_its_last_line() {
        let failed = run("printf 'first\\nno route\\n\\n' >&2; exit 3", 60_000);
        assert_eq!(failed, Err("exit status: 3: no route".to_owned()));
        assert_eq!(run("kill -9 $$", 60_000), Err("signal: 9 (SIGKILL)".to_owned()));
        assert!(run("no-such-program", 60_000).is_err_and(|why| why.contains("exit status: 127: ")));
    }

    #[test]
    fn any_amount_of_output_is_read_and_a_bounded_part_kept() {
        let flood = "yes 0123456789 | head -c 1000000";
        assert_eq!(run(&format!("{flood}; {flood} >&2; echo end >&2"), 60_000), Ok("0123456789".to_owned()));
        assert!(
            run(&format!("{flood} >&2; echo >&2; echo end >&2; false"), 60_000)
                .is_err_and(|why| why.ends_with("1: end"))
        );
    }

    #[test]
    fn a_command_that_hangs_is_killed_with_its_children() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("children");
        let command = format!("sleep 600 & echo $! $$ > {}; wait", file.display());
        let began = Instant::now();
        let until = || match std::fs::read_to_string(&file).is_ok_and(|text| text.ends_with('\n')) {
            true => began,
            false => began + Duration::from_secs(60),
        };
        assert!(matches!(first_line(&command, until), Err(ShellError::Late(_))));
        let pids = std::fs::read_to_string(&file).expect("two numbers");
        let alive =
            |pid: &str| std::fs::read_to_string(format!("/proc/{pid}/stat")).is_ok_and(|stat| !stat.contains(") Z"));
        while pids.split_whitespace().any(alive) {
            assert!(began.elapsed() < Duration::from_secs(60), "{pids} are alive");
            thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_process_that_is_left_behind_does_not_hold_up_the_result() {
        let began = Instant::now();
        assert_eq!(run("sleep 30 & echo 23.4", 60_000), Ok("23.4".to_owned()));
        assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
    }
}
