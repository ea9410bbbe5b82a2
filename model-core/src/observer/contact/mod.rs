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

/// What there is to tell the contact by.
#[derive(Debug, Clone, Copy)]
pub enum Evidence<T: Real> {
    /// The force alone: the half-gap is not known yet.
    Force,
    /// Force and deflection. The last learning interval may have been in settled contact, and both together leave the
    /// force a standard deviation [N].
    Position {
        /// Where the deflection is in the gap.
        position: ByPosition<T>,
        /// The last learning interval was in settled contact.
        settled: bool,
        /// Standard deviation of the force by both together [N].
        deviation: T,
    },
    /// Without an output encoder: the flank that the motor feels.
    MotorOnly(Option<Flank>),
}

impl Contact {
    /// Contact in this period, by the motor side's mesh force with its standard deviation and by what else there is [N].
    /// Returns the mesh force that follows from all of it [N].
    #[inline]
    pub fn step<T: Real>(&mut self, force: T, deviation: T, evidence: &Evidence<T>) -> T {
        let by_force = self.by_force.step(force, deviation);
        match evidence {
            Evidence::Force => {
                self.reported = by_force;
                force
            }
            Evidence::Position { position, settled, deviation: both } => {
                self.settled = *settled || self.settled && position.deflection.abs() > T::HALF * position.half_gap;
                let (reported, force) = position.reported(self.reported, force, [deviation, *both], self.settled);
                self.reported = reported;
                force
            }
            Evidence::MotorOnly(felt) => {
                self.reported = *felt;
                force
            }
        }
    }
}
