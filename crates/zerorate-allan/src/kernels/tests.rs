use super::*;
use crate::Gap;
use crate::kernel::{Order, Plain};
use std::string::ToString;
use std::vec::Vec;

/// The definition by averages, without running sums.
fn by_definition(rate: &[f64], stat: Stat, m: usize) -> f64 {
    let mean = |i: usize| rate[i..i + m].iter().sum::<f64>() / m as f64;
    let means: Vec<f64> = (0..=rate.len() - m).map(mean).collect();
    let second: Vec<f64> = (0..means.len().saturating_sub(m)).map(|i| means[i + m] - means[i]).collect();
    let third: Vec<f64> = (0..second.len().saturating_sub(m)).map(|i| second[i + m] - second[i]).collect();
    let root = |differences: &mut dyn Iterator<Item = f64>, divisor: f64| {
        let squares: Vec<f64> = differences.map(|d| d * d).collect();
        (squares.iter().sum::<f64>() / (divisor * squares.len() as f64)).sqrt()
    };
    let modified = || root(&mut second.windows(m).map(|w| w.iter().sum::<f64>() / m as f64), 2.0);
    match stat {
        Stat::Adev => root(&mut second.iter().copied().step_by(m), 2.0),
        Stat::Oadev => root(&mut second.iter().copied(), 2.0),
        Stat::Mdev => modified(),
        Stat::Tdev => modified() * m as f64 / 3f64.sqrt(),
        Stat::Hdev => root(&mut third.iter().copied().step_by(m), 6.0),
        Stat::Ohdev => root(&mut third.iter().copied(), 6.0),
        Stat::Totdev => total_by_definition(rate, m),
    }
}

/// Where the phase is reflected, the rate runs backwards.
fn total_by_definition(rate: &[f64], m: usize) -> f64 {
    let backwards = || rate.iter().rev().copied();
    let whole: Vec<f64> = backwards().chain(rate.iter().copied()).chain(backwards()).collect();
    let n = rate.len();
    let mean = |i: usize| whole[i..i + m].iter().sum::<f64>() / m as f64;
    let squares = (n + 1..2 * n).map(|middle| (mean(middle) - mean(middle - m)).powi(2)).sum::<f64>();
    (squares / (2.0 * (n - 1) as f64)).sqrt()
}

fn dev(input: &Input<'_>, stat: Stat, m: usize) -> f64 {
    deviations(input, 1.0, stat, &[m as u64])[0].unwrap().dev
}

fn phase_of(rate: &[f64]) -> Vec<f64> {
    let mut x = std::vec![0.0];
    rate.iter().for_each(|value| x.push(x[x.len() - 1] + value));
    x
}

fn assert_close(value: f64, truth: f64, tolerance: f64, what: &str) {
    assert!((value / truth - 1.0).abs() <= tolerance, "{what}: {value} is not {truth}");
}

/// NIST SP 1065 section 12.4, table 30.
#[test]
fn nbs14_10_points() {
    use Stat::*;
    let rate = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];
    let codes = rate.map(|value| value as i32);
    let published = [
        (Adev, 91.22945, 115.8082),
        (Oadev, 91.22945, 85.95287),
        (Mdev, 91.22945, 74.78849),
        (Tdev, 52.67135, 86.35831),
        (Hdev, 70.80607, 116.7980),
        (Ohdev, 70.80607, 85.61487),
        (Totdev, 91.22945, 93.90379),
    ];
    for (stat, at_1, at_2) in published {
        for (m, value) in [(1, at_1), (2, at_2)] {
            assert_close(dev(&Input::Rate(&rate), stat, m), value, 3e-7, stat.name());
            assert_close(dev(&Input::Phase(&phase_of(&rate)), stat, m), value, 3e-7, stat.name());
            assert_close(dev(&Input::Codes { codes: &codes, gaps: &[] }, stat, m), value, 3e-7, stat.name());
        }
    }
}

