//! Detection of readings that the part cannot have made. A bit error on the bus changes one reading, and a part with a
//! bandwidth of 300 Hz cannot jump and come back within one sample. The code uses integers only, bounded memory, and
//! two samples of look-ahead.
//!
//! # Strict rule
//!
//! Let y₋₂ … y₂ be five readings in a row, at a distance of T, with no loss between them. The reading y₀ is impossible
//! if
//!
//! L = |y₀ − (4·(y₋₁ + y₁) − (y₋₂ + y₂))/6| > Θ(T), where Θ(T) = 1.15 °/s · r + 0.35 °/s · r⁴, r = T/175.7 µs, for the
//! ADIS16130,
//!
//! and L also exceeds two other numbers. One is the roughness of the four neighbours: the larger of |y₂ − 2y₁ + 2y₋₁ −
//! y₋₂| and |y₂ − y₁ − y₋₁ + y₋₂|. The other is four times the largest L of earlier readings, which fades by 1/32 with
//! each reading. The L of an impossible reading counts half, for the next seven.
//!
//! * Noise: white noise of F-02 behind the poles of F-03 gives L a standard deviation of 0.064 °/s at 175.7 µs. At
//!   1.5, 2 and 3 times that period it is 0.104, 0.141 and 0.202 °/s. The resonance of M-08 adds an amplitude of at
//!   most 0.075 °/s. Even at three times this noise and resonance, Θ lies 6.6 deviations out, which is less than one
//!   false mark in 2·10¹⁰ readings (40 days). At the noise of F-02 it lies 22 deviations out, so there are no false
//!   marks in practice.
//! * Motion: a sine of frequency f and amplitude A shows L = A·|H(f)|·(8/3)·sin⁴(πfT), with the poles H of F-03.
//!   For 250 °/s (F-08) at the bandwidth of 300 Hz this is 0.35 °/s, the second term of Θ. So no motion within
//!   range and bandwidth is ever marked, nor any other with an angular acceleration below 43 000 °/s². A hard
//!   shock or a vibration above 1 kHz (0.5 kHz at a third of the full rate) may cost one or two marks where it
//!   begins. After that the readings around it are rough too, so nothing is marked.
//! * Limits: an error smaller than Θ, 1.5 °/s at the full rate, is not found. The same is true of an error that comes
//!   together with such a shock, or with another error of the same size within two samples.
//!
//! # Loose rule
//!
//! This rule holds next to a loss, at either end of a record, and for readings more than 0.6 ms apart. There a
//! reading is impossible if it cannot be reached from either of two neighbours. The response of the two poles
//! (F-03) to any input within ±250 °/s (F-08) moves by no more than 2 · 250 °/s · 1194/s · t in a time t, 105 °/s
//! in a sample. 1194/s is the largest value of their impulse response, at 0.26 ms. For readings more than 1.2 ms
//! apart this is more than the whole scale, and the reading is *unjudged*.
//!
//! A single reading out of range is impossible too, if the end of the range cannot be reached from its neighbours.
//!
//! # Temperatures
//!
//! A temperature is impossible if it differs from each of the last two good ones by more than 1 °C plus 2 °C for each
//! second between them. By M-05, a reading has a noise of 0.053 °C, so 1 °C is 13 deviations of a difference, and F-55
//! expects up to 1 °C/s. If a second such temperature in a row agrees with the first, it is valid. The very first
//! temperature is impossible if the next two temperatures agree with each other and not with it. If they
//! have none, because not every reading has a temperature, the very first is valid, and a next one that differs is
//! impossible.

use crate::part::{Axis, Reading};
use core::num::NonZeroU64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limits {
    /// Noise part of Θ, 2⁻¹⁶ codes per µs.
    noise_per_us_q16: u64,
    /// Period of the readings below which the noise part of Θ is constant, µs. A part that converts only its rate
    /// has a shorter period.
    least_us: u64,
    /// Divisor of the fourth power of the period in the motion part of Θ, µs⁴ per code.
    motion_us4_per_code: NonZeroU64,
    /// Readings farther apart than this are judged by the loose rule, µs.
    longest_strict_us: u64,
    /// Slew limit of the loose rule, codes per µs.
    slew_codes_per_us: u64,
    /// Difference that the loose rule allows for noise, codes.
    slew_noise_codes: u64,
    span_codes: u64,
}

