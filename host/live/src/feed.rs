//! Feed of one source: the run's end of the channel. It never waits for a viewer.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::{Duration, Instant};

use report::interruption;

use crate::hub::Parcel;
use crate::pace::Pace;
use crate::sample::Sample;
use crate::shared::Shared;
use crate::source::Source;

/// Samples of a parcel: a channel of single samples would wake the hub too often.
const PARCEL: usize = 64;
/// Age of a parcel on the clock at which its next sample completes it. An age on the time of the run would make a run in
/// slow motion arrive in jerks.
const MAX_AGE: Duration = Duration::from_millis(10);
/// Longest sleep, so that Ctrl-C is heard.
const MAX_SLEEP: Duration = Duration::from_millis(20);

/// Feed of one source.
pub struct Feed {
    source: Arc<Source>,
    hub: SyncSender<Parcel>,
    shared: Arc<Shared>,
    parcel: Vec<Sample>,
    /// Moment of the first sample in the parcel.
    begun: Instant,
    pace: Option<Pace>,
    /// True if the feed holds the claim of a run on the view, which ends with the feed.
    is_claim: bool,
}

impl Feed {
    /// Feed of a source. With a speed, the run follows the clock at this multiple of its time.
    pub(crate) fn new(
        source: Arc<Source>,
        hub: SyncSender<Parcel>,
        shared: Arc<Shared>,
        speed: Option<f64>,
        is_claim: bool,
    ) -> Self {
        let begun = Instant::now();
        let pace = speed.map(|speed| Pace::starting(begun, speed));
        Self { source, hub, shared, parcel: Vec::new(), begun, pace, is_claim }
    }

    /// Publishes the sample of a period at a time of the run [s]; computes the sample only if it has a receiver.
    pub fn publish(&mut self, time: f64, sample: impl FnOnce() -> Sample) {
        if let Some(pace) = self.pace {
            self.wait(pace, time);
        }
        if !self.shared.has_receiver() {
            return;
        }
        if self.parcel.is_empty() {
            self.parcel.reserve_exact(PARCEL);
            self.begun = Instant::now();
        }
        self.parcel.push(sample());
        if self.parcel.len() == PARCEL || self.begun.elapsed() >= MAX_AGE {
            self.send();
        }
    }

    fn wait(&self, pace: Pace, time: f64) {
        let mut rest = pace.wait(time);
        while rest.as_millis() > 0 && !interruption::requested() {
            let sleep = rest.min(MAX_SLEEP);
            thread::sleep(sleep);
            self.shared.waited.fetch_add(sleep.as_nanos() as u64, Ordering::Relaxed);
            rest = pace.wait(time);
        }
    }

    fn send(&mut self) {
        let samples = std::mem::take(&mut self.parcel);
        let count = samples.len() as u64;
        if self.hub.try_send(Parcel::Samples(self.source.clone(), samples)).is_err() {
            self.shared.lost.fetch_add(count, Ordering::Relaxed);
        }
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        if !self.parcel.is_empty() {
            self.send();
        }
        let _ = self.hub.try_send(Parcel::End(self.source.clone()));
        if self.is_claim {
            self.shared.is_claimed.store(false, Ordering::Release);
        }
    }
}