/// NIST SP 1065 section 12.4, table 31.
#[test]
fn nbs14_1000_points() {
    use Stat::*;
    let rate = nbs14(1000);
    let published = [
        (Adev, [2.922319e-1, 9.965736e-2, 3.897804e-2]),
        (Oadev, [2.922319e-1, 9.159953e-2, 3.241343e-2]),
        (Mdev, [2.922319e-1, 6.172376e-2, 2.170921e-2]),
        (Tdev, [1.687202e-1, 3.563623e-1, 1.253382e0]),
        (Hdev, [2.943883e-1, 1.052754e-1, 3.910860e-2]),
        (Ohdev, [2.943883e-1, 9.581083e-2, 3.237638e-2]),
        (Totdev, [2.922319e-1, 9.134743e-2, 3.406530e-2]),
    ];
    for (stat, values) in published {
        for (m, value) in [1, 10, 100].into_iter().zip(values) {
            assert_close(dev(&Input::Rate(&rate), stat, m), value, 3e-7, stat.name());
            assert_close(dev(&Input::Phase(&phase_of(&rate)), stat, m), value, 3e-7, stat.name());
        }
    }
}

/// The uniform numbers of NIST SP 1065 section 12.4.
fn uniform(seed: u64) -> impl Iterator<Item = f64> {
    let next = |n: &u64| Some(16807 * n % 2147483647);
    core::iter::successors(Some(seed), next).map(|n| n as f64 / 2147483647.0)
}

pub(crate) fn nbs14(n: usize) -> Vec<f64> {
    uniform(1_234_567_890).take(n).collect()
}

/// Sums of twelve uniform numbers: normal enough, of variance 1, and the same on every machine.
pub(crate) fn white(seed: u64, n: usize) -> Vec<f64> {
    let mut uniform = uniform(seed).skip(1).map(|value| value - 0.5);
    (0..n).map(|_| uniform.by_ref().take(12).sum()).collect()
}

#[test]
fn everything_follows_the_definition() {
    let codes: Vec<i32> = (0..257).map(|i: i32| (i * i * 7919) % 10_007 - 5_000).collect();
    let rate: Vec<f64> = codes.iter().map(|&c| f64::from(c)).collect();
    let x = phase_of(&rate);
    for stat in Stat::ALL {
        for m in [1usize, 2, 3, 7, 32, 85, 86, 128, 200, 257] {
            let inputs = [Input::Codes { codes: &codes, gaps: &[] }, Input::Rate(&rate), Input::Phase(&x)];
            let found = inputs.map(|input| deviations(&input, 1.0, stat, &[m as u64])[0]);
            if let Err(reason) = found[0] {
                assert!(matches!(reason, Reason::TooShort { needs } if needs > 257), "{stat} {m} {reason:?}");
                assert!(found[1].is_err() && found[2].is_err());
                continue;
            }
            let truth = by_definition(&rate, stat, m);
            found.iter().for_each(|found| assert_close(found.unwrap().dev, truth, 1e-12, stat.name()));
        }
    }
}

#[test]
fn each_missing_deviation_has_its_reason() {
    let rate = [1.0, 2.0, 4.0, 3.0, 5.0];
    let found = deviations(&Input::Rate(&rate), 1.0, Stat::Oadev, &[0, 1, 2, 3, u64::MAX]);
    assert_eq!(found[0], Err(Reason::ZeroLength));
    assert_eq!(found[2].unwrap().n, 2);
    assert_eq!(found[3], Err(Reason::TooShort { needs: 6 }));
    assert_eq!(found[4], Err(Reason::TooShort { needs: u64::MAX }));
    let phase = deviations(&Input::Phase(&rate), 1.0, Stat::Oadev, &[2, 3]);
    assert_eq!(phase[0].unwrap().n, 1);
    assert_eq!(phase[1], Err(Reason::TooShort { needs: 7 }));
    let infinite = Input::Rate(&[1.0, f64::INFINITY, 2.0, 3.0]);
    assert_eq!(deviations(&infinite, 1.0, Stat::Oadev, &[1]), [Err(Reason::NotFinite)]);
    for stat in Stat::ALL {
        for empty in
            [Input::Rate(&[]), Input::Phase(&[]), Input::Phase(&[1.0]), Input::Codes { codes: &[], gaps: &[] }]
        {
            assert!(matches!(deviations(&empty, 1.0, stat, &[1])[0], Err(Reason::TooShort { .. })), "{stat}");
        }
    }
}

