//! The converter: the times of its conversions, the data registers, unread data and RDY.

use crate::facts;
use crate::registers::{Channel, Registers};
use crate::registers::{IOP_RDYFN, MODE_CLAMP, MODE_CONTINUOUS, MODE_MD, MODE_SINGLE};
use crate::tally::{Conversion, LastRead, LostUnread, Reading, Tally};

pub(crate) const NEVER: u64 = u64::MAX;

#[derive(Copy, Clone)]
struct Data {
    code: u32,
    negative: bool,
    out_of_range: bool,
    conversion: Option<Conversion>,
    tally: Tally,
}

impl Data {
    fn reset(tally: Tally) -> Self {
        Self { code: facts::ZERO_CODE, negative: false, out_of_range: false, conversion: None, tally }
    }
}

pub(crate) struct Adc {
    mclk_hz: f64,
    data: [Data; 2],
    /// Channels with unread data, as a set of [`Channel::bit`].
    unread: u8,
    /// The channel whose data register is being read, from the accepted COM byte to the last data byte.
    reading: Option<Channel>,
    plan: Plan,
    pub(crate) converting: Channel,
    /// Time at which the running conversion ends, in ps, or [`NEVER`].
    pub(crate) next_update_ps: u64,
    pub(crate) frozen: bool,
}

/// The configuration of the converter, computed from the registers when they change.
#[derive(Copy, Clone)]
struct Plan {
    enabled: u8,
    conversion_ps: [u64; 2],
    scaling_ps: u64,
    single: bool,
    running: bool,
    clamp: bool,
    rdy_needs_all: bool,
}

impl Plan {
    fn of(registers: &Registers, mclk_hz: f64, held: bool) -> Self {
        let ps = |cycles: u32| ((f64::from(cycles) * 1e12 / mclk_hz + 0.5) as u64).max(1);
        let mode = registers.mode & MODE_MD;
        let enabled = registers.enabled();
        Self {
            enabled,
            conversion_ps: Channel::ALL.map(|channel| ps(registers.conversion_cycles(channel))),
            scaling_ps: ps(facts::SCALING_CYCLES),
            single: mode == MODE_SINGLE,
            running: (mode == MODE_CONTINUOUS || mode == MODE_SINGLE) && enabled != 0 && !held,
            clamp: registers.mode & MODE_CLAMP != 0,
            rdy_needs_all: registers.iop & IOP_RDYFN != 0,
        }
    }

    fn first(&self) -> Channel {
        if self.enabled & Channel::Rate.bit() != 0 { Channel::Rate } else { Channel::Temp }
    }

    fn after(&self, channel: Channel) -> Channel {
        let other = match channel {
            Channel::Rate => Channel::Temp,
            Channel::Temp => Channel::Rate,
        };
        if self.enabled & other.bit() != 0 { other } else { channel }
    }
}

/// The effects of an update of a data register, apart from the stored code.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) struct Update {
    pub(crate) rdy_falls: bool,
    pub(crate) single_done: bool,
}

impl Adc {
    pub(crate) fn new(mclk_hz: f64) -> Self {
        Self {
            mclk_hz,
            data: [Data::reset(Tally::default()); 2],
            unread: 0,
            reading: None,
            plan: Plan::of(&Registers::RESET, mclk_hz, false),
            converting: Channel::Rate,
            next_update_ps: NEVER,
            frozen: false,
        }
    }

    /// Resets the converter, but keeps the [`Tally`] of each channel.
    pub(crate) fn reset(&mut self) {
        self.data = self.data.map(|data| Data::reset(data.tally));
        self.unread = 0;
        self.reading = None;
        self.plan = Plan::of(&Registers::RESET, self.mclk_hz, false);
        self.next_update_ps = NEVER;
    }

    /// Uses new register contents. With `restart` (after a write to MODE or a rise of SYNC) the sequence begins anew.
    /// Otherwise a running conversion keeps its end time. `held`: whether the SYNC pin holds the conversions.
    pub(crate) fn plan(&mut self, registers: &Registers, held: bool, restart: bool, now_ps: u64) {
        self.plan = Plan::of(registers, self.mclk_hz, held);
        if !self.plan.running {
            self.next_update_ps = NEVER;
        } else if restart || self.next_update_ps == NEVER {
            self.begin(self.plan.first(), now_ps);
        }
    }

    /// Time from one conversion of a channel to the next conversion of the same channel, in ps.
    pub(crate) fn period_ps(&self) -> u64 {
        let [rate_ps, temp_ps] = self.plan.conversion_ps;
        match self.plan.enabled {
            0b01 => rate_ps,
            0b10 => temp_ps,
            _ => rate_ps + temp_ps,
        }
    }

