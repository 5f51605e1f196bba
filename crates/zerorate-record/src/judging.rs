//! Rows that are judged before they are used, and corrected where there is a correction.

use super::layout::Layout;
use super::row::Row;
use std::collections::VecDeque;
use zerorate::health::{Health, Judged};
use zerorate::{Axis, Correction, Corrector, MAX_AXES};

/// Judges the rows of a part: they come out in their order, two later.
#[derive(Clone, Debug)]
pub struct Judging {
    layout: Layout,
    axes: Vec<(Axis, Health)>,
    corrector: Option<Corrector<Vec<Correction>>>,
    waiting: VecDeque<Row>,
}

/// A row, with what of it is to be believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedRow {
    /// The row, untouched.
    pub row: Row,
    /// The rate of each axis as it was measured, °/s, if it is to be believed.
    pub rates_dps: [Option<f64>; MAX_AXES],
    /// The same, corrected; none before the first temperature, and without a correction.
    pub corrected_dps: [Option<f64>; MAX_AXES],
    /// The temperature, °C, if it was read with this row and is to be believed.
    pub temp_c: Option<f64>,
    /// The temperature that was read last, °C.
    pub last_temp_c: Option<f64>,
}

impl Judging {
    /// A judge for a part with these axes, before the first row.
    #[must_use]
    pub fn new(layout: &Layout, axes: &[Axis], corrector: Option<Corrector<Vec<Correction>>>) -> Self {
        let axes = axes.iter().map(|axis| (*axis, Health::new(axis))).collect();
        Self { layout: layout.clone(), axes, corrector, waiting: VecDeque::new() }
    }

    /// Takes a row in, and hands on the one two before it.
    pub fn push(&mut self, row: &Row) -> Option<JudgedRow> {
        self.waiting.push_back(*row);
        let mut judged = [None; MAX_AXES];
        for (index, ((_, health), judged)) in self.axes.iter_mut().zip(&mut judged).enumerate() {
            *judged = self.layout.reading(row, index).and_then(|reading| health.push(&reading));
        }
        self.hand_on(&judged)
    }

    /// The next of those that still wait: at the end.
    pub fn finish(&mut self) -> Option<JudgedRow> {
        let mut judged = [None; MAX_AXES];
        for ((_, health), judged) in self.axes.iter_mut().zip(&mut judged) {
            *judged = health.finish();
        }
        self.hand_on(&judged)
    }

    /// Begins in the middle of a recording: this temperature, °C, was read before, if one was.
    pub fn begin_at(&mut self, temp_c: Option<f64>) {
        if let Some(corrector) = &mut self.corrector {
            corrector.read(temp_c);
        }
    }

    /// The temperature, °C, that the corrector uses.
    #[must_use]
    pub fn temp_c(&self) -> Option<f64> {
        self.corrector.as_ref().and_then(Corrector::temp_c)
    }

    /// The correction of the rate of an axis at the temperature that was read last, °/s.
    #[must_use]
    pub fn correction_dps(&self, axis: usize) -> Option<f64> {
        self.corrector.as_ref()?.correct(axis, Some(0.0))
    }

    fn hand_on(&mut self, judged: &[Option<Judged>; MAX_AXES]) -> Option<JudgedRow> {
        let (first, (axis, _)) = (judged[0]?, self.axes.first()?);
        let row = self.waiting.pop_front()?;
        let temp_c = first.temp().map(|code| axis.temp.value(code.into()));
        if let Some(corrector) = &mut self.corrector {
            corrector.read(temp_c);
        }
        let last_temp_c = self.temp_c().or(temp_c);
        let (mut rates_dps, mut corrected_dps) = ([None; MAX_AXES], [None; MAX_AXES]);
        for (index, ((axis, _), judged)) in self.axes.iter().zip(judged).enumerate() {
            rates_dps[index] = judged.and_then(|judged| judged.rate()).map(|code| axis.rate.value(code.into()));
            corrected_dps[index] = self.corrector.as_ref().and_then(|it| it.correct(index, rates_dps[index]));
        }
        Some(JudgedRow { row, rates_dps, corrected_dps, temp_c, last_temp_c })
    }
}
