//! Adaptive integrator: steps as long as the error allows; an event ends a step, then the mode is selected again.

use std::fmt;

use super::dormand_prince::trial;
use super::event::Search;
use super::system::{Entries, MAX_ENTRIES, SwitchedSystem};

/// Reason for a failed integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntegrationError {
    /// The state or its rates became infinite or NaN at this time [s].
    NotFinite(f64),
    /// No step, however short, met the tolerance at this time [s].
    StepTooShort(f64),
}

impl fmt::Display for IntegrationError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(time) => write!(formatter, "the state is no longer finite at t = {time} s"),
            Self::StepTooShort(time) => write!(formatter, "no step is short enough for the tolerance at t = {time} s"),
        }
    }
}

impl std::error::Error for IntegrationError {}

/// Counts of steps and events of an integration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected for their error.
    pub refused: u64,
    /// Events located.
    pub events: u64,
    /// Steps without event detection, taken to pass a graze.
    pub unguarded_steps: u64,
}

/// Number of events within [`GRAZE_STEP`] that count as one graze: the guard stays near zero, where both modes agree.
const GRAZE_EVENTS: u32 = 32;

/// Duration of a graze, and of the unguarded step that ends it, relative to the longest step.
const GRAZE_STEP: f64 = 1e-5;

/// State and step size of a running integration.
#[derive(Debug, Clone)]
pub struct Integrator {
    time: f64,
    state: Entries,
    step: f64,
    counters: Counters,
}

impl Integrator {
    /// Integrator at a state.
    pub fn new(time: f64, state: Entries) -> Self {
        Self { time, state, step: f64::INFINITY, counters: Counters::default() }
    }

    /// Present time [s].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Present state.
    pub fn state(&self) -> &Entries {
        &self.state
    }

    /// Present state, mutable between two calls of `advance`.
    pub fn state_mut(&mut self) -> &mut Entries {
        &mut self.state
    }

    /// Sets the time after the state was advanced by other means; the size of the next step is estimated anew.
    pub fn move_time(&mut self, time: f64) {
        self.time = time;
        self.step = f64::INFINITY;
    }

    /// Returns the counts so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Integrates up to `end`; inputs of the system may change between calls.
    pub fn advance<S: SwitchedSystem>(&mut self, system: &mut S, end: f64) -> Result<(), IntegrationError> {
        let mut rates = [0.0; MAX_ENTRIES];
        let mut sliver = (self.time, 0);
        self.restart(system, &mut rates);
        let longest = system.longest_step();
        while self.time < end {
            let unguarded = sliver.1 >= GRAZE_EVENTS;
            let remaining = end - self.time;
            let wanted = if unguarded { GRAZE_STEP * longest } else { self.step.min(longest) };
            // Two equal steps instead of a full one and a tiny rest.
            let step = if wanted >= remaining { remaining } else { wanted.min(0.5 * remaining) };
            let whole = trial(system, self.time, &self.state, &rates, step);
            let error = whole.error(system, step);
            if !error.is_finite() {
                return Err(IntegrationError::NotFinite(self.time));
            }
            // The error of a step grows with its eighth power, since the estimate is of seventh order.
            let factor = (0.9 * error.max(1e-16).powf(-0.125)).clamp(0.2, 4.0);
            if error > 1.0 {
                self.counters.refused += 1;
                self.step = step * factor;
                if self.step < 1e-12 * longest {
                    return Err(IntegrationError::StepTooShort(self.time));
                }
                continue;
            }
            self.counters.steps += 1;
            let search = Search { system, time: self.time, state: &self.state, rates: &rates };
            let event = if unguarded { None } else { search.first_event(&whole) };
            let accepted = event.as_ref().unwrap_or(&whole);
            self.time = if accepted.step == remaining { end } else { self.time + accepted.step };
            self.state = accepted.state;
            rates = accepted.rates;
            if !unguarded {
                // A step shortened by the end of the interval does not reduce the proposed step size.
                self.step = if step < wanted { wanted.max(step * factor) } else { step * factor };
            }
            if event.is_some() {
                self.counters.events += 1;
                sliver =
                    if self.time - sliver.0 > GRAZE_STEP * longest { (self.time, 1) } else { (sliver.0, sliver.1 + 1) };
                self.restart(system, &mut rates);
            } else if unguarded {
                self.counters.unguarded_steps += 1;
                sliver = (self.time, 0);
                self.restart(system, &mut rates);
            }
        }
        Ok(())
    }

    fn restart<S: SwitchedSystem>(&self, system: &mut S, rates: &mut Entries) {
        system.select_mode(self.time, &self.state);
        system.derivative(self.time, &self.state, rates);
    }
}
