//! A bridge at a serial port of the browser. The page transfers the bytes (docs/formats/bridge.md).
//!
//! A single future does all the work, from the first request to the last sample. It is polled whenever bytes arrive
//! or time passes, so that nothing blocks.

mod wire;

use super::{Next, Source, about_part};
use crate::registers;
use crate::session::{About, NoticeText};
use adis16130::asynch::Adis16130;
use adis16130::bridge::{Answer, Command, Continuity, GONE, PROTOCOL, Refusal, RequestError, SILENT, Settings};
use adis16130::{Config, Fault, Framing, MAX_SCLK_HZ, MCLK_HZ, SamplerConfig};
use std::cell::RefCell;
use std::convert::Infallible;
use std::future::Future;
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use std::time::Duration;
use wire::{SharedWire, Transfers, Wire};
use zerorate_record::Row;
use zerorate_view::SessionWarning;

/// A part behind a bridge.
pub struct Bridge {
    about: About,
    shared: SharedWire,
    work: Pin<Box<dyn Future<Output = Result<Infallible, String>>>>,
    failed: Option<String>,
}

/// The SPI clock, Hz: half of the part's maximum (F-21), as in the command-line program.
const SCLK_HZ: u32 = MAX_SCLK_HZ / 2;

/// Time without a sample after which the part counts as failed.
const SILENCE: Duration = Duration::from_secs(1);
/// Additional time for which the port's window may be blocked, by a dialog or by a browser that throttles hidden
/// windows.
const BLOCKED: Duration = Duration::from_secs(30);

impl Bridge {
    /// Opens a bridge, and queues the first request to it. `now_ms` is the time of the page's clock, ms.
    #[must_use]
    pub fn open(now_ms: f64) -> Self {
        let config = Config::new().with_framing(Framing::Command);
        let shared: SharedWire = Rc::new(RefCell::new(Wire { now: of_page(now_ms), ..Wire::default() }));
        let work = Box::pin(measure(shared.clone(), config));
        let about = about_part("bridge: at a serial port", &config, false, false);
        let mut bridge = Self { about, shared, work, failed: None };
        bridge.work();
        bridge
    }

    fn work(&mut self) {
        if self.failed.is_none()
            && let Poll::Ready(Err(why)) = self.work.as_mut().poll(&mut Context::from_waker(Waker::noop()))
        {
            self.failed = Some(why);
        }
    }
}

impl Source for Bridge {
    fn about(&self) -> About {
        let mut about = self.about.clone();
        let shared = self.shared.borrow();
        if let Some(firmware) = &shared.firmware {
            about.name = format!("bridge: {firmware}");
        }
        about.registers.clone_from(&shared.registers);
        about
    }

    fn opened(&mut self) -> bool {
        std::mem::take(&mut self.shared.borrow_mut().is_opened)
    }

    fn next(&mut self) -> Result<Next, String> {
        if let Some(row) = self.shared.borrow_mut().rows.pop_front() {
            return Ok(Next::Row(row));
        }
        self.failed.clone().map_or(Ok(Next::Waiting), Err)
    }

    fn notes(&mut self) -> Vec<NoticeText> {
        let damaged = std::mem::take(&mut self.shared.borrow_mut().client.damaged);
        (damaged > 0).then(|| SessionWarning::Damaged(damaged).into()).into_iter().collect()
    }

    fn received(&mut self, bytes: &[u8], now_ms: f64) {
        let mut wire = self.shared.borrow_mut();
        wire.now = of_page(now_ms);
        wire.received.extend(bytes);
        drop(wire);
        self.work();
    }

    fn to_send(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.shared.borrow_mut().to_send)
    }

    fn unplugged(&mut self, why: &str) {
        self.failed = Some(format!("the bridge {GONE} ({why})"));
    }
}

/// Runs the whole communication with a bridge, until it cannot be read any longer.
async fn measure(shared: SharedWire, config: Config) -> Result<Infallible, String> {
    let told = |error| match error {
        RequestError::Silent => format!("the bridge {SILENT}"),
        other => other.to_string(),
    };
    greet(&shared, &config).await.map_err(told)??;
    let mut part = Adis16130::new(Transfers(shared.clone()), (), config);
    if let Err(error) = part.restart().await {
        return Err(format!("{} ({error})", Fault::UNPLUGGED));
    }
    let values = part.read_all().await.map_err(|error| error.to_string())?;
    shared.borrow_mut().registers = registers::described(&config, &values);
    shared.borrow_mut().is_opened = true;
    let SamplerConfig { every_temp, divider, .. } = SamplerConfig::new();
    let start = Command::Start { every_temp, divider, mclk_hz: MCLK_HZ };
    wire::request(&shared, start, Answer::Started.only()).await.map_err(told)?;
    let mut continuity = Continuity::new(config.width());
    while let Some(reading) = wire::sample(&shared, SILENCE, BLOCKED).await? {
        let row = Row::from(&continuity.sample(&reading));
        shared.borrow_mut().rows.push_back(row);
    }
    wire::request(&shared, Command::Stop, Answer::Stopped.only()).await.map_err(told)?;
    match part.diagnose().await {
        Ok(Some(fault)) => Err(fault.to_string()),
        Ok(None) => Err(Fault::NO_NEW_DATA.to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// Stops the bridge, and configures its SPI clock and the part. The inner error states why this bridge cannot be used.
async fn greet(shared: &SharedWire, config: &Config) -> Result<Result<(), String>, RequestError> {
    wire::request(shared, Command::Stop, Answer::Stopped.only()).await?;
    let hello = wire::request(shared, Command::Hello, |answer| match answer {
        Answer::Hello { protocol, firmware, .. } => Some((protocol, firmware.to_owned())),
        _ => None,
    });
    let (protocol, firmware) = hello.await?;
    if protocol != PROTOCOL {
        return Ok(Err(format!(
            "the bridge is {firmware} and speaks version {protocol} of the protocol, but this page speaks version \
             {PROTOCOL}; update the older one"
        )));
    }
    shared.borrow_mut().firmware = Some(firmware);
    let clock = Command::Clock { sclk_hz: SCLK_HZ };
    wire::request(shared, clock, |answer| matches!(answer, Answer::Clock { .. }).then_some(())).await?;
    let settings = Command::Configure(Settings::from(config));
    match wire::request(shared, settings, Answer::Configured.only()).await {
        Err(RequestError::Refused(Refusal::NoSuchWire)) => {
            return Ok(Err("the bridge cannot detect the falling edge of RDY: update its firmware".to_owned()));
        }
        configured => configured?,
    }
    // the first frame after opening a port is often incomplete
    shared.borrow_mut().client.damaged = 0;
    Ok(Ok(()))
}

fn of_page(now_ms: f64) -> Duration {
    Duration::try_from_secs_f64(now_ms / 1e3).unwrap_or_default()
}
