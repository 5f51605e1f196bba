//! The common source of both drivers. Two modules include this file: `blocking.rs` and `asynch.rs`. Each brings its
//! own `SpiDevice`, `DelayNs`, `RdyPin` and `bisync`. In `asynch`, `bisync` leaves the code as it is. In `blocking`,
//! it removes `async` and `.await`.

use super::{DelayNs, RdyPin, SpiDevice, bisync};

use embedded_hal::digital::OutputPin;

use crate::channel::{Channel, ConvertedChannels};
use crate::checksum::WriteCheck;
use crate::codes::{RateCode, TempCode};
use crate::config::{Channels, Config, Write};
use crate::diagnosis::{Fault, is_at_rail, is_doubtful, is_doubtful_reading, is_near_rail, meaning_on_healthy_link};
use crate::error::{
    BusError, InitError, NoReading, OutOfRange, ReadError, SampleError, SelfTestError, VerifyError, WaitError,
};
use crate::frame::{Frame, Framing, RESET_FRAME, com_read};
use crate::readback::{Differences, WriteLog};
use crate::registers::{
    AdcStatus, Address, ChannelStatus, Checksum, Iop, Mode, RateConv, RateCs, RateData, RateStatus, Readable,
    Register, Revision, TempConv, TempCs, TempData, TempStatus, Writable,
};
use crate::sample::{Edge, Sample};
use crate::sampler::Sampler;
use crate::self_test::{Active, Level, SelfTest, SelfTestPlan};
use crate::wait::WaitBound;

/// The part on an SPI bus, with its RDY line.
///
/// No method waits or retries unless its documentation says so. Each does a bounded number of transfers.
///
/// A failed transfer, or an async call that is dropped during one, leaves the part in the middle of a command. The
/// part's next bytes would then be read shifted. So every later command sends nothing and returns
/// [`BusError::Interrupted`], until [`reset`](Self::reset) or [`restart`](Self::restart) succeeds.
#[derive(Debug)]
pub struct Adis16130<SPI, RDY> {
    spi: SPI,
    pub(super) rdy: RDY,
    pub(super) config: Config,
    written: WriteLog,
    seen: ConvertedChannels,
    /// The register of a command that has begun and may not have ended.
    in_flight: Option<Address>,
}

impl<SPI, RDY> Adis16130<SPI, RDY> {
    /// Takes the bus ([`crate::SPI_MODE`], at most [`crate::MAX_SCLK_HZ`]) and the RDY pin. Sends nothing:
    /// call [`restart`](Self::restart).
    pub const fn new(spi: SPI, rdy: RDY, config: Config) -> Self {
        Self { spi, rdy, config, written: WriteLog::NOTHING, seen: ConvertedChannels::NOTHING, in_flight: None }
    }

    /// Returns the bus and the pin. The part goes on converting.
    pub fn release(self) -> (SPI, RDY) {
        (self.spi, self.rdy)
    }

    /// The bus, for settings such as its clock. After commands of your own, call [`restart`](Self::restart).
    pub const fn bus_mut(&mut self) -> &mut SPI {
        self.seen = ConvertedChannels::NOTHING;
        &mut self.spi
    }

    /// The configuration that [`init`](Self::init) writes.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// Sets the configuration that the next [`init`](Self::init) writes. Its framing and RDY edge take effect at once.
    pub const fn set_config(&mut self, config: Config) {
        self.config = config;
    }

    /// MODE as last written with success, or its reset value if it has not been written since the reset.
    pub const fn mode(&self) -> Mode {
        self.written.mode()
    }
}

#[bisync]
impl<SPI: SpiDevice, RDY> Adis16130<SPI, RDY> {
    /// Resets the part with 32 ones in a row, as one CS-low frame in either framing (F-23).
    pub async fn reset(&mut self) -> Result<(), BusError<SPI::Error>> {
        self.in_flight = Some(Address::Com);
        let sent = self.spi.write(&RESET_FRAME).await;
        sent.map_err(|error| BusError::Transfer { register: Address::Com, error })?;
        self.in_flight = None;
        self.written = WriteLog::NOTHING;
        self.seen = ConvertedChannels::NOTHING;
        Ok(())
    }

