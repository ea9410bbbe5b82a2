//! Computes the points of a shard in parallel and writes each to the journal at once. The result does not depend on the
//! order of completion.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use rayon::prelude::*;

use super::grid::Grid;
use super::journal::{self, Journal};
use super::metrics::{self, Metric};
use crate::sim::arguments::MotionArguments;
use crate::sim::scheme::SchemeName;
use joint_file::named::{self, Loaded};
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

/// Computation of the points.
pub struct Work<'a> {
    /// Joint file that the grid changes.
    pub base: &'a Loaded,
    /// Grid.
    pub grid: &'a Grid,
    /// Motion of the joint.
    pub motion: &'a MotionArguments,
    /// Scheme.
    pub scheme: SchemeName,
    /// Metrics to compute.
    pub metrics: &'a [Metric],
    /// Number of threads; `None` for the number of processors.
    pub threads: Option<u16>,
}

/// Outcome of the work.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WorkOutcome {
    /// Points computed and stored.
    pub finished: usize,
    /// Points whose joint is rejected.
    pub refused: usize,
    /// Reason for the first rejection.
    pub remark: Option<String>,
}

impl Work<'_> {
    /// Computes points until all are done or the user stops the run.
    pub fn run(&self, todo: &[u64], journal: &mut Journal, progress: &Progress) -> Outcome<WorkOutcome> {
        let threads = self.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
            Failure::new(format!("cannot start {threads} threads: {error}")).with_help("give fewer --threads")
        })?;
        let (sender, receiver) = mpsc::channel::<(u64, metrics::PointResult)>();
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let stop = &stop;
            // Threads take points one by one, so that no thread idles behind a slow one.
            let next = AtomicUsize::new(0);
            scope.spawn(move || {
                pool.install(|| {
                    (0..pool.current_num_threads()).into_par_iter().for_each_with(sender, |sender, _| {
                        while let Some(&point) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
                            if stop.load(Ordering::Relaxed) || interruption::requested() {
                                break;
                            }
                            let Some(result) = self.point(point) else { break };
                            if sender.send((point, result)).is_err() {
                                break;
                            }
                        }
                    });
                });
            });
            let kept = store(&receiver, journal, progress);
            stop.store(true, Ordering::Relaxed);
            kept
        })
    }

    fn point(&self, point: u64) -> Option<metrics::PointResult> {
        let joint = named::read_changed(self.base.name.clone(), self.base.text.clone(), &self.grid.changes(point));
        metrics::compute(joint, self.motion, self.scheme, self.metrics)
    }
}

/// Writes finished points to the journal, all available ones at a time.
fn store(
    receiver: &mpsc::Receiver<(u64, metrics::PointResult)>,
    journal: &mut Journal,
    progress: &Progress,
) -> Outcome<WorkOutcome> {
    let mut outcome = WorkOutcome::default();
    while let Ok(first) = receiver.recv() {
        let mut lines = String::new();
        let mut count = 0;
        for (point, result) in std::iter::once(first).chain(receiver.try_iter()) {
            let fields: Vec<&str> =
                std::iter::once(result.status).chain(result.values.iter().map(String::as_str)).collect();
            lines += &journal::line(point, &fields.join(","));
            count += 1;
            outcome.refused += usize::from(result.remark.is_some());
            outcome.remark = outcome.remark.or(result.remark);
        }
        journal.append(&lines).map_err(|failure| {
            let kept = format!(
                "{} points of this run are kept: free some space, then run the same command again",
                outcome.finished
            );
            failure.with_help(kept)
        })?;
        outcome.finished += count;
        progress.set_position(outcome.finished as u32);
    }
    Ok(outcome)
}
