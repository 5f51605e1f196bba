//! The bytes of a ROS message that contains a `sensor_msgs/Imu` or a `sensor_msgs/Temperature`.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Common Data Representation of OMG, as in ROS 2: numbers aligned to their size.
    Cdr,
    /// ROS 1: little endian, no alignment.
    Ros1,
}

impl Encoding {
    pub fn of(name: &str) -> Option<Self> {
        match name {
            "cdr" => Some(Self::Cdr),
            "ros1" => Some(Self::Ros1),
            _ => None,
        }
    }
}

pub fn is_imu(type_name: &str) -> bool {
    matches!(type_name, "sensor_msgs/msg/Imu" | "sensor_msgs/Imu")
}

pub fn is_temperature(type_name: &str) -> bool {
    matches!(type_name, "sensor_msgs/msg/Temperature" | "sensor_msgs/Temperature")
}

/// The body of a message: the bytes after the four-byte mark of CDR, or all bytes in ROS 1.
pub struct Body<'a> {
    bytes: &'a [u8],
    encoding: Encoding,
    big_endian: bool,
    /// Offset of the header's stamp in `bytes`, once [`Self::at`] has set it.
    start: usize,
}

impl<'a> Body<'a> {
    /// Splits off the mark of CDR. Returns `None` if the mark is invalid.
    pub fn of(encoding: Encoding, message: &'a [u8]) -> Option<Self> {
        let (big_endian, bytes) = match encoding {
            Encoding::Ros1 => (false, message),
            Encoding::Cdr => match message.get(..4)? {
                [0, endian @ (0 | 1), ..] => (*endian == 0, &message[4..]),
                _ => return None,
            },
        };
        Some(Self { bytes, encoding, big_endian, start: 0 })
    }

    /// The body for an IMU or a temperature that begins at `start`, in ROS 1 with a sequence number before its stamp.
    pub fn at(self, start: usize) -> Option<Self> {
        let start = match self.encoding {
            Encoding::Ros1 => start.checked_add(4)?,
            Encoding::Cdr => self.aligned(start, 4),
        };
        Some(Self { start, ..self })
    }

    /// The first offset from `at` on at which a number of `size` bytes may begin.
    pub fn aligned(&self, at: usize, size: usize) -> usize {
        if self.encoding == Encoding::Cdr { at.next_multiple_of(size) } else { at }
    }

    /// True if an offset is in the body, or at its end.
    pub fn holds(&self, at: usize) -> bool {
        at <= self.bytes.len()
    }

    pub fn u32_at(&self, at: usize) -> Option<u32> {
        let bytes = *self.bytes.get(at..)?.first_chunk()?;
        Some(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub fn f64_at(&self, at: usize) -> Option<f64> {
        let bytes = *self.bytes.get(at..)?.first_chunk()?;
        Some(if self.big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
    }

    /// The stamp of the header, ns since 1970.
    pub fn stamp_ns(&self) -> Option<i64> {
        let (sec, nanosec) = (self.u32_at(self.start)? as i32, self.u32_at(self.start + 4)?);
        Some(i64::from(sec) * 1_000_000_000 + i64::from(nanosec))
    }

    /// The frame name of the header, and the offset of the numbers behind the header.
    pub fn frame(&self) -> Option<(&'a [u8], usize)> {
        let begin = self.start + 12;
        let end = (self.u32_at(self.start + 8)? as usize).checked_add(begin)?;
        Some((self.bytes.get(begin..end)?, self.aligned(end, 8)))
    }
}
