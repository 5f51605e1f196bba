//! One thread reads a device and distributes the samples to all readers.
//!
//! A reader that needs every sample (for example one that records a capture) uses a [`LosslessReader`], for which the
//! thread waits. If the reader is too slow, samples are lost before they reach the thread, and later samples count the
//! losses. The thread never waits for a [`Watcher`]. A watcher misses samples that do not fit into its queue, and
//! receives the number of missed samples.

use crate::pace::{Pace, Speed, WallClock};
use crate::source::{DeviceInfo, Losses, Source};
use crate::warning::SourceWarning;
use crate::{DeviceError, DeviceSpec, Result, Setup, Stop};
use adis16130_twin::Truth;
use anyhow::{Context, anyhow};
use std::iter::Peekable;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use std::vec::IntoIter;
use zerorate_record::admission::Admission;
use zerorate_record::{CaptureWarning, Row};

/// Largest number of samples in a batch: 0.7 s at the full rate.
const BATCH: usize = 4096;
/// Longest wall-clock time of a batch, unless the speed is unlimited. It limits the delay of a watcher's samples.
const LIVE_BATCH: Duration = Duration::from_millis(20);
/// Number of batches that can wait for a lossless reader.
const QUEUE: usize = 16;

/// Consecutive samples, with the warnings and the losses up to the last of them.
#[derive(Debug, Default)]
pub struct Batch {
    /// The samples in order of time, checked so that a capture can hold them.
    pub rows: Vec<Row>,
    /// The warnings since the previous batch.
    pub notes: Vec<SourceWarning>,
    /// The warnings about the timestamps of all samples so far.
    pub doubts: Vec<CaptureWarning>,
    /// Losses between the part and the hub since the device was opened.
    pub losses: Losses,
    /// The true state of each axis of a simulated part after the last sample; empty for any other device.
    pub truths: Vec<Truth>,
}

/// A thread that reads a device, and the subscriptions to its samples.
#[derive(Debug)]
pub struct Hub {
    facts: DeviceInfo,
    requests: Sender<Request>,
    shared: Shared,
    thread: Option<JoinHandle<()>>,
}

/// A subscription to every sample. The reading thread waits for this reader.
#[derive(Debug)]
pub struct LosslessReader(Receiver<BatchResult>);

/// A subscription that may miss samples. The reading thread never waits for this watcher.
#[derive(Debug)]
pub struct Watcher(Receiver<WatchedBatch>);

/// A batch for a watcher, with the number of samples that the watcher missed before the batch.
#[derive(Clone, Debug)]
pub struct WatchedBatch {
    /// The samples.
    pub batch: Arc<Batch>,
    /// Number of samples that were dropped before this batch because the queue was full.
    pub missed: u64,
    /// Number of samples that the dropped samples had counted as lost (sum of their [`Row::lost`]).
    pub lost: u64,
}

type BatchResult = Result<Arc<Batch>, DeviceError>;

/// The result of a wait with a timeout.
#[derive(Clone, Debug)]
pub enum Poll<T> {
    /// Samples came.
    Samples(T),
    /// No sample came before the timeout.
    Nothing,
    /// There are no more samples.
    End,
}

impl<T> Poll<T> {
    fn of(received: Result<T, RecvTimeoutError>) -> Self {
        match received {
            Ok(came) => Self::Samples(came),
            Err(RecvTimeoutError::Timeout) => Self::Nothing,
            Err(RecvTimeoutError::Disconnected) => Self::End,
        }
    }
}

#[derive(Debug)]
enum Subscriber {
    LosslessReader(SyncSender<BatchResult>),
    Watcher { queue: SyncSender<WatchedBatch>, missed: u64, lost: u64 },
}

type Work = Box<dyn FnOnce(&mut dyn Source) + Send>;

/// A request to the thread before it reads samples.
enum Request {
    Do(Work),
    Read { marks_ns: Vec<u64> },
}