impl Limits {
    /// Scales the numbers of the ADIS16130 (1.15 °/s and 0.35 °/s at 175.7 µs, 0.6 ms, 2 · 250 °/s · 1194/s, 1.5 °/s)
    /// to another axis by similarity. Time scales with 1/bandwidth. Motion scales with the range, noise with its
    /// density times √bandwidth, and both with the codes per °/s. `None` if range, bandwidth or noise is not known,
    /// or if the codes are too wide for these sums.
    fn of(axis: &Axis) -> Option<Self> {
        let (bandwidth, range) = (axis.bandwidth_hz? / 300.0, axis.range_dps? / 250.0);
        let noise = axis.noise?.white_dps_per_rt_hz / 0.0125 * libm::sqrt(bandwidth);
        let lsb = axis.rate.lsb_per_unit / 23_488.0;
        let square = bandwidth * bandwidth;
        (axis.rate.width_bits <= 24).then(|| Self {
            noise_per_us_q16: libm::round(154.0 * 65_536.0 * noise * lsb * bandwidth) as u64,
            least_us: libm::ceil(176.0 / bandwidth) as u64,
            motion_us4_per_code: NonZeroU64::new(libm::round(115_800.0 / (range * lsb * square * square)) as u64)
                .unwrap_or(NonZeroU64::MIN),
            longest_strict_us: (600.0 / bandwidth) as u64,
            slew_codes_per_us: libm::ceil(14_022.0 * range * lsb * bandwidth) as u64,
            slew_noise_codes: libm::ceil(35_232.0 * noise * lsb) as u64,
            span_codes: 1 << axis.rate.width_bits,
        })
    }

    /// Θ in codes.
    #[inline]
    fn threshold_codes(&self, period_us: u64) -> u64 {
        let square = period_us * period_us;
        let noise_q16 = self.noise_per_us_q16 * period_us.max(self.least_us);
        (noise_q16 >> 16) + square * square / self.motion_us4_per_code
    }
}

/// Factor by which a reading must be rougher than the readings before it.
const ROUGHNESS: u32 = 4;
/// Divisor of the L of a marked reading when it counts as roughness for later readings.
const MARK_SHARE: u32 = 2;
/// A marked reading raises the threshold of the next strict judgements, one fewer than this. After them, the
/// roughness of past readings, which lags by three readings, includes the shock.
const SHOCK_LASTS: u8 = 8;
/// log₂ of the number of readings over which the roughness of past readings fades.
const FADING: u32 = 5;
const KEPT: usize = 8;
/// Number of readings that a judgement waits for.
const AHEAD: usize = 2;
/// Index of the reading that is judged with all its neighbours.
const JUDGED: usize = KEPT - 1 - AHEAD;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Finding {
    pub(crate) rate: Verdict,
    pub(crate) temp_impossible: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Possible,
    Impossible,
    /// The rate is beyond the range of the converter (F-35).
    OutOfRange,
    /// The neighbours are missing or too far away in time to judge the rate, or the part's limits are not known.
    Unjudged,
}

#[derive(Clone, Debug)]
pub(crate) struct Plausible {
    limits: Option<Limits>,
    /// Codes, newest last. An impossible one is replaced by the value that its neighbours suggest.
    codes: [i32; KEPT],
    times_ns: [u64; KEPT],
    /// A bit for each code, the newest in the lowest bit: set if status or code is out of range.
    out_of_range: u8,
    /// Number of codes that were pushed, up to `KEPT`.
    filled: usize,
    /// Number of codes, up to the newest, that follow each other without a loss.
    run: usize,
    /// Number of the newest codes that are not judged yet.
    pub(super) waiting: usize,
    readings: [Option<Reading>; AHEAD + 1],
    roughness: u32,
    shock: Shock,
    temps: Temps,
}

/// The last marked reading. The onset of a shock is marked like a bit error, but the readings after it must not be.
#[derive(Clone, Copy, Debug, Default)]
struct Shock {
    roughness: u32,
    /// One more than the number of strict judgements for which `roughness` still raises the threshold. After them, the
    /// recent readings themselves show the roughness of the shock.
    left: u8,
}

impl Plausible {
    pub(crate) fn new(axis: &Axis) -> Self {
        Self {
            limits: Limits::of(axis),
            codes: [0; KEPT],
            times_ns: [0; KEPT],
            out_of_range: 0,
            filled: 0,
            run: 0,
            waiting: 0,
            readings: [None; AHEAD + 1],
            roughness: 0,
            shock: Shock::default(),
            temps: Temps::new(axis),
        }
    }

