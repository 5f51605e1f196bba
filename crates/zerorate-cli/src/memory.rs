//! The memory size of the machine.

use zerorate_input::limits::Bytes;

/// Half of the machine's memory: the default limit for reading files. `None` if the size of the memory is unknown.
pub fn half() -> Option<Bytes> {
    machine_bytes().map(|bytes| Bytes(bytes / 2))
}

/// The memory of the machine, or of the container if that is less.
#[cfg(target_os = "linux")]
fn machine_bytes() -> Option<u64> {
    let info = rustix::system::sysinfo();
    let all = (info.totalram as u64).saturating_mul(u64::from(info.mem_unit));
    let contained = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let contained = contained.and_then(|text| text.trim().parse().ok());
    Some(contained.map_or(all, |limit: u64| limit.min(all)))
}

#[cfg(not(target_os = "linux"))]
fn machine_bytes() -> Option<u64> {
    None
}
