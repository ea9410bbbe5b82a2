//! A run thinned for pictures: a point each millisecond, and each crossing of the gap. Metrics are never computed from
//! a trace.

use super::run_history::{ObserverOutput, RunHistory, TrueValues};
use reference::closed_loop::Sample;

/// One point of a trace.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TracePoint {
    /// Time [s].
    pub time: f32,
    /// Desired angle [rad].
    pub wanted: f32,
    /// Desired minus actual link angle [rad].
    pub error: f32,
    /// Gap coordinate [m].
    pub gap: f32,
    /// Estimated gap coordinate [m]; NaN without an observer.
    pub estimated_gap: f32,
    /// Motor torque [N m].
    pub torque: f32,
    /// Largest net force of the sun's meshes in this millisecond [N].
    pub force: f32,
}

/// A thinned run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// Points, a thousand a second.
    pub points: Vec<TracePoint>,
    /// Time of each contact with the other flank, and duration of the crossing [s].
    pub crossings: Vec<(f64, f64)>,
    /// Half of the free gap at the end [m].
    pub half_gap: f64,
}

/// Points a second [Hz].
const RATE: f64 = 1000.0;

/// Share of the half-gap above which a flank counts as touched [-].
const TOUCH_SHARE: f64 = 0.9;

impl Trace {
    /// Trace with bins of points reduced to those of least and greatest error: enough for a whole run.
    pub fn coarse(&self, bin: usize) -> Self {
        let ends = |points: &[TracePoint]| {
            let by_error = |a: &&TracePoint, b: &&TracePoint| a.error.total_cmp(&b.error);
            let force = points.iter().map(|point| point.force).fold(0.0, f32::max);
            let mut both: Vec<TracePoint> =
                points.iter().min_by(by_error).into_iter().chain(points.iter().max_by(by_error)).copied().collect();
            both.sort_by(|a, b| a.time.total_cmp(&b.time));
            both.dedup();
            both.iter_mut().for_each(|point| point.force = force);
            both
        };
        Self { points: self.points.chunks(bin.max(1)).flat_map(ends).collect(), ..self.clone() }
    }

    /// Trace of a run.
    pub fn from_history(history: &RunHistory) -> Self {
        let point =
            |(sample, truth, observed, peak): (&Sample, &TrueValues, Option<&ObserverOutput>, f64)| TracePoint {
                time: sample.time as f32,
                wanted: sample.wanted as f32,
                error: (sample.wanted - sample.link) as f32,
                gap: truth.gap as f32,
                estimated_gap: observed.map_or(f32::NAN, |observed| observed.gap),
                torque: sample.command as f32,
                force: peak as f32,
            };
        let mut trace = Self {
            points: history.samples_at(RATE).map(point).collect(),
            crossings: Vec::new(),
            half_gap: history.truths.last().map_or(0.0, |truth| 2.0 * truth.half_backlash),
        };
        let mut touched = None::<(f64, f64)>;
        for sample in history.run.samples.iter().filter(|sample| sample.gap.abs() > TOUCH_SHARE) {
            let side = sample.gap.signum();
            if let Some((_, since)) = touched.filter(|(before, _)| *before != side) {
                trace.crossings.push((sample.time, sample.time - since));
            }
            touched = Some((side, sample.time));
        }
        trace
    }
}
