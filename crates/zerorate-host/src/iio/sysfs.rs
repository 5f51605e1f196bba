//! Reads and writes a device's attributes in sysfs.

use anyhow::{Context, Result};
use std::fs;
use std::path::Path;
use std::str::FromStr;

pub fn read<T: FromStr<Err: std::error::Error + Send + Sync + 'static>>(folder: &Path, name: &str) -> Result<T> {
    let text = read_text(folder, name)?;
    text.parse().with_context(|| format!("{}/{name} reads {text:?}", folder.display()))
}

/// Reads and parses the first of these attributes that exists; `None` if none does.
pub fn first<T: FromStr<Err: std::error::Error + Send + Sync + 'static>>(
    folder: &Path,
    names: &[&str],
) -> Result<Option<T>> {
    let found = names.iter().find(|name| folder.join(name).exists());
    found.map(|name| read(folder, name)).transpose()
}

pub fn read_text(folder: &Path, name: &str) -> Result<String> {
    let path = folder.join(name);
    let text = fs::read_to_string(&path).with_context(|| {
        format!("reading {}: was the part unplugged, or its driver unbound? (ls /sys/bus/iio/devices)", path.display())
    })?;
    Ok(text.trim().to_owned())
}

pub fn write(folder: &Path, name: &str, value: &str) -> Result<()> {
    let path = folder.join(name);
    fs::write(&path, value).with_context(|| {
        format!(
            "writing {value} to {}: run it as root, or poll with ?hz=N, which only reads; another program may hold \
             the buffer, too",
            path.display()
        )
    })
}
