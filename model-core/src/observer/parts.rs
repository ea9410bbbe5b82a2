//! What an interval gives to do and can wait, a part a period so that no period has to do it all. What cannot wait is left
//! to `interval`.

use super::contact::on;
use super::interval::Part;
use super::regressors::{OFFSET, Touch};
use super::state::Observer;
use crate::numbers::Real;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// The next part of what is to be done after an interval.
    pub(super) fn go_on_learning(&mut self) {
        let tables = self.tables;
        self.interval.part = match self.interval.part {
            Part::Answer(rest) => {
                let seen = self.supervisor.sees_both() && self.knowledge.width_serves;
                self.inertia.learn(&tables.inertia, &mut self.load, seen);
                if rest { Part::Tell } else { Part::Know }
            }
            Part::Tell => {
                if self.tell_flank() {
                    Part::Learn
                } else {
                    Part::Know
                }
            }
            Part::Learn => {
                self.interval.learnt_on = on(self.block.side());
                self.take_rest();
                Part::Know
            }
            Part::Know => {
                self.learner.forget(tables.learner.forgetting);
                self.know();
                Part::Say
            }
            Part::Say | Part::Done => {
                self.knowledge.of_learnt(tables, &self.learner);
                self.say_learnt();
                Part::Done
            }
        };
    }

    /// How much is known after an interval.
    fn know(&mut self) {
        let mut seen = self.places.free;
        if let (Some(offset), false) = (seen.get_mut(OFFSET), self.supervisor.sees_both()) {
            // Without an output encoder there is no offset to be wrong.
            *offset = T::ZERO;
        }
        let touch = Touch { side: self.interval.nearer, force: T::ZERO, mesh: self.places.mesh_then };
        let [_, compliance] = self.shape();
        self.knowledge.of_force(self.tables, &self.bias, compliance, self.interval.direction);
        self.knowledge.next(self.tables, &self.learner, &seen, &touch);
    }
}
