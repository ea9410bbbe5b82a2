//! An absolute encoder: the past of an angle, its errors, its counts.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use parameters::AbsoluteEncoder;

use super::parameters::ErrorPhases;

#[derive(Debug, Clone, Copy)]
struct Point {
    time: f64,
    angle: f64,
    speed: f64,
}

/// An encoder and as much of the past as its skew needs.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    parameters: AbsoluteEncoder,
    phases: ErrorPhases,
    past: VecDeque<Point>,
}

impl Encoder {
    pub fn new(parameters: AbsoluteEncoder, phases: ErrorPhases) -> Self {
        Self { parameters, phases, past: VecDeque::new() }
    }

    /// Notes where the shaft is; times must rise.
    pub fn note(&mut self, time: f64, angle: f64, speed: f64) {
        self.past.push_back(Point { time, angle, speed });
        // One point at or before the moment that is read now, the rest after it.
        while self.past.len() > 2 && self.past[1].time <= time - self.parameters.skew {
            self.past.pop_front();
        }
    }

    /// Counts since angle zero, whole turns included.
    pub fn counts(&self) -> i64 {
        let angle = self.angle_then();
        let once = self.parameters.once_per_turn_error * (angle + self.phases.once_per_turn).sin();
        let twice = self.parameters.twice_per_turn_error * (2.0 * angle + self.phases.twice_per_turn).sin();
        let counts_per_turn = f64::from(1_u32 << self.parameters.bits);
        ((angle + once + twice) / TAU * counts_per_turn).floor() as i64
    }

    /// The angle when the reading was taken: the cubic between the two nearest points.
    fn angle_then(&self) -> f64 {
        let Some(last) = self.past.back() else { return 0.0 };
        let then = last.time - self.parameters.skew;
        let after = self.past.partition_point(|point| point.time <= then);
        let (Some(from), Some(to)) =
            (after.checked_sub(1).and_then(|index| self.past.get(index)), self.past.get(after))
        else {
            // No skew: the last point itself. Before the start: it stood where it started.
            return if after == 0 { self.past[0].angle } else { last.angle };
        };
        let width = to.time - from.time;
        let fraction = (then - from.time) / width;
        let rest = 1.0 - fraction;
        from.angle * rest * rest * (1.0 + 2.0 * fraction)
            + to.angle * fraction * fraction * (1.0 + 2.0 * rest)
            + width * fraction * rest * (from.speed * rest - to.speed * fraction)
    }
}
