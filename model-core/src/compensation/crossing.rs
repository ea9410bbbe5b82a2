//! How long a crossing takes.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Times of a crossing.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Crossing<T: Real> {
    /// From setting out to arriving [s].
    pub duration: T,
    /// In which the motor comes to its steady speed, and from it [s]; at most half of the duration.
    pub ramp: T,
}

impl<T: Real> Crossing<T> {
    /// The crossing of a gap of twice `half`. Planets that are struck on the way are struck no harder than a set share
    /// of the rated force or than what will be passed on anyway (`demand`), up to a set share of the peak torque; ramps
    /// are as steep as the motor's torque and the loop's delays allow.
    pub fn new(tables: &CompensationTables<T>, half: T, demand: T) -> Self {
        let force = clamp(demand.abs(), tables.crossing.strike_torque, tables.crossing.hardest_strike);
        let speed = force * tables.crossing.strike_speed_per_torque;
        let longest = tables.crossing.longest;
        if speed <= T::ZERO {
            return Self { duration: longest, ramp: tables.crossing.shortest_ramp };
        }
        let Self { duration, ramp } =
            Self::at(speed, half + half, tables.crossing.ramp_per_speed, tables.crossing.shortest_ramp);
        Self { duration: clamp(duration, T::ZERO, longest), ramp: clamp(ramp, T::ZERO, T::HALF * longest) }
    }

    /// The crossing of a way at a speed, however long it takes. `ramp_per_speed` is the time that torque needs on the ramp
    /// for each unit of speed.
    pub fn at(speed: T, way: T, ramp_per_speed: T, shortest_ramp: T) -> Self {
        let along = way.over(speed);
        let steepest = ramp_per_speed * speed;
        // A gap that is crossed before that speed is reached has no more than two ramps.
        let ramp = if steepest > along { (ramp_per_speed * way).square_root() } else { steepest };
        let ramp = if ramp < shortest_ramp { shortest_ramp } else { ramp };
        let (flat, twice) = (ramp + along, ramp + ramp);
        Self { duration: if flat < twice { twice } else { flat }, ramp }
    }
}
