//! Compares addresses, sizes, values after reset and bits with the table of docs/facts.md section 3.

use adis16130::registers::{
    Access, AdcStatus, Address, ChannelSetup, ChannelStatus, Checksum, ConversionTime, Iop, Mode, Operation, Range,
    RateConv, RateCs, RateData, RateStatus, Readable, Revision, TempConv, TempCs, TempData, TempStatus, Writable,
};
use adis16130::{Channels, Config, Width, frame};

use crate::part::TABLE;

fn row<R: Readable>() -> (Address, usize, usize) {
    (R::ADDRESS, R::SIZE.bytes(Width::Bits16), R::SIZE.bytes(Width::Bits24))
}

fn rows() -> [(Address, usize, usize); 13] {
    [
        row::<Iop>(),
        row::<Revision>(),
        row::<AdcStatus>(),
        row::<Checksum>(),
        row::<RateData>(),
        row::<TempData>(),
        row::<RateStatus>(),
        row::<TempStatus>(),
        row::<RateCs>(),
        row::<TempCs>(),
        row::<RateConv>(),
        row::<TempConv>(),
        row::<Mode>(),
    ]
}

#[test]
fn every_register_has_the_address_the_size_and_the_access_of_the_facts() {
    for ((address, bytes, _, readable, writable), (register, narrow, wide)) in TABLE.into_iter().zip(rows()) {
        let expected = if bytes == 0 { (address, 2, 3) } else { (address, bytes, bytes) };
        assert_eq!((register as u8, narrow, wide), expected);
        assert_eq!(register.size().bytes(Width::Bits16), narrow, "{register}");
        let expected = match (readable, writable) {
            (true, true) => Access::ReadWrite,
            (true, false) => Access::ReadOnly,
            _ => Access::WriteOnly,
        };
        assert_eq!(register.access(), expected, "{register}");
        assert!(register.description().ends_with('.'), "{register}");
    }
    assert_eq!(Address::Com as u8, 0x00);
}

#[test]
fn fields_share_no_bits() {
    for (register, ..) in rows() {
        let masks = register.fields().iter().map(|field| field.mask);
        let all = masks.clone().fold(0, |all, mask| all | mask);
        assert_eq!(masks.map(u32::count_ones).sum::<u32>(), all.count_ones(), "{register}");
        assert!(all >> (8 * register.size().bytes(Width::Bits24)) == 0, "{register}");
        assert!(!register.fields().is_empty(), "{register}");
    }
}

#[test]
fn a_field_is_taken_out_of_its_register() {
    let of_mode = |mask| Address::Mode.fields().iter().find(|field| field.mask == mask).unwrap().of(0b0101_1110);
    assert_eq!([0xE0, 0x10, 0x02, 0x01].map(of_mode), [2, 1, 1, 0]);
}

#[test]
fn every_writable_register_resets_to_the_value_of_the_facts() {
    fn check<R: Writable>() {
        let (address, _, reset, _, writable) = TABLE.into_iter().find(|row| row.0 == R::ADDRESS as u8).unwrap();
        assert!(writable, "{address:02X}h");
        assert_eq!(R::encode(R::RESET), reset, "{address:02X}h");
    }
    check::<Iop>();
    check::<Checksum>();
    check::<RateCs>();
    check::<TempCs>();
    check::<RateConv>();
    check::<TempConv>();
    check::<Mode>();
}

#[test]
fn every_read_only_register_resets_to_the_value_of_the_facts() {
    use adis16130::registers::Register;
    assert_eq!(Revision::RESET.bits(), 0x24);
    assert_eq!(AdcStatus::RESET.bits(), 0x00);
    assert_eq!(RateStatus::RESET.bits(), 0x00);
    assert_eq!(TempStatus::RESET.bits(), 0x40);
    assert_eq!(RateData::RESET.code(), 0x8000);
    assert_eq!(TempData::RESET.to_millicelsius(), 25_000);
}

#[test]
fn f24_com_byte() {
    assert_eq!(frame::com_read(Address::RateData), 0x48);
    assert_eq!(frame::com_write(Address::Mode), 0x38);
}

