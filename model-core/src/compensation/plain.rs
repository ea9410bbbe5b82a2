//! Plain control: a PID on the motor position with all poles at the bandwidth and known load fed forward, while the
//! link is not seen; in impedance mode the commanded law, while the compensation does not act.
//!
//! ```text
//!        torque = J a - K (theta_m - lead) + D (v - w_m) + L + f dir + u_i,   u_i' = -J w^3 (theta_m - lead)
//! (K17)  torque = t + k_p (r - theta_l) + k_d (v - w_m);   theta_m replaces theta_l if the link is not seen
//! ```
//!
//! Symbols: theta_m - lead = `position_error()`, with lead = `motor_lead`, the expected distance of motor and link;
//! u_i = `integral`.

use super::integral::Integral;
use super::load::LoadModel;
use super::loop_state::LoopState;
use super::set_point::{ImpedancePoint, Motion};
use super::thresholds::PlainThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// Integral of the PID, and motor position relative to the link.
#[derive(Debug, Clone)]
pub(super) struct PlainControl<T: Real> {
    integral: Integral<T>,
    /// Motor less link on the flank that carries, smoothed [rad].
    motor_lead: T,
    /// Flank that motion and load ask for, 1 or -1; a share of it for a demand as small as the uncertainty of torques.
    /// `None` in impedance mode, while the link is seen, and while the half-gap is unknown.
    expected_flank: Option<T>,
}
state_words! { struct PlainControl<T> { integral, motor_lead, expected_flank } }

impl<T: Real> PlainControl<T> {
    const THRESHOLDS: PlainThresholds<T> = PlainThresholds::TUNED;

    pub fn new() -> Self {
        Self { integral: Integral::new(), motor_lead: T::ZERO, expected_flank: None }
    }

    /// Motor position less the expected distance to the link [rad].
    fn position_error(&self, state: &LoopState<T>) -> T {
        state.bounded_motor_position - self.motor_lead
    }

    /// Computes the torque of the PID while the link is not seen [N m].
    pub fn torque(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        now: &Motion<T>,
    ) -> T {
        // The integral takes over the load that the load model gives up while the link is not seen, so that the torque
        // does not sag.
        self.integral.add(tables, tables.law.back_calculation * load.gravity_torque());
        // The integral then holds the load.
        let friction = load.planned_friction(tables, now.speed);
        let demand = tables.body.load_inertia * now.acceleration + self.integral.torque() + friction;
        let share = clamp(tables.switching.inverse_step * demand, -T::ONE, T::ONE);
        self.expected_flank = state.half_gap_known.then_some(share);
        // A link that is pushed hard closes the gap by itself: with all damping on the motor the teeth meet too hard,
        // without damping on the link too late. The blow is not fed forward, because it ends before the motor can
        // answer.
        let (on_motor, on_link, load_torque) = if load.external_impact(tables) {
            let on_motor = swinging_motor_damping(tables.law.motor_damping);
            (on_motor, Self::THRESHOLDS.pushed_link_damping * (tables.law.damping - on_motor), T::ZERO)
        } else {
            (tables.law.damping, T::ZERO, load.gravity_torque() + friction)
        };
        let torque = (tables.body.load_inertia + tables.body.motor_inertia) * now.acceleration
            - tables.law.position * self.position_error(state)
            + on_motor * (now.speed - state.motor_speed)
            + on_link * state.error_rate
            + load_torque
            + self.integral.torque();
        self.integral.detect_swing(tables, torque, T::ONE);
        torque
    }

    /// Computes the torque of the impedance law [N m]: damper on the motor; spring on the link, or on the motor while
    /// the link is not seen.
    pub fn impedance_torque(&mut self, state: &LoopState<T>, point: &ImpedancePoint<T>) -> T {
        self.expected_flank = None;
        let error = if state.link_seen { state.error } else { -self.position_error(state) };
        point.torque + point.stiffness * error + point.damping * (point.speed - state.motor_speed)
    }

