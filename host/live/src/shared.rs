//! State that run, hub and viewers share.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::sample::Sample;
use crate::source::Source;

/// Carries out a command, a line of JSON; returns the answer, or `None` once the run is over.
pub type Commands = Arc<dyn Fn(String) -> Option<String> + Send + Sync>;

/// Samples of one source after the reduction.
#[derive(Debug)]
pub struct Batch {
    /// Source.
    pub source: Arc<Source>,
    /// Samples in rising time.
    pub samples: Vec<Sample>,
}

/// Item in the queue of a viewer.
#[derive(Debug, Clone)]
pub enum Item {
    /// A source that the viewer does not know yet.
    Source(Arc<Source>),
    /// Samples.
    Batch(Arc<Batch>),
    /// The run is over.
    End,
}

/// Queue of a viewer.
pub struct Outlet {
    /// Queue; a full one drops its items.
    pub items: SyncSender<Item>,
    /// Number of the last source that the viewer was told of, by identifier.
    pub known: Vec<(u8, u32)>,
    /// Samples that the viewer lost.
    pub lost: Arc<AtomicU64>,
}

/// State that run, hub and viewers share.
#[derive(Default)]
pub struct Shared {
    /// Queues of the connected viewers. The run never locks them.
    outlets: Mutex<Vec<Outlet>>,
    /// Connected viewers.
    pub viewers: AtomicUsize,
    /// True if samples go to PlotJuggler, which need not be there.
    pub has_udp: AtomicBool,
    /// Connections, also of those that are no viewers yet.
    pub connections: AtomicUsize,
    /// Samples that the run could not hand over.
    pub lost: AtomicU64,
    /// Sources so far.
    pub sources: AtomicU32,
    /// Time that the run has waited for the clock [ns].
    pub waited: AtomicU64,
    /// True while one of several parallel runs has claimed the view.
    pub is_claimed: AtomicBool,
    /// True once the view ends.
    pub is_ending: AtomicBool,
}

impl Shared {
    /// True while samples have a receiver: a viewer or PlotJuggler.
    pub fn has_receiver(&self) -> bool {
        self.has_viewer() || self.has_udp.load(Ordering::Relaxed)
    }

    /// True while a viewer is connected.
    pub fn has_viewer(&self) -> bool {
        self.viewers.load(Ordering::Relaxed) > 0
    }

    /// Adds the queue of a viewer.
    pub fn add(&self, outlet: Outlet) {
        self.lock().push(outlet);
        self.viewers.fetch_add(1, Ordering::Relaxed);
    }

    /// Hands a batch to every viewer; removes the queues of viewers that left.
    pub fn hand_out(&self, batch: &Arc<Batch>) {
        self.remove(&mut self.lock(), |outlet| outlet.has_left(batch));
    }

    /// Tells every viewer that the run is over, and forgets it.
    pub fn end(&self) {
        let over = |outlet: &mut Outlet| {
            let _ = outlet.items.try_send(Item::End);
            true
        };
        self.remove(&mut self.lock(), over);
    }

    fn remove(&self, outlets: &mut Vec<Outlet>, gone: impl FnMut(&mut Outlet) -> bool) {
        let removed = outlets.extract_if(.., gone).count();
        self.viewers.fetch_sub(removed, Ordering::Relaxed);
    }

    /// A panic in another thread leaves the list consistent.
    fn lock(&self) -> MutexGuard<'_, Vec<Outlet>> {
        self.outlets.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Time that the run has waited for the clock.
    pub fn waited(&self) -> Duration {
        Duration::from_nanos(self.waited.load(Ordering::Relaxed))
    }
}

impl Outlet {
    /// Offers a batch to the viewer, which loses it if its queue is full; returns true once the viewer has left.
    fn has_left(&mut self, batch: &Arc<Batch>) -> bool {
        let offered = self.introduce(&batch.source).and_then(|()| self.items.try_send(Item::Batch(batch.clone())));
        match offered {
            Ok(()) => false,
            Err(TrySendError::Full(_)) => {
                self.lost.fetch_add(batch.samples.len() as u64, Ordering::Relaxed);
                false
            }
            Err(TrySendError::Disconnected(_)) => true,
        }
    }

    /// Tells the viewer of a source, once.
    fn introduce(&mut self, source: &Arc<Source>) -> Result<(), TrySendError<Item>> {
        let (id, number) = (source.description.id, source.number);
        if !self.known.contains(&(id, number)) {
            self.items.try_send(Item::Source(source.clone()))?;
            self.known.retain(|(known, _)| *known != id);
            self.known.push((id, number));
        }
        Ok(())
    }
}