    pub(crate) fn has_limits(&self) -> bool {
        self.limits.is_some()
    }

    /// Takes a reading in, and judges the reading that came two before it.
    #[inline]
    pub(crate) fn push(&mut self, reading: &Reading) -> Option<(Reading, Finding)> {
        self.codes.copy_within(1.., 0);
        self.times_ns.copy_within(1.., 0);
        self.readings.copy_within(1.., 0);
        self.codes[KEPT - 1] = reading.rate;
        self.times_ns[KEPT - 1] = reading.t_ns;
        self.readings[AHEAD] = Some(*reading);
        self.out_of_range = self.out_of_range << 1 | u8::from(reading.out_of_range);
        self.filled = (self.filled + 1).min(KEPT);
        self.run = if reading.lost == 0 { (self.run + 1).min(KEPT) } else { 1 };
        self.waiting += 1;
        if self.waiting > AHEAD { self.early() } else { None }
    }

    /// Judges the oldest reading that waits, with the neighbours that are there.
    pub(crate) fn early(&mut self) -> Option<(Reading, Finding)> {
        let place = KEPT.checked_sub(self.waiting).filter(|place| *place < KEPT)?;
        let reading = self.readings.get(place - JUDGED).copied().flatten()?;
        self.waiting -= 1;
        let rate = self.rate(place);
        let later = [1, 2].map(|after| self.readings.get(place - JUDGED + after).copied().flatten());
        let temp_impossible = self.temps.is_impossible(&reading, later);
        Some((reading, Finding { rate, temp_impossible }))
    }

    #[inline]
    fn rate(&mut self, place: usize) -> Verdict {
        let Some(limits) = self.limits else {
            return if self.is_out_of_range(place) { Verdict::OutOfRange } else { Verdict::Unjudged };
        };
        if self.is_out_of_range(place) {
            return self.beyond(&limits, place);
        }
        let period_us = (self.times_ns[KEPT - 1].wrapping_sub(self.times_ns[KEPT - 5])).div_ceil(4_000);
        if place == JUDGED && self.run >= 5 && period_us <= limits.longest_strict_us {
            self.strict(&limits, period_us)
        } else {
            self.loose(&limits, place)
        }
    }

    /// Judges a reading out of range. A part cannot leave its range for one reading only, and be well inside before
    /// and after. Then the code or the status is faulty.
    #[cold]
    fn beyond(&mut self, limits: &Limits, place: usize) -> Verdict {
        let others = [place.checked_sub(1), Some(place + 1)].map(|other| other.filter(|other| self.is_there(*other)));
        let inside = |other: usize| {
            let reach = self.reach_codes(limits, place, other) + u64::from(self.codes[other % KEPT].unsigned_abs());
            !self.is_out_of_range(other) && reach < limits.span_codes / 2
        };
        let neighbour = others.iter().flatten().copied().next();
        match neighbour.filter(|_| others.iter().flatten().all(|other| inside(*other))) {
            Some(neighbour) => {
                self.codes[place % KEPT] = self.codes[neighbour % KEPT];
                Verdict::Impossible
            }
            None => Verdict::OutOfRange,
        }
    }

    fn is_there(&self, place: usize) -> bool {
        (KEPT - self.filled..KEPT).contains(&place)
    }

    #[inline]
    fn is_out_of_range(&self, place: usize) -> bool {
        self.out_of_range >> (KEPT - 1 - place) & 1 == 1
    }

    #[inline]
    fn strict(&mut self, limits: &Limits, period_us: u64) -> Verdict {
        self.roughness -= self.roughness >> FADING;
        self.shock.left = self.shock.left.saturating_sub(1);
        if self.run >= KEPT {
            self.roughness = self.roughness.max(six_times_deviation(&self.codes, JUDGED - 3));
        }
        let six_l = six_times_deviation(&self.codes, JUDGED);
        if u64::from(six_l) <= 6 * limits.threshold_codes(period_us) {
            Verdict::Possible
        } else {
            self.against_neighbours(six_l)
        }
    }

