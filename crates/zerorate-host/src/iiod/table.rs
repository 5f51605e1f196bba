//! The channels of the served device: their order, their layout in a buffer, and their attributes.

use std::mem::size_of;
use zerorate::{MAX_AXES, Scale};
use zerorate_record::Layout;

#[derive(Clone, Debug)]
pub struct Table {
    /// The channels, in the order of their bits in a mask and of their values in a sample.
    pub channels: Vec<Channel>,
}

#[derive(Clone, Debug)]
pub struct Channel {
    /// The id in libiio, which begins with the type of the channel: `anglvel_z`.
    pub id: String,
    /// A second name of the channel, if the id does not say what the channel holds.
    pub name: Option<&'static str>,
    pub quantity: Quantity,
    /// The layout in the buffer: `le:u24/32>>0`.
    pub format: String,
    /// Size of the channel in the buffer in bytes. Its offset is a multiple of the size.
    pub bytes: usize,
    /// The attributes that can be read.
    pub attributes: &'static [&'static str],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The code of an axis, as measured.
    Rate(usize),
    Temp,
    Corrected(usize),
    Lost,
    /// Time of the sample, ns.
    Time,
}

/// The unit of corrected rates in a buffer, rad/s. A code of an ADIS16130 is 743 times as large (F-40).
pub const CORRECTED_RAD_PER_S: f64 = 1e-9;

/// The mask of all channels fits into 32 bits.
const _: () = assert!(2 * MAX_AXES + 3 <= u32::BITS as usize);

const CODE: &[&str] = &["raw", "scale", "offset"];
const CODE_AND_BIAS: &[&str] = &["raw", "scale", "offset", "calibbias"];
const PLAIN: &[&str] = &["raw", "scale"];
const COUNT: &[&str] = &["raw"];

impl Table {
    /// The channels of a part with this layout. `is_corrected` adds the corrected rates and `calibbias`.
    pub fn new(layout: &Layout, is_corrected: bool) -> Self {
        let ids = ids(layout);
        let attributes = if is_corrected { CODE_AND_BIAS } else { CODE };
        let rate = |(axis, id): (usize, &String)| Channel {
            attributes,
            ..Channel::code(id.clone(), Quantity::Rate(axis), &layout.axes()[axis].scale)
        };
        let corrected = |(axis, id): (usize, &String)| {
            Channel::wide(format!("{id}_corrected"), None, Quantity::Corrected(axis), "le:S64/64>>0", PLAIN)
        };
        let mut channels: Vec<Channel> = ids.iter().enumerate().map(rate).collect();
        channels.push(Channel::code("temp0".to_owned(), Quantity::Temp, layout.temp()));
        channels.extend(ids.iter().enumerate().filter(|_| is_corrected).map(corrected));
        channels.push(Channel::wide("count0".to_owned(), Some("samples_lost"), Quantity::Lost, "le:U64/64>>0", COUNT));
        channels.push(Channel::wide("timestamp".to_owned(), None, Quantity::Time, "le:S64/64>>0", &[]));
        Self { channels }
    }

    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.id == name || channel.name == Some(name))
    }
}

impl Channel {
    /// Makes a channel for codes of up to 32 bits.
    fn code(id: String, quantity: Quantity, scale: &Scale) -> Self {
        let format = format!("le:{}{}/32>>0", if scale.signed { 's' } else { 'u' }, scale.width_bits);
        Self { id, name: None, quantity, format, bytes: size_of::<u32>(), attributes: CODE }
    }

    fn wide(
        id: String,
        name: Option<&'static str>,
        quantity: Quantity,
        format: &str,
        attributes: &'static [&'static str],
    ) -> Self {
        Self { id, name, quantity, format: format.to_owned(), bytes: size_of::<u64>(), attributes }
    }

    /// The file name of an attribute as in the kernel's sysfs: `in_anglvel_z_raw`.
    pub fn file(&self, attribute: &str) -> String {
        let name = self.name.map(|name| format!("_{name}")).unwrap_or_default();
        format!("in_{}{name}_{attribute}", self.id)
    }
}

/// Ids such as `anglvel_z` if the directions of the axes are known, otherwise numbered ids.
fn ids(layout: &Layout) -> Vec<String> {
    let by_letter = |direction: usize| format!("anglvel_{}", ['x', 'y', 'z'][direction]);
    match layout.directions() {
        Some(directions) => directions.into_iter().map(by_letter).collect(),
        None => (0..layout.axes().len()).map(|index| format!("anglvel{index}")).collect(),
    }
}
