//! Uses the Rust crates to compute the output that `bindings/c/tests/agree.c` must print about driver, corrections,
//! tracker, self-test, and the procedure on fixed memory.

use crate::trial::Rig;
use adis16130::{RateCode, Sample, SelfTestPlan, TempCode, WaitBound};
use adis16130_twin::Spec;
use anyhow::{Context, Result, anyhow, ensure};
use std::fmt::Write;
use zerorate::track::{Prior, Tracked, Tracker, TrackerConfig};
use zerorate::{
    Action, Axis, CodeTable, Corrected, Correction, Corrector, CorrectorConfig, Event, FixedProcedure, Method,
    Outcome, Plan, Reading, Refusal, State, Validity, Warning, WindowWarnings,
};

/// The correction of the test, as a calibration file.
pub const CALIBRATION: &str =
    "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 26.0\n";

const CORRECTION: Correction = Correction::line(-0.25, -0.04, 26.0);
const CURVED: Correction = Correction { btc2_dps_per_c2: 0.0005, btc3_dps_per_c3: -2e-6, ..CORRECTION };
const SAMPLES: usize = 500;
const ROWS: usize = 201;

/// The expected results of misuse. The status numbers of bindings/c/src/status.rs are typed again here, so that the
/// test fails if one changes.
const MISUSE: &str = "no settings -1\nno gyro -1\nnot set up -2\nnot begun -2\nseven bits -3\nno transfer -1\nno \
    average -40\n\
    steep -30\ncurved -30\nsteep curve -30\n\
    ragged -31\nno room -32\nno table -3\nlaid out 0\nabove -34 -4800\nbelow -34 4800\nno row -1\nno \
    correction 77\n\
    RDY gave no sign of new data in time; check its wire and edge, and the supply. unknown status.\n";
/// The expected results of failing reads, with the status numbers typed again. RDY counts as silent after 64 periods
/// of 175.7 µs (F-31).
const NO_NUMBERS: &str = "framing 1\nset up 0\nwithout initialisation -25\ninitialise 0\nbefore the first conversion \
    -25\nconverted 0\n\
    dip -22\ninitialise 0\nbroken -10\nafter it -15\ninitialise 0\nuntouched 7 7\nwhole 0\nheard 0\nquiet 0\nsilent \
    -12\n\
    initialise 0\nbeyond the scale -24\n";
const FAULTS: &str = "diagnose 0\nzeros -21\nones -20\ndip -22\nagain 0\ncut -12\n";
/// The expected results of failing self-tests. After the pin was set, the last call must set it low, unless that call
/// is refused.
const SELF_TEST_FAULTS: &str = "no pin -1\nno plan -1\nno result -1\nno function -13\n\
    low refused -14\ncalls 1 level 0 n 7\nhigh refused -14\ncalls 3 level 0 n 7\n\
    release refused -14\ncalls 3 level 1 n 7\ncut -12\ncalls 3 level 0 n 7\nzeros -21\ncalls 3 level 0 n 7\n\
    not set up -2\ncalls 0 level 0 n 7\nbroken rdy -11\ncalls 1 level 0 n 7\n\
    no rdy -13\ncalls 0 level 0 n 7\nno delay -13\ncalls 0 level 0 n 7\n";

pub fn text(seed: u64) -> Result<String> {
    let quick = "mclk_hz=1000000,warmup_s=10,curvature=0,hysteresis=0";
    let mut text = MISUSE.to_owned();
    stream(&mut text)?;
    track(&mut text)?;
    text.push_str(NO_NUMBERS);
    samples(&mut text, &format!("seed={seed}"))?;
    self_test(&mut text, &format!("seed={seed}"))?;
    calibrate(&mut text, &format!("seed={seed},{quick}"))?;
    calibrate(&mut text, &format!("seed={seed},{quick},motion=sway"))?;
    Ok(text)
}

