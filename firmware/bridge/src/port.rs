//! The port: a USB CDC ACM device, which carries bytes both ways while a host has it open.

use embassy_futures::join::join;
use embassy_futures::select::select3;
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::driver::Driver;
use embassy_usb::{Builder, Config, UsbDevice};
use static_cell::StaticCell;

use crate::Link;

/// USB vendor and product ID, for tests only, from <https://pid.codes/1209/0001/>. A product needs its own.
const TEST_ID: (u16, u16) = (0x1209, 0x0001);

/// Largest packet of a bulk endpoint at full speed, bytes.
const PACKET: usize = 64;

struct Buffers {
    configuration: [u8; 128],
    bos: [u8; 32],
    control: [u8; 64],
    state: State<'static>,
}

static BUFFERS: StaticCell<Buffers> = StaticCell::new();

/// Runs the USB device. Hosts recognise the device by its serial number. Call it once.
pub async fn run(driver: impl Driver<'static>, serial: Option<&'static str>, link: &Link) -> ! {
    let buffers =
        BUFFERS.init_with(|| Buffers { configuration: [0; 128], bos: [0; 32], control: [0; 64], state: State::new() });
    let mut config = Config::new(TEST_ID.0, TEST_ID.1);
    config.manufacturer = Some("zerorate");
    config.product = Some("ADIS16130 bridge");
    config.serial_number = serial;
    let mut builder =
        Builder::new(driver, config, &mut buffers.configuration, &mut buffers.bos, &mut [], &mut buffers.control);
    let class = CdcAcmClass::new(&mut builder, &mut buffers.state, PACKET as u16);
    let mut device = builder.build();
    join(enumerate(&mut device, link), carry(class, link)).await.0
}

/// Handles the enumeration of the device. Hangs up if the bus has no traffic: the host sleeps, or the cable is out.
async fn enumerate<D: Driver<'static>>(device: &mut UsbDevice<'static, D>, link: &Link) -> ! {
    loop {
        device.run_until_suspend().await;
        link.hang_up();
        device.wait_resume().await;
    }
}

async fn carry<D: Driver<'static>>(class: CdcAcmClass<'static, D>, link: &Link) -> ! {
    let (mut sender, mut receiver, control) = class.split_with_control();
    loop {
        sender.wait_connection().await;
        until_open(&control, true).await;
        select3(send(&mut sender, link), receive(&mut receiver, link), until_open(&control, false)).await;
        link.hang_up();
    }
}

/// Waits until the host has opened the port (`open`) or closed it.
async fn until_open(control: &ControlChanged<'_>, open: bool) {
    while control.dtr() != open {
        control.control_changed().await;
    }
}

async fn send<D: Driver<'static>>(sender: &mut Sender<'static, D>, link: &Link) {
    // never a full packet, after which the host would wait for more bytes
    let mut packet = [0; PACKET - 1];
    loop {
        let len = link.to_host.read(&mut packet).await;
        if sender.write_packet(&packet[..len]).await.is_err() {
            return;
        }
    }
}

async fn receive<D: Driver<'static>>(receiver: &mut Receiver<'static, D>, link: &Link) {
    let mut packet = [0; PACKET];
    while let Ok(len) = receiver.read_packet(&mut packet).await {
        link.from_host.write_all(&packet[..len]).await;
    }
}

/// Formats a unique number as hexadecimal text, the serial number of the USB device.
pub fn hex(id: [u8; 8], room: &mut [u8; 16]) -> &str {
    for (digits, byte) in room.chunks_exact_mut(2).zip(id) {
        for (digit, value) in digits.iter_mut().zip([byte >> 4, byte & 15]) {
            *digit = if value < 10 { b'0' + value } else { b'A' - 10 + value };
        }
    }
    // digits and capital letters are always valid UTF-8
    core::str::from_utf8(room).unwrap_or_default()
}
