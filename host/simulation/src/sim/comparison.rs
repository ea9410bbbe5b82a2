//! All schemes over one run: error of each scheme against the reference while the motion is predictable, and cost of
//! each scheme.

use std::sync::atomic::{AtomicU32, Ordering};

use model_core::gears::design::Substeps;
use serde::Serialize;

use super::errors::{DISTURBANCE, Errors, errors, is_constant, predictable, standard_deviation};
use super::scheme::SchemeName;
use super::snapshot::Snapshot;
use super::stepping::{self, RunEnd, SimulationSpec};
use report::failure::{Failure, Outcome};
use report::interruption;

/// Ticks of a cost measurement.
const COST_TICKS: u32 = 4000;
/// Rounds of cost measurements, with schemes in turn. The least cost counts, since other load of the machine only adds.
const COST_ROUNDS: usize = 5;

/// Sections of the run for the picture of the error.
const ERROR_SECTIONS: usize = 240;

/// Samples of the compared quantities by one scheme.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Scheme.
    pub scheme: SchemeName,
    /// End of the run.
    pub end: RunEnd,
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// Deflections of every mesh, then gap, then link offset; one list for each quantity [m, m, rad].
    pub columns: Vec<Vec<f64>>,
}

/// All schemes.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Tracks, the reference first.
    pub tracks: Vec<Track>,
    /// Number of samples in which the motion is predictable.
    pub predictable: usize,
    /// Rows of the table.
    pub rows: Vec<Row>,
}

/// One row of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Row {
    /// Name of the scheme.
    pub scheme: &'static str,
    /// Root mean square errors over the motion's standard deviation: deflections, gap, link offset [-].
    pub errors: [Option<f64>; 3],
    /// Processor time for each simulated second, over that of `realtime` in the same process [-].
    pub cost_ratio: f64,
    /// Processor time for each simulated second on this machine [s].
    pub cost_s_per_s: f64,
    /// Method of the sub-steps of a tick in which contacts change: `corrected` or `leapfrog`; null for schemes with a
    /// single method.
    pub method: Option<&'static str>,
    /// Number of sub-steps; null for the reference, which chooses its own steps.
    pub substeps: Option<u32>,
    /// Time at which the state stopped being finite [s].
    pub diverged_at_s: Option<f64>,
}

/// Runs all schemes and compares every `every`-th tick; `progress` receives the total of finished ticks.
pub fn compare(run: &SimulationSpec, every: u32, progress: &(dyn Fn(u32) + Sync)) -> Outcome<Comparison> {
    let done = AtomicU32::new(0);
    let tick = || progress(done.fetch_add(1, Ordering::Relaxed));
    let schemes = SchemeName::for_joint(&run.joint);
    let exact = schemes.iter().map(|scheme| (*scheme, 0.0));
    let jobs: Vec<(SchemeName, f64)> = std::iter::once((SchemeName::Reference, DISTURBANCE)).chain(exact).collect();
    let followed: Vec<Outcome<Track>> = std::thread::scope(|scope| {
        let threads: Vec<_> = jobs
            .iter()
            .map(|&(scheme, disturbance)| scope.spawn(move || record(run, every, scheme, disturbance, &tick)))
            .collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, _>| {
            thread.join().unwrap_or_else(|_| Err(Failure::new("a scheme has failed")))
        };
        threads.into_iter().map(join).collect()
    });
    let mut tracks = followed.into_iter().collect::<Outcome<Vec<_>>>()?;
    let disturbed = tracks.remove(0).columns;
    let costs = costs(run)?;
    let predictable = predictable(&tracks[0].columns, &disturbed);
    let board = schemes.iter().position(|scheme| *scheme == SchemeName::Realtime);
    let board = board.map_or(1.0, |board| costs[board]);
    let rows = tracks
        .iter()
        .zip(costs)
        .map(|(track, cost)| {
            let substeps = run.substeps(track.scheme);
            Row {
                scheme: track.scheme.name(),
                errors: errors(&tracks[0].columns, &track.columns, predictable),
                cost_ratio: cost / board,
                cost_s_per_s: cost,
                method: substeps.filter(|_| track.scheme == SchemeName::Realtime).map(Substeps::method),
                substeps: substeps.map(Substeps::count),
                diverged_at_s: track.end.diverged_at(run.tick_rate),
            }
        })
        .collect();
    Ok(Comparison { tracks, predictable, rows })
}

