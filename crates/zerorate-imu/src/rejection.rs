//! Reasons why numbers must not become a result.

use std::fmt;
use zerorate_allan::Fit;

/// The reason why the coefficients of an axis must not become a result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Rejection {
    /// The record has no noise model.
    #[error("{0}")]
    NoModel(String),
    /// The model is rejected. The number is its relative error.
    #[error("the noise model is off by {:.0} %, so none of its coefficients is a result", .0 * 100.0)]
    Rejected(f64),
    /// The sensor moves.
    #[error(
        "the sensor moves: some windows of 10 s are over 10 times as loud as others, so no coefficient is a result"
    )]
    Moves,
}

impl Rejection {
    /// The rejection of a model; `None` if the model is valid.
    #[must_use]
    pub fn about(fit: &Fit) -> Option<Self> {
        let why = if fit.motion_ratio.is_some() { Self::Moves } else { Self::Rejected(fit.model_error) };
        fit.is_rejected.then_some(why)
    }

    /// True if another rejection has the same reason, even with another number.
    fn is_as(&self, other: &Self) -> bool {
        self == other || matches!((self, other), (Self::Rejected(_), Self::Rejected(_)))
    }

    /// The stable code of the rejection, for scripts.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::NoModel(_) => "no-model",
            Self::Rejected(_) | Self::Moves => "model-rejected",
        }
    }
}

/// The rejections of several axes, grouped by reason.
#[derive(Clone, Debug, Default)]
pub struct Rejections(Vec<Vec<(String, Rejection)>>);

impl Rejections {
    /// Groups the rejections of named axes by reason.
    pub fn about<'a>(axes: impl IntoIterator<Item = (&'a str, Option<Rejection>)>) -> Self {
        let mut all: Vec<Vec<(String, Rejection)>> = Vec::new();
        for (name, doubt) in axes.into_iter().filter_map(|(name, doubt)| Some((name.to_owned(), doubt?))) {
            match all.iter_mut().find(|kind| kind[0].1.is_as(&doubt)) {
                Some(kind) => kind.push((name, doubt)),
                None => all.push(vec![(name, doubt)]),
            }
        }
        Self(all)
    }

    fn each(&self) -> impl Iterator<Item = &Rejection> {
        self.0.iter().flatten().map(|(_, doubt)| doubt)
    }

    /// The code of the first rejection; `None` if there is none.
    #[must_use]
    pub fn code(&self) -> Option<&'static str> {
        self.each().next().map(Rejection::code)
    }

    /// True if a file with the numbers may be written. With `accept_rejected`, only a missing model forbids it.
    #[must_use]
    pub fn allow(&self, accept_rejected: bool) -> bool {
        self.each().all(|doubt| accept_rejected && !matches!(doubt, Rejection::NoModel(_)))
    }

    /// Each reason with the axes that have it.
    #[must_use]
    pub fn texts(&self) -> Vec<String> {
        self.0.iter().map(|kind| of_kind(kind)).collect()
    }
}

fn of_kind(kind: &[(String, Rejection)]) -> String {
    let axes = |named: fn(&(String, Rejection)) -> String| kind.iter().map(named).collect::<Vec<_>>().join(", ");
    match kind {
        [(_, Rejection::Rejected(_)), _, ..] => {
            let axes = axes(|(name, doubt)| match doubt {
                Rejection::Rejected(error) => format!("{name} by {:.0} %", error * 100.0),
                Rejection::NoModel(_) | Rejection::Moves => name.clone(),
            });
            format!("the noise model is off ({axes}), so none of its coefficients is a result")
        }
        [(_, why), ..] => format!("{}: {why}", axes(|(name, _)| name.clone())),
        [] => String::new(),
    }
}

impl fmt::Display for Rejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.texts().join("; "))
    }
}
