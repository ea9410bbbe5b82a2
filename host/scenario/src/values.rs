//! Values of the metrics of one run, from the true motion. `metrics` defines them; `observer_metrics` computes those of
//! the observer.

use std::collections::BTreeMap;

use model_core::gears::Kinematics;
use reference::closed_loop::{Figures as Plain, Sample, deviation};

use super::case::Case;
use super::controller::ControllerName;
use super::file::TestFile;
use super::metrics::{METRICS, Metric, NamedMetric, Relation};
use super::observer_metrics;
use super::run_history::{RunHistory, TrueValues};

/// Largest gain over another controller; division by zero error would give infinity.
const MAX_GAIN: f64 = 1e6;

/// Values of all metrics that could be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricValues(Vec<Option<f64>>);

impl MetricValues {
    /// Values for a run; `without_gap` is the run that an impedance's deviation is measured from.
    pub fn compute(file: &TestFile, case: &Case, history: &RunHistory, without_gap: Option<&RunHistory>) -> Self {
        let mut values = Self(vec![None; METRICS.len()]);
        values.motion(file, case, history);
        if let Some(other) = without_gap {
            let (rms, peak, torque) = deviation(&history.run, &other.run, file.settle);
            values.set("deviation_rms", 1e3 * rms);
            values.set("deviation_peak", 1e3 * peak);
            values.set("torque_error", torque);
        }
        if !history.observer_outputs.is_empty() {
            for (stem, value) in observer_metrics::values(file, case, history) {
                values.set(stem, value);
            }
        }
        if file.profile.kind == "hysteresis" {
            values.hysteresis(file, case, history);
        }
        values
    }

    /// Values from the figures of a record, which has every available one.
    pub fn from_figures(figures: &BTreeMap<String, f64>) -> Self {
        Self(METRICS.iter().map(|metric| figures.get(&metric.name()).copied()).collect())
    }

    /// Metrics and values that are available.
    pub fn available(&self) -> impl Iterator<Item = (&'static Metric, f64)> {
        METRICS.iter().zip(&self.0).filter_map(|(metric, value)| Some((metric, (*value)?)))
    }

    /// Value by the index of the metric.
    pub fn at(&self, index: usize) -> Option<f64> {
        self.0.get(index).copied().flatten()
    }

    /// Value of a metric relative to other controllers' values.
    pub fn named_value(&self, named: &NamedMetric, of: impl Fn(ControllerName) -> Option<MetricValues>) -> Option<f64> {
        let own = self.at(named.index())?;
        let ratio = |above: f64, below: f64| match (above, below) {
            (above, below) if above == below => 1.0,
            (above, 0.0) => above.signum() * MAX_GAIN,
            (above, below) => above / below,
        };
        match named.relation {
            Relation::Own => Some(own),
            Relation::GainOver(other) => Some(ratio(of(other)?.at(named.index())?, own)),
            Relation::Of(other) => of(other)?.at(named.index()),
            Relation::RatioTo(other) => Some(ratio(own, of(other)?.at(named.index())?)),
        }
    }

    fn set(&mut self, stem: &str, value: f64) {
        if let Some(index) = METRICS.iter().position(|metric| metric.stem == stem) {
            self.0[index] = value.is_finite().then_some(value);
        }
    }

    fn motion(&mut self, file: &TestFile, case: &Case, history: &RunHistory) {
        let plain = Plain::of(&history.run, file.settle);
        let joint = &case.truth.parameters;
        let rated = joint.rated_output_torque / (2.0 * joint.geometry.carrier_base_radius());
        let samples = || history.run.samples.iter().filter(|sample| sample.time >= file.settle);
        let count = samples().count().max(1) as f64;
        let limit = case.truth.surroundings.torque_limit;
        let at_limit = samples().filter(|sample| sample.command.abs() >= 0.9999 * limit).count() as f64;
        let end = history.run.samples.last().map_or(0.0, |sample| sample.time);
        self.set("rms", 1e3 * plain.rms);
        self.set("peak", 1e3 * plain.peak);
        self.set("peak_to_peak", 1e3 * plain.peak_to_peak);
        self.set("lost_motion", 1e3 * plain.lost_motion_time);
        self.set("longest_lost_motion", 1e3 * plain.longest_lost_motion);
        self.set("crossings", plain.crossings as f64);
        self.set("strikes", plain.strikes as f64);
        self.set("last_crossing", plain.last_crossing);
        self.set("quiet", end - plain.last_crossing.max(file.settle));
        self.set("peak_mesh_force", plain.peak_mesh_force);
        self.set("peak_mesh_force_ratio", plain.peak_mesh_force / rated);
        self.set("effort", plain.effort);
        self.set("peak_torque", samples().map(|sample| sample.command.abs()).fold(0.0, f64::max));
        self.set("saturated", 100.0 * at_limit / count);
        if let Some(error) = reversal_error(file.settle, case, history) {
            self.set("reversal_error", 1e3 * error);
        }
    }

    /// Loop of link angle minus motor motion over load torque.
    fn hysteresis(&mut self, file: &TestFile, case: &Case, history: &RunHistory) {
        let ratio = case.nominal.geometry.ratio_by_teeth();
        let points = || {
            history
                .run
                .samples
                .iter()
                .zip(&history.truths)
                .filter(|(sample, _)| sample.time >= file.settle)
                .map(|(sample, truth)| (transmitted(sample, truth), sample.link - truth.motor / ratio))
        };
        let largest = points().map(|(torque, _)| torque.abs()).fold(0.0, f64::max);
        let near = |from: f64, to: f64| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (torque, angle) in points().filter(|(torque, _)| (from..to).contains(torque)) {
                sum += angle;
                count += 1.0;
                debug_assert!(torque.is_finite());
            }
            (count > 0.0).then_some(sum / count)
        };
        let share = 0.03 * case.truth.parameters.rated_output_torque;
        let band = 0.5 * share;
        if let (Some(high), Some(low)) = (near(share - band, share + band), near(-share - band, -share + band)) {
            self.set("loop_lost_motion", 1e3 * (high - low).abs());
        }
        if let (Some(high), Some(half)) = (near(0.9 * largest, largest), near(0.45 * largest, 0.55 * largest)) {
            self.set("loop_stiffness", 0.45 * largest / (high - half).abs());
        }
    }
}

/// Time before and after a reversal in which the error is taken [s].
const REVERSAL_WINDOW: f64 = 0.06;

/// Largest error near each reversal, mean over reversals [rad].
fn reversal_error(settle: f64, case: &Case, history: &RunHistory) -> Option<f64> {
    let samples = &history.run.samples;
    let reach = (REVERSAL_WINDOW / history.run.period).round() as usize;
    let mut before = 0.0;
    let mut largest = Vec::new();
    for (index, sample) in samples.iter().enumerate() {
        let speed = case.motion.at(sample.time).speed;
        if speed * before < 0.0 && sample.time >= settle {
            let window = &samples[index.saturating_sub(reach)..(index + reach).min(samples.len())];
            largest.push(window.iter().map(|s| (s.wanted - s.link).abs()).fold(0.0, f64::max));
        }
        if speed != 0.0 {
            before = speed;
        }
    }
    (!largest.is_empty()).then(|| largest.iter().sum::<f64>() / largest.len() as f64)
}

/// Torque through the teeth, referred to the link.
fn transmitted(sample: &Sample, truth: &TrueValues) -> f64 {
    // Without a compliance no torque between carrier and link is computed, so the load takes its place.
    if sample.transmitted == 0.0 { truth.load_torque } else { sample.transmitted }
}
