//! Progress on stderr: a bar with current step, percentage and remaining time, or a spinner if the duration is
//! unknown. Both are hidden if stderr is not a terminal.

use crate::output::{clear, show, warn};
use crate::wording::{coded, flag};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::thread;
use std::time::Duration;
use zerorate::{Progress, Reached, Setting, SettingNames};
use zerorate_jobs::JobWarning;
use zerorate_jobs::calibrate::Watch;
use zerorate_view::Seconds;

#[derive(Debug)]
pub struct Meter {
    bar: ProgressBar,
    scale: f64,
    note: Option<String>,
}

impl Meter {
    /// A progress bar that is full at `total`, in seconds of the part's time or in samples.
    pub fn new(total: f64) -> Self {
        let bar = ProgressBar::new(STEPS);
        let style = ProgressStyle::with_template("{msg:32} {wide_bar:.cyan/dim} {percent:>3} %  {eta} left ");
        // the template is a constant; should it be invalid, the default style is used
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        show(&bar);
        Self { bar, scale: STEPS as f64 / total.max(f64::MIN_POSITIVE), note: None }
    }

    /// Shows the amount `done`, in the unit of the total, and the current step. Call this every few thousand samples.
    pub fn show(&self, done: f64, step: String) {
        self.bar.set_message(step);
        self.bar.set_position((done * self.scale) as u64);
    }

    /// Like [`Meter::show`], for a measurement whose total changes: `left` is the remaining amount.
    pub fn show_left(&self, done: f64, left: f64, step: String) {
        self.bar.set_message(step);
        self.bar.set_position((done / (done + left).max(f64::MIN_POSITIVE) * STEPS as f64) as u64);
    }

    /// True if the bar is hidden. The text of the current step is then not needed.
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
        clear();
    }
}

pub struct Busy;

impl Busy {
    /// After two seconds, shows `message` and the elapsed time.
    pub fn with(message: String) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()).with_message(message);
        let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        show(&bar);
        thread::spawn(move || {
            thread::sleep(Duration::from_secs(2));
            if !bar.is_finished() {
                bar.set_draw_target(ProgressDrawTarget::stderr());
                bar.enable_steady_tick(Duration::from_millis(200));
            }
        });
        Self
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        clear();
    }
}

const STEPS: u64 = 100_000;
