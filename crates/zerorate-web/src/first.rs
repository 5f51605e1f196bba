//! A preview of the twin, the simulated sensor, from a small module that loads fast. The session takes over when its
//! own module is loaded.

use crate::live::Pace;
use crate::message::DeviceState;
use crate::session::{LiveView, encode};
use crate::source::{Source, TwinSource};

/// A preview of a simulated unit from its power-on.
pub struct FirstLook {
    live_view: LiveView,
    /// `None` if the twin cannot be read any longer. The session will report the reason.
    source: Option<TwinSource>,
    pace: Pace,
}

impl FirstLook {
    /// Opens the unit with these keys, in the syntax of `--device twin:`.
    ///
    /// # Errors
    /// Returns an error if a key is unknown, or the part does not answer.
    pub fn open(keys: &str) -> Result<Self, String> {
        let source = TwinSource::open(keys)?;
        let about = source.about();
        let pace = Pace::of(&about);
        let mut live_view = LiveView::new(about);
        live_view.state(DeviceState::Reading);
        Ok(Self { live_view, source: Some(source), pace })
    }

    /// Reads the samples that are due, for about `budget_ms`. `clock` returns the page's time, ms.
    pub fn turn(&mut self, clock: &mut dyn FnMut() -> f64, budget_ms: f64) {
        let Some(source) = &mut self.source else { return };
        let until_ms = clock() + budget_ms;
        let live_view = &mut self.live_view;
        let more = self.pace.readings(source, clock, until_ms, |row| {
            live_view.take(row, &mut ());
        });
        if more != Ok(true) {
            self.source = None;
        }
    }

    /// The frame with all changes since the last call; `None` if nothing changed.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        let (frame, payload) = self.live_view.is_changed().then(|| self.live_view.news(None))?;
        Some(encode(&frame, &payload))
    }

    /// A complete frame, for a newly opened window.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let (frame, payload) = self.live_view.everything(None);
        encode(&frame, &payload)
    }

    /// Duration of the preview, s of the twin's time, for [`Live::catch_up`](crate::live::Live::catch_up).
    #[must_use]
    pub fn shown_s(&self) -> f64 {
        self.live_view.now_s()
    }
}