    /// Does a [`reset`](Self::reset), then [`init_verified`](Self::init_verified). Call it at the start, after an
    /// error, and after an async call was dropped. Then call [`Sampler::restarted`] of a sampler in use. The next
    /// reading comes from a new conversion.
    pub async fn restart(&mut self) -> Result<(), InitError<SPI::Error>> {
        self.reset().await?;
        self.init_verified().await
    }

    /// Writes the configuration. With the default configuration these are the twelve bytes of F-30. Does not reset the
    /// part and does not read back.
    pub async fn init(&mut self) -> Result<(), InitError<SPI::Error>> {
        for write in self.config.writes() {
            self.send(write).await?;
        }
        Ok(())
    }

    /// Does an [`init`](Self::init), then [`verify`](Self::verify).
    pub async fn init_verified(&mut self) -> Result<(), InitError<SPI::Error>> {
        self.init().await?;
        Ok(self.verify().await?)
    }

    /// Does an [`init`](Self::init) between two reads of CHECKSUM, which show whether the part has received every
    /// written bit. A disagreement is not an error, because the register is not verified on this part (F-34).
    pub async fn init_checksummed(&mut self) -> Result<WriteCheck, InitError<SPI::Error>> {
        let before = self.read_register::<Checksum>().await?;
        self.init().await?;
        let got = self.read_register::<Checksum>().await?;
        let seen = self.config.writes().fold(before, |sum, write| sum.fed(write.frame.bytes()));
        let expected = seen.fed(&[com_read(Checksum::ADDRESS)]);
        Ok(WriteCheck { expected, got })
    }

    /// Reads back every configuration register written since the reset. Returns an error if a register differs, or if
    /// MODE has not been written.
    pub async fn verify(&mut self) -> Result<(), VerifyError<SPI::Error>> {
        if !self.written.is_complete() {
            return Err(VerifyError::NotInitialised);
        }
        let mut differences = Differences::default();
        for (register, expected) in self.written.iter() {
            let got = self.exchange(register, Frame::read_byte(register)).await?;
            differences.compare(register, expected, got as u8);
        }
        VerifyError::judge(differences)
    }

    /// Reads a register as it is, without a check.
    #[inline]
    pub async fn read_register<R: Readable>(&mut self) -> Result<R::Value, BusError<SPI::Error>> {
        let width = self.mode().width();
        let answer = self.exchange(R::ADDRESS, Frame::read::<R>(width)).await?;
        Ok(R::decode(answer, width))
    }

    /// Reads all registers as they are, in the order of their addresses. This consumes the unread readings of the
    /// data registers, so their edge gives no sample.
    pub async fn read_all(&mut self) -> Result<[(Address, u32); 13], BusError<SPI::Error>> {
        Ok([
            (Address::Iop, self.read_register::<Iop>().await?.bits().into()),
            (Address::Revision, self.read_register::<Revision>().await?.bits().into()),
            (Address::AdcStatus, self.read_register::<AdcStatus>().await?.bits().into()),
            (Address::Checksum, self.read_register::<Checksum>().await?.bits().into()),
            (Address::RateData, self.read_register::<RateData>().await?.code()),
            (Address::TempData, self.read_register::<TempData>().await?.code()),
            (Address::RateStatus, self.read_register::<RateStatus>().await?.bits().into()),
            (Address::TempStatus, self.read_register::<TempStatus>().await?.bits().into()),
            (Address::RateCs, self.read_register::<RateCs>().await?.bits().into()),
            (Address::TempCs, self.read_register::<TempCs>().await?.bits().into()),
            (Address::RateConv, self.read_register::<RateConv>().await?.bits().into()),
            (Address::TempConv, self.read_register::<TempConv>().await?.bits().into()),
            (Address::Mode, self.read_register::<Mode>().await?.bits().into()),
        ])
    }