    #[cold]
    fn against_neighbours(&mut self, six_l: u32) -> Verdict {
        let [y0, y1, _, y3, y4] = around(&self.codes, JUDGED);
        let (odd, even) = ((y4 - 2 * y3 + 2 * y1 - y0).unsigned_abs(), (y4 - y3 - y1 + y0).unsigned_abs());
        let shock = if self.shock.left > 0 { self.shock.roughness } else { 0 };
        if six_l <= 6 * odd.max(even) || six_l <= ROUGHNESS * self.roughness.max(shock) {
            return Verdict::Possible;
        }
        self.codes[JUDGED] = (4 * (y1 + y3) - (y0 + y4)) / 6;
        self.shock = Shock { roughness: six_l / MARK_SHARE, left: SHOCK_LASTS };
        Verdict::Impossible
    }

    /// Judges by the loose rule, with one neighbour on each side, or with two on one side.
    #[cold]
    fn loose(&mut self, limits: &Limits, place: usize) -> Verdict {
        let there = |place: &usize| self.is_there(*place);
        let (before, after) = (place.checked_sub(1).filter(there), Some(place + 1).filter(there));
        let neighbours = match (before, after) {
            (Some(before), Some(after)) => [before, after],
            (Some(before), None) if there(&(place - 2)) => [before, place - 2],
            (None, Some(after)) if there(&(place + 2)) => [after, place + 2],
            _ => return Verdict::Unjudged,
        };
        let reach = neighbours.map(|other| self.reach_codes(limits, place, other));
        if reach.iter().all(|reach| *reach >= limits.span_codes) {
            return Verdict::Unjudged;
        }
        let far = |(other, reach): (usize, u64)| {
            u64::from(self.codes[place % KEPT].abs_diff(self.codes[other % KEPT])) > reach
        };
        if !neighbours.into_iter().zip(reach).all(far) {
            return Verdict::Possible;
        }
        self.codes[place % KEPT] = self.codes[neighbours[0] % KEPT];
        Verdict::Impossible
    }

    /// Largest distance that the response can move between two readings, with the allowance for noise, in codes.
    fn reach_codes(&self, limits: &Limits, place: usize, other: usize) -> u64 {
        let us = self.times_ns[place % KEPT].abs_diff(self.times_ns[other % KEPT]).div_ceil(1000);
        us.saturating_mul(limits.slew_codes_per_us).saturating_add(limits.slew_noise_codes)
    }
}

/// The reading at a place and two on each side. (The remainders change nothing, but with them the compiler sees that
/// nothing can panic.)
#[inline]
fn around(codes: &[i32; KEPT], place: usize) -> [i32; 5] {
    let at = |k: usize| codes[(place + KEPT - 2 + k) % KEPT];
    [at(0), at(1), at(2), at(3), at(4)]
}

/// Returns 6 L of the reading at a place.
#[inline]
fn six_times_deviation(codes: &[i32; KEPT], place: usize) -> u32 {
    let [y0, y1, y2, y3, y4] = around(codes, place);
    (6 * y2 - 4 * (y1 + y3) + y0 + y4).unsigned_abs()
}

/// Judges temperatures by the last two valid ones. Because there are two, an error just below the limit does not
/// make the next temperature look wrong.
#[derive(Clone, Copy, Debug)]
struct Temps {
    /// Allowed difference for noise and quantisation, codes: 1 °C.
    step_codes: u64,
    /// Largest slope, codes per s: 2 °C/s.
    codes_per_s: u64,
    good: Option<Temp>,
    before: Option<Temp>,
    /// The last temperature, if it was found impossible.
    odd: Option<Temp>,
}

#[derive(Clone, Copy, Debug)]
struct Temp {
    code: i32,
    t_ns: u64,
}

impl Temp {
    fn of(reading: &Reading) -> Option<Self> {
        reading.temp.map(|code| Self { code, t_ns: reading.t_ns })
    }
}

impl Temps {
    fn new(axis: &Axis) -> Self {
        let step_codes = libm::ceil(axis.temp.lsb_per_unit) as u64;
        Self { step_codes, codes_per_s: 2 * step_codes, good: None, before: None, odd: None }
    }

    #[inline]
    fn agree(&self, one: &Temp, other: &Temp) -> bool {
        let apart_ms = one.t_ns.abs_diff(other.t_ns) / 1_000_000;
        let allowed = self.step_codes + apart_ms.saturating_mul(self.codes_per_s) / 1000;
        u64::from(one.code.abs_diff(other.code)) <= allowed
    }

