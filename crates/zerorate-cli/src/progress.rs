//! The progress bar on stderr: the step in words, the progress, the time left. It is hidden where stderr is not a
//! terminal.

use crate::output::warn;
use crate::wording::{coded, flag};
use indicatif::{ProgressBar, ProgressStyle};
use zerorate::{Progress, Reached, Setting, SettingNames};
use zerorate_jobs::JobWarning;
use zerorate_jobs::calibrate::Watch;
use zerorate_view::Seconds;

/// Progress of a measurement whose length is known.
#[derive(Debug)]
pub struct Meter {
    bar: ProgressBar,
    scale: f64,
    note: Option<String>,
}

impl Meter {
    /// A meter for a measurement that ends at `total`, in seconds of part time or in samples.
    pub fn new(total: f64) -> Self {
        let bar = ProgressBar::new(STEPS);
        let style = ProgressStyle::with_template("{msg:32} {wide_bar:.cyan/dim} {percent:>3} %  {eta} left ");
        // the template is a constant; if it were wrong, the plain bar would still do
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar, scale: STEPS as f64 / total.max(f64::MIN_POSITIVE), note: None }
    }

    /// Shows how much of the measurement is done, and the current step. Call it every few thousand samples.
    pub fn show(&self, done: f64, step: String) {
        self.bar.set_message(step);
        self.bar.set_position((done * self.scale) as u64);
    }

    /// The same where only the rest is known, in the unit of the total.
    pub fn show_left(&self, done: f64, left: f64, step: String) {
        self.bar.set_message(step);
        self.bar.set_position((done / (done + left).max(f64::MIN_POSITIVE) * STEPS as f64) as u64);
    }

    /// Whether nobody can see the bar.
    pub fn is_hidden(&self) -> bool {
        self.bar.is_hidden()
    }
}

impl Watch for Meter {
    fn see(&mut self, progress: &Progress) -> bool {
        if !self.is_hidden() {
            let step = self.note.clone().unwrap_or_else(|| progress.state.to_string());
            self.show(progress.elapsed_s, step);
        }
        true
    }

    fn approach(&mut self, Reached { u_dps, left_s, .. }: Reached) {
        let settles = if left_s > 0.0 { format!(", settles in {}", Seconds(left_s.round())) } else { String::new() };
        self.note = Some(format!("{:.1} °/h ({}){settles}", 3600.0 * u_dps, flag(Setting::Target)));
    }

    fn warn(&mut self, warning: JobWarning) {
        warn(&[coded(warning)]);
    }

    fn names(&self) -> SettingNames {
        flag
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Resolution of the bar.
const STEPS: u64 = 100_000;
