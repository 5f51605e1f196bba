//! One thread reads a device for all readers: lossless readers get every sample, and the thread waits for no watcher.

use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use zerorate_host::{
    AmbientProfile, Cause, DeviceSpec, Hub, LosslessReader, Pace, Poll, Sampling, Setup, Stop, Watcher,
};

fn hub(device: &str, stop: &Stop) -> Hub {
    let spec: DeviceSpec = device.parse().expect("a device");
    let hub = Hub::open(&spec, Setup::default(), stop).expect("a hub");
    hub.with(|source| source.initialise()).expect("a part");
    hub
}

/// Number of samples, number of lost samples, and the time from the first sample to the last, s. `most` becomes the
/// largest resident memory, bytes.
fn recorded(everything: &LosslessReader, most: &AtomicU64) -> (u64, u64, f64) {
    let (mut samples, mut lost, mut span_ns) = (0, 0, None);
    while let Some(batch) = everything.next().expect("samples") {
        for sample in &batch.rows {
            let (first_ns, last_seq) = *span_ns.get_or_insert((sample.t_ns, sample.edge_seq));
            assert!(samples == 0 || sample.edge_seq > last_seq, "each sample once, in order");
            span_ns = Some((first_ns, sample.edge_seq));
            samples += 1;
            lost += u64::from(sample.lost);
        }
        let (first_ns, _) = span_ns.expect("a sample");
        let now_ns = batch.rows.last().map_or(first_ns, |last| last.t_ns);
        most.fetch_max(resident_bytes(), Ordering::Relaxed);
        if now_ns - first_ns >= SECONDS * 1_000_000_000 {
            return (samples, lost, (now_ns - first_ns) as f64 * 1e-9);
        }
    }
    panic!("the twin has no end");
}

const SECONDS: u64 = 10;
const WATCHERS: usize = 20;
/// Number of batches that can wait for a watcher.
const QUEUE: usize = 8;

/// Number of samples that a watcher received, and number of samples that it was told it had missed.
fn watched(watcher: &Watcher) -> (u64, u64) {
    let (mut got, mut missed) = (0, 0);
    while let Some(watched) = watcher.next() {
        got += watched.batch.rows.len() as u64;
        missed += watched.missed;
    }
    (got, missed)
}

#[cfg(target_os = "linux")]
fn resident_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("the kernel tells");
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")?.trim().strip_suffix(" kB"));
    resident.and_then(|kib| kib.parse::<u64>().ok()).expect("a number") * 1024
}

#[cfg(not(target_os = "linux"))]
fn resident_bytes() -> u64 {
    0
}

/// Two parts are read at their full rate for 10 s of wall-clock time. Each has 20 watchers, one of which never reads.
#[test]
fn two_parts_are_recorded_whole_whoever_watches() {
    let stop = Stop::default();
    let (begun, most) = (Instant::now(), AtomicU64::new(0));
    let before = resident_bytes();
    thread::scope(|scope| {
        for seed in [1, 2] {
            let (stop, most) = (stop.clone(), &most);
            scope.spawn(move || {
                let hub = hub(&format!("twin:seed={seed}"), &stop);
                let everything = hub.everything();
                let idle = hub.watch(QUEUE);
                let watchers: Vec<Watcher> = (1..WATCHERS).map(|_| hub.watch(QUEUE)).collect();
                let watching: Vec<_> =
                    watchers.into_iter().map(|watcher| scope.spawn(move || watched(&watcher))).collect();
                hub.read(Pace::RealTime, Vec::new()).expect("a thread");
                let (samples, lost, seconds) = recorded(&everything, most);
                // F-31: 5692.6 a second at the nominal clock, which is good to 1 % (M-06)
                let rate_hz = samples as f64 / seconds;
                assert!((5_600.0..5_800.0).contains(&rate_hz) && lost == 0, "{rate_hz} Hz, {lost} lost");
                drop((hub, everything));
                for watcher in watching {
                    let (got, missed) = watcher.join().expect("a watcher");
                    assert!(got + missed <= samples + 4096 && got > 0, "{got} and {missed} of {samples}");
                }
                // the idle watcher only has the batches that fit into its queue
                let (got, _) = watched(&idle);
                assert!(got < samples / 20, "{got} of {samples} waited for who never read");
            });
        }
    });
    assert!(begun.elapsed() >= Duration::from_secs(SECONDS - 1), "no faster than the wall clock");
    let grown = most.load(Ordering::Relaxed).saturating_sub(before);
    assert!(grown < 64 << 20, "{grown} bytes more than at the beginning");
}

