//! Sampled trajectory of the reference through a case, and the error of another motion against it. The other motion may be sampled more
//! coarsely.

use parameters::Excitation;
use reference::joint::{Reference, ReferenceError, RelativeState, Start};

use crate::case::Case;
use crate::reading::Reading;

/// Motion of the reference.
#[derive(Debug, Clone)]
pub struct ReferenceTrajectory {
    /// Samples from time zero on, at `sample_rate`.
    samples: Vec<Reading>,
    /// States at the restarts of the case.
    restarts: Vec<Restart>,
    /// First evaluated sample.
    first: usize,
    /// Sample at which each part of the case begins.
    parts: Vec<usize>,
    /// Standard deviation of all evaluated deflections.
    deviation: f64,
    lost_motion: f64,
}

/// State of the reference to which a method is reset.
#[derive(Debug, Clone, PartialEq)]
pub struct Restart {
    /// Tick of the case at whose beginning the method is reset.
    pub tick: u64,
    /// State without the rigid carrier's angle.
    pub state: RelativeState,
    /// Angle of the rigid carrier [turns].
    pub turns: f64,
}

/// Errors of a motion against the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// RMS over all deflections, over their standard deviation; NaN for a model without meshes.
    pub deflections: f64,
    /// RMS error of the link angle over the lost motion.
    pub link_rms: f64,
    /// Worst error of the link angle over the lost motion.
    pub link_worst: f64,
    /// Relative error of the largest mesh force; the worst over the parts of the case.
    pub peak_force: f64,
}

impl Errors {
    /// Zero errors.
    pub const NONE: Self = Self { deflections: 0.0, link_rms: 0.0, link_worst: 0.0, peak_force: 0.0 };

    /// Worse of both, figure by figure; NaN is worst.
    pub fn worst_of(&self, other: &Self) -> Self {
        let worse = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        Self {
            deflections: worse(self.deflections, other.deflections),
            link_rms: worse(self.link_rms, other.link_rms),
            link_worst: worse(self.link_worst, other.link_worst),
            peak_force: worse(self.peak_force, other.peak_force),
        }
    }
}

impl ReferenceTrajectory {
    /// Runs the reference through a case.
    pub fn new(case: &Case) -> Result<Self, ReferenceError> {
        Self::from(case, &case.start)
    }

    /// Runs the reference through a case from another start.
    pub fn from(case: &Case, start: &Start) -> Result<Self, ReferenceError> {
        let mut reference = Reference::start(&case.joint, start)?;
        let whole = matches!(case.joint.excitation, Excitation::Angle);
        let length = case.joint.characteristic_length;
        let mut changes = case.torques.iter().peekable();
        let (mut drive, mut load) = (0.0, 0.0);
        let count = (case.duration() * f64::from(case.sample_rate)).floor() as usize;
        let mut samples = Vec::with_capacity(count + 1);
        let mut due = case.restarts.iter().peekable();
        let mut restarts = Vec::with_capacity(case.restarts.len());
        for index in 0..=count {
            let time = index as f64 / f64::from(case.sample_rate);
            let begins = |tick: u64| tick as f64 / f64::from(case.tick_rate);
            // Changes at the time of a sample take effect after it.
            while let Some(change) = changes.next_if(|change| begins(change.from_tick) < time) {
                reference.advance(begins(change.from_tick), drive, load)?;
                (drive, load) = (change.drive_torque, change.load_torque);
            }
            reference.advance(time, drive, load)?;
            let now = reference.observe();
            // Restarts are ticks, and ticks coincide with samples where there are restarts.
            while let Some(tick) = due.next_if(|tick| begins(**tick) <= time) {
                restarts.push(Restart { tick: *tick, state: RelativeState::of(&now), turns: now.rigid_turns });
            }
            samples.push(Reading {
                deflections: now.deflections.iter().flatten().map(|value| value / length).collect(),
                link_angle: if whole { now.link_angle } else { now.link_offset },
                mesh_force: now.mesh_forces.iter().flatten().fold(0.0, |peak: f64, force| peak.max(force.abs())),
            });
        }
        let first = (case.counts_from * f64::from(case.sample_rate)).ceil() as usize;
        let counted = samples.get(first..).unwrap_or_default();
        let values: Vec<f64> = counted.iter().flat_map(|sample| sample.deflections.iter().copied()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let sample = |tick: &u64| (tick * u64::from(case.sample_rate) / u64::from(case.tick_rate)) as usize;
        let parts = case.parts.iter().map(sample).collect();
        Ok(Self { restarts, first, parts, deviation, lost_motion: case.lost_motion(), samples })
    }

    /// States to which a method is reset.
    pub fn restarts(&self) -> &[Restart] {
        &self.restarts
    }

    /// Samples from time zero on.
    pub fn samples(&self) -> &[Reading] {
        &self.samples
    }

    /// Returns true if a sample is evaluated.
    pub fn counts(&self, sample: usize) -> bool {
        sample >= self.first && sample < self.samples.len()
    }

    /// Errors of readings against the reference, each with the index of its sample. Infinite for a diverged motion.
    pub fn errors(&self, motion: &[(usize, Reading)]) -> Errors {
        let (mut squares, mut values) = (0.0, 0_usize);
        let (mut link_squares, mut link_worst, mut counted) = (0.0, 0.0_f64, 0_usize);
        let mut peaks = vec![(0.0_f64, 0.0_f64); self.parts.len()];
        for (sample, found) in motion.iter().filter(|(sample, _)| self.counts(*sample)) {
            let right = &self.samples[*sample];
            for (found, right) in found.deflections.iter().zip(&right.deflections) {
                squares += (found - right).powi(2);
                values += 1;
            }
            let error = (found.link_angle - right.link_angle) / self.lost_motion;
            link_squares += error * error;
            // `max` would ignore NaN.
            link_worst = if error.abs() <= link_worst { link_worst } else { error.abs() };
            counted += 1;
            // The sample at which a part begins is the last of the part before.
            let part = self.parts.partition_point(|first| first < sample).saturating_sub(1);
            if let Some((peak, right_peak)) = peaks.get_mut(part) {
                *peak = peak.max(found.mesh_force);
                *right_peak = right_peak.max(right.mesh_force);
            }
        }
        let off = |(peak, right): &(f64, f64)| if peak == right { 0.0 } else { (peak / right - 1.0).abs() };
        let finite = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        Errors {
            deflections: if values == 0 { f64::NAN } else { finite((squares / values as f64).sqrt() / self.deviation) },
            link_rms: finite((link_squares / counted as f64).sqrt()),
            link_worst: finite(link_worst),
            peak_force: finite(peaks.iter().map(off).fold(0.0, f64::max)),
        }
    }
}
