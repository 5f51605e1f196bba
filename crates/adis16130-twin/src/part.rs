//! The whole part on simulated time: the order of the events, and the signals on the wires.

use crate::adc::NEVER;
use crate::chip::{Chip, Effect};
use crate::fault::{Fault, WireFaults};
use crate::gyro::Gyro;
use crate::registers::Channel;
use crate::spec::{Motion, RdyOutput, Spec};
use crate::truth::Truth;
use core::fmt;

const PS_PER_S: f64 = 1e12;

pub(crate) struct Part {
    pub(crate) spec: Spec,
    pub(crate) now_ps: u64,
    /// Time of the next update or fault, in ps, or [`NEVER`].
    pub(crate) next_event_ps: u64,
    fault_at_ps: u64,
    byte_ps: u64,
    gap_ps: u64,
    pub(crate) chip: Chip,
    gyro: Gyro,
    faults: WireFaults,
    switched_on: bool,
    supplied: bool,
    /// Whether the part has its supply, and no fault changes bytes or hides edges.
    plain: bool,
    /// Whether a fault keeps RDY from announcing data.
    rdy_masked: bool,
    edge_seq: u32,
    edge_ps: u64,
    reported_seq: u32,
    /// Number of reported edges at which a scaling time began.
    scaling_seq: u32,
}

impl Part {
    pub(crate) fn new(spec: Spec) -> Self {
        let fault_at_s = spec.fault_at_s.unwrap_or(0.0);
        let faulty = pending_fault(&spec) != Fault::None;
        let fault_at_ps = if faulty { (fault_at_s * PS_PER_S) as u64 } else { NEVER };
        Self {
            now_ps: 0,
            next_event_ps: fault_at_ps,
            fault_at_ps,
            byte_ps: (8.0 * PS_PER_S / spec.sclk_hz) as u64,
            gap_ps: u64::from(spec.cs_gap_ns) * 1000,
            chip: Chip::new(spec.mclk_hz),
            gyro: Gyro::new(&spec),
            faults: WireFaults::new(spec.seed, spec.bit_error_rate),
            switched_on: true,
            supplied: true,
            plain: true,
            rdy_masked: false,
            edge_seq: 0,
            edge_ps: 0,
            reported_seq: 0,
            scaling_seq: 0,
            spec,
        }
    }

    // ---- time ----

    /// Carries out all events up to and including `t_ps`, and sets the time to it.
    #[inline]
    pub(crate) fn run_to(&mut self, t_ps: u64) {
        while self.next_event_ps <= t_ps {
            self.event();
        }
        self.now_ps = t_ps;
    }

    #[inline]
    pub(crate) fn advance_ps(&mut self, ps: u64) {
        self.run_to(self.now_ps.saturating_add(ps).min(NEVER - 1));
    }

    fn event(&mut self) {
        let t_ps = self.next_event_ps;
        if self.fault_at_ps <= t_ps {
            self.now_ps = t_ps;
            self.fault_at_ps = NEVER;
            return self.set_fault(pending_fault(&self.spec));
        }
        let code = match self.chip.adc.converting {
            Channel::Rate => self.gyro.rate_code(t_ps),
            Channel::Temp => self.gyro.temp_code(t_ps),
        };
        let update = self.chip.adc.update(code);
        if update.rdy_falls {
            self.rdy_masked = !self.plain && !self.faults.edge_passes();
            if !self.rdy_masked {
                self.edge(t_ps);
            }
        }
        if update.single_done {
            self.chip.finish_single(t_ps);
        }
        self.next_event_ps = self.fault_at_ps.min(self.chip.adc.next_update_ps);
    }

    #[inline]
    fn edge(&mut self, t_ps: u64) {
        self.edge_seq = self.edge_seq.wrapping_add(1);
        self.edge_ps = t_ps;
    }

