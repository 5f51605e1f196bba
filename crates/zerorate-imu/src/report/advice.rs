//! The advice that follows from a noise model, in words.

use crate::Record;
use zerorate_allan::{self as allan, Averaging, span};
use zerorate_logs::{Quantity, STANDARD_GRAVITY};

/// The advice of the fit, one sentence each. Empty for a rejected fit, and for a rate that follows the temperature.
pub fn advice(record: &Record) -> Vec<String> {
    let Some(advice) = record.model().and_then(allan::advice) else { return Vec::new() };
    let at_rest = |dev: f64| in_words(record, dev);
    let averaging = match advice.averaging {
        Averaging::Minimum { tau_s, dev } => format!(
            "To find the bias, average for about {}: the curve has its minimum there, {}; longer averages get \
             worse.",
            span(tau_s),
            at_rest(dev)
        ),
        Averaging::Flat { tau_s, dev } => format!(
            "To find the bias, average for about {}: {}; averaging longer gains less than 5 %.",
            span(tau_s),
            at_rest(dev)
        ),
        Averaging::Falling { tau_s, dev } => format!(
            "To find the bias, average as long as you can: the curve still falls at {}, {}.",
            span(tau_s),
            at_rest(dev)
        ),
    };
    let times = allan::AN1042_TAUS_S.into_iter().zip(advice.an1042).filter(|_| record.is_of_adis16130());
    let times = times.filter_map(|(tau_s, dev)| Some(format!("{tau_s} s give {}", at_rest(dev?))));
    let times = times.collect::<Vec<_>>().join(", ");
    let note = (!times.is_empty()).then(|| format!("AN-1042's averaging times: {times}."));
    std::iter::once(averaging).chain(note).collect()
}

fn in_words(record: &Record, dev: f64) -> String {
    match record.quantity {
        Some(Quantity::AngularRate) => format!("{dev:.3e} °/s ({:.3} °/h)", dev * 3600.0),
        Some(Quantity::Acceleration) => format!("{dev:.3e} m/s² ({:.3} µg)", dev / STANDARD_GRAVITY * 1e6),
        Some(Quantity::Temperature) => format!("{dev:.3e} °C"),
        None => format!("{dev:.3e}"),
    }
}
