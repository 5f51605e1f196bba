//! Carries out the steps of a run on a driver, a sampler and a twin.

use adis16130::registers::{ChannelSetup, Iop, Mode, RateConv, RateData, TempCs};
use adis16130::{Config, ConversionTime, Edge, MCLK_HZ, Sampler, SamplerConfig, SelfTestPlan, WaitBound};
use adis16130_twin::{Fault, Spec, Twin};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use crate::bus::{Ahead, Trouble};
use crate::gyro::{Form, Gyro, call, on};
use crate::judge::{Judge, Verdict};
use crate::step::{Plan, ReadCall, Start, Step, WritableRegister};

/// The longest wait for an edge: longer than two of the slowest conversions.
const EDGE_WITHIN_NS: u64 = 20_000_000;

pub struct Bench {
    form: Form,
    twin: Twin,
    ahead: Ahead,
    gyro: Gyro,
    sampling: SamplerConfig,
    sampler: Sampler,
    /// Offsets of the host's clock (ns) and of its count of edges from the twin's.
    clock: (u64, u32),
    newest: Option<Edge>,
    judge: Judge,
}

impl Bench {
    pub fn new(plan: &Plan) -> Self {
        let mclk_hz = f64::from(MCLK_HZ) * (1.0 + f64::from(plan.clock_ppm) * 1e-6);
        let twin = Twin::new(Spec {
            rotation_dps: plan.rotation_dps,
            mclk_hz,
            sclk_hz: plan.sclk_hz,
            bit_error_rate: plan.bit_error_rate,
            fault_at_s: Some(1e6), // after the end of the test: only the steps set faults
            rdy: plan.rdy,
            ..Spec::from_seed(plan.seed)
        });
        let ahead = Ahead::default();
        Self {
            form: plan.form,
            gyro: Gyro::new(plan.form, &twin, &ahead, plan.config),
            judge: Judge::new(&twin, mclk_hz, &plan.config, plan.sampling),
            twin,
            ahead,
            sampling: plan.sampling,
            sampler: Sampler::new(plan.sampling, &plan.config, MCLK_HZ),
            clock: (plan.t_ns, plan.seq),
            newest: None,
        }
    }

    pub fn carry_out(&mut self, step: &Step) -> Verdict {
        match *step {
            Step::Sample { late_ns } => return self.next_sample(late_ns),
            Step::Samples(count) => return (0..count).try_for_each(|_| self.next_sample(0)),
            Step::SameEdge => return self.newest.map_or(Ok(()), |edge| self.sample(edge)),
            Step::Glitch => return self.glitch(),
            Step::Read(read) => return self.read(read),
            Step::Start(start) => return self.start(start),
            Step::Recover => return self.recover(),
            Step::Configure(config, sampling) => return self.configure(config, sampling),
            Step::Pass { ns } => self.twin.advance_ns(ns),
            Step::Wait { us } => self.wait(us),
            Step::SelfTest => return self.self_test(),
            Step::Write(register, value) => return self.write(register, value),
            Step::Raw(ref bytes) => self.send_raw(bytes),
            Step::Release => self.release(),
            Step::Fault(fault) => self.set_fault(fault),
            Step::Power(on) => self.power(on),
            Step::Replug => self.twin.replug(),
            Step::Sync(high) => self.sync(high),
            Step::Ahead(bytes, trouble) => self.ahead.set(bytes, trouble),
        }
        Ok(())
    }

    // ---- samples ----

    fn next_edge_within(&mut self, timeout_ns: u64) -> Option<Edge> {
        let edge = self.twin.next_falling_edge(timeout_ns)?;
        let (t_ns, seq) = self.clock;
        self.newest = Some(Edge { t_ns: edge.t_ns.wrapping_add(t_ns), seq: edge.seq.wrapping_add(seq) });
        self.newest
    }

    fn next_sample(&mut self, late_ns: u32) -> Verdict {
        let Some(edge) = self.next_edge_within(EDGE_WITHIN_NS) else {
            self.sampler.silent_since(self.twin.now_ns().wrapping_add(self.clock.0));
            return Ok(());
        };
        self.twin.advance_ns(late_ns.into());
        self.sample(edge)
    }

    fn sample(&mut self, edge: Edge) -> Verdict {
        let learned_ns = self.sampler.rate_period_ns();
        self.judge.begin();
        let result = call!(self.gyro, sample(&mut self.sampler, edge));
        self.judge.end(self.ahead.take_struck())?;
        let edge_ns = edge.t_ns.wrapping_sub(self.clock.0);
        self.judge.sample(result.and_then(Result::ok).flatten(), edge_ns, learned_ns)
    }

    /// Passes an edge that the part did not make. The host counts this edge like any other.
    fn glitch(&mut self) -> Verdict {
        let t_ns = self.twin.now_ns().wrapping_add(self.clock.0);
        let Some(newest) = self.newest else { return Ok(()) };
        let glitch = Edge { t_ns, seq: newest.seq.wrapping_add(1) };
        self.clock.1 = self.clock.1.wrapping_add(1);
        self.newest = Some(glitch);
        self.judge.count_nothing();
        self.sample(glitch)
    }

    // ---- other calls ----

