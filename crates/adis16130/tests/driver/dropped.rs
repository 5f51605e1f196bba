//! Drops async calls on the twin at each wait and within transfers. The next reading must be correct or an error.

use std::cell::Cell;
use std::convert::Infallible;
use std::future::{Future, pending};
use std::rc::Rc;
use std::task::{Context, Waker};

use adis16130::asynch::Adis16130;
use adis16130::registers::Mode;
use adis16130::{
    BusError, Config, Edge, Framing, MCLK_HZ, RateCode, ReadError, Sampler, SamplerConfig, TempCode, Width,
};
use adis16130_twin::{Spec, Twin, TwinSpi};
use embedded_hal::spi::Operation;

use crate::part::now;

/// Number of steps until the bus stalls. The beginning of a transaction, each byte, and the end are one step each.
#[derive(Clone)]
struct Steps(Rc<Cell<usize>>);

impl Steps {
    async fn take(&self) {
        match self.0.get().checked_sub(1) {
            Some(left) => self.0.set(left),
            None => pending().await,
        }
    }
}

/// The twin's bus with transfers that can be dropped in the middle, as a DMA transfer can. The bytes before that point
/// have then been sent.
struct Bus {
    spi: TwinSpi,
    steps: Steps,
}

impl embedded_hal_async::spi::ErrorType for Bus {
    type Error = Infallible;
}

impl embedded_hal_async::spi::SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.steps.take().await;
        let [operation] = operations else { panic!("one operation per transaction: {operations:?}") };
        let (mut copy, into) = match operation {
            Operation::Write(bytes) => (bytes.to_vec(), None),
            Operation::TransferInPlace(bytes) => (bytes.to_vec(), Some(bytes)),
            other => panic!("{other:?}"),
        };
        // The twin takes whole frames, so it is sent only the bytes for which steps are left.
        let sent = copy.len().min(self.steps.0.get());
        embedded_hal::spi::SpiDevice::transfer_in_place(&mut self.spi, &mut copy[..sent])?;
        for _ in 0..copy.len() {
            self.steps.take().await;
        }
        if let Some(bytes) = into {
            bytes.copy_from_slice(&copy);
        }
        self.steps.take().await;
        Ok(())
    }
}

struct Bench {
    twin: Twin,
    gyro: Adis16130<Bus, ()>,
    sampler: Sampler,
    steps: Steps,
}

impl Bench {
    fn new(config: Config) -> Self {
        // With −3 °/s, a reading of shifted bytes is far from the truth.
        let twin = Twin::new(Spec { bias_dps: -3.0, ..Spec::from_seed(5) });
        let steps = Steps(Rc::new(Cell::new(usize::MAX)));
        let bus = Bus { spi: twin.spi(), steps: steps.clone() };
        let sampler = Sampler::new(SamplerConfig::new(), &config, MCLK_HZ);
        let mut bench = Self { twin, gyro: Adis16130::new(bus, (), config), sampler, steps };
        bench.restart();
        bench
    }

    /// Restarts the part, and waits for two edges. The first edge may be an old one, so both channels are known to
    /// have converted only after the second edge.
    fn restart(&mut self) {
        now(self.gyro.restart()).unwrap();
        self.sampler.restarted();
        self.wait();
        self.wait();
    }

    /// Waits for the next edge. If the part does not convert, returns an edge that the part did not make.
    fn wait(&mut self) -> Edge {
        match self.twin.next_falling_edge(1_000_000) {
            Some(edge) => Edge { t_ns: edge.t_ns, seq: edge.seq },
            None => Edge { t_ns: self.twin.now_ns(), seq: 77 },
        }
    }

    /// Begins a call that gets this many steps, and drops its future. Returns whether the call had already ended.
    fn drop_after(&mut self, steps: usize, call: Call) -> bool {
        let edge = self.wait();
        self.steps.0.set(steps);
        let ended = {
            let mut future = call(&mut self.gyro, &mut self.sampler, edge);
            future.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_ready()
        };
        self.steps.0.set(usize::MAX);
        ended
    }

    /// Asserts that the rate is right to 1.5 °/s, six times the noise of a single reading (F-02, F-03), and the
    /// temperature to 1 °C.
    fn assert_true(&self, rate: RateCode, temp: Option<TempCode>, what: &str) {
        let truth = self.twin.truth();
        let error_dps = f64::from(rate.to_dps()) + truth.pbc_dps(truth.sensor_c);
        assert!(error_dps.abs() < 1.5, "{what}: {} °/s is wrong by {error_dps}", rate.to_dps());
        if let Some(temp) = temp {
            let error_c = f64::from(temp.to_celsius()) - truth.sensor_c;
            assert!(error_c.abs() < 1.0, "{what}: {} °C is wrong by {error_c}", temp.to_celsius());
        }
    }

