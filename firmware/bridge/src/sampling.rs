//! The sampling side: two tasks at the same priority, above everything else that takes time.

use core::convert::Infallible;

use adis16130::Edge;
use adis16130::bridge::{Bus, Decoder, Station};
use embassy_futures::select::{Either3, select3};
use embassy_time::Instant;
use embedded_hal_async::digital::Wait;

use crate::Link;

/// The SPI clock until a host asks for another: half of what the part takes (F-21), for wires and level shifters.
const FIRST_SCLK_HZ: u32 = 5_000_000;

/// Numbers every falling edge of RDY and notes its time, also while the part is being read.
pub async fn watch(mut rdy: impl Wait<Error = Infallible>, link: &Link) -> ! {
    let mut seq = 0_u32;
    loop {
        let Ok(()) = rdy.wait_for_falling_edge().await;
        let t_ns = 1_000 * Instant::now().as_micros();
        seq = seq.wrapping_add(1);
        link.edge.signal(Edge { t_ns, seq });
    }
}

/// Owns the part: reads it at edges, and does what hosts ask for. `firmware` is the name as in [`Station::new`].
pub async fn serve(mut bus: impl Bus, firmware: &'static str, link: &Link) -> ! {
    let sclk_hz = bus.set_sclk_hz(FIRST_SCLK_HZ);
    let mut station = Station::new(bus, sclk_hz, firmware);
    let mut requests = Decoder::new();
    let mut bytes = [0; 64];
    loop {
        match select3(link.gone.wait(), link.edge.wait(), link.from_host.read(&mut bytes)).await {
            Either3::First(()) => {
                station.stop();
                requests = Decoder::new();
                link.clear().await;
            }
            Either3::Second(edge) => {
                if let Some(message) = station.edge(edge).await {
                    link.send(&message).await;
                }
            }
            Either3::Third(len) => {
                for byte in &bytes[..len] {
                    // to a damaged request there is no answer, so the host asks again
                    if let Some(Ok(request)) = requests.push(*byte) {
                        link.send(&station.request(&request).await).await;
                    }
                }
            }
        }
    }
}
