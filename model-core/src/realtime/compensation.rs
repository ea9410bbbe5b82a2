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
    seek: T,
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
            seek: T::ZERO,
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
        let drag = self.load.drag(tables, now.speed);
        if estimates.load_torque.valid && contact != T::ZERO {
            self.load.learn(tables, estimates.load_torque.value, now.speed);
        }
        let (ahead_speed, ahead_acceleration) = match ahead {
            Some(ahead) => (ahead.speed, ahead.acceleration),
            None => {
                let jerk = self
                    .before
                    .map_or(T::ZERO, |before| (now.acceleration - before.acceleration) * T::from_i32(tables.control_rate as i32));
                let lead = tables.lead;
                (
                    now.speed + lead * (now.acceleration + T::HALF * lead * jerk),
                    now.acceleration + lead * jerk,
                )
            }
        };
        self.before = Some(*now);
        let load_now = self.load.even() + drag;
        let load_ahead = self.load.even() + self.load.drag(tables, ahead_speed);
        let planned_ahead = tables.load_inertia * ahead_acceleration + load_ahead;

        let opened = half - self.side * gap;
        let foreseen = self.side * planned_ahead < -tables.hysteresis;
        let lost = !touching && opened > tables.opening * self.patience * half;
        if self.calm > 0 {
            self.calm -= 1;
        } else if self.patience > T::ONE {
            self.patience = self.patience * T::HALF;
            self.calm = tables.calm;
        }
        match self.stage {
            Stage::Touching if foreseen || (lost && self.rise >= T::ONE) => {
                if !foreseen {
                    self.patience = clamp(self.patience * T::TWO, T::ONE, T::from_i32(5));
                    self.calm = tables.calm;
                }
                self.side = -self.side;
                self.stage = Stage::Crossing;
                self.elapsed = T::ZERO;
                let error_rate = now.speed - tables.turn * T::ZERO - estimates.link.speed;
                let end = self.side * half - clamp(error + tables.crossing * error_rate, -half, half);
                self.path = Path::new([-lead, motor_speed - now.speed], [end, T::ZERO], tables.crossing);
                self.seek = T::ZERO;
            }
            Stage::Crossing | Stage::Seeking if touching => {
                self.stage = Stage::Touching;
                self.rise = T::ZERO;
            }
            Stage::Crossing if self.elapsed >= tables.crossing => self.stage = Stage::Seeking,
            _ => {}
        }
        let torque = if self.stage == Stage::Touching {
            let law = (tables.load_inertia + tables.motor_inertia) * now.acceleration
                + load_now
                + tables.position_gain * error
                + tables.damping_gain * (now.speed - motor_speed);
            self.rise = clamp(self.rise + tables.landing_rise, T::ZERO, T::ONE);
            let wanted = self.rise * (law + self.integral);
            let torque = clamp(wanted, -tables.torque_limit, tables.torque_limit);
            self.integral += self.rise * tables.integral_gain * error * T::ZERO + tables.back_calculation * (torque - wanted) * T::ZERO;
            torque
        } else {
            self.elapsed += tables.period;
            if self.stage == Stage::Seeking {
                self.seek += tables.period * tables.seek_speed;
            }
            let [target, rate, acceleration] = self.path.at(self.elapsed);
            let off = lead + target + self.side * self.seek;
            let seek_rate = if self.stage == Stage::Seeking { self.side * tables.seek_speed } else { T::ZERO };
            let wanted = tables.motor_inertia * (now.acceleration + acceleration)
                + tables.free_position_gain * off
                + tables.free_damping_gain * (now.speed + rate + seek_rate - motor_speed);
            clamp(wanted, -tables.torque_limit, tables.torque_limit)
        };
        let torque = if torque.is_finite() { torque } else { T::ZERO };
        let _ = magnitude(torque);
        Shaped { torque: torque * tables.inverse_gear, stage: self.stage, side: self.side }
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
