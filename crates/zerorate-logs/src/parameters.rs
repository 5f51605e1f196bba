//! The parameters that a log of ArduPilot states.

use crate::dataflash::Messages;
use crate::error::Result;
use crate::open::{self, ARDUPILOT};
use std::collections::BTreeMap;
use std::path::Path;
use zerorate_input::Input;

/// The parameters of a log of ArduPilot, each with its first value. Empty for any other log.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn parameters(path: &Path, input: Input) -> Result<BTreeMap<String, f64>> {
    let mut found = BTreeMap::new();
    each(path, input, |name, value, _| {
        found.entry(name).or_insert(value);
        true
    })?;
    Ok(found)
}

/// Finds the first change of a parameter in a log of ArduPilot. Only parameters whose name `is_wanted` accepts count.
/// Returns the name, and the time of the change in s since the first of these parameters was logged. `None` without a
/// change, and for any other log.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn changed_parameter(
    path: &Path,
    input: Input,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<Option<(String, f64)>> {
    let (mut known, mut start_us, mut changed) = (BTreeMap::new(), None, None);
    each(path, input, |name, value, time_us| {
        if is_wanted(&name) {
            let since_s = (time_us - *start_us.get_or_insert(time_us)) * 1e-6;
            if known.insert(name.clone(), value).is_some_and(|before| before != value) {
                changed = Some((name, since_s));
            }
        }
        changed.is_none()
    })?;
    Ok(changed)
}

/// Calls `take` with the name, the value and the time, µs, of each parameter that is logged, until it returns false.
fn each(path: &Path, input: Input, mut take: impl FnMut(String, f64, f64) -> bool) -> Result<()> {
    let log = open::open(path, input)?;
    if !log.start.starts_with(&ARDUPILOT) {
        return Ok(());
    }
    Messages::new(path, log.input).all(|_, form, body| {
        let parameter = form.text("Name", body).zip(form.number("Value", body)).filter(|_| form.name == "PARM");
        parameter.is_none_or(|(name, value)| take(name, value, form.number("TimeUS", body).unwrap_or(0.0)))
    })?;
    Ok(())
}
