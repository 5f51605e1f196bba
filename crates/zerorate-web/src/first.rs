//! The first look at the twin, by a module that is small: what is seen of it, until the session with all that is known
//! of it has come and goes on in its place.

use crate::live::Pace;
use crate::message::DeviceState;
use crate::session::{LiveView, encode};
use crate::source::{Source, TwinSource};

/// A unit of the twin that was just switched on.
pub struct FirstLook {
    live_view: LiveView,
    /// None: it can be read no more; the session will say why.
    source: Option<TwinSource>,
    pace: Pace,
}

impl FirstLook {
    /// A unit by its keys, as after `--device twin:`.
    ///
    /// # Errors
    /// Keys that there are not, or a part that does not answer.
    pub fn open(keys: &str) -> Result<Self, String> {
        let source = TwinSource::open(keys)?;
        let about = source.about();
        let pace = Pace::of(&about);
        let mut live_view = LiveView::new(about);
        live_view.state(DeviceState::Reading);
        Ok(Self { live_view, source: Some(source), pace })
    }

    /// Takes readings for at most so long, as far as their time has come; `clock` tells the time of the page, ms.
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

    /// What is new; none: nothing.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        let (frame, payload) = self.live_view.is_changed().then(|| self.live_view.news(None))?;
        Some(encode(&frame, &payload))
    }

    /// All there is, for a window that just came.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let (frame, payload) = self.live_view.everything(None);
        encode(&frame, &payload)
    }

    /// How long it was looked at, s of its time: where [`Live::catch_up`](crate::live::Live::catch_up) goes on.
    #[must_use]
    pub fn shown_s(&self) -> f64 {
        self.live_view.now_s()
    }
}
