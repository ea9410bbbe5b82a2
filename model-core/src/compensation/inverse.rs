//! Control of the motor with an adaptive inverse of the backlash (Tao, Kokotovic 1996): while both shafts are seen but the gap is unknown,
//! and after a loop has hunted. Of the link only a slow mean is used, so that no mode of a payload is fed back. The link is damped only if
//! the motor swings against the delays of the loop. The observer's half-gap and offset replace an edge that the demand has not pressed yet;
//! the observer's compliance gives the wind-up.
//!
//! ```text
//! (K18)  u = k_J J a + J_m s'' + K (r + s - theta_m) + D (v + s' - w_m) + f sign(v) + u_i,   u_i' = J w^3 (r + s - theta_m)
//! (K21)  p follows d/(pressing demand) through a play of +-1, within [-1, 1]
//!        s -> (drive + back)/2 + 0.75 p (drive - back)/2 + d/S,   double pole at 3 w
//! ```
//!
//! Symbols, referred to the link: u = `torque`, s, s' = `shift`, its target = `goal`, p = `share` from -1 (back flank) to 1 (drive flank),
//! drive, back = `edges`, u_i = `integral`; `demand` estimates k_J, f and d from the torque.
//!
//! - The play keeps noise about zero demand from moving the motor. While only one edge is known, 1 replaces 0.75.
//! - Each edge is the mean of motor less link, less wind-up, while the demand presses that flank and the torque reaches the teeth.
//! - A link that leaves the pressed flank and lags on the other side moves to the other flank: p jumps there, and the load is estimated
//!   anew.

use super::demand::Demand;
use super::integral::Integral;
use super::plain::damping_on_motor;
use super::set_point::Motion;
use super::situation::Situation;
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// State of the PID, its feed-forward and the inverse of the backlash.
#[derive(Debug, Clone)]
pub(super) struct BacklashInverse<T: Real> {
    integral: Integral<T>,
    /// Shift of the set-point [rad] and its rate [rad/s].
    shift: [T; 2],
    /// Share p, -1 on the back flank to 1 on the drive flank [-].
    share: T,
    /// Motor less link on drive and back flank, without wind-up and transmission error, once measured [rad].
    edges: [Option<T>; 2],
    /// Motor less link, without transmission error, when this law began to control [rad].
    anchor: Option<T>,
    /// Target of motor less link [rad].
    goal: T,
    /// Torque of this law in the last period, before the limit; zero while it has no share in the torque [N m].
    torque: T,
    /// Time for which the demand has pressed a flank [time constants of the loop].
    pressed: T,
    /// True if a flank was pressed long enough since the link last left a flank.
    has_settled: bool,
    demand: Demand<T>,
}

impl<T: Real> BacklashInverse<T> {
    /// Part of the lost motion that is not inverted [-]. An unforeseen change of the flank causes an error of half the
    /// lost motion without an inverse, of all of it with a full inverse.
    const LEFT: T = T::QUARTER;

    /// Double pole of the path of the shift, over the bandwidth [-]: a crossing takes little more than a time constant
    /// of the loop, and less torque than the limit of the bandwidth leaves.
    const PATH: T = T::THREE;

    /// Rate at which an edge is followed, over the bandwidth [-]: slower than any payload swings.
    const EDGE: T = T::EIGHTH;

    /// Time for which a flank is pressed before its edge is measured [time constants of the loop]: a crossing and its
    /// transient.
    const SETTLES: T = T::TWO;

    /// Opening of the teeth, and lag of the link, beyond which the link counts as moving to the other flank, over the
    /// half-gap [-].
    const LEAVES: T = T::HALF;

    pub fn new(tables: &CompensationTables<T>) -> Self {
        Self {
            integral: Integral::new(),
            shift: [T::ZERO; 2],
            share: T::ZERO,
            edges: [None; 2],
            anchor: None,
            goal: T::ZERO,
            torque: T::ZERO,
            pressed: T::ZERO,
            has_settled: false,
            demand: Demand::new(tables),
        }
    }

    /// Resets the edges, because the encoders may return with another offset; estimates of inertia, friction and load
    /// stay.
    pub fn forget_places(&mut self) {
        (self.integral, self.shift, self.share) = (Integral::new(), [T::ZERO; 2], T::ZERO);
        (self.edges, self.anchor, self.pressed, self.has_settled) = ([None; 2], None, T::ZERO, false);
        self.torque = T::ZERO;
        self.demand.forget_plan();
    }

    /// Motor less its target position [rad].
    fn place(&self, situation: &Situation<T>) -> T {
        situation.lead - situation.error - self.shift[0]
    }

