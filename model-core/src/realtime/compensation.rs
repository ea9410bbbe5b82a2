//! Takes the lost motion out: from estimates and set-points to a motor torque and a shaped motor reference, once a
//! control period. Estimating is left to `observer`.

mod arithmetic;
mod load;
mod path;
mod set_point;

pub use set_point::{Command, ImpedancePoint, Motion, Position, Shaped, Stage};

use crate::mesh::ContactState;
use crate::real::Real;
use crate::realtime::observer::Estimates;
use crate::tables::compensation::CompensationTables;
use arithmetic::{clamp, magnitude};
use load::LoadModel;
use path::Path;

/// The compensation of one joint.
#[derive(Debug, Clone)]
pub struct Compensation<'tables, T: Real> {
    tables: &'tables CompensationTables<T>,
    load: LoadModel<T>,
    /// 1 or -1: the flank that carries or is being gone to.
    side: T,
    stage: Stage,
    elapsed: T,
    path: Path<T>,
    origin: Position<T>,
    rise: T,
    integral: T,
    before: Option<Motion<T>>,
    patience: T,
    calm: u32,
}

impl<'tables, T: Real> Compensation<'tables, T> {
    /// A compensation that knows what was designed.
    pub fn new(tables: &'tables CompensationTables<T>) -> Self {
        Self {
            tables,
            load: LoadModel::new(),
            side: T::ONE,
            stage: Stage::Touching,
            elapsed: T::ZERO,
            path: Path::default(),
            origin: Position::default(),
            rise: T::ZERO,
            integral: T::ZERO,
            before: None,
            patience: T::ONE,
            calm: 0,
        }
    }

    /// Takes the estimates and the command of one control period.
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> Shaped<T> {
        match command {
            Command::Position { now, ahead } => self.follow(estimates, now, ahead.as_ref()),
            Command::Impedance(_) => Shaped::default(),
        }
    }

