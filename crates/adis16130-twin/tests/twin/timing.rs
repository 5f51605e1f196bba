//! Tests the times at which conversions end (F-31) and RDY changes (F-32), and lost samples (F-33).

use crate::bus::{Host, INIT, dps, quiet};
use adis16130_twin::{Motion, Spec};
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_hal::spi::SpiDevice;

/// Number of edges of RDY per simulated second, with a read of these registers after each edge.
fn edges_per_second(host: &mut Host, registers: &[u8]) -> f64 {
    let mut edge = || {
        let edge = host.edge();
        registers.iter().for_each(|address| _ = host.code24(*address));
        edge
    };
    edge();
    let first = edge();
    let mut last = first;
    for _ in 0..2000 {
        last = edge();
    }
    f64::from(last.seq - first.seq) / ((last.t_ns - first.t_ns) as f64 * 1e-9)
}

fn near(rate: f64, expected: f64) {
    assert!((rate / expected - 1.0).abs() < 1e-4, "{rate} Hz, expected {expected}");
}

#[test]
fn reading_on_every_nth_edge_gives_f_conv_over_n_plus_1() {
    for (n, hz) in [(1u32, 5692.6), (2, 3795.1), (3, 2846.3), (50, 223.24)] {
        let mut host = Host::started(quiet());
        let first = host.pair().0;
        let mut last = first;
        for _ in 0..200 {
            for _ in 1..n {
                host.edge();
            }
            last = host.pair().0;
        }
        near(200.0 / ((last.t_ns - first.t_ns) as f64 * 1e-9), hz);
        assert_eq!(last.seq - first.seq, 200 * n);
    }
}

#[test]
fn edges_come_by_the_clock_and_by_what_is_read() {
    for (mclk_hz, iop, read, hz) in [
        (6.144e6, 0x38, &[][..], 11_658.4),
        // the temperature stays unread, so all channels are unread again after each rate conversion
        (6.0e6, 0x38, &[0x08][..], 5692.6),
        // without RDYFN any unread channel pulls RDY down
        (6.0e6, 0x30, &[0x08, 0x0A][..], 11_385.2),
    ] {
        let mut host = Host::started(Spec { mclk_hz, ..quiet() });
        host.send(&[0x01, iop]);
        near(edges_per_second(&mut host, read), hz);
    }
}

#[test]
fn conversion_times_are_f31() {
    let cycles = |setup: [u8; 2], words: [u8; 2]| {
        let mut host = Host::new(quiet());
        host.send(&[0x01, 0x30, 0x28, setup[0], 0x30, words[0], 0x2A, setup[1], 0x32, words[1], 0x38, 0x22]);
        let edges = [0; 3].map(|_| host.edge().t_ns);
        [edges[1] - edges[0], edges[2] - edges[1]].map(|ns| (ns as f64 * 6e-3).round() as u64)
    };
    let (on, off) = (0x0A, 0x02);
    // With both channels, the second edge ends a conversion of the temperature, and the third one of the rate.
    assert_eq!(cycles([on, on], [5, 5]), [527, 527]);
    assert_eq!(cycles([on, on], [5, 17]), [17 * 64 + 207, 527]);
    assert_eq!(cycles([on, on], [0x85, 0x91]), [17 * 128 + 249, 5 * 128 + 249]);
    assert_eq!(cycles([on, on], [0x7F, 5]), [527, 127 * 64 + 207]);
    assert_eq!(cycles([on, off], [5, 5]), [526, 526]);
    assert_eq!(cycles([off, on], [5, 0x85]), [5 * 128 + 248; 2]);
}

#[test]
fn rdy_rises_when_a_channel_is_read_with_rdyfn() {
    let mut host = Host::started(quiet());
    let mut rdy = host.twin.rdy();
    host.edge();
    assert!(rdy.is_low().unwrap());
    host.code24(0x08);
    assert!(rdy.is_high().unwrap());
}

#[test]
fn edges_are_latched_and_counted() {
    let mut host = Host::started(quiet());
    let first = host.edge();
    host.twin.advance_ns(10 * 87_834);
    let latched = host.edge();
    assert_eq!(latched.seq, first.seq + 10);
    assert!(latched.t_ns < host.twin.now_ns());
    assert_eq!(host.edge().seq, first.seq + 11);
    let now = host.twin.now_ns();
    assert_eq!(host.twin.next_falling_edge(1000), None);
    assert_eq!(host.twin.now_ns(), now + 1000);
}

#[test]
fn unread_data_is_overwritten_and_counted() {
    let mut host = Host::started(quiet());
    host.edge();
    for _ in 0..10 {
        host.edge();
    }
    let lost = host.twin.lost_unread();
    assert_eq!((lost.rate.overwritten, lost.temp.overwritten), (5, 5));
    assert_eq!((lost.rate.lost_new, lost.temp.lost_new), (0, 0));
}

/// A slow oscillation, so that successive samples have different codes.
fn swaying() -> Spec {
    Spec { motion: Motion::Sway, sway_dps: 100.0, sway_hz: 1.0, ..quiet() }
}

