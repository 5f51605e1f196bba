//! Controls the set point. However a measurement ends, a chamber that the program set goes to its safe temperature,
//! and the user learns whether the chamber confirmed that.

use anyhow::Result;
use zerorate_host::{Chamber, ChamberSpec, ChamberThread, SafeEnd, Stop};

/// Receives the state in which the chamber is or will be left.
pub trait AirListener {
    /// Receives the state that the chamber would be left in if the program ended now.
    fn set_pending(&self, air: &AirState);

    /// Called if a stop was requested, right before a chamber that was set goes to its safe temperature.
    fn leaving(&self, air: &AirState);

    /// Receives the final state of the chamber and the result of setting the safe temperature. The result is `None`
    /// if a person sets the chamber. `air` is `None` if there is nothing to tell the user.
    fn settle(&self, air: Option<(&AirState, Option<&SafeEnd>)>);
}

/// Who sets the air temperature of the chamber, and to which values.
#[derive(Clone, Debug)]
pub struct AirState {
    /// True if a person sets the chamber by hand.
    pub by_hand: bool,
    /// The safe temperature, °C.
    pub safe_c: f64,
    /// The last set point that the chamber confirmed, °C; `None` before the first.
    pub set_c: Option<f64>,
}

/// The source of the air temperature: a recording, a person or a chamber.
pub(super) enum Control {
    Recording,
    Hand,
    Chamber(Box<dyn Chamber>),
}

/// Controls the set point. A chamber that was set gets its safe temperature at the end, at the latest on drop.
pub struct SetPointControl {
    pub(super) by: Control,
    /// True if the user must be told how the chamber was left. False for a simulated chamber.
    has_word: bool,
    state: AirState,
    /// True if a set point was sent. The chamber may have followed it even if the command failed.
    is_touched: bool,
    is_left: bool,
    stop: Stop,
    listener: Box<dyn AirListener>,
}

impl SetPointControl {
    /// Prepares the control. No command is run yet.
    ///
    /// # Errors
    /// Returns an error if no thread can be started.
    pub fn new(
        spec: Option<&ChamberSpec>,
        is_simulated: bool,
        safe_c: f64,
        stop: &Stop,
        listener: Box<dyn AirListener>,
    ) -> Result<Self> {
        let by = match spec.map(|spec| spec.chamber(stop)) {
            None => Control::Recording,
            Some(None) => Control::Hand,
            // a simulated sensor can wait for its chamber, but a slow command must not delay the reading of a real
            // sensor, so a real chamber has its own thread
            Some(Some(chamber)) if is_simulated => Control::Chamber(chamber),
            Some(Some(chamber)) => Control::Chamber(Box::new(ChamberThread::new(chamber)?)),
        };
        let has_word = matches!(spec, Some(ChamberSpec::Hand | ChamberSpec::Commands(_)));
        let state = AirState { by_hand: matches!(by, Control::Hand), safe_c, set_c: None };
        Ok(Self { by, has_word, state, is_touched: false, is_left: false, stop: stop.clone(), listener })
    }

    /// Checks that the chamber answers. If a person sets the chamber, passes its state to the listener instead.
    ///
    /// # Errors
    /// Returns an error if the chamber does not answer.
    pub fn start(&mut self) -> Result<()> {
        if self.state.by_hand {
            self.listener.set_pending(&self.state);
        }
        match &mut self.by {
            Control::Chamber(chamber) => Ok(chamber.start()?),
            Control::Recording | Control::Hand => Ok(()),
        }
    }

    /// The last set point that the chamber confirmed, °C.
    pub(super) fn set_c(&self) -> Option<f64> {
        self.state.set_c
    }

    /// Sends the set point `temp_c` to the chamber. Does nothing if a person sets the chamber, or for a recording.
    pub(super) fn set(&mut self, temp_c: f64) -> Result<()> {
        let Control::Chamber(chamber) = &mut self.by else { return Ok(()) };
        // the message is prepared before the command, which may take effect even if it fails
        if self.has_word {
            self.listener.set_pending(&self.state);
        }
        self.is_touched = true;
        chamber.set(temp_c)?;
        self.state.set_c = Some(temp_c);
        if self.has_word {
            self.listener.set_pending(&self.state);
        }
        Ok(())
    }

    /// Sets a chamber that was set to its safe temperature, once, and sends the final message to the listener.
    pub(super) fn leave(&mut self) {
        if std::mem::replace(&mut self.is_left, true) {
            return;
        }
        let Self { by, has_word, state, is_touched, stop, listener, .. } = self;
        match by {
            Control::Recording => listener.settle(None),
            Control::Hand => listener.settle(Some((state, None))),
            Control::Chamber(chamber) => {
                if stop.asked() && *has_word && *is_touched {
                    listener.leaving(state);
                }
                let end = chamber.end(state.safe_c);
                listener.settle(end.as_ref().map(|end| (&*state, Some(end))));
            }
        }
    }
}

impl Drop for SetPointControl {
    fn drop(&mut self) {
        self.leave();
    }
}
