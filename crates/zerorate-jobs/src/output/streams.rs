//! The standard streams, where they are files or pipes: an output may be one of them by another name.

use super::identity::Identity;
#[cfg(unix)]
use std::io;
#[cfg(unix)]
use std::path::Path;

/// The name of stdout in messages.
pub const STDOUT: &str = "stdout";

/// The standard streams that go into regular files, by name.
#[cfg(unix)]
pub fn files() -> Vec<(Identity, &'static str)> {
    let streams = [(metadata(io::stdout()), STDOUT), (metadata(io::stderr()), "stderr")];
    let file = |(metadata, name): (Option<std::fs::Metadata>, _)| {
        Some((Identity::of(&metadata.filter(std::fs::Metadata::is_file)?, Path::new(name))?, name))
    };
    streams.into_iter().filter_map(file).collect()
}

/// The pipe that stdout goes into.
#[cfg(unix)]
pub fn stdout_pipe() -> Option<Identity> {
    super::place::pipe(&metadata(io::stdout())?, Path::new(STDOUT))
}

/// The file that comes in through stdin, where it is one.
#[cfg(unix)]
pub fn stdin_file() -> Option<Identity> {
    Identity::of(&metadata(io::stdin()).filter(std::fs::Metadata::is_file)?, Path::new("stdin"))
}

#[cfg(unix)]
fn metadata(stream: impl std::os::fd::AsFd) -> Option<std::fs::Metadata> {
    let owned = stream.as_fd().try_clone_to_owned().ok()?;
    std::fs::File::from(owned).metadata().ok()
}

/// On other systems the streams have no names as files.
#[cfg(not(unix))]
pub fn files() -> Vec<(Identity, &'static str)> {
    Vec::new()
}

/// On other systems the streams have no names as files.
#[cfg(not(unix))]
pub fn stdout_pipe() -> Option<Identity> {
    None
}

/// On other systems the streams have no names as files.
#[cfg(not(unix))]
pub fn stdin_file() -> Option<Identity> {
    None
}
