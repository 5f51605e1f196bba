//! The notices of a session. Repeated ones are merged and counted.

use crate::message::Notice;
use std::fmt;
use zerorate_record::CaptureWarning;
use zerorate_view::SessionWarning;

/// Largest number of kept notices.
const MOST: usize = 100;

/// The notices, the newest last.
#[derive(Debug, Default)]
pub struct Notices {
    entries: Vec<NoticeEntry>,
}

#[derive(Debug)]
struct NoticeEntry {
    notice: Notice,
    /// True for a condition that still holds; false for an event, and for a condition that has ended.
    lasts: bool,
}

/// The text of a notice. Texts with the same code and axis count as the same notice, even if their numbers differ.
/// Texts without a code must be equal.
#[derive(Clone, Debug, PartialEq)]
pub struct NoticeText {
    /// The code for `zerorate explain`; empty for a text without a code.
    code: &'static str,
    /// The name of the axis, if the notice is about one of several; otherwise empty.
    axis: String,
    text: String,
}

impl NoticeText {
    /// A text with a code, of no particular axis.
    pub fn new(code: &'static str, text: impl fmt::Display) -> Self {
        Self { code, axis: String::new(), text: text.to_string() }
    }

    /// A text without a code.
    pub fn plain(text: impl fmt::Display) -> Self {
        Self::new("", text)
    }
}

impl fmt::Display for NoticeText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.code {
            "" => f.write_str(&self.text),
            code => write!(f, "{code}: {}", self.text),
        }
    }
}

impl From<SessionWarning> for NoticeText {
    fn from(warning: SessionWarning) -> Self {
        Self::new(warning.code(), warning)
    }
}

impl From<&CaptureWarning> for NoticeText {
    fn from(warning: &CaptureWarning) -> Self {
        let axis = match warning {
            CaptureWarning::OfAxis { axis, .. } => axis.clone(),
            _ => String::new(),
        };
        Self { axis, ..Self::new(warning.code(), warning) }
    }
}

impl NoticeEntry {
    fn is(&self, new: &NoticeText) -> bool {
        let Notice { code, axis, text, .. } = &self.notice;
        code == new.code && *axis == new.axis && (!code.is_empty() || *text == new.text)
    }
}

impl Notices {
    /// Adds an event. It replaces an older one with the same code and axis.
    pub fn push(&mut self, new: &NoticeText, at_s: f64) {
        self.keep(new, at_s, false);
    }

    /// Replaces the conditions that hold now. A condition is counted when it starts, not at each call. Returns
    /// whether a notice is new or changed; the notice of a condition that ended stays.
    pub fn set_conditions(&mut self, findings: &[NoticeText], at_s: f64) -> bool {
        for entry in &mut self.entries {
            entry.lasts &= findings.iter().any(|new| entry.is(new));
        }
        let mut is_new = false;
        for new in findings {
            match self.entries.iter_mut().find(|entry| entry.lasts && entry.is(new)) {
                Some(entry) if entry.notice.text == new.text => {}
                Some(entry) => {
                    new.text.clone_into(&mut entry.notice.text);
                    is_new = true;
                }
                None => {
                    self.keep(new, at_s, true);
                    is_new = true;
                }
            }
        }
        is_new
    }

    fn keep(&mut self, new: &NoticeText, at_s: f64, lasts: bool) {
        let before =
            self.entries.iter().position(|entry| entry.is(new)).map(|index| self.entries.remove(index).notice);
        let (at_s, count) = before.map_or((at_s, 1), |before| (before.at_s, before.count.saturating_add(1)));
        if self.entries.len() == MOST {
            self.entries.remove(0);
        }
        let NoticeText { code, axis, text } = new.clone();
        self.entries.push(NoticeEntry { notice: Notice { code: code.to_owned(), axis, text, at_s, count }, lasts });
    }

    pub fn all(&self) -> Vec<Notice> {
        self.entries.iter().map(|entry| entry.notice.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_listed_once_with_its_newest_text() {
        let mut notices = Notices::default();
        notices.push(&NoticeText::new("frozen", "since 3 s"), 3.0);
        notices.push(&NoticeText::plain("The cable: was pulled"), 4.0);
        notices.push(&NoticeText::new("frozen", "since 4 s"), 5.0);
        let all = notices.all();
        assert_eq!(all.len(), 2);
        assert_eq!((&*all[1].text, all[1].at_s, all[1].count), ("since 4 s", 3.0, 2));
        assert_eq!((&*all[0].code, &*all[0].text), ("", "The cable: was pulled"));
        (0..1000).for_each(|k| notices.push(&NoticeText::plain(k), 6.0));
        assert_eq!(notices.all().len(), MOST);
    }

    #[test]
    fn axes_are_told_apart() {
        let mut notices = Notices::default();
        for (axis, text) in [("x", "since 3 s"), ("y", "since 3 s"), ("x", "since 4 s")] {
            let warning = Box::new(CaptureWarning::Frozen(text.to_owned()));
            notices.push(&NoticeText::from(&CaptureWarning::OfAxis { axis: axis.to_owned(), warning }), 3.0);
        }
        let all = notices.all();
        let texts: Vec<_> = all.iter().map(|notice| (&*notice.axis, &*notice.text)).collect();
        assert_eq!(texts, [("y", "axis y: since 3 s"), ("x", "axis x: since 4 s")]);
    }

    #[test]
    fn a_condition_is_counted_when_it_begins() {
        let mut notices = Notices::default();
        let once = [NoticeText::new("impossible", "1 of 10")];
        let news: Vec<bool> = (0..3).map(|_| notices.set_conditions(&once, 1.0)).collect();
        assert_eq!(news, [true, false, false]);
        assert!(notices.set_conditions(&[NoticeText::new("impossible", "1 of 20")], 2.0));
        let one = |notices: &Notices| notices.all().into_iter().next().map(|one| (one.text, one.count)).unwrap();
        assert_eq!(one(&notices), ("1 of 20".to_owned(), 1));
        assert!(!notices.set_conditions(&[], 3.0));
        assert!(notices.set_conditions(&once, 4.0));
        assert_eq!(one(&notices), ("1 of 10".to_owned(), 2));
    }
}
