//! Control on the motor alone with an adaptive inverse of the backlash: what controls while both shafts are seen and the gap is not, and
//! what takes over from a loop that hunts. Of the link it uses no more than a slow mean, so that no mode of a payload is fed back; only
//! where the motor swings against the loop's delays is the link damped. The observer's half-gap and offset stand in for an edge that the
//! demand has not pressed yet, and its compliance gives the wind-up.
//!
//! Symbols, all referred to the link: r set-point, m motor, s shift of the set-point, J all inertia, Jm the motor's, b bandwidth,
//! u torque, d demand on the teeth, p share of the half-gap from -1 (back flank) to 1 (drive flank).
//!
//! 1. PID with all three poles at b on the motor's place: u = Jh r'' + Jm s'' + 3 J b^2 (r + s - m) + 3 J b (r' + s' - m') + F + I.
//! 2. Feed-forward by feedback-error learning (Kawato 1990): the ratio of Jh to J, dry friction f and even load g follow what the torque is
//!    beyond Jh r'' + f sign(r') + g, by normalised least mean squares. F = f sign(r').
//! 3. Inverse of the backlash (Tao, Kokotovic 1996): d = (Jh - Jm) r'' + f sign(r') + g. p follows d over the least demand that explains a
//!    flank through a play of one on either side: noise about no demand moves nothing. s goes three quarters of the way to the edge that p
//!    says, all the way while one edge is known, and by d as far as torque winds the joint up, on a path with a double pole.
//! 4. Each edge is the mean by which the motor leads the link while the demand presses that flank, less wind-up.

use super::integral::Integral;
use super::plain::damping_on_motor;
use super::set_point::Motion;
use super::situation::{Situation, planned_direction};
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// State of the PID with its feed-forward and the inverse of the backlash.
#[derive(Debug, Clone)]
pub(super) struct BacklashInverse<T: Real> {
    integral: Integral<T>,
    /// Shift of the set-point [rad] and its rate [rad/s].
    shift: [T; 2],
    /// From -1 on the back flank to 1 on the drive flank [-].
    share: T,
    /// Motor beyond the link on the drive flank and on the back flank without wind-up, once it was seen [rad].
    edges: [Option<T>; 2],
    /// Where the motor was beyond the link when another law controlled it last, or at first [rad].
    anchor: Option<T>,
    /// For how long the demand has pressed a flank, in time constants of the loop [-].
    pressed: T,
    /// All inertia over the designed [-].
    inertia: T,
    /// Dry friction [N m].
    friction: T,
    /// Load that does not depend on the motion [N m].
    even: T,
    /// Square of the largest torque of late that the designed inertia was accelerated with [N^2 m^2].
    largest: T,
    /// Planned demand on the teeth [N m].
    demand: T,
    /// What the set-point asked for when it was observed last, until it is learnt from: torque for the designed inertia [N m], direction [-].
    asked: Option<[T; 2]>,
}

impl<T: Real> BacklashInverse<T> {
    /// Part of the lost motion that is not inverted [-]. Where a link goes to the other flank unforeseen, it is wrong by half the
    /// lost motion without an inverse, by all of it with a whole one.
    const LEFT: T = T::QUARTER;

    /// Double pole of the shift's path over the bandwidth [-]: a crossing takes little more than a time constant of the loop, and less
    /// torque than the limit of the bandwidth leaves for it.
    const PATH: T = T::THREE;

    /// Rate at which an edge follows, over the bandwidth [-]: as slow as no payload swings.
    const EDGE: T = T::EIGHTH;

    /// Time constants of the loop for which a flank is pressed before its edge is learnt [-]: a crossing and what it leaves.
    const SETTLES: T = T::TWO;

    /// Rate at which inertia and friction follow [1/s]: a few swings of a motion.
    const FOLLOWS: T = T::TWO;

