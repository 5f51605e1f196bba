//! Reads lines that are JSON objects, one for each sample: `{"t_ms":10,"gyro":{"x":0.5,"y":0.25}}`. The names of the
//! values are replaced by blanks, so that cells remain.

use std::ops::Range;

/// Deepest nesting that is read.
const DEEPEST: usize = 8;

/// The name of a value, made of the names that lead to it (`gyro.x`), and the place of the value in the line.
type Named = (String, Range<usize>);

/// The names of the values, if the line is an object.
pub fn names(line: &str) -> Option<Vec<String>> {
    Some(values(line.as_bytes())?.into_iter().map(|(name, _)| name).collect())
}

/// Erases an object except its values, and puts commas between the values. Erases a line that is only a bracket of an
/// array. Does not change other lines, or objects with other names.
pub fn erase(line: &mut [u8], names: &[String]) {
    if matches!(line.trim_ascii(), b"[" | b"]") {
        line.fill(b' ');
    }
    let Some(values) = values(line).filter(|values| values.iter().map(|(name, _)| name).eq(names)) else { return };
    let mut at = 0;
    for (_, place) in &values {
        line[at..place.start].fill(b' ');
        at = place.end;
    }
    line[at..].fill(b' ');
    values[..values.len() - 1].iter().for_each(|(_, place)| line[place.end] = b',');
}

/// The values of an object, in order; `None` if the line is not an object.
fn values(line: &[u8]) -> Option<Vec<Named>> {
    // a client of MQTT writes the topic in front
    let at = line.iter().position(|byte| *byte == b'{')?;
    if line[..at].trim_ascii().iter().any(|byte| byte.is_ascii_whitespace() || b"[,".contains(byte)) {
        return None;
    }
    let mut reading = Reading { line, at, values: Vec::new() };
    reading.value("", 0)?;
    // in an array, a comma follows each object
    let is_end = line[reading.at..].iter().all(|byte| byte.is_ascii_whitespace() || *byte == b',');
    Some(reading.values).filter(|values| is_end && !values.is_empty())
}

struct Reading<'a> {
    line: &'a [u8],
    at: usize,
    values: Vec<Named>,
}

impl Reading<'_> {
    fn skip_blanks(&mut self) {
        self.at += self.line[self.at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    }

    /// Reads the next byte that is not a blank.
    fn next(&mut self) -> Option<u8> {
        self.skip_blanks();
        let byte = self.line.get(self.at).copied();
        self.at += 1;
        byte
    }

    fn value(&mut self, name: &str, depth: usize) -> Option<()> {
        self.skip_blanks();
        let start = self.at;
        match self.line.get(start)? {
            b'{' | b'[' if depth < DEEPEST => self.values_within(name, depth),
            b'"' => {
                self.string()?;
                self.values.push((name.to_owned(), start..self.at));
                Some(())
            }
            _ => {
                let is_part = |byte: &&u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
                self.at += self.line[start..].iter().take_while(is_part).count();
                self.values.push((name.to_owned(), start..self.at));
                (self.at > start).then_some(())
            }
        }
    }

    fn values_within(&mut self, name: &str, depth: usize) -> Option<()> {
        let is_object = self.next()? == b'{';
        let end = if is_object { b'}' } else { b']' };
        for number in 0.. {
            let own = if is_object { self.name()? } else { number.to_string() };
            let name = if name.is_empty() { own } else { format!("{name}.{own}") };
            self.value(&name, depth + 1)?;
            match self.next()? {
                b',' => {}
                byte => return (byte == end).then_some(()),
            }
        }
        None
    }

    /// Reads a name and the colon behind it.
    fn name(&mut self) -> Option<String> {
        self.skip_blanks();
        let start = self.at;
        self.string()?;
        let name = std::str::from_utf8(&self.line[start + 1..self.at - 1]).ok()?.to_owned();
        (self.next()? == b':').then_some(name)
    }

    /// Skips a string; `None` if the string contains an escape.
    fn string(&mut self) -> Option<()> {
        let rest = self.line.get(self.at..)?.strip_prefix(b"\"")?;
        let end = rest.iter().position(|byte| matches!(byte, b'"' | b'\\'))?;
        self.at += end + 2;
        (rest[end] == b'"').then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(line: &str) -> Option<(String, String)> {
        let names = names(line)?;
        let mut bytes = line.as_bytes().to_vec();
        erase(&mut bytes, &names);
        let text = String::from_utf8(bytes).unwrap();
        Some((names.join(" "), text.split(',').map(str::trim).collect::<Vec<_>>().join("|")))
    }

    #[test]
    fn values_remain() {
        for (line, names, values) in [
            (r#"{"t":10,"gx":-0.5e-3}"#, "t gx", "10|-0.5e-3"),
            (r#"{ "t" : 10 , "gyro" : { "x" : 0.5, "y" : null } },"#, "t gyro.x gyro.y", "10|0.5|null"),
            (r#"imu/data {"t":10,"gx":1}"#, "t gx", "10|1"),
            (r#"{"gyro":[0.5,0.25],"at":"12:00:00.5"}"#, "gyro.0 gyro.1 at", r#"0.5|0.25|"12:00:00.5""#),
        ] {
            assert_eq!(cells(line), Some((names.to_owned(), values.to_owned())), "{line}");
        }
    }

    #[test]
    fn other_lines_stay() {
        let deep = format!("{{\"a\":{}1{}}}", "[".repeat(20), "]".repeat(20));
        for line in ["[1,2]", "{\"a\":}", "{\"a\":1", "{\"a\" 1}", "{}", "{\"a\\\"b\":1}", "{\"a\":1}x", "", &deep] {
            assert_eq!(names(line), None, "{line}");
        }
        let mut line = br#"{"b":1}"#.to_vec();
        erase(&mut line, &["a".to_owned()]);
        assert_eq!(line, br#"{"b":1}"#);
    }
}
