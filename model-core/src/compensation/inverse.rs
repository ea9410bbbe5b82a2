//! Control on the motor alone with an adaptive inverse of the backlash: what controls while both shafts are seen and the gap is not, and
//! what takes over from a loop that hunts. Of the link it uses no more than a slow mean, so that no mode of a payload is fed back; only
//! where the motor swings against the loop's delays is the link damped. The observer's half-gap and offset stand in for an edge that the
//! demand has not pressed yet, and its compliance gives the wind-up.
//!
//! Symbols, all referred to the link: r set-point, m motor, s shift of the set-point, J all inertia, Jm the motor's, b bandwidth,
//! u torque, d demand on the teeth, p share of the half-gap from -1 (back flank) to 1 (drive flank).
//!
//! 1. PID with all three poles at b on the motor's place: u = Jm s'' + 3 J b^2 (r + s - m) + 3 J b (r' + s' - m') + F + I, with the
//!    feed-forward F and the demand d that are learnt from the torque (`demand`).
//! 2. Inverse of the backlash (Tao, Kokotovic 1996): p follows d, over what it takes to press a flank, through a play of one on either side:
//!    noise about no demand moves nothing. s goes three quarters of the way to the edge that p says, all the way while one edge is known,
//!    and by d as far as torque winds the joint up, on a path with a double pole.
//! 3. Each edge is the mean by which the motor leads the link, less wind-up, while the demand presses that flank and the torque passes it.
//! 4. A link that is seen to leave the flank which the demand presses, and is left behind on the other side, is on its way to the other
//!    flank: p goes there at once, and the load has to be learnt anew.

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
    /// Where the motor was beyond the link when another law controlled it last, or at first, less the transmission error [rad].
    anchor: Option<T>,
    /// Where it shall be beyond the link [rad].
    goal: T,
    /// Torque of the last period that this law was asked in, before the limit; zero while it has no share in the torque [N m].
    torque: T,
    /// For how long the demand has pressed a flank, in time constants of the loop [-].
    pressed: T,
    /// Whether a flank was pressed for long enough since the link was seen to leave one.
    has_settled: bool,
    demand: Demand<T>,
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

    /// Part of the half-gap by which the teeth have to open, and the link to be behind, before it counts as on its way to the other flank [-].
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

    /// Forgets where the flanks are: the encoders may come back elsewhere. What the motor has to move stays as it is.
    pub fn forget_places(&mut self) {
        (self.integral, self.shift, self.share) = (Integral::new(), [T::ZERO; 2], T::ZERO);
        (self.edges, self.anchor, self.pressed, self.has_settled) = ([None; 2], None, T::ZERO, false);
        self.torque = T::ZERO;
        self.demand.forget_plan();
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
            let edge = situation.lead - situation.shift - self.demand.torque().over(situation.stiffness);
            let [drive, back] = &mut self.edges;
            let known = if self.share > T::ZERO { drive } else { back };
            let before = known.unwrap_or(edge);
            *known = Some(before + Self::EDGE * share * (edge - before));
        }
        if let Some(anchor) = self.anchor {
            self.goal = self.goal(situation, anchor);
        }
    }

    /// The flank, 1 or -1, that the link is on its way to though the demand presses the other one, or though nobody has seen it yet.
    fn leaves(&self, situation: &Situation<T>) -> Option<T> {
        // What swings to and fro is not chased.
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

    /// Where the motor shall be beyond the link under the demand [rad].
    fn goal(&self, situation: &Situation<T>, anchor: T) -> T {
        // Where an edge was not seen, the gap says where it lies, or the other edge and the guess of the lost motion. Where none was, the
        // motor stays as it stands, wound up or not.
        let [drive, back] = self.edges;
        let wind_up = self.demand.torque().over(situation.stiffness);
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
        T::HALF * (drive + back + inverted * self.share * (drive - back)) + situation.shift
    }

    /// Stays where the motor stands, if this law begins to control it now.
    fn stand(&mut self, situation: &Situation<T>) {
        if self.anchor.is_none() {
            self.anchor = Some(situation.lead - situation.shift);
            (self.shift, self.goal) = ([situation.lead, T::ZERO], situation.lead);
        }
    }

    /// Torque of a period [N m].
    // A function of its own leaves the registers to the law that controls instead: fewer instructions a tick on a Cortex-M4F.
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
        // All of the damping on the motor, as long as that does not swing against the loop's delays; then the link takes over what
        // the motor does not bear, while the teeth may carry. Where a payload swings, that is the reason, and damping on the link drives it.
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

    /// Integrates; `cut` is what the limit took off if this law has a share in the torque. While it has none, it keeps itself ready to
    /// take over where the motor is.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: Option<T>) {
        if let Some(cut) = cut {
            self.integral.integrate(tables, self.place(situation), cut);
        } else {
            self.integral.approach(tables, self.demand.even());
            (self.anchor, self.torque) = (None, T::ZERO);
            self.stand(situation);
        }
    }

    /// Learns what the motor has to move from the torque of one of [`Turn::periods`] periods [N m].
    pub fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.demand.learn(tables, torque);
    }
}