    /// Rate at which the even load follows [1/s]. At 8 it follows a loop that swings at 5 Hz, and its sign keeps that swinging.
    const EVEN_FOLLOWS: T = T::THREE;

    /// Torque for acceleration over the motor's limit below which no inertia is learnt [-]: what friction hides.
    const LEAST: T = T::TWENTIETH;

    pub fn new() -> Self {
        Self {
            integral: Integral::new(),
            shift: [T::ZERO; 2],
            share: T::ZERO,
            edges: [None; 2],
            anchor: None,
            pressed: T::ZERO,
            inertia: T::ONE,
            friction: T::ZERO,
            even: T::ZERO,
            largest: T::ZERO,
            demand: T::ZERO,
            asked: None,
        }
    }

    /// Forgets where the flanks are: the encoders may come back elsewhere. What the motor has to move stays as it is.
    pub fn forget_places(&mut self) {
        let Self { inertia, friction, even, largest, .. } = *self;
        *self = Self { inertia, friction, even, largest, ..Self::new() };
    }

    /// Motor beyond where it shall be [rad].
    fn place(&self, situation: &Situation<T>) -> T {
        situation.lead - situation.error - self.shift[0]
    }

    /// Observes one of [`Turn::periods`] periods in which both shafts are seen, whoever controls. What would press a flank is
    /// known from it.
    // A function of its own leaves the registers to the law that controls instead: fewer instructions a tick on a Cortex-M4F.
    #[inline(never)]
    pub fn observe(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, now: &Motion<T>) {
        let total = tables.body.motor_inertia + tables.body.load_inertia;
        let direction = planned_direction(tables, now.speed);
        let asked = [total * now.acceleration, direction];
        let demand = (self.inertia * total - tables.body.motor_inertia) * now.acceleration
            + self.friction * direction
            + self.even;
        self.demand = T::ZERO;
        if !demand.is_finite() {
            return;
        }
        // A set-point may ask for anything; the motor gives no more than its limit, and no more than twice that passes the teeth.
        let most = T::TWO * tables.limits.motor;
        let demand = clamp(demand, -most, most);
        self.asked = (asked[0].abs() <= most).then_some(asked);
        let pressing = demand.over(tables.watch.least_demand);
        self.share = clamp(clamp(self.share, pressing - T::ONE, pressing + T::ONE), -T::ONE, T::ONE);
        let presses = pressing.abs() > T::ONE && self.share.abs() >= T::ONE;
        let share = Turn::periods::<T>() * tables.law.back_calculation;
        let longer = clamp(self.pressed + share, T::ZERO, T::THREE);
        self.pressed = if presses { longer } else { T::ZERO };
        if self.pressed > Self::SETTLES {
            let edge = situation.lead - demand.over(situation.stiffness);
            let [drive, back] = &mut self.edges;
            let known = if self.share > T::ZERO { drive } else { back };
            let before = known.unwrap_or(edge);
            *known = Some(before + Self::EDGE * share * (edge - before));
        }
        self.demand = demand;
    }

    /// Where the motor shall be beyond the link under the demand [rad].
    fn goal(&self, situation: &Situation<T>, anchor: T) -> T {
        // Where an edge was not seen, the gap says where it lies, or the other edge and the guess of the lost motion. Where none was, the
        // motor stays as it stands, wound up or not.
        let [drive, back] = self.edges;
        let wind_up = self.demand.over(situation.stiffness);
        let place = |seen: Option<T>, other: Option<T>, flank: Flank| {
            let by_other = |other: T| other + T::TWO * flank.sign::<T>() * situation.half;
            let by_gap = || situation.half_is_known.then(|| situation.offset + flank.sign::<T>() * situation.half);
            seen.or_else(by_gap).or(other.map(by_other)).map_or(anchor, |edge| edge + wind_up)
        };
        let (drive, back) = (place(drive, back, Flank::Drive), place(back, drive, Flank::Back));
        let back = if back < drive { back } else { drive };
        // A flank that the link has never left is inverted as a whole.
        let both = situation.half_is_known || self.edges.iter().all(Option::is_some);
        let inverted = if both { T::ONE - Self::LEFT } else { T::ONE };
        T::HALF * (drive + back + inverted * self.share * (drive - back))
    }

