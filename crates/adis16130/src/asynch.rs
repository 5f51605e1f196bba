//! The driver over async traits: [`embedded_hal_async::spi::SpiDevice`], [`Wait`](embedded_hal_async::digital::Wait).

use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::Poll;

use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::digital::Wait as RdyPin;
use embedded_hal_async::spi::SpiDevice;

use crate::config::RdyEdge;
use crate::error::WaitError;
use crate::wait::WaitBound;

crate::shell::shell!([async] [.await]);

impl<SPI, RDY: RdyPin> Adis16130<SPI, RDY> {
    /// Waits until RDY says that data waits (F-32), or until `delay` says that the bound is over.
    pub async fn wait_ready(
        &mut self,
        delay: &mut impl DelayNs,
        bound: WaitBound,
    ) -> Result<(), WaitError<RDY::Error>> {
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

/// The output of whichever future ends first, the left one if both do; the other is dropped.
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