#[test]
fn phase_and_time_deviation_know_the_rate() {
    let rate: Vec<f64> = nbs14(1000);
    let x: Vec<f64> = phase_of(&rate).iter().map(|x| x / 50.0).collect();
    for stat in Stat::ALL {
        let of = |input: &Input<'_>| deviations(input, 50.0, stat, &[10])[0].unwrap().dev;
        assert_close(of(&Input::Phase(&x)), of(&Input::Rate(&rate)), 1e-12, stat.name());
    }
    let modified = deviations(&Input::Rate(&rate), 50.0, Stat::Mdev, &[10])[0].unwrap().dev;
    let time = deviations(&Input::Rate(&rate), 50.0, Stat::Tdev, &[10])[0].unwrap().dev;
    assert_close(time, 0.2 * modified / 3f64.sqrt(), 1e-15, "tau is 10 / 50 s");
}

/// Three samples are missing. The averages of one, two and four samples are worked out by hand.
#[test]
fn gaps_are_left_out() {
    let rate = [1.0, 3.0, 2.0, 4.0, f64::NAN, 5.0, 9.0, f64::NAN, f64::NAN];
    let codes =
        Input::Codes { codes: &[1, 3, 2, 4, 5, 9], gaps: &[Gap { at: 4, missing: 1 }, Gap { at: 6, missing: 2 }] };
    for input in [Input::Rate(&rate), codes] {
        assert_eq!((input.len(), input.missing()), (9, 3));
        let one = deviations(&input, 1.0, Stat::Oadev, &[1])[0].unwrap();
        assert_eq!(one.n, 4);
        assert_close(one.dev, ((4.0 + 1.0 + 4.0 + 16.0) / 8.0f64).sqrt(), 1e-15, "m = 1");
        // averages of two samples: 2, 2.5, 3, only one sample (4), only one (5), 7, only one (9), none
        let two = deviations(&input, 1.0, Stat::Oadev, &[2])[0].unwrap();
        assert_eq!(two.n, 1);
        assert_close(two.dev, 0.5f64.sqrt(), 1e-15, "m = 2");
        // averages of four: 2.5 before 7 (two samples, variance 8), then 3 (three samples, variance 1) before that 7
        let four = deviations(&input, 1.0, Stat::Oadev, &[4])[0].unwrap();
        assert_eq!(four.n, 2);
        let squares = (20.25 - 8.0 / 4.0) + (16.0 - 1.0 / 12.0 - 8.0 / 4.0);
        assert_close(four.dev, (squares / 4.0f64).sqrt(), 1e-15, "m = 4");
    }
    let sparse = Input::Codes { codes: &[1, 2], gaps: &[Gap { at: 1, missing: u64::MAX }] };
    assert_eq!(deviations(&sparse, 1.0, Stat::Oadev, &[1]), [Err(Reason::Gaps)]);
}

/// Four of ten samples lost one by one: means over the rest scatter more, by up to 40 % of the deviation.
#[test]
fn losses_do_not_add_to_the_deviation() {
    let whole = nbs14(1000).into_iter().cycle().zip(1u64..).map(|(x, i)| x + (i * i % 89) as f64 / 89.0);
    let whole: Vec<f64> = whole.take(60_000).collect();
    let mut gappy = whole.clone();
    let mut state = 1u64;
    for value in &mut gappy {
        state = 16_807 * state % 2_147_483_647;
        if state % 10 < 4 {
            *value = f64::NAN;
        }
    }
    for m in [4, 8, 32] {
        let found = deviations(&Input::Rate(&gappy), 1.0, Stat::Oadev, &[m])[0].unwrap().dev;
        let of_whole = deviations(&Input::Rate(&whole), 1.0, Stat::Oadev, &[m])[0].unwrap().dev;
        assert_close(found, of_whole, 0.03, "OADEV");
    }
}

#[test]
fn gaps_path_agrees_with_the_whole_record() {
    let rate = nbs14(1000);
    let x = phase_of(&rate);
    for stat in Stat::ALL {
        for m in [1, 2, 7, 100, 300] {
            let whole = dev(&Input::Rate(&rate), stat, m);
            let row = stat.row();
            for input in [Input::Rate(&rate), Input::Phase(&x)] {
                let sum = gaps::squares(&input, row.kernel, &[m])[0].unwrap();
                let found = deviation(sum, row, m, scale(row.is_times_s, false, 1.0, m)).unwrap();
                assert_eq!(found.n, row.kernel.terms(1001, m as u64));
                assert_close(found.dev, whole, 1e-10, stat.name());
            }
        }
    }
}