/// The expected output about correcting a stream of readings, with the status numbers typed again. Output variables
/// that are not written keep their initial value 7.
fn stream(text: &mut String) -> Result<()> {
    let validity = Some(Validity { temp_min_c: 25.0, temp_max_c: 33.0, margin_c: 0.5 });
    let mut corrector = Corrector::new(CorrectorConfig { corrections: [CORRECTION], validity });
    let mut take = |text: &mut String, rate_dps, read_c| {
        let Corrected { rate_dps, temp_c, extrapolated } = corrector.take(rate_dps, read_c);
        match rate_dps.zip(temp_c) {
            Some((rate_dps, temp_c)) => line(text, 0, rate_dps, temp_c, extrapolated.into()),
            None => line(text, 1, 7.0, 7.0, 7),
        }
    };
    line(text, -2, 7.0, 7.0, 7)?;
    text.push_str("no correction -1\nbegin 0\n");
    for (rate_dps, read_c) in [
        (Some(0.5), None),
        (Some(0.5), Some(30.0)),
        (Some(-0.25), None),
        (None, Some(33.25)),
        (Some(0.125), Some(34.0)),
    ] {
        take(text, rate_dps, read_c)?;
    }
    text.push_str("begin 0\n");
    line(text, 0, CORRECTION.apply(0.125, 34.0), 34.0, 0)?;
    text.push_str("nowhere -1\n");
    Ok(())
}

fn line(text: &mut String, status: i32, rate_dps: f64, temp_c: f64, extrapolated: u8) -> Result<()> {
    writeln!(text, "taken {status}")?;
    f64_line(text, "rate_dps", rate_dps)?;
    f64_line(text, "temp_c", temp_c)?;
    Ok(writeln!(text, "extrapolated {extrapolated}")?)
}

/// The expected output about tracking: a minute at rest with another bias than calibrated, a rotation, a rest, a
/// missing mean (which counts as a motion), a day without power, and an invalid state.
fn track(text: &mut String) -> Result<()> {
    let prior = Prior {
        u_pbc_dps: 0.003,
        u_btc_dps_per_c: 0.003,
        cov_pbc_btc_dps2_per_c: 0.0,
        u_curvature_dps_per_c2: 0.0005, // M-02
    };
    let config = TrackerConfig::of(&Axis::ADIS16130, CORRECTION, prior);
    let mut tracker = Tracker::new(config).aged(0.0);
    text.push_str("bias -2\nchange_dps 401c000000000000\nu_dps 401c000000000000\nphase 7\nbegin 0\n");
    for (blocks, rate_dps) in [(600, 0.254), (20, 5.254), (400, 0.254)] {
        for _ in 0..blocks {
            tracker.push(Some(rate_dps), Some(26.0), true);
        }
        bias(text, &tracker)?;
    }
    tracker.push(None, Some(26.0), true);
    let saved = tracker.save();
    writeln!(text, "push 0\nsave 0\nlearned {}\nresume 0", saved.counts.learned_s)?;
    bias(text, &Tracker::resume(config, &saved, 86_400.0).map_err(|_| anyhow!("an unsound state"))?)?;
    text.push_str("unsound -3\n");
    Ok(())
}

fn bias(text: &mut String, tracker: &Tracker) -> Result<()> {
    let Tracked { change_dps, u_dps, phase } = tracker.tracked(27.0);
    text.push_str("bias 0\n");
    f64_line(text, "change_dps", change_dps)?;
    f64_line(text, "u_dps", u_dps)?;
    Ok(writeln!(text, "phase {}", phase as u8)?)
}

/// A unit of the twin, initialised as `agree.c` initialises it.
fn initialised(keys: &str) -> Result<Rig> {
    let mut rig = Rig::new(Spec::parse_keys(keys)?);
    rig.gyro.restart().map_err(|error| anyhow!("{error}"))?;
    rig.sampler.restarted();
    Ok(rig)
}

