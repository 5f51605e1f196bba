//! Tests of `docs/facts.md` section 3: addresses, reset values, access and widths of the registers.

use crate::bus::{Host, INIT, quiet};
use embedded_hal::digital::OutputPin;

/// Address, reset value, and mask of the bits that can be written.
const TABLE: [(u8, u8, u8); 12] = [
    (0x01, 0x70, 0x3F), // IOP: 30h, and pin 18 is high; P0 and P1 are inputs
    (0x02, 0x24, 0x00),
    (0x04, 0x00, 0x00),
    (0x20, 0x00, 0x00),
    (0x22, 0x40, 0x00),
    (0x28, 0x00, 0xFF),
    (0x2A, 0x00, 0xFF),
    (0x30, 0x91, 0xFF),
    (0x32, 0x91, 0xFF),
    (0x38, 0x00, 0x1F), // MODE without MD, so that nothing starts
    (0x03, 0x00, 0x00), // nothing there
    (0x3F, 0x00, 0x00),
];

#[test]
fn registers_have_their_reset_values() {
    let mut host = Host::new(quiet());
    for (address, reset, _) in TABLE {
        assert_eq!(host.byte(address), reset, "{address:02X}");
    }
    assert_eq!(host.code16(0x08), 0x8000);
    assert_eq!(host.code16(0x0A), 0x8000);
}

#[test]
fn writable_bits_are_kept_and_no_others() {
    for (address, reset, writable) in TABLE {
        for value in [0x00, 0x55, 0xAA, 0xFF] {
            let mut host = Host::new(quiet());
            // P0 and P1 of IOP stay inputs here. The test of IOP below makes them outputs.
            let inputs = if address == 0x01 { 0x30 } else { 0x00 };
            let written = value & writable | inputs;
            host.send(&[address, written]);
            let expected = reset & !writable | written & writable;
            assert_eq!(host.byte(address), expected, "{address:02X} <- {written:02X}");
            assert_eq!(host.byte(0x02), 0x24, "in step after {address:02X}");
        }
    }
}

#[test]
fn data_registers_ignore_writes_of_their_width() {
    let mut host = Host::new(quiet());
    host.send(&[0x08, 0x12, 0x34, 0x38, 0x02]);
    assert_eq!(host.code24(0x08), 0x80_0000);
    host.send(&[0x0A, 0x12, 0x34, 0x56]);
    assert_eq!(host.code24(0x0A), 0x80_0000);
}

#[test]
fn settings_without_effect_read_back() {
    let mut host = Host::started(quiet());
    host.send(&[0x28, 0x1B, 0x38, 0x3E]); // STATOPT and range; CLKDIS, DUMP, CONTRD
    assert_eq!(host.byte(0x28), 0x1B);
    assert_eq!(host.byte(0x38), 0x3E);
    let (a, b) = (host.pair().0, host.pair().0);
    assert_eq!(b.t_ns - a.t_ns, 175_667);
}

#[test]
fn iop_shows_pins_in_bits_7_and_6() {
    let mut host = Host::new(quiet());
    let mut sync = host.twin.sync_pin();
    host.send(&[0x01, 0x38]);
    assert_eq!(host.byte(0x01), 0x78);
    sync.set_low().unwrap();
    assert_eq!(host.byte(0x01), 0x38);
    host.send(&[0x01, 0xC0]); // both outputs: what was written
    assert_eq!(host.byte(0x01), 0xC0);
}

#[test]
fn checksum_starts_as_published() {
    let mut host = Host::new(quiet());
    for expected in [0xE45E, 0x4691, 0x9AEB, 0xFE27] {
        assert_eq!(host.code16(0x05), expected);
    }
}

#[test]
fn checksum_covers_com_and_written_bytes() {
    let mut host = Host::new(quiet());
    host.send(&INIT);
    assert_eq!(host.code16(0x05), 0x48CE); // F-34, computed bit by bit over INIT and the COM byte of this read
}

#[test]
fn checksum_can_be_written() {
    let mut host = Host::new(quiet());
    host.send(&[0x05, 0xFF, 0xFF]);
    assert_eq!(host.code16(0x05), 0xE45E);
}
