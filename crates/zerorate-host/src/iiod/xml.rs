//! The XML description of the device for clients.

use super::device::{ATTRIBUTES, BUFFER_ATTRIBUTES, Device, ID};
use super::table::Channel;
use std::fmt::Write;

/// The version of libiio whose protocol the server implements.
pub const VERSION: (u32, u32, &str) = (0, 24, "v0.24");

/// The document type. Without it, clients print an error and continue.
const DOCTYPE: &str = concat!(
    "<!DOCTYPE context [<!ELEMENT context (device | context-attribute)*><!ELEMENT context-attribute EMPTY>",
    "<!ELEMENT device (channel | attribute | debug-attribute | buffer-attribute)*>",
    "<!ELEMENT channel (scan-element?, attribute*)><!ELEMENT attribute EMPTY><!ELEMENT scan-element EMPTY>",
    "<!ELEMENT debug-attribute EMPTY><!ELEMENT buffer-attribute EMPTY>",
    "<!ATTLIST context name CDATA #REQUIRED version-major CDATA #REQUIRED version-minor CDATA #REQUIRED ",
    "version-git CDATA #REQUIRED description CDATA #IMPLIED>",
    "<!ATTLIST context-attribute name CDATA #REQUIRED value CDATA #REQUIRED>",
    "<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED label CDATA #IMPLIED>",
    "<!ATTLIST channel id CDATA #REQUIRED type (input|output) #REQUIRED name CDATA #IMPLIED>",
    "<!ATTLIST scan-element index CDATA #REQUIRED format CDATA #REQUIRED scale CDATA #IMPLIED>",
    "<!ATTLIST attribute name CDATA #REQUIRED filename CDATA #IMPLIED>",
    "<!ATTLIST debug-attribute name CDATA #REQUIRED><!ATTLIST buffer-attribute name CDATA #REQUIRED>]>",
);

/// The description in one line, as libiio's own server sends it.
pub fn describe(device: &Device) -> String {
    let (major, minor, git) = VERSION;
    let title = escaped(&format!("{}, {}", zerorate::SOFTWARE, device.name));
    let mut xml = format!("<?xml version=\"1.0\" encoding=\"utf-8\"?>{DOCTYPE}");
    xml += &format!("<context name=\"network\" version-major=\"{major}\" version-minor=\"{minor}\" ");
    xml += &format!("version-git=\"{git}\" description=\"{title}\">");
    for (key, value) in &device.context {
        xml += &format!("<context-attribute name=\"{key}\" value=\"{}\"/>", escaped(value));
    }
    xml += &format!("<device id=\"{ID}\" name=\"{}\">", escaped(&device.name));
    for (index, channel) in device.table.channels.iter().enumerate() {
        describe_channel(&mut xml, index, channel);
    }
    ATTRIBUTES.iter().for_each(|name| xml += &format!("<attribute name=\"{name}\"/>"));
    BUFFER_ATTRIBUTES.iter().for_each(|name| xml += &format!("<buffer-attribute name=\"{name}\"/>"));
    xml + "</device></context>"
}

/// Describes a channel. The scan element comes first, as the document type requires.
fn describe_channel(xml: &mut String, index: usize, channel: &Channel) {
    let Channel { id, name, format, attributes, .. } = channel;
    let name = name.map(|name| format!(" name=\"{name}\"")).unwrap_or_default();
    let _ = write!(xml, "<channel id=\"{id}\"{name} type=\"input\">");
    let _ = write!(xml, "<scan-element index=\"{index}\" format=\"{}\"/>", escaped(format));
    for attribute in *attributes {
        let _ = write!(xml, "<attribute name=\"{attribute}\" filename=\"{}\"/>", channel.file(attribute));
    }
    *xml += "</channel>";
}

/// Escapes text for an XML attribute. Control characters, U+FFFE and U+FFFF become question marks.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&apos;",
            other if other.is_control() || matches!(other, '\u{fffe}' | '\u{ffff}') => out.push('?'),
            other => out.push(other),
        }
    }
    out
}