    /// Updates the integral while the link is not seen; `cut` is the torque that the limit cut off. While the link is
    /// seen, other laws control: the integral decays to be ready, and the flank in use gives the distance of motor and
    /// link.
    pub fn update(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>, cut: T) {
        let slow = Self::THRESHOLDS.lead_smoothing * tables.law.back_calculation;
        let (towards, part) = if state.link_seen {
            self.expected_flank = None;
            self.integral.decay_toward(tables, T::ZERO);
            // Teeth that may be open, and a link that moves fast against its set-point, give no distance.
            let link_pushed = tables.clock.period * state.error_rate.abs()
                > Self::THRESHOLDS.pushed_link_travel * tables.law.back_calculation * state.half_gap;
            let lead_unknown = state.contact.is_none() || link_pushed;
            let towards = if lead_unknown { self.motor_lead } else { state.bounded_motor_lead() };
            (towards, slow)
        } else {
            self.integral.integrate(tables, self.position_error(state), cut);
            // A distance corrected on one flank would be wrong by the whole lost motion on the other: the motor moves
            // to the expected flank.
            let to_expected_flank = |share: T| (share * state.half_gap, tables.law.back_calculation);
            self.expected_flank.map_or((T::ZERO, slow), to_expected_flank)
        };
        let motor_lead = self.motor_lead + part * (towards - self.motor_lead);
        if motor_lead.is_finite() {
            self.motor_lead = motor_lead;
        }
    }
}

/// Damper on the motor [N m s/rad]: larger than D_m of the compensation, whose damper acts against the link.
pub(super) fn swinging_motor_damping<T: Real>(motor_damping: T) -> T {
    (T::ONE + PlainThresholds::<T>::TUNED.damping_growth) * motor_damping
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{HALF_GAP, state, tables};

    fn unseen() -> LoopState<f64> {
        LoopState { link_seen: false, gap_known: false, ..state() }
    }

    #[test]
    fn motor_is_held_at_its_set_point() {
        let state = LoopState { bounded_motor_position: 1e-3, ..unseen() };
        let load = LoadModel::of_known(0.0, 0.0);
        let torque = PlainControl::new().torque(&tables(), &load, &state, &Motion::default());
        assert!((torque + 1.2).abs() < 1e-12);
    }

    #[test]
    fn pushed_link_keeps_half_of_the_remaining_damper() {
        let mut estimates = crate::observer::Estimates::default();
        (estimates.load_torque.value, estimates.load_torque.valid) = (9.0, true);
        let mut load = LoadModel::new();
        load.update(&tables(), &estimates, &state(), true);
        let moving = LoopState { bounded_motor_position: 0.0, error_rate: 1.0, ..unseen() };
        let torque = PlainControl::new().torque(&tables(), &load, &moving, &Motion::default());
        // Half of 120 less 1.5 times 20 N m s/rad; the integral takes over the load.
        assert!((torque - 45.0 - 0.01 * load.gravity_torque()).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn contact_gives_the_distance_of_motor_and_link() {
        let mut plain = PlainControl::new();
        (0..4000).for_each(|_| plain.update(&tables(), &state(), 0.0));
        assert!((plain.motor_lead - HALF_GAP).abs() < 1e-6);
    }

    #[test]
    fn open_teeth_and_fast_links_give_no_distance() {
        let tables = tables();
        // A quarter of the half-gap in a time constant of 0.1 s: 5 mrad/s.
        for (state, follows) in [
            (LoopState { contact: None, ..state() }, false),
            (LoopState { error_rate: 5.1e-3, ..state() }, false),
            (LoopState { error_rate: -4.9e-3, ..state() }, true),
        ] {
            let mut plain = PlainControl::new();
            plain.update(&tables, &state, 0.0);
            assert_eq!(plain.motor_lead != 0.0, follows);
        }
    }

    #[test]
    fn unseen_link_shifts_the_motor_to_the_expected_flank() {
        let (tables, load, mut plain) = (tables(), LoadModel::of_known(0.0, 0.0), PlainControl::new());
        let now = Motion { acceleration: -1.0, ..Motion::default() };
        plain.torque(&tables, &load, &unseen(), &now);
        (0..2000).for_each(|_| plain.update(&tables, &unseen(), 0.0));
        assert!((plain.motor_lead + HALF_GAP).abs() < 1e-6);
    }

    #[test]
    fn impedance_spring_acts_on_the_link_while_it_is_seen() {
        let point = ImpedancePoint { stiffness: 100.0, ..ImpedancePoint::default() };
        let seen = LoopState { error: 0.02, bounded_motor_position: -0.03, ..state() };
        let torque = |link_seen| PlainControl::new().impedance_torque(&LoopState { link_seen, ..seen }, &point);
        assert_eq!((torque(true), torque(false)), (2.0, 3.0));
    }

    #[test]
    fn position_that_is_no_number_is_forgotten() {
        let mut plain = PlainControl::new();
        plain.update(&tables(), &LoopState { bounded_motor_position: f64::NAN, ..state() }, 0.0);
        assert_eq!(plain.motor_lead, 0.0);
    }
}