    /// Where the motor stood beyond the link when this law began to control it [rad].
    fn stand(&mut self, situation: &Situation<T>) -> T {
        *self.anchor.get_or_insert_with(|| {
            self.shift = [situation.lead, T::ZERO];
            situation.lead
        })
    }

    /// Torque of a period [N m].
    // A function of its own leaves the registers to the law that controls instead: fewer instructions a tick on a Cortex-M4F.
    #[inline(never)]
    pub fn follow(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, now: &Motion<T>) -> T {
        let pole = Self::PATH * tables.law.rate;
        let anchor = self.stand(situation);
        let [shift, rate] = self.shift;
        let acceleration = pole * (pole * (self.goal(situation, anchor) - shift) - T::TWO * rate);
        let rate = rate + tables.clock.period * acceleration;
        let shift = shift + tables.clock.period * rate;
        if shift.is_finite() && rate.is_finite() {
            self.shift = [shift, rate];
        }
        let inertia = self.inertia * (tables.body.motor_inertia + tables.body.load_inertia);
        // All of the damping on the motor, as long as that does not swing against the loop's delays; then the link takes over what
        // the motor does not bear, while the teeth may carry.
        let on_motor =
            if self.integral.swings() { damping_on_motor(tables.law.motor_damping) } else { tables.law.damping };
        let on_link = if situation.open { T::ZERO } else { tables.law.damping - on_motor };
        let torque = inertia * now.acceleration + tables.body.motor_inertia * acceleration
            - tables.law.position * self.place(situation)
            + on_motor * (now.speed + self.shift[1] - situation.motor_speed)
            + on_link * situation.error_rate
            + self.friction * planned_direction(tables, now.speed)
            + self.integral.torque();
        self.integral.watch(tables, torque);
        torque
    }

    /// Integrates; `cut` is what the limit took off if this law has a share in the torque. While it has none, it keeps itself ready to
    /// take over where the motor is.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: Option<T>) {
        if let Some(cut) = cut {
            self.integral.integrate(tables, self.place(situation), cut);
        } else {
            self.integral.approach(tables, self.even);
            self.anchor = None;
            self.stand(situation);
        }
    }

    /// Learns what the motor has to move from one of [`Turn::periods`] periods.
    // A function of its own leaves the registers to the law that controls instead: fewer instructions a tick on a Cortex-M4F.
    #[inline(never)]
    pub fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        let Some([accelerates, direction]) = self.asked.take() else { return };
        let limit = tables.limits.motor;
        let passed = Turn::periods::<T>() * tables.clock.period;
        let share = Self::FOLLOWS * passed;
        let excess = torque - self.inertia * accelerates - self.friction * direction - self.even;
        let square = accelerates * accelerates;
        let faded = self.largest - T::HALF * share * self.largest;
        if !(excess.is_finite() && square.is_finite()) {
            return;
        }
        self.largest = if square > faded { square } else { faded };
        let least = Self::LEAST * limit;
        if self.largest > least * least {
            // Of the link a quarter to four times what was designed, as everywhere.
            let by = T::TWO * share * (excess * accelerates).over(self.largest);
            let link = tables.body.load_share;
            let [lightest, heaviest] = [T::QUARTER, T::FOUR].map(|ratio| T::ONE + link * (ratio - T::ONE));
            self.inertia = clamp(self.inertia + by, lightest, heaviest);
        }
        self.friction = clamp(self.friction + share * excess * direction, T::ZERO, T::HALF * limit);
        self.even = clamp(self.even + Self::EVEN_FOLLOWS * passed * excess, -limit, limit);
    }
}
