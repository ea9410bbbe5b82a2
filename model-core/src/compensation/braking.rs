//! How fast the link may close on its set-point so that the motor can still brake it.
//!
//! The linear law asks for the speed w e towards a set-point that is e away, w being its spring over its damper. That takes a
//! braking of w^2 e: more than there is from some milliradians on. With the braking A that torque, load and inertia leave,
//! the link closes on a place no faster than
//!
//! ```text
//! v(A, e) = w e                      up to e0 = A / w^2
//!           sqrt(2 A (e - e0 / 2))   beyond
//! ```
//!
//! Both parts have one value and one slope at e0; up to e0, so wherever the torque suffices, it is the linear law. Against a
//! set-point that moves on at the speed u and is braked at the rate a, the link
//!
//! - comes up to it at v(A - a, e), for it is braked beside it;
//! - makes for where it will stand, at v(A, e + u^2 / (2 a)) - u, if it will stand before it could be met, or if nobody can
//!   brake beside it: a >= A or e > (A - a) (u / a)^2 / 2.
//!
//! Up to e0 / 4 the linear law stays in force, whatever the set-point does. A set-point that is braked about as hard as the link can be
//! would otherwise leave no error to close on: a link whose inertia is known to 30 % would be braked too early at every reversal of a
//! sine, and stay behind though the torque suffices.

use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// Part of the largest torque that is left to brake a link which a load drives [-]: a weight that the motor cannot hold is
/// approached as if it could.
fn least<T: Real>(tables: &CompensationTables<T>) -> T {
    T::EIGHTH * tables.limits.motor
}

/// How a set-point moves, against which the link closes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course<T: Real> {
    /// [rad/s].
    pub speed: T,
    /// [rad/s^2].
    pub acceleration: T,
    /// The same when a crossing that began now ends [rad/s^2].
    pub ahead: T,
}

/// Where the link is against its set-point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lag<T: Real> {
    /// Set-point less link [rad].
    pub error: T,
    /// [rad/s].
    pub rate: T,
    /// [rad/s^2].
    pub acceleration: T,
}

/// How the link closes on its set-point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach<T: Real> {
    /// Speed against the set-point [rad/s].
    pub closing: T,
    /// Acceleration that belongs to it [rad/s^2].
    pub acceleration: T,
}

/// What can brake the link.
#[derive(Debug, Clone, Copy)]
pub(super) struct Braking<T: Real> {
    /// Inertia of link and motor [kg m^2].
    inertia: T,
    /// Torque against a link that goes back, and against one that goes on [N m].
    torques: [T; 2],
    /// Spring of the linear law over its damper [1/s].
    rate: T,
}

impl<T: Real> Braking<T> {
    /// Error over e0 up to which the linear law stays in force [-]. Tuned on sines, moves and random motions that ask for 0.5 to 3 times
    /// the torque; 1/8 gives the same figures to a tenth, 1 makes the peaks of short moves up to 1.5 times larger.
    const LINEAR: T = T::QUARTER;

    /// With motor, load and inertia as they are known.
    pub fn new(tables: &CompensationTables<T>, load: &LoadModel<T>, situation: &Situation<T>) -> Self {
        let [bias, motor_friction] = situation.losses;
        let [driven, still] = [load.even() + bias, tables.limits.motor + load.friction() + motor_friction];
        let of = |torque: T| tables.limits.braking * if torque > least(tables) { torque } else { least(tables) };
        Self { inertia: situation.inertia, torques: [of(still - driven), of(still + driven)], rate: tables.law.rate }
    }

    /// Acceleration of a link on which the motor's torque acts, or that no flank carries [rad/s^2].
    pub fn acceleration(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        torque: T,
    ) -> T {
        if situation.open {
            -load.free() * tables.body.inverse_load_inertia
        } else {
            (torque - load.free()).over(self.inertia)
        }
    }

    /// How the link closes on a set-point, if that is not the linear law's to say. `error` is the set-point less the link [rad].
    pub fn approach(&self, error: T, course: &Course<T>) -> Option<Approach<T>> {
        let goes_on = if course.speed == T::ZERO { error > T::ZERO } else { course.speed > T::ZERO };
        let [back, on] = self.torques;
        let (side, against, against_return) = if goes_on { (T::ONE, on, back) } else { (-T::ONE, back, on) };
        let [error, speed, acceleration, ahead] =
            [error, course.speed, course.acceleration, course.ahead].map(|way| side * way);
        let hardest = if ahead < acceleration { ahead } else { acceleration };
        let braked = if speed > T::ZERO && hardest < T::ZERO { -hardest } else { T::ZERO };
        // Nobody goes beside a set-point that is braked harder than the link can be.
        let unmatched = self.inertia * braked >= against;
        let needed = self.inertia * self.rate * self.rate * error;
        let (needed, against_error, left) = if error < T::ZERO {
            (-needed, against_return, against_return)
        } else {
            (needed, against, against - self.inertia * braked)
        };
        if needed <= Self::LINEAR * against_error || needed <= left && !unmatched {
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
        let approach = if braked > T::ZERO { self.or_to_rest(beside, most, error, speed, braked) } else { beside };
        Some(Approach { closing: side * approach.closing, acceleration: side * approach.acceleration })
    }

    /// What the teeth will have to pass on after a time [N m]. Where braking begins the law changes at once, which no rate of
    /// today's demand tells: it is asked what it will be.
    pub fn demand(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        lag: &Lag<T>,
        course: &Course<T>,
        time: T,
    ) -> T {
        let rate = lag.rate + time * lag.acceleration;
        let error = lag.error + time * (lag.rate + T::HALF * time * lag.acceleration);
        let growth = time.over(tables.crossing.lead) * (course.ahead - course.acceleration);
        let course = Course {
            speed: course.speed + time * (course.acceleration + T::HALF * growth),
            acceleration: course.acceleration + growth,
            ..*course
        };
        let linear = Approach { closing: self.rate * error, acceleration: course.acceleration };
        let approach = self.approach(error, &course).unwrap_or(linear);
        tables.body.load_inertia * approach.acceleration
            + tables.law.damping * (approach.closing + rate)
            + load.even()
            + load.drag()
            + time * load.rate()
    }

    /// The approach to a set-point that goes on at a speed and is braked: to where it will stand, if the link is to be there first,
    /// or if it can come beside it no more.
    fn or_to_rest(&self, beside: Approach<T>, most: T, error: T, speed: T, braked: T) -> Approach<T> {
        let stands_in = speed.over(braked);
        let to_rest = self.towards(most, error + T::HALF * speed * stands_in, T::ZERO);
        let to_rest = Approach { closing: to_rest.closing - speed, ..to_rest };
        let stands_first = if most > braked {
            error > T::HALF * (most - braked) * stands_in * stands_in
        } else {
            to_rest.closing < beside.closing
        };
        if stands_first { to_rest } else { beside }
    }

    /// How a place is approached that is so far away, itself accelerated, with a braking. Near the knee the linear law takes over,
    /// which feeds forward what the place does.
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