    /// Asserts that each reading before a recovery is correct or an error, and that a reading follows a recovery.
    fn assert_honest(&mut self, what: &str) {
        for _ in 0..3 {
            let edge = self.wait();
            match now(self.gyro.read_both()) {
                Ok((rate, temp)) => self.assert_true(rate, Some(temp), what),
                Err(error) => assert!(matches!(error, ReadError::Bus(_) | ReadError::NoReading(_)), "{what}: {error}"),
            }
            if let Ok(Some(sample)) = now(self.gyro.sample(&mut self.sampler, edge)) {
                self.assert_true(sample.rate, sample.temp, what);
            }
        }
        self.restart();
        let (rate, temp) = now(self.gyro.read_both()).unwrap();
        self.assert_true(rate, Some(temp), what);
        let edge = self.wait();
        let sample = now(self.gyro.sample(&mut self.sampler, edge)).unwrap().unwrap();
        self.assert_true(sample.rate, sample.temp, what);
    }
}

type Call =
    for<'a> fn(&'a mut Adis16130<Bus, ()>, &'a mut Sampler, Edge) -> std::pin::Pin<Box<dyn Future<Output = ()> + 'a>>;

const CALLS: [(&str, Call); 20] = [
    ("reset", |gyro, _, _| Box::pin(async { _ = gyro.reset().await })),
    ("init", |gyro, _, _| Box::pin(async { _ = gyro.init().await })),
    ("init_verified", |gyro, _, _| Box::pin(async { _ = gyro.init_verified().await })),
    ("init_checksummed", |gyro, _, _| Box::pin(async { _ = gyro.init_checksummed().await })),
    ("restart", |gyro, _, _| Box::pin(async { _ = gyro.restart().await })),
    ("verify", |gyro, _, _| Box::pin(async { _ = gyro.verify().await })),
    ("diagnose", |gyro, _, _| Box::pin(async { _ = gyro.diagnose().await })),
    ("read_register", |gyro, _, _| Box::pin(async { _ = gyro.read_register::<Mode>().await })),
    ("read_all", |gyro, _, _| Box::pin(async { _ = gyro.read_all().await })),
    ("read_rate", |gyro, _, _| Box::pin(async { _ = gyro.read_rate().await })),
    ("read_temp", |gyro, _, _| Box::pin(async { _ = gyro.read_temp().await })),
    ("read_both", |gyro, _, _| Box::pin(async { _ = gyro.read_both().await })),
    ("read_rate_in_range", |gyro, _, _| Box::pin(async { _ = gyro.read_rate_in_range().await })),
    ("read_in_range", |gyro, _, _| Box::pin(async { _ = gyro.read_in_range().await })),
    ("rate_status", |gyro, _, _| Box::pin(async { _ = gyro.rate_status().await })),
    ("temp_status", |gyro, _, _| Box::pin(async { _ = gyro.temp_status().await })),
    ("adc_status", |gyro, _, _| Box::pin(async { _ = gyro.adc_status().await })),
    ("revision", |gyro, _, _| Box::pin(async { _ = gyro.revision().await })),
    ("write_register", |gyro, _, _| {
        let mode = gyro.config().mode();
        Box::pin(async move { _ = gyro.write_register::<Mode>(mode).await })
    }),
    ("sample", |gyro, sampler, edge| Box::pin(async move { _ = gyro.sample(sampler, edge).await })),
];

fn configs() -> [Config; 3] {
    let per_byte = Config::new();
    assert_eq!(per_byte.framing(), Framing::PerByte);
    [per_byte, per_byte.with_framing(Framing::Command), per_byte.with_width(Width::Bits16)]
}

#[test]
fn a_dropped_call_never_shifts_what_is_read_next() {
    for config in configs() {
        for (name, call) in CALLS {
            for steps in 0.. {
                let mut bench = Bench::new(config);
                let ended = bench.drop_after(steps, call);
                bench.assert_honest(&format!("{name} after {steps} steps, {config:?}"));
                if ended {
                    assert!(steps > 2, "{name}");
                    break;
                }
            }
        }
    }
}

#[test]
fn an_interrupted_bus_stays_silent_until_the_reset() {
    for config in configs() {
        let mut bench = Bench::new(config);
        now(bench.gyro.read_both()).unwrap();
        assert!(!bench.drop_after(2, |gyro, _, _| Box::pin(async { _ = gyro.read_both().await })));
        let interrupted = BusError::Interrupted { register: adis16130::registers::Address::RateData };
        let before_ns = bench.twin.now_ns();
        assert_eq!(now(bench.gyro.read_both()), Err(ReadError::Bus(interrupted)));
        assert_eq!(now(bench.gyro.diagnose()), Err(interrupted));
        assert_eq!(now(bench.gyro.write_register::<Mode>(config.mode())), Err(interrupted));
        now(bench.gyro.init()).unwrap_err();
        assert_eq!(bench.twin.now_ns(), before_ns, "the bus takes time");
        let text = interrupted.to_string();
        assert!(text.contains("RATEDATA (08h)") && text.contains("reset and initialise"), "{text}");
        now(bench.gyro.reset()).unwrap();
        now(bench.gyro.init_verified()).unwrap();
        bench.assert_honest("reset and init_verified");
    }
}
