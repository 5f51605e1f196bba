//! Checks the readings of rows, then corrects the rates.

use zerorate::health::{Health, Judged};
use zerorate::{Axis, Correction, Corrector, MAX_AXES};
use zerorate_record::{Layout, Row};

/// Corrects the rows of a part. The corrected rates come two rows later, because the checks need two more rows.
#[derive(Clone, Debug)]
pub struct Correcting {
    layout: Layout,
    axes: Vec<(Axis, Health)>,
    corrector: Corrector<Vec<Correction>>,
}

impl Correcting {
    pub fn new(layout: &Layout, axes: &[Axis], corrector: Corrector<Vec<Correction>>) -> Self {
        let axes = axes.iter().map(|axis| (*axis, Health::new(axis))).collect();
        Self { layout: layout.clone(), axes, corrector }
    }

    /// Adds a row. Returns the corrected rates, °/s, of the row that was added two rows earlier. A rate is `None` if
    /// its reading is not valid, before the first temperature, or if there is no such axis.
    pub fn push(&mut self, row: &Row) -> Option<[Option<f64>; MAX_AXES]> {
        let mut judged: [Option<Judged>; MAX_AXES] = [None; MAX_AXES];
        for (index, ((_, health), judged)) in self.axes.iter_mut().zip(&mut judged).enumerate() {
            *judged = self.layout.reading(row, index).and_then(|reading| health.push(&reading));
        }
        let (first, (axis, _)) = (judged[0]?, self.axes.first()?);
        self.corrector.read(first.temp().map(|code| axis.temp.value(code.into())));
        let mut corrected_dps = [None; MAX_AXES];
        for (index, ((axis, _), judged)) in self.axes.iter().zip(&judged).enumerate() {
            let rate_dps = judged.and_then(|judged| judged.rate()).map(|code| axis.rate.value(code.into()));
            corrected_dps[index] = self.corrector.correct(index, rate_dps);
        }
        Some(corrected_dps)
    }

    /// Sets the last known temperature, °C, so that a correction can begin in the middle of a recording.
    pub fn begin_at(&mut self, temp_c: Option<f64>) {
        self.corrector.read(temp_c);
    }

    /// The last temperature that was read, °C; `None` before the first.
    pub fn temp_c(&self) -> Option<f64> {
        self.corrector.temp_c()
    }

    /// The correction of an axis at the last temperature, °/s; `None` before the first temperature.
    pub fn correction_dps(&self, axis: usize) -> Option<f64> {
        self.corrector.correct(axis, Some(0.0))
    }
}
