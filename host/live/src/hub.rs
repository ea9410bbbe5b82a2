//! The hub: a thread that takes the samples of all sources, reduces them and hands them to the viewers.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use crate::sample::Sample;
use crate::shared::{Batch, Shared};
use crate::source::Source;
use crate::thinner::Thinner;
use crate::udp::Udp;

/// Parcels between run and hub: 32,768 samples, a second and a half at 20 kHz.
pub const PARCELS: usize = 512;
/// Interval between two batches: one and a half frames of a screen at 60 Hz.
const INTERVAL: Duration = Duration::from_millis(25);
/// Largest batch; larger ones would delay the first sample of a fast run.
const MAX_BATCH: usize = 512;

/// Parcel of a run.
pub enum Parcel {
    /// Samples of a source in rising time.
    Samples(Arc<Source>, Vec<Sample>),
    /// A source has ended.
    End(Arc<Source>),
}

/// Source as the hub sees it.
struct Inlet {
    source: Arc<Source>,
    thinner: Thinner,
    kept: Vec<Sample>,
}

/// Hub.
pub struct Hub {
    parcels: Receiver<Parcel>,
    shared: Arc<Shared>,
    udp: Option<Udp>,
    inlets: BTreeMap<u32, Inlet>,
}

impl Hub {
    /// Hub with its channel.
    pub fn new(parcels: Receiver<Parcel>, shared: Arc<Shared>, udp: Option<Udp>) -> Self {
        Self { parcels, shared, udp, inlets: BTreeMap::new() }
    }

    /// Runs until all feeds are closed; then tells the viewers that the run is over.
    pub fn run(mut self) {
        let mut flushed = Instant::now();
        loop {
            match self.parcels.recv_timeout(INTERVAL.saturating_sub(flushed.elapsed())) {
                Ok(Parcel::Samples(source, samples)) => self.take(source, samples),
                Ok(Parcel::End(source)) => self.end(source.number),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if flushed.elapsed() >= INTERVAL {
                flushed = Instant::now();
                self.inlets.values_mut().for_each(|inlet| inlet.flush(&self.shared, self.udp.as_mut()));
            }
        }
        let left: Vec<u32> = self.inlets.keys().copied().collect();
        left.into_iter().for_each(|number| self.end(number));
        self.shared.end();
    }

    fn take(&mut self, source: Arc<Source>, samples: Vec<Sample>) {
        let inlet = self.inlets.entry(source.number).or_insert_with(|| Inlet {
            source,
            thinner: Thinner::default(),
            kept: Vec::new(),
        });
        for sample in samples {
            inlet.thinner.push(sample, &mut inlet.kept);
        }
        if inlet.kept.len() >= MAX_BATCH {
            inlet.flush(&self.shared, self.udp.as_mut());
        }
    }

    fn end(&mut self, number: u32) {
        if let Some(mut inlet) = self.inlets.remove(&number) {
            inlet.thinner.finish(&mut inlet.kept);
            inlet.flush(&self.shared, self.udp.as_mut());
        }
    }
}

impl Inlet {
    fn flush(&mut self, shared: &Shared, udp: Option<&mut Udp>) {
        if self.kept.is_empty() {
            return;
        }
        let batch = Arc::new(Batch { source: self.source.clone(), samples: std::mem::take(&mut self.kept) });
        if let Some(udp) = udp {
            udp.send(&batch);
        }
        shared.hand_out(&batch);
    }
}
