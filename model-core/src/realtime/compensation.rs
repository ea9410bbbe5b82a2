//! Takes the lost motion out: from estimates and a set-point to a motor torque, once a control period. Estimating is
//! left to `observer`, limits of the motor's current to the motor controller.
//!
//! The structure, front to back:
//! 1. `position` and `impedance` turn a set-point into an [`Intent`](intent::Intent): the torque that the control law
//!    gives while a flank carries, and the torque that the teeth will have to pass on, now and one crossing later.
//! 2. `flank` decides from that which flank shall carry, and when to leave for it.
//! 3. `crossing` and `path` take the motor through the gap to where the load will be, and softly onto the flank.
//! 4. `limit` keeps what the teeth pass on within bounds.
//! 5. `load` knows what brakes the link and how that changes when the motion turns round, `habit` how motions start.
//! 6. `plain` is the same control law on the motor alone, without compensation; it takes over, blended, where the
//!    estimates are not valid.
//!
//! `docs/compensation.md` derives all of it and says where its limits are.

pub(crate) mod crossing;
mod flank;
mod habit;
mod impedance;
mod intent;
mod limit;
mod load;
mod path;
mod plain;
mod position;
mod sender;
mod set_point;

pub use set_point::{Command, ImpedancePoint, Motion, Position, Shaped, Stage};

use crate::real::Real;
use crate::realtime::arithmetic::clamp;
use crate::realtime::observer::Estimates;
use crate::tables::compensation::CompensationTables;
use flank::Flank;
use impedance::ImpedanceLaw;
use intent::Situation;
use load::LoadModel;
use plain::Plain;
use position::PositionLaw;

/// The compensation of one joint.
#[derive(Debug, Clone)]
pub struct Compensation<'tables, T: Real> {
    tables: &'tables CompensationTables<T>,
    load: LoadModel<T>,
    flank: Flank<T>,
    position: PositionLaw<T>,
    impedance: ImpedanceLaw<T>,
    plain: Plain<T>,
    /// By how much the motor's encoder leads the output's, as last vouched for alone or as part of the gap coordinate; at
    /// the output [rad].
    offset: T,
    /// 0: plain control; 1: compensation.
    trust: T,
}

impl<'tables, T: Real> Compensation<'tables, T> {
    /// A compensation that knows what was designed.
    pub fn new(tables: &'tables CompensationTables<T>) -> Self {
        Self {
            tables,
            load: LoadModel::new(),
            flank: Flank::new(),
            position: PositionLaw::new(),
            impedance: ImpedanceLaw::new(),
            plain: Plain::new(),
            offset: T::ZERO,
            trust: T::ZERO,
        }
    }

    /// Back to what was designed, part by part: a whole new compensation would need as much stack again.
    pub fn restart(&mut self) {
        self.load = LoadModel::new();
        self.flank = Flank::new();
        self.position.forget();
        self.impedance.forget();
        self.plain = Plain::new();
        self.offset = T::ZERO;
        self.trust = T::ZERO;
    }

    /// Takes the estimates and the command of one control period. The torque is always finite and within its limit.
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> Shaped<T> {
        let tables = self.tables;
        let vouched = estimates.encoder_offset.valid || estimates.gap.valid;
        if vouched && estimates.encoder_offset.value.is_finite() {
            self.offset = estimates.encoder_offset.value;
        }
        let situation = Situation::new(tables, estimates, self.offset, command);
        // Teeth that lie by a flank too early are felt now and then, but carry nothing of the load.
        let situation = Situation { open: situation.open || self.flank.waits(), ..situation };
        let leans = self.flank.stage() == Stage::Touching && situation.open && situation.sees;
        if leans && matches!(command, Command::Position { .. }) {
            self.load.lean(tables, self.position.heeded(&situation));
        }
        self.load.observe(tables, estimates, &situation);
        let (intent, plain) = match command {
            Command::Position { now, ahead } => (
                self.position.intend(tables, &self.load, &situation, now, ahead.as_ref()),
                self.plain.follow(tables, &self.load, &situation, now),
            ),
            Command::Impedance(point) => {
                (self.impedance.intend(tables, &self.load, &situation, point), self.plain.yield_to(&situation, point))
            }
        };
        let sees = situation.sees && intent.is_finite();
        let change = if sees { tables.trust_step } else { -tables.trust_step };
        self.trust = clamp(self.trust + change, T::ZERO, T::ONE);
        let compensated = if sees {
            self.flank.step(tables, &situation, &intent)
        } else {
            self.flank.forget(&situation);
            self.position.forget();
            self.impedance.forget();
            plain
        };
        let wanted = plain + self.trust * (compensated - plain);
        let torque =
            if wanted.is_finite() { clamp(wanted, -tables.torque_limit, tables.torque_limit) } else { T::ZERO };
        self.plain.take(tables, &situation, torque - wanted, self.trust);
        let stage = if self.trust > T::ZERO { self.flank.stage() } else { Stage::Plain };
        Shaped {
            torque: torque * tables.inverse_gear,
            stage,
            side: self.flank.side(),
            demand: if sees { intent.demand_ahead } else { T::ZERO },
            load: [self.load.even(), self.load.friction()],
            trust: self.trust,
        }
    }
}
