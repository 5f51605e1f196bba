//! The thread of the session. It processes samples, sends frames, and answers requests in between.

use super::connection::HostCheck;
use super::device::{OpenDevice, Opener, Opening, SampleFeed};
use super::folder::tell;
use super::{Folder, Libiio, Recordings};
use crate::output::say;
use crate::wording::{flag, text};
use anyhow::Result;
use hyper::body::Bytes;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use tokio::sync::{broadcast, oneshot};
use zerorate::Wording;
use zerorate_host::{Bus, DeviceError, Hub, Losses, Pace, Poll, Stop, WatchedBatch};
use zerorate_jobs::acquisition;
use zerorate_view::SessionWarning;
use zerorate_web::message::DeviceState;
use zerorate_web::session::{HostCommand, NoticeText, RequestResult, Session};

const FRAME: Duration = Duration::from_millis(33);
/// Longest wait for samples before requests are handled.
const TURN: Duration = Duration::from_millis(10);
/// Time between the attempts to open a disconnected part again.
const RETRY: Duration = Duration::from_secs(3);
/// Number of frames that a browser may lag behind: about one second.
pub const BEHIND: usize = 32;
/// Length of the queue of requests. Each connection has at most one request in it.
const QUEUE: usize = 256;
/// Largest number of requests that are handled before samples are checked again.
const MOST_REQUESTS: usize = 64;

pub enum SessionRequest {
    /// Answer a request of the page.
    Ask(String, oneshot::Sender<String>),
    /// Send a snapshot of everything, and then each new frame.
    Watch(oneshot::Sender<Subscription>),
}

pub struct Subscription {
    pub snapshot: Bytes,
    pub frames: broadcast::Receiver<Bytes>,
}

pub type RequestSender = SyncSender<SessionRequest>;

/// The session, its device, and the viewers that wait for their first snapshot.
pub struct SessionThread {
    /// Calibrations are added to it and to the folder before the device is read.
    pub session: Session,
    opener: Opener,
    device: Device,
    speed: f64,
    recordings: Recordings,
    pub folder: Folder,
    pub libiio: Option<Libiio>,
    requests: Receiver<SessionRequest>,
    frames: broadcast::Sender<Bytes>,
    pending: Vec<oneshot::Sender<Subscription>>,
    frame_due: Instant,
    /// The last printed reason why the device cannot be read; `None` once it is read again.
    failed: Option<String>,
    failure: Option<anyhow::Error>,
}

enum Device {
    /// The device is open but is not being read yet.
    Opened(Arc<Hub>, Option<Bus>),
    Opening(Opening),
    Reading(Box<Reading>),
    /// There is nothing to read. If `again` is set, the device is opened again at that time.
    Over {
        hub: Option<Arc<Hub>>,
        again: Option<Instant>,
    },
}

struct Reading {
    hub: Arc<Hub>,
    feed: SampleFeed,
    host_check: Option<HostCheck>,
    losses: Losses,
    doubts: usize,
}

impl Reading {
    fn of(hub: Arc<Hub>, bus: Option<Bus>) -> Self {
        let host_check = Some(HostCheck::new(hub.facts(), bus));
        Self { feed: SampleFeed::of(&hub), hub, host_check, losses: Losses::default(), doubts: 0 }
    }
}

impl SessionThread {
    /// Prepares the thread for a device that was opened and is not being read yet. Also returns its request sender.
    pub fn new(opener: Opener, opened: OpenDevice, recordings: Recordings, folder: Folder) -> (Self, RequestSender) {
        let (sender, requests) = sync_channel(QUEUE);
        let (frames, _) = broadcast::channel(BEHIND);
        let thread = Self {
            session: Session::new(opened.about),
            opener,
            device: Device::Opened(opened.hub, opened.bus),
            speed: 1.0,
            recordings,
            folder,
            libiio: None,
            requests,
            frames,
            pending: Vec::new(),
            frame_due: Instant::now(),
            failed: None,
            failure: None,
        };
        (thread, sender)
    }

