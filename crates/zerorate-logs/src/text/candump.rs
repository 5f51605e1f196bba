//! Recognises a text of `candump`, whose messages have no names and no units.

pub const CANDUMP: &str = "it holds messages of a CAN bus, as candump writes them; decode them with cantools and the \
                           DBC file of the device, and write a table";

/// True for a line such as `(1609459200.010000) can0 188#001F3E5D` or `can0  188   [4]  00 1F 3E 5D`.
pub fn is_message(line: &str) -> bool {
    let mut words = line.split_whitespace().skip_while(|word| word.starts_with('('));
    let is_code = |text: &str| matches!(text.len(), 3 | 8) && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    let is_length = |word: &str| {
        let inside = word.strip_prefix('[').and_then(|word| word.strip_suffix(']'));
        inside.is_some_and(|length| length.parse::<u8>().is_ok())
    };
    let (Some(interface), Some(id)) = (words.next(), words.next()) else { return false };
    let is_id = match id.split_once('#') {
        Some((id, _)) => is_code(id),
        None => is_code(id) && words.next().is_some_and(is_length),
    };
    is_id && interface.contains("can")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_a_bus_are_told_from_rows() {
        for line in ["(1609459200.01) can0 188#001F", "can0  188   [2]  00 1F", " (1.5)  vcan1  18FF0188   [1]  00"] {
            assert!(is_message(line), "{line}");
        }
        for line in [
            "",
            "(0.5, 0.25)",
            "can0",
            "can0 188 0.5",
            "can 0.5 [2]",
            "I (321) imu: 0.5",
            "scan 1 [2] 3",
            "scan acc [g] gx",
        ] {
            assert!(!is_message(line), "{line}");
        }
    }
}
