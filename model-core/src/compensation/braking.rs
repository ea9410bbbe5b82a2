//! Closing speed at which the motor can still brake the link.
//!
//! The linear law closes an error e at the speed w e, which takes a deceleration of w^2 e. Beyond some milliradians the
//! motor cannot brake that hard. With the deceleration A that torque, load and inertia allow, the link approaches a
//! place no faster than v(A, e):
//!
//! ```text
//! (K12)  A = 0.9 (M_max + all dry friction +- (L + bias))/J,   e_0 = A/w^2
//!        v(A, e) = w e up to e_0,   sqrt(2 A (e - e_0/2)) beyond;   a' = a - A (1 - e_0/e)
//! ```
//!
//! Value and slope of both parts agree at e_0. A set-point that moves at the speed u and brakes at b is approached
//!
//! - with v(A - b, e), if the link can brake beside the set-point;
//! - with v(A, e + u^2/(2 b)) - u towards the place where the set-point will stop, if the set-point stops before the
//!   link reaches it, e > (A - b) (u/b)^2/2, or if it brakes harder than the link can, b >= A, unless w e is slower.
//!
//! Up to e_0/4 the linear law applies for every set-point. Otherwise a set-point that brakes about as hard as the link
//! can would permit no error: with an inertia known to 30 %, the link would be braked too early at every reversal of a
//! sine, and lag although the torque suffices.
//!
//! Symbols: e = `error`, w = `rate`, A = `deceleration`, A J = `torques`, e_0 = `knee`, u = `speed`,
//! b = `set_point_deceleration`, v = `closing`, a' = `acceleration` of the [`Approach`].

use super::load::LoadModel;
use super::loop_state::LoopState;
use super::thresholds::BrakingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// Motion of the set-point that the link closes on.
#[derive(Debug, Clone, Copy)]
pub(super) struct SetPointMotion<T: Real> {
    /// Speed [rad/s].
    pub speed: T,
    /// Acceleration [rad/s^2].
    pub acceleration: T,
    /// Acceleration at the end of a crossing that begins now [rad/s^2].
    pub ahead: T,
}

/// Difference of set-point and link.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrackingError<T: Real> {
    /// Set-point less link [rad].
    pub error: T,
    /// Rate of the error [rad/s].
    pub rate: T,
    /// Acceleration of the error [rad/s^2].
    pub acceleration: T,
}

/// Approach of the link to its set-point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach<T: Real> {
    /// Speed against the set-point [rad/s].
    pub closing: T,
    /// Acceleration fed forward during the approach [rad/s^2].
    pub acceleration: T,
}

/// Braking torque and inertia of the link.
#[derive(Debug, Clone, Copy)]
pub(super) struct BrakingLimit<T: Real> {
    /// Inertia of link and motor [kg m^2].
    inertia: T,
    /// Torque that brakes a link moving backwards, forwards [N m].
    torques: [T; 2],
    /// Spring of the linear law over its damper [1/s].
    rate: T,
}

impl<T: Real> BrakingLimit<T> {
    const THRESHOLDS: BrakingThresholds<T> = BrakingThresholds::TUNED;

    /// Computes braking torques and inertia from the estimates.
    pub fn new(tables: &CompensationTables<T>, load: &LoadModel<T>, state: &LoopState<T>) -> Self {
        let [bias, motor_friction] = state.losses;
        let [load_torque, resisting] =
            [load.gravity_torque() + bias, tables.limits.motor + load.friction() + motor_friction];
        let least = Self::THRESHOLDS.min_torque_share * tables.limits.motor;
        let torques = [resisting - load_torque, resisting + load_torque]
            .map(|torque| tables.limits.braking * if torque > least { torque } else { least });
        Self { inertia: state.inertia, torques, rate: tables.law.rate }
    }