/// The record of allantools: white noise of which 200 of 1000 points are lost.
#[test]
fn reference_record_with_gaps_stays_near_the_whole() {
    let folder = std::env::var("ZERORATE_REFERENCE_DATA").unwrap_or("../../../shared/data".into());
    let read = |name: &str| -> Option<Vec<f64>> {
        let text = std::fs::read_to_string(std::format!("{folder}/gaps/{name}")).ok()?;
        Some(text.lines().map(|line| line.trim().parse().unwrap()).collect())
    };
    let (Some(whole), Some(gappy)) = (read("y.dat"), read("y_gap.dat")) else {
        std::eprintln!("skipped: no reference data in {folder}");
        return;
    };
    for stat in Stat::ALL {
        for m in [1usize, 4, 16, 64] {
            let found = deviations(&Input::Rate(&gappy), 1.0, stat, &[m as u64])[0].unwrap();
            let of_whole = deviations(&Input::Rate(&whole), 1.0, stat, &[m as u64])[0].unwrap();
            let independent = (found.n as f64 / m as f64).max(1.0);
            assert!(found.n < of_whole.n, "{stat} {m}");
            assert_close(found.dev, of_whole.dev, 1.5 / independent.sqrt(), stat.name());
        }
    }
}

/// Pseudo-random codes of `bits` bits.
fn noise(len: usize, bits: u32) -> Vec<i32> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state as i64 >> (64 - bits)) as i32
    };
    (0..len).map(|_| next()).collect()
}

/// Sum of squares in big integers, straight from the definition with phase.
fn big_sum(codes: &[i32], kernel: Kernel, m: usize) -> num_bigint::BigInt {
    let mut x = std::vec![0i128];
    codes.iter().for_each(|&code| x.push(x[x.len() - 1] + i128::from(code)));
    let (m, last) = (m as isize, x.len() as isize - 1);
    let at = |i: isize| match i {
        i if i < 0 => 2 * x[0] - x[-i as usize],
        i if i > last => 2 * x[last as usize] - x[(2 * last - i) as usize],
        i => x[i as usize],
    };
    let second = |i: isize| at(i + 2 * m) - 2 * at(i + m) + at(i);
    let third = |i: isize| at(i + 3 * m) - 3 * at(i + 2 * m) + 3 * at(i + m) - at(i);
    let stride = |plain: Plain| if plain.overlapping { 1 } else { m as usize };
    let differences: Vec<i128> = match kernel {
        Kernel::Plain(plain) => match plain.order {
            Order::Second => (0..=last - 2 * m).step_by(stride(plain)).map(second).collect(),
            Order::Third => (0..=last - 3 * m).step_by(stride(plain)).map(third).collect(),
        },
        Kernel::Modified => (0..=last + 1 - 3 * m).map(|i| (i..i + m).map(second).sum()).collect(),
        Kernel::Reflected => (1 - m..last - m).map(second).collect(),
    };
    differences.into_iter().map(|d| num_bigint::BigInt::from(d) * d).sum()
}

fn assert_exact(codes: &[i32], lengths: &[usize]) {
    assert_exact_of(&Stat::ALL, codes, lengths);
}

fn assert_exact_of(stats: &[Stat], codes: &[i32], lengths: &[usize]) {
    for &stat in stats {
        let kernel = stat.row().kernel;
        for &m in lengths.iter().filter(|&&m| kernel.check(codes.len() as u64, m as u64, false).is_ok()) {
            let found = codes::squares(codes, kernel, &[m])[0].unwrap();
            let truth: f64 = big_sum(codes, kernel, m).to_string().parse().unwrap();
            assert!((found.sum - truth).abs() <= truth * f64::EPSILON, "{stat} {m}: {} is not {truth}", found.sum);
        }
    }
}

#[test]
fn codes_agree_with_big_integers() {
    let extreme =
        |block: usize| move |i: usize| if (i / block).is_multiple_of(2) { (1 << 23) - 1 } else { -(1 << 23) };
    let lengths = [1, 2, 3, 17, 64, 250, 499, 500, 900, 1000];
    assert_exact(&noise(1000, 12), &lengths);
    assert_exact(&noise(1000, 24), &lengths);
    assert_exact(&noise(1001, 32), &lengths);
    for block in [1, 10, 250, 500] {
        assert_exact(&(0..1000).map(extreme(block)).collect::<Vec<i32>>(), &lengths);
    }
    assert_exact(&(0..20_000).map(extreme(10_000)).collect::<Vec<i32>>(), &[1, 1000, 10_000]);
    let widest = |i: i32| if i / 1024 % 2 == 0 { i32::MAX } else { i32::MIN };
    assert_exact(&(0..4096).map(widest).collect::<Vec<i32>>(), &[1024]);
}