    /// Ends the running conversion, whose code before clamping is `unlimited`. Begins the next one, unless this was
    /// the last one of single mode.
    #[inline]
    pub(crate) fn update(&mut self, unlimited: i64) -> Update {
        let channel = self.converting;
        if self.plan.enabled & channel.bit() != 0 {
            self.store(channel, unlimited);
        }
        let next = self.plan.after(channel);
        let single_done = self.plan.single && next as u8 <= channel as u8;
        if single_done {
            self.next_update_ps = NEVER;
        } else {
            self.begin(next, self.next_update_ps);
        }
        Update { rdy_falls: self.rdy_due(), single_done }
    }

    #[inline]
    fn begin(&mut self, channel: Channel, now_ps: u64) {
        self.converting = channel;
        self.next_update_ps = now_ps.saturating_add(self.plan.conversion_ps[channel as usize]);
    }

    #[inline]
    fn store(&mut self, channel: Channel, unlimited: i64) {
        let data = &mut self.data[channel as usize];
        data.tally.conversions += 1;
        if self.reading == Some(channel) {
            data.tally.losses.lost_new += 1;
            return;
        }
        data.tally.losses.overwritten += u64::from(self.unread & channel.bit() != 0);
        data.conversion = Some(Conversion { number: data.tally.conversions, t_ns: self.next_update_ps / 1000 });
        self.unread |= channel.bit();
        if self.frozen {
            return;
        }
        let max = i64::from(facts::MAX_CODE);
        data.out_of_range = unlimited < 0 || unlimited > max;
        data.negative = unlimited < i64::from(facts::ZERO_CODE);
        data.code = if self.plan.clamp { unlimited.clamp(0, max) as u32 } else { unlimited as u32 & facts::MAX_CODE };
    }

    /// Whether the condition of F-32 for a low RDY holds, apart from the scaling time.
    #[inline]
    pub(crate) fn rdy_due(&self) -> bool {
        let unread = self.unread & self.plan.enabled;
        unread != 0 && (!self.plan.rdy_needs_all || unread == self.plan.enabled)
    }

    pub(crate) fn rdy_low(&self, now_ps: u64) -> bool {
        now_ps < self.scaling_from_ps() && self.rdy_due()
    }

    /// The time at which the scaling time of the running conversion begins, in ps, or [`NEVER`].
    pub(crate) fn scaling_from_ps(&self) -> u64 {
        match self.next_update_ps {
            NEVER => NEVER,
            update => update.saturating_sub(self.plan.scaling_ps),
        }
    }

    /// Begins the read of a data register after the COM byte. Returns the 24-bit code, which now counts as read.
    #[inline]
    pub(crate) fn begin_read(&mut self, channel: Channel) -> u32 {
        self.reading = Some(channel);
        self.unread &= !channel.bit();
        let data = &mut self.data[channel as usize];
        let Data { code, conversion, out_of_range, .. } = *data;
        data.tally.last_read = Some(Reading { code, conversion, out_of_range });
        code
    }

    #[inline]
    pub(crate) fn end_read(&mut self) {
        self.reading = None;
    }

    /// Returns the value of the ADC status register: bit n is set while channel n holds unread data.
    pub(crate) fn status(&self) -> u8 {
        let bit = |channel: Channel| u8::from(self.unread & channel.bit() != 0) << channel.number();
        bit(Channel::Rate) | bit(Channel::Temp)
    }

    #[inline]
    pub(crate) fn channel_status(&self, channel: Channel) -> u8 {
        let data = &self.data[channel as usize];
        channel.number() << 5
            | u8::from(self.unread & channel.bit() != 0) << 3
            | u8::from(data.negative) << 1
            | u8::from(data.out_of_range)
    }

    pub(crate) fn lost_unread(&self) -> LostUnread {
        let [rate, temp] = self.data.map(|data| data.tally.losses);
        LostUnread { rate, temp }
    }

    pub(crate) fn last_read(&self) -> LastRead {
        let [rate, temp] = self.data.map(|data| data.tally.last_read);
        LastRead { rate, temp }
    }
}

/// Converts a 24-bit code to 16 bits: rounded to nearest, ties away from 2¹⁵, limited to 0 … FFFFh (F-43).
pub(crate) fn to_16_bits(code24: u32) -> u16 {
    let distance = i64::from(code24) - i64::from(facts::ZERO_CODE);
    let rounded = (distance.abs() + 128) >> 8;
    (0x8000 + rounded * distance.signum()).clamp(0, 0xFFFF) as u16
}
