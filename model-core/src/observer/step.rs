//! One control period of the observer, part after part.

use super::estimates::{Estimates, Source};
use super::late::Heard;
use super::samples::Samples;
use super::state::Observer;
use crate::numbers::Real;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Takes the samples of one control period and says what they mean.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        let heard = self.follow(samples);
        if heard == Heard::Not {
            self.hold();
            return &self.estimates;
        }
        let now = self.now();
        self.decide(&now);
        self.watch(&now);
        self.say(&now);
        if matches!(heard, Heard::Now | Heard::Missed) && !self.lateness.lasts() {
            self.learn(&now);
        } else {
            self.vouch_for_nothing();
            if self.lateness.lasts() {
                self.estimates.source = Source::Nothing;
            }
        }
        &self.estimates
    }
}
