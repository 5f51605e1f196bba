//! The statements of the module's documentation about the loop, measured on synthetic edges and compared with the
//! formulas of a loop in continuous time.

extern crate std;

use super::{EdgeGrid, FIRST_GEAR, FRACTION_BITS, Grip, LOOP_GEAR, Pattern, TOP_GEAR, Timeline};
use crate::sample::Edge;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, TAU};

/// Time of a rate and a temperature conversion, 527 cycles each at 6.000 MHz (F-31), in ns.
const PERIOD_NS: f64 = 1054.0 / 6e6 * 1e9;

/// A timeline that is fed edges, each one period of the clock after the one before.
struct Bench {
    timeline: Timeline,
    seq: u32,
    /// Time of the next edge, ns.
    t_ns: f64,
    period_ns: f64,
}

impl Bench {
    /// A timeline whose edges come from a clock that is slow by this many millionths.
    fn new(ppm: f64) -> Self {
        let timeline = Timeline::new(EdgeGrid::new((527, 527), 6_000_000, Pattern::Steady));
        Self { timeline, seq: 0, t_ns: 1e9, period_ns: PERIOD_NS * (1.0 + ppm * 1e-6) }
    }

    /// A timeline in this gear, after 5000 edges, so that nothing is left of its start.
    fn in_gear(gear: u32) -> Self {
        let mut bench = Self::new(0.0);
        (0..5_000).for_each(|_| bench.step(0.0));
        assert_eq!(bench.timeline.gear, TOP_GEAR);
        bench.timeline.gear = gear;
        bench
    }

    fn step(&mut self, late_ns: f64) {
        let t_ns = (self.t_ns + late_ns).round() as u64;
        self.timeline.advance(Edge { t_ns, seq: self.seq });
        self.seq += 1;
        self.t_ns += self.period_ns;
    }

    /// Takes an edge as [`step`](Self::step) does, but stays in the present gear.
    fn stay(&mut self, late_ns: f64) {
        let gear = self.timeline.gear;
        self.step(late_ns);
        self.timeline.gear = gear;
    }

    /// The error that the edge just taken had, ns: the loop has taken α of it.
    fn error_ns(&self) -> f64 {
        let left = (self.timeline.since_tick - self.timeline.temp) as f64 / f64::from(1 << FRACTION_BITS);
        left / (1.0 - alpha(self.timeline.gear))
    }

    fn period_error_ns(&self) -> f64 {
        self.timeline.period_ns() - self.period_ns
    }
}

fn alpha(gear: u32) -> f64 {
    0.5_f64.powi(gear as i32)
}