#[test]
fn a_register_that_is_being_read_loses_the_new_sample() {
    let mut host = Host::started(swaying());
    let mut twin = Host::started(swaying());
    let (_, before, _) = twin.pair();
    host.edge();
    host.send(&[0x48]);
    host.twin.advance_ns(100_000); // the next rate update falls in here
    let mut data = [0; 3];
    host.spi.read(&mut data).unwrap();
    assert_eq!(u32::from_be_bytes([0, data[0], data[1], data[2]]), before);
    assert_eq!(host.byte(0x20) & 0x08, 0, "no new data arrived");
    assert_eq!(host.code24(0x08), before, "the new sample is gone");
    assert_eq!(host.twin.lost_unread().rate.lost_new, 1);
    assert_eq!(host.twin.lost_unread().rate.overwritten, 0);
    host.code24(0x0A);
    let (_, after, _) = host.pair();
    assert!(dps(after) > dps(before), "the next one is stored again");
}

#[test]
fn a_reading_is_known_by_its_conversion() {
    let mut host = Host::started(swaying());
    let number = |host: &Host| host.twin.last_read().rate.unwrap().conversion.map(|conversion| conversion.number);
    assert_eq!(host.twin.last_read().rate, None, "nothing was read");
    host.code24(0x08);
    assert_eq!(number(&host), None, "nothing was converted");
    let (edge, code, _) = host.pair();
    let reading = host.twin.last_read().rate.unwrap();
    assert_eq!((reading.code, number(&host)), (code, Some(1)));
    assert_eq!(edge.t_ns - reading.conversion.unwrap().t_ns, 87_833, "the temperature comes between");
    host.code24(0x08);
    assert_eq!(number(&host), Some(1), "the same again");
    host.pair();
    host.edge();
    host.send(&[0x48]);
    host.twin.advance_ns(100_000); // the next rate update falls in here, and is dropped
    host.send(&[0x00; 3]);
    assert_eq!(number(&host), Some(3));
    host.pair();
    assert_eq!(number(&host), Some(5), "the fourth is counted");
    host.spi_reset();
    host.code16(0x08);
    assert_eq!(number(&host), None);
    host.send(&INIT);
    host.pair();
    assert!(number(&host) > Some(5), "the count goes on");
}

#[test]
fn an_update_of_the_other_channel_loses_nothing() {
    let mut host = Host::started(quiet());
    host.edge();
    host.send(&[0x4A]);
    host.twin.advance_ns(100_000);
    host.spi.read(&mut [0; 3]).unwrap();
    let lost = host.twin.lost_unread();
    assert_eq!((lost.temp.lost_new, lost.rate.lost_new, lost.rate.overwritten), (0, 0, 1));
}

#[test]
fn single_mode_converts_once_and_idles() {
    let mut host = Host::new(quiet());
    host.send(&INIT[..10]);
    for _ in 0..3 {
        host.send(&[0x38, 0x42]);
        assert_eq!(host.byte(0x38), 0x42);
        host.pair();
        assert_eq!(host.byte(0x38), 0x02);
        assert!(host.twin.next_falling_edge(1_000_000).is_none());
    }
}

#[test]
fn idle_power_down_and_no_channel_convert_nothing() {
    for mode in [0x02, 0x62, 0x82, 0xE2] {
        let mut host = Host::started(quiet());
        host.pair();
        host.send(&[0x38, mode]);
        host.twin.advance_ns(200_000);
        assert_eq!(host.byte(0x04), 0, "mode {mode:02X}");
    }
    let mut host = Host::new(quiet());
    host.send(&[0x38, 0x22]);
    assert!(host.twin.next_falling_edge(10_000_000).is_none());
    host.send(&[0x28, 0x0A]); // enabled later, so it begins then
    host.edge();
}

#[test]
fn sync_holds_and_restarts() {
    let mut host = Host::started(quiet());
    let mut sync = host.twin.sync_pin();
    host.pair();
    sync.set_low().unwrap();
    host.edge(); // without IOP.SYNC the pin means nothing
    host.send(&[0x01, 0x39]);
    host.code24(0x08);
    host.code24(0x0A);
    host.twin.next_falling_edge(0);
    assert!(host.twin.next_falling_edge(5_000_000).is_none());
    let released_ns = host.twin.now_ns();
    sync.set_high().unwrap();
    let (edge, _, _) = host.pair();
    assert!(edge.t_ns.abs_diff(released_ns + 175_667) <= 1, "two conversions from the start");
}

#[test]
fn a_register_write_that_lets_rdy_fall_is_an_edge() {
    let mut host = Host::started(quiet());
    let edge = host.pair().0;
    host.code24(0x08);
    host.twin.advance_ns(60_000); // rate is unread, temperature is not
    assert_eq!(host.byte(0x04), 0b001);
    assert!(host.twin.rdy().is_high().unwrap());
    host.send(&[0x01, 0x30]);
    assert!(host.twin.rdy().is_low().unwrap());
    assert_eq!(host.edge().seq, edge.seq + 1);
}

#[test]
fn the_next_event_is_the_next_edge() {
    let twin = adis16130_twin::Twin::new(quiet());
    assert_eq!(twin.next_event_ns(), None, "nothing happens by itself after power-on");
    let mut spi = twin.spi();
    spi.write(&INIT).expect("a bus");
    while let Some(t_ns) = twin.next_event_ns().filter(|t_ns| *t_ns < 10_000_000) {
        assert_eq!(twin.next_falling_edge(t_ns - twin.now_ns() - 1).map(|edge| edge.t_ns), None);
        twin.advance_ns(t_ns - twin.now_ns());
        // the rate is converted first, and RDY waits for both channels (F-32)
        let edge = twin.next_falling_edge(0);
        assert!(edge.is_none_or(|edge| edge.t_ns.abs_diff(t_ns) <= 1), "{edge:?} at {t_ns}");
    }
    assert!(twin.next_falling_edge(1_000_000).is_some_and(|edge| edge.seq > 100));
}
