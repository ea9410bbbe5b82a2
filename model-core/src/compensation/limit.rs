//! Limit of the torque through the teeth, including the swing of motor against link.
//!
//! ```text
//! (K11)  T_s + sqrt((T_s - F)^2 + S I v_c^2) <= P,   hence  T_s <= (P + F)/2 - S I v_c^2/(2 (P - F)),   T_s >= P/2
//! ```
//!
//! Under constant torque the torque through the teeth swings about its static value T_s = `mesh_torque()`, while motor and link close at
//! v_c = `closing`. S = `stiffness`, I = `reduced_inertia`, F = `force` at present, P = `limit`. Teeth that have just met get half of P at
//! once, and all of P a quarter of a swing later, without overshoot.

use super::load::LoadModel;
use super::loop_state::LoopState;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// Static torque through the teeth, T, under a torque after losses: law and load accelerate motor and link together,
/// and the motor's inertia takes its share [N m].
pub(super) fn mesh_torque<T: Real>(tables: &CompensationTables<T>, free: T, useful: T) -> T {
    free + tables.body.load_share * (useful - free)
}

/// Largest torque through the teeth, P, while the law asks for a torque after losses [N m]. The reserve for swings is
/// released where the law asks for more than the motor has: the link lags anyway, and more with a reserve.
pub(super) fn mesh_torque_limit<T: Real>(tables: &CompensationTables<T>, useful: T) -> T {
    let limits = &tables.limits;
    let short = beyond(useful, limits.motor).abs();
    if short == T::ZERO {
        return limits.teeth;
    }
    limits.teeth + clamp(short.over(limits.motor), T::ZERO, T::ONE) * (limits.teeth_at_most - limits.teeth)
}

/// Torque after losses, limited so that the torque through the teeth stays within `limit` [N m].
pub(super) fn limit_mesh_torque<T: Real>(
    tables: &CompensationTables<T>,
    load: &LoadModel<T>,
    state: &LoopState<T>,
    useful: T,
    limit: T,
) -> T {
    if load.external_impact(tables) {
        return useful;
    }
    let mesh_torque = mesh_torque(tables, load.free_load_torque(), useful);
    let side = if mesh_torque < T::ZERO { -T::ONE } else { T::ONE };
    let static_limit = static_limit(tables, state, side, limit);
    let asked = side * mesh_torque;
    if asked > static_limit { useful - side * tables.body.inverse_load_share * (asked - static_limit) } else { useful }
}

/// Static torque that the law may ask of a flank, between half of `limit` and `limit`. Less than half would brake the
/// motor, with delays of a third of a swing on stiff joints.
fn static_limit<T: Real>(tables: &CompensationTables<T>, state: &LoopState<T>, side: T, limit: T) -> T {
    let closing = side * (state.motor_speed - state.link_speed);
    let wound = side * (state.motor_position + state.error - state.flank_shift) - state.half_gap;
    // Force by positions: without delay, but on a stiff joint the position errors become large forces. An overestimated
    // force costs a third of an underestimated one.
    let force_by_position = state.stiffness * (wound + tables.crossing.reaction * closing);
    let force_by_torque = side * state.mesh_torque;
    let force = clamp(
        if force_by_torque > force_by_position { force_by_torque } else { force_by_position },
        T::ZERO,
        limit + limit,
    );
    let room = limit - force;
    let swing =
        if closing > T::ZERO { state.stiffness * tables.body.reduced_inertia * closing * closing } else { T::ZERO };
    let least = tables.limits.least_room;
    let reserve = room.abs() + swing.over(if room > least { room } else { least });
    clamp(limit - T::HALF * reserve, T::HALF * limit, limit)
}