impl Hub {
    /// Opens the device in a new thread. The part is initialised later, by [`Source::initialise`]. If `stop` is
    /// requested, the samples end without an error, as at the end of a recording.
    pub fn open(spec: &DeviceSpec, setup: Setup, stop: &Stop) -> Result<Self> {
        let (spec, inner) = (spec.clone(), stop.clone());
        Self::start(move || spec.open(&setup, &inner), stop)
    }

    /// Starts a hub for the source that `open` returns. The source is made in the thread of the hub, so it need not
    /// be `Send`.
    pub fn start(open: impl FnOnce() -> Result<Box<dyn Source>> + Send + 'static, stop: &Stop) -> Result<Self> {
        let (requests, wanted) = channel();
        let (tell, told) = channel();
        let shared = Shared { stop: stop.clone(), ..Shared::default() };
        let reading = shared.clone();
        let body = move || match open() {
            Ok(mut source) => {
                let _ = tell.send(Ok(source.facts()));
                reading.serve(source.as_mut(), &wanted);
            }
            Err(error) => drop(tell.send(Err(error))),
        };
        let thread =
            thread::Builder::new().name("hub".to_owned()).spawn(body).context("starting the reading thread")?;
        let facts = told.recv().map_err(|_| died())??;
        Ok(Self { facts, requests, shared, thread: Some(thread) })
    }

    /// The facts about the device, which do not change while it is read.
    #[must_use]
    pub fn facts(&self) -> &DeviceInfo {
        &self.facts
    }

    /// The stop that ends the reading.
    #[must_use]
    pub fn stop(&self) -> &Stop {
        &self.shared.stop
    }

    /// The speed of simulated or replayed time. [`Hub::read`] sets it first; afterwards it may be changed at any time.
    #[must_use]
    pub fn speed(&self) -> &Speed {
        &self.shared.speed
    }

    /// The error that ended the samples; `None` if the device did not fail.
    #[must_use]
    pub fn failure(&self) -> Option<DeviceError> {
        lock(&self.shared.failure).as_ref().map(DeviceError::again)
    }

    /// Runs `work` with the source in the reading thread. Call it before [`Hub::read`].
    ///
    /// # Errors
    /// Returns the error of `work`, or an error if the device is already being read.
    pub fn with<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut dyn Source) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let (tell, told) = channel();
        let request = Request::Do(Box::new(move |source| drop(tell.send(work(source)))));
        self.requests.send(request).map_err(|_| died())?;
        told.recv().map_err(|_| anyhow!("the device is being read already"))?
    }

    /// Subscribes to every sample from now on. Subscribe before [`Hub::read`] to get all samples.
    #[must_use]
    pub fn everything(&self) -> LosslessReader {
        let (queue, batches) = sync_channel(QUEUE);
        lock(&self.shared.subscribers).push(Subscriber::LosslessReader(queue));
        LosslessReader(batches)
    }

    /// Subscribes to samples from now on. Samples that do not fit into the queue of `queue` batches are missed.
    #[must_use]
    pub fn watch(&self, queue: usize) -> Watcher {
        let (queue, batches) = sync_channel(queue.max(1));
        lock(&self.shared.subscribers).push(Subscriber::Watcher { queue, missed: 0, lost: 0 });
        Watcher(batches)
    }

    /// Starts reading samples. Each of `marks_ns` ends a batch at the first sample whose time since the first sample
    /// is not less than the mark. The marks ascend. The `truths` of that batch belong to its last sample.
    ///
    /// # Errors
    /// Returns an error if the thread has ended.
    pub fn read(&self, pace: Pace, marks_ns: Vec<u64>) -> Result<()> {
        self.shared.speed.set(pace.factor());
        self.requests.send(Request::Read { marks_ns }).map_err(|_| died().into())
    }
}

