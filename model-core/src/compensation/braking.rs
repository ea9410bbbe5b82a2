//! Closing speed at which the motor can still brake the link (K12).
//!
//! The linear law closes an error e = `error` at the speed w e (w = `rate`), which takes a deceleration of w^2 e.
//! Beyond some milliradians the motor cannot brake that hard. With the deceleration A that torque, load and inertia
//! allow (`most`), the link approaches a place no faster than
//!
//! ```text
//! v(A, e) = w e                      up to e0 = A / w^2
//!           sqrt(2 A (e - e0 / 2))   beyond
//! ```
//!
//! Value and slope of both parts agree at e0. Up to e0, the linear law applies. A set-point that moves at the speed
//! u = `speed` and brakes at the rate a = `braked` is approached in one of two ways:
//!
//! - at v(A - a, e), if the link can brake beside the set-point;
//! - at v(A, e + u^2 / (2 a)) - u towards the place where the set-point will stop, if the set-point stops before the link
//!   reaches it, e > (A - a) (u / a)^2 / 2, or if it brakes harder than the link can, a >= A, unless w e is slower.
//!
//! Up to e0 / 4 the linear law applies for every set-point. Otherwise a set-point that brakes about as hard as the link
//! can would permit no error: with an inertia known to 30 %, the link would be braked too early at every reversal of a
//! sine, and lag although the torque suffices.

use super::load::LoadModel;
use super::loop_state::LoopState;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// Smallest braking torque assumed for a link that a load drives: a weight that the motor cannot hold is approached
/// with this torque [N m].
fn min_braking_torque<T: Real>(tables: &CompensationTables<T>) -> T {
    T::EIGHTH * tables.limits.motor
}

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
    /// Error over e0 up to which the linear law always applies [-]. Tuned on sines, moves and random motions that ask
    /// for 0.5 to 3 times the torque: 1/8 changes the figures by less than a tenth, 1 makes the peaks of short moves up
    /// to 1.5 times larger.
    const LINEAR_ERROR_SHARE: T = T::QUARTER;

    /// Computes braking torques and inertia from the estimates.
    pub fn new(tables: &CompensationTables<T>, load: &LoadModel<T>, state: &LoopState<T>) -> Self {
        let [bias, motor_friction] = state.losses;
        let [driven, still] = [load.gravity_torque() + bias, tables.limits.motor + load.friction() + motor_friction];
        let of = |torque: T| {
            tables.limits.braking
                * if torque > min_braking_torque(tables) { torque } else { min_braking_torque(tables) }
        };
        Self { inertia: state.inertia, torques: [of(still - driven), of(still + driven)], rate: tables.law.rate }
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
            (torque - load.free_load_torque()).over(self.inertia)
        }
    }

    /// Returns the approach that replaces the linear law; `None` while the linear law applies. `error` is the set-point
    /// less the link [rad].
    pub fn approach(&self, error: T, course: &SetPointMotion<T>) -> Option<Approach<T>> {
        let moves_forward = if course.speed == T::ZERO { error > T::ZERO } else { course.speed > T::ZERO };
        let [back, on] = self.torques;
        let (side, against, against_return) = if moves_forward { (T::ONE, on, back) } else { (-T::ONE, back, on) };
        let [error, speed, acceleration, ahead] =
            [error, course.speed, course.acceleration, course.ahead].map(|way| side * way);
        let hardest = if ahead < acceleration { ahead } else { acceleration };
        let braked = if speed > T::ZERO && hardest < T::ZERO { -hardest } else { T::ZERO };
        // The link cannot brake beside a set-point that brakes harder.
        let unmatched = self.inertia * braked >= against;
        let needed = self.inertia * self.rate * self.rate * error;
        let (needed, against_error, left) = if error < T::ZERO {
            (-needed, against_return, against_return)
        } else {
            (needed, against, against - self.inertia * braked)
        };
        if needed <= Self::LINEAR_ERROR_SHARE * against_error || needed <= left && !unmatched {
            return None;
        }
        let most = against.over(self.inertia);
        let beside = if error < T::ZERO {
            self.towards(against_return.over(self.inertia), error, acceleration)
        } else if unmatched {
            Approach { closing: self.rate * error, acceleration }
        } else {
            self.towards(most - braked, error, acceleration)
        };
        let approach =
            if braked > T::ZERO { self.nearer_of_place_and_rest(beside, most, error, speed, braked) } else { beside };
        Some(Approach { closing: side * approach.closing, acceleration: side * approach.acceleration })
    }

    /// Torque through the teeth after a time [N m]. The demand jumps where braking begins, which its present rate does
    /// not show: the law is evaluated at the future time.
    pub fn demand(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        lag: &TrackingError<T>,
        course: &SetPointMotion<T>,
        time: T,
    ) -> T {
        let rate = lag.rate + time * lag.acceleration;
        let error = lag.error + time * (lag.rate + T::HALF * time * lag.acceleration);
        let growth = time.over(tables.crossing.lead) * (course.ahead - course.acceleration);
        let course = SetPointMotion {
            speed: course.speed + time * (course.acceleration + T::HALF * growth),
            acceleration: course.acceleration + growth,
            ..*course
        };
        let linear = Approach { closing: self.rate * error, acceleration: course.acceleration };
        let approach = self.approach(error, &course).unwrap_or(linear);
        tables.body.load_inertia * approach.acceleration
            + tables.law.damping * (approach.closing + rate)
            + load.gravity_torque()
            + load.friction_torque()
            + time * load.gravity_rate()
    }

    /// Approach to a set-point that moves and brakes: towards the place where the set-point will stop, if it stops
    /// first or brakes harder than the link can; otherwise `beside`.
    fn nearer_of_place_and_rest(&self, beside: Approach<T>, most: T, error: T, speed: T, braked: T) -> Approach<T> {
        let time_to_rest = speed.over(braked);
        let to_rest = self.towards(most, error + T::HALF * speed * time_to_rest, T::ZERO);
        let to_rest = Approach { closing: to_rest.closing - speed, ..to_rest };
        let rests_first = if most > braked {
            error > T::HALF * (most - braked) * time_to_rest * time_to_rest
        } else {
            to_rest.closing < beside.closing
        };
        if rests_first { to_rest } else { beside }
    }

    /// Approach to an accelerated place at the distance `way`. Near the knee the linear law takes over, which feeds
    /// forward the acceleration of the place.
    fn towards(&self, braking: T, way: T, acceleration: T) -> Approach<T> {
        let knee = braking.over(self.rate * self.rate);
        let size = way.abs();
        if size <= knee {
            return Approach { closing: self.rate * way, acceleration };
        }
        let speed = (T::TWO * braking * (size - T::HALF * knee)).square_root();
        let (speed, braking) = if way < T::ZERO { (-speed, braking) } else { (speed, -braking) };
        let linear = knee.over(size);
        Approach { closing: speed, acceleration: acceleration + (T::ONE - linear) * braking }
    }
}