    /// Writes a register. The driver records the value as written only if the transfer succeeds.
    pub async fn write_register<R: Writable>(&mut self, value: R::Value) -> Result<(), BusError<SPI::Error>> {
        self.send(Write::of::<R>(value)).await
    }

    /// Reads the rate, in the width that was written to MODE.
    ///
    /// A code that a dead line would give makes the driver check the link. On a healthy link the result is
    /// [`ReadError::OutOfRange`] (F-35), otherwise the fault.
    ///
    /// The driver also checks the code that the data registers hold after a reset. It is a rate if the part still has
    /// its configuration and this channel has converted. Otherwise the result is [`ReadError::NoReading`] or the
    /// fault. After MODE was written, each call first checks the link and reads the channel's
    /// status, until the channel has shown a conversion.
    ///
    /// With CLAMP = 0 codes wrap and only the status shows it: use [`read_rate_in_range`](Self::read_rate_in_range).
    pub async fn read_rate(&mut self) -> Result<RateCode, ReadError<SPI::Error>> {
        let rate = self.reading::<RateData>(Channel::Rate).await?;
        rate.ok_or_else(|| self.no_reading(Channel::Rate))
    }

    /// Reads the temperature, with the same checks as [`read_rate`](Self::read_rate).
    pub async fn read_temp(&mut self) -> Result<TempCode, ReadError<SPI::Error>> {
        let temp = self.reading::<TempData>(Channel::Temp).await?;
        temp.ok_or_else(|| self.no_reading(Channel::Temp))
    }

    /// Reads the rate, then the temperature. [`read_in_range`](Self::read_in_range) checks the status, too.
    pub async fn read_both(&mut self) -> Result<(RateCode, TempCode), ReadError<SPI::Error>> {
        let rate = self.read_rate().await?;
        let temp = self.read_temp().await?;
        Ok((rate, temp))
    }

    /// Reads the rate and the status that belongs to it. Reports a rate out of range as [`ReadError::OutOfRange`],
    /// also if its code has wrapped, as with CLAMP = 0 (F-35). This method is for loops that do not follow RDY.
    /// [`sample`](Self::sample) handles every edge of RDY.
    ///
    /// If a conversion ends between the two reads, both are read once more. A conversion may end between them again,
    /// as on a host that takes longer than a conversion for six bytes. Then the rate is out of range if one of the two
    /// statuses says so, or if its code is within 1/64 of the end of the scale, where it may have wrapped.
    pub async fn read_rate_in_range(&mut self) -> Result<RateCode, ReadError<SPI::Error>> {
        let mut rate = self.read_rate().await?;
        let mut status = self.rate_status().await?;
        let mut outside = status.out_of_range();
        if status.ready() {
            rate = self.read_rate().await?;
            status = self.rate_status().await?;
            outside = status.out_of_range() || status.ready() && (outside || is_near_rail(rate));
        }
        if outside { Err(OutOfRange::of_rate(rate, status).into()) } else { Ok(rate) }
    }

    /// Reads the rate as [`read_rate_in_range`](Self::read_rate_in_range) does, then the temperature.
    pub async fn read_in_range(&mut self) -> Result<(RateCode, TempCode), ReadError<SPI::Error>> {
        let rate = self.read_rate_in_range().await?;
        let temp = self.read_temp().await?;
        Ok((rate, temp))
    }

    /// Reads the status of the rate channel. A status that names another channel is a fault.
    pub async fn rate_status(&mut self) -> Result<ChannelStatus, ReadError<SPI::Error>> {
        self.read_checked::<RateStatus>().await
    }

    /// Reads the status of the temperature channel. A status that names another channel is a fault.
    pub async fn temp_status(&mut self) -> Result<ChannelStatus, ReadError<SPI::Error>> {
        self.read_checked::<TempStatus>().await
    }

