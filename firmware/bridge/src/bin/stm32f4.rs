//! The bridge on a WeAct "Black Pill" with STM32F411CE.
//!
//! | signal | board | part (F-11) |
//! |---|---|---|
//! | SCK  | PA5 | 16 SCLK |
//! | MISO | PA6 | 12 SDO |
//! | MOSI | PA7 | 14 SDI |
//! | CS   | PA4 | 8 CS |
//! | RDY  | PB0 | 10 RDY |
//! | self-test | PB1 | 1 to 7, 9 |
//!
//! The LED is that of the board, on PC13.

#![no_std]
#![no_main]

use embassy_executor::{InterruptExecutor, Spawner};
use embassy_stm32::exti::{self, ExtiInput};
use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::mode::Async;
use embassy_stm32::rcc::{
    self, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllSource, Sysclk, mux::Clk48sel,
};
use embassy_stm32::spi::mode::Master;
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::uid::uid_hex;
use embassy_stm32::usb::{self, Driver};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, dma, interrupt, peripherals};
use firmware_bridge::bus::PartBus;
use firmware_bridge::{Link, lamp, port, sampling};
use panic_reset as _;
use static_cell::ConstStaticCell;

const FIRMWARE: &str = concat!("bridge-stm32f4 ", env!("CARGO_PKG_VERSION"));

bind_interrupts!(struct Irqs {
    EXTI0 => exti::InterruptHandler<interrupt::typelevel::EXTI0>;
    DMA2_STREAM2 => dma::InterruptHandler<peripherals::DMA2_CH2>;
    DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
    OTG_FS => usb::InterruptHandler<peripherals::USB_OTG_FS>;
});

type Controller = Spi<'static, Async, Master>;

static LINK: Link = Link::new();
static ABOVE_USB: InterruptExecutor = InterruptExecutor::new();
static PACKETS: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);

#[embassy_executor::main]
async fn main(main: Spawner) {
    let p = embassy_stm32::init(clocks());
    let cs = Output::new(p.PA4, Level::High, Speed::VeryHigh);
    let mut config = spi::Config::default();
    config.mode = spi::MODE_3;
    let controller = Spi::new(p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH2, Irqs, config);
    let self_test = Output::new(p.PB1, Level::Low, Speed::Low);
    let bus = PartBus::new(controller, cs, set_clock, self_test, &LINK);
    let rdy = ExtiInput::new(p.PB0, p.EXTI0, Pull::Up, Irqs);

    // the HAL leaves RDY, DMA and USB at the highest priority
    interrupt::SPI5.set_priority(Priority::P6);
    interrupt::OTG_FS.set_priority(Priority::P7);
    let mut watchdog = IndependentWatchdog::new(p.IWDG, sampling::WATCHDOG.as_micros() as u32);
    watchdog.unleash();
    let spawner = ABOVE_USB.start(interrupt::SPI5);
    spawner.spawn(watch(rdy).expect("spawned once"));
    spawner.spawn(serve(bus, watchdog).expect("spawned once"));

    let mut config = usb::Config::default();
    // the board does not connect VBUS to PA9
    config.vbus_detection = false;
    let driver = Driver::new_fs(p.USB_OTG_FS, Irqs, p.PA12, p.PA11, PACKETS.take(), config);
    main.spawn(shine(Output::new(p.PC13, Level::High, Speed::Low)).expect("spawned once"));
    port::run(driver, Some(uid_hex()), &LINK).await
}

#[embassy_executor::task]
async fn watch(rdy: ExtiInput<'static, Async>) {
    sampling::watch(rdy, &LINK).await
}

#[embassy_executor::task]
async fn serve(
    bus: PartBus<Controller, Output<'static>, Output<'static>>,
    mut watchdog: IndependentWatchdog<'static, peripherals::IWDG>,
) {
    sampling::serve(bus, FIRMWARE, &LINK, || watchdog.pet()).await
}

/// Drives the LED, which is lit while the pin is low, since it is connected to the supply.
#[embassy_executor::task]
async fn shine(mut led: Output<'static>) {
    lamp::run(|lit| led.set_level((!lit).into()), &LINK).await
}

/// Sets the core clock to 72 MHz from the crystal of 25 MHz, and the USB clock to 48 MHz. SPI1 can then have 9 MHz, or
/// 9 MHz halved up to five times. With faster core clocks that allow for USB, its fastest clock below 10 MHz is 6 or
/// 5.25 MHz.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(25_000_000), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV25,
        mul: PllMul::MUL288,
        divp: Some(PllPDiv::DIV4),
        divq: Some(PllQDiv::DIV6),
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.apb1_pre = APBPrescaler::DIV2;
    config.rcc.mux.clk48sel = Clk48sel::PLL1_Q;
    config
}

/// Sets the fastest SPI clock that is not above `hz`, or else the slowest one. Returns that clock, Hz.
///
/// The controller divides its clock by a power of two. The HAL alone might choose a faster clock than requested.
fn set_clock(controller: &mut Controller, hz: u32) -> u32 {
    let kernel_hz = rcc::frequency::<peripherals::SPI1>().0;
    let divided = (1..=8).map(|power| kernel_hz >> power).find(|clock| *clock <= hz);
    let mut config = controller.get_current_config();
    config.frequency = Hertz(divided.unwrap_or(kernel_hz >> 8));
    controller.set_config(&config).expect("the HAL refuses nothing");
    controller.get_current_config().frequency.0
}

#[interrupt]
fn SPI5() {
    #[expect(unsafe_code, reason = "polls the executor")]
    // SAFETY: called from this handler alone, which `start` enables
    unsafe {
        ABOVE_USB.on_interrupt();
    }
}
