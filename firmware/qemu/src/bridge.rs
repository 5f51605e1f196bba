//! A bridge whose part is the twin. Simulated time passes as fast as the host takes samples.
//!
//! The tests of the program `zerorate` include this file too, with a socket as the port.

use adis16130::Edge;
use adis16130::bridge::{Bus, Decoder, MAX_FRAME, Message, Station, encode};
use adis16130_twin::{SelfTestPin, Twin, TwinSpi};
use core::convert::Infallible;
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::Operation;
use embedded_hal_async::spi::{ErrorType, SpiDevice};

/// SPI clock until a host sets another one, Hz.
const FIRST_SCLK_HZ: u32 = 5_000_000;
/// Longest simulated time between two checks for requests, ns.
const LOOK_NS: u64 = 1_000_000;

/// The connection to the host.
pub trait Port {
    /// The error that ends the connection.
    type Closed;

    /// Reads the next byte. Returns `None` if there is none. With `wait`, waits for a byte.
    fn read(&mut self, wait: bool) -> Result<Option<u8>, Self::Closed>;

    /// Sends all bytes.
    fn write(&mut self, bytes: &[u8]) -> Result<(), Self::Closed>;
}

/// Serves the host at `port` until the connection closes.
pub fn serve<P: Port>(twin: &Twin, firmware: &'static str, port: &mut P) -> Result<Infallible, P::Closed> {
    let bus = TwinBus { spi: twin.spi(), self_test: twin.self_test_pin() };
    let mut station = Station::new(bus, FIRST_SCLK_HZ, firmware);
    let mut requests = Decoder::new();
    loop {
        while let Some(byte) = port.read(!station.is_sampling())? {
            if let Some(Ok(request)) = requests.push(byte) {
                // simulated time goes on also without sampling, so that the host sees edges of RDY
                pass_edge(twin, &mut station, port)?;
                send(port, &at_once(station.request(&request)))?;
            }
        }
        pass_edge(twin, &mut station, port)?;
    }
}

/// Passes the next edge of RDY to the bridge, and sends the message that it returns, if any.
fn pass_edge<P: Port>(twin: &Twin, station: &mut Station<TwinBus>, port: &mut P) -> Result<(), P::Closed> {
    let Some(edge) = twin.next_falling_edge(LOOK_NS) else { return Ok(()) };
    let message = at_once(station.edge(Edge { t_ns: edge.t_ns, seq: edge.seq }));
    message.map_or(Ok(()), |message| send(port, &message))
}

fn send<P: Port>(port: &mut P, message: &Message<'_>) -> Result<(), P::Closed> {
    let mut room = [0; MAX_FRAME];
    // every message fits (docs/formats/bridge.md)
    encode(message, &mut room).map_or(Ok(()), |frame| port.write(frame))
}

/// Runs a future that is ready at once, as the futures of the twin are.
fn at_once<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return output;
        }
    }
}

/// The bus of the twin. The SPI clock of the twin is fixed, so setting the clock changes only the reported clock.
struct TwinBus {
    spi: TwinSpi,
    self_test: SelfTestPin,
}

impl ErrorType for TwinBus {
    type Error = Infallible;
}

impl SpiDevice for TwinBus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        SpiDevice::transaction(&mut self.spi, operations).await
    }
}

impl Bus for TwinBus {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        hz
    }

    fn set_self_test(&mut self, on: bool) -> bool {
        let Ok(()) = self.self_test.set_state(on.into());
        true
    }
}