    /// Reads which channels hold unread data.
    pub async fn adc_status(&mut self) -> Result<AdcStatus, ReadError<SPI::Error>> {
        self.read_checked::<AdcStatus>().await
    }

    /// Reads the revision of the converter.
    pub async fn revision(&mut self) -> Result<Revision, ReadError<SPI::Error>> {
        self.read_checked::<Revision>().await
    }

    /// Reads TEMP STATUS and MODE, and returns the fault of the line or the part. `None` if the part is connected, and
    /// configured as written: before the first initialisation, as after a reset.
    pub async fn diagnose(&mut self) -> Result<Option<Fault>, BusError<SPI::Error>> {
        let temp_status = self.read_register::<TempStatus>().await?;
        let mode = self.read_register::<Mode>().await?;
        Ok(Fault::shown_by(temp_status, mode, self.mode()))
    }

    /// Handles an edge of RDY: reads what `sampler` finds due, in the order status, rate, temperature.
    ///
    /// Returns `None` if nothing was due, or the edge was stale (its data has been read already).
    ///
    /// An out-of-range rate is not an error: the status of the sample shows it, and the caller decides what to do. For
    /// a rate at the end of its scale, and for the first rate after MODE was written, the status is read even if it
    /// was not due. A temperature that is due before its first conversion is left out, and stays due.
    ///
    /// The driver diagnoses the link after a status that names another channel, and after an answer that a dead line
    /// or a part without a reading would give. A fault of the line or the part is returned as [`SampleError::Fault`].
    #[inline]
    pub async fn sample(
        &mut self,
        sampler: &mut Sampler,
        edge: Edge,
    ) -> Result<Option<Sample>, SampleError<SPI::Error>> {
        let Some(mut due) = sampler.edge(edge) else {
            return Ok(None);
        };
        let mut status = None;
        if due.status || !self.seen.has(Channel::Rate) {
            let read = self.read_register::<RateStatus>().await?;
            if !read.announces_rate() {
                self.require_stale(read).await?;
                sampler.stale();
                return Ok(None);
            }
            self.seen.note(Channel::Rate);
            status = Some(read);
        }
        let rate = self.read_register::<RateData>().await?;
        if is_doubtful_reading(rate.code(), rate.width()) {
            status = self.status_of_doubtful(rate, status).await?;
        }
        let mut temp = None;
        if due.temp {
            temp = self.reading::<TempData>(Channel::Temp).await?;
            due.temp = temp.is_some();
        }
        let lost = sampler.taken(&due);
        Ok(Some(Sample { t_ns: edge.t_ns, seq: edge.seq, rate, status, temp, lost }))
    }

    /// Checks a status without unread data: returns an error if a fault is the reason. Otherwise the edge is stale.
    #[cold]
    async fn require_stale(&mut self, status: ChannelStatus) -> Result<(), SampleError<SPI::Error>> {
        if is_doubtful(RateStatus::ADDRESS, status.bits()) {
            self.require_healthy().await?;
            if let Some(fault) = Fault::of_channel(RateStatus::ADDRESS, status, RateStatus::RESET) {
                return Err(fault.into());
            }
        }
        Ok(())
    }

    /// Checks the link after a rate that a dead line or a part without a reading would give, unless the rate and the
    /// given status both say that the input is out of range. Returns the given status. If none was given and the rate
    /// is at the end of its scale, reads it from the register.
    #[cold]
    async fn status_of_doubtful(
        &mut self,
        rate: RateCode,
        status: Option<ChannelStatus>,
    ) -> Result<Option<ChannelStatus>, SampleError<SPI::Error>> {
        if status.is_some_and(ChannelStatus::out_of_range) && rate.is_at_rail() {
            return Ok(status);
        }
        self.require_healthy().await?;
        if status.is_none() && rate.is_at_rail() {
            return Ok(Some(self.read_register::<RateStatus>().await?));
        }
        Ok(status)
    }

