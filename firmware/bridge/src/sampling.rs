//! The sampling side: two tasks of the same priority, which is higher than the priority of USB.

use core::convert::Infallible;

use adis16130::bridge::{Bus, Decoder, Message, Station};
use adis16130::{Edge, RdyEdge};
use embassy_futures::select::{Either, Either3, select, select3};
use embassy_time::{Duration, Instant, with_timeout};
use embedded_hal_async::digital::Wait;

use crate::Link;
use crate::link::SIGN_OF_LIFE;
use crate::state::State;

/// The SPI clock until a host sets it, Hz: half of the part's maximum (F-21), for long wires and level shifters.
const FIRST_SCLK_HZ: u32 = 5_000_000;

/// The watchdog resets the chip if nothing feeds it for this time: a transfer never ends, or the executor has stopped.
pub const WATCHDOG: Duration = Duration::from_millis(2_000);

/// Numbers every edge of RDY that announces new data, and notes the time of the edge, also while the part is being
/// read. These are the falling edges, unless a host chooses the rising ones (F-32).
pub async fn watch(mut rdy: impl Wait<Error = Infallible>, link: &Link) -> ! {
    let (mut seq, mut heard) = (0_u32, RdyEdge::Falling);
    loop {
        let Either::First(()) = select(next(&mut rdy, heard), async { heard = link.heard.wait().await }).await else {
            continue;
        };
        let t_ns = 1_000 * Instant::now().as_micros();
        seq = seq.wrapping_add(1);
        link.edge.signal(Edge { t_ns, seq });
    }
}

async fn next(rdy: &mut impl Wait<Error = Infallible>, kind: RdyEdge) {
    let Ok(()) = match kind {
        RdyEdge::Falling => rdy.wait_for_falling_edge().await,
        RdyEdge::Rising => rdy.wait_for_rising_edge().await,
    };
}

/// Answers the requests of hosts and, while the bridge samples, reads the part at each edge. Only this task uses the
/// bus of the part. `firmware` is the name for [`Station::new`]. `alive` feeds the watchdog, which nothing else does.
pub async fn serve(mut bus: impl Bus, firmware: &'static str, link: &Link, mut alive: impl FnMut()) -> ! {
    let sclk_hz = bus.set_sclk_hz(FIRST_SCLK_HZ);
    let mut station = Station::new(bus, sclk_hz, firmware);
    let mut requests = Decoder::new();
    let mut bytes = [0; 64];
    loop {
        alive();
        let next = select3(link.gone.wait(), link.edge.wait(), link.from_host.read(&mut bytes));
        let Ok(next) = with_timeout(SIGN_OF_LIFE, next).await else { continue };
        match next {
            Either3::First(()) => {
                station.stop();
                requests = Decoder::new();
                link.clear().await;
                link.show(State::Idle);
            }
            Either3::Second(edge) => {
                if let Some(message) = station.edge(edge).await {
                    if message == Message::Ended {
                        link.show(State::Failed);
                    }
                    link.send(&message, &mut alive).await;
                }
            }
            Either3::Third(len) => {
                for byte in &bytes[..len] {
                    // a damaged request gets no answer, so the host sends it again
                    if let Some(Ok(request)) = requests.push(*byte) {
                        link.send(&station.request(&request).await, &mut alive).await;
                        link.show(if station.is_sampling() { State::Sampling } else { State::Ready });
                    }
                }
            }
        }
    }
}
