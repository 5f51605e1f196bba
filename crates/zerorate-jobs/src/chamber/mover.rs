//! Moves the air. After any end of a measurement, the chamber is sent to its safe temperature, and the user hears how
//! it was left.

use anyhow::Result;
use zerorate_host::{Apart, Chamber, ChamberSpec, Left, Stop};

/// Hears what becomes of the air.
pub trait AirListener {
    /// Hears what is true if the program ends from here on.
    fn owe(&self, air: &AirState);

    /// The chamber is being sent where it may stay, since that was asked.
    fn leaving(&self, air: &AirState);

    /// Hears what became of it; none: there is nothing to say. `left` is what a chamber did; else it is set by hand.
    fn settle(&self, air: Option<(&AirState, Option<&Left>)>);
}

/// The known facts about the air.
#[derive(Clone, Debug)]
pub struct AirState {
    /// The name of a real chamber.
    pub name: Option<String>,
    /// The safe temperature, °C.
    pub safe_c: f64,
    /// The set point that it was told last, °C.
    pub told_c: Option<f64>,
}

/// The mover of the air.
pub(super) enum By {
    /// A recording has decided that already.
    Nobody,
    /// Somebody at the knobs, who hears of each step.
    Hand,
    /// A chamber.
    Chamber(Box<dyn Chamber>),
}

/// Moves the air until it is left, at the latest when this is dropped.
pub struct Mover {
    pub(super) by: By,
    state: AirState,
    is_left: bool,
    stop: Stop,
    listener: Box<dyn AirListener>,
}

impl Mover {
    /// Nothing is told or started by this.
    pub fn new(
        spec: Option<&ChamberSpec>,
        is_simulated: bool,
        safe_c: f64,
        stop: &Stop,
        listener: Box<dyn AirListener>,
    ) -> Result<Self> {
        let by = match spec.map(|spec| spec.chamber(stop)) {
            None => By::Nobody,
            Some(None) => By::Hand,
            // nobody waits for a chamber while a part is read; a simulated part waits anyway
            Some(Some(chamber)) if is_simulated => By::Chamber(chamber),
            Some(Some(chamber)) => By::Chamber(Box::new(Apart::new(chamber)?)),
        };
        let name = spec.filter(|spec| matches!(spec, ChamberSpec::Lines(_))).map(ToString::to_string);
        let state = AirState { name, safe_c, told_c: None };
        Ok(Self { by, state, is_left: false, stop: stop.clone(), listener })
    }

    /// Sets it going.
    pub fn start(&mut self) -> Result<()> {
        self.owe();
        match &mut self.by {
            By::Chamber(chamber) => Ok(chamber.start()?),
            By::Nobody | By::Hand => Ok(()),
        }
    }

    /// The set point that it was told last, °C.
    pub(super) fn told_c(&self) -> Option<f64> {
        self.state.told_c
    }

    /// Sends a chamber's air to a temperature, °C.
    pub(super) fn set(&mut self, temp_c: f64) -> Result<()> {
        let By::Chamber(chamber) = &mut self.by else { return Ok(()) };
        chamber.set(temp_c)?;
        self.state.told_c = Some(temp_c);
        self.owe();
        Ok(())
    }

    /// Notes that the user must hear about the chamber; a simulated one needs no word.
    fn owe(&self) {
        if matches!(self.by, By::Hand) || self.state.name.is_some() {
            self.listener.owe(&self.state);
        }
    }

    /// Sends it where it may stay, once, and settles what is said last.
    pub(super) fn leave(&mut self) {
        if std::mem::replace(&mut self.is_left, true) {
            return;
        }
        let Self { by, state, stop, listener, .. } = self;
        match by {
            By::Nobody => listener.settle(None),
            By::Hand => listener.settle(Some((state, None))),
            By::Chamber(chamber) => {
                if stop.asked() && state.name.is_some() {
                    listener.leaving(state);
                }
                let left = chamber.end(state.safe_c);
                listener.settle(left.as_ref().map(|left| (&*state, Some(left))));
            }
        }
    }
}

impl Drop for Mover {
    fn drop(&mut self) {
        self.leave();
    }
}
