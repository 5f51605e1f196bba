//! The pins RDY, SYNC and self-test, and the delay, with the traits of embedded-hal.

use crate::part::Part;
use alloc::rc::Rc;
use core::cell::RefCell;
use core::convert::Infallible;
use core::fmt;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};
use embedded_hal_async::digital::Wait;

macro_rules! pin {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $name {
            part: Rc<RefCell<Part>>,
        }

        impl $name {
            pub(crate) fn new(part: &Rc<RefCell<Part>>) -> Self {
                Self { part: Rc::clone(part) }
            }
        }
    };
}

pin!(
    /// The data-ready pin (F-32). Reading it takes no simulated time.
    ///
    /// A wait lets simulated time pass at once, so its future is ready at once. It fails after one second of simulated
    /// time, since nothing else could end it. A wait for an edge ends only with an edge after the call. A wait that
    /// takes time drops an edge that [`Twin::next_falling_edge`](crate::Twin::next_falling_edge) would report.
    TwinRdy
);
pin!(
    /// The SYNC pin (18). With IOP.SYNC = 1 a low level holds the conversions, and a rising edge restarts the
    /// sequence.
    SyncPin
);
pin!(
    /// The self-test pins, tied together: a high level shifts the rate by
    /// [`Spec::self_test_dps`](crate::Spec::self_test_dps), before the sensitivity error.
    SelfTestPin
);
pin!(
    /// A delay that lets simulated time pass.
    TwinDelay
);

/// Longest wait on [`TwinRdy`], in ns of simulated time.
pub const RDY_WAIT_LIMIT_NS: u64 = 1_000_000_000;

/// The error if the awaited change of RDY does not come within [`RDY_WAIT_LIMIT_NS`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct RdyTimeout;

impl fmt::Display for RdyTimeout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RDY did not change as awaited within {RDY_WAIT_LIMIT_NS} ns of simulated time")
    }
}

impl core::error::Error for RdyTimeout {}

impl Error for RdyTimeout {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl TwinRdy {
    fn wait(&self, done: impl Fn(bool, bool) -> bool) -> Result<(), RdyTimeout> {
        let mut part = self.part.borrow_mut();
        let came = part.wait_rdy(RDY_WAIT_LIMIT_NS * 1000, done);
        part.clear_latched_edge();
        if came { Ok(()) } else { Err(RdyTimeout) }
    }

    fn wait_level(&self, high: bool) -> Result<(), RdyTimeout> {
        if self.part.borrow().rdy_high() == high {
            return Ok(());
        }
        self.wait(|_, now| now == high)
    }
}

impl ErrorType for TwinRdy {
    type Error = RdyTimeout;
}

impl InputPin for TwinRdy {
    #[inline]
    fn is_high(&mut self) -> Result<bool, RdyTimeout> {
        Ok(self.part.borrow().rdy_high())
    }

    #[inline]
    fn is_low(&mut self) -> Result<bool, RdyTimeout> {
        self.is_high().map(|high| !high)
    }
}

impl Wait for TwinRdy {
    async fn wait_for_high(&mut self) -> Result<(), RdyTimeout> {
        self.wait_level(true)
    }

    async fn wait_for_low(&mut self) -> Result<(), RdyTimeout> {
        self.wait_level(false)
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), RdyTimeout> {
        self.wait(|before, now| !before && now)
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), RdyTimeout> {
        self.wait(|before, now| before && !now)
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), RdyTimeout> {
        self.wait(|before, now| before != now)
    }
}

macro_rules! output {
    ($name:ident, $set:ident) => {
        impl ErrorType for $name {
            type Error = Infallible;
        }

        impl OutputPin for $name {
            fn set_low(&mut self) -> Result<(), Infallible> {
                self.part.borrow_mut().$set(false);
                Ok(())
            }

            fn set_high(&mut self) -> Result<(), Infallible> {
                self.part.borrow_mut().$set(true);
                Ok(())
            }
        }
    };
}

output!(SyncPin, set_sync);
output!(SelfTestPin, set_self_test);

impl DelayNs for TwinDelay {
    fn delay_ns(&mut self, ns: u32) {
        self.part.borrow_mut().advance_ps(u64::from(ns) * 1000);
    }
}

impl embedded_hal_async::delay::DelayNs for TwinDelay {
    async fn delay_ns(&mut self, ns: u32) {
        DelayNs::delay_ns(self, ns);
    }
}
