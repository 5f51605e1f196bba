//! The usbredir protocol, version 0.7, for a device with control and bulk endpoints only: encodes and decodes packets,
//! without a socket. README.md describes the exchange.

/// Largest accepted length of a packet without its header, bytes. QEMU sends at most 64 KiB in a transfer to a device
/// with bulk endpoints.
pub const LONGEST_PACKET: usize = 1 << 20;

/// Length of the version text in a hello, bytes.
const VERSION_LEN: usize = 64;
/// Number of endpoints in both directions: 0–15 out, 16–31 in.
const ENDPOINTS: usize = 32;

const HELLO: u32 = 0;
const DEVICE_CONNECT: u32 = 1;
const DEVICE_DISCONNECT: u32 = 2;
const RESET: u32 = 3;
const INTERFACE_INFO: u32 = 4;
const ENDPOINT_INFO: u32 = 5;
const SET_CONFIGURATION: u32 = 6;
const GET_CONFIGURATION: u32 = 7;
const CONFIGURATION_STATUS: u32 = 8;
const SET_ALT_SETTING: u32 = 9;
const GET_ALT_SETTING: u32 = 10;
const ALT_SETTING_STATUS: u32 = 11;
const CANCEL: u32 = 21;
const CONTROL: u32 = 100;
const BULK: u32 = 101;

/// A set of capabilities. A capability applies if both ends announce it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Caps(u32);

impl Caps {
    const DEVICE_VERSION: u32 = 1 << 1;
    const MAX_PACKET_SIZE: u32 = 1 << 4;
    const WIDE_IDS: u32 = 1 << 5;
    const LONG_BULK: u32 = 1 << 6;

    /// The capabilities that we announce.
    pub const OURS: Self = Self(Self::DEVICE_VERSION | Self::MAX_PACKET_SIZE | Self::WIDE_IDS | Self::LONG_BULK);

    fn has(self, cap: u32) -> bool {
        self.0 & cap != 0
    }
}

/// The result of a transfer, with its number in the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    Success = 0,
    Cancelled = 1,
    Stall = 4,
}

#[derive(Debug, PartialEq, Eq)]
pub enum Request {
    /// The name of the host. The capabilities that both ends announce apply from now on.
    Hello(String),
    Reset,
    SetConfiguration(u8),
    GetConfiguration,
    SetAltSetting {
        interface: u8,
        alt: u8,
    },
    GetAltSetting {
        interface: u8,
    },
    /// The host cancels the transfer that has the id of this request.
    Cancel,
    Control(Control),
    /// A bulk transfer: data for an out endpoint, or a request for up to `length` bytes of an in endpoint.
    Bulk {
        endpoint: u8,
        length: u32,
        data: Vec<u8>,
    },
    /// A message that needs no answer from this device.
    Other(u32),
}

/// A control transfer: USB's setup packet. The adapter ignores the data of the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Control {
    pub endpoint: u8,
    pub request: u8,
    pub request_type: u8,
    pub value: u16,
    pub index: u16,
    pub length: u16,
}

