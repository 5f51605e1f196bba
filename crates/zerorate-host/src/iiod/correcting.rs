//! Checks the readings of rows, then corrects the rates.

use zerorate::health::{Health, Judged};
use zerorate::{Axis, Correction, Corrector, MAX_AXES};
use zerorate_record::{Layout, Row};

/// Corrects the rows of a part. The corrected rates come two rows later, because the checks need two more rows.
#[derive(Clone, Debug)]
pub struct Correcting {
    layout: Layout,
    axes: Vec<(Axis, Health)>,
    pub corrector: Corrector<Vec<Correction>>,
}

impl Correcting {
    pub fn new(layout: &Layout, axes: &[Axis], corrector: Corrector<Vec<Correction>>) -> Self {
        let axes = axes.iter().map(|axis| (*axis, Health::new(axis))).collect();
        Self { layout: layout.clone(), axes, corrector }
    }

    /// Adds a row. Returns the corrected rates, °/s, of the row that was added two rows earlier, if any. A rate is
    /// `None` if its reading is not valid, before the first temperature, or if there is no such axis.
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
}