#[test]
fn bits_of_iop() {
    let iop = Iop::new(0);
    assert_eq!(iop.with_p0(true).bits(), 0x80);
    assert_eq!(iop.with_p1(true).bits(), 0x40);
    assert_eq!(iop.with_p0_input(true).bits(), 0x20);
    assert_eq!(iop.with_p1_input(true).bits(), 0x10);
    assert_eq!(iop.with_rdyfn(true).bits(), 0x08);
    assert_eq!(iop.with_sync(true).bits(), 0x01);
    let all = Iop::new(0xFF);
    assert_eq!(all.with_rdyfn(false).with_sync(false).bits(), 0xF6);
    assert!(all.p0() && all.p1() && all.p0_is_input() && all.p1_is_input() && all.rdyfn() && all.sync());
}

#[test]
fn bits_of_the_channel_registers() {
    let status = ChannelStatus::new(0b0100_1111);
    assert_eq!(status.channel(), 2);
    assert!(status.ready() && status.no_reference() && status.negative() && status.out_of_range());
    assert!(ChannelStatus::new(0x08).announces_rate() && !status.announces_rate());

    let setup = ChannelSetup::new(0).with_statopt(true).with_enabled(true).with_range(Range::Bits11);
    assert_eq!(setup.bits(), 0x1B);
    assert!(setup.statopt() && setup.enabled());
    for (bits, range) in [(0, Range::Bits00), (1, Range::Bits01), (2, Range::Bits10), (3, Range::Bits11)] {
        assert_eq!(ChannelSetup::new(0xF8 | bits).range(), range);
    }
    assert!(AdcStatus::new(0x01).rate_ready() && AdcStatus::new(0x04).temp_ready());
}

#[test]
fn bits_of_mode() {
    let mode = Mode::new(0);
    let bits = |operation| mode.with_operation(operation).bits();
    assert_eq!(bits(Operation::Idle), 0x00);
    assert_eq!(bits(Operation::Continuous), 0x20);
    assert_eq!(bits(Operation::Single), 0x40);
    assert_eq!(bits(Operation::PowerDown), 0x60);
    assert_eq!(Mode::new(0xE0).operation(), Operation::Other(7), "unknown is kept, not mapped");
    assert_eq!(bits(Operation::Other(7)), 0xE0);
    assert_eq!(mode.with_clkdis(true).bits(), 0x10);
    assert_eq!(mode.with_dump(true).bits(), 0x08);
    assert_eq!(mode.with_contrd(true).bits(), 0x04);
    assert_eq!(mode.with_width(Width::Bits24).bits(), 0x02);
    assert_eq!(mode.with_clamp(true).bits(), 0x01);
    assert!(Mode::new(0x1F).clkdis() && Mode::new(0x1F).dump() && Mode::new(0x1F).contrd() && Mode::new(0x1F).clamp());
}

#[test]
fn f31_conversion_times() {
    let five = ConversionTime::new(5);
    assert_eq!((five.cycles(true), five.cycles(false)), (527, 526));
    let chopped = five.with_chop(true);
    assert_eq!((chopped.bits(), chopped.cycles(true), chopped.cycles(false)), (0x85, 889, 888));
    assert_eq!(five.with_filter_word(0x80), None);
    assert_eq!(chopped.with_filter_word(0x7F).map(ConversionTime::bits), Some(0xFF));

    assert_eq!(Config::new().conversion_cycles(), (527, 527));
    assert_eq!(Config::new().with_channels(Channels::Rate).conversion_cycles(), (526, 0));
    assert_eq!(Config::new().with_channels(Channels::Temp).conversion_cycles(), (0, 526));
}

#[test]
fn memory_is_what_the_readme_says() {
    let driver = size_of::<adis16130::blocking::Adis16130<(), ()>>();
    let sampler = size_of::<adis16130::Sampler>();
    let readme = include_str!("../../README.md");
    let stated = format!("driver {driver} bytes, [`Sampler`] {sampler} bytes");
    assert!(readme.contains(&stated), "{stated}");
}
