//! The notices of a session, each once.

use crate::message::Notice;
use std::fmt;
use zerorate_record::CaptureWarning;
use zerorate_view::SessionWarning;

/// Number of notices that are kept.
const MOST: usize = 100;

/// The notices, the newest last.
#[derive(Debug, Default)]
pub struct Notices {
    kept: Vec<Kept>,
}

#[derive(Debug)]
struct Kept {
    notice: Notice,
    axis: String,
    /// Whether this is a condition that lasts, and not an event.
    stands: bool,
}

/// A message. Messages with the same code count as the same, even if their numbers differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// The code that `zerorate explain` knows; empty for a message without one.
    code: &'static str,
    /// The axis, if the part has several.
    axis: String,
    text: String,
}

impl Said {
    /// A message with a code.
    pub fn new(code: &'static str, text: impl fmt::Display) -> Self {
        Self { code, axis: String::new(), text: text.to_string() }
    }

    /// A text without a code.
    pub fn plain(text: impl fmt::Display) -> Self {
        Self::new("", text)
    }
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.code {
            "" => f.write_str(&self.text),
            code => write!(f, "{code}: {}", self.text),
        }
    }
}

impl From<SessionWarning> for Said {
    fn from(warning: SessionWarning) -> Self {
        Self::new(warning.code(), warning)
    }
}

impl From<&CaptureWarning> for Said {
    fn from(warning: &CaptureWarning) -> Self {
        let axis = match warning {
            CaptureWarning::OfAxis { axis, .. } => axis.clone(),
            _ => String::new(),
        };
        Self { axis, ..Self::new(warning.code(), warning) }
    }
}

impl Kept {
    fn is(&self, said: &Said) -> bool {
        let Notice { code, text, .. } = &self.notice;
        code == said.code && self.axis == said.axis && (!code.is_empty() || *text == said.text)
    }
}

impl Notices {
    /// Takes an event. It replaces an older one with the same code and axis.
    pub fn push(&mut self, said: &Said, at_s: f64) {
        self.keep(said, at_s, false);
    }

    /// Takes all present conditions. A condition is counted when it begins, not each time. Returns whether anything is
    /// new.
    pub fn stand(&mut self, findings: &[Said], at_s: f64) -> bool {
        for kept in &mut self.kept {
            kept.stands &= findings.iter().any(|said| kept.is(said));
        }
        let mut is_new = false;
        for said in findings {
            match self.kept.iter_mut().find(|kept| kept.stands && kept.is(said)) {
                Some(kept) if kept.notice.text == said.text => {}
                Some(kept) => {
                    said.text.clone_into(&mut kept.notice.text);
                    is_new = true;
                }
                None => {
                    self.keep(said, at_s, true);
                    is_new = true;
                }
            }
        }
        is_new
    }

    fn keep(&mut self, said: &Said, at_s: f64, stands: bool) {
        let before = self.kept.iter().position(|kept| kept.is(said)).map(|index| self.kept.remove(index).notice);
        let (at_s, count) = before.map_or((at_s, 1), |before| (before.at_s, before.count.saturating_add(1)));
        if self.kept.len() == MOST {
            self.kept.remove(0);
        }
        let notice = Notice { code: said.code.to_owned(), text: said.text.clone(), at_s, count };
        self.kept.push(Kept { notice, axis: said.axis.clone(), stands });
    }

    pub fn all(&self) -> Vec<Notice> {
        self.kept.iter().map(|kept| kept.notice.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_said_once_with_its_newest_text() {
        let mut notices = Notices::default();
        notices.push(&Said::new("frozen", "since 3 s"), 3.0);
        notices.push(&Said::plain("The cable: was pulled"), 4.0);
        notices.push(&Said::new("frozen", "since 4 s"), 5.0);
        let all = notices.all();
        assert_eq!(all.len(), 2);
        assert_eq!((&*all[1].text, all[1].at_s, all[1].count), ("since 4 s", 3.0, 2));
        assert_eq!((&*all[0].code, &*all[0].text), ("", "The cable: was pulled"));
        (0..1000).for_each(|k| notices.push(&Said::plain(k), 6.0));
        assert_eq!(notices.all().len(), MOST);
    }

    #[test]
    fn axes_are_told_apart() {
        let mut notices = Notices::default();
        for (axis, text) in [("x", "since 3 s"), ("y", "since 3 s"), ("x", "since 4 s")] {
            let warning = Box::new(CaptureWarning::Frozen(text.to_owned()));
            notices.push(&Said::from(&CaptureWarning::OfAxis { axis: axis.to_owned(), warning }), 3.0);
        }
        let all = notices.all();
        let texts: Vec<&str> = all.iter().map(|notice| &*notice.text).collect();
        assert_eq!(texts, ["axis y: since 3 s", "axis x: since 4 s"]);
    }

    #[test]
    fn what_stands_is_counted_when_it_begins() {
        let mut notices = Notices::default();
        let once = [Said::new("impossible", "1 of 10")];
        let news: Vec<bool> = (0..3).map(|_| notices.stand(&once, 1.0)).collect();
        assert_eq!(news, [true, false, false]);
        assert!(notices.stand(&[Said::new("impossible", "1 of 20")], 2.0));
        let one = |notices: &Notices| notices.all().into_iter().next().map(|one| (one.text, one.count)).unwrap();
        assert_eq!(one(&notices), ("1 of 20".to_owned(), 1));
        assert!(!notices.stand(&[], 3.0));
        assert!(notices.stand(&once, 4.0));
        assert_eq!(one(&notices), ("1 of 10".to_owned(), 2));
    }
}