    pub fn begin(&mut self) -> Result<()> {
        self.note_standing();
        let device = std::mem::replace(&mut self.device, Device::Over { hub: None, again: None });
        let Device::Opened(hub, bus) = device else { return Ok(()) };
        self.recordings.begin(&hub, &self.session.about().info)?;
        self.read(hub, bus)
    }

    /// Called each time the device is opened.
    fn note_standing(&mut self) {
        if self.folder.path.is_none() {
            self.session.note(SessionWarning::NoFolder);
        }
    }

    fn read(&mut self, hub: Arc<Hub>, bus: Option<Bus>) -> Result<()> {
        let reading = Reading::of(hub, bus);
        reading.hub.read(Pace::RealTime, Vec::new())?;
        reading.hub.speed().set(self.speed);
        if let Some(libiio) = &mut self.libiio {
            libiio.begin(&reading.hub)?;
        }
        self.device = Device::Reading(Box::new(reading));
        self.session.state(DeviceState::Reading);
        Ok(())
    }

    /// Runs until a stop is requested, and completes the recording. Returns the first error of a recording.
    pub fn run(mut self, stop: &Stop) -> Result<()> {
        while !stop.asked() {
            self = self.turn(stop);
        }
        self.device = Device::Over { hub: None, again: None };
        let ended = self.recordings.end();
        self.failure.map_or(ended, Err)
    }

    fn turn(mut self, stop: &Stop) -> Self {
        match &self.device {
            Device::Reading(_) => self.take_what_waits(stop),
            Device::Opening(_) => {
                std::thread::sleep(TURN);
                self = self.look_at_opening();
            }
            Device::Opened(..) => {}
            Device::Over { again, .. } => {
                if again.is_some_and(|again| Instant::now() >= again) {
                    self.open_again();
                }
                std::thread::sleep(TURN);
            }
        }
        self.receive();
        self.folder.keep(&mut self.session);
        if let Some(error) = self.recordings.failure() {
            self.note_failure(error);
        }
        if Instant::now() >= self.frame_due {
            self.frame();
        }
        self
    }

    /// Waits for samples and processes the queue, at most until the next frame: samples that wait too long are missed.
    fn take_what_waits(&mut self, stop: &Stop) {
        let begun = Instant::now();
        let until = self.frame_due.max(begun + TURN);
        let mut patience = self.frame_due.saturating_duration_since(begun).min(TURN);
        while let Device::Reading(reading) = &self.device {
            match reading.feed.next_within(patience) {
                Poll::Samples(watched) => self.take(&watched),
                Poll::Nothing => return,
                Poll::End if stop.asked() => return,
                Poll::End => return self.end_reading(),
            }
            if Instant::now() >= until {
                return;
            }
            patience = Duration::ZERO;
        }
    }

    fn take(&mut self, watched: &WatchedBatch) {
        let Device::Reading(reading) = &mut self.device else { return };
        let (session, batch) = (&mut self.session, &watched.batch);
        if watched.missed > 0 {
            session.missed(watched.missed);
        }
        for row in &batch.rows {
            session.take(row);
        }
        session.truths(&batch.truths);
        for note in &batch.notes {
            say(format_args!("warning: {}", note.coded()));
            session.note(NoticeText::new(note.code(), note));
        }
        for doubt in batch.doubts.iter().skip(reading.doubts) {
            session.note(doubt);
        }
        reading.doubts = batch.doubts.len();
        if reading.losses != batch.losses {
            reading.losses = batch.losses;
            for lost in acquisition::lost_on_the_way(batch.losses) {
                session.note(NoticeText::new(lost.code(), lost.with(flag)));
            }
        }
        if let Some(found) = reading.host_check.as_ref().and_then(|check| check.ended(session.tally())) {
            session.checked(found);
            reading.host_check = None;
        }
    }

    /// Handles the end of a replay, or a failure of the device.
    fn end_reading(&mut self) {
        let Device::Reading(reading) = &self.device else { return };
        let hub = Arc::clone(&reading.hub);
        let (failure, is_real) = (hub.failure(), hub.facts().is_real);
        self.device = Device::Over { hub: Some(hub), again: None };
        match failure {
            None => self.session.state(DeviceState::Ended),
            Some(error) => self.gone(&error.into(), is_real),
        }
        if let Err(error) = self.recordings.end() {
            self.note_failure(error);
        }
    }

