//! Steps as long as the error allows, ended by every event, after which the mode is selected again.

use std::fmt;

use super::dormand_prince::trial;
use super::event::Search;
use super::system::{Entries, MAX_ENTRIES, SwitchedSystem};

/// Why an integration stopped.
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

/// What an integration has cost so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Accepted steps.
    pub steps: u64,
    /// Steps refused for their error.
    pub refused: u64,
    /// Events located.
    pub events: u64,
    /// Steps taken without event detection, to get past a graze.
    pub unguarded_steps: u64,
}

/// So many events within a sliver of time are one graze: its guard hovers about zero, where both choices agree.
const EVENTS_IN_A_GRAZE: u32 = 32;

/// Length of such a sliver, and of the unguarded step that ends it, over the longest step.
const GRAZE: f64 = 1e-5;

/// State and step size of a running integration.
#[derive(Debug, Clone)]
pub struct Integrator {
    time: f64,
    state: Entries,
    step: f64,
    counters: Counters,
}

impl Integrator {
    /// Starts at a state.
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

    /// Present state, to be changed between two calls of `advance`.
    pub fn state_mut(&mut self) -> &mut Entries {
        &mut self.state
    }

    /// Says that the state has been moved to `time` by other means; the next step is sized anew.
    pub fn move_time(&mut self, time: f64) {
        self.time = time;
        self.step = f64::INFINITY;
    }

    /// What it has cost so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Integrates up to `end`; inputs of the system may have changed since the last call.
    pub fn advance<S: SwitchedSystem>(&mut self, system: &mut S, end: f64) -> Result<(), IntegrationError> {
        let mut rates = [0.0; MAX_ENTRIES];
        let mut sliver = (self.time, 0);
        self.restart(system, &mut rates);
        let longest = system.longest_step();
        while self.time < end {
            let unguarded = sliver.1 >= EVENTS_IN_A_GRAZE;
            let remaining = end - self.time;
            let wanted = if unguarded { GRAZE * longest } else { self.step.min(longest) };
            // Two equal parts instead of a full step and a crumb.
            let step = if wanted >= remaining { remaining } else { wanted.min(0.5 * remaining) };
            let whole = trial(system, self.time, &self.state, &rates, step);
            let error = whole.error(system, step);
            if !error.is_finite() {
                return Err(IntegrationError::NotFinite(self.time));
            }
            // Eighth order: the error of a step goes with its eighth power here, since the estimate is of seventh.
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
                // A step cut short by the end of the interval says nothing against the one that was wanted.
                self.step = if step < wanted { wanted.max(step * factor) } else { step * factor };
            }
            if event.is_some() {
                self.counters.events += 1;
                sliver = if self.time - sliver.0 > GRAZE * longest { (self.time, 1) } else { (sliver.0, sliver.1 + 1) };
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
