//! Demand of a motion on the teeth, estimated from the motor's torque alone: free of payload modes and observer errors.
//!
//! ```text
//! (K19)  y = u - k_J J a - f sign(v) - L_0;   k_J' = 4/s y J a/max (J a)^2;   f, L_0 by a Kalman filter (`brakes`)
//! (K20)  d = (k_J J - J_m) a + (f - f_m) sign(v) + L_0
//! ```
//!
//! Symbols, referred to the link: k_J = `inertia`, f, L_0 = `brakes`, J a, J_m a = `accelerates`, sign(v) = `direction`,
//! max (J a)^2 = `largest`, f_m = `frictions[0]`, d = `torque`. (K19) is feedback-error learning (Kawato 1990); the filter begins with the
//! friction of the joint file. d presses a flank beyond a threshold (K21): the friction that the motor may hold at rest, plus the standard
//! deviation of the filter, plus the smallest demand of the monitor.

use super::brakes::Brakes;
use super::set_point::Motion;
use super::situation::planned_direction;
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Demand of a motion on the teeth, with the estimates that it follows from.
#[derive(Debug, Clone)]
pub(super) struct Demand<T: Real> {
    /// Estimated inertia over the designed inertia [-].
    inertia: T,
    /// Dry friction of motor and link, and even load.
    brakes: Brakes<T>,
    /// Square of the largest recent torque that accelerates the designed inertia, decaying [N^2 m^2].
    largest: T,
    /// Recent torque beyond the torque that accelerates the motor alone, smoothed [N m].
    passed: T,
    /// Planned demand on the teeth; `rubs`: friction in the planned motor torque [N m].
    torque: T,
    rubs: T,
    /// Set-point torque of the last planned demand, until it is used for estimation.
    asked: Option<Asked<T>>,
}

/// Torque that a set-point asks for.
#[derive(Debug, Clone, Copy)]
struct Asked<T: Real> {
    /// Torque that accelerates the designed inertia, and the motor alone [N m].
    accelerates: [T; 2],
    /// Share and sign of dry friction at the planned speed, -1 to 1.
    direction: T,
}

impl<T: Real> Demand<T> {
    /// Rate at which the inertia estimate follows [1/s]: a few swings of a motion.
    const INERTIA_FOLLOWS: T = T::TWO;

    /// Rates at which the even load and the friction follow once they are known [1/s]. At 8 the even load follows a
    /// loop that swings at 5 Hz, and its sign sustains the swing.
    const FOLLOW: [T; 2] = [T::THREE, T::HALF];

    /// Smallest accelerating torque for estimating the inertia, over the motor's limit [-]: friction hides smaller
    /// torques.
    const LEAST: T = T::TWENTIETH;

    /// Standard deviation of unexplained torque, over the motor's limit [-].
    const NOISE: T = T::TWENTIETH;

    /// Standard deviation of an unknown load, over the motor's limit [-]. Of ten measurements the first then weigh
    /// most.
    const UNKNOWN: T = T::EIGHTH;

    /// Starts from the designed values.
    pub fn new(tables: &CompensationTables<T>) -> Self {
        let [motor, link] = tables.load.frictions;
        let friction = motor + link;
        // Friction on a data sheet may be wrong by a third, and a small friction may be missing.
        let deviation = T::THIRD * friction + T::QUARTER * Self::NOISE * tables.limits.motor;
        Self {
            inertia: T::ONE,
            brakes: Brakes::new(friction, [Self::unknown(tables), deviation * deviation]),
            largest: T::ZERO,
            passed: T::ZERO,
            torque: T::ZERO,
            rubs: T::ZERO,
            asked: None,
        }
    }

    /// Variance of an unknown load [N^2 m^2].
    fn unknown(tables: &CompensationTables<T>) -> T {
        let deviation = Self::UNKNOWN * tables.limits.motor;
        deviation * deviation
    }

    /// Resets the planned demand; estimates stay.
    pub fn forget_plan(&mut self) {
        (self.passed, self.torque, self.rubs, self.asked) = (T::ZERO, T::ZERO, T::ZERO, None);
    }

