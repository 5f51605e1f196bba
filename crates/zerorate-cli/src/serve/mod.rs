//! The live page. One thread reads the device, one keeps the session of the page, and one talks to browsers. The
//! session gets every sample. Browsers get what they can take, and nothing waits for them.
//!
//! `session_thread.rs` has the device (`device.rs`), its recordings (`recordings.rs`) and the calibrations on disk
//! (`folder.rs`). `server.rs` accepts connections, checks each request with the guard (`guard.rs`), and counts the
//! tokens that are tried (`trials.rs`). `watch.rs`, `page.rs` and `metrics.rs` answer requests, in the form of
//! `answer.rs`. `libiio.rs` serves other clients.

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
pub use page::{absent, is_there as has_page};
pub use recordings::Recordings;
pub use server::{EndsAll, run};
pub use session_thread::SessionThread;
