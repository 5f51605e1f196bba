//! Tests of `docs/facts.md` sections 2 (framing, reset by ones, time on the wire), 3 (status, CLAMP) and 5 (codes).

use crate::bus::{Host, INIT, celsius, dps, quiet};
use adis16130_twin::Spec;
use embedded_hal::spi::{Operation, SpiDevice};

#[test]
fn both_framings_do_the_same() {
    let mut bytewise = Host::started(quiet());
    let mut framed = Host::new(quiet());
    for command in INIT.chunks(2) {
        framed.spi.write(command).unwrap();
    }
    for address in [0x01, 0x28, 0x30, 0x2A, 0x32, 0x38] {
        let mut value = [0, 0];
        framed.spi.transfer(&mut value, &[0x40 | address, 0]).unwrap();
        assert_eq!(value[1], bytewise.byte(address), "{address:02X}");
    }
    framed.edge();
    let mut data = [0; 3];
    framed.spi.transaction(&mut [Operation::Write(&[0x48]), Operation::Read(&mut data)]).unwrap();
    assert_eq!(data, [0x80, 0, 0]);
    let mut in_place = [0x60, 0];
    framed.spi.transfer_in_place(&mut in_place).unwrap();
    assert_eq!(in_place[1], 0x00); // read, so no unread data
}

#[test]
fn several_commands_fit_in_one_frame() {
    let mut host = Host::new(quiet());
    host.spi.write(&INIT).unwrap();
    assert_eq!(host.byte(0x38), 0x22);
}

#[test]
fn reset_frame_resets_in_any_phase() {
    for before in [&[][..], &[0x38], &[0x05], &[0x05, 0x12], &[0x48], &[0x48, 0x00]] {
        let mut host = Host::started(quiet());
        host.send(before);
        host.spi_reset();
        assert_eq!(host.code16(0x05), 0xE45E, "the checksum after {before:?}");
        assert_eq!(host.byte(0x38), 0x00, "after {before:?}");
        assert_eq!(host.code16(0x08), 0x8000);
        assert!(host.twin.next_falling_edge(1_000_000).is_none());
    }
}

#[test]
fn ones_count_only_in_a_row_and_in_one_frame() {
    let mut host = Host::started(quiet());
    host.send(&[0xFF; 8]); // CS rises in between
    host.spi.write(&[0xFF, 0xFF, 0xFF, 0xFE, 0xFF, 0xFF, 0xFF]).unwrap();
    assert_eq!(host.byte(0x38), 0x22);
    host.spi.write(&[0xF1, 0xFF, 0xFF, 0xFF, 0xFE]).unwrap(); // 1 + 24 + 7 ones in a row
    assert_eq!(host.byte(0x38), 0x00);
}

#[test]
fn bytes_and_gaps_take_time() {
    let mut host = Host::new(Spec { sclk_hz: 2.0e6, cs_gap_ns: 300, ..quiet() });
    host.spi.write(&[0; 5]).unwrap();
    assert_eq!(host.twin.now_ns(), 5 * 4000 + 300);
    host.spi.transaction(&mut [Operation::DelayNs(1234)]).unwrap();
    assert_eq!(host.twin.now_ns(), 5 * 4000 + 300 + 1234 + 300);
}

#[test]
fn rate_codes_are_f42_and_f43() {
    let vectors = [
        (250.0, 14_260_608, 55_706),
        (10.0, 8_623_488, 33_686),
        (0.000_170_30, 8_388_612, 32_768),
        (0.000_042_575, 8_388_609, 32_768),
        (0.0, 8_388_608, 32_768),
        (-0.000_042_575, 8_388_607, 32_768),
        (-0.000_170_30, 8_388_604, 32_768),
        (-10.0, 8_153_728, 31_850),
        (-250.0, 2_516_608, 9_830),
        // ties, a code next to a tie, and both ends
        (128.0 / 23_488.0, 8_388_736, 32_769),
        (-128.0 / 23_488.0, 8_388_480, 32_767),
        (127.0 / 23_488.0, 8_388_735, 32_768),
        (8_388_607.0 / 23_488.0, 0xFF_FFFF, 0xFFFF),
        (-8_388_608.0 / 23_488.0, 0, 0),
    ];
    for (rotation_dps, code24, code16) in vectors {
        let mut host = Host::started(Spec { rotation_dps, ..quiet() });
        host.edge();
        assert_eq!(host.code24(0x08), code24);
        host.send(&[0x38, 0x20]);
        host.edge();
        assert_eq!(host.code16(0x08), code16);
    }
}

#[test]
fn temperature_codes_are_f42_and_f43() {
    let vectors = [
        (105.0, 9_516_048, 37_172),
        (85.0, 9_234_188, 36_071),
        (26.0, 8_402_701, 32_823),
        (25.0, 8_388_608, 32_768),
        (0.0, 8_036_283, 31_392),
        (-40.0, 7_472_563, 29_190),
    ];
    for (ambient_c, code24, code16) in vectors {
        let mut host = Host::started(Spec { ambient_c, warmup_c: 0.0, ..quiet() });
        host.edge();
        assert_eq!(host.code24(0x0A), code24);
        assert!((celsius(code24) - ambient_c).abs() < 1e-4);
        host.send(&[0x38, 0x20]);
        host.edge();
        assert_eq!(host.code16(0x0A), code16);
    }
}

#[test]
fn clamp_wraps_or_saturates_and_status_tells() {
    // ±400 °/s are 9 395 200 codes from the middle: past either end.
    for (rotation_dps, clamp, code, status) in [
        (400.0, 0x22, 8_388_608 + 9_395_200 - (1 << 24), 0x01),
        (400.0, 0x23, 0xFF_FFFF, 0x01),
        (-400.0, 0x22, (1 << 24) + 8_388_608 - 9_395_200, 0x03),
        (-400.0, 0x23, 0, 0x03),
        (-10.0, 0x22, 8_153_728, 0x02),
        (10.0, 0x23, 8_623_488, 0x00),
    ] {
        let mut host = Host::new(Spec { rotation_dps, ..quiet() });
        host.send(&INIT[..10]);
        host.send(&[0x38, clamp]);
        host.edge();
        assert_eq!(host.byte(0x20), status | 0x08, "{rotation_dps} unread");
        assert_eq!(host.code24(0x08), code, "{rotation_dps}");
        assert_eq!(host.byte(0x20), status, "{rotation_dps} read");
    }
}

#[test]
fn status_registers_show_unread_channels() {
    let mut host = Host::started(quiet());
    host.edge();
    assert_eq!(host.byte(0x04), 0b101);
    assert_eq!((host.byte(0x20), host.byte(0x22)), (0x08, 0x48));
    host.code24(0x08);
    assert_eq!(host.byte(0x04), 0b100);
    host.code24(0x0A);
    assert_eq!((host.byte(0x20), host.byte(0x22)), (0x00, 0x40));
}

#[test]
fn self_test_and_sensitivity_scale_the_element() {
    use embedded_hal::digital::OutputPin;
    let spec = Spec { rotation_dps: 10.0, sensitivity_error: 0.1, self_test_dps: 20.0, ..quiet() };
    let mut host = Host::started(spec);
    assert!((dps(host.pair().1) - 11.0).abs() < 1e-4);
    host.twin.self_test_pin().set_high().unwrap();
    host.pair();
    assert!((dps(host.pair().1) - 33.0).abs() < 1e-4);
}