    fn read(&mut self, read: ReadCall) -> Verdict {
        self.judge.read_beside();
        self.judge.begin();
        let (mut rate, mut temp, mut in_range) = (None, None, None);
        let gyro = &mut self.gyro;
        match read {
            ReadCall::Rate => rate = call!(*gyro, read_rate()).and_then(Result::ok),
            ReadCall::Temp => temp = call!(*gyro, read_temp()).and_then(Result::ok),
            ReadCall::Both => (rate, temp) = call!(*gyro, read_both()).and_then(Result::ok).unzip(),
            ReadCall::RateInRange => in_range = call!(*gyro, read_rate_in_range()).and_then(Result::ok),
            ReadCall::InRange => (in_range, temp) = call!(*gyro, read_in_range()).and_then(Result::ok).unzip(),
            ReadCall::RateStatus => _ = call!(*gyro, rate_status()),
            ReadCall::TempStatus => _ = call!(*gyro, temp_status()),
            ReadCall::AdcStatus => _ = call!(*gyro, adc_status()),
            ReadCall::Revision => _ = call!(*gyro, revision()),
            ReadCall::All => _ = call!(*gyro, read_all()),
            ReadCall::Raw => _ = call!(*gyro, read_register::<RateData>()),
            ReadCall::Verify => _ = call!(*gyro, verify()),
            ReadCall::Diagnose => _ = call!(*gyro, diagnose()),
        }
        self.judge.end(self.ahead.take_struck())?;
        self.judge.readings(rate, in_range, temp)
    }

    fn start(&mut self, start: Start) -> Verdict {
        self.judge.count_nothing();
        if matches!(start, Start::Restart | Start::RestartInSecret | Start::Reset) {
            self.judge.begin_reset();
        } else {
            self.judge.begin();
        }
        let gyro = &mut self.gyro;
        let done = match start {
            Start::Restart | Start::RestartInSecret => call!(*gyro, restart()).map(|done| done.is_ok()),
            Start::Reset => call!(*gyro, reset()).map(|done| done.is_ok()),
            Start::Init => call!(*gyro, init()).map(|done| done.is_ok()),
            Start::InitVerified => call!(*gyro, init_verified()).map(|done| done.is_ok()),
            Start::InitChecksummed => call!(*gyro, init_checksummed()).map(|done| done.is_ok()),
        };
        self.judge.end(self.ahead.take_struck())?;
        if done == Some(true) && matches!(start, Start::Restart) {
            self.tell_sampler();
        }
        Ok(())
    }

    /// Discards old edges, and reports a restart to the sampler. Replaces a sampler that has got false edges.
    fn tell_sampler(&mut self) {
        self.next_edge_within(0);
        self.newest = None;
        if self.judge.restarted() {
            self.sampler.restarted();
        } else {
            self.sampler = Sampler::new(self.sampling, on!(&self.gyro, gyro => gyro.config()), MCLK_HZ);
        }
    }

    fn recover(&mut self) -> Verdict {
        self.ahead.clear();
        self.set_fault(Fault::None);
        self.power(true);
        self.sync(true);
        self.start(Start::Restart)?;
        let verified = call!(self.gyro, verify()).map(|verified| verified.is_ok());
        if verified == Some(true) { Ok(()) } else { Err("a part that was mended does not start".to_owned()) }
    }

    fn configure(&mut self, config: Config, sampling: SamplerConfig) -> Verdict {
        on!(&mut self.gyro, gyro => gyro.set_config(config));
        self.sampling = sampling;
        self.sampler = Sampler::new(sampling, &config, MCLK_HZ);
        self.judge.configure(&config, sampling);
        self.start(Start::Restart)
    }

    fn wait(&mut self, us: u16) {
        _ = call!(self.gyro, wait_ready(&mut self.twin.delay(), WaitBound::from_us(us.into())));
        self.judge.struck(self.ahead.take_struck());
    }

    fn self_test(&mut self) -> Verdict {
        self.judge.read_beside();
        let plan = SelfTestPlan::new(16).with_settle_us(500).with_bound(WaitBound::from_us(2_000));
        _ = call!(self.gyro, self_test(&mut self.twin.self_test_pin(), &mut self.twin.delay(), plan));
        self.judge.struck(self.ahead.take_struck());
        Ok(())
    }

    fn write(&mut self, register: WritableRegister, value: u8) -> Verdict {
        self.judge.bewilder();
        self.judge.begin();
        let gyro = &mut self.gyro;
        match register {
            // the driver does not read with DUMP or CONTRD set
            WritableRegister::Mode => _ = call!(*gyro, write_register::<Mode>(Mode::new(value & !0x0C))),
            WritableRegister::Iop => _ = call!(*gyro, write_register::<Iop>(Iop::new(value))),
            WritableRegister::RateConv => _ = call!(*gyro, write_register::<RateConv>(ConversionTime::new(value))),
            WritableRegister::TempCs => _ = call!(*gyro, write_register::<TempCs>(ChannelSetup::new(value))),
        }
        self.judge.end(self.ahead.take_struck())
    }

    fn send_raw(&mut self, bytes: &[u8]) {
        self.judge.spoil();
        let mut bytes = bytes.to_vec();
        _ = on!(&mut self.gyro, gyro => SpiDevice::transfer_in_place(gyro.bus_mut(), &mut bytes));
        let struck = self.ahead.take_struck().filter(|trouble| !matches!(trouble, Trouble::Cut));
        self.judge.struck(struck);
    }

    fn release(&mut self) {
        let config = *on!(&self.gyro, gyro => gyro.config());
        self.gyro = Gyro::new(self.form, &self.twin, &self.ahead, config);
        self.judge.released();
    }

    // ---- the part and its wires ----

    fn set_fault(&mut self, fault: Fault) {
        self.twin.set_fault(fault);
        self.judge.fault(fault);
    }

    fn power(&mut self, on: bool) {
        if on {
            self.twin.power_on()
        } else {
            self.twin.power_off()
        }
        self.judge.count_nothing();
    }

    fn sync(&mut self, high: bool) {
        let Ok(()) = self.twin.sync_pin().set_state(high.into());
        self.judge.count_nothing();
    }
}
