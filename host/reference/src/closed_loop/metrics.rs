//! Figures of merit of a run, computed from the true motion.

use super::{Run, Sample};

/// Share of the half-gap from which a flank counts as touching; below 1 by mesh deflection and transmission error.
const TOUCH_SHARE: f64 = 0.9;

/// Share of the half-gap below which a flank counts as left: a shorter bounce belongs to the strike before it. Chosen.
const RELEASE_SHARE: f64 = 0.8;

/// Figures of merit of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Figures {
    /// RMS error of the link position [rad].
    pub rms: f64,
    /// [rad].
    pub peak: f64,
    /// Peak-to-peak error of the link position [rad].
    pub peak_to_peak: f64,
    /// Changes from one flank to the other.
    pub crossings: usize,
    /// Landings on either flank, including the flank that was left.
    pub strikes: usize,
    /// Mean time from leaving one flank to touching the other [s].
    pub lost_motion_time: f64,
    /// Longest time from leaving one flank to touching the other [s].
    pub longest_lost_motion: f64,
    /// Time of the last crossing [s].
    pub last_crossing: f64,
    /// Largest net force of the sun's meshes [N].
    pub peak_mesh_force: f64,
    /// RMS of the commanded torque [N m].
    pub effort: f64,
}

impl Figures {
    /// Computes the figures from `from` on [s].
    pub fn of(run: &Run, from: f64) -> Self {
        Self::between(run, from, f64::INFINITY)
    }

    /// Computes the figures between two times [s].
    pub fn between(run: &Run, from: f64, to: f64) -> Self {
        let samples: Vec<Sample> =
            run.samples.iter().filter(|sample| (from..to).contains(&sample.time)).copied().collect();
        let count = samples.len().max(1) as f64;
        let error = |sample: &Sample| sample.wanted - sample.link;
        let mean_square = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(|s| of(s).powi(2)).sum::<f64>() / count;
        let largest = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).fold(f64::MIN, f64::max);
        let mut figures = Self {
            rms: mean_square(&error).sqrt(),
            peak: largest(&|s| error(s).abs()),
            peak_to_peak: largest(&error) + largest(&|s| -error(s)),
            peak_mesh_force: largest(&|s| s.mesh_force.abs()),
            effort: mean_square(&|s| s.command).sqrt(),
            ..Self::default()
        };
        figures.count_crossings(&samples);
        figures.strikes = strikes(&samples);
        figures
    }

    fn count_crossings(&mut self, samples: &[Sample]) {
        let mut touched: Option<(f64, f64)> = None;
        let mut total = 0.0;
        for sample in samples.iter().filter(|sample| sample.gap.abs() > TOUCH_SHARE) {
            let side = sample.gap.signum();
            if let Some((before, since)) = touched
                && before != side
            {
                let took = sample.time - since;
                self.crossings += 1;
                self.last_crossing = sample.time;
                self.longest_lost_motion = self.longest_lost_motion.max(took);
                total += took;
            }
            touched = Some((side, sample.time));
        }
        if self.crossings > 0 {
            self.lost_motion_time = total / self.crossings as f64;
        }
    }
}

/// Counts landings on a flank after a flank was left.
fn strikes(samples: &[Sample]) -> usize {
    let (mut free, mut strikes) = (false, 0);
    for sample in samples {
        let gap = sample.gap.abs();
        if free && gap > TOUCH_SHARE {
            (free, strikes) = (false, strikes + 1);
        }
        free |= gap < RELEASE_SHARE;
    }
    strikes
}

/// Deviation of a run from another run of an equal motion: link position RMS and peak [rad], and RMS of the torque
/// between carrier and link [N m].
pub fn deviation(run: &Run, from_run: &Run, from: f64) -> (f64, f64, f64) {
    let pairs = run.samples.iter().zip(&from_run.samples).filter(|(sample, _)| sample.time >= from);
    let (mut count, mut squares, mut peak, mut torques) = (0.0_f64, 0.0, 0.0_f64, 0.0);
    for (sample, other) in pairs {
        let error = sample.link - other.link;
        count += 1.0;
        squares += error * error;
        peak = peak.max(error.abs());
        torques += (sample.transmitted - other.transmitted).powi(2);
    }
    ((squares / count.max(1.0)).sqrt(), peak, (torques / count.max(1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strike_is_landing_after_leaving_flank() {
        let of = |gaps: &[f64]| {
            let samples: Vec<Sample> = gaps.iter().map(|gap| Sample { gap: *gap, ..Sample::default() }).collect();
            (strikes(&samples), Figures::of(&Run { samples, period: 1.0 }, 0.0).crossings)
        };
        assert_eq!(of(&[1.0, 0.0, -1.0]), (1, 1), "a crossing is one strike");
        assert_eq!(of(&[1.0, 0.5, 1.0, 0.7, 1.0]), (2, 0), "bounces on one flank are strikes and no crossings");
        assert_eq!(of(&[1.0, 0.85, 1.0]), (0, 0), "a flank that is hardly left is not struck");
        assert_eq!(of(&[0.0, 0.3, -0.5]), (0, 0), "teeth that stay in the gap strike nothing");
    }
}
