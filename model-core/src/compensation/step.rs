//! One control period of the compensation: selects the control law, blends compensation with plain control, limits the torque.

use super::flank::FlankControl;
use super::impedance::ImpedanceLaw;
use super::inverse::BacklashInverse;
use super::load::LoadModel;
use super::plain::Plain;
use super::position::PositionLaw;
use super::set_point::{Command, CommandRef, Shaped, Stage};
use super::situation::Situation;
use super::turn::Turn;
use super::watch::{Watch, Watched};
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::{Estimates, TorqueResponse};

/// Backlash compensation of one joint.
///
/// This example moves the link by 0.1 turns in half a second. The motion after a crossing of the gap is given as well,
/// so that the motor can leave its flank in time:
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
    inverse: BacklashInverse<T>,
    /// Offset of the motor encoder against the output encoder at the link, as last valid alone or as part of the gap
    /// coordinate [rad].
    offset: T,
    /// Share of the compensation in the torque: 0 plain control, 1 compensation [-].
    trust: T,
    watch: Watch<T>,
    turn: Turn,
}

impl<'tables, T: Real> Compensation<'tables, T> {
    /// Creates a compensation in its designed state.
    pub fn new(tables: &'tables CompensationTables<T>) -> Self {
        Self {
            tables,
            load: LoadModel::new(),
            flank: FlankControl::new(),
            position: PositionLaw::new(),
            impedance: ImpedanceLaw::new(),
            plain: Plain::new(),
            inverse: BacklashInverse::new(tables),
            offset: T::ZERO,
            trust: T::ZERO,
            watch: Watch::new(tables),
            turn: Turn::Judges,
        }
    }

    /// Restores the designed state part by part: assigning a new compensation would need as much stack again.
    pub fn restart(&mut self) {
        self.load = LoadModel::new();
        self.offset = T::ZERO;
        self.watch = Watch::new(self.tables);
        self.inverse = BacklashInverse::new(self.tables);
        self.let_go();
    }

    /// Resets flank, control laws and trust; estimates of load and offset stay.
    fn let_go(&mut self) {
        self.flank = FlankControl::new();
        self.position.forget();
        self.impedance.forget();
        self.plain = Plain::new();
        self.inverse.forget_places();
        self.trust = T::ZERO;
    }

    /// Returns zero torque while the motor position is unknown, or the sign of torque or motor encoder is wrong.
    #[cold]
    fn stay_off(&mut self, stage: Stage) -> Shaped<T> {
        self.let_go();
        Shaped { stage, load: [self.load.even(), self.load.friction()], ..Shaped::default() }
    }

    /// Computes the torque of one control period from estimates and command. The torque is always finite and within the
    /// motor's limit.
    #[inline]
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> Shaped<T> {
        self.step_by_reference(estimates, command.by_reference())
    }