    /// Returns time and number of the latest edge that was not reported yet, or of the next one within `timeout_ps`.
    #[inline]
    pub(crate) fn next_falling_edge(&mut self, timeout_ps: u64) -> Option<(u64, u32)> {
        if self.edge_seq == self.reported_seq {
            let deadline_ps = self.now_ps.saturating_add(timeout_ps).min(NEVER - 1);
            while self.edge_seq == self.reported_seq {
                let t_ps = self.next_event_ps;
                if t_ps > deadline_ps {
                    self.now_ps = deadline_ps;
                    return None;
                }
                self.event();
                self.now_ps = t_ps;
            }
        }
        self.reported_seq = self.edge_seq;
        Some((self.edge_ps, self.edge_seq))
    }

    /// Returns time and number of the next rising or falling edge within `timeout_ps`. An edge that announces new data
    /// may also be a past one that was not reported yet.
    pub(crate) fn next_edge(&mut self, rising: bool, timeout_ps: u64) -> Option<(u64, u32)> {
        if rising == (self.spec.rdy != RdyOutput::Level) {
            self.next_falling_edge(timeout_ps)
        } else {
            self.next_scaling(timeout_ps)
        }
    }

    /// Returns the next edge at which the scaling time begins. This edge does not announce new data.
    fn next_scaling(&mut self, timeout_ps: u64) -> Option<(u64, u32)> {
        let deadline_ps = self.now_ps.saturating_add(timeout_ps).min(NEVER - 1);
        while self.next_event_ps <= deadline_ps || self.chip.adc.scaling_from_ps() <= deadline_ps {
            let from_ps = self.chip.adc.scaling_from_ps();
            let before = self.next_event_ps > from_ps && from_ps > self.now_ps;
            self.run_to(if before { from_ps } else { self.next_event_ps.min(deadline_ps) });
            let shows = self.spec.rdy == RdyOutput::Pulse || self.chip.adc.rdy_due();
            if before && shows && self.supplied && !self.rdy_masked {
                self.scaling_seq = self.scaling_seq.wrapping_add(1);
                return Some((from_ps, self.scaling_seq));
            }
        }
        self.run_to(deadline_ps);
        None
    }

    pub(crate) fn clear_latched_edge(&mut self) {
        self.reported_seq = self.edge_seq;
    }

    /// Runs until `done(level before, level now)` of RDY holds (`true` = high). Returns `false` after `limit_ps`.
    pub(crate) fn wait_rdy(&mut self, limit_ps: u64, done: impl Fn(bool, bool) -> bool) -> bool {
        let deadline_ps = self.now_ps.saturating_add(limit_ps).min(NEVER - 1);
        let mut before = self.rdy_high();
        loop {
            let scaling_ps = self.chip.adc.scaling_from_ps();
            let rise_ps = if scaling_ps > self.now_ps { scaling_ps } else { NEVER };
            let t_ps = rise_ps.min(self.next_event_ps);
            if t_ps > deadline_ps {
                self.run_to(deadline_ps);
                return false;
            }
            self.run_to(t_ps);
            let now = self.rdy_high();
            if done(before, now) {
                return true;
            }
            before = now;
        }
    }

    // ---- wires ----

    /// Handles a rise of CS, which stays high for `gap_ps`.
    #[inline]
    pub(crate) fn deselect(&mut self) {
        self.chip.deselect();
        self.advance_ps(self.gap_ps);
    }

    #[inline]
    pub(crate) fn exchange(&mut self, mosi: u8) -> u8 {
        self.advance_ps(self.byte_ps);
        if self.plain { self.clock(mosi) } else { self.exchange_specially(mosi) }
    }

    #[cold]
    fn exchange_specially(&mut self, mosi: u8) -> u8 {
        if !self.supplied {
            return 0xFF;
        }
        let sdi = self.faults.sdi(mosi);
        let sdo = self.clock(sdi);
        self.faults.sdo(sdo)
    }