    /// Updates share, edges and target in one of [`Turn::periods`] periods in which both shafts are seen, whichever law
    /// controls.
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn observe(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, now: &Motion<T>) {
        self.integral.watch(tables, self.torque, Turn::periods());
        let Some(pressing) = self.demand.plan(tables, now) else { return };
        self.share = clamp(clamp(self.share, pressing - T::ONE, pressing + T::ONE), -T::ONE, T::ONE);
        if let Some(side) = self.leaves(situation) {
            (self.share, self.has_settled) = (side, false);
            self.demand.doubt_load(tables);
        }
        let presses = self.share * pressing > T::ONE && self.share.abs() >= T::ONE && self.demand.is_passed();
        let share = Turn::periods::<T>() * tables.law.back_calculation;
        let longer = clamp(self.pressed + share, T::ZERO, T::THREE);
        self.pressed = if presses { longer } else { T::ZERO };
        if self.pressed > Self::SETTLES {
            self.has_settled = true;
            let edge = situation.lead - situation.shift - self.demand.torque() / situation.stiffness;
            let [drive, back] = &mut self.edges;
            let known = if self.share > T::ZERO { drive } else { back };
            let before = known.unwrap_or(edge);
            *known = Some(before + Self::EDGE * share * (edge - before));
        }
        if let Some(anchor) = self.anchor {
            self.goal = self.goal(situation, anchor);
        }
    }

    /// Returns the flank, 1 or -1, to which the link moves although the demand presses the other flank or the edge was
    /// never measured.
    fn leaves(&self, situation: &Situation<T>) -> Option<T> {
        // A link that swings to and fro is not followed.
        if !self.has_settled {
            return None;
        }
        let (side, edge) = match self.edges {
            [Some(edge), None] => (-T::ONE, edge),
            [None, Some(edge)] => (T::ONE, edge),
            [Some(drive), Some(_)] if self.share > T::ZERO => (-T::ONE, drive),
            [Some(_), Some(back)] => (T::ONE, back),
            [None, None] => return None,
        };
        let least = Self::LEAVES * situation.half;
        (side * (situation.lead - situation.shift - edge) > least && side * situation.error > least).then_some(side)
    }

    /// Target of motor less link under the demand [rad].
    fn goal(&self, situation: &Situation<T>, anchor: T) -> T {
        // An edge that was not measured follows from the gap, or from the other edge and the guessed lost motion.
        // Without any edge the motor stays where it stands, wound up or not.
        let [drive, back] = self.edges;
        let wind_up = self.demand.torque() / situation.stiffness;
        let place = |seen: Option<T>, other: Option<T>, flank: Flank| {
            let by_other = |other: T| other + T::TWO * flank.sign::<T>() * situation.half;
            let by_gap = || situation.half_is_known.then(|| situation.offset + flank.sign::<T>() * situation.half);
            seen.or_else(by_gap).or(other.map(by_other)).map_or(anchor, |edge| edge + wind_up)
        };
        let (drive, back) = (place(drive, back, Flank::Drive), place(back, drive, Flank::Back));
        let back = if back < drive { back } else { drive };
        // While only one edge is known, the inverse is full.
        let both = situation.half_is_known || self.edges.iter().all(Option::is_some);
        let inverted = if both { T::ONE - Self::LEFT } else { T::ONE };
        T::HALF * (drive + back + inverted * self.share * (drive - back)) + situation.shift
    }

    /// Starts at the present motor position, if this law begins to control.
    fn stand(&mut self, situation: &Situation<T>) {
        if self.anchor.is_none() {
            self.anchor = Some(situation.lead - situation.shift);
            (self.shift, self.goal) = ([situation.lead, T::ZERO], situation.lead);
        }
    }

    /// Computes the torque of a period [N m].
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn follow(
        &mut self,
        tables: &CompensationTables<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
        payload_swings: bool,
    ) -> T {
        let pole = Self::PATH * tables.law.rate;
        self.stand(situation);
        let [shift, rate] = self.shift;
        let acceleration = pole * (pole * (self.goal - shift) - T::TWO * rate);
        let rate = rate + tables.clock.period * acceleration;
        let shift = shift + tables.clock.period * rate;
        if shift.is_finite() && rate.is_finite() {
            self.shift = [shift, rate];
        }
        // The motor gets all damping until it swings against the delays of the loop; then the link gets the part that
        // the motor does not bear, while the teeth may carry. If a payload swings, the payload is the cause, and
        // damping on the link would drive it.
        let on_motor = if self.integral.swings() && !payload_swings {
            damping_on_motor(tables.law.motor_damping)
        } else {
            tables.law.damping
        };
        let on_link = if situation.open { T::ZERO } else { tables.law.damping - on_motor };
        let torque = self.demand.feed_forward(tables, now) + tables.body.motor_inertia * acceleration
            - tables.law.position * self.place(situation)
            + on_motor * (now.speed + self.shift[1] - situation.motor_speed)
            + on_link * situation.error_rate
            + self.integral.torque();
        self.torque = torque;
        torque
    }

    /// Updates the integral; `cut` is the torque that the limit cut off. `None`: this law has no share in the torque,
    /// and stays ready to take over at the present motor position.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: Option<T>) {
        if let Some(cut) = cut {
            self.integral.integrate(tables, self.place(situation), cut);
        } else {
            self.integral.approach(tables, self.demand.even());
            (self.anchor, self.torque) = (None, T::ZERO);
            self.stand(situation);
        }
    }

    /// Updates inertia, friction and load by the torque of one of [`Turn::periods`] periods [N m].
    pub fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.demand.learn(tables, torque);
    }
}
