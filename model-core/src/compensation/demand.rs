//! What a motion will ask of the teeth, learnt from the motor's torque alone, so that no mode of a payload and no error of the observer is
//! in it.
//!
//! Symbols, all referred to the link: r set-point, u torque, J all inertia as designed, Jm the motor's, k ratio of the inertia to J,
//! fm the motor's dry friction as designed, f all dry friction, g even load.
//!
//! 1. Feed-forward by feedback-error learning (Kawato 1990): k, f and g follow what u is beyond k J r'' + f sign(r') + g; k by normalised
//!    least mean squares, f and g by a Kalman filter that begins with what the joint's file says of friction (`brakes`).
//! 2. Demand on the teeth: d = (k J - Jm) r'' + (f - fm) sign(r') + g. It presses a flank when it is beyond what the motor's friction may
//!    hold of it at rest, plus the standard deviation that the filter gives.

use super::brakes::Brakes;
use super::set_point::Motion;
use super::situation::planned_direction;
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// What a motion will ask of the teeth, and what that is known from.
#[derive(Debug, Clone)]
pub(super) struct Demand<T: Real> {
    /// All inertia over the designed [-].
    inertia: T,
    /// Dry friction of motor and link, and the load that does not depend on the motion.
    brakes: Brakes<T>,
    /// Square of the largest torque of late that the designed inertia was accelerated with [N^2 m^2].
    largest: T,
    /// Torque of late beyond what the motor's own inertia takes [N m].
    passed: T,
    /// Planned demand on the teeth, and what friction takes of the motor's torque [N m].
    torque: T,
    rubs: T,
    /// What the set-point asked for when the demand was planned last, until it is learnt from.
    asked: Option<Asked<T>>,
}

/// What a set-point asks for.
#[derive(Debug, Clone, Copy)]
struct Asked<T: Real> {
    /// Torque for the designed inertia, and for that of the motor alone [N m].
    accelerates: [T; 2],
    /// -1 to 1.
    direction: T,
}

impl<T: Real> Demand<T> {
    /// Rate at which the inertia follows [1/s]: a few swings of a motion.
    const INERTIA_FOLLOWS: T = T::TWO;

    /// Rates at which the even load and the friction follow once they are known [1/s]. A load that is followed at 8 follows a loop that
    /// swings at 5 Hz, and its sign keeps that swinging.
    const FOLLOW: [T; 2] = [T::THREE, T::HALF];

    /// Torque for acceleration over the motor's limit below which no inertia is learnt [-]: what friction hides.
    const LEAST: T = T::TWENTIETH;

    /// What nothing explains of a torque, as a standard deviation over the motor's limit [-].
    const NOISE: T = T::TWENTIETH;

    /// Standard deviation of a load of which nothing is known, over the motor's limit [-]. Of ten torques the first ones count for most.
    const UNKNOWN: T = T::EIGHTH;

    /// Nothing but what was designed is known.
    pub fn new(tables: &CompensationTables<T>) -> Self {
        let [motor, link] = tables.load.frictions;
        let friction = motor + link;
        // A data sheet may be wrong by a third, or say nothing of a little.
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

    /// Variance of a load of which nothing is known [N^2 m^2].
    fn unknown(tables: &CompensationTables<T>) -> T {
        let deviation = Self::UNKNOWN * tables.limits.motor;
        deviation * deviation
    }

    /// Forgets what was planned; what was learnt stays.
    pub fn forget_plan(&mut self) {
        (self.passed, self.torque, self.rubs, self.asked) = (T::ZERO, T::ZERO, T::ZERO, None);
    }

    /// [N m].
    pub fn torque(&self) -> T {
        self.torque
    }

    /// Load that does not depend on the motion [N m].
    pub fn even(&self) -> T {
        self.brakes.even
    }

    /// Torque that the motor has to give for a motion without a load [N m].
    pub fn feed_forward(&self, tables: &CompensationTables<T>, now: &Motion<T>) -> T {
        self.inertia * (tables.body.motor_inertia + tables.body.load_inertia) * now.acceleration + self.rubs
    }

    /// Whether the torque of late has passed half of the demand to the teeth, and no other flank was pressed.
    pub fn is_passed(&self) -> bool {
        let passed = if self.torque < T::ZERO { -self.passed } else { self.passed };
        passed > T::HALF * self.torque.abs()
    }

    /// The even load is another than before.
    pub fn doubt_load(&mut self, tables: &CompensationTables<T>) {
        self.brakes.doubt_even(Self::unknown(tables));
    }

    /// Plans the demand of a motion; how far it presses a flank, over what it takes to press one: beyond 1 the drive flank, below -1 the
    /// back flank. `None` where the motion is no number.
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
        // A set-point may ask for anything; the motor gives no more than its limit, and no more than twice that passes the teeth.
        let most = T::TWO * tables.limits.motor;
        self.torque = clamp(demand, -most, most);
        self.asked = (designed.abs() <= most).then_some(Asked { accelerates: [designed, alone], direction });
        let held = of_motor * (T::ONE - direction.abs());
        let deviation = self.brakes.variance(direction).square_root();
        Some(self.torque.over(tables.watch.least_demand + held + deviation))
    }

    /// Learns from the torque of one of [`Turn::periods`] periods [N m].
    // A function of its own leaves the registers to the law that controls instead: fewer instructions a tick on a Cortex-M4F.
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
            // Of the link a quarter to four times what was designed, as everywhere.
            let by = T::TWO * share * (excess * designed).over(self.largest);
            let link = tables.body.load_share;
            let [lightest, heaviest] = [T::QUARTER, T::FOUR].map(|ratio| T::ONE + link * (ratio - T::ONE));
            self.inertia = clamp(self.inertia + by, lightest, heaviest);
        }
        // At rest friction may hold any part of it.
        let (unexplained, held) = (Self::NOISE * limit, self.brakes.friction * (T::ONE - direction.abs()));
        let noise = unexplained * unexplained + held * held;
        self.brakes.grow(Self::FOLLOW.map(|rate| rate * time * (rate * time) * noise));
        self.brakes.take(brakes, direction, noise, T::HALF * limit);
        self.brakes.even = clamp(self.brakes.even, -limit, limit);
    }
}