    #[inline]
    fn clock(&mut self, sdi: u8) -> u8 {
        let (sdo, effect) = self.chip.byte(sdi, self.now_ps);
        if let Effect::Changed { rdy_was_low } = effect {
            self.changed(!rdy_was_low || self.rdy_masked);
        }
        sdo
    }

    /// The level of RDY on the host's side.
    pub(crate) fn rdy_high(&self) -> bool {
        match self.spec.rdy {
            RdyOutput::Level => self.rdy_idle(),
            RdyOutput::Inverted => !self.rdy_idle(),
            RdyOutput::Pulse => !self.supplied || self.rdy_masked || self.now_ps < self.chip.adc.scaling_from_ps(),
        }
    }

    /// Whether RDY announces no data. Does not show the pulses of [`RdyOutput::Pulse`].
    fn rdy_idle(&self) -> bool {
        !self.supplied || self.rdy_masked || !self.chip.adc.rdy_low(self.now_ps)
    }

    pub(crate) fn set_sync(&mut self, high: bool) {
        let was_high = self.rdy_idle();
        self.chip.set_sync(high, self.now_ps);
        self.changed(was_high);
    }

    pub(crate) fn set_self_test(&mut self, active: bool) {
        self.gyro.set_self_test(active);
    }

    // ---- faults, supply, motion ----

    pub(crate) fn set_fault(&mut self, fault: Fault) {
        let was_high = self.rdy_idle();
        self.faults.set(fault);
        self.chip.adc.frozen = fault == Fault::Frozen;
        if fault == Fault::Brownout {
            self.chip.reset();
        }
        self.rdy_masked = fault == Fault::RdyLost;
        self.note_supply();
        self.changed(was_high);
    }

    pub(crate) fn switch(&mut self, on: bool) {
        let was_high = self.rdy_idle();
        self.switched_on = on;
        self.note_supply();
        self.changed(was_high);
    }

    pub(crate) fn replug(&mut self) {
        if self.faults.active == Fault::Unplug {
            self.set_fault(Fault::None);
        }
    }

    pub(crate) fn set_motion(&mut self, motion: Motion) {
        self.gyro.slow.follow(self.now_ps);
        let now_s = self.now_ps as f64 / PS_PER_S;
        self.gyro.slow.platform.set_motion(motion, now_s);
    }

    pub(crate) fn set_ambient(&mut self, temp_c: f64, over_s: f64) {
        self.gyro.slow.set_ambient(temp_c, over_s, self.now_ps);
    }

    pub(crate) fn truth(&mut self) -> Truth {
        Truth::new(&self.spec, self.now_ps, &self.gyro.slow.at(self.now_ps))
    }

    /// If the supply has come or gone, resets the registers and switches the self-heating.
    fn note_supply(&mut self) {
        let supplied = self.switched_on && self.faults.active != Fault::Unplug;
        if supplied != self.supplied {
            self.supplied = supplied;
            self.chip.reset();
            self.gyro.slow.set_powered(supplied, self.now_ps);
        }
    }

    /// Updates the state after a change of a register, a fault or the supply. Counts an edge if RDY has fallen.
    fn changed(&mut self, rdy_was_high: bool) {
        let wires_good = matches!(self.faults.active, Fault::None | Fault::Frozen | Fault::Brownout);
        self.plain = wires_good && self.supplied;
        self.gyro.set_period_ps(self.chip.adc.period_ps());
        self.next_event_ps = self.fault_at_ps.min(self.chip.adc.next_update_ps);
        if rdy_was_high && !self.rdy_idle() {
            self.edge(self.now_ps);
        }
    }
}

impl fmt::Debug for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Part").field("seed", &self.spec.seed).field("now_ps", &self.now_ps).finish_non_exhaustive()
    }
}

/// The fault of the specification. Without a fault, a bit error rate above zero means [`Fault::BitErrors`].
fn pending_fault(spec: &Spec) -> Fault {
    if spec.fault == Fault::None && spec.bit_error_rate > 0.0 { Fault::BitErrors } else { spec.fault }
}