impl Drop for Hub {
    fn drop(&mut self) {
        self.shared.ended.ask();
        let (closed, _) = channel();
        self.requests = closed;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

fn died() -> anyhow::Error {
    anyhow!("the reading thread has ended")
}

impl LosslessReader {
    /// Waits for the next batch. `None` at the end of a recording, after a stop, or if the hub was dropped.
    pub fn next(&self) -> Result<Option<Arc<Batch>>> {
        self.0.recv().map_or(Ok(None), |given| given.map(Some))
    }

    /// Waits for the next batch, for `patience` at most.
    pub fn next_within(&self, patience: Duration) -> Result<Poll<Arc<Batch>>> {
        Ok(match Poll::of(self.0.recv_timeout(patience)) {
            Poll::Samples(given) => Poll::Samples(given?),
            Poll::Nothing => Poll::Nothing,
            Poll::End => Poll::End,
        })
    }
}

impl Watcher {
    /// Waits for the next batch. `None` at the end; [`Hub::failure`] tells whether an error was the reason.
    #[must_use]
    pub fn next(&self) -> Option<WatchedBatch> {
        self.0.recv().ok()
    }

    /// Waits for the next batch, for `patience` at most. After the end, [`Hub::failure`] has the error, if any.
    #[must_use]
    pub fn next_within(&self, patience: Duration) -> Poll<WatchedBatch> {
        Poll::of(self.0.recv_timeout(patience))
    }
}

struct BatchBuilder {
    /// The wall clock that paces simulated or replayed time; `None` for a real device.
    clock: Option<WallClock>,
    /// Times since the first row at which a batch must end, ns.
    marks: Peekable<IntoIter<u64>>,
    admission: Admission,
    start_ns: Option<u64>,
}

impl BatchBuilder {
    /// Longest duration of a batch in the part's time, ns; `None` if the speed is unlimited.
    fn longest_ns(&self) -> Option<u64> {
        self.clock.as_ref().map_or(Some(LIVE_BATCH.as_nanos() as u64), |clock| clock.part_ns(LIVE_BATCH))
    }

    /// Fills a batch. Returns `None` if the batch is full, spans its longest duration, or reached a mark. Otherwise
    /// returns how reading ended.
    fn fill(&mut self, batch: &mut Batch, source: &mut dyn Source, is_over: impl Fn() -> bool) -> Option<Result<()>> {
        let longest_ns = self.longest_ns().unwrap_or(u64::MAX);
        loop {
            let row = match admitted(source, &mut self.admission) {
                Ok(Some(row)) if !is_over() => row,
                Ok(_) => return Some(Ok(())),
                Err(error) => return Some(Err(error)),
            };
            if let Some(clock) = &mut self.clock {
                clock.keep(row.t_ns, &is_over);
            }
            batch.rows.push(row);
            let since_ns = row.t_ns - *self.start_ns.get_or_insert(row.t_ns);
            let first_ns = batch.rows.first().map_or(row.t_ns, |first| first.t_ns);
            let is_marked = self.marks.next_if(|mark_ns| since_ns >= *mark_ns).is_some();
            let is_late = row.t_ns.saturating_sub(first_ns) >= longest_ns;
            if is_marked || is_late || batch.rows.len() == BATCH {
                return None;
            }
        }
    }
}

/// The state that the hub shares with its reading thread. The methods run in the thread.
#[derive(Clone, Debug, Default)]
struct Shared {
    subscribers: Arc<Mutex<Vec<Subscriber>>>,
    speed: Speed,
    /// The error that ended the reading; `None` without an error.
    failure: Arc<Mutex<Option<DeviceError>>>,
    stop: Stop,
    /// Set when the hub was dropped.
    ended: Stop,
}

impl Shared {
    /// Serves the requests until one of them starts the reading, reads until the end, and closes all subscriptions.
    fn serve(self, source: &mut dyn Source, wanted: &Receiver<Request>) {
        while let Ok(request) = wanted.recv() {
            match request {
                Request::Do(work) => work(source),
                Request::Read { marks_ns } => {
                    let clock = (!source.facts().is_real).then(|| WallClock::new(self.speed.clone()));
                    if let Err(error) = self.read(source, clock, marks_ns) {
                        self.fail(&error);
                    }
                    lock(&self.subscribers).clear();
                    return;
                }
            }
        }
    }

    fn read(&self, source: &mut dyn Source, clock: Option<WallClock>, marks_ns: Vec<u64>) -> Result<()> {
        let marks = marks_ns.into_iter().peekable();
        let mut builder = BatchBuilder { clock, marks, admission: Admission::default(), start_ns: None };
        loop {
            let mut batch = Batch::default();
            let end = builder.fill(&mut batch, source, || self.is_over());
            (batch.notes, batch.doubts) = (source.take_notes(), builder.admission.warnings().collect());
            (batch.losses, batch.truths) = (source.losses(), source.truths());
            let has_subscribers = self.give(batch);
            if let Some(end) = end {
                return end;
            }
            if !has_subscribers && builder.longest_ns().is_none() {
                return Ok(());
            }
        }
    }

    fn is_over(&self) -> bool {
        self.stop.asked() || self.ended.asked()
    }

    /// Sends a batch to all subscribers. Returns false if there are none left.
    fn give(&self, batch: Batch) -> bool {
        let batch = Arc::new(batch);
        // waits for lossless readers without the lock, so that new subscribers need not wait
        let mut subscribers = std::mem::take(&mut *lock(&self.subscribers));
        subscribers.retain_mut(|subscriber| subscriber.give(&batch, &self.ended));
        let mut all = lock(&self.subscribers);
        subscribers.append(&mut all);
        *all = subscribers;
        !all.is_empty()
    }

    /// Sends the error to lossless readers, and stores it for watchers ([`Hub::failure`]).
    fn fail(&self, error: &DeviceError) {
        *lock(&self.failure) = Some(error.again());
        for subscriber in std::mem::take(&mut *lock(&self.subscribers)) {
            if let Subscriber::LosslessReader(queue) = subscriber {
                wait_for_room(&queue, Err(error.again()), &self.ended);
            }
        }
    }
}

/// Waits until the queue has space, and sends. Returns false if the reader or the hub is gone.
fn wait_for_room(queue: &SyncSender<BatchResult>, given: BatchResult, ended: &Stop) -> bool {
    let mut given = given;
    loop {
        match queue.try_send(given) {
            Ok(()) => return true,
            Err(TrySendError::Full(back)) if !ended.asked() => given = back,
            Err(_) => return false,
        }
        thread::sleep(FULL_QUEUE);
    }
}

/// Sleep between attempts while a queue is full. The queue of a live device holds 0.3 s of samples.
const FULL_QUEUE: Duration = Duration::from_micros(200);

impl Subscriber {
    /// Sends a batch. Returns false if the subscriber is gone.
    fn give(&mut self, batch: &Arc<Batch>, ended: &Stop) -> bool {
        match self {
            Self::LosslessReader(queue) => wait_for_room(queue, Ok(Arc::clone(batch)), ended),
            Self::Watcher { queue, missed, lost } => {
                match queue.try_send(WatchedBatch { batch: Arc::clone(batch), missed: *missed, lost: *lost }) {
                    Ok(()) => (*missed, *lost) = (0, 0),
                    Err(TrySendError::Full(_)) => {
                        *missed += batch.rows.len() as u64;
                        *lost += batch.rows.iter().map(|row| u64::from(row.lost)).sum::<u64>();
                    }
                    Err(TrySendError::Disconnected(_)) => return false,
                }
                true
            }
        }
    }
}

/// Reads the next sample that is valid for a capture.
#[inline]
fn admitted(source: &mut dyn Source, admission: &mut Admission) -> Result<Option<Row>> {
    while let Some(row) = source.next()? {
        if let Some(admitted) = admission.admit(row)? {
            return Ok(Some(admitted));
        }
    }
    Ok(None)
}
