//! The session behind the page, without a browser.

mod live;
#[cfg(feature = "readers")]
mod log;
mod session;
