//! One control period of the compensation: the law that the command asks for, which flank carries it, and the torque.

use super::flank::FlankControl;
use super::impedance::ImpedanceLaw;
use super::load::LoadModel;
use super::plain::Plain;
use super::position::PositionLaw;
use super::set_point::{Command, Shaped, Stage};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::Estimates;

/// The compensation of one joint.
#[derive(Debug, Clone)]
pub struct Compensation<'tables, T: Real> {
    tables: &'tables CompensationTables<T>,
    load: LoadModel<T>,
    flank: FlankControl<T>,
    position: PositionLaw<T>,
    impedance: ImpedanceLaw<T>,
    plain: Plain<T>,
    /// By how much the motor's encoder leads the output's, as last valid alone or as part of the gap coordinate; at
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
            flank: FlankControl::new(),
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
        self.flank = FlankControl::new();
        self.position.forget();
        self.impedance.forget();
        self.plain = Plain::new();
        self.offset = T::ZERO;
        self.trust = T::ZERO;
    }

    /// Takes the estimates and the command of one control period. The torque is always finite and within its limit.
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> Shaped<T> {
        let tables = self.tables;
        let known = estimates.encoder_offset.valid || estimates.gap.valid;
        if known && estimates.encoder_offset.value.is_finite() {
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
        let change = if sees { tables.law.trust_step } else { -tables.law.trust_step };
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
            if wanted.is_finite() { clamp(wanted, -tables.limits.motor, tables.limits.motor) } else { T::ZERO };
        self.plain.take(tables, &situation, torque - wanted, self.trust);
        let stage = if self.trust > T::ZERO { self.flank.stage() } else { Stage::Plain };
        Shaped {
            torque: torque * tables.gear.link_per_motor,
            stage,
            flank: Some(self.flank.flank()),
            demand: if sees { intent.demand_ahead } else { T::ZERO },
            load: [self.load.even(), self.load.friction()],
            trust: self.trust,
        }
    }
}
