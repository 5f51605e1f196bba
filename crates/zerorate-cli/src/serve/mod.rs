//! The server of the live page. Separate threads read the device, record it, run the session, and talk to browsers and
//! to libiio clients. The recording gets every sample. A session that hangs misses samples of a real part. A slow
//! browser misses frames, and nothing waits for it.
//!
//! `session_thread.rs` owns the device (`device.rs`), its recordings (`recordings.rs`) and the calibrations on disk
//! (`folder.rs`). `server.rs` accepts connections, checks each request (`guard.rs`), and limits attempts to guess
//! the token (`trials.rs`). `watch.rs`, `page.rs` and `metrics.rs` answer requests, with `answer.rs`. `libiio.rs`
//! serves libiio clients.

mod answer;
mod bucket;
mod connection;
mod device;
mod folder;
mod guard;
mod libiio;
mod metrics;
mod page;
mod recordings;
mod server;
mod session_thread;
mod small_page;
mod trials;
mod watch;

pub use device::Opener;
pub use folder::Folder;
pub use guard::{Guard, Token};
pub use libiio::Libiio;
pub use page::is_there as has_page;
pub use recordings::Recordings;
pub use server::{EndsAll, run};
pub use session_thread::SessionThread;
