//! One control period of the compensation: the law that the command asks for, which flank carries it, and the torque.

use super::flank::FlankControl;
use super::impedance::ImpedanceLaw;
use super::load::LoadModel;
use super::plain::Plain;
use super::position::PositionLaw;
use super::set_point::{Command, CommandRef, Shaped, Stage};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::Estimates;

/// The compensation of one joint.
///
/// The link goes to 0.1 turns in half a second and stays there. Where it will have to be after a crossing of the gap is
/// known beforehand, so that the motor can leave its flank in time:
///
/// ```
/// use model_core::compensation::design::{compensation_settings, design_compensation};
/// use model_core::compensation::{Command, Compensation, Motion, Position};
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::{MAPPED, Observer, design::{design_observer, observer_settings}};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let observer_tables = design_observer(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let tables = design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, 60.0))?;
/// let mut joint = VirtualJoint::new(&gears, &around);
/// let mut observer = Observer::<f32, MAPPED>::new(&observer_tables);
/// let mut compensation = Compensation::new(&tables);
/// let motion = |time: f32| {
///     let s = (2.0 * time).min(1.0);
///     let (speed, acceleration) = (7.54 * (s - s * s), 15.08 * (1.0 - 2.0 * s) * f32::from(u8::from(s < 1.0)));
///     Motion { position: Position { turns: 0, fraction: 0.1 * s * s * (3.0 - 2.0 * s) }, speed, acceleration }
/// };
/// for period in 0..20_000 {
///     let time = tables.clock.period * period as f32;
///     let command = Command::Position { now: motion(time), ahead: Some(motion(time + tables.crossing.lead)) };
///     let shaped = compensation.step(observer.step(&joint.samples()), &command);
///     assert!(shaped.torque.abs() <= 2.5, "the motor's limit");
///     joint.advance(shaped.torque, 0.0);
/// }
/// let error_turns = observer.estimates().link.fraction - 0.1;
/// assert!(error_turns.abs() < 0.001 / 6.28, "within 1 mrad, though the gap is of 3.8 mrad");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
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
        self.offset = T::ZERO;
        self.let_go();
    }

    /// Forgets what was on its way; what was learnt of load and offset stays.
    fn let_go(&mut self) {
        self.flank = FlankControl::new();
        self.position.forget();
        self.impedance.forget();
        self.plain = Plain::new();
        self.trust = T::ZERO;
    }

    /// No torque while it is not known where the motor is.
    #[cold]
    fn stay_off(&mut self) -> Shaped<T> {
        self.let_go();
        Shaped { stage: Stage::Off, load: [self.load.even(), self.load.friction()], ..Shaped::default() }
    }

    /// Takes the estimates and the command of one control period. The torque is always finite and within its limit.
    #[inline]
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> Shaped<T> {
        self.step_by_reference(estimates, command.by_reference())
    }

    /// The same with a command that lies elsewhere.
    pub fn step_by_reference(&mut self, estimates: &Estimates<T>, command: CommandRef<T>) -> Shaped<T> {
        let tables = self.tables;
        if !estimates.source.has_motor() {
            return self.stay_off();
        }
        let known = estimates.encoder_offset.valid || estimates.gap.valid;
        if known && estimates.encoder_offset.value.is_finite() {
            self.offset = estimates.encoder_offset.value;
        }
        let situation = Situation::new(tables, estimates, self.offset, command);
        // Teeth that lie by a flank too early are felt now and then, but carry nothing of the load.
        let situation = Situation { open: situation.open || self.flank.waits(), ..situation };
        let leans = self.flank.stage() == Stage::Touching && situation.open && situation.sees;
        if leans && matches!(command, CommandRef::Position { .. }) {
            self.load.lean(tables, self.position.heeded(&situation));
        }
        self.load.observe(tables, estimates, &situation);
        let (intent, plain) = match command {
            CommandRef::Position { now, ahead } => (
                self.position.intend(tables, &self.load, &situation, now, ahead),
                self.plain.follow(tables, &self.load, &situation, now),
            ),
            CommandRef::Impedance(point) => {
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
        self.load.take_cut(tables, torque != wanted);
        self.plain.take(tables, &situation, torque - wanted, self.trust);
        let stage = if self.trust > T::ZERO { self.flank.stage() } else { Stage::Plain };
        Shaped {
            torque: torque * tables.gear.link_per_motor,
            stage,
            flank: Some(self.flank.flank()),
            demand: if sees { intent.demand_ahead } else { T::ZERO },
            load: [self.load.even(), self.load.friction()],
            trust: self.trust,
            short_of_torque: torque != wanted || sees && intent.brakes_early,
        }
    }
}
