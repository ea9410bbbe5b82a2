//! Finds the first moment at which a guard of a switched system turns negative within one step.

use super::dormand_prince::{Trial, trial};
use super::guard::{Guard, Guards};
use super::system::{Entries, SwitchedSystem};

/// A point of a step: how far in, and what a guard reads there.
#[derive(Debug, Clone, Copy)]
struct Reading {
    step: f64,
    guard: Guard,
}

/// Root search within one step. Every probe is a full Runge-Kutta step from the same start, so that a located event
/// is as accurate as the method itself, which an interpolant of lower order would not be.
pub(super) struct Search<'a, S> {
    pub system: &'a S,
    pub time: f64,
    pub state: &'a Entries,
    pub rates: &'a Entries,
}

impl<S: SwitchedSystem> Search<'_, S> {
    /// The step up to just after the first event within `whole`, or none.
    pub fn first_event(&self, whole: &Trial) -> Option<Trial> {
        let start = self.guards(self.time, self.state, self.rates);
        let mut end = *whole;
        let mut found = false;
        for index in 0..start.length {
            let from = Reading { step: 0.0, guard: start.list[index] };
            let to = self.reading(&end, index);
            let crossed = if to.guard.value < 0.0 { Some((from, end)) } else { self.hidden_crossing(index, from, to) };
            if let Some((from, beyond)) = crossed {
                end = self.narrow(index, from, beyond);
                found = true;
            }
        }
        found.then_some(end)
    }

    /// A guard that is positive at both ends may dip below zero in between: follow the minimum of its Hermite cubic.
    fn hidden_crossing(&self, index: usize, from: Reading, to: Reading) -> Option<(Reading, Trial)> {
        let (mut left, mut right) = (from, to);
        // Four probes shrink the distance to the minimum by far more than the guard's resolution needs.
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

    /// Newton's method on the guard, kept inside its bracket, until it is negative by less than the resolution.
    fn narrow(&self, index: usize, from: Reading, beyond: Trial) -> Trial {
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
            // A graze can make Newton crawl along one side: every fourth probe halves the bracket.
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

/// Where within [0, 1] the cubic through two readings is lowest, and how low. The left rate is negative, the right
/// one positive.
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
