//! The twin, and the functions that make its SPI port and pins.

use crate::adc::NEVER;
use crate::fault::Fault;
use crate::part::Part;
use crate::pins::{SelfTestPin, SyncPin, TwinDelay, TwinRdy};
use crate::spec::{Motion, Spec};
use crate::spi::TwinSpi;
use crate::tally::{LastRead, LostUnread};
use crate::truth::Truth;
use alloc::rc::Rc;
use core::cell::RefCell;

/// An edge of RDY: its simulated time and its number.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct TwinEdge {
    /// Simulated time of the edge, in ns from the start.
    pub t_ns: u64,
    /// Running number of the edge, which wraps. Edges that announce new data count even if they are not reported. The
    /// other edges have numbers of their own, and count only if they are reported.
    pub seq: u32,
}

/// The simulated part. This is a handle, and its clones are handles of the same part.
///
/// Simulated time starts at 0 with the supply switched on. Only SPI frames, [`TwinDelay`], waits for RDY and
/// [`Twin::advance_ns`] let it pass.
#[derive(Clone, Debug)]
pub struct Twin {
    part: Rc<RefCell<Part>>,
}

impl Twin {
    /// Makes the part of this specification, just switched on.
    pub fn new(spec: Spec) -> Self {
        Self { part: Rc::new(RefCell::new(Part::new(spec))) }
    }

    /// The SPI port of the part. Every handle is the same port.
    pub fn spi(&self) -> TwinSpi {
        TwinSpi::new(&self.part)
    }

    /// The data-ready pin of the part.
    pub fn rdy(&self) -> TwinRdy {
        TwinRdy::new(&self.part)
    }

    /// A delay that lets simulated time pass.
    pub fn delay(&self) -> TwinDelay {
        TwinDelay::new(&self.part)
    }

    /// The self-test pins of the part (tied together, F-11), low at first.
    pub fn self_test_pin(&self) -> SelfTestPin {
        SelfTestPin::new(&self.part)
    }

    /// The SYNC pin (18) of the part, high at first.
    pub fn sync_pin(&self) -> SyncPin {
        SyncPin::new(&self.part)
    }

    /// The present simulated time, in ns from the start.
    pub fn now_ns(&self) -> u64 {
        self.part.borrow().now_ps / 1000
    }

    /// Lets `ns` nanoseconds of simulated time pass.
    pub fn advance_ns(&self, ns: u64) {
        self.part.borrow_mut().advance_ps(ns.saturating_mul(1000));
    }

    /// Returns the latest edge of RDY that announced new data and was not reported yet, like an interrupt flag that is
    /// still set. This is a falling edge, unless [`Spec::rdy`] sets a line whose rising edge announces new data. If
    /// all edges were reported, lets time pass to the next one. Returns `None` after `timeout_ns` of simulated time
    /// without an edge.
    #[inline]
    pub fn next_falling_edge(&self, timeout_ns: u64) -> Option<TwinEdge> {
        let edge = self.part.borrow_mut().next_falling_edge(timeout_ns.saturating_mul(1000));
        edge.map(|(t_ps, seq)| TwinEdge { t_ns: t_ps / 1000, seq })
    }

    /// Returns the next rising or falling edge of RDY, whose shape [`Spec::rdy`] sets. One of the two kinds announces
    /// new data. The other kind comes 27 µs before new data, when the scaling time begins (F-32). Past edges that
    /// announced new data and were not reported are handled as by [`Twin::next_falling_edge`]. Returns `None` after
    /// `timeout_ns` of simulated time without an edge.
    pub fn next_edge(&self, rising: bool, timeout_ns: u64) -> Option<TwinEdge> {
        let edge = self.part.borrow_mut().next_edge(rising, timeout_ns.saturating_mul(1000));
        edge.map(|(t_ps, seq)| TwinEdge { t_ns: t_ps / 1000, seq })
    }

    /// The time of the next event without bus traffic (a conversion ends, a fault sets in), in ns from the start,
    /// rounded up. `None` if there will be no event. New data is announced at such times, so a loop that lets
    /// simulated time follow the wall clock can sleep until then.
    pub fn next_event_ns(&self) -> Option<u64> {
        match self.part.borrow().next_event_ps {
            NEVER => None,
            t_ps => Some(t_ps.div_ceil(1000)),
        }
    }

    /// The true slow bias at the present simulated time.
    pub fn truth(&self) -> Truth {
        self.part.borrow_mut().truth()
    }

    /// Switches the supply off. SDO reads all ones, RDY announces no data, and the part cools. The slow processes go
    /// on.
    pub fn power_off(&self) {
        self.part.borrow_mut().switch(false);
    }

    /// Switches the supply on again. The registers then have their reset values, and nothing is converted.
    pub fn power_on(&self) {
        self.part.borrow_mut().switch(true);
    }

    /// Numbers of samples that the host never saw, per channel.
    pub fn lost_unread(&self) -> LostUnread {
        self.part.borrow().chip.adc.lost_unread()
    }

    /// The last reads of the data registers, with their conversions.
    pub fn last_read(&self) -> LastRead {
        self.part.borrow().chip.adc.last_read()
    }

    /// The specification of the part.
    pub fn spec(&self) -> Spec {
        self.part.borrow().spec.clone()
    }

    /// Replaces the present fault by this one. [`Fault::None`] repairs the wires, but does not restore the registers
    /// that a brown-out has reset.
    pub fn set_fault(&self, fault: Fault) {
        self.part.borrow_mut().set_fault(fault);
    }

    /// Plugs the cable in again after [`Fault::Unplug`]. The registers then have their reset values.
    pub fn replug(&self) {
        self.part.borrow_mut().replug();
    }

    /// Changes the ambient temperature linearly to `temp_c`, in °C, within `over_s` seconds. The change begins within
    /// 8 ms. The temperature then stays constant, apart from the wander. [`Spec::profile`] has no more effect.
    pub fn set_ambient(&self, temp_c: f64, over_s: f64) {
        self.part.borrow_mut().set_ambient(temp_c, over_s);
    }

    /// Sets the motion of the platform. The change begins within 8 ms.
    pub fn set_motion(&self, motion: Motion) {
        self.part.borrow_mut().set_motion(motion);
    }
}