    /// Acceleration of a link under the motor's torque or, in the open gap, under its load alone [rad/s^2].
    pub fn acceleration(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        torque: T,
    ) -> T {
        if state.teeth_open {
            -load.free_load_torque() * tables.body.inverse_load_inertia
        } else {
            (torque - load.free_load_torque()) / self.inertia
        }
    }

    /// Returns the approach that replaces the linear law; `None` while the linear law applies. `error` is the set-point
    /// less the link [rad].
    pub fn approach(&self, error: T, set_point: &SetPointMotion<T>) -> Option<Approach<T>> {
        let forward = if set_point.speed == T::ZERO { error > T::ZERO } else { set_point.speed > T::ZERO };
        let [backward_torque, forward_torque] = self.torques;
        // In the direction of the set-point's motion: `against` brakes the link, `back` brakes its way back.
        let (side, against, back) = if forward {
            (T::ONE, forward_torque, backward_torque)
        } else {
            (-T::ONE, backward_torque, forward_torque)
        };
        let [error, speed, acceleration, ahead] =
            [error, set_point.speed, set_point.acceleration, set_point.ahead].map(|value| side * value);
        let hardest = if ahead < acceleration { ahead } else { acceleration };
        let set_point_deceleration = if speed > T::ZERO && hardest < T::ZERO { -hardest } else { T::ZERO };
        // The link cannot brake beside a set-point that brakes harder.
        let unmatched = self.inertia * set_point_deceleration >= against;
        if self.linear_law_applies(error, against, back, set_point_deceleration) {
            return None;
        }
        let deceleration = against / self.inertia;
        let beside = if error < T::ZERO {
            self.towards(back / self.inertia, error, acceleration)
        } else if unmatched {
            Approach { closing: self.rate * error, acceleration }
        } else {
            self.towards(deceleration - set_point_deceleration, error, acceleration)
        };
        let approach = if set_point_deceleration > T::ZERO {
            self.nearer_of_place_and_rest(beside, deceleration, error, speed, set_point_deceleration)
        } else {
            beside
        };
        Some(Approach { closing: side * approach.closing, acceleration: side * approach.acceleration })
    }

    /// True if the linear law needs no more torque than braking leaves, or the error is below e_0/4. `against` brakes
    /// the link in the direction of the set-point's motion, `back` on its way back [N m].
    fn linear_law_applies(&self, error: T, against: T, back: T, set_point_deceleration: T) -> bool {
        let unmatched = self.inertia * set_point_deceleration >= against;
        let needed = self.inertia * self.rate * self.rate * error;
        let (needed, available, left) = if error < T::ZERO {
            (-needed, back, back)
        } else {
            (needed, against, against - self.inertia * set_point_deceleration)
        };
        needed <= Self::THRESHOLDS.linear_error_share * available || needed <= left && !unmatched
    }

    /// Torque through the teeth after a time [N m]. The demand jumps where braking begins, which its present rate does
    /// not show: the law is evaluated at the future time.
    pub fn demand(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        tracking: &TrackingError<T>,
        set_point: &SetPointMotion<T>,
        time: T,
    ) -> T {
        let rate = tracking.rate + time * tracking.acceleration;
        let error = tracking.error + time * (tracking.rate + T::HALF * time * tracking.acceleration);
        let growth = (time / tables.crossing.lead) * (set_point.ahead - set_point.acceleration);
        let set_point = SetPointMotion {
            speed: set_point.speed + time * (set_point.acceleration + T::HALF * growth),
            acceleration: set_point.acceleration + growth,
            ..*set_point
        };
        let linear = Approach { closing: self.rate * error, acceleration: set_point.acceleration };
        let approach = self.approach(error, &set_point).unwrap_or(linear);
        tables.body.load_inertia * approach.acceleration
            + tables.law.damping * (approach.closing + rate)
            + load.gravity_torque()
            + load.friction_torque()
            + time * load.gravity_rate()
    }

