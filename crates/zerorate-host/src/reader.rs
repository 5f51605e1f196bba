//! Reads samples in a separate thread.

use adis16130::Sample;
use anyhow::{Context, Result, anyhow};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};

/// Capacity of the queue in samples: 11.5 s at the full rate, 2.6 MB.
pub const QUEUE: usize = 1 << 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhenFull {
    /// Drop and count the sample, because reading the part cannot wait.
    Drop,
    /// Wait. The sender buffers or counts the samples that come meanwhile.
    Wait,
}

pub struct Reader {
    samples: Option<Receiver<Result<Sample>>>,
    overflowed: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

/// Waits for the end of the thread. The thread keeps the device open until then, so no other reader can open it.
impl Drop for Reader {
    fn drop(&mut self) {
        self.samples = None;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Reader {
    /// Starts reading with `next`, after calling `prepare` in the same thread. The thread ends with the first error,
    /// or when the reader is dropped. `length` is the capacity of the queue in samples.
    pub fn start(
        length: usize,
        when_full: WhenFull,
        prepare: impl FnOnce() + Send + 'static,
        next: impl FnMut() -> Result<Sample> + Send + 'static,
    ) -> Result<Self> {
        let (queue, samples) = sync_channel(length);
        let overflowed = Arc::new(AtomicU64::new(0));
        let feeder = Feeder { queue, when_full, overflowed: Arc::clone(&overflowed), owed: 0 };
        let body = move || {
            prepare();
            feeder.run(next);
        };
        let thread =
            thread::Builder::new().name("reader".to_owned()).spawn(body).context("starting the reading thread")?;
        Ok(Self { samples: Some(samples), overflowed, thread: Some(thread) })
    }

    /// Waits for the next sample, or for the error that ended the thread.
    pub fn next(&self) -> Result<Sample> {
        let sample = self.samples.as_ref().and_then(|samples| samples.recv().ok());
        sample.unwrap_or_else(|| Err(anyhow!("the reading thread has ended")))
    }

    /// Number of samples that were dropped because the queue was full. The next sample that fits counts them as lost.
    pub fn overflowed(&self) -> u64 {
        self.overflowed.load(Ordering::Relaxed)
    }
}

/// The sending end of the queue, in the reading thread.
struct Feeder {
    queue: SyncSender<Result<Sample>>,
    when_full: WhenFull,
    overflowed: Arc<AtomicU64>,
    /// Number of dropped samples, and of samples that these had counted as lost, that no sample has reported yet.
    owed: u32,
}

impl Feeder {
    fn run(mut self, mut next: impl FnMut() -> Result<Sample>) {
        loop {
            match next() {
                Ok(sample) => {
                    if !self.offer(sample) {
                        return;
                    }
                }
                Err(error) => {
                    // this may block, because nothing else will be read
                    let _ = self.queue.send(Err(error));
                    return;
                }
            }
        }
    }

    /// Sends a sample. Returns false if the receiver is gone. With [`WhenFull::Drop`], a sample that does not fit into
    /// the queue is dropped, and the next sample that fits counts it as lost.
    fn offer(&mut self, mut sample: Sample) -> bool {
        sample.lost = sample.lost.saturating_add(self.owed);
        if self.when_full == WhenFull::Wait {
            return self.queue.send(Ok(sample)).is_ok();
        }
        match self.queue.try_send(Ok(sample)) {
            Ok(()) => {
                self.owed = 0;
                true
            }
            Err(TrySendError::Full(_)) => {
                self.owed = sample.lost.saturating_add(1);
                self.overflowed.fetch_add(1, Ordering::Relaxed);
                true
            }
            Err(TrySendError::Disconnected(_)) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130::{RateCode, Width};
    use std::sync::mpsc::channel;

    #[test]
    fn a_full_queue_costs_samples_that_the_next_one_counts() {
        let (go_on, may_go_on) = channel();
        let mut seq = 0;
        let next = move || {
            seq += 1;
            match seq {
                // ten samples into a queue of four, then one more when the queue has room again
                1..=10 => {}
                11 => may_go_on.recv()?,
                _ => return Err(anyhow!("unplugged")),
            }
            let lost = u32::from(seq == 7);
            Ok(Sample { t_ns: 0, seq, rate: RateCode::new(8_388_608, Width::Bits24), status: None, temp: None, lost })
        };
        let reader = Reader::start(4, WhenFull::Drop, || (), next).expect("a thread");
        while reader.overflowed() < 6 {
            thread::yield_now();
        }
        let mut seen: Vec<_> = (0..4).map(|_| reader.next().expect("a sample")).collect();
        go_on.send(()).expect("a thread that waits");
        seen.push(reader.next().expect("a sample"));
        assert_eq!(seen.iter().map(|sample| sample.seq).collect::<Vec<_>>(), [1, 2, 3, 4, 11]);
        assert_eq!(seen.iter().map(|sample| sample.lost).collect::<Vec<_>>(), [0, 0, 0, 0, 7]);
        assert_eq!(reader.next().unwrap_err().to_string(), "unplugged");
        assert_eq!(reader.overflowed(), 6);
    }
}
