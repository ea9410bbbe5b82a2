//! How much torque may be asked for so that the teeth do not pass on more than they should, with what motor and link swing
//! against each other counted in.
//!
//! While torque stays as it is, the torque in the teeth swings about what they will pass on at rest, T, and motor and link
//! close at a speed v: with the stiffness S between them and their reduced inertia I it comes to
//! T + sqrt((T - F)^2 + S I v^2), F being what is passed on now. That is no more than P if
//! T <= (P + F)/2 - S I v^2 / (2 (P - F)). So teeth that have just met get half of it at once and all of it a quarter of a
//! swing later, without overshoot and without waiting.

use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// What the teeth pass on at rest under a torque that is not lost on the way, with what brakes the link if left to itself:
/// law and load accelerate motor and load together, and the motor's share stays behind [N m].
pub(super) fn passed<T: Real>(tables: &CompensationTables<T>, free: T, useful: T) -> T {
    free + tables.body.load_share * (useful - free)
}

/// The most that teeth shall pass on while the law asks for a useful torque [N m]. What is kept back for swings is given to a
/// link that asks for more than the motor has: it lags anyway, and by more with every bit that is kept from it.
pub(super) fn spared<T: Real>(tables: &CompensationTables<T>, useful: T) -> T {
    let limits = &tables.limits;
    let short = beyond(useful, limits.motor).abs();
    if short == T::ZERO {
        return limits.teeth;
    }
    limits.teeth + clamp(short.over(limits.motor), T::ZERO, T::ONE) * (limits.teeth_at_most - limits.teeth)
}

/// A useful torque without what would carry the teeth beyond the most that they shall pass on [N m].
pub(super) fn limited<T: Real>(
    tables: &CompensationTables<T>,
    load: &LoadModel<T>,
    situation: &Situation<T>,
    useful: T,
    most: T,
) -> T {
    if load.throws(tables) {
        return useful;
    }
    let passed = passed(tables, load.free(), useful);
    let side = if passed < T::ZERO { -T::ONE } else { T::ONE };
    let allowed = allowed(tables, situation, side, most);
    let asked = side * passed;
    if asked > allowed { useful - side * tables.body.inverse_load_share * (asked - allowed) } else { useful }
}

/// What the flank of a side may be asked to pass on at rest: between half of the most and the most. Less than
/// half would brake the motor, with delays that are a third of a swing on stiff joints.
fn allowed<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>, side: T, most: T) -> T {
    let closing = side * (situation.motor_speed - situation.link_speed);
    let wound = side * (situation.motor + situation.error - situation.shift) - situation.half;
    // Seen by places without delay, but by as much wrong as a stiff joint makes of their errors; taken for too large it
    // costs a third of what it costs if taken for too small.
    let seen = situation.stiffness * (wound + tables.crossing.reaction * closing);
    let felt = side * situation.mesh_torque;
    let force = clamp(if felt > seen { felt } else { seen }, T::ZERO, most + most);
    let room = most - force;
    let swing =
        if closing > T::ZERO { situation.stiffness * tables.body.reduced_inertia * closing * closing } else { T::ZERO };
    let least = tables.limits.least_room;
    let taken = room.abs() + swing.over(if room > least { room } else { least });
    clamp(most - T::HALF * taken, T::HALF * most, most)
}
