//! Tests faults that begin at the specified time or by a call. Other crates test how a host detects them.

use crate::bus::{Host, INIT, dps, quiet};
use adis16130_twin::{Fault, Motion, Spec};
use embedded_hal::digital::InputPin;

#[test]
fn bit_errors_come_at_their_rate() {
    let rate = 1e-3;
    let mut host = Host::new(Spec { bit_error_rate: rate, ..quiet() });
    let mut wrong = 0;
    let reads = 20_000;
    for _ in 0..reads {
        // A flipped bit in the command can leave the link out of step, so a reset follows each read.
        wrong += u32::from(host.byte(0x02) != 0x24);
        host.spi_reset();
    }
    // A flip in the 8 bits of the command or the 8 of the answer spoils the read. Flips in a reset spoil a few more.
    let expected = f64::from(reads) * 16.0 * rate;
    assert!((f64::from(wrong) / expected - 1.0).abs() < 0.25, "{wrong} of {expected}");
}

#[test]
fn unplug_and_replug() {
    let spec = Spec { fault: Fault::Unplug, fault_at_s: Some(0.01), rotation_dps: 10.0, ..quiet() };
    let mut host = Host::started(spec);
    assert_eq!(host.pair().1, 8_623_488, "well before the fault");
    host.twin.advance_ns(10_000_000);
    assert_eq!(host.code24(0x08), 0xFF_FFFF);
    assert!(host.twin.rdy().is_high().unwrap());
    host.twin.power_on(); // has no effect without the cable
    assert_eq!(host.byte(0x38), 0xFF);
    host.twin.replug();
    assert_eq!(host.byte(0x38), 0x00);
    host.send(&INIT);
    host.twin.next_falling_edge(0);
    assert_eq!(host.pair().1, 8_623_488);
}

#[test]
fn power_cycle_resets() {
    let mut host = Host::started(quiet());
    host.twin.power_off();
    assert_eq!(host.byte(0x38), 0xFF);
    host.twin.power_on();
    assert_eq!(host.byte(0x38), 0x00);
    assert!(host.twin.next_falling_edge(1_000_000).is_none());
}

#[test]
fn supply_step_shifts_the_bias() {
    let mut host = Host::started(Spec { supply_step_mv: 100.0, ..quiet() });
    host.twin.advance_ns(59_000_000_000);
    assert!(dps(host.pair().1).abs() < 1e-4);
    host.twin.advance_ns(2_000_000_000);
    host.pair(); // takes the latched edge
    assert!((dps(host.pair().1) - 0.02).abs() < 1e-4);
    assert!((host.twin.truth().pbc_dps(25.0) + 0.02).abs() < 1e-9);
}

#[test]
fn motion_sways_and_bumps() {
    let mut host = Host::started(Spec { motion: Motion::Bump, fault_at_s: Some(1.0), ..quiet() });
    let peak = |host: &mut Host, seconds: f64| host.rates((seconds * 5692.6) as usize).into_iter().fold(0.0, f64::max);
    assert!(peak(&mut host, 0.95) < 1e-4);
    assert!((peak(&mut host, 0.3) - 3.0).abs() < 0.01);
    assert!(peak(&mut host, 2.0) < 1e-4);
    host.twin.set_motion(Motion::Sway);
    assert!((peak(&mut host, 5.0) - 0.5).abs() < 0.001);
    host.twin.set_motion(Motion::None);
    host.twin.advance_ns(10_000_000);
    host.pair();
    assert!(peak(&mut host, 0.5) < 1e-4);
}