    fn follow(&mut self, estimates: &Estimates<T>, now: &Motion<T>, ahead: Option<&Motion<T>>) -> Shaped<T> {
        let tables = self.tables;
        let error = tables.turn * now.position.less(estimates.link.turns, estimates.link.fraction);
        let motor_speed = tables.inverse_gear * estimates.motor.speed;
        let lead = self.motor_error(estimates, &now.position);
        let half = tables.inverse_lever * estimates.half_backlash.value;
        let gap = tables.inverse_lever * T::HALF * estimates.gap.value;
        let contact = match estimates.reported_contact {
            ContactState::DriveSide => T::ONE,
            ContactState::BackSide => -T::ONE,
            ContactState::Separated => T::ZERO,
        };
        let touching = contact * self.side > T::ZERO;

        // What the planned motion asks of the teeth, now and ahead.
        let error_rate = now.speed - estimates.link.speed;
        if estimates.load_torque.valid && contact != T::ZERO {
            self.load.learn(tables, estimates.load_torque.value, estimates.link.speed);
        }
        let (ahead_speed, ahead_acceleration) = self.ahead(now, ahead);
        let load_now = self.load.even() + self.load.drag(tables, now.speed);
        let law = (tables.load_inertia + tables.motor_inertia) * now.acceleration
            + load_now
            + tables.position_gain * error
            + tables.damping_gain * (now.speed - motor_speed);
        let feedback = |time: T| {
            let torque = tables.position_gain * (error + time * error_rate) + tables.damping_gain * error_rate;
            let dead = tables.doubt * self.patience;
            torque - clamp(torque, -dead, dead)
        };
        let demand_now = tables.load_inertia * now.acceleration
            + self.load.even()
            + self.load.drag(tables, estimates.link.speed)
            + feedback(T::ZERO);
        let demand_ahead = tables.load_inertia * ahead_acceleration
            + self.load.even()
            + self.load.drag(tables, ahead_speed - error_rate)
            + feedback(tables.lead);
        let turned = self.side * (demand_now + demand_ahead) < -tables.hysteresis
            && self.side * demand_ahead < -tables.hysteresis;

        if self.calm > 0 {
            self.calm -= 1;
        } else if self.patience > T::ONE {
            self.patience = self.patience * T::HALF;
            self.calm = tables.calm;
        }
        let opened = half - self.side * gap;
        let load_acceleration =
            -(self.load.even() + self.load.drag(tables, estimates.link.speed)) * tables.inverse_load_inertia;
        let start = [-lead, motor_speed];
        match self.stage {
            Stage::Touching if turned && self.rise >= T::ONE => {
                self.side = -self.side;
                self.stage = Stage::Crossing;
                self.set_out(start, error, estimates.link.speed, load_acceleration, half, now);
            }
            Stage::Touching if !touching && opened > tables.opening * half && self.rise >= T::ONE => {
                self.stage = Stage::Seeking;
                self.set_out(start, error, estimates.link.speed, load_acceleration, half, now);
            }
            Stage::Crossing | Stage::Seeking if touching => {
                self.stage = Stage::Touching;
                self.rise = T::ZERO;
            }
            Stage::Crossing | Stage::Seeking if self.elapsed >= tables.crossing + tables.crossing => {
                if turned {
                    self.side = -self.side;
                }
                self.stage = Stage::Seeking;
                self.set_out(start, error, estimates.link.speed, load_acceleration, half, now);
            }
            _ => {}
        }
        let torque = if self.stage == Stage::Touching {
            self.rise = clamp(self.rise + tables.landing_rise, T::ZERO, T::ONE);
            let wanted = self.rise * (law + self.integral);
            clamp(wanted, -tables.torque_limit, tables.torque_limit)
        } else {
            self.elapsed += tables.period;
            let [target, rate, acceleration] = self.path.at(self.elapsed);
            // The path was laid in the frame of the reference as it was at the start.
            let drift = tables.turn * now.position.less(self.origin.turns, self.origin.fraction);
            let off = lead - drift + target;
            let wanted = tables.motor_inertia * acceleration
                + tables.free_position_gain * off
                + tables.free_damping_gain * (rate - motor_speed);
            clamp(wanted, -tables.torque_limit, tables.torque_limit)
        };
        let torque = if torque.is_finite() { torque } else { T::ZERO };
        let _ = magnitude(torque);
        Shaped { torque: torque * tables.inverse_gear, stage: self.stage, side: self.side }
    }

    /// Speed and acceleration that the motion will have after the lead; without a preview, its jerk says.
    fn ahead(&mut self, now: &Motion<T>, ahead: Option<&Motion<T>>) -> (T, T) {
        let tables = self.tables;
        let before = self.before.replace(*now);
        if let Some(ahead) = ahead {
            return (ahead.speed, ahead.acceleration);
        }
        let rate = T::from_i32(tables.control_rate as i32);
        let jerk = before.map_or(T::ZERO, |before| rate * (now.acceleration - before.acceleration));
        let lead = tables.lead;
        (now.speed + lead * (now.acceleration + T::HALF * lead * jerk), now.acceleration + lead * jerk)
    }

    /// Lays a path to the flank where the load will be, left to itself.
    fn set_out(&mut self, start: [T; 2], error: T, link_speed: T, link_acceleration: T, half: T, now: &Motion<T>) {
        let tables = self.tables;
        let time = tables.crossing;
        let speed = link_speed + time * link_acceleration;
        let place = time * (link_speed + T::HALF * time * link_acceleration) - error;
        self.path = Path::new(start, [place + self.side * half, speed + self.side * tables.seek_speed], time);
        self.origin = now.position;
        self.elapsed = T::ZERO;
    }

    /// Reference less motor, felt at the link, with every tooth centred [rad].
    fn motor_error(&self, estimates: &Estimates<T>, wanted: &Position<T>) -> T {
        let tables = self.tables;
        let [numerator, denominator] = tables.ratio.map(i64::from);
        let whole = numerator * i64::from(wanted.turns) - denominator * i64::from(estimates.motor.turns);
        let turns = T::from_i64(whole) * tables.inverse_denominator + tables.gear * wanted.fraction
            - estimates.motor.fraction;
        tables.turn * tables.inverse_gear * turns + estimates.encoder_offset.value
    }
}
