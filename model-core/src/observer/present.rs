//! What one control period comes to: both sides put together, and which flank touches. What is learnt of it is left to
//! `interval`, what is said to `saying`.

use super::bias::Bias;
use super::contact::ByPosition;
use super::motion::magnitude;
use super::now::{Now, small};
use super::regressors::{ERROR, MAPPED, OFFSET, SKEW};
use super::state::Observer;
use crate::numbers::Real;
use parameters::ContactState;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Puts the two sides together.
    #[inline]
    pub(super) fn now(&self) -> Now<T> {
        let tables = self.tables;
        let levers = &tables.levers;
        let (_, difference) = self.counts.used();
        let shift = self.error(&self.places.mesh);
        let raw =
            tables.counts.length * small(difference) + levers.sun * self.drive.ahead - levers.output * self.load.ahead;
        let lost = self.drive.taken * levers.per_sun;
        let direction = Bias::direction(&tables.contact, self.drive.speed);
        let net = lost - self.bias.at(direction);
        // Losses in proportion to the load are friction too: they take from what drives and add to what holds back.
        let loss = if net * direction > T::ZERO { tables.contact.loss_driving } else { tables.contact.loss_driven };
        let force = net + net * magnitude(direction) * loss;
        let rate = levers.sun * self.drive.speed - levers.output * self.load.speed;
        let soon = if magnitude(rate) > tables.contact.rate_deviation { rate * tables.contact.lag } else { T::ZERO };
        Now { shift, raw, rate, soon, way: raw - self.beside_teeth(), lost, direction, force }
    }

    /// Way that everything but the teeth makes now [m].
    fn beside_teeth(&self) -> T {
        let speed = if self.supervisor.sees_both() { self.load.speed } else { T::ZERO };
        let plain = self.learner.value(OFFSET) + self.learner.value(SKEW) * speed;
        if P == MAPPED { plain + self.places.errors[0] + self.places.errors[1] } else { plain }
    }

    /// Contact, and what the meshes pass on.
    pub(super) fn decide(&mut self, now: &Now<T>) {
        let tables = self.tables;
        let known = &self.knowledge;
        self.estimates.contact = self.by_force.step(now.force, known.force_deviation);
        let mut force = now.force;
        self.estimates.reported_contact = if !self.supervisor.sees_both() {
            self.contact_unseen(now)
        } else if known.width_serves {
            let before = self.estimates.reported_contact;
            let deviations = [known.force_deviation, known.both_deviation];
            let position = self.by_position(now.way, now.soon, now.shift);
            self.settled = known.settled || self.settled && magnitude(position.way) > T::HALF * position.half_gap;
            let (contact, both) = position.reported(before, force, deviations, self.settled);
            force = both;
            contact
        } else {
            self.estimates.contact
        };
        // Where a light contact cannot be told from none, what the motor side says of the force is the best guess.
        let unsure = self.supervisor.sees_both() && !known.width_serves;
        let open = self.estimates.reported_contact == ContactState::Separated && !unsure;
        let lever = if open { T::ZERO } else { tables.levers.output };
        self.from_meshes = self.inertia.pass(lever * now.force);
        self.estimates.mesh_torque.value = lever * force;
    }

    /// What a way says of the teeth.
    pub(super) fn by_position(&self, way: T, soon: T, shift: T) -> ByPosition<T> {
        let [half_gap, _] = self.shape();
        let known = &self.knowledge;
        ByPosition {
            way: way - shift,
            soon,
            half_gap,
            blur: known.blur,
            near: known.near,
            stiffness: known.stiffness,
            weight: known.position_weight,
        }
    }

    /// Transmission error at a mesh phase [m].
    pub(super) fn error(&self, mesh: &[T; 2]) -> T {
        mesh[0] * self.learner.value(ERROR) + mesh[1] * self.learner.value(ERROR + 1)
    }
}