/// Errors of one scheme against the reference; `None` if the motion is unpredictable or the scheme breaks off.
pub fn errors_against_reference(run: &SimulationSpec, scheme: SchemeName) -> Outcome<Option<Errors>> {
    let track = |scheme, disturbance| record(run, 1, scheme, disturbance, &|| {});
    let exact = track(SchemeName::Reference, 0.0)?.columns;
    let samples = predictable(&exact, &track(SchemeName::Reference, DISTURBANCE)?.columns);
    let found = errors(&exact, &track(scheme, 0.0)?.columns, samples);
    Ok(if samples > 1 { Errors::from_values(found) } else { None })
}

impl Comparison {
    /// Times of the reference's samples [s].
    pub fn times(&self) -> &[f64] {
        &self.tracks[0].times
    }

    /// Returns true if no compared quantity moves: a relative error is then undefined.
    pub fn is_constant(&self) -> bool {
        self.tracks[0].columns.iter().all(|column| is_constant(column))
    }

    /// End of the compared time [s].
    pub fn predictable_until(&self) -> f64 {
        self.predictable.checked_sub(1).map_or(0.0, |last| self.times()[last])
    }

    /// Error of a track's first deflection over the standard deviation: root mean square of short sections, each at its
    /// middle [s].
    pub fn error_over_time(&self, track: &Track) -> Vec<(f64, f64)> {
        let exact = &self.tracks[0].columns[0][..self.predictable];
        let spread = standard_deviation(exact);
        let pairs: Vec<(f64, f64)> =
            exact.iter().zip(&track.columns[0]).zip(self.times()).map(|((a, b), time)| (*time, b - a)).collect();
        let section = self.predictable.div_ceil(ERROR_SECTIONS).max(1);
        pairs
            .chunks(section)
            .map(|part| {
                let square = part.iter().map(|(_, error)| error * error).sum::<f64>() / part.len() as f64;
                (0.5 * (part[0].0 + part[part.len() - 1].0), square.sqrt() / spread)
            })
            .collect()
    }
}

/// Runs a scheme and records the compared quantities.
fn record(
    run: &SimulationSpec,
    every: u32,
    scheme: SchemeName,
    disturbance: f64,
    tick: &(dyn Fn() + Sync),
) -> Outcome<Track> {
    let mut times = Vec::new();
    let mut columns = vec![Vec::new(); 2 * run.joint.geometry.planets + 2];
    let mut hook = |snapshot: &Snapshot| {
        if snapshot.tick.is_multiple_of(every) {
            times.push(snapshot.time);
            let values =
                snapshot.teeth.iter().map(|teeth| teeth.deflection).chain([snapshot.gap, snapshot.link_offset]);
            columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        tick();
        Ok(())
    };
    let end = stepping::simulate(run, scheme, disturbance, &mut hook)?;
    if end == RunEnd::Stopped {
        return Err(Failure::interrupted("stopped by the user"));
    }
    Ok(Track { scheme, end, times, columns })
}

/// Least of several measurements of each scheme, in the order of [`SchemeName::of_joint`].
fn costs(run: &SimulationSpec) -> Outcome<Vec<f64>> {
    let mut least: Vec<f64> = Vec::new();
    for round in 0..COST_ROUNDS {
        for (place, scheme) in SchemeName::for_joint(&run.joint).iter().enumerate() {
            let cost = stepping::cost(run, *scheme, COST_TICKS)?;
            match least.get_mut(place) {
                Some(best) if round > 0 => *best = best.min(cost),
                _ => least.push(cost),
            }
        }
        if interruption::requested() {
            return Err(Failure::interrupted("stopped by the user"));
        }
    }
    Ok(least)
}
