//! Limit of the torque through the teeth, including the swing of motor against link.
//!
//! ```text
//! (K11)  T_s + sqrt((T_s - F)^2 + S I v_c^2) <= P,   hence  T_s <= (P + F)/2 - S I v_c^2/(2 (P - F)),   T_s >= P/2
//! ```
//!
//! Under constant torque the torque through the teeth swings about its static value T_s = `passed()`, while motor and link close at
//! v_c = `closing`. S = `stiffness`, I = `reduced_inertia`, F = `force` at present, P = `most`. Teeth that have just met get half of P at
//! once, and all of P a quarter of a swing later, without overshoot.

use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};

/// Static torque through the teeth, T, under a torque after losses: law and load accelerate motor and link together,
/// and the motor's inertia takes its share [N m].
pub(super) fn passed<T: Real>(tables: &CompensationTables<T>, free: T, useful: T) -> T {
    free + tables.body.load_share * (useful - free)
}

/// Largest torque through the teeth, P, while the law asks for a torque after losses [N m]. The reserve for swings is
/// released where the law asks for more than the motor has: the link lags anyway, and more with a reserve.
pub(super) fn spared<T: Real>(tables: &CompensationTables<T>, useful: T) -> T {
    let limits = &tables.limits;
    let short = deadband(useful, limits.motor).abs();
    if short == T::ZERO {
        return limits.teeth;
    }
    limits.teeth + clamp(short / limits.motor, T::ZERO, T::ONE) * (limits.teeth_at_most - limits.teeth)
}

/// Torque after losses, limited so that the torque through the teeth stays within `most` [N m].
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

/// Static torque that the law may ask of a flank, between half of `most` and `most`. Less than half would brake the
/// motor, with delays of a third of a swing on stiff joints.
fn allowed<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>, side: T, most: T) -> T {
    let closing = side * (situation.motor_speed - situation.link_speed);
    let wound = side * (situation.motor + situation.error - situation.shift) - situation.half;
    // Force by positions: without delay, but on a stiff joint the position errors become large forces. An overestimated
    // force costs a third of an underestimated one.
    let seen = situation.stiffness * (wound + tables.crossing.reaction * closing);
    let felt = side * situation.mesh_torque;
    let force = clamp(if felt > seen { felt } else { seen }, T::ZERO, most + most);
    let room = most - force;
    let swing =
        if closing > T::ZERO { situation.stiffness * tables.body.reduced_inertia * closing * closing } else { T::ZERO };
    let least = tables.limits.least_room;
    let taken = room.abs() + swing / if room > least { room } else { least };
    clamp(most - T::HALF * taken, T::HALF * most, most)
}
