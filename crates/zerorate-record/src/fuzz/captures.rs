//! Damaged captures in every format.

use super::edited;
use crate::tests::FORMATS;
use crate::{CaptureReader, Format, axes, tests as forms};
use std::path::Path;

/// Reads damaged content. Samples must be in order of time, whatever the content.
fn read(bytes: &[u8]) {
    let Ok(mut reader) = CaptureReader::open(Path::new("edited"), bytes.to_vec().into()) else { return };
    let samples: Vec<_> = reader.by_ref().map_while(Result::ok).collect();
    assert!(samples.is_sorted_by(|one, next| one.t_ns < next.t_ns));
    let _ = reader.warnings();
}

/// Captures with three axes of signed codes.
#[test]
fn axes() {
    let seeds: Vec<Vec<u8>> = FORMATS.iter().map(|form| axes::bytes(*form, 30)).collect();
    edited(700, &seeds, read);
}

fn seed(format: Format) -> Vec<Vec<u8>> {
    vec![forms::bytes(format, 40), forms::bytes(format, 0)]
}

#[test]
fn arrows() {
    edited(700, &seed(Format::Arrows), read);
}

#[cfg(feature = "parquet")]
#[test]
fn parquet() {
    edited(500, &seed(Format::Parquet), read);
}

#[test]
fn csv() {
    edited(700, &seed(Format::Csv), read);
}
