//! The driver over async traits: [`embedded_hal_async::spi::SpiDevice`], [`Wait`](embedded_hal_async::digital::Wait).
//!
//! This task gives the processor to other tasks while it waits. It runs on the software twin of the part:
//!
//! ```
//! use adis16130::{Config, Error, WaitBound, asynch::Adis16130};
//! use adis16130_twin::{RdyTimeout, Spec, Twin};
//! # use core::{convert::Infallible, future::Future, pin::pin, task::{Context, Poll, Waker}};
//!
//! async fn mean_dps(twin: &Twin) -> Result<f32, Error<Infallible, RdyTimeout>> {
//!     let mut delay = twin.delay(); // on a board: an async DelayNs, such as embassy_time::Delay
//!     let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), Config::new());
//!     gyro.restart().await?;
//!     let mut sum_dps = 0.0;
//!     for _ in 0..100 {
//!         gyro.wait_ready(&mut delay, WaitBound::from_us(2_000)).await?;
//!         let (rate, _) = gyro.read_in_range().await?;
//!         sum_dps += rate.to_dps();
//!     }
//!     Ok(sum_dps / 100.0)
//! }
//! # fn block_on<F: Future>(future: F) -> F::Output {
//! #     match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
//! #         Poll::Ready(output) => output,
//! #         Poll::Pending => unreachable!("the twin's futures are ready at once"),
//! #     }
//! # }
//!
//! assert!(block_on(mean_dps(&Twin::new(Spec::from_seed(1))))?.abs() < 10.0);
//! # Ok::<(), Error<_, _>>(())
//! ```
//!
//! A future may be dropped at any time, by a `select` or a timeout. If it is dropped in the middle of a command, the
//! next calls return [`BusError::Interrupted`](crate::BusError::Interrupted) until `reset` or `restart` succeeds.

use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::Poll;

use bisync_macros::internal_noop as bisync;
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::digital::Wait as RdyPin;
use embedded_hal_async::spi::SpiDevice;

use crate::config::RdyEdge;
use crate::error::WaitError;
use crate::wait::WaitBound;

pub use driver::Adis16130;

#[path = "driver.rs"]
#[allow(clippy::duplicate_mod, reason = "both drivers are made of this one source")]
mod driver;

impl<SPI: SpiDevice, RDY: RdyPin> Adis16130<SPI, RDY> {
    /// Waits until RDY shows unread data (F-32). Returns [`WaitError::TimedOut`] if the time of `bound`, measured by
    /// `delay`, ends first.
    async fn wait_for_rdy(
        &mut self,
        delay: &mut impl DelayNs,
        bound: WaitBound,
    ) -> Result<(), WaitError<SPI::Error, RDY::Error>> {
        let edge = self.config.rdy_edge();
        let ready = async {
            match edge {
                RdyEdge::Falling => self.rdy.wait_for_low().await,
                RdyEdge::Rising => self.rdy.wait_for_high().await,
            }
        };
        match first(ready, delay.delay_us(bound.timeout_us())).await {
            First::Left(ready) => ready.map_err(WaitError::Pin),
            First::Right(()) => Err(WaitError::TimedOut { timeout_us: bound.timeout_us() }),
        }
    }
}

enum First<L, R> {
    Left(L),
    Right(R),
}

/// Returns the output of the future that ends first (of the left one, if both are ready). Drops the other future.
async fn first<L: Future, R: Future>(left: L, right: R) -> First<L::Output, R::Output> {
    let (mut left, mut right) = (pin!(left), pin!(right));
    poll_fn(|context| {
        if let Poll::Ready(output) = left.as_mut().poll(context) {
            return Poll::Ready(First::Left(output));
        }
        right.as_mut().poll(context).map(First::Right)
    })
    .await
}
