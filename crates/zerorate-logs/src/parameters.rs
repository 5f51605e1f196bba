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
    let log = open::open(path, input)?;
    let mut found = BTreeMap::new();
    if !log.start.starts_with(&ARDUPILOT) {
        return Ok(found);
    }
    Messages::new(path, log.input).all(|_, form, body| {
        if form.name == "PARM"
            && let Some((name, value)) = form.text("Name", body).zip(form.number("Value", body))
        {
            found.entry(name).or_insert(value);
        }
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
    let log = open::open(path, input)?;
    if !log.start.starts_with(&ARDUPILOT) {
        return Ok(None);
    }
    let (mut known, mut start_us, mut changed) = (BTreeMap::new(), None, None);
    Messages::new(path, log.input).all(|_, form, body| {
        if form.name == "PARM"
            && let Some((name, value)) = form.text("Name", body).zip(form.number("Value", body))
            && is_wanted(&name)
        {
            let time_us = form.number("TimeUS", body).unwrap_or(0.0);
            let since_s = (time_us - *start_us.get_or_insert(time_us)) * 1e-6;
            if known.insert(name.clone(), value).is_some_and(|before| before != value) {
                changed = Some((name, since_s));
            }
        }
        changed.is_none()
    })?;
    Ok(changed)
}
