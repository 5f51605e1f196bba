//! What there is to say, each once.

use crate::message::Notice;

/// Notices that are kept.
const MOST: usize = 100;

/// The newest last.
#[derive(Debug, Default)]
pub struct Notices {
    kept: Vec<Notice>,
}

impl Notices {
    /// Takes `code: text`, or a text without a code. What has a code that was seen takes the place of the older one.
    pub fn push(&mut self, said: &str, at_s: f64) {
        let is_code = |code: &&str| code.contains(|c: char| c.is_ascii_lowercase()) && !code.contains(' ');
        let parts = said.split_once(": ").filter(|(code, _)| is_code(code));
        let (code, text) = parts.unwrap_or(("", said));
        let same = |one: &Notice| one.code == code && (!code.is_empty() || one.text == text);
        let before = self.kept.iter().position(same).map(|index| self.kept.remove(index));
        let (first_s, count) = before.map_or((at_s, 1), |before| (before.at_s, before.count.saturating_add(1)));
        if self.kept.len() == MOST {
            self.kept.remove(0);
        }
        self.kept.push(Notice { code: code.to_owned(), text: text.to_owned(), at_s: first_s, count });
    }

    pub fn all(&self) -> Vec<Notice> {
        self.kept.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_said_once_with_its_newest_text() {
        let mut notices = Notices::default();
        notices.push("frozen: since 3 s", 3.0);
        notices.push("The cable: was pulled", 4.0);
        notices.push("frozen: since 4 s", 5.0);
        let all = notices.all();
        assert_eq!(all.len(), 2);
        assert_eq!((&*all[1].text, all[1].at_s, all[1].count), ("since 4 s", 3.0, 2));
        assert_eq!((&*all[0].code, &*all[0].text), ("", "The cable: was pulled"));
        (0..1000).for_each(|k| notices.push(&format!("no. {k}"), 6.0));
        assert_eq!(notices.all().len(), MOST);
    }
}
