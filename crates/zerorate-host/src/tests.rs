//! Tests of the addresses of devices.

use crate::bridge::BridgeAddress;
use crate::iio::IioAddress;
use crate::options::PartOptions;
use crate::spi::SpiAddress;
use crate::wire::Port;
use crate::{DeviceSpec, KINDS, Setup, Stop};
use adis16130::{Config, ConversionTime, Framing, RdyEdge, Width};

#[test]
fn an_address_is_read_whole() {
    let address = SpiAddress::read("/dev/spidev1.2?rdy=gpiochip4:25&hz=8000000&framing=byte&mclk=105400");
    let expected = SpiAddress {
        spi: "/dev/spidev1.2".into(),
        chip: "/dev/gpiochip4".into(),
        line: 25,
        hz: 8_000_000,
        part: PartOptions::new(),
        mclk_hz: 105_400,
    };
    assert_eq!(address, Ok(expected));
    let plain = SpiAddress::read("/dev/spidev0.0?rdy=/dev/gpiochip0:3").expect("an address");
    assert_eq!((plain.hz, plain.part.config.framing(), plain.mclk_hz), (5_000_000, Framing::Command, 6_000_000));
    let iio = IioAddress::read("iio:device0?hz=50").expect("an address");
    assert_eq!((iio.folder.to_str(), iio.hz), (Some("/sys/bus/iio/devices/iio:device0"), Some(50)));
}

#[test]
fn a_bridge_is_a_port_or_a_connection() {
    let serial = BridgeAddress::read_serial("/dev/ttyUSB0?hz=8000000&baud=2000000").expect("an address");
    assert_eq!(serial.port, Port::Serial { path: "/dev/ttyUSB0".to_owned(), baud: 2_000_000 });
    assert_eq!((serial.hz, serial.mclk_hz), (8_000_000, 6_000_000));
    let tcp = BridgeAddress::read_tcp("[::1]:16130?mclk=105000").expect("an address");
    assert_eq!((tcp.to_string().as_str(), tcp.mclk_hz), ("tcp:[::1]:16130", 105_000));
    for (wrong, hint) in [("", "bridge:/dev/ttyACM0"), ("/dev/ttyACM0?baud=1", "from 9600"), ("x?rdy=1", "`rdy=1`")] {
        assert!(BridgeAddress::read_serial(wrong).unwrap_err().contains(hint), "{wrong}");
    }
    for (wrong, hint) in
        [("", "tcp:127.0.0.1:16130"), ("host", "tcp:127"), (":7", "tcp:127"), ("h:7?baud=9600", "`baud=9600`")]
    {
        assert!(BridgeAddress::read_tcp(wrong).unwrap_err().contains(hint), "{wrong}");
    }
}

#[test]
fn the_part_is_configured_alike_wherever_it_is() {
    let options = "framing=byte&width=16&fw=9:12&chop=1&edge=rising&divided=50";
    let chopped = |word: u8| ConversionTime::new(0x80 | word);
    let expected = Config::new()
        .with_width(Width::Bits16)
        .with_rate_conversion(chopped(9))
        .with_temp_conversion(chopped(12))
        .with_rdy_edge(RdyEdge::Rising);
    let spi = SpiAddress::read(&format!("/dev/spidev0.0?rdy=gpiochip0:25&{options}")).expect("an address");
    let serial = BridgeAddress::read_serial(&format!("/dev/ttyACM0?{options}")).expect("an address");
    let tcp = BridgeAddress::read_tcp(&format!("localhost:1?{options}")).expect("an address");
    let expected = PartOptions { config: expected, divided: 50, bandwidth_hz: None };
    assert_eq!([spi.part, serial.part, tcp.part], [expected; 3]);
    for (wrong, hint) in [
        ("width=20", "width=24|16"),
        ("fw=200", "from 0 to 127"),
        ("edge=up", "falling|rising"),
        ("divided=0", "from 1 to 65535"),
        ("roa=5nf", "roa=none and roa=10nf"),
        ("bandwidth_hz=0", "from 0.01 to 100000"),
    ] {
        let error = BridgeAddress::read_serial(&format!("x?{wrong}")).unwrap_err();
        assert!(error.contains(hint), "{error}");
    }
}