    /// Planned demand on the teeth [N m].
    pub fn torque(&self) -> T {
        self.torque
    }

    /// Even load [N m].
    pub fn even(&self) -> T {
        self.brakes.even
    }

    /// Torque of the motor for a motion without a load [N m].
    pub fn feed_forward(&self, tables: &CompensationTables<T>, now: &Motion<T>) -> T {
        self.inertia * (tables.body.motor_inertia + tables.body.load_inertia) * now.acceleration + self.rubs
    }

    /// True if the recent torque has passed more than half of the demand to the teeth, with the sign of the demand.
    pub fn is_passed(&self) -> bool {
        let passed = if self.torque < T::ZERO { -self.passed } else { self.passed };
        passed > T::HALF * self.torque.abs()
    }

    /// Resets the variance of the even load, which has changed.
    pub fn doubt_load(&mut self, tables: &CompensationTables<T>) {
        self.brakes.doubt_even(Self::unknown(tables));
    }

    /// Plans the demand of a motion. Returns the demand over the torque that surely presses a flank: above 1 it presses
    /// the drive flank, below -1 the back flank. `None` if the motion is not finite.
    pub fn plan(&mut self, tables: &CompensationTables<T>, now: &Motion<T>) -> Option<T> {
        let [of_motor, _] = tables.load.frictions;
        let alone = tables.body.motor_inertia * now.acceleration;
        let designed = alone + tables.body.load_inertia * now.acceleration;
        let direction = planned_direction(tables, now.speed);
        let rubs = clamp(self.brakes.friction - of_motor, T::ZERO, self.brakes.friction);
        let demand = self.inertia * designed - alone + rubs * direction + self.brakes.even;
        if !demand.is_finite() {
            (self.torque, self.rubs) = (T::ZERO, T::ZERO);
            return None;
        }
        self.rubs = self.brakes.friction * direction;
        // A set-point may ask for any torque; the motor is bound to its limit, and the teeth pass at most twice that
        // limit.
        let most = T::TWO * tables.limits.motor;
        self.torque = clamp(demand, -most, most);
        self.asked = (designed.abs() <= most).then_some(Asked { accelerates: [designed, alone], direction });
        let held = of_motor * (T::ONE - direction.abs());
        let deviation = self.brakes.variance(direction).square_root();
        Some(self.torque / (tables.watch.least_demand + held + deviation))
    }

    /// Updates the estimates by the torque of one of [`Turn::periods`] periods [N m].
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        let Some(Asked { accelerates: [designed, alone], direction }) = self.asked.take() else { return };
        let limit = tables.limits.motor;
        let time = Turn::periods::<T>() * tables.clock.period;
        let brakes = torque - self.inertia * designed;
        let square = designed * designed;
        if !(brakes.is_finite() && square.is_finite()) {
            return;
        }
        self.passed += Turn::periods::<T>() * tables.law.back_calculation * (torque - alone - self.passed);
        let share = Self::INERTIA_FOLLOWS * time;
        let faded = self.largest - T::HALF * share * self.largest;
        self.largest = if square > faded { square } else { faded };
        let least = Self::LEAST * limit;
        if self.largest > least * least {
            let excess = brakes - self.brakes.torque(direction);
            // The link inertia stays within a quarter to four times the designed value, as everywhere.
            let by = T::TWO * share * ((excess * designed) / self.largest);
            let link = tables.body.load_share;
            let [lightest, heaviest] = [T::QUARTER, T::FOUR].map(|ratio| T::ONE + link * (ratio - T::ONE));
            self.inertia = clamp(self.inertia + by, lightest, heaviest);
        }
        // At rest friction may hold any part of the torque.
        let (unexplained, held) = (Self::NOISE * limit, self.brakes.friction * (T::ONE - direction.abs()));
        let noise = unexplained * unexplained + held * held;
        self.brakes.grow(Self::FOLLOW.map(|rate| rate * time * (rate * time) * noise));
        self.brakes.take(brakes, direction, noise, T::HALF * limit);
        self.brakes.even = clamp(self.brakes.even, -limit, limit);
    }
}
