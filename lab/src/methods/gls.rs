//! The estimate of `calibrate --method warmup` and `cycle`, from blocks of means. Steps of the bias are not detected,
//! because none occur here.

use super::comparison::MethodResult;
use super::unit::Recording;
use zerorate::Axis;
use zerorate::temperature::{self, Assumed};

const MAX_ORDER: usize = 3;

pub fn fit(recording: &Recording) -> Option<MethodResult> {
    let blocks = recording.blocks();
    let axis = Axis::ADIS16130;
    let assumed = Assumed {
        axis: &axis,
        white_dps_per_rt_hz: axis.noise?.white_dps_per_rt_hz,
        gauss_markov: &[],
        steps_s: &[],
        motions_hz: &[],
        max_order: MAX_ORDER,
        t3_c: blocks.last()?.temp_c,
    };
    temperature::fit(&blocks, &assumed).ok().map(MethodResult::from)
}
