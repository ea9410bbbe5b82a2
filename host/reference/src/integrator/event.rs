//! Search for the first time within a step at which a guard of a switched system turns negative.

use super::dormand_prince::{Trial, trial};
use super::guard::{Guard, Guards};
use super::system::{Entries, SwitchedSystem};

/// Point of a step: its time in the step and a guard's value.
#[derive(Debug, Clone, Copy)]
struct Reading {
    step: f64,
    guard: Guard,
}

/// Root search within one step. Every probe is a full Runge-Kutta step from the start of the step, so that a located
/// event is as accurate as the method; an interpolant would be of lower order.
pub(super) struct Search<'a, S> {
    pub system: &'a S,
    pub time: f64,
    pub state: &'a Entries,
    pub rates: &'a Entries,
}

impl<S: SwitchedSystem> Search<'_, S> {
    /// Returns the step up to just after the first event within `whole`, if there is an event.
    pub fn first_event(&self, whole: &Trial) -> Option<Trial> {
        let start = self.guards(self.time, self.state, self.rates);
        let mut end = *whole;
        let mut found = false;
        for index in 0..start.length {
            let from = Reading { step: 0.0, guard: start.list[index] };
            let to = self.reading(&end, index);
            let crossed = if to.guard.value < 0.0 { Some((from, end)) } else { self.hidden_crossing(index, from, to) };
            if let Some((from, beyond)) = crossed {
                end = self.refine_crossing(index, from, beyond);
                found = true;
            }
        }
        found.then_some(end)
    }

    /// Finds a guard that is positive at both ends but negative in between, by following the minimum of its Hermite
    /// cubic.
    fn hidden_crossing(&self, index: usize, from: Reading, to: Reading) -> Option<(Reading, Trial)> {
        let (mut left, mut right) = (from, to);
        // Four probes reduce the distance to the minimum far below the guard's resolution.
        for _ in 0..4 {
            if !(left.guard.rate < 0.0 && right.guard.rate > 0.0) {
                return None;
            }
            let width = right.step - left.step;
            let (fraction, minimum) = hermite_minimum(left.guard, right.guard, width);
            let margin = 0.1 * width * left.guard.rate.abs().max(right.guard.rate);
            if minimum > margin {
                return None;
            }
            let probe = self.probe(left.step + fraction * width);
            let middle = self.reading(&probe, index);
            if middle.guard.value < 0.0 {
                return Some((from, probe));
            }
            if middle.guard.rate < 0.0 {
                left = middle;
            } else {
                right = middle;
            }
        }
        None
    }

    /// Newton's method on the guard within its bracket, until the guard is negative by less than the resolution.
    fn refine_crossing(&self, index: usize, from: Reading, beyond: Trial) -> Trial {
        let resolution = self.system.guard_resolution();
        let aim = -0.5 * resolution;
        let (mut low, mut end) = (from, beyond);
        let mut high = self.reading(&end, index);
        for round in 0..80 {
            if high.guard.value >= -resolution || high.step - low.step <= 1e-15 * beyond.step {
                break;
            }
            let near = if low.guard.value.abs() < high.guard.value.abs() { low } else { high };
            let newton = near.step - (near.guard.value - aim) / near.guard.rate;
            // At a graze Newton's method may advance slowly from one side: every fourth probe halves the bracket.
            let inside = newton > low.step && newton < high.step && round % 4 != 3;
            let step = if inside { newton } else { 0.5 * (low.step + high.step) };
            if !(step > low.step && step < high.step) {
                break;
            }
            let probe = self.probe(step);
            let middle = self.reading(&probe, index);
            if middle.guard.value < 0.0 {
                (high, end) = (middle, probe);
            } else {
                low = middle;
            }
        }
        end
    }

    fn probe(&self, step: f64) -> Trial {
        trial(self.system, self.time, self.state, self.rates, step)
    }

    fn reading(&self, at: &Trial, index: usize) -> Reading {
        let guards = self.guards(self.time + at.step, &at.state, &at.rates);
        Reading { step: at.step, guard: guards.list[index] }
    }

    fn guards(&self, time: f64, state: &Entries, rates: &Entries) -> Guards {
        let mut guards = Guards::none();
        self.system.guards(time, state, rates, &mut guards);
        guards
    }
}

/// Location in [0, 1] and value of the minimum of the cubic through two readings. The left rate is negative, the right
/// rate positive.
fn hermite_minimum(left: Guard, right: Guard, width: f64) -> (f64, f64) {
    let (fall, rise) = (left.rate * width, right.rate * width);
    let cubic = 2.0 * (left.value - right.value) + fall + rise;
    let square = 3.0 * (right.value - left.value) - 2.0 * fall - rise;
    let root = (square * square - 3.0 * cubic * fall).max(0.0).sqrt();
    // The stable form of (-square + root) / (3 cubic), the root at which the slope rises.
    let fraction = (-fall / (square + root)).clamp(1e-3, 1.0 - 1e-3);
    let value = left.value + fraction * (fall + fraction * (square + fraction * cubic));
    (fraction, value)
}