/// A standard normal number, as the sum of twelve uniform ones from a linear congruential generator.
fn normal(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) as f64 / 2_f64.powi(31)
    };
    (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

fn assert_near(measured: f64, claimed: f64, tolerance: f64, what: &str) {
    let ratio = measured / claimed;
    assert!((ratio - 1.0).abs() < tolerance, "{what}: {measured:e} instead of {claimed:e}");
}

/// Amplitude of the loop's error per amplitude of a sinusoidal wander of the edges, of `omega` rad per edge. Computed
/// from the correlation with the wander over whole turns.
fn error_of_wander(gear: u32, omega: f64) -> f64 {
    const WANDER_NS: f64 = 30_000.0;
    let mut bench = Bench::in_gear(gear);
    let turn = TAU / omega;
    let settled = (turn.max(20.0 / alpha(gear)) / turn).ceil() * turn;
    let turns = (20_000.0 / turn).ceil() * turn;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for k in 0..(settled + turns) as u32 {
        let phase = omega * f64::from(k);
        bench.stay(WANDER_NS * phase.sin());
        if f64::from(k) >= settled {
            sine += bench.error_ns() * phase.sin();
            cosine += bench.error_ns() * phase.cos();
        }
    }
    2.0 * sine.hypot(cosine) / turns / WANDER_NS
}

#[test]
fn natural_frequency_and_damping_are_those_of_the_gear() {
    for gear in [7, TOP_GEAR] {
        let natural = alpha(gear) * FRAC_1_SQRT_2;
        // |s²/(s² + 2ζω_n·s + ω_n²)|, which is 1/(2ζ), ζ = 1/√2, at ω_n and has no peak above
        let theory = |relative: f64| {
            let square = relative * relative;
            square / (1.0 - square).hypot(std::f64::consts::SQRT_2 * relative)
        };
        assert_near(theory(1.0), FRAC_1_SQRT_2, 1e-9, "the formula");
        for (relative, claimed) in [(1.0, FRAC_1_SQRT_2), (0.1, 0.01), (0.3, theory(0.3)), (3.0, theory(3.0))] {
            let measured = error_of_wander(gear, relative * natural);
            assert_near(measured, claimed, 0.02, &std::format!("gear {gear}, {relative} of ω_n"));
        }
    }
    // 5693 edges a second (F-31)
    let hz = |gear| alpha(gear) * FRAC_1_SQRT_2 / TAU * 1e9 / PERIOD_NS;
    assert_near(hz(LOOP_GEAR), 20.0, 0.005, "gear 5 in Hz");
    assert_near(hz(TOP_GEAR), 0.63, 0.02, "gear 10 in Hz");
}

#[test]
fn edges_of_both_kinds_teach_the_period_and_the_place_of_the_temperature() {
    for (temp_cycles, fast) in [(527, 1.019), (2_319, 0.981)] {
        let mut timeline = Timeline::new(EdgeGrid::new((527, temp_cycles), 6_000_000, Pattern::Each));
        let [rate_ns, temp_ns] = [527, temp_cycles].map(|cycles| f64::from(cycles) / 6e-3 / fast);
        let (mut t_ns, mut seq) = (1e9, 0);
        for _ in 0..200 {
            for gap_ns in [temp_ns, rate_ns] {
                timeline.advance(Edge { t_ns: t_ns as u64, seq });
                (t_ns, seq) = (t_ns + gap_ns, seq + 1);
            }
        }
        assert_near(timeline.period_ns(), rate_ns + temp_ns, 1e-4, "the period");
        assert_near(timeline.temp as f64 / f64::from(1 << FRACTION_BITS), temp_ns, 2e-3, "the place");
    }
}

#[test]
fn a_bounce_of_data_ready_is_not_a_conversion_of_one_channel() {
    let grid = EdgeGrid::new((527, 0), 6_000_000, Pattern::Each);
    let period = grid.clamped(0) / 15 * 16;
    assert_eq!(grid.nearest_gap((period, 0), period / 8).0, period);
}

#[test]
fn a_step_of_the_period_dies_down_as_claimed() {
    for gear in [6, 8, TOP_GEAR] {
        let mut bench = Bench::in_gear(gear);
        let step_ns = PERIOD_NS * 0.1 * alpha(gear);
        bench.period_ns += step_ns;
        let (mut largest, mut at) = (0.0, 0);
        for n in 1..(8.0 / alpha(gear)) as u32 {
            bench.stay(0.0);
            if bench.error_ns() > largest {
                (largest, at) = (bench.error_ns(), n);
            }
            let x = alpha(gear) * f64::from(n) / 2.0;
            let left = (-x).exp() * (x.cos() + x.sin());
            let measured = -bench.period_error_ns() / step_ns;
            assert!(
                (measured - left).abs() < 2.0 * alpha(gear),
                "gear {gear}, {n} edges: {measured} instead of {left}"
            );
        }
        let claimed = 2.0 * (-FRAC_PI_4).exp() * FRAC_PI_4.sin();
        assert_near(claimed, 0.645, 1e-3, "the formula");
        assert_near(largest, claimed * step_ns / alpha(gear), 0.02, "the largest error");
        assert_near(f64::from(at), TAU / 4.0 / alpha(gear), 0.03, "its edge");
    }
    assert_near(TAU / 4.0 / alpha(LOOP_GEAR), 50.0, 0.01, "gear 5");
    assert_near(TAU / 4.0 / alpha(TOP_GEAR), 1_608.0, 0.001, "gear 10");
    assert_near((-2_f64).exp() * (2_f64.cos() + 2_f64.sin()), 0.07, 0.05, "what is left after 4/α edges");
}

#[test]
fn the_noise_of_the_period_is_as_claimed() {
    const JITTER_NS: f64 = 15_000.0;
    for (gear, claimed) in [(LOOP_GEAR, 1.0 / 512.0), (8, (alpha(8).powi(3) / 8.0).sqrt()), (TOP_GEAR, 1.0 / 92_682.0)]
    {
        let (mut sum, mut count) = (0.0, 0);
        for seed in 0..8 {
            let mut bench = Bench::in_gear(gear);
            let mut state = 7 + seed;
            let settled = (16.0 / alpha(gear)) as u32;
            for k in 0..settled + 60_000 {
                bench.stay(JITTER_NS * normal(&mut state));
                if k >= settled {
                    sum += bench.period_error_ns().powi(2);
                    count += 1;
                }
            }
        }
        // 480 000 edges are only some 120 times 4/α in gear 10, so the noise measured there is good to some 8 %
        let tolerance = 0.05 + 4.0 * alpha(gear).sqrt();
        assert_near((sum / f64::from(count)).sqrt(), JITTER_NS * claimed, tolerance, &std::format!("gear {gear}"));
    }
    assert_near(JITTER_NS / 92_682.0 / PERIOD_NS, 0.92e-6, 0.01, "1 part in 10⁶");
}

#[test]
fn the_gaps_give_the_period_before_the_loop_does() {
    let noise_ns = |jitter_ns: f64| {
        let (mut sum, runs) = (0.0, 400);
        for seed in 0..runs {
            let mut bench = Bench::new(10_000.0);
            let mut state = 99 + seed;
            while bench.timeline.gear < LOOP_GEAR {
                bench.step(jitter_ns * normal(&mut state));
            }
            assert!((129..140).contains(&bench.seq), "{} edges", bench.seq);
            sum += bench.period_error_ns().powi(2);
        }
        (sum / runs as f64).sqrt()
    };
    assert_near(noise_ns(8_000.0), 8_000.0 * 2_f64.sqrt() / 128.0, 0.1, "the two ends of 128 gaps in a row");
    assert_near(noise_ns(15_000.0), 15_000.0 / 64.0, 0.1, "where some gaps are left out");
}

#[test]
fn the_last_gear_begins_after_4096_edges() {
    let mut bench = Bench::new(0.0);
    while bench.timeline.gear < TOP_GEAR {
        bench.step(0.0);
    }
    assert_eq!(bench.seq, 1 + 128 + 3_968);
    assert_near(f64::from(bench.seq) * PERIOD_NS * 1e-9, 0.72, 0.005, "in s");
}

#[test]
fn the_lock_range_is_a_sixteenth() {
    for ppm in [-62_000.0, -20_000.0, 20_000.0, 62_000.0] {
        let mut bench = Bench::new(ppm);
        for k in 0..8_192 {
            bench.step(0.0);
            if (2..16).contains(&k) {
                let limit_ns = PERIOD_NS / 8.0 + 1.0;
                assert!(bench.error_ns().abs() < limit_ns, "{ppm} ppm: {} ns in gear 1", bench.error_ns());
            }
        }
        assert!((bench.period_error_ns() / bench.period_ns).abs() < 2e-7, "{ppm} ppm");
        assert_eq!((bench.timeline.grip, bench.timeline.ticks), (Grip::Firm, 8_191), "{ppm} ppm");
    }
    for ppm in [-64_000.0, 64_000.0, 100_000.0] {
        let mut bench = Bench::new(ppm);
        (0..8_192).for_each(|_| bench.step(0.0));
        let period_ns = bench.timeline.period_ns();
        assert!((period_ns / PERIOD_NS - 1.0).abs() <= 1.0 / 16.0 + 1e-9, "{ppm} ppm: {period_ns} ns");
    }
}

#[test]
fn edges_that_lie_anywhere_are_found_out_and_the_nominal_period_holds() {
    let mut bench = Bench::new(0.0);
    let mut state = 5;
    (0..4_096).for_each(|_| bench.step(0.0));
    for _ in 0..3 * 256 {
        bench.step(normal(&mut state) * PERIOD_NS);
    }
    assert!(matches!(bench.timeline.grip, Grip::Held(_)), "{:?}", bench.timeline.grip);
    assert_near(bench.timeline.period_ns(), PERIOD_NS, 1e-9, "held");
    // the nominal period holds for 17 checks, and one more check confirms what was learned
    (0..19 * 256).for_each(|_| bench.step(0.0));
    assert_eq!(bench.timeline.grip, Grip::Firm);
    assert!(bench.timeline.gear > FIRST_GEAR);
}

#[test]
fn the_period_carries_the_phase_over_4_by_alpha_periods() {
    const JITTER_NS: f64 = 15_000.0;
    let (mut sum, runs) = (0.0, 600);
    for seed in 0..runs {
        let mut bench = Bench::in_gear(LOOP_GEAR);
        let mut state = 1_234 + seed;
        (0..512).for_each(|_| bench.stay(JITTER_NS * normal(&mut state)));
        let drift = bench.period_error_ns() * 4.0 / alpha(LOOP_GEAR);
        sum += drift * drift;
    }
    let claimed = JITTER_NS * (2.0 * alpha(LOOP_GEAR)).sqrt();
    assert_near((sum / runs as f64).sqrt(), claimed, 0.1, "σ·√(2α)");
}

#[test]
fn a_divided_period_is_the_mean_of_the_gaps() {
    const JITTER_NS: f64 = 15_000.0;
    // every 50th edge is 51 conversions after the one before: 25.5 periods (F-56)
    for ppm in [-20_000.0, 20_000.0] {
        let mut bench = Bench::new(ppm);
        bench.timeline = Timeline::new(EdgeGrid::new((527, 527), 6_000_000, Pattern::Mixed).divided(51, 2));
        bench.period_ns *= 25.5;
        let (mut state, mut sum) = (3, 0.0);
        for k in 0..40_000 {
            bench.step(JITTER_NS * normal(&mut state));
            if k >= 20_000 {
                sum += bench.period_error_ns().powi(2);
            }
        }
        assert_eq!((bench.timeline.gear, bench.timeline.ticks), (LOOP_GEAR, 39_999));
        let noise_ns = (sum / 20_000.0).sqrt();
        assert_near(noise_ns, JITTER_NS / 2_048.0, 0.1, &std::format!("{ppm} ppm"));
    }
}
