//! Computes the points of a shard in parallel and writes each to the journal as soon as it is done. The order of
//! completion does not change the result.

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

/// The computation at every point.
pub struct Work<'a> {
    /// The joint file that the grid changes.
    pub base: &'a Loaded,
    /// The grid.
    pub grid: &'a Grid,
    /// What moves the joint.
    pub motion: &'a MotionArguments,
    /// How.
    pub scheme: SchemeName,
    /// What is measured.
    pub metrics: &'a [Metric],
    /// How many at a time; none for as many as there are processors.
    pub threads: Option<u16>,
}

/// How the work ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WorkOutcome {
    /// Points computed and kept.
    pub finished: usize,
    /// Points whose joint cannot be.
    pub refused: usize,
    /// Why the first of them cannot be.
    pub remark: Option<String>,
}

impl Work<'_> {
    /// Computes points until all are done or the user wants to stop.
    pub fn run(&self, todo: &[u64], journal: &mut Journal, progress: &Progress) -> Outcome<WorkOutcome> {
        let threads = self.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
            Failure::new(format!("cannot start {threads} threads: {error}")).with_help("give fewer --threads")
        })?;
        let (sender, receiver) = mpsc::channel::<(u64, metrics::PointResult)>();
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let stop = &stop;
            // Points are taken one by one, so that no thread sits idle behind a slow one.
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
            let kept = keep(&receiver, journal, progress);
            stop.store(true, Ordering::Relaxed);
            kept
        })
    }

    fn point(&self, point: u64) -> Option<metrics::PointResult> {
        let joint = named::read_changed(self.base.name.clone(), self.base.text.clone(), &self.grid.changes(point));
        metrics::compute(joint, self.motion, self.scheme, self.metrics)
    }
}

/// Writes what comes, as many points at a time as have come meanwhile.
fn keep(
    receiver: &mpsc::Receiver<(u64, metrics::PointResult)>,
    journal: &mut Journal,
    progress: &Progress,
) -> Outcome<WorkOutcome> {
    let mut went = WorkOutcome::default();
    while let Ok(first) = receiver.recv() {
        let mut lines = String::new();
        let mut count = 0;
        for (point, result) in std::iter::once(first).chain(receiver.try_iter()) {
            let fields: Vec<&str> =
                std::iter::once(result.status).chain(result.values.iter().map(String::as_str)).collect();
            lines += &journal::line(point, &fields.join(","));
            count += 1;
            went.refused += usize::from(result.remark.is_some());
            went.remark = went.remark.or(result.remark);
        }
        journal.append(&lines).map_err(|failure| {
            let kept = format!(
                "{} points of this run are kept: free some space, then run the same command again",
                went.finished
            );
            failure.with_help(kept)
        })?;
        went.finished += count;
        progress.at(went.finished as u32);
    }
    Ok(went)
}
