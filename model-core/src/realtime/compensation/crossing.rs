//! How long a crossing takes. The path itself is left to `path`.

use super::arithmetic::clamp;
use crate::real::Real;
use crate::tables::compensation::CompensationTables;

/// Times of a crossing.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossing<T: Real> {
    /// From setting out to arriving [s].
    pub duration: T,
    /// In which the motor comes to its steady speed, and from it [s]; at most half of the duration.
    pub ramp: T,
}

impl<T: Real> Crossing<T> {
    /// The crossing of a gap of twice `half`. Planets that are struck on the way are struck no harder than a set share of
    /// the rated force or, up to the rated force, than what will be passed on anyway (`demand`); ramps are as steep as the
    /// motor's torque and the loop's delays allow.
    pub fn new(tables: &CompensationTables<T>, half: T, demand: T) -> Self {
        let force = clamp(demand.abs(), tables.strike_torque, tables.hardest_strike);
        let speed = force * tables.strike_speed_per_torque;
        let way = half + half;
        let along = if speed > T::ZERO { way.over(speed) } else { tables.longest_crossing };
        // A gap that is crossed before that speed is reached has no more than two ramps.
        let steepest = tables.ramp_per_speed * speed;
        let ramp = if steepest > along { (tables.ramp_per_speed * way).square_root() } else { steepest };
        let ramp = clamp(ramp, tables.shortest_ramp, T::HALF * tables.longest_crossing);
        Self { duration: clamp(ramp + along, ramp + ramp, tables.longest_crossing), ramp }
    }
}
