//! One control period of the compensation: selects the control law, blends compensation with plain control, limits the
//! torque.

use super::control_demand::ControlDemand;
use super::flank::FlankControl;
use super::impedance::ImpedanceLaw;
use super::inverse::BacklashInverse;
use super::load::LoadModel;
use super::loop_state::LoopState;
use super::monitor::{LoopMonitor, MonitorInput};
use super::plain::PlainControl;
use super::position::PositionLaw;
use super::set_point::{Command, CommandRef, ControlOutput, Stage};
use super::slow_task::SlowTask;
use super::thresholds::EstimateBounds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::{Layout, Reader, StateWords, Writer};
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
    plain: PlainControl<T>,
    inverse: BacklashInverse<T>,
    /// Offset of the motor encoder against the output encoder at the link, as last valid alone or as part of the gap
    /// coordinate [rad].
    encoder_offset: T,
    /// Share of the compensation in the torque: 0 plain control, 1 compensation [-].
    trust: T,
    monitor: LoopMonitor<T>,
    task: SlowTask,
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
            plain: PlainControl::new(),
            inverse: BacklashInverse::new(tables),
            encoder_offset: T::ZERO,
            trust: T::ZERO,
            monitor: LoopMonitor::new(tables),
            task: SlowTask::Monitor,
        }
    }

    /// Restores the designed state part by part: assigning a new compensation would need as much stack again.
    pub fn restart(&mut self) {
        self.load = LoadModel::new();
        self.encoder_offset = T::ZERO;
        self.monitor = LoopMonitor::new(self.tables);
        self.inverse = BacklashInverse::new(self.tables);
        self.reset_control();
    }

    /// Resets flank, control laws and trust; estimates of load and encoder offset stay.
    fn reset_control(&mut self) {
        self.flank = FlankControl::new();
        self.position.reset();
        self.impedance.reset();
        self.plain = PlainControl::new();
        self.inverse.reset_edges();
        self.trust = T::ZERO;
    }

    /// Layout of the state as words; the tables are no part of it.
    pub const STATE_LAYOUT: Layout = Layout::EMPTY
        .with("load", LoadModel::<T>::LAYOUT)
        .with("flank", FlankControl::<T>::LAYOUT)
        .with("position", PositionLaw::<T>::LAYOUT)
        .with("impedance", ImpedanceLaw::<T>::LAYOUT)
        .with("plain", PlainControl::<T>::LAYOUT)
        .with("inverse", BacklashInverse::<T>::LAYOUT)
        .with("encoder_offset", T::LAYOUT)
        .with("trust", T::LAYOUT)
        .with("monitor", LoopMonitor::<T>::LAYOUT)
        .with("task", SlowTask::LAYOUT);

    /// Writes the state as `STATE_LAYOUT.words` words. A compensation of the same tables that reads them continues with
    /// equal bits.
    pub fn write_state(&self, to: &mut Writer) {
        let Self { tables: _, load, flank, position, impedance, plain, inverse, encoder_offset, trust, monitor, task } =
            self;
        load.write(to);
        flank.write(to);
        position.write(to);
        impedance.write(to);
        plain.write(to);
        inverse.write(to);
        encoder_offset.write(to);
        trust.write(to);
        monitor.write(to);
        task.write(to);
    }

    /// Replaces the state by one that was written by a compensation of the same tables.
    pub fn read_state(&mut self, from: &mut Reader) {
        let Self { tables: _, load, flank, position, impedance, plain, inverse, encoder_offset, trust, monitor, task } =
            self;
        load.read_in_place(from);
        flank.read_in_place(from);
        position.read_in_place(from);
        impedance.read_in_place(from);
        plain.read_in_place(from);
        inverse.read_in_place(from);
        encoder_offset.read_in_place(from);
        trust.read_in_place(from);
        monitor.read_in_place(from);
        task.read_in_place(from);
    }

    /// Returns zero torque while the motor position is unknown, or the sign of torque or motor encoder is wrong.
    #[cold]
    fn stay_off(&mut self, stage: Stage) -> ControlOutput<T> {
        self.reset_control();
        ControlOutput { stage, load: [self.load.gravity_torque(), self.load.friction()], ..ControlOutput::default() }
    }

    /// Computes the torque of one control period from estimates and command. The torque is always finite and within the
    /// motor's limit.
    #[inline]
    pub fn step(&mut self, estimates: &Estimates<T>, command: &Command<T>) -> ControlOutput<T> {
        self.step_by_reference(estimates, command.by_reference())
    }

    /// Computes the torque of one control period from a borrowed command.
    pub fn step_by_reference(&mut self, estimates: &Estimates<T>, command: CommandRef<T>) -> ControlOutput<T> {
        let tables = self.tables;
        if estimates.torque_response == TorqueResponse::Reversed {
            return self.stay_off(Stage::Reversed);
        }
        if !estimates.source.allows_control() {
            return self.stay_off(Stage::Off);
        }
        let state = self.loop_state(estimates, command);
        self.update_load(estimates, &state, command);
        let demand = self.demand(&state, command);
        if self.task == SlowTask::Monitor {
            self.monitor(&state, &command);
        }
        let stepped_back = self.monitor.is_tripped();
        let acts = state.gap_known && demand.is_finite() && !stepped_back;
        let change = if acts { tables.law.trust_step } else { -tables.law.trust_step };
        self.trust = clamp(self.trust + change, T::ZERO, T::ONE);
        // Plain control is computed only while it has a share in the torque.
        let plain_acts = !acts || self.trust < T::ONE;
        let plain_torque = if plain_acts { self.plain_torque(&state, &command) } else { T::ZERO };
        let compensated = if acts {
            self.flank.step(tables, &state, &demand)
        } else {
            self.flank.reset(&state);
            self.position.reset();
            self.impedance.reset();
            plain_torque
        };
        let wanted = plain_torque + self.trust * (compensated - plain_torque);
        let may_act = wanted.is_finite() && estimates.torque_response != TorqueResponse::Tested;
        let torque = if may_act { clamp(wanted, -tables.limits.motor, tables.limits.motor) } else { T::ZERO };
        self.apply_torque(&state, command, torque, wanted, plain_acts);
        ControlOutput {
            torque: torque * tables.gear.link_per_motor,
            stage: if self.trust > T::ZERO { self.flank.stage() } else { Stage::Plain },
            flank: Some(self.flank.flank()),
            demand: if acts { demand.after_crossing } else { T::ZERO },
            load: [self.load.gravity_torque(), self.load.friction()],
            trust: self.trust,
            stepped_back,
            short_of_torque: torque != wanted || acts && demand.brakes_early,
        }
    }

    /// Computes the state of the loop, with the encoder offset as last known.
    fn loop_state(&mut self, estimates: &Estimates<T>, command: CommandRef<T>) -> LoopState<T> {
        let known = estimates.encoder_offset.valid || estimates.gap.valid;
        if known && estimates.encoder_offset.value.is_finite() {
            self.encoder_offset = estimates.encoder_offset.value;
        }
        let mut state = LoopState::new(self.tables, estimates, self.encoder_offset, command);
        // A motor that has arrived early touches its flank now and then, but the flank carries no load.
        state.teeth_open |= self.flank.arrived_early();
        state
    }

    /// Updates the load model. Where a flank should carry but the teeth are open, position mode integrates the error.
    fn update_load(&mut self, estimates: &Estimates<T>, state: &LoopState<T>, command: CommandRef<T>) {
        let flank_missing = self.flank.stage() == Stage::Touching && state.teeth_open && state.gap_known;
        if flank_missing && matches!(command, CommandRef::Position { .. }) {
            self.load.integrate_error(self.tables, self.position.error_beyond_deadband(state));
        }
        self.load.update(self.tables, estimates, state, self.trust == T::ONE);
    }

    /// Computes the demand of the control law of the command's mode.
    fn demand(&mut self, state: &LoopState<T>, command: CommandRef<T>) -> ControlDemand<T> {
        match command {
            CommandRef::Position { now, ahead } => {
                if state.link_seen && self.task == SlowTask::UpdateEdges {
                    self.inverse.update_edges(self.tables, state, now);
                }
                self.position.demand(self.tables, &self.load, state, now, ahead)
            }
            CommandRef::Impedance(point) => self.impedance.demand(self.tables, &self.load, state, point),
        }
    }

    /// Lets the monitor judge the loop. Flank changes count as hunting only while the set-point is plausible.
    fn monitor(&mut self, state: &LoopState<T>, command: &CommandRef<T>) {
        let input = self.monitor_input(state, command);
        let set_point_plausible = input.has_error || matches!(command, CommandRef::Impedance(_));
        let acting = (self.trust > T::ZERO && state.gap_known && set_point_plausible).then(|| self.flank.flank());
        self.monitor.step(self.tables, state, &input, acting);
    }

    /// Tells load model, plain control and inverse the torque that the limit has left of the wanted torque [N m].
    fn apply_torque(&mut self, state: &LoopState<T>, command: CommandRef<T>, torque: T, wanted: T, plain_acts: bool) {
        let cut = torque - wanted;
        self.load.record_saturation(self.tables, torque != wanted);
        self.plain.update(self.tables, state, cut);
        let inverse_acts = plain_acts && state.link_seen && matches!(command, CommandRef::Position { .. });
        self.inverse.update_integral(self.tables, state, inverse_acts.then_some(cut));
        if self.task == SlowTask::EstimateDemand {
            self.inverse.estimate(self.tables, torque);
        }
        self.task = self.task.following();
    }

    /// Torque of plain control [N m].
    fn plain_torque(&mut self, state: &LoopState<T>, command: &CommandRef<T>) -> T {
        match command {
            CommandRef::Position { now, .. } if state.link_seen => {
                self.inverse.torque(self.tables, state, now, self.load.payload_swings())
            }
            CommandRef::Position { now, .. } => self.plain.torque(self.tables, &self.load, state, now),
            CommandRef::Impedance(point) => self.plain.impedance_torque(state, point),
        }
    }

    /// Returns the quantities of a period that the monitor judges.
    fn monitor_input(&self, state: &LoopState<T>, command: &CommandRef<T>) -> MonitorInput<T> {
        let (tables, load) = (self.tables, &self.load);
        match command {
            CommandRef::Position { now, .. } => {
                let planned = tables.body.load_inertia * now.acceleration + load.planned_friction(tables, now.speed);
                let most = tables.limits.braking * tables.limits.motor;
                let whole = planned + tables.body.motor_inertia * now.acceleration;
                let exceeds_motor = (whole + load.gravity_torque()).abs() > most;
                MonitorInput {
                    planned,
                    load: load.gravity_torque(),
                    // The error is not judged while the motion needs more torque than the motor has, nor above 1 rad:
                    // then set-point or reading is implausible. A loop that runs away is detected long before.
                    has_error: state.link_seen
                        && !exceeds_motor
                        && state.error.abs() < EstimateBounds::<T>::TUNED.implausible_error,
                    external_impact: load.external_impact(tables),
                }
            }
            // In impedance mode the commanded torque, spring included, is the demand: it explains the flank that it
            // presses.
            CommandRef::Impedance(point) => MonitorInput {
                planned: point.torque + point.stiffness * state.error,
                load: T::ZERO,
                has_error: false,
                external_impact: false,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use parameters::ContactState;

    use super::*;
    use crate::compensation::set_point::Motion;
    use crate::compensation::test_bench::tables;
    use crate::observer::Source;

    /// Estimates of a joint that touches its drive flank.
    fn estimates() -> Estimates<f64> {
        let mut estimates = Estimates { source: Source::Both, contact_valid: true, ..Estimates::default() };
        estimates.reported_contact = ContactState::DriveSide;
        (estimates.gap.valid, estimates.half_backlash.valid) = (true, true);
        (estimates.half_backlash.value, estimates.compliance.value) = (2e-3, 1e-3);
        // The gap coordinate is a deflection of both meshes, twice the travel of the link.
        (estimates.gap.value, estimates.motor_lead) = (4e-3, 2e-3);
        estimates
    }

    fn command(acceleration: f64) -> Command<f64> {
        Command::Position { now: Motion { acceleration, ..Motion::default() }, ahead: None }
    }

    #[test]
    fn unknown_motor_gives_no_torque() {
        let tables = tables();
        let output = Compensation::new(&tables).step(&Estimates::default(), &command(1.0));
        assert_eq!((output.torque, output.stage, output.flank), (0.0, Stage::Off, None));
    }

    #[test]
    fn trust_grows_to_one_and_falls_with_the_gap() {
        let tables = tables();
        let mut compensation = Compensation::new(&tables);
        let first = compensation.step(&estimates(), &command(0.0));
        assert_eq!((first.trust, first.stage), (0.1, Stage::Touching));
        let last = (0..12).fold(first, |_, _| compensation.step(&estimates(), &command(0.0)));
        assert_eq!(last.trust, 1.0);
        let mut blind = estimates();
        blind.gap.valid = false;
        assert!((compensation.step(&blind, &command(0.0)).trust - 0.9).abs() < 1e-12);
    }

    #[test]
    fn torque_is_cut_at_the_motor_limit() {
        let tables = tables();
        let output = Compensation::new(&tables).step(&estimates(), &command(100.0));
        assert_eq!(output.torque, 10.0 * (1.0 / 6.0));
        assert!(output.short_of_torque);
    }

    #[test]
    fn set_point_that_is_not_finite_gives_no_torque() {
        let tables = tables();
        for acceleration in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let output = Compensation::new(&tables).step(&estimates(), &command(acceleration));
            assert!(output.torque.is_finite() && output.demand == 0.0, "{acceleration}: {}", output.torque);
        }
    }

    #[test]
    fn error_of_a_radian_is_not_judged() {
        let tables = tables();
        let command = command(0.0);
        let is_judged = |error: f64| {
            let state = LoopState { error, ..crate::compensation::test_bench::state() };
            Compensation::new(&tables).monitor_input(&state, &command.by_reference()).has_error
        };
        assert_eq!([0.99, -0.99, 1.01, -1.01].map(is_judged), [true, true, false, false]);
    }
}
