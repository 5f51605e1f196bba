//! Feeds damaged logs to every reader: none may panic, and none may keep more than the input's memory limit. The
//! harness comes from `zerorate-record`, whose comments say how to replay a failure.

#[path = "../../../zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[cfg(feature = "full")]
mod forms;
#[path = "../../../zerorate-record/src/fuzz/harness.rs"]
mod harness;
mod logs;

use harness::edited;
