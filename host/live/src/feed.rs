//! Feed of one source: the run's end of the channel. It never waits for a viewer.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::{Duration, Instant};

use report::interruption;

use crate::hub::Parcel;
use crate::sample::Sample;
use crate::shared::Shared;
use crate::source::Source;

/// Samples of a parcel: a channel of single samples would wake the hub too often.
const PARCEL: usize = 64;
/// Longest time of a sample in an unfinished parcel, on the time of the run [s].
const MAX_AGE: f64 = 0.01;
/// Longest sleep, so that Ctrl-C is heard.
const MAX_SLEEP: Duration = Duration::from_millis(20);

/// Feed of one source.
pub struct Feed {
    source: Arc<Source>,
    hub: SyncSender<Parcel>,
    shared: Arc<Shared>,
    parcel: Vec<Sample>,
    pace: Option<Pace>,
    /// True for the feed of the only run that shows itself.
    is_claim: bool,
}

/// Pace of a run that follows the clock.
#[derive(Debug, Clone, Copy)]
struct Pace {
    start: Instant,
    speed: f64,
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
        let pace = speed.map(|speed| Pace { start: Instant::now(), speed });
        Self { source, hub, shared, parcel: Vec::new(), pace, is_claim }
    }

    /// Publishes the sample of a period at a time of the run [s]; computes it only if somebody watches.
    pub fn publish(&mut self, time: f64, sample: impl FnOnce() -> Sample) {
        if let Some(pace) = self.pace {
            self.wait(pace, time);
        }
        if !self.shared.is_watched() {
            return;
        }
        if self.parcel.is_empty() {
            self.parcel.reserve_exact(PARCEL);
        }
        self.parcel.push(sample());
        let first = self.parcel.first().map_or(time, |first| first.time);
        if self.parcel.len() == PARCEL || time - first >= MAX_AGE {
            self.send();
        }
    }

    fn wait(&self, pace: Pace, time: f64) {
        let due = pace.start + Duration::from_secs_f64((time / pace.speed).max(0.0));
        while let Some(rest) = due.checked_duration_since(Instant::now()).filter(|rest| rest.as_millis() > 0) {
            if interruption::requested() {
                return;
            }
            let sleep = rest.min(MAX_SLEEP);
            thread::sleep(sleep);
            self.shared.waited.fetch_add(sleep.as_nanos() as u64, Ordering::Relaxed);
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
