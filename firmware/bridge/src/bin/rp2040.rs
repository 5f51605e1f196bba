//! The bridge on a Raspberry Pi Pico.
//!
//! | signal | board | part (F-11) |
//! |---|---|---|
//! | SCK  | GP18, pin 24 | 16 SCLK |
//! | MISO | GP16, pin 21 | 12 SDO |
//! | MOSI | GP19, pin 25 | 14 SDI |
//! | CS   | GP17, pin 22 | 8 CS |
//! | RDY  | GP20, pin 26 | 10 RDY |
//! | self-test | GP21, pin 27 | 1 to 7, 9 |
//!
//! The LED is that of the board, on GP25.

#![no_std]
#![no_main]

use embassy_executor::{InterruptExecutor, Spawner};
use embassy_rp::clocks::clk_peri_freq;
use embassy_rp::flash::{self, Flash};
use embassy_rp::gpio::{Input, Level, Output, Pull};
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::peripherals::{DMA_CH0, DMA_CH1, FLASH, SPI0, USB};
use embassy_rp::spi::{self, Phase, Polarity, Spi};
use embassy_rp::usb::{self, Driver};
use embassy_rp::watchdog::Watchdog;
use embassy_rp::{Peri, bind_interrupts, dma, interrupt};
use firmware_bridge::bus::PartBus;
use firmware_bridge::{Link, lamp, port, sampling};
use panic_reset as _;
use static_cell::StaticCell;

const FIRMWARE: &str = concat!("bridge-rp2040 ", env!("CARGO_PKG_VERSION"));

/// Slowest SPI clock that can be set, Hz. The HAL panics below 1.923 kHz.
const SLOWEST_SCLK_HZ: u32 = 2_000;

/// Size of the external flash, bytes. The RP2040 has no serial number, so the unique number of this flash is used.
const FLASH_BYTES: usize = 2 * 1024 * 1024;

bind_interrupts!(struct Irqs {
    DMA_IRQ_0 => dma::InterruptHandler<DMA_CH0>, dma::InterruptHandler<DMA_CH1>;
    USBCTRL_IRQ => usb::InterruptHandler<USB>;
});

type Controller = Spi<'static, SPI0, spi::Async>;

static LINK: Link = Link::new();
static ABOVE_USB: InterruptExecutor = InterruptExecutor::new();

#[embassy_executor::main]
async fn main(main: Spawner) {
    let p = embassy_rp::init(Default::default());
    // before anything else runs: while the serial number is read, no code can run from flash
    let serial = serial(p.FLASH);
    let cs = Output::new(p.PIN_17, Level::High);
    let mut config = spi::Config::default();
    config.polarity = Polarity::IdleHigh;
    config.phase = Phase::CaptureOnSecondTransition;
    let controller = Spi::new(p.SPI0, p.PIN_18, p.PIN_19, p.PIN_16, p.DMA_CH0, p.DMA_CH1, Irqs, config);
    let self_test = Output::new(p.PIN_21, Level::Low);
    let bus = PartBus::new(controller, cs, set_clock, self_test, &LINK);
    let rdy = Input::new(p.PIN_20, Pull::Up);

    // the HAL puts RDY and DMA at the lowest priority, and leaves USB at the highest
    interrupt::IO_IRQ_BANK0.set_priority(Priority::P0);
    interrupt::DMA_IRQ_0.set_priority(Priority::P0);
    interrupt::SWI_IRQ_0.set_priority(Priority::P1);
    interrupt::USBCTRL_IRQ.set_priority(Priority::P3);
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    watchdog.pause_on_debug(true);
    watchdog.start(sampling::WATCHDOG);
    let spawner = ABOVE_USB.start(interrupt::SWI_IRQ_0);
    spawner.spawn(watch(rdy).expect("spawned once"));
    spawner.spawn(serve(bus, watchdog).expect("spawned once"));

    main.spawn(shine(Output::new(p.PIN_25, Level::Low)).expect("spawned once"));
    port::run(Driver::new(p.USB, Irqs), serial, &LINK).await
}

#[embassy_executor::task]
async fn watch(rdy: Input<'static>) {
    sampling::watch(rdy, &LINK).await
}

#[embassy_executor::task]
async fn serve(bus: PartBus<Controller, Output<'static>, Output<'static>>, mut watchdog: Watchdog) {
    sampling::serve(bus, FIRMWARE, &LINK, || watchdog.feed(sampling::WATCHDOG)).await
}

#[embassy_executor::task]
async fn shine(mut led: Output<'static>) {
    lamp::run(|lit| led.set_level(lit.into()), &LINK).await
}

/// Returns the flash's unique number as text. Call it once.
fn serial(flash: Peri<'static, FLASH>) -> Option<&'static str> {
    static ROOM: StaticCell<[u8; 16]> = StaticCell::new();
    let mut id = [0; 8];
    Flash::<_, flash::Blocking, FLASH_BYTES>::new_blocking(flash).blocking_unique_id(&mut id).ok()?;
    Some(port::hex(id, ROOM.init([0; 16])))
}

/// Sets the SPI clock. Returns the resulting clock, Hz, computed as in the HAL, which does not report it.
fn set_clock(controller: &mut Controller, hz: u32) -> u32 {
    let hz = hz.max(SLOWEST_SCLK_HZ);
    controller.set_frequency(hz);
    // `calc_prescs` of embassy-rp 0.10.0, `src/spi.rs`
    let kernel_hz = clk_peri_freq();
    let ratio = kernel_hz.div_ceil(2 * hz);
    let prescaler = ratio.div_ceil(256);
    kernel_hz / (2 * prescaler * ratio.div_ceil(prescaler))
}

#[interrupt]
fn SWI_IRQ_0() {
    #[expect(unsafe_code, reason = "polls the executor")]
    // SAFETY: called from this handler alone, which `start` enables
    unsafe {
        ABOVE_USB.on_interrupt();
    }
}