fn samples(text: &mut String, keys: &str) -> Result<()> {
    let mut rig = initialised(keys)?;
    text.push_str("initialise 0\ninteger 0\ncurve 0\ncurved 0\nsingle 0\ntable 0\n");
    let Axis { rate, temp, .. } = Axis::ADIS16130;
    let (integer, single) = (CORRECTION.to_integer(&rate, &temp)?, CORRECTION.to_f32());
    let (curve, curved) = (CURVED.to_integer_curve(&rate, &temp)?, CURVED.to_f32());
    let mut rows = [0; ROWS];
    CORRECTION.fill_table(0.02, 2.0, &mut rows)?;
    let table = CodeTable::new(&rows, 0.02, CORRECTION.t3_c, &Axis::ADIS16130.temp);
    for _ in 0..SAMPLES {
        let Sample { t_ns, seq, rate, temp, lost, .. } = rig.read()?;
        let temp = temp.context("a sample without temperature")?;
        let (rate_code, temp_code) = (rate.code24(), temp.code24());
        let corrected = integer.apply(rate_code, temp_code);
        let f32_bits = single.apply(rate.to_dps(), temp.to_celsius()).to_bits();
        let row = table.look_up_udps(temp_code).context("beyond the table")?;
        let time = t_ns as u32;
        writeln!(
            text,
            "{time} {seq} {rate_code} {temp_code} {lost} {corrected} {f32_bits:x} {row} {corrected} {row}"
        )?;
        let f32_bits = curved.apply(rate.to_dps(), temp.to_celsius()).to_bits();
        writeln!(text, "curve {} {f32_bits:x}", curve.apply(rate_code, temp_code))?;
    }
    f64_line(text, "f64", CORRECTION.apply(0.33, 33.5))?;
    f64_line(text, "curved f64", CURVED.apply(0.33, 33.5))?;
    CURVED.fill_table(0.02, 2.0, &mut rows)?;
    let table = CodeTable::new(&rows, 0.02, CURVED.t3_c, &Axis::ADIS16130.temp);
    // 27 °C, one degree above T3 of the correction
    let row = table.look_up_udps(8_416_794).context("beyond the table")?;
    writeln!(text, "no curve 77\ncurved table 0\ncurved row 0 {row}")?;
    let ready = rig.gyro.wait_ready(&mut rig.twin.delay(), WaitBound::from_us(1000));
    ready.map_err(|error| anyhow!("{error}"))?;
    let (rate, temp): (RateCode, TempCode) = rig.gyro.read_in_range().map_err(|error| anyhow!("{error}"))?;
    writeln!(text, "wait 0\nread 0\n{} {}", rate.code24(), temp.code24())?;
    text.push_str(FAULTS);
    Ok(())
}

fn self_test(text: &mut String, keys: &str) -> Result<()> {
    let Rig { twin, mut gyro, .. } = initialised(keys)?;
    let seen = gyro.self_test(&mut twin.self_test_pin(), &mut twin.delay(), SelfTestPlan::new(500));
    let seen = seen.map_err(|error| anyhow!("{error}"))?;
    // the twin's self-test is 20 °/s at the sensing element, and the sensitivity varies by 3 % (M-07)
    ensure!((seen.shift_dps - 20.0).abs() < 4.0, "{seen:?}");
    text.push_str("initialise 0\nplan 0\n100000 20000 6000\nself-test 0\n");
    writeln!(text, "shift_dps {:08x}\nu_dps {:08x}", seen.shift_dps.to_bits(), seen.u_dps.to_bits())?;
    writeln!(text, "n {} calls 3 level 0\nuntil {}", seen.n, twin.now_ns() as u32)?;
    text.push_str(SELF_TEST_FAULTS);
    Ok(())
}

const PLAN: Plan = Plan {
    method: Method::An1042,
    target_dps: None,
    average_s: 2.0,
    warmup_s: 20.0,
    settle_s: 10.0,
    offset_s: 6.0,
    final_temp_s: 0.5,
    max_lost: 0.001,
    max_u_btc_dps_per_c: 0.05,
    earth_dps: Some(0.003),
    assume_linear: true,
};