    #[cold]
    async fn require_healthy(&mut self) -> Result<(), SampleError<SPI::Error>> {
        self.diagnose().await?.map_or(Ok(()), |fault| Err(fault.into()))
    }

    /// Reads the data register of `channel`. Returns `None` if it holds its reset value, and the channel is not known
    /// to have converted since MODE was written.
    #[inline]
    async fn reading<D: Readable>(&mut self, channel: Channel) -> Result<Option<D::Value>, SampleError<SPI::Error>> {
        if !self.seen.has(channel) {
            self.look_for_first(channel).await?;
        }
        let width = self.mode().width();
        let answer = self.exchange(D::ADDRESS, Frame::read::<D>(width)).await?;
        if is_doubtful_reading(answer, width) && !self.is_measured(channel, answer).await? {
            return Ok(None);
        }
        self.seen.note(channel);
        Ok(Some(D::decode(answer, width)))
    }

    /// Checks whether a channel has a reading. This must come before the data register is read, which clears RDY in
    /// the status.
    #[cold]
    async fn look_for_first(&mut self, channel: Channel) -> Result<(), SampleError<SPI::Error>> {
        self.require_healthy().await?;
        let status = self.exchange(channel.status(), Frame::read_byte(channel.status())).await?;
        if channel.announced_by(ChannelStatus::new(status as u8)) {
            self.seen.note(channel);
        }
        Ok(())
    }

    /// Whether a doubtful answer of a data register is a reading. Returns an error for a fault, and for a code at the
    /// end of the scale.
    #[cold]
    async fn is_measured(&mut self, channel: Channel, answer: u32) -> Result<bool, SampleError<SPI::Error>> {
        self.require_healthy().await?;
        let width = self.mode().width();
        if is_at_rail(answer, width) {
            return Err(OutOfRange { register: channel.data(), code: answer, width, status: None }.into());
        }
        Ok(self.seen.has(channel))
    }

    #[cold]
    fn no_reading(&self, channel: Channel) -> ReadError<SPI::Error> {
        ReadError::NoReading(NoReading { register: channel.data(), mode: self.mode() })
    }

    /// Reads a register of one byte, and diagnoses the link if the answer is doubtful.
    async fn read_checked<R: Readable>(&mut self) -> Result<R::Value, ReadError<SPI::Error>> {
        let width = self.mode().width();
        let answer = self.exchange(R::ADDRESS, Frame::read::<R>(width)).await?;
        if is_doubtful(R::ADDRESS, answer as u8) {
            self.require_healthy().await?;
            if let Some(fault) = meaning_on_healthy_link(R::ADDRESS, answer as u8) {
                return Err(fault.into());
            }
        }
        Ok(R::decode(answer, width))
    }

    async fn send(&mut self, write: Write) -> Result<(), BusError<SPI::Error>> {
        self.exchange(write.address, write.frame).await?;
        if self.written.record(write.address, write.frame.answer()) {
            self.seen = ConvertedChannels::NOTHING;
        }
        Ok(())
    }

    /// Sends one command in the configured framing (F-22): one transfer per byte, or one for the whole command.
    /// Returns the data bytes that came back.
    #[inline]
    async fn exchange(&mut self, register: Address, mut frame: Frame) -> Result<u32, BusError<SPI::Error>> {
        if let Some(register) = self.in_flight {
            return Err(BusError::Interrupted { register });
        }
        self.in_flight = Some(register);
        let failed = |error| BusError::Transfer { register, error };
        match self.config.framing() {
            Framing::Command => self.spi.transfer_in_place(frame.bytes_mut()).await.map_err(failed)?,
            Framing::PerByte => {
                for byte in frame.bytes_mut() {
                    self.spi.transfer_in_place(core::slice::from_mut(byte)).await.map_err(failed)?;
                }
            }
        }
        self.in_flight = None;
        Ok(frame.answer())
    }
}