impl Control {
    /// True if the data go from the device to the host.
    pub fn is_in(&self) -> bool {
        self.request_type & 0x80 != 0
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Announcement {
    pub vendor: u16,
    pub product: u16,
    pub version_bcd: u16,
    pub class: u8,
    /// Class of the only interface.
    pub interface_class: u8,
    /// Addresses of the bulk endpoints (bit 7: in).
    pub bulk: [u8; 2],
    pub max_packet: u16,
}

/// Our end of a connection: decodes requests from bytes, and encodes answers.
#[derive(Debug, Default)]
pub struct Connection {
    received: Vec<u8>,
    caps: Caps,
}

impl Connection {
    pub fn push(&mut self, bytes: &[u8]) {
        self.received.extend_from_slice(bytes);
    }

    /// Decodes the next request and its id; `None` if it has not arrived completely. An error if the other end
    /// violates the protocol.
    pub fn next(&mut self) -> Result<Option<(u64, Request)>, String> {
        let head = if self.caps.has(Caps::WIDE_IDS) { 16 } else { 12 };
        let Some((kind, length)) = le32(&self.received, 0).zip(le32(&self.received, 4)) else {
            return Ok(None);
        };
        let length = length as usize;
        if length > LONGEST_PACKET {
            return Err(format!("usbredir: a packet of {length} bytes; is that a usbredir socket?"));
        }
        if self.received.len() < head + length {
            return Ok(None);
        }
        let packet: Vec<u8> = self.received.drain(..head + length).collect();
        let id = if head == 16 { le64(&packet, 8) } else { le32(&packet, 8).map(u64::from) };
        let request = self.parse(kind, &packet[head..]);
        let request = request.ok_or_else(|| format!("usbredir: a packet of kind {kind} with only {length} bytes"))?;
        Ok(Some((id.unwrap_or_default(), request)))
    }

    fn parse(&mut self, kind: u32, body: &[u8]) -> Option<Request> {
        Some(match kind {
            HELLO => self.hello(body)?,
            RESET => Request::Reset,
            SET_CONFIGURATION => Request::SetConfiguration(*body.first()?),
            GET_CONFIGURATION => Request::GetConfiguration,
            SET_ALT_SETTING => Request::SetAltSetting { interface: *body.first()?, alt: *body.get(1)? },
            GET_ALT_SETTING => Request::GetAltSetting { interface: *body.first()? },
            CANCEL => Request::Cancel,
            CONTROL => Request::Control(Control {
                endpoint: *body.first()?,
                request: *body.get(1)?,
                request_type: *body.get(2)?,
                value: le16(body, 4)?,
                index: le16(body, 6)?,
                length: le16(body, 8)?,
            }),
            BULK => self.bulk(body)?,
            other => Request::Other(other),
        })
    }

    fn hello(&mut self, body: &[u8]) -> Option<Request> {
        let name = body.get(..VERSION_LEN)?.split(|byte| *byte == 0).next()?;
        let theirs = le32(body, VERSION_LEN).unwrap_or(0);
        self.caps = Caps(Caps::OURS.0 & theirs);
        Some(Request::Hello(String::from_utf8_lossy(name).into_owned()))
    }

    fn bulk(&self, body: &[u8]) -> Option<Request> {
        let long = self.caps.has(Caps::LONG_BULK);
        let high = if long { le16(body, 8)? } else { 0 };
        let length = u32::from(high) << 16 | u32::from(le16(body, 2)?);
        Some(Request::Bulk { endpoint: *body.first()?, length, data: body.get(if long { 10 } else { 8 }..)?.to_vec() })
    }

    // ---- packets that this end sends ----

    /// The first packet of a connection. Its id has 32 bits, since no capabilities are agreed yet.
    pub fn hello_packet(name: &str) -> Vec<u8> {
        let mut body = name.as_bytes().to_vec();
        body.resize(VERSION_LEN, 0);
        body.extend(Caps::OURS.0.to_le_bytes());
        Self::default().packet(HELLO, 0, &body)
    }

    /// Packets that announce the device: its interface, its endpoints, and the device itself.
    pub fn connect_packets(&self, device: &Announcement) -> Vec<u8> {
        let mut interface = 1u32.to_le_bytes().to_vec();
        interface.extend([0; ENDPOINTS]);
        interface.push(device.interface_class);
        interface.extend([0; 3 * ENDPOINTS - 1]);
        let mut packets = self.packet(INTERFACE_INFO, 0, &interface);
        packets.extend(self.packet(ENDPOINT_INFO, 0, &self.endpoint_info(device)));
        packets.extend(self.packet(DEVICE_CONNECT, 0, &self.device_connect(device)));
        packets
    }

    fn endpoint_info(&self, device: &Announcement) -> Vec<u8> {
        const CONTROL_TYPE: u8 = 0;
        const BULK_TYPE: u8 = 2;
        let (mut types, mut sizes) = ([255u8; ENDPOINTS], [0u16; ENDPOINTS]);
        for (address, kind) in
            [(0, CONTROL_TYPE), (0x80, CONTROL_TYPE), (device.bulk[0], BULK_TYPE), (device.bulk[1], BULK_TYPE)]
        {
            let index = usize::from((address & 0x80) >> 3 | address & 0x0F);
            (types[index], sizes[index]) = (kind, device.max_packet);
        }
        let mut info = types.to_vec();
        info.extend([0; 2 * ENDPOINTS]); // intervals, interfaces
        if self.caps.has(Caps::MAX_PACKET_SIZE) {
            info.extend(sizes.iter().flat_map(|size| size.to_le_bytes()));
        }
        info
    }

    fn device_connect(&self, device: &Announcement) -> Vec<u8> {
        const FULL_SPEED: u8 = 1;
        let mut body = vec![FULL_SPEED, device.class, 0, 0];
        body.extend(device.vendor.to_le_bytes());
        body.extend(device.product.to_le_bytes());
        if self.caps.has(Caps::DEVICE_VERSION) {
            body.extend(device.version_bcd.to_le_bytes());
        }
        body
    }

    pub fn disconnect_packet(&self) -> Vec<u8> {
        self.packet(DEVICE_DISCONNECT, 0, &[])
    }

    pub fn configuration_status(&self, id: u64, configuration: u8) -> Vec<u8> {
        self.packet(CONFIGURATION_STATUS, id, &[Status::Success as u8, configuration])
    }

    pub fn alt_setting_status(&self, id: u64, interface: u8, alt: u8) -> Vec<u8> {
        self.packet(ALT_SETTING_STATUS, id, &[Status::Success as u8, interface, alt])
    }

    /// A packet with the result of a control transfer; `None` is a stall.
    pub fn control_result(&self, id: u64, control: &Control, data: Option<&[u8]>) -> Vec<u8> {
        let Control { endpoint, request, request_type, value, index, length } = control;
        let (status, length) = match data {
            None => (Status::Stall, 0),
            Some(data) if control.is_in() => (Status::Success, data.len() as u16),
            Some(_) => (Status::Success, *length),
        };
        let mut body = vec![*endpoint, *request, *request_type, status as u8];
        body.extend([*value, *index, length].iter().flat_map(|word| word.to_le_bytes()));
        if control.is_in() {
            body.extend(data.unwrap_or_default());
        }
        self.packet(CONTROL, id, &body)
    }

    /// A packet with the result of a bulk transfer of `length` bytes. `data` are the bytes of an in endpoint, and
    /// empty for an out endpoint.
    pub fn bulk_result(&self, id: u64, endpoint: u8, status: Status, length: u32, data: &[u8]) -> Vec<u8> {
        let mut body = vec![endpoint, status as u8];
        body.extend((length as u16).to_le_bytes());
        body.extend(0u32.to_le_bytes()); // stream
        if self.caps.has(Caps::LONG_BULK) {
            body.extend(((length >> 16) as u16).to_le_bytes());
        }
        body.extend(data);
        self.packet(BULK, id, &body)
    }

    fn packet(&self, kind: u32, id: u64, body: &[u8]) -> Vec<u8> {
        let mut packet = kind.to_le_bytes().to_vec();
        packet.extend((body.len() as u32).to_le_bytes());
        let id = id.to_le_bytes();
        packet.extend(if self.caps.has(Caps::WIDE_IDS) { &id[..] } else { &id[..4] });
        packet.extend(body);
        packet
    }
}

fn le16(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn le32(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn le64(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twin_usb::ljca::ANNOUNCEMENT;

    fn bytes(text: &str) -> Vec<u8> {
        text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("hex")).collect()
    }

    /// A hello packet as QEMU 7.2 sends it: 64 bytes of name, capabilities FEh.
    fn qemu_hello() -> Vec<u8> {
        let mut hello = bytes("00 00 00 00 44 00 00 00 00 00 00 00");
        hello.extend(b"qemu usb-redir guest 7.2".iter().chain([0; 40].iter()));
        hello.extend(bytes("fe 00 00 00"));
        hello
    }

    fn connected() -> Connection {
        let mut connection = Connection::default();
        connection.push(&qemu_hello());
        let hello = connection.next().expect("a packet");
        assert_eq!(hello, Some((0, Request::Hello("qemu usb-redir guest 7.2".to_owned()))));
        connection
    }

    #[test]
    fn ids_are_wide_after_the_hello_and_packets_may_come_in_pieces() {
        let mut connection = connected();
        let packet = bytes("06 00 00 00 01 00 00 00 11 22 33 44 55 66 77 08 01");
        for byte in &packet[..16] {
            connection.push(&[*byte]);
            assert_eq!(connection.next(), Ok(None));
        }
        connection.push(&packet[16..]);
        assert_eq!(connection.next(), Ok(Some((0x0877_6655_4433_2211, Request::SetConfiguration(1)))));
        assert_eq!(connection.configuration_status(2, 1), bytes("08 0 0 0 02 0 0 0 02 0 0 0 0 0 0 0 00 01"));
    }

    #[test]
    fn a_peer_without_capabilities_gets_the_short_forms() {
        let mut connection = Connection::default();
        let mut hello = qemu_hello();
        hello[4] = 64;
        hello.truncate(12 + 64);
        connection.push(&hello);
        connection.next().expect("a packet").expect("whole");
        connection.push(&bytes("65 0 0 0 08 0 0 0 05 0 0 0 82 00 40 00 00 00 00 00"));
        let bulk = Request::Bulk { endpoint: 0x82, length: 64, data: vec![] };
        assert_eq!(connection.next(), Ok(Some((5, bulk))));
        let answer = connection.bulk_result(5, 0x82, Status::Success, 2, &[7, 8]);
        assert_eq!(answer, bytes("65 0 0 0 0a 0 0 0 05 0 0 0 82 00 02 00 00 00 00 00 07 08"));
    }

    #[test]
    fn a_control_transfer_comes_and_goes() {
        let mut connection = connected();
        connection.push(&bytes("64 0 0 0 0a 0 0 0 09 0 0 0 0 0 0 0 80 06 80 00 00 01 00 00 12 00"));
        let Ok(Some((9, Request::Control(control)))) = connection.next() else { panic!("a control transfer") };
        assert_eq!((control.request, control.value, control.length, control.is_in()), (6, 0x0100, 18, true));
        let answer = connection.control_result(9, &control, Some(&[0x12, 0x01]));
        assert_eq!(answer[16..], bytes("80 06 80 00 00 01 00 00 02 00 12 01"));
        let stall = connection.control_result(9, &control, None);
        assert_eq!(stall[16..], bytes("80 06 80 04 00 01 00 00 00 00"));
    }

    #[test]
    fn a_device_is_announced_with_its_endpoints() {
        let packets = connected().connect_packets(&ANNOUNCEMENT);
        assert_eq!(packets[..8], bytes("04 0 0 0 84 0 0 0"));
        assert_eq!(packets[16..20], [1, 0, 0, 0], "one interface");
        assert_eq!(packets[16 + 4 + 32], 255, "its class");
        let endpoints = &packets[16 + 132..];
        assert_eq!(endpoints[..8], bytes("05 0 0 0 a0 0 0 0"));
        let types = &endpoints[16..48];
        assert_eq!((types[0], types[1], types[2], types[16], types[18]), (0, 2, 255, 0, 2));
        assert_eq!(packets[packets.len() - 10..], bytes("01 ff 00 00 86 80 63 0b 00 01"));
    }

    #[test]
    fn nonsense_is_an_error_not_a_panic() {
        let mut connection = connected();
        connection.push(&bytes("64 0 0 0 ff ff ff 7f 0 0 0 0 0 0 0 0"));
        assert!(connection.next().unwrap_err().contains("usbredir socket"));
        let mut connection = connected();
        connection.push(&bytes("64 0 0 0 01 0 0 0 0 0 0 0 0 0 0 0 80"));
        assert!(connection.next().unwrap_err().contains("kind 100"));
    }
}