fn calibrate(text: &mut String, keys: &str) -> Result<()> {
    let mut rig = initialised(keys)?;
    text.push_str("initialise 0\nbegin 0\ntoo early -2\nfirst 0\n");
    let mut procedure = FixedProcedure::on_fixed_memory(&Axis::ADIS16130, PLAN)?;
    let mut seen = procedure.handle(Event::Initialised { t_ns: rig.twin.now_ns() });
    while seen.is_ok() && procedure.next() != Action::Done {
        seen = procedure.handle(Event::Reading(&Reading::from(&rig.read()?)));
    }
    let ended = seen.map_or_else(|refusal| number(&refusal), |()| 0);
    let remedies: Vec<String> = match &seen {
        Err(refusal) => refusal.remedies().iter().map(|remedy| remedy.code().to_string()).collect(),
        Ok(()) => Vec::new(),
    };
    let progress = procedure.progress();
    // a step of the C interface has the number of the procedure's state plus 3, except that the end stays 10
    let step = if progress.state == State::Done { 10 } else { 3 + progress.state as u32 };
    writeln!(text, "ended {ended}\nremedies [{}]\nstep {step}", remedies.join(","))?;
    f64_line(text, "elapsed_s", progress.elapsed_s)?;
    f64_line(text, "total_s", progress.total_s)?;
    writeln!(text, "outcome {ended}")?;
    if seen.is_ok() { outcome_lines(text, &procedure.outcome()?) } else { Ok(()) }
}

fn outcome_lines(text: &mut String, outcome: &Outcome<WindowWarnings>) -> Result<()> {
    let (correction, uncertainty) = (&outcome.correction, &outcome.uncertainty);
    let means = outcome.means.context("the procedure of AN-1042 has means")?;
    let lines = [
        ("pbc_dps", correction.pbc_dps),
        ("btc_dps_per_c", correction.btc_dps_per_c),
        ("t3_c", correction.t3_c),
        ("u_pbc_dps", uncertainty.u_pbc_dps),
        ("u_btc_dps_per_c", uncertainty.u_btc_dps_per_c),
        ("u_t3_c", uncertainty.u_t3_c),
        ("b1_dps", means.b1_dps),
        ("b2_dps", means.b2_dps),
        ("t1_c", means.t1_c),
        ("t2_c", means.t2_c),
        ("temp_min_c", outcome.temp_min_c),
        ("temp_max_c", outcome.temp_max_c),
        ("white", outcome.noise.model.white_dps_per_rt_hz),
        ("rate_hz", outcome.rate_hz),
    ];
    for (name, value) in lines {
        f64_line(text, name, value)?;
    }
    let warnings: u32 = outcome.warnings.iter().map(flag).sum();
    writeln!(text, "samples {} lost {} warnings {warnings}", outcome.samples, outcome.lost_samples)?;
    Ok(())
}

fn f64_line(text: &mut String, name: &str, value: f64) -> Result<()> {
    Ok(writeln!(text, "{name} {:016x}", value.to_bits())?)
}

/// The status number of a refusal in the C interface, typed again.
fn number(refusal: &Refusal) -> i32 {
    match refusal {
        Refusal::Moving { .. } => -50,
        Refusal::Turning { .. } => -51,
        Refusal::Noisy { .. } => -52,
        Refusal::Span { .. } => -53,
        Refusal::Curvature { .. } => -54,
        Refusal::Lost { .. } => -55,
        Refusal::Overranged { .. } => -56,
        Refusal::Frozen { .. } => -57,
        Refusal::TooFew { .. } => -58,
        Refusal::NoTemperature { .. } => -59,
        Refusal::Unsteady { .. } => -61,
        _ => -60,
    }
}

fn flag(warning: &Warning) -> u32 {
    match warning {
        Warning::EarthIncluded => 1,
        Warning::CurvatureUnseen { .. } => 2,
        Warning::Drifting { .. } => 4,
        Warning::ShortAverage { .. } => 8,
        Warning::Aliased { .. } => 16,
        Warning::Lost { .. } => 32,
        Warning::Wandering { .. } => 64,
        Warning::EarthSubtracted { .. } => 256,
        Warning::Flat { .. } => 512,
        Warning::HourUnchecked => 1024,
        _ => 128,
    }
}