    #[inline]
    fn is_impossible(&mut self, reading: &Reading, later: [Option<Reading>; AHEAD]) -> bool {
        let Some(temp) = Temp::of(reading) else { return false };
        let agrees = match &self.good {
            Some(good) => {
                self.agree(&temp, good) || [self.before, self.odd].iter().flatten().any(|one| self.agree(&temp, one))
            }
            None => !self.contradicted(&temp, later.map(|reading| reading.as_ref().and_then(Temp::of))),
        };
        if agrees {
            (self.before, self.good, self.odd) = (self.good, Some(temp), None);
        } else {
            self.odd = Some(temp);
        }
        !agrees
    }

    fn contradicted(&self, first: &Temp, later: [Option<Temp>; AHEAD]) -> bool {
        let [Some(second), Some(third)] = later else { return false };
        self.agree(&second, &third) && !self.agree(first, &second) && !self.agree(first, &third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use core::f64::consts::PI;

    const PERIOD_NS: u64 = 175_667;

    fn sample(k: u64, rate_dps: f64) -> Reading {
        let rate = (rate_dps * 23_488.0).round() as i32;
        Reading {
            t_ns: k * PERIOD_NS,
            seq: k as u32,
            rate,
            temp: None,
            out_of_range: rate >> 23 != rate >> 31,
            lost: 0,
        }
    }

    fn findings(samples: impl IntoIterator<Item = Reading>) -> Vec<Finding> {
        let mut judge = Plausible::new(&Axis::ADIS16130);
        let mut all: Vec<_> = samples.into_iter().filter_map(|sample| judge.push(&sample)).collect();
        while let Some(judged) = judge.early() {
            all.push(judged);
        }
        assert!(all.windows(2).all(|pair| pair[0].0.t_ns < pair[1].0.t_ns), "each once, in order");
        all.into_iter().map(|(_, finding)| finding).collect()
    }

    fn verdicts(samples: impl IntoIterator<Item = Reading>) -> Vec<Verdict> {
        findings(samples).into_iter().map(|finding| finding.rate).collect()
    }

    fn marked(verdicts: &[Verdict]) -> Vec<usize> {
        (0..verdicts.len()).filter(|k| verdicts[*k] == Verdict::Impossible).collect()
    }

    /// The exact response of the two poles of F-03 to a rate that is constant over each time step.
    #[derive(Clone, Copy, Default)]
    struct Poles(f64, f64);

    impl Poles {
        const W: [f64; 2] = [2.0 * PI * 327.0, 2.0 * PI * 1000.0];

        fn step(&mut self, rate_dps: f64, dt_s: f64) -> f64 {
            let [slow, fast] = Self::W;
            self.0 += (rate_dps - self.0) * -(-slow * dt_s).exp_m1();
            self.1 += (rate_dps - self.1) * -(-fast * dt_s).exp_m1();
            (fast * self.0 - slow * self.1) / (fast - slow)
        }
    }

    /// The readings that the part makes of a motion, every `periods` periods.
    fn readings(count: u64, periods: u64, motion: impl Fn(f64) -> f64) -> Vec<Reading> {
        let period_s = (PERIOD_NS * periods) as f64 * 1e-9;
        let mut poles = Poles::default();
        (0..count)
            .map(|k| {
                let mut rate_dps = 0.0;
                for part in 0..20u32 {
                    rate_dps = poles.step(motion((k as f64 + f64::from(part) / 20.0) * period_s), period_s / 20.0);
                }
                Reading { t_ns: k * periods * PERIOD_NS, ..sample(k, rate_dps) }
            })
            .collect()
    }

    #[test]
    fn one_wrong_reading_is_marked_at_every_bit_that_matters() {
        for bit in 16..24 {
            let mut samples: Vec<_> = (0..40).map(|k| sample(k, 0.05 * (k as f64).sin())).collect();
            samples[20].rate = ((samples[20].rate + (1 << 23)) ^ (1 << bit)) - (1 << 23);
            assert_eq!(marked(&verdicts(samples)), [20], "bit {bit}");
        }
    }

    #[test]
    fn full_scale_motion_within_the_bandwidth_is_never_marked() {
        for periods in 1..=3 {
            for hz in [0.2, 5.0, 30.0, 100.0, 200.0, 300.0] {
                let sway = readings(4000, periods, |t| 250.0 * (2.0 * PI * hz * t).sin());
                assert_eq!(marked(&verdicts(sway)), [], "{hz} Hz, every {periods} periods");
            }
        }
    }

    #[test]
    fn jumps_shocks_and_vibration_cost_two_marks_at_most() {
        for phase in 0..40 {
            let start_s = 40.0 * 175.667e-6 * (1.0 + f64::from(phase) / 1600.0);
            let jump = readings(200, 1, |t| if t > start_s { 250.0 } else { -250.0 });
            assert_eq!(marked(&verdicts(jump)), [], "jump, phase {phase}");
            for width_s in [50e-6, 200e-6, 500e-6, 2e-3] {
                let within = |t: f64| (0.0..width_s).contains(&(t - start_s));
                let shock = readings(200, 1, |t| if within(t) { 250.0 } else { 0.0 });
                assert!(marked(&verdicts(shock)).len() <= 1, "shock of {width_s} s, phase {phase}");
            }
        }
        for hz in (400..2840).step_by(61) {
            let shaken =
                readings(2000, 1, |t| if t > 0.05 { 250.0 * (2.0 * PI * f64::from(hz) * t).sin() } else { 0.0 });
            assert!(marked(&verdicts(shaken)).len() <= 2, "{hz} Hz");
        }
    }

    #[test]
    fn next_to_a_loss_only_rates_that_cannot_be_reached_are_marked() {
        let record = |error_dps: f64| {
            let mut samples: Vec<_> = (0..20).map(|k| sample(k, 0.0)).collect();
            samples[11].lost = 1;
            samples[11..].iter_mut().for_each(|sample| sample.t_ns += PERIOD_NS);
            samples[10] = sample(10, error_dps);
            marked(&verdicts(samples))
        };
        // the part can move by 105 °/s in one period, and by 210 °/s in two
        assert_eq!(record(100.0), []);
        assert_eq!(record(225.0), [10]);
    }

    #[test]
    fn both_ends_are_judged_by_the_neighbours_that_exist() {
        for place in [0, 1, 18, 19] {
            let mut samples: Vec<_> = (0..20).map(|k| sample(k, 1.0)).collect();
            samples[place] = sample(place as u64, 340.0);
            assert_eq!(marked(&verdicts(samples)), [place]);
        }
        assert_eq!(verdicts([sample(0, 340.0)]), [Verdict::Unjudged]);
    }

    #[test]
    fn readings_far_apart_are_not_judged() {
        let slow = |k: u64| Reading { t_ns: k * 4_480_000, ..sample(k, if k == 10 { 300.0 } else { 0.0 }) };
        assert!(verdicts((0..20).map(slow)).iter().all(|verdict| *verdict == Verdict::Unjudged));
    }

    #[test]
    fn beyond_the_range_is_not_called_impossible_but_a_spoilt_status_is() {
        let over = |k: u64| Reading { out_of_range: true, ..sample(k, -354.0) };
        let turning = (0..30).map(|k| if k < 15 { sample(k, 3.0) } else { over(k) });
        let found = verdicts(turning);
        assert!(found[15..].iter().all(|verdict| *verdict == Verdict::OutOfRange), "{found:?}");
        let faulty = (0..30).map(|k| Reading { out_of_range: k == 15, ..sample(k, 3.0) });
        assert_eq!(marked(&verdicts(faulty)), [15]);
    }

    #[test]
    fn a_temperature_cannot_jump() {
        let with = |k: u64, temp_c: f64| Reading { temp: Some(((temp_c - 25.0) * 14_093.0) as i32), ..sample(k, 0.0) };
        let impossible = |temps_c: &[f64]| {
            let found = findings((0_u64..).zip(temps_c).map(|(k, temp_c)| with(k, *temp_c)));
            (0..found.len()).filter(|k| found[*k].temp_impossible).collect::<Vec<_>>()
        };
        assert_eq!(impossible(&[25.0, 25.1, 27.3, 25.05, 25.1]), [2]);
        assert_eq!(impossible(&[77.0, 25.0, 25.0, 25.0]), [0]);
        assert_eq!(impossible(&[25.0, 25.0, 25.0, 61.0]), [3]);
        assert_eq!(impossible(&[25.0, 25.0, 40.0, 40.0, 40.0]), [2], "a second one that agrees is believed");
    }
}
