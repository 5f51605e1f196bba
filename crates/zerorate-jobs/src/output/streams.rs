//! The files and pipes behind the standard streams, since an output path may lead to one of them.

use super::identity::Identity;
#[cfg(unix)]
use std::io;
#[cfg(unix)]
use std::path::Path;

/// The name of stdout in messages.
pub const STDOUT: &str = "stdout";

/// The regular files to which stdout and stderr are redirected, each with the name of its stream.
#[cfg(unix)]
pub fn files() -> Vec<(Identity, &'static str)> {
    let streams = [(metadata(io::stdout()), STDOUT), (metadata(io::stderr()), "stderr")];
    let file = |(metadata, name): (Option<std::fs::Metadata>, _)| {
        Some((Identity::of(&metadata.filter(std::fs::Metadata::is_file)?, Path::new(name))?, name))
    };
    streams.into_iter().filter_map(file).collect()
}

/// The pipe or socket behind stdout; `None` if stdout is something else.
#[cfg(unix)]
pub fn stdout_pipe() -> Option<Identity> {
    super::place::pipe(&metadata(io::stdout())?, Path::new(STDOUT))
}

/// The regular file behind stdin; `None` if stdin is something else.
#[cfg(unix)]
pub fn stdin_file() -> Option<Identity> {
    Identity::of(&metadata(io::stdin()).filter(std::fs::Metadata::is_file)?, Path::new("stdin"))
}

#[cfg(unix)]
fn metadata(stream: impl std::os::fd::AsFd) -> Option<std::fs::Metadata> {
    let owned = stream.as_fd().try_clone_to_owned().ok()?;
    std::fs::File::from(owned).metadata().ok()
}

/// On systems other than Unix, standard streams are not compared with files.
#[cfg(not(unix))]
pub fn files() -> Vec<(Identity, &'static str)> {
    Vec::new()
}

#[cfg(not(unix))]
pub fn stdout_pipe() -> Option<Identity> {
    None
}

#[cfg(not(unix))]
pub fn stdin_file() -> Option<Identity> {
    None
}
