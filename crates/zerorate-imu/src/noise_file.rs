//! Writes the noise file for a filter, or reports why it cannot.

use super::numbers::Numbers;
use super::{Axis, Format, Kind, NoiseFileOptions, Rejections, Rule};

/// The reason why a noise file cannot be written.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NoNoiseFile {
    /// No column is an axis.
    #[error("no column is stated to be an axis of a gyroscope or an accelerometer")]
    NoAxis,
    /// The factor on all noise is not a number above zero.
    #[error("the factor on all noise must be a number above zero")]
    Inflate(f64),
    /// The horizon is longer than the models cover. The number is the longest horizon of all axes, s.
    #[error("the horizon is longer than half of the record: give at most {0} s, or record for longer")]
    Horizon(f64),
    /// The noise models are missing or rejected.
    #[error("{0}")]
    Rejected(Rejections),
    /// The format needs three axes of each kind, and this kind has another number.
    #[error("{count} {kind} {axes}, and {reader} takes three; choose three",
        kind = .0.name(), count = .1, axes = if *.1 == 1 { "axis" } else { "axes" }, reader = .2.reader())]
    NotThree(Kind, usize, Format),
}

impl Format {
    /// Checks that each kind has three axes or none, if the format has a number for each axis.
    ///
    /// # Errors
    /// Returns `NotThree` for a kind with another number of axes.
    pub fn check(self, axes: impl Iterator<Item = Kind> + Clone) -> Result<(), NoNoiseFile> {
        for kind in Kind::ALL {
            let count = axes.clone().filter(|of| *of == kind).count();
            if self.is_by_axis() && !matches!(count, 0 | 3) {
                return Err(NoNoiseFile::NotThree(kind, count, self));
            }
        }
        Ok(())
    }

    /// The text of the noise file. With `accept_rejected`, the models may be rejected, and the noise file says so.
    ///
    /// # Errors
    /// Returns the reason why no file can be written.
    pub fn file(
        self,
        choice: NoiseFileOptions,
        axes: &[Axis<'_>],
        doubts: &Rejections,
        accept_rejected: bool,
    ) -> Result<String, NoNoiseFile> {
        if !(choice.inflate > 0.0 && choice.inflate.is_finite()) {
            return Err(NoNoiseFile::Inflate(choice.inflate));
        }
        if !doubts.allow(accept_rejected) {
            return Err(NoNoiseFile::Rejected(doubts.clone()));
        }
        if axes.is_empty() {
            return Err(NoNoiseFile::NoAxis);
        }
        self.check(axes.iter().map(|axis| axis.kind))?;
        let longest_s = axes.iter().map(|axis| axis.fit.span_s.1).fold(f64::INFINITY, f64::min);
        if matches!(choice.rule, Rule::Covers(Some(horizon_s)) if horizon_s > longest_s) {
            return Err(NoNoiseFile::Horizon((10.0 * longest_s).floor() / 10.0));
        }
        Ok(self.text(&Numbers::new(choice, self.usage(), doubts, axes)))
    }
}
