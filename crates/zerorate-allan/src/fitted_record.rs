//! The deviations and the noise model of a record at rest, computed in the same way for every front end.

use crate::{
    AllanWarning, Analysis, AnalysisError, DetrendedRate, Fit, FitError, FitOptions, Input, Line, Options, Term,
    analyse, fit,
};
use alloc::vec::Vec;

/// How the dependence of the rate on temperature was treated before the analysis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preparation {
    /// The rate without a polynomial over temperature, if one was removed.
    pub detrended: Option<DetrendedRate>,
    /// The warning that the rate follows the temperature, if it does and no polynomial was removed.
    pub follows: Option<AllanWarning>,
}

/// A record with its noise model, from which deviations are computed.
pub struct FittedRecord<'a> {
    input: Input<'a>,
    rate_hz: f64,
    scale: f64,
    detrended: Option<DetrendedRate>,
    fit: Option<Result<Fit, FitError>>,
}

impl<'a> FittedRecord<'a> {
    /// Fits the noise model if `options` is given. `scale` is the size of one input step in the unit of the result.
    #[must_use]
    pub fn new(
        input: Input<'a>,
        rate_hz: f64,
        scale: f64,
        options: Option<FitOptions>,
        settled: &Preparation,
    ) -> Self {
        let mut fit = options.map(|options| fit(&input, rate_hz, &FitOptions { scale, ..options }));
        let Preparation { detrended, follows, .. } = settled;
        if let Some(Ok(fit)) = &mut fit {
            if let Some(detrended) = detrended {
                fit.k = detrended.widened_walk(&fit.k);
            }
            if let Some(follows) = follows {
                fit.warnings.insert(0, *follows);
            }
        }
        Self { input, rate_hz, scale, detrended: detrended.clone(), fit }
    }

    /// The deviations of the record without the glitches and steps that the fit removed, so that curve and fit can be
    /// compared. A removed polynomial over temperature widens the intervals. `options.scale` is not used.
    ///
    /// # Errors
    /// Returns the errors of [`analyse`].
    pub fn deviations(&self, options: &Options) -> Result<Analysis, AnalysisError> {
        let (input, scale) = match self.cleaned() {
            Some(rate) => (Input::Rate(rate), 1.0),
            None => (self.input, self.scale),
        };
        let mut analysis = analyse(&input, self.rate_hz, &Options { scale, ..options.clone() })?;
        if let Some(detrended) = &self.detrended {
            analysis.points.iter_mut().for_each(|point| *point = detrended.widened(point, options.confidence));
        }
        Ok(analysis)
    }

    /// The record without glitches and steps, in the unit of the result; `None` if nothing was removed.
    #[must_use]
    pub fn cleaned(&self) -> Option<&[f64]> {
        self.fit.iter().flatten().find_map(|fit| fit.cleaned.rate.as_deref())
    }

    /// The samples from which the deviations are computed, in the unit of the result; NaN is a missing sample.
    #[must_use]
    pub fn rates(&self) -> Vec<f64> {
        match self.cleaned() {
            Some(rate) => rate.to_vec(),
            None => self.input.rates(self.rate_hz, self.scale),
        }
    }

    /// The noise model, if one was requested.
    #[must_use]
    pub fn into_fit(self) -> Option<Result<Fit, FitError>> {
        self.fit
    }
}

impl Fit {
    /// The spectral lines in the model.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.terms.iter().filter_map(|term| if let Term::Line(line) = term { Some(line) } else { None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Stat, detrend, deviations};

    /// A ramp of temperature with a rate that follows it, and one sample that cannot be noise.
    fn warming() -> (Vec<f64>, Vec<f64>) {
        let mut uniform = crate::fit::tests::uniform(7);
        let temps: Vec<f64> = (0..60_000).map(|k| 25.0 + 1e-4 * f64::from(k)).collect();
        let mut rates: Vec<f64> = temps.iter().map(|temp| 0.05 * temp + (uniform() - 0.5)).collect();
        rates[30_000] += 500.0;
        (rates, temps)
    }

    #[test]
    fn a_glitch_and_the_temperature_affect_neither_model_nor_deviations() {
        let (rates, temps) = warming();
        let detrended = detrend(&rates, &temps, 1).unwrap();
        let residual = detrended.residual.clone();
        let settled = Preparation { detrended: Some(detrended), ..Preparation::default() };
        let options = Options::default();
        let analysed = FittedRecord::new(Input::Rate(&residual), 100.0, 2.0, Some(FitOptions::default()), &settled);
        let curve = analysed.deviations(&options).unwrap();
        // the expected deviation, from samples without the glitch; it is doubled below, for the scale of the record
        let mut plain = residual.clone();
        plain[30_000] = (plain[29_999] + plain[30_001]) / 2.0;
        let expected = deviations(&Input::Rate(&plain), 100.0, Stat::Oadev, &[1])[0].unwrap();
        assert!((curve.points[0].dev / (2.0 * expected.dev) - 1.0).abs() < 1e-3, "{:?}", curve.points[0]);
        let unsettled = FittedRecord::new(Input::Rate(&residual), 100.0, 2.0, None, &Preparation::default());
        let last = |analysed: &FittedRecord<'_>| *analysed.deviations(&options).unwrap().points.last().unwrap();
        assert!(last(&analysed).edf < last(&unsettled).edf, "what the line took is missing from the last averages");
        assert!(analysed.cleaned().is_some() && unsettled.cleaned().is_none() && unsettled.into_fit().is_none());
    }

    #[test]
    fn a_model_says_that_its_rate_follows_the_temperature() {
        let (rates, _) = warming();
        let follows = AllanWarning::FollowsTemperature { explained: 0.9, slope: 0.05, span_c: 6.0 };
        let settled = Preparation { follows: Some(follows), ..Preparation::default() };
        let analysed = FittedRecord::new(Input::Rate(&rates), 100.0, 1.0, Some(FitOptions::default()), &settled);
        let fit = analysed.into_fit().unwrap().unwrap();
        assert_eq!(fit.warnings[0], follows);
    }
}