    /// Computes the torque of one control period from a borrowed command.
    pub fn step_by_reference(&mut self, estimates: &Estimates<T>, command: CommandRef<T>) -> Shaped<T> {
        let tables = self.tables;
        if estimates.torque_response == TorqueResponse::Reversed {
            return self.stay_off(Stage::Reversed);
        }
        if !estimates.source.allows_control() {
            return self.stay_off(Stage::Off);
        }
        let known = estimates.encoder_offset.valid || estimates.gap.valid;
        if known && estimates.encoder_offset.value.is_finite() {
            self.offset = estimates.encoder_offset.value;
        }
        let mut situation = Situation::new(tables, estimates, self.offset, command);
        // A motor that has arrived early touches its flank now and then, but the flank carries no load.
        situation.open |= self.flank.waits();
        let leans = self.flank.stage() == Stage::Touching && situation.open && situation.sees;
        if leans && matches!(command, CommandRef::Position { .. }) {
            self.load.lean(tables, self.position.heeded(&situation));
        }
        self.load.observe(tables, estimates, &situation, self.trust == T::ONE);
        let intent = match command {
            CommandRef::Position { now, ahead } => {
                if situation.feels && self.turn == Turn::Observes {
                    self.inverse.observe(tables, &situation, now);
                }
                self.position.intend(tables, &self.load, &situation, now, ahead)
            }
            CommandRef::Impedance(point) => self.impedance.intend(tables, &self.load, &situation, point),
        };
        if self.turn == Turn::Judges {
            let watched = self.watched(&situation, &command);
            // Flank changes count as hunting only while the set-point is plausible.
            let makes_sense = watched.has_error || matches!(command, CommandRef::Impedance(_));
            let acting = (self.trust > T::ZERO && situation.sees && makes_sense).then(|| self.flank.flank());
            self.watch.step(tables, &situation, &watched, acting);
        }
        let stepped_back = self.watch.is_away();
        let sees = situation.sees && intent.is_finite() && !stepped_back;
        let change = if sees { tables.law.trust_step } else { -tables.law.trust_step };
        self.trust = clamp(self.trust + change, T::ZERO, T::ONE);
        // Plain control is computed only while it has a share in the torque.
        let shares = !sees || self.trust < T::ONE;
        let alone = if shares { self.alone(&situation, &command) } else { T::ZERO };
        let compensated = if sees {
            self.flank.step(tables, &situation, &intent)
        } else {
            self.flank.forget(&situation);
            self.position.forget();
            self.impedance.forget();
            alone
        };
        let wanted = alone + self.trust * (compensated - alone);
        let may_act = wanted.is_finite() && estimates.torque_response != TorqueResponse::Tested;
        let torque = if may_act { clamp(wanted, -tables.limits.motor, tables.limits.motor) } else { T::ZERO };
        self.load.take_cut(tables, torque != wanted);
        let cut = torque - wanted;
        self.plain.take(tables, &situation, cut);
        let inverse_acts = shares && situation.feels && matches!(command, CommandRef::Position { .. });
        self.inverse.take(tables, &situation, inverse_acts.then_some(cut));
        if self.turn == Turn::Learns {
            self.inverse.learn(tables, torque);
        }
        self.turn = self.turn.next();
        let stage = if self.trust > T::ZERO { self.flank.stage() } else { Stage::Plain };
        Shaped {
            torque: torque * tables.gear.link_per_motor,
            stage,
            flank: Some(self.flank.flank()),
            demand: if sees { intent.demand_ahead } else { T::ZERO },
            load: [self.load.even(), self.load.friction()],
            trust: self.trust,
            stepped_back,
            short_of_torque: torque != wanted || sees && intent.brakes_early,
        }
    }

    /// Torque of plain control [N m].
    fn alone(&mut self, situation: &Situation<T>, command: &CommandRef<T>) -> T {
        match command {
            CommandRef::Position { now, .. } if situation.feels => {
                self.inverse.follow(self.tables, situation, now, self.load.swings())
            }
            CommandRef::Position { now, .. } => self.plain.follow(self.tables, &self.load, situation, now),
            CommandRef::Impedance(point) => self.plain.yield_to(situation, point),
        }
    }

    /// Returns the quantities of a period that the monitor judges.
    fn watched(&self, situation: &Situation<T>, command: &CommandRef<T>) -> Watched<T> {
        let (tables, load) = (self.tables, &self.load);
        match command {
            CommandRef::Position { now, .. } => {
                let planned = tables.body.load_inertia * now.acceleration + load.planned_drag(tables, now.speed);
                let most = tables.limits.braking * tables.limits.motor;
                let whole = planned + tables.body.motor_inertia * now.acceleration;
                let is_asked_too_much = (whole + load.even()).abs() > most;
                Watched {
                    planned,
                    load: load.even(),
                    // The error is not judged while the motion needs more torque than the motor has, nor above 1 rad:
                    // then set-point or reading is implausible. A loop that runs away is detected long before.
                    has_error: situation.feels && !is_asked_too_much && situation.error.abs() < T::ONE,
                    is_thrown: load.throws(tables),
                }
            }
            // In impedance mode the commanded torque, spring included, is the demand: it explains the flank that it
            // presses.
            CommandRef::Impedance(point) => Watched {
                planned: point.torque + point.stiffness * situation.error,
                load: T::ZERO,
                has_error: false,
                is_thrown: false,
            },
        }
    }
}
