//! Swings of the output from one turning point to the next, each with one reversal of the torque on its way.

use crate::quasi_static::passes::turning_points;
use crate::statistics::{quantile_of, range_of};

/// Motion back from a turning point that confirms the turn: share of the range, and counts; the larger applies.
const TURN_SHARE: f64 = 0.001;
const TURN_COUNTS: f64 = 6.0;
/// Least torque whose sign is used, over the largest torque [-].
const SIGN_TORQUE_SHARE: f64 = 0.1;
/// Share of each half of a swing excluded next to its turning point, where friction sticks [-].
const TURN_EXCLUDED_SHARE: f64 = 0.1;
/// Share of the half after the reversal excluded while the motor crosses the gap [-]. Tuned: 0.2 moves no finding by a
/// tenth of its interval.
const SETTLING_SHARE: f64 = 0.1;
/// Fewest samples, and smallest motion of the output in counts, on either side of a reversal.
const SIDE_SAMPLES_MIN: usize = 8;
const SIDE_COUNTS_MIN: f64 = 8.0;
/// A steady torque is at least this share of its median on either side of the reversal,
const STEADY_SHARE: f64 = 0.5;
/// except in this share of the samples, in which a measured torque rises.
const RISE_SHARE: f64 = 0.08;

/// One swing with a reversal.
#[derive(Debug, Clone, PartialEq)]
pub struct Swing {
    /// Direction of the output: 1 or -1.
    pub direction: f64,
    /// First sample with the new torque.
    pub reversal: usize,
    /// Samples between the turning point and the reversal.
    pub before: [usize; 2],
    /// Samples between the reversal and the next turning point.
    pub after: [usize; 2],
    /// Magnitude of the torque before and after the reversal, at the output [N m].
    pub torque: [f64; 2],
}

impl Swing {
    /// Returns the samples that the fit uses.
    pub fn samples(&self) -> impl Iterator<Item = usize> {
        let start = self.after[0] + ((self.after[1] - self.after[0]) as f64 * SETTLING_SHARE).ceil() as usize;
        (self.before[0]..self.before[1]).chain(start..self.after[1])
    }
}

/// Finds the swings in which a steady torque along the motion steps to a steady torque against it.
pub fn swings(angle: &[f64], torque: &[f64], count: f64) -> Vec<Swing> {
    let turns = turning_points(angle, (TURN_SHARE * range_of(angle)).max(TURN_COUNTS * count));
    let largest = quantile_of(&torque.iter().map(|torque| torque.abs()).collect::<Vec<_>>(), 0.98);
    turns
        .windows(2)
        .filter_map(|turns| swing([turns[0], turns[1]], angle, torque, [count, SIGN_TORQUE_SHARE * largest]))
        .collect()
}

fn swing([from, to]: [usize; 2], angle: &[f64], torque: &[f64], [count, least_torque]: [f64; 2]) -> Option<Swing> {
    let direction = (angle[to] - angle[from]).signum();
    let along = |sample: usize| direction * torque[sample];
    // The torque may be opposite at the start and the end of a swing.
    let reversal = (from..to)
        .find(|sample| *sample > from && along(*sample) < -least_torque && along(*sample - 1) > -least_torque)?;
    let inside = |samples: usize| ((samples as f64 * TURN_EXCLUDED_SHARE).ceil() as usize).min(samples);
    let before = [from + inside(reversal - from), reversal];
    let after = [reversal, to - inside(to - reversal)];
    let steady = |[start, end]: [usize; 2], side: f64| {
        let torques: Vec<f64> = (start..end).map(|sample| side * along(sample)).collect();
        let median = quantile_of(&torques, 0.5);
        let weak = torques.iter().filter(|torque| **torque < STEADY_SHARE * median).count();
        (median > least_torque && weak as f64 <= RISE_SHARE * torques.len() as f64).then_some(median)
    };
    let has_enough = |[start, end]: [usize; 2]| {
        end >= start + SIDE_SAMPLES_MIN && (angle[end - 1] - angle[start]).abs() > SIDE_COUNTS_MIN * count
    };
    let swing = Swing { direction, reversal, before, after, torque: [steady(before, 1.0)?, steady(after, -1.0)?] };
    let later = swing.samples().filter(|sample| *sample >= reversal).count();
    (has_enough(before) && has_enough(after) && later >= SIDE_SAMPLES_MIN).then_some(swing)
}