#[test]
fn errors_of_an_address_name_the_remedy() {
    for (text, hint) in [
        ("", "spi:/dev/spidev0.0"),
        ("/dev/spidev0.0", "rdy=CHIP:LINE"),
        ("/dev/spidev0.0?rdy=25", "gpiochip0:25"),
        ("/dev/spidev0.0?rdy=gpiochip0:25&hz=20000000", "10000000"),
        ("/dev/spidev0.0?rdy=gpiochip0:25&speed=1", "`speed=1`"),
        ("/dev/spidev0.0?rdy=gpiochip0:25&framing=bit", "`framing=bit`"),
    ] {
        let error = SpiAddress::read(text).unwrap_err();
        assert!(error.contains(hint), "{text}: {error}");
    }
    assert!(IioAddress::read("").unwrap_err().contains("iio:iio:device0"));
    assert!(IioAddress::read("iio:device0?hz=0").unwrap_err().contains("from 1"));
}

#[test]
fn each_kind_is_named_where_none_fits() {
    let error = "usb:x".parse::<DeviceSpec>().unwrap_err();
    assert!(KINDS.iter().all(|kind| error.contains(kind.name)), "{error}");
    for (text, hint) in
        [("twin", "with the colon"), ("replay:", "needs the file"), ("Cargo.toml", "replay:Cargo.toml")]
    {
        assert!(text.parse::<DeviceSpec>().unwrap_err().contains(hint), "{text}");
    }
    for (text, meant) in [
        ("/dev/ttyACM0", "bridge:/dev/ttyACM0"),
        ("/dev/ttyUSB0?baud=2000000", "bridge:/dev/ttyUSB0?baud=2000000"),
        ("COM3", "bridge:COM3"),
        ("/dev/spidev0.0", "spi:/dev/spidev0.0?rdy=CHIP:LINE"),
        ("/dev/spidev0.0?rdy=gpiochip0:25", "spi:/dev/spidev0.0?rdy=gpiochip0:25"),
        ("/sys/bus/iio/devices/iio:device0", "iio:iio:device0"),
        ("192.168.0.9:16130", "tcp:192.168.0.9:16130"),
    ] {
        assert_eq!(text.parse::<DeviceSpec>().unwrap_err(), format!("did you mean {meant}?"));
    }
    let bandwidth = "bridge:/dev/ttyACM0?roa=10nf&hz=4000000".parse::<DeviceSpec>().expect("an address");
    assert!(format!("{bandwidth:?}").contains("bandwidth_hz: Some(50.0)"), "{bandwidth:?}");
}

/// Each axis has its own random values. Values given in the address hold for all axes, and all axes share the clock
/// and the temperature.
#[test]
fn a_twin_may_have_several_axes() {
    for (wrong, hint) in [("axes=0", "1, 2 or 3"), ("axes=4", "1, 2 or 3"), ("axes=three", "1, 2 or 3")] {
        let error = format!("twin:seed=3,{wrong}").parse::<DeviceSpec>().unwrap_err();
        assert!(error.to_string().contains(hint), "{wrong}: {error}");
    }
    let device: DeviceSpec = "twin:seed=3,axes=3,tempco_dps_per_c=0.07,width=16".parse().expect("an address");
    let mut source = device.open(&Setup::default(), &Stop::default()).expect("a twin");
    source.initialise().expect("three parts");
    let truths = source.truths();
    assert_eq!(truths.len(), 3);
    assert!(truths.iter().all(|truth| truth.tempco_dps_per_c == 0.07 && truth.ambient_c == truths[0].ambient_c));
    assert!((1..3).all(|axis| truths[axis].initial_dps != truths[0].initial_dps));
    let facts = source.facts();
    let layout = &facts.info.layout;
    assert_eq!((layout.axes().len(), layout.axes()[2].scale.width_bits, facts.part.axes.len()), (3, 16, 3));
    for axis in 0..3 {
        assert_eq!(facts.part.axes[axis].axis.noise, zerorate::Axis::ADIS16130.noise);
    }
    let rows: Vec<_> = (0..1000).map(|_| source.next().expect("a row").expect("a row")).collect();
    assert!(rows.windows(2).all(|pair| pair[0].t_ns < pair[1].t_ns && pair[1].lost == 0));
    for (axis, truth) in truths.iter().enumerate() {
        let sum: f64 = rows.iter().map(|row| row.codes()[axis] as f64 - 32_768.0).sum();
        // 91.75 codes of 16 bits are 1 °/s. The mean of 0.2 s at 0.0125 °/s/√Hz (F-02) has a standard deviation of
        // 0.02 °/s. The limit is wider because the part warms up.
        let off = sum / 1000.0 / 91.75 - truth.bias_dps(truth.sensor_c);
        assert!(off.abs() < 0.15, "axis {axis}: {off}");
    }
}
