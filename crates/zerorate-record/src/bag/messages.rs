//! The messages: their types as ROS states them, and rows of a capture as one of them.

use super::cdr::{Cdr, Fields};
use crate::layout::Layout;
use crate::row::Row;
use std::fmt::Write;
use zerorate::{MAX_AXES, Scale};

/// A type, and its definition with those that it is made of.
pub struct Definition {
    pub name: &'static str,
    pub text: String,
}

const HEADER: &str = "std_msgs/Header header\n";
const HEADER_PARTS: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";
const IMU: &str = "\
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
";
const IMU_PARTS: &str = "\
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
";

/// `sensor_msgs/msg/Imu`.
pub fn imu() -> Definition {
    Definition { name: "sensor_msgs/msg/Imu", text: [HEADER, IMU, IMU_PARTS, HEADER_PARTS].concat() }
}

/// `sensor_msgs/msg/Temperature`.
pub fn temperature() -> Definition {
    let text = [HEADER, "float64 temperature\nfloat64 variance\n", HEADER_PARTS].concat();
    Definition { name: "sensor_msgs/msg/Temperature", text }
}

/// `std_msgs/msg/String`.
pub fn string() -> Definition {
    Definition { name: "std_msgs/msg/String", text: "string data\n".to_owned() }
}

/// A row of this layout: its columns, and whether those that may be empty are there.
pub fn sample(layout: &Layout) -> Definition {
    let mut text = "uint64 t_ns\nuint32 edge_seq\n".to_owned();
    let mut names: Vec<String> = Vec::new();
    for (index, axis) in layout.axes().iter().enumerate() {
        let name = field_name(&axis.code_column());
        let name = if names.contains(&name) { format!("axis{index}_code") } else { name };
        let _ = writeln!(text, "{} {name}", code_type(&axis.scale));
        names.push(name);
    }
    let _ = writeln!(text, "uint32 status\nbool status_is_there");
    let _ = writeln!(text, "{} temp_code\nbool temp_code_is_there\nuint32 lost", code_type(layout.temp()));
    Definition { name: "zerorate_msgs/msg/Sample", text }
}

fn code_type(scale: &Scale) -> &'static str {
    if scale.signed { "int32" } else { "uint32" }
}

/// Small letters, digits and single underscores, a letter first.
fn field_name(column: &str) -> String {
    let mut name = String::new();
    for character in column.chars() {
        match character.to_ascii_lowercase() {
            kept @ ('a'..='z' | '0'..='9') => name.push(kept),
            _ if name.is_empty() || name.ends_with('_') => {}
            _ => name.push('_'),
        }
    }
    let starts_well = name.starts_with(|first: char| first.is_ascii_lowercase());
    if starts_well { name } else { format!("axis_{name}") }
}

/// Encodes a row as a message. Codes have 32 bits at most, signed or unsigned.
pub fn encode(row: &Row) -> Cdr {
    let mut message = Cdr::new();
    message.number(row.t_ns.to_le_bytes()).number(row.edge_seq.to_le_bytes());
    for code in row.codes() {
        message.number((*code as u32).to_le_bytes());
    }
    message.number(row.status.unwrap_or_default().to_le_bytes()).number([u8::from(row.status.is_some())]);
    let temp_code = row.temp_code.unwrap_or_default() as u32;
    message.number(temp_code.to_le_bytes()).number([u8::from(row.temp_code.is_some())]);
    message.number(row.lost.to_le_bytes());
    message
}

/// Decodes a message; none if it is not a row of this layout.
pub fn decode(layout: &Layout, message: &[u8]) -> Option<Row> {
    let mut fields = Fields::of(message)?;
    let (t_ns, edge_seq) = (u64::from_le_bytes(fields.number()?), u32::from_le_bytes(fields.number()?));
    let mut codes = [0; MAX_AXES];
    for (code, axis) in codes.iter_mut().zip(layout.axes()) {
        *code = code_of(&axis.scale, fields.number()?);
    }
    let (status, has_status) = (u32::from_le_bytes(fields.number()?), flag(fields.number()?)?);
    let (temp_code, has_temp) = (code_of(layout.temp(), fields.number()?), flag(fields.number()?)?);
    let lost = u32::from_le_bytes(fields.number()?);
    let row = Row::new(t_ns, edge_seq, codes.get(..layout.axes().len())?)?;
    let row = row.with_status(has_status.then_some(status)).with_temp_code(has_temp.then_some(temp_code));
    fields.is_at_end().then(|| row.with_lost(lost))
}

fn code_of(scale: &Scale, bytes: [u8; 4]) -> i64 {
    if scale.signed { i32::from_le_bytes(bytes).into() } else { u32::from_le_bytes(bytes).into() }
}

fn flag([byte]: [u8; 1]) -> Option<bool> {
    match byte {
        0 => Some(false),
        1 => Some(true),
        _ => None,
    }
}