#[test]
fn a_watcher_that_comes_late_or_sleeps_is_told_what_it_missed() {
    let hub = hub("twin:seed=3", &Stop::default());
    let everything = hub.everything();
    let watcher = hub.watch(2);
    hub.read(Pace::Free, Vec::new()).expect("a thread");
    let mut seen = 0;
    for _ in 0..10 {
        seen += everything.next().expect("samples").expect("a batch").rows.len() as u64;
    }
    let late = hub.watch(2);
    let (first, second) = (watcher.next().expect("a batch"), watcher.next().expect("a batch"));
    assert_eq!((first.missed, second.missed), (0, 0));
    everything.next().expect("samples");
    let third = watcher.next().expect("a batch");
    let gap = third.batch.rows[0].edge_seq - second.batch.rows.last().expect("a sample").edge_seq;
    assert!(third.missed >= seen / 2 && u64::from(gap) > third.missed, "{} missed, {gap} edges", third.missed);
    while everything.next().is_ok_and(|batch| batch.is_some()) && late.next().is_none() {}
}

#[test]
fn a_stop_ends_one_hub_and_no_other() {
    let (one, other) = (Stop::default(), Stop::default());
    let (ends, goes_on) = (hub("twin:seed=4", &one), hub("twin:seed=5", &other));
    let (all, others) = (ends.everything(), goes_on.everything());
    ends.read(Pace::Free, Vec::new()).expect("a thread");
    goes_on.read(Pace::Free, Vec::new()).expect("a thread");
    assert!(all.next().expect("samples").is_some());
    one.ask();
    while all.next().expect("no failure").is_some() {}
    assert!((0..50).all(|_| others.next().expect("samples").is_some()));
}

#[test]
fn a_fault_reaches_everybody_who_must_know_behind_the_last_sample() {
    let hub = hub("twin:seed=6,fault=unplug,fault_at_s=2", &Stop::default());
    let (one, other, watcher) = (hub.everything(), hub.everything(), hub.watch(4));
    hub.read(Pace::Free, Vec::new()).expect("a thread");
    let mut samples = 0;
    for everything in [one, other] {
        samples = 0;
        let error = loop {
            match everything.next() {
                Ok(Some(batch)) => samples += batch.rows.len(),
                Ok(None) => panic!("it ended without a word"),
                Err(error) => break error,
            }
        };
        assert_eq!(error.cause(), Cause::Gone, "{error:#}");
    }
    assert!((10_000..11_500).contains(&samples), "2 s of samples, not {samples}");
    while !matches!(watcher.next_within(Duration::from_secs(5)), Poll::End) {}
    assert_eq!(hub.failure().expect("a watcher asks the hub").cause(), Cause::Gone);
}

#[test]
fn a_marked_batch_ends_with_its_sample_and_states_the_truth_of_it() {
    let hub = hub("twin:seed=7,warmup_c=8", &Stop::default());
    let everything = hub.everything();
    hub.read(Pace::Free, vec![1_500_000_000]).expect("a thread");
    let mut start_ns = None;
    loop {
        let batch = everything.next().expect("samples").expect("a batch");
        let (first, last) = (batch.rows[0].t_ns, batch.rows[batch.rows.len() - 1].t_ns);
        let start_ns = *start_ns.get_or_insert(first);
        if last - start_ns >= 1_500_000_000 {
            assert!(last - start_ns < 1_500_400_000 && !batch.truths.is_empty(), "{} ns", last - start_ns);
            return;
        }
    }
}

