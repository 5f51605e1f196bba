//! Embassy on an RP2040, with DMA. One task numbers the edges of RDY. The other task reads the part, and restarts it
//! if no edge comes or a reading fails. The wiring is that of the bridge on a Pico (`firmware/bridge/README.md`).

#![no_std]
#![no_main]

use adis16130::asynch::Adis16130;
use adis16130::{Config, Edge, Framing, MCLK_HZ, Sampler, SamplerConfig};
use embassy_executor::Spawner;
use embassy_rp::gpio::{Input, Level, Output, Pull};
use embassy_rp::peripherals::{DMA_CH0, DMA_CH1, SPI0};
use embassy_rp::spi::{self, Phase, Polarity, Spi};
use embassy_rp::{bind_interrupts, dma};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Delay, Duration, Instant, Timer, with_timeout};
use embedded_hal_bus::spi::ExclusiveDevice;
use firmware_examples::{BackOff, control, unit};
use panic_reset as _;

bind_interrupts!(struct Irqs {
    DMA_IRQ_0 => dma::InterruptHandler<DMA_CH0>, dma::InterruptHandler<DMA_CH1>;
});

type Gyro = Adis16130<ExclusiveDevice<Spi<'static, SPI0, spi::Async>, Output<'static>, Delay>, ()>;

/// The last edge of RDY that was not handled yet.
static EDGE: Signal<CriticalSectionRawMutex, Edge> = Signal::new();

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_rp::init(Default::default());
    let mut config = spi::Config::default();
    config.polarity = Polarity::IdleHigh;
    config.phase = Phase::CaptureOnSecondTransition;
    config.frequency = 8_000_000;
    let controller = Spi::new(p.SPI0, p.PIN_18, p.PIN_19, p.PIN_16, p.DMA_CH0, p.DMA_CH1, Irqs, config);
    let Ok(device) = ExclusiveDevice::new(controller, Output::new(p.PIN_17, Level::High), Delay);
    // one transfer per command, so that both channels are read before the next edge (F-22, F-33)
    let config = Config::new().with_framing(Framing::Command);
    let mut gyro = Adis16130::new(device, (), config);
    let mut sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
    let mut back_off = BackOff::new();
    spawner.spawn(watch(Input::new(p.PIN_20, Pull::Up)).expect("spawned once"));
    loop {
        // restarts the part at the start, after a brown-out, and while a wire is broken
        if gyro.restart().await.is_ok() {
            sampler.restarted();
            until_it_fails(&mut gyro, &mut sampler, &mut back_off).await;
        }
        Timer::after_millis(back_off.pause_ms().into()).await;
    }
}

/// Numbers every falling edge of RDY and notes the time of the edge, also while the part is being read.
#[embassy_executor::task]
async fn watch(mut rdy: Input<'static>) {
    let mut seq = 0_u32;
    loop {
        rdy.wait_for_falling_edge().await;
        let t_ns = 1_000 * Instant::now().as_micros();
        seq = seq.wrapping_add(1);
        EDGE.signal(Edge { t_ns, seq });
    }
}

/// Reads a sample at each edge. Returns if no edge comes for the time of `silence_ns`, or if a reading fails.
async fn until_it_fails(gyro: &mut Gyro, sampler: &mut Sampler, back_off: &mut BackOff) {
    let deadline = Duration::from_micros(sampler.silence_ns().div_ceil(1_000));
    let mut temp = None;
    while let Ok(edge) = with_timeout(deadline, EDGE.wait()).await {
        // this transfer is never cancelled: there is no select and no timeout around it
        match gyro.sample(sampler, edge).await {
            Ok(Some(sample)) => {
                back_off.done();
                temp = sample.temp.or(temp);
                // a rate out of range is not a reading (F-35)
                let wrong = sample.status.is_some_and(|status| status.out_of_range());
                if let (false, Some(temp)) = (wrong, temp) {
                    let temp_code = temp.code24();
                    control(unit::correct_code(sample.rate.code24(), temp_code), unit::in_range(temp_code));
                }
            }
            Ok(None) => {}
            Err(_) => return,
        }
    }
}
