//! Fits one noise model to several records of the same part type.

use serde::Serialize;
use zerorate_allan::{self as allan, Differs, FitError, PoolError, PoolRecord, Spread, fit_pool};
use zerorate_imu::Record;
use zerorate_logs::LogWarning;

/// The common noise model of several records.
pub struct Pool {
    /// The model as a record, which can be reported and plotted like the record of one log.
    pub record: Record,
    /// The spread of each coefficient that two records identify, beyond what the confidence intervals explain.
    pub spread: Vec<Spread>,
    /// The records that do not fit the common model.
    pub outliers: Vec<Outlier>,
    /// The names of the records that the model describes.
    pub used: Vec<String>,
}

/// A record that does not fit the others.
#[derive(Clone, Serialize)]
pub struct Outlier {
    /// The name of the record.
    pub record: String,
    /// The difference to the common model, in words.
    pub why: String,
    /// True if the record is excluded from the common model.
    #[serde(rename = "left_out")]
    pub is_left_out: bool,
}

/// The reasons why records have no common model.
#[derive(Debug, thiserror::Error)]
pub enum NoPool {
    /// A record was given more than once.
    #[error("{0} is given twice, which would count its noise twice; give each record once")]
    Twice(String),
    /// Two records have different quantities.
    #[error("{0} and {1} are of different quantities; pool records of one kind")]
    Mixed(String, String),
    /// There are too few records, or their sampling rates differ.
    #[error("{0}")]
    Unfit(PoolError),
    /// A record has no noise model of its own.
    #[error("{0}: {1}")]
    NoModel(String, FitError),
    /// The records are too different, or no common model can be fitted.
    #[error("no common model: {0}")]
    NoCommonModel(PoolError),
}

impl NoPool {
    /// The code of the refusal. `None` for invalid input, where the user has to give other records.
    #[must_use]
    pub const fn code(&self) -> Option<&'static str> {
        match self {
            Self::Twice(_) | Self::Mixed(..) | Self::Unfit(_) => None,
            Self::NoModel(..) => Some("no-model"),
            Self::NoCommonModel(_) => Some("no-common-model"),
        }
    }
}

/// Fits one model to these records, except records that do not fit the others, and records without a fit.
/// Each needs its samples.
///
/// # Errors
/// Returns [`NoPool`] if the records have no common model.
pub fn pool<'a>(records: &'a [Record]) -> Result<Pool, NoPool> {
    check(records)?;
    let input = |record: &'a Record| {
        let fit = record.fit.as_ref()?.as_ref().map_err(|why| NoPool::NoModel(record.label(), *why));
        let rate = record.rate.as_deref().unwrap_or_default();
        Some(fit.map(|fit| PoolRecord { rate, rate_hz: record.analysis.rate_hz, fit }))
    };
    let fitted: Vec<&Record> = records.iter().filter(|record| record.fit.is_some()).collect();
    let inputs: Vec<PoolRecord<'_>> = fitted.iter().copied().filter_map(input).collect::<Result<_, _>>()?;
    let pool = fit_pool(&inputs).map_err(|why| match why {
        PoolError::TooFew { .. } | PoolError::Rates { .. } => NoPool::Unfit(why),
        why => NoPool::NoCommonModel(why),
    })?;
    let used: Vec<&Record> = pool.used.iter().map(|&i| fitted[i]).collect();
    let outliers: Vec<Outlier> =
        pool.outliers.iter().map(|outlier| Outlier::of(fitted[outlier.record], outlier)).collect();
    Ok(Pool {
        spread: pool.spread,
        used: used.iter().map(|record| record.label()).collect(),
        record: Record::together(&used, pool.fit, outliers.iter().map(Outlier::warning).collect()),
        outliers,
    })
}

fn check(records: &[Record]) -> Result<(), NoPool> {
    let names: Vec<String> = records.iter().map(Record::label).collect();
    if let Some((_, twice)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return Err(NoPool::Twice(twice.clone()));
    }
    let mixed = records.windows(2).find(|pair| pair[0].quantity != pair[1].quantity);
    mixed.map_or(Ok(()), |pair| Err(NoPool::Mixed(pair[0].label(), pair[1].label())))
}

impl Outlier {
    fn of(record: &Record, outlier: &allan::Outlier) -> Self {
        let why = match outlier.differs {
            Differs::Rejected { error } => format!("has no model of its own (off by {:.0} %)", error * 100.0),
            Differs::Moves => "has no model of its own (the sensor moves)".to_owned(),
            Differs::White { ratio } => format!("has {ratio:.2} times the N of the others"),
            Differs::Slow { gain } => format!("has other slow noise (−2 ln L differs by {gain:.0})"),
            _ => "differs".to_owned(),
        };
        Self { record: record.label(), why, is_left_out: outlier.is_left_out }
    }

    fn warning(&self) -> LogWarning {
        let rest = match self.is_left_out {
            true => "left out of the common model",
            false => "a third record would tell which is odd",
        };
        LogWarning::NotAlike(format!("{} {}: {rest}", self.record, self.why))
    }
}
