//! The first look at the twin, by a small module. It shows the twin until the whole session has been loaded and
//! continues
//! from there.

use crate::live::Pace;
use crate::message::DeviceState;
use crate::session::{LiveView, encode};
use crate::source::{Source, TwinSource};

/// A unit of the twin that was just switched on.
pub struct FirstLook {
    live_view: LiveView,
    /// `None` if the twin can no longer be read; the session will say why.
    source: Option<TwinSource>,
    pace: Pace,
}

impl FirstLook {
    /// Opens the unit with these keys, as after `--device twin:`.
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

    /// Takes readings whose time has come, for at most this long. `clock` tells the time of the page, ms.
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

    /// The frame with everything that changed, or `None` if nothing did.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        let (frame, payload) = self.live_view.is_changed().then(|| self.live_view.news(None))?;
        Some(encode(&frame, &payload))
    }

    /// The frame with everything, for a window that just opened.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let (frame, payload) = self.live_view.everything(None);
        encode(&frame, &payload)
    }

    /// How long the twin was looked at, s of its time. [`Live::catch_up`](crate::live::Live::catch_up) continues
    /// there.
    #[must_use]
    pub fn shown_s(&self) -> f64 {
        self.live_view.now_s()
    }
}
