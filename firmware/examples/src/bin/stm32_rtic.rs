//! RTIC on an STM32F411, wired as in `docs/wiring.md`. The interrupt of RDY reads samples, and a tick checks that
//! edges still come.

#![no_std]
#![no_main]

use panic_reset as _;

#[rtic::app(device = stm32_metapac, peripherals = false)]
mod app {
    use adis16130::blocking::Adis16130;
    use adis16130::{Config, Edge, Framing, MCLK_HZ, Sampler, SamplerConfig, TempCode};
    use cortex_m::peripheral::syst::SystClkSource;
    use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
    use embassy_stm32::mode::Blocking;
    use embassy_stm32::spi::mode::Master;
    use embassy_stm32::spi::{self, Spi};
    use embassy_time::{Delay, Instant};
    use embedded_hal_bus::spi::ExclusiveDevice;
    use firmware_examples::{BackOff, control, unit};
    use stm32_metapac as pac;

    type Gyro = Adis16130<ExclusiveDevice<Spi<'static, Blocking, Master>, Output<'static>, Delay>, ()>;

    /// The EXTI line of RDY, which is pin PA10.
    const RDY: usize = 10;

    /// Length of a tick in cycles of the internal oscillator of 16 MHz: 10 ms.
    const TICK: u32 = 160_000;

    #[shared]
    struct Shared {
        part: Part,
    }

    #[local]
    struct Local {
        _rdy: Input<'static>,
        wait_ticks: u32,
    }

    /// The driver and the sampler of the part.
    pub struct Part {
        gyro: Gyro,
        sampler: Sampler,
        temp: Option<TempCode>,
        seq: u32,
        back_off: BackOff,
        failed: bool,
    }

    #[init]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        let p = embassy_stm32::init(Default::default());
        let mut config = spi::Config::default();
        config.mode = spi::MODE_3;
        config.frequency = embassy_stm32::time::Hertz(8_000_000);
        let controller = Spi::new_blocking(p.SPI1, p.PA5, p.PA7, p.PA6, config);
        let Ok(device) = ExclusiveDevice::new(controller, Output::new(p.PB6, Level::High, Speed::VeryHigh), Delay);
        // one transfer per command, so that both channels are read before the next edge (F-22, F-33)
        let config = Config::new().with_framing(Framing::Command);
        let rdy = Input::new(p.PA10, Pull::Up);
        // EXTI line 10 is connected to port A by default
        pac::EXTI.ftsr(0).modify(|w| w.set_line(RDY, true));
        pac::EXTI.imr(0).modify(|w| w.set_line(RDY, true));
        cx.core.SYST.set_clock_source(SystClkSource::Core);
        cx.core.SYST.set_reload(TICK - 1);
        cx.core.SYST.enable_counter();
        cx.core.SYST.enable_interrupt();
        let part = Part {
            gyro: Adis16130::new(device, (), config),
            sampler: Sampler::new(SamplerConfig::new(), &config, MCLK_HZ),
            temp: None,
            seq: 0,
            back_off: BackOff::new(),
            failed: true,
        };
        (Shared { part }, Local { _rdy: rdy, wait_ticks: 0 })
    }

    #[task(binds = EXTI15_10, shared = [part], priority = 2)]
    fn edge(mut cx: edge::Context) {
        let t_ns = 1_000 * Instant::now().as_micros();
        pac::EXTI.pr(0).write(|w| w.set_line(RDY, true));
        cx.shared.part.lock(|part| part.sample(t_ns));
    }

    /// Initialises the part at the start, and again if no edges come or a reading has failed.
    #[task(binds = SysTick, shared = [part], local = [wait_ticks], priority = 1)]
    fn tick(mut cx: tick::Context) {
        let wait_ticks = cx.local.wait_ticks;
        *wait_ticks = wait_ticks.saturating_sub(1);
        cx.shared.part.lock(|part| {
            let now_ns = 1_000 * Instant::now().as_micros();
            if *wait_ticks == 0 && (part.failed || part.sampler.silent_since(now_ns).is_some()) {
                part.restart();
                *wait_ticks = part.back_off.pause_ms() / 10;
            }
        });
    }

    impl Part {
        fn sample(&mut self, t_ns: u64) {
            self.seq = self.seq.wrapping_add(1);
            if self.failed {
                return;
            }
            match self.gyro.sample(&mut self.sampler, Edge { t_ns, seq: self.seq }) {
                Ok(Some(sample)) => {
                    self.back_off.done();
                    self.temp = sample.temp.or(self.temp);
                    // a rate out of range is not a reading (F-35)
                    let wrong = sample.status.is_some_and(|status| status.out_of_range());
                    if let (false, Some(temp)) = (wrong, self.temp) {
                        let temp_code = temp.code24();
                        control(unit::correct_code(sample.rate.code24(), temp_code), unit::in_range(temp_code));
                    }
                }
                Ok(None) => {}
                Err(_) => self.failed = true,
            }
        }

        fn restart(&mut self) {
            self.failed = self.gyro.restart().is_err();
            self.sampler.restarted();
            self.temp = None;
        }
    }
}
