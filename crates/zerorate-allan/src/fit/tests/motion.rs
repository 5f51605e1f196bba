//! Tests the detection of motion that several axes show at the same moment.

use super::*;

#[test]
fn axes_that_jump_together_are_motion() {
    let with_step = |at: usize, seed| {
        let mut rate = Truth { n: 0.01, ..Truth::default() }.noise(100_000, seed);
        rate[at..].iter_mut().for_each(|rate| *rate += 0.05);
        of(&rate)
    };
    let fits = [with_step(30_000, 80), with_step(36_000, 81), with_step(30_010, 82)];
    let [found] = &motion(&fits.each_ref())[..] else { panic!("{:?}", motion(&fits.each_ref())) };
    assert!(found.axes == [0, 2] && (found.at_s - 300.0).abs() < 1.0, "{found:?}");
    assert_eq!(found.kind, MotionKind::Jump);
}

/// Two axes share a knock and have a bit error each. Many bit errors on both axes coincide by chance, without motion.
#[test]
fn glitches_that_fall_together_are_a_knock() {
    let with_glitches = |at: &[usize], seed| {
        let mut rate = Truth { n: 0.01, ..Truth::default() }.noise(100_000, seed);
        at.iter().for_each(|&at| rate[at] += 10.0);
        of(&rate)
    };
    let fits = [with_glitches(&[10_000, 50_000], 83), with_glitches(&[50_002, 70_000], 84)];
    assert_eq!(fits[0].cleaned.glitches_s, [100.0, 500.0]);
    let [found] = &motion(&fits.each_ref())[..] else { panic!("{:?}", motion(&fits.each_ref())) };
    assert!(found.axes == [0, 1] && (found.at_s - 500.01).abs() < 1e-6, "{found:?}");
    assert_eq!(found.kind, MotionKind::Knock);
    let mut draw = uniform(85);
    let mut many = || (0..300).map(|_| (draw() * 99_999.0) as usize).collect::<Vec<_>>();
    let fits = [with_glitches(&many(), 86), with_glitches(&many(), 87)];
    assert_eq!(motion(&fits.each_ref()), []);
}
