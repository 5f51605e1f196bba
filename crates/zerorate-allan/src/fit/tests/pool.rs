//! Tests the common model of several records.

use super::*;

fn pool_of(rates: &[Vec<f64>]) -> Result<Pool, PoolError> {
    let fits: Vec<Fit> = rates.iter().map(|rate| of(rate)).collect();
    // the pool needs no raw rate of a record that was cleaned, because the fit has the cleaned rate
    let kept = rates.iter().zip(&fits).map(|(rate, fit)| if fit.cleaned.rate.is_some() { &[][..] } else { rate });
    let record = |(rate, fit)| PoolRecord { rate, rate_hz: RATE_HZ, fit };
    fit_pool(&kept.zip(&fits).map(record).collect::<Vec<_>>())
}

/// The intervals of N and B from four units of one type are at least 30 % narrower than those from one unit.
#[test]
fn a_pool_is_surer_than_its_records() {
    let rates: Vec<Vec<f64>> = (60..64).map(|seed| HOUR.noise(180_000 + 1000 * seed as usize, seed)).collect();
    let pool = pool_of(&rates).unwrap();
    let one = of(&rates[0]);
    assert!(pool.used == [0, 1, 2, 3] && pool.outliers.is_empty(), "{:?}", pool.outliers);
    let width = |c: Coefficient| (c.hi - c.lo) / c.value;
    assert!(width(pool.fit.n) < 0.7 * width(one.n) && width(pool.fit.b) < 0.7 * width(one.b), "{pool:?}");
    for (found, truth) in [(pool.fit.n, HOUR.n), (pool.fit.b, HOUR.b), (pool.fit.k, HOUR.k)] {
        assert!(found.lo < truth && truth < found.hi, "{found:?} {truth}");
    }
    assert!(pool.fit.model_error < 0.01 && pool.fit.terms.is_empty() && !pool.fit.is_rejected);
    let n = pool.spread.iter().find(|spread| spread.noise == Noise::AngleRandomWalk).unwrap();
    assert!(n.records == 4 && n.relative < 3e-3, "{n:?}");
}

/// K of a pool is as large beside warm-ups as without them.
#[test]
fn warm_ups_do_not_take_from_the_walk_of_a_pool() {
    let truth = Truth { n: 0.005, k: 1e-4, ..Truth::default() };
    let still: Vec<Vec<f64>> = (720..728).map(|seed| truth.noise(120_000, seed)).collect();
    let warm = |rate: &Vec<f64>| rate.iter().zip(0..).map(warmer).collect::<Vec<f64>>();
    let [still, warm] = [still.clone(), still.iter().map(warm).collect()].map(|rates| pool_of(&rates).unwrap().fit.k);
    assert!(near(warm.value, still.value, 0.2), "{warm:?} {still:?}");
    assert!(warm.lo < truth.k && truth.k < warm.hi, "{warm:?}");
}

fn warmer((rate, i): (&f64, u32)) -> f64 {
    rate + 0.5 * (-f64::from(i) / RATE_HZ / 400.0).exp()
}

/// Units whose N differs by 3 % are one type, and the interval of their mean allows for it. A unit with twice the
/// noise or with other slow noise is an outlier.
#[test]
fn a_pool_states_its_spread_and_names_the_outliers() {
    let unit = |part: f64, seed: u64| Truth { n: HOUR.n * part, ..HOUR }.noise(180_000, seed);
    let mut rates = vec![unit(0.97, 70), unit(1.0, 71), unit(1.03, 72)];
    let pool = pool_of(&rates).unwrap();
    let n = pool.spread[0];
    assert!(n.noise == Noise::AngleRandomWalk && n.relative > 0.02 && n.relative < 0.045, "{n:?}");
    assert!(
        pool.fit.n.lo < 0.98 * HOUR.n && pool.fit.n.hi > 1.02 * HOUR.n && pool.fit.n.identified,
        "{:?}",
        pool.fit.n
    );
    rates.push(unit(2.0, 73));
    rates.push(Truth { k: 3e-3, ..HOUR }.noise(180_000, 74));
    let pool = pool_of(&rates).unwrap();
    assert_eq!(pool.used, [0, 1, 2]);
    let [white, slow] = pool.outliers[..] else { panic!("{:?}", pool.outliers) };
    assert!(matches!(white.differs, Differs::White { ratio } if near(ratio, 2.0, 0.05)), "{white:?}");
    assert!(matches!(slow.differs, Differs::Slow { gain } if gain > 18.5), "{slow:?}");
    assert!((white.record, slow.record) == (3, 4) && white.is_left_out && slow.is_left_out, "{white:?} {slow:?}");
    // if two differ, either may be right
    let pool = pool_of(&rates[3..]);
    assert_eq!(pool.unwrap_err(), PoolError::NothingInCommon);
    let pool = pool_of(&[rates[0].clone(), rates[4].clone()]).unwrap();
    assert!(pool.used == [0, 1] && pool.outliers.len() == 1 && !pool.outliers[0].is_left_out, "{:?}", pool.outliers);
}

