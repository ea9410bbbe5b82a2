//! Which flank touches now, for a controller: by the mesh force alone, by force and deflection together, or, without an
//! output encoder, by what the motor feels. On which flank teeth rest, for learning, `learnt::flank` tells.

pub mod by_force;
pub mod by_position;

use by_force::ByForce;
use by_position::ByPosition;

use crate::gears::Flank;
use crate::numbers::Real;

/// The contact that is reported, and what it depends on from period to period.
#[derive(Debug, Clone, Copy, Default)]
pub struct Contact {
    /// Contact by force alone.
    pub by_force: ByForce,
    /// The flank that is reported as touching.
    pub reported: Option<Flank>,
    /// The teeth have settled since they came across the gap.
    settled: bool,
}

impl Contact {
    /// Contact by force and deflection together, which is reported, and the mesh force that follows from both [N]. The
    /// standard deviations are of the force alone and of both together [N]; the last learning interval may have been in
    /// settled contact.
    #[inline]
    pub fn step_by_position<T: Real>(
        &mut self,
        position: &ByPosition<T>,
        force: T,
        deviations: [T; 2],
        settled: bool,
    ) -> T {
        self.settled = settled || self.settled && position.deflection.abs() > T::HALF * position.half_gap;
        let (reported, force) = position.reported(self.reported, force, deviations, self.settled);
        self.reported = reported;
        force
    }
}