#[test]
fn sums_are_exact_across_blocks_and_pieces() {
    assert_exact(&noise(300_000, 10), &[1, 1000, 150_000]);
    assert_exact(&noise(200_000, 24), &[3, 100_000]);
    assert_exact_of(&[Stat::Oadev, Stat::Ohdev], &noise(200_000, 12), &[65_536]);
    assert_exact_of(&[Stat::Oadev], &noise(265_000, 24), &[65_536, 131_072]);
}

fn all(input: &Input<'_>, m: &[u64]) -> Vec<f64> {
    let of = |stat| deviations(input, 1.0, stat, m).into_iter().map(|found| found.unwrap().dev);
    Stat::ALL.into_iter().flat_map(of).collect()
}

const EVERY_PATH: [u64; 5] = [1, 16, 1024, 1 << 16, 1 << 17];
/// A record length that is a multiple of each length in [`EVERY_PATH`].
const WHOLE: usize = 3 << 17;

#[test]
#[cfg(feature = "std")]
fn any_number_of_threads_gives_the_same_bits() {
    let codes = noise(WHOLE, 24);
    let rate: Vec<f64> = codes.iter().map(|&code| f64::from(code) / 23_425.0).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let codes = Input::Codes { codes: &codes, gaps: &[] };
            (all(&codes, &EVERY_PATH), all(&Input::Rate(&rate), &EVERY_PATH))
        })
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn scale_offset_and_reversal_are_exact() {
    let codes = noise(WHOLE, 24);
    let of_codes = |codes: &[i32]| all(&Input::Codes { codes, gaps: &[] }, &EVERY_PATH);
    let found = of_codes(&codes);
    assert_eq!(of_codes(&codes.iter().map(|code| code + 1_234_567).collect::<Vec<_>>()), found);
    assert_eq!(of_codes(&codes.iter().rev().copied().collect::<Vec<_>>()), found);
    assert_eq!(of_codes(&codes.iter().map(|code| -code).collect::<Vec<_>>()), found);

    let rate: Vec<f64> = codes.iter().map(|&code| f64::from(code) / 23_425.0).collect();
    let eightfold: Vec<f64> = rate.iter().map(|value| value * 8.0).collect();
    let found = all(&Input::Rate(&rate), &EVERY_PATH);
    let found_eightfold = all(&Input::Rate(&eightfold), &EVERY_PATH);
    assert_eq!(found.iter().map(|dev| dev * 8.0).collect::<Vec<_>>(), found_eightfold);
}

/// Largest relative error of the deviations of f64. The deviations of the same numbers as integers are exact.
fn error_of_floats(codes: &[i32], m: &[u64]) -> f64 {
    let rate: Vec<f64> = codes.iter().map(|&code| f64::from(code) * 0.0625 + 1000.0).collect();
    let exact = all(&Input::Codes { codes, gaps: &[] }, m);
    let found = all(&Input::Rate(&rate), m);
    exact.iter().zip(found).map(|(exact, found)| (found / (exact * 0.0625) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn floats_agree_with_exact_codes() {
    let error = error_of_floats(&noise(300_000, 16), &[1, 16, 200, 1000, 70_000]);
    assert!(error <= 1e-13, "{error:e}");
}

#[test]
fn floats_keep_their_digits_under_drift() {
    let white = noise(WHOLE, 8);
    let with = |slow: &dyn Fn(i32) -> i32| (0..).zip(&white).map(|(i, noise)| noise + slow(i)).collect::<Vec<i32>>();
    let ramp = error_of_floats(&with(&|i| i / 3), &EVERY_PATH);
    let bend = error_of_floats(&with(&|i| (i / 1000 - 200) * (i / 1000 - 200)), &EVERY_PATH);
    let walk: Vec<i32> = white.iter().scan(0, |sum, step| Some(core::mem::replace(sum, *sum + step))).collect();
    let walk = error_of_floats(&walk, &EVERY_PATH);
    let white = error_of_floats(&white, &EVERY_PATH);
    assert!(white < 1e-13 && ramp < 3e-11 && bend < 3e-11 && walk < 1e-14, "{white:e} {ramp:e} {bend:e} {walk:e}");
}
