//! Reasons why numbers must not become a result.

use std::fmt;
use zerorate_allan::Fit;

/// Why the coefficients of an axis must not become a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// The record has no noise model.
    NoModel(String),
    /// It is off by so much, as a share.
    Rejected(f64),
}

impl Doubt {
    /// About a model, if there is one.
    #[must_use]
    pub fn about(fit: &Fit) -> Option<Self> {
        fit.is_rejected.then_some(Self::Rejected(fit.model_error))
    }

    /// The code of a refusal for it.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::NoModel(_) => "no-model",
            Self::Rejected(_) => "model-rejected",
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoModel(why) => f.write_str(why),
            Self::Rejected(error) => {
                let percent = error * 100.0;
                write!(f, "the noise model is off by {percent:.0} %, so none of its coefficients is a result")
            }
        }
    }
}

/// The doubts about several axes.
#[derive(Clone, Debug, Default)]
pub struct Doubts(Vec<(Doubt, Vec<String>)>);

impl Doubts {
    /// About axes by name.
    pub fn about<'a>(axes: impl IntoIterator<Item = (&'a str, Option<Doubt>)>) -> Self {
        let mut all: Vec<(Doubt, Vec<String>)> = Vec::new();
        for (name, doubt) in axes.into_iter().filter_map(|(name, doubt)| Some((name, doubt?))) {
            match all.iter_mut().find(|(same, _)| same.to_string() == doubt.to_string()) {
                Some((_, names)) => names.push(name.to_owned()),
                None => all.push((doubt, vec![name.to_owned()])),
            }
        }
        Self(all)
    }

    /// The code of a refusal for them; none: there is no doubt.
    #[must_use]
    pub fn code(&self) -> Option<&'static str> {
        self.0.first().map(|(doubt, _)| doubt.code())
    }

    /// Whether a file with the numbers may be written. With `accept_rejected`, only a missing model forbids it.
    #[must_use]
    pub fn allow(&self, accept_rejected: bool) -> bool {
        self.0.iter().all(|(doubt, _)| accept_rejected && matches!(doubt, Doubt::Rejected(_)))
    }

    /// Each reason with the axes that have it.
    #[must_use]
    pub fn texts(&self) -> Vec<String> {
        self.0.iter().map(|(why, names)| format!("{}: {why}", names.join(", "))).collect()
    }
}

impl fmt::Display for Doubts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.texts().join("; "))
    }
}