    /// Handles a device that cannot be read. The reason is printed again only when it has changed.
    fn gone(&mut self, error: &anyhow::Error, look_again: bool) {
        let hub = match std::mem::replace(&mut self.device, Device::Over { hub: None, again: None }) {
            Device::Over { hub, .. } => hub,
            _ => None,
        };
        self.device = Device::Over { hub, again: look_again.then(|| Instant::now() + RETRY) };
        let why = text(error);
        if self.failed.as_ref() != Some(&why) {
            say(format_args!("the device cannot be read: {why}"));
            self.failed = Some(why.clone());
        }
        self.session.state(DeviceState::Failed { why });
    }

    fn note_failure(&mut self, error: anyhow::Error) {
        tell(&mut self.session, SessionWarning::NotRecorded(text(&error)));
        self.failure.get_or_insert(error);
    }

    fn open_again(&mut self) {
        let hub = match std::mem::replace(&mut self.device, Device::Over { hub: None, again: None }) {
            Device::Reading(reading) => Some(reading.hub),
            Device::Opened(hub, _) => Some(hub),
            Device::Over { hub, .. } => hub,
            opening @ Device::Opening(_) => {
                self.device = opening;
                return;
            }
        };
        // the libiio server holds the hub, so it must end first
        self.libiio.iter_mut().for_each(Libiio::end);
        self.device = Device::Opening(self.opener.open_again(hub));
        self.session.state(DeviceState::Opening);
    }

    fn look_at_opening(mut self) -> Self {
        let Device::Opening(opening) = &self.device else { return self };
        match opening.ready() {
            None => self,
            Some(Ok(OpenDevice { hub, about, bus })) => {
                self.session = self.session.reopened(about);
                self.note_standing();
                self.failed = None;
                // without its recording, the part is still read and shown
                if let Err(error) = self.recordings.begin(&hub, &self.session.about().info) {
                    self.note_failure(error);
                }
                if let Err(error) = self.read(hub, bus) {
                    self.gone(&error, true);
                }
                self
            }
            Some(Err(error)) => {
                self.gone(&error, error.is::<DeviceError>());
                self
            }
        }
    }

    fn receive(&mut self) {
        for _ in 0..MOST_REQUESTS {
            match self.requests.try_recv() {
                // the client may have left
                Ok(SessionRequest::Ask(request, answer)) => drop(answer.send(self.answer(&request))),
                Ok(SessionRequest::Watch(subscriber)) => self.pending.push(subscriber),
                Err(_) => return,
            }
        }
    }

    fn answer(&mut self, request: &str) -> String {
        match self.session.ask(request) {
            RequestResult::Answer(answer) => answer,
            RequestResult::Host { id, command } => {
                match command {
                    HostCommand::Speed(factor) => self.set_speed(factor),
                    HostCommand::Reopen => self.open_again(),
                }
                self.session.done(id, Ok(()))
            }
        }
    }

    fn set_speed(&mut self, factor: f64) {
        self.speed = factor;
        if let Device::Reading(reading) = &self.device {
            reading.hub.speed().set(factor);
        }
        self.session.speed(factor);
    }

    /// Sends the new frame to all viewers. New viewers since the last frame share one snapshot.
    fn frame(&mut self) {
        let now = Instant::now();
        let next = self.frame_due + FRAME;
        self.frame_due = if next > now { next } else { now + FRAME };
        if let Some(frame) = self.session.frame() {
            // an error only means that there are no viewers
            let _ = self.frames.send(frame.into());
        }
        if !self.pending.is_empty() {
            let snapshot = Bytes::from(self.session.snapshot());
            for subscriber in self.pending.drain(..) {
                let _ = subscriber.send(Subscription { snapshot: snapshot.clone(), frames: self.frames.subscribe() });
            }
        }
    }
}