/// The sum of the likelihoods follows the loudest record, which once stayed while three that agree were left out.
#[test]
fn a_record_that_is_louder_or_quieter_than_the_others_is_the_outlier() {
    let quiet = |seed| Truth { n: 0.01, ..Truth::default() }.noise(100_000, seed);
    let loud = |seed| Truth { n: 0.01, k: 0.02, ..Truth::default() }.noise(100_000, seed);
    for (rates, exception) in
        [([quiet(84), loud(85), quiet(86), quiet(87)], 1), ([loud(88), loud(89), quiet(90), loud(91)], 2)]
    {
        let pool = pool_of(&rates).unwrap();
        let found: Vec<(usize, bool)> =
            pool.outliers.iter().map(|outlier| (outlier.record, outlier.is_left_out)).collect();
        assert_eq!(found, [(exception, true)], "{:?}", pool.outliers);
    }
}

#[test]
fn one_record_or_different_rates_are_not_a_pool() {
    let rate = HOUR.noise(20_000, 75);
    let fit = of(&rate);
    let at = |rate_hz| PoolRecord { rate: &rate, rate_hz, fit: &fit };
    assert_eq!(fit_pool(&[at(100.0)]).unwrap_err(), PoolError::TooFew { records: 1 });
    let rates = fit_pool(&[at(100.0), at(200.0)]).unwrap_err();
    assert!(rates.to_string().contains("100.000 and 200.000 Hz"), "{rates}");
}

/// Every record has a glitch. The bound of the Gauss–Markov term depends on the length of the longest record.
#[test]
fn a_pool_of_cleaned_records_knows_their_length() {
    let truth = Truth { n: 0.03, sigma: 0.02, tau_s: 3.0, ..Truth::default() };
    let rate = |seed| {
        let mut rate = truth.noise(100_000, seed);
        rate[50_000] = 50.0;
        rate
    };
    let fit = pool_of(&[rate(78), rate(79)]).unwrap().fit;
    assert_eq!(fit.span_s, (0.01, 500.0));
    assert!(fit.k.needed_s.unwrap() > 1000.0, "{:?}", fit.k);
    assert!(
        matches!(fit.terms[..], [Term::GaussMarkov { tau_s, .. }] if near(tau_s.value, 3.0, 0.3)),
        "{:?}",
        fit.terms
    );
}

#[test]
fn a_pool_has_no_drift_of_one_record() {
    let still = Truth { k: 0.0, ..HOUR };
    let mut rates: Vec<Vec<f64>> = (76..79).map(|seed| still.noise(180_000, seed)).collect();
    let clean = pool_of(&rates).unwrap();
    rates[1].iter_mut().enumerate().for_each(|(i, rate)| *rate += 0.1 * (-(i as f64) / RATE_HZ / 300.0).exp());
    let pool = pool_of(&rates).unwrap();
    assert!(
        pool.used == [0, 1, 2] && near(pool.fit.b.value, clean.fit.b.value, 0.15),
        "{:?} {:?}",
        pool.outliers,
        pool.fit.b
    );
    // when the warm-up was part of the common model, K was 1e-3
    assert!(pool.fit.k.value < 4e-4, "{:?}", pool.fit.k);
}