#[test]
fn a_failure_to_open_reaches_the_thread_that_asked() {
    let refused = |device: &str, sampling: Sampling| {
        let spec: DeviceSpec = device.parse().expect("an address");
        let hub = Hub::open(&spec, Setup { sampling, ..Setup::default() }, &Stop::default());
        hub.map(drop).expect_err("nothing is there").cause()
    };
    assert_eq!(refused("replay:/nowhere/x.arrows", Sampling::default()), Cause::File);
    assert_eq!(refused("replay:x", Sampling { divider: Some(2), every_temp: None }), Cause::Request);
}

#[test]
fn the_speed_of_time_can_be_changed_while_it_passes() {
    let hub = hub("twin:seed=8", &Stop::default());
    let everything = hub.everything();
    hub.read(Pace::RealTime, Vec::new()).expect("a thread");
    hub.speed().set(0.001);
    while !matches!(everything.next_within(Duration::from_millis(300)).expect("samples"), Poll::Nothing) {}
    hub.speed().set(0.0);
    let mut samples = 0;
    while samples < 20_000 {
        samples += everything.next().expect("samples").expect("a batch").rows.len();
    }
}

/// The written values come from F-30, typed again from docs/facts.md.
#[test]
fn the_registers_of_the_twin_can_be_read_before_its_samples() {
    for device in ["twin:", "twin:axes=3"] {
        let hub = hub(device, &Stop::default());
        let registers = hub.with(|source| source.registers()).expect("registers").expect("the twin has some");
        let of = |address: u8| registers.values.iter().find(|(at, _)| *at as u8 == address).map(|(_, value)| *value);
        let written = [(0x28, 0x0A), (0x30, 0x05), (0x2A, 0x0A), (0x32, 0x05), (0x38, 0x22)];
        for (address, value) in written {
            assert_eq!(of(address), Some(value), "{address:02X}h of {device}");
        }
        assert_eq!((registers.values.len(), of(0x01).map(|iop| iop & 0x3F)), (13, Some(0x38)));
        let everything = hub.everything();
        hub.read(Pace::Free, Vec::new()).expect("a thread");
        assert_eq!(everything.next().expect("samples").expect("a batch").rows[0].lost, 0, "{device}");
    }
}

/// A chamber changes the ambient temperature at each mark. With these seeds, one sample comes 20 µs before a mark.
#[test]
fn a_part_waits_for_its_air_only_behind_the_mark_at_which_that_moves() {
    const SECOND_NS: u64 = 1_000_000_000;
    let sampling = Sampling { divider: Some(50), ..Sampling::default() };
    for seed in [4, 166, 169] {
        let (ambient, writer) = AmbientProfile::with_writer();
        let setup = Setup { sampling, ambient: Some(ambient), ..Setup::default() };
        let spec: DeviceSpec = format!("twin:seed={seed}").parse().expect("a device");
        let hub = Hub::open(&spec, setup, &Stop::default()).expect("a hub");
        hub.with(|source| source.initialise()).expect("a part");
        // the writer is dropped before the hub: the hub waits for its thread, and the thread waits for the writer
        let (everything, writer) = (hub.everything(), writer);
        hub.read(Pace::Free, (0..=400).map(|second| second * SECOND_NS).collect()).expect("it begins");
        for second in 0..400 {
            let poll = everything.next_within(Duration::from_secs(60)).expect("samples");
            let Poll::Samples(batch) = poll else { panic!("seed {seed}: no mark after {second} s") };
            let marked = batch.rows.last().expect("a sample");
            writer.ramp_to(25.0, marked.t_ns + SECOND_NS);
        }
        hub.stop().ask();
    }
}