#[bisync]
impl<SPI: SpiDevice, RDY: RdyPin> Adis16130<SPI, RDY> {
    /// Waits until RDY shows unread data, and the channel status confirms it (F-32). With a line that is stuck, or
    /// inverted without [`Config::with_rdy_edge`], no reading comes twice either. The status is of the rate, or of the
    /// temperature if only that is converted.
    ///
    /// # Errors
    /// [`WaitError::TimedOut`] if RDY shows nothing within `bound`, or if `bound.polls() + 1` statuses did not confirm
    /// it. [`WaitError::Status`] if the status cannot be read.
    pub async fn wait_ready(
        &mut self,
        delay: &mut impl DelayNs,
        bound: WaitBound,
    ) -> Result<(), WaitError<SPI::Error, RDY::Error>> {
        for _ in 0..=bound.polls() {
            self.wait_for_rdy(delay, bound).await?;
            let status = match self.config.channels() {
                Channels::Temp => self.temp_status().await?,
                Channels::Both | Channels::Rate => self.rate_status().await?,
            };
            if status.ready() {
                return Ok(());
            }
            delay.delay_us(bound.poll().us()).await;
        }
        Err(WaitError::TimedOut { timeout_us: bound.timeout_us() })
    }

    /// Measures by how much the self-test shifts the rate. It does not judge the shift (F-11).
    ///
    /// `pin` drives the self-test pins 1–7 and 9 together and is active high. It is low when the method returns, also
    /// with an error other than [`SelfTestError::Pin`], and when an async call is dropped. The part must be
    /// initialised, and at rest, since motion counts as shift. The call takes two settling times and `2 · samples`
    /// rates. Each rate takes at most four times the bound of the plan.
    #[allow(clippy::type_complexity, reason = "one type for each of the three wires that can fail")]
    pub async fn self_test<P: OutputPin>(
        &mut self,
        pin: &mut P,
        delay: &mut impl DelayNs,
        plan: SelfTestPlan,
    ) -> Result<SelfTest, SelfTestError<SPI::Error, RDY::Error, P::Error>> {
        pin.set_low().map_err(SelfTestError::Pin)?;
        let off = self.level(delay, &plan).await?;
        let active = Active::activate(pin).map_err(SelfTestError::Pin)?;
        let on = self.level(delay, &plan).await;
        active.release().map_err(SelfTestError::Pin)?;
        Ok(SelfTest::from_levels(&plan, &off, &on?))
    }

    async fn level<P>(
        &mut self,
        delay: &mut impl DelayNs,
        plan: &SelfTestPlan,
    ) -> Result<Level, SelfTestError<SPI::Error, RDY::Error, P>> {
        delay.delay_us(plan.settle_us()).await;
        let mut level = Level::default();
        for _ in 0..plan.samples() {
            let rate = self.next_rate(delay, plan).await?;
            level.push(plan, rate);
        }
        Ok(level)
    }

    /// Waits for the next unread rate. Both channels are read, since unread data of either channel can keep RDY
    /// active.
    async fn next_rate<P>(
        &mut self,
        delay: &mut impl DelayNs,
        plan: &SelfTestPlan,
    ) -> Result<RateCode, SelfTestError<SPI::Error, RDY::Error, P>> {
        for _ in 0..4 {
            self.wait_for_rdy(delay, plan.bound()).await?;
            let status = self.rate_status().await?;
            if status.out_of_range() {
                let rate = self.read_register::<RateData>().await.map_err(ReadError::from)?;
                return Err(ReadError::from(OutOfRange::of_rate(rate, status)).into());
            }
            let rate = self.reading::<RateData>(Channel::Rate).await.map_err(ReadError::from)?;
            self.reading::<TempData>(Channel::Temp).await.map_err(ReadError::from)?;
            if let (Some(rate), true) = (rate, status.ready()) {
                return Ok(rate);
            }
        }
        Err(SelfTestError::Wait(WaitError::TimedOut { timeout_us: plan.bound().timeout_us() }))
    }
}