    /// Approach to a set-point that moves and brakes: towards the place where the set-point will stop, if it stops
    /// first or brakes harder than the link can; otherwise `beside`.
    fn nearer_of_place_and_rest(
        &self,
        beside: Approach<T>,
        deceleration: T,
        error: T,
        speed: T,
        set_point_deceleration: T,
    ) -> Approach<T> {
        let time_to_rest = speed / set_point_deceleration;
        let to_rest = self.towards(deceleration, error + T::HALF * speed * time_to_rest, T::ZERO);
        let to_rest = Approach { closing: to_rest.closing - speed, ..to_rest };
        let rests_first = if deceleration > set_point_deceleration {
            error > T::HALF * (deceleration - set_point_deceleration) * time_to_rest * time_to_rest
        } else {
            to_rest.closing < beside.closing
        };
        if rests_first { to_rest } else { beside }
    }

    /// Approach to an accelerated place at the distance `way`. Near the knee the linear law takes over, which feeds
    /// forward the acceleration of the place.
    fn towards(&self, braking: T, way: T, acceleration: T) -> Approach<T> {
        let knee = braking / (self.rate * self.rate);
        let distance = way.abs();
        if distance <= knee {
            return Approach { closing: self.rate * way, acceleration };
        }
        let speed = (T::TWO * braking * (distance - T::HALF * knee)).square_root();
        let (speed, braking) = if way < T::ZERO { (-speed, braking) } else { (speed, -braking) };
        let linear_share = knee / distance;
        Approach { closing: speed, acceleration: acceleration + (T::ONE - linear_share) * braking }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{q1, state, tables};

    /// Deceleration of 10 N m at 4 kg m^2, of which 0.9 are planned [rad/s^2].
    const DECELERATION: f64 = 0.9 * 10.0 / 4.0;

    /// Error at which the linear law needs this deceleration [rad].
    const KNEE: f64 = DECELERATION / 100.0;

    fn limit(gravity_torque: f64, friction: f64) -> BrakingLimit<f64> {
        BrakingLimit::new(&tables(), &LoadModel::of_known(gravity_torque, friction), &state())
    }

    /// Set-point with a speed and a deceleration that stays.
    fn set_point(speed: f64, acceleration: f64) -> SetPointMotion<f64> {
        SetPointMotion { speed, acceleration, ahead: acceleration }
    }

    #[test]
    fn error_up_to_the_knee_leaves_the_linear_law() {
        let at_rest = set_point(0.0, 0.0);
        assert!(limit(0.0, 0.0).approach(0.99 * KNEE, &at_rest).is_none());
        assert!(limit(0.0, 0.0).approach(1.01 * KNEE, &at_rest).is_some());
    }

    #[test]
    fn error_beyond_the_knee_closes_by_the_root() {
        let approach = limit(0.0, 0.0).approach(9.0 * KNEE, &set_point(0.0, 0.0)).expect("an approach");
        let speed = f64::sqrt(2.0 * DECELERATION * 8.5 * KNEE);
        assert!((approach.closing - speed).abs() < 1e-9, "{} not {speed}", approach.closing);
        assert!((approach.acceleration + DECELERATION * (1.0 - 1.0 / 9.0)).abs() < 1e-12);
    }

    #[test]
    fn approach_mirrors_with_the_error() {
        let [on, back] = [1.0, -1.0].map(|side| {
            let approach = limit(0.0, 0.0).approach(side * 4.0 * KNEE, &set_point(0.0, 0.0)).expect("an approach");
            [side * approach.closing, side * approach.acceleration]
        });
        assert_eq!(on, back);
    }

    #[test]
    fn load_that_brakes_permits_a_larger_error() {
        let at_rest = set_point(0.0, 0.0);
        assert!(limit(5.0, 0.0).approach(1.3 * KNEE, &at_rest).is_none(), "braked by the load");
        assert!(limit(-5.0, 0.0).approach(0.7 * KNEE, &at_rest).is_some(), "driven by the load");
    }

    #[test]
    fn friction_brakes_both_ways() {
        let at_rest = set_point(0.0, 0.0);
        assert!([1.4, -1.4].map(|side| limit(0.0, 5.0).approach(side * KNEE, &at_rest).is_none()) == [true; 2]);
    }

    #[test]
    fn weight_beyond_the_motor_is_approached_with_the_least_torque() {
        let approach = limit(-12.0, 0.0).approach(4.0 * KNEE, &set_point(0.0, 0.0)).expect("an approach");
        let (deceleration, knee) = (DECELERATION / 8.0, KNEE / 8.0);
        let speed = f64::sqrt(2.0 * deceleration * (4.0 * KNEE - 0.5 * knee));
        assert!((approach.closing - speed).abs() < 1e-9);
    }

    #[test]
    fn braking_set_point_leaves_less_for_the_error() {
        let error = 0.5 * KNEE;
        assert!(limit(0.0, 0.0).approach(error, &set_point(0.5, 0.0)).is_none());
        assert!(limit(0.0, 0.0).approach(error, &set_point(0.5, -0.7 * DECELERATION)).is_some());
    }

    #[test]
    fn error_below_a_quarter_of_the_knee_is_always_linear() {
        let hard = set_point(0.5, -3.0 * DECELERATION);
        assert!(limit(0.0, 0.0).approach(0.24 * KNEE, &hard).is_none());
        assert!(limit(0.0, 0.0).approach(0.26 * KNEE, &hard).is_some());
    }

    #[test]
    fn set_point_that_stops_first_is_approached_at_its_place_of_rest() {
        let (error, speed, brakes) = (4.0 * KNEE, 0.02, 0.5 * DECELERATION);
        let approach = limit(0.0, 0.0).approach(error, &set_point(speed, -brakes)).expect("an approach");
        let rest = error + 0.5 * speed * speed / brakes;
        let closing = f64::sqrt(2.0 * DECELERATION * (rest - 0.5 * KNEE)) - speed;
        assert!((approach.closing - closing).abs() < 1e-9);
    }

    #[test]
    fn link_in_the_open_gap_accelerates_under_its_load_alone() {
        let (tables, load) = (tables(), LoadModel::of_known(3.0, 0.0));
        let acceleration =
            |teeth_open| limit(3.0, 0.0).acceleration(&tables, &load, &LoopState { teeth_open, ..state() }, 7.0);
        assert_eq!((acceleration(true), acceleration(false)), (-1.0, 1.0));
    }

    #[test]
    fn braking_is_planned_with_nine_tenths() {
        let tables = q1::<f64>();
        let limit = BrakingLimit::new(&tables, &LoadModel::of_known(0.0, 0.0), &state());
        // Error at which the linear law brakes 4 kg m^2 with a share of the motor's torque at 60 rad/s.
        let is_linear = |share: f64| {
            limit.approach(share * tables.limits.motor / (4.0 * 60.0 * 60.0), &set_point(0.0, 0.0)).is_none()
        };
        assert!(is_linear(0.89) && !is_linear(0.91));
    }

    #[test]
    fn demand_adds_acceleration_damper_and_load() {
        let (tables, load) = (tables(), LoadModel::of_known(2.0, 0.0));
        let tracking = TrackingError { error: 0.0, rate: 0.01, acceleration: 0.0 };
        let demand = |time: f64| limit(2.0, 0.0).demand(&tables, &load, &tracking, &set_point(0.0, 0.5), time);
        // 3 kg m^2 at 0.5 rad/s^2, a damper of 120 N m s/rad at 0.01 rad/s, and a weight of 2 N m.
        assert!((demand(0.0) - 4.7).abs() < 1e-12, "{}", demand(0.0));
        // The error grows by 0.01 mrad in 1 ms and closes at 10/s.
        assert!((demand(1e-3) - 4.712).abs() < 1e-12, "{}", demand(1e-3));
    }
}
