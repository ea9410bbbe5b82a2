//! Limit of the torque through the teeth, including the swing of motor against link.
//!
//! ```text
//! (K11)  T_s + sqrt((T_s - F)^2 + S I v_c^2) <= P,   hence  T_s <= (P + F)/2 - S I v_c^2/(2 (P - F)),   T_s >= P/2
//! ```
//!
//! Under constant torque the torque through the teeth swings about its static value T_s, while motor and link close at
//! v_c. Teeth that have just met get half of P at once, and all of P a quarter of a swing later, without overshoot.
//!
//! Symbols: T_s = `mesh_torque()`, v_c = `closing`, S = `stiffness`, I = `reduced_inertia`, F = `force`, P = `limit`.

use super::load::LoadModel;
use super::loop_state::LoopState;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};

/// Static torque through the teeth, T, under a torque after losses: law and load accelerate motor and link together,
/// and the motor's inertia takes its share [N m].
pub(super) fn mesh_torque<T: Real>(tables: &CompensationTables<T>, free: T, useful: T) -> T {
    free + tables.body.load_share * (useful - free)
}

/// Largest torque through the teeth, P, while the law asks for a torque after losses [N m]. The reserve for swings is
/// released where the law asks for more than the motor has: the link lags anyway, and more with a reserve.
pub(super) fn mesh_torque_limit<T: Real>(tables: &CompensationTables<T>, useful: T) -> T {
    let limits = &tables.limits;
    let short = deadband(useful, limits.motor).abs();
    if short == T::ZERO {
        return limits.teeth;
    }
    limits.teeth + clamp(short / limits.motor, T::ZERO, T::ONE) * (limits.teeth_at_most - limits.teeth)
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
    let requested = side * mesh_torque;
    if requested > static_limit {
        useful - side * tables.body.inverse_load_share * (requested - static_limit)
    } else {
        useful
    }
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
    let reserve = room.abs() + swing / (if room > least { room } else { least });
    clamp(limit - T::HALF * reserve, T::HALF * limit, limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{state, tables};
    use crate::observer::Estimates;

    /// Returns a load model after a push at the link [N m].
    fn pushed(torque: f64) -> LoadModel<f64> {
        let mut estimates = Estimates::default();
        (estimates.load_torque.value, estimates.load_torque.valid) = (torque, true);
        let mut load = LoadModel::new();
        load.update(&tables(), &estimates, &state(), true);
        load
    }

    /// Returns the static torque that a law of 20 N m gets through the teeth in a state [N m].
    fn largest(state: &LoopState<f64>) -> f64 {
        let load = LoadModel::of_known(0.0, 0.0);
        mesh_torque(&tables(), 0.0, limit_mesh_torque(&tables(), &load, state, 20.0, 8.0))
    }

    #[test]
    fn unloaded_joint_passes_the_share_of_the_link() {
        assert_eq!(mesh_torque(&tables(), 0.0, 4.0), 3.0);
    }

    #[test]
    fn torque_equal_to_the_load_passes_whole() {
        assert_eq!(mesh_torque(&tables(), 4.0, 4.0), 4.0);
    }

    #[test]
    fn law_within_the_motor_limit_keeps_the_reserve() {
        assert_eq!([-10.0, 0.0, 10.0].map(|torque| mesh_torque_limit(&tables(), torque)), [8.0; 3]);
    }

    #[test]
    fn law_beyond_the_motor_limit_releases_the_reserve() {
        assert_eq!(
            [15.0, -15.0, 20.0, 30.0].map(|torque| mesh_torque_limit(&tables(), torque)),
            [9.0, 9.0, 10.0, 10.0]
        );
    }

    #[test]
    fn torque_within_the_limit_is_unchanged() {
        let load = LoadModel::of_known(0.0, 0.0);
        assert_eq!(limit_mesh_torque(&tables(), &load, &state(), 4.0, 8.0), 4.0);
    }

    #[test]
    fn teeth_just_met_get_half_the_limit() {
        assert!((largest(&state()) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn teeth_at_the_limit_keep_the_limit() {
        assert!((largest(&LoopState { mesh_torque: 8.0, ..state() }) - 8.0).abs() < 1e-12);
    }

    #[test]
    fn torque_of_the_other_sign_is_limited_likewise() {
        let load = LoadModel::of_known(0.0, 0.0);
        let state = LoopState { motor_position: -HALF, gap: -HALF, ..state() };
        let limited = limit_mesh_torque(&tables(), &load, &state, -20.0, 8.0);
        assert!((mesh_torque(&tables(), 0.0, limited) + 4.0).abs() < 1e-12);
    }

    /// Half-gap of the state [rad].
    const HALF: f64 = crate::compensation::test_bench::HALF_GAP;

    #[test]
    fn closing_motor_lowers_the_limit() {
        let held = LoopState { mesh_torque: 6.0, ..state() };
        let closing = LoopState { motor_speed: 0.05, ..held };
        assert!(largest(&closing) < largest(&held) && largest(&closing) >= 4.0 - 1e-12);
    }

    #[test]
    fn opening_motor_does_not_lower_the_limit() {
        let held = LoopState { mesh_torque: 6.0, ..state() };
        assert_eq!(largest(&LoopState { motor_speed: -0.05, ..held }), largest(&held));
    }

    #[test]
    fn push_beyond_the_teeth_suspends_the_limit() {
        let torque = |push| limit_mesh_torque(&tables(), &pushed(push), &state(), 20.0, 8.0);
        assert!(torque(7.9) < 20.0);
        assert_eq!(torque(8.1), 20.0);
    }
}
