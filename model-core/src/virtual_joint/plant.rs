//! Real-time plant: the fixed step of the gears with motor, current loop, frictions, weight and encoders, one control
//! period at a time. Torques are constant over a period; friction can stick. There is no noise, so that equal commands
//! give equal bits everywhere.
//!
//! ```text
//! air gap   i += (u - i) rise,   torque = (u - (u - i) lacking) gain,   u = command, delayed
//! friction  viscous w + clamp(stop w + driving - viscous w, -dry, dry)
//!           dry = coulomb + rise/(1 + (w/w_half)^2) + loss
//! encoder   counts(angle - lag w + once sin(angle) + twice sin(2 angle))
//! ```
//!
//! Symbols: the fields of [`SurroundingsTable`], [`CurrentLoopTable`](super::tables::CurrentLoopTable),
//! [`FrictionTable`] and [`EncoderErrorTable`]; w = speed of the shaft, 1/w_half = `per_speed`, stop = inertia/period.

use crate::gears::Tables;
use crate::gears::{Model, Outputs, State, Torques};
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::numbers::state_words::state_words;
use crate::observer::{Reading, Samples};
use crate::virtual_joint::tables::{
    COMMAND_QUEUE_LENGTH, EncoderErrorTable, FrictionTable, SurroundingsTable, VirtualJointDesign,
};

/// Passes of [`VirtualJoint::advance_with_link`].
const LINK_PASSES: usize = 3;

/// Torques of the last period [N m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ActingTorques<T: Real> {
    /// Torque in the motor's air gap.
    pub air_gap: T,
    /// Torque on the sun, friction and cogging included.
    pub drive: T,
    /// Torque that brakes the link: friction, weight, disturbance.
    pub load: T,
}

state_words! { struct ActingTorques<T> { air_gap, drive, load } }

/// Link that another simulator moves, over one control period: `acceleration of the link = torque of the gears *
/// inverse_inertia + acceleration`. Weight and friction of the link belong to the other simulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrivenLink<T: Real> {
    /// Inverse of the inertia that the joint sees at its output [1/(kg m2)].
    pub inverse_inertia: T,
    /// Acceleration of the link without a torque of the gears [rad/s2].
    pub acceleration: T,
}

/// State of a virtual joint between periods, without references to tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualJointState<T: Real, const N: usize> {
    /// State of the gears.
    pub gears: State<T, N>,
    /// Delayed commands, the newest first [N m].
    pub commands: [T; COMMAND_QUEUE_LENGTH],
    /// Torque that the current loop has reached [N m].
    pub current: T,
    /// Control periods since the start.
    pub periods: u32,
    /// Torques of the last period.
    pub acting: ActingTorques<T>,
}

state_words! { struct VirtualJointState<T, P> { gears, commands, current, periods, acting } }

/// Joint with its surroundings.
///
/// ```
/// use model_core::{VirtualJoint, VirtualJointDesign};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let design = VirtualJointDesign::new(&q1, 10_000)?;
/// let mut joint = design.joint();
/// let turned = |joint: &mut VirtualJoint<'_, f32, 3>, torque: f32| {
///     (0..500).for_each(|_| joint.advance(torque, 0.0));
///     joint.samples().output.unwrap().counts
/// };
/// // Dry friction of 0.03 N m at the motor holds against 0.02 N m, but not against 1 N m.
/// assert_eq!(turned(&mut joint, 0.02), 0);
/// assert!(turned(&mut joint, 1.0) > 100);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct VirtualJoint<'tables, T: Real, const N: usize> {
    model: Model<'tables, T, N>,
    table: &'tables SurroundingsTable<T>,
    /// Delayed commands, the newest first.
    commands: [T; COMMAND_QUEUE_LENGTH],
    current: T,
    periods: u32,
    acting: ActingTorques<T>,
    /// Outputs of the gears, and the resulting motion of the shafts.
    outputs: Outputs<T, N>,
    shafts: Shafts<T>,
}

/// Angles and speeds of both shafts.
#[derive(Debug, Clone, Copy, Default)]
struct Shafts<T: Real> {
    /// Angles [2^-32 turns]: the motor's within its turn, the link's with its turns.
    motor: u32,
    link: i64,
    /// Speeds [rad/s].
    speeds: [T; 2],
}

impl<T: Real, const N: usize> VirtualJointDesign<N, T> {
    /// Creates a joint at rest at angle zero, with the teeth in the middle of their gap.
    pub fn joint(&self) -> VirtualJoint<'_, T, N> {
        VirtualJoint::new(&self.gears, &self.surroundings)
    }
}

impl<'tables, T: Real, const N: usize> VirtualJoint<'tables, T, N> {
    /// Creates a joint at rest at angle zero, with the teeth in the middle of their gap.
    pub fn new(tables: &'tables Tables<T, N>, table: &'tables SurroundingsTable<T>) -> Self {
        let model = Model::new(tables);
        let mut joint = Self {
            outputs: model.outputs(),
            shafts: Shafts::default(),
            model,
            table,
            commands: [T::ZERO; COMMAND_QUEUE_LENGTH],
            current: T::ZERO,
            periods: 0,
            acting: ActingTorques::default(),
        };
        joint.update_outputs();
        joint
    }

    /// Updates outputs and shafts after a step.
    #[inline(never)]
    fn update_outputs(&mut self) {
        self.outputs = self.model.outputs();
        self.shafts = self.shafts();
    }

    /// Returns to rest at angle zero.
    pub fn reset(&mut self) {
        self.model.reset();
        self.commands = [T::ZERO; COMMAND_QUEUE_LENGTH];
        self.current = T::ZERO;
        self.periods = 0;
        self.acting = ActingTorques::default();
        self.update_outputs();
    }

    /// Model of the gears.
    pub fn model(&self) -> &Model<'tables, T, N> {
        &self.model
    }

    /// Present motion of the gears.
    pub fn outputs(&self) -> &Outputs<T, N> {
        &self.outputs
    }

    /// Torques of the last period.
    pub fn acting(&self) -> ActingTorques<T> {
        self.acting
    }

    /// Speed of the motor [rad/s].
    pub fn motor_speed(&self) -> T {
        self.shafts.speeds[0]
    }

    /// Speed of the link [rad/s].
    pub fn link_speed(&self) -> T {
        self.shafts.speeds[1]
    }

    /// Present measurements: counts within the encoders' turns, and the last commanded torque.
    pub fn samples(&self) -> Samples<T> {
        let (table, shafts) = (self.table, self.shafts);
        let time = self.periods.wrapping_mul(table.clock_ticks);
        let [motor, output] = &table.encoders;
        Samples {
            time,
            motor: Reading { counts: counts(motor, shafts.motor.into(), shafts.speeds[0]), time },
            output: Some(Reading { counts: counts(output, shafts.link, shafts.speeds[1]), time }),
            torque: self.commands[0],
        }
    }

    /// Whole turns in the output encoder's present reading, if the encoder reads `zero` at angle zero [2^-32 turns]:
    /// the observer counts the link's turns from the turn of its first reading.
    pub fn output_turn(&self, zero: u32) -> i32 {
        let reading = reading(&self.table.encoders[1], self.shafts.link, self.shafts.speeds[1]);
        (reading.wrapping_add(zero.into()) >> 32) as i32
    }

    /// Advances by one period under a torque command and a torque that brakes the link [N m]. The parts of the work are
    /// not inlined: each needs much stack, but not at the same time.
    #[inline(never)]
    pub fn advance(&mut self, command: T, disturbance: T) {
        self.compute_torques(command, disturbance);
        self.model.step(Torques { drive: self.acting.drive, load: self.acting.load });
        self.periods = self.periods.wrapping_add(1);
        self.update_outputs();
    }

    /// Advances by one period under a torque command [N m] and the motion of a link that another simulator moves, and
    /// returns the mean torque of the gears on the link [N m]. The link's own inertia, weight and friction in the tables
    /// have no effect.
    ///
    /// ```text
    /// load = torque - inertia (torque inverse_inertia + acceleration),   torque = load + inertia (w_end - w_start)/period
    /// ```
    ///
    /// Both equations hold at once for one load; three passes approach it. The error of a pass is the error of the pass
    /// before times `stiffness period^2 |1/inertia - inverse_inertia| / 6`.
    #[inline(never)]
    pub fn advance_with_link(&mut self, command: T, link: DrivenLink<T>) -> T {
        let table = self.table;
        let mesh_torque = self.compute_drive(command);
        let inertia = table.load_friction.stop * table.period;
        let start = self.shafts.speeds[1];
        let before = self.model.clone();
        let mut torque = self.torque_on_link(mesh_torque);
        for _ in 0..LINK_PASSES {
            self.model.clone_from(&before);
            self.acting.load = torque - inertia * (torque * link.inverse_inertia + link.acceleration);
            self.model.step(Torques { drive: self.acting.drive, load: self.acting.load });
            self.update_outputs();
            torque = self.acting.load + table.load_friction.stop * (self.shafts.speeds[1] - start);
        }
        self.periods = self.periods.wrapping_add(1);
        torque
    }

    /// Turns the whole joint by an angle [turns] and changes its speed [rad/s, at the link]; deformations stay.
    pub fn shift(&mut self, turns: i32, fraction: T, speed: T) {
        let mut state = *self.model.state();
        let units = (fraction * self.table.turn * self.table.units_per_radian).to_i64();
        let carrier = (i64::from(state.rigid.turns) << 32)
            .wrapping_add((state.rigid.fraction >> 32) as i64)
            .wrapping_add(i64::from(turns) << 32)
            .wrapping_add(units);
        let below = state.rigid.fraction & u64::from(u32::MAX);
        state.rigid.turns = (carrier >> 32) as i32;
        state.rigid.fraction = ((carrier as u64) << 32) | below;
        // Speed of the rigid body [2^-64 turns per period] from 2^-32 turns per second.
        let change = (speed * self.table.units_per_radian * self.table.period).to_i64();
        state.rigid.speed = state.rigid.speed.saturating_add(change.saturating_mul(1 << 32));
        self.model.set_state(state);
        self.update_outputs();
    }

    /// Returns the state.
    pub fn state(&self) -> VirtualJointState<T, N> {
        let (commands, current, periods, acting) = (self.commands, self.current, self.periods, self.acting);
        VirtualJointState { gears: *self.model.state(), commands, current, periods, acting }
    }

    /// Replaces the state. A period after it is computed without what the gears keep from the period before, so that it
    /// depends on the state alone.
    pub fn set_state(&mut self, state: &VirtualJointState<T, N>) {
        self.model.set_state(state.gears);
        (self.commands, self.current, self.periods) = (state.commands, state.current, state.periods);
        self.acting = state.acting;
        self.update_outputs();
    }

    /// Computes the torques that act over the period.
    #[inline(never)]
    fn compute_torques(&mut self, command: T, disturbance: T) {
        let mesh_torque = self.compute_drive(command);
        self.compute_load(disturbance, mesh_torque);
    }

    /// Computes the torques in the air gap and on the sun over the period, and returns the mesh torque at its start.
    #[inline(always)]
    fn compute_drive(&mut self, command: T) -> T {
        let table = self.table;
        self.commands.rotate_right(1);
        let limit = table.current.limit;
        self.commands[0] = if command.is_finite() { clamp(command, -limit, limit) } else { T::ZERO };
        let air_gap = self.air_gap();
        let shafts = self.shafts;
        let (sine, _) = sine_cosine::<T>(shafts.motor.wrapping_mul(table.cogging_periods));
        let driving = air_gap + table.cogging_torque * sine;
        let mesh_torque = self.mesh_torque();
        let motor_speed = shafts.speeds[0];
        let loss = table.losses[usize::from(mesh_torque * motor_speed < T::ZERO)] * mesh_torque.abs();
        let motor_friction = friction(&table.motor_friction, motor_speed, driving - mesh_torque, loss);
        (self.acting.air_gap, self.acting.drive) = (air_gap, driving - motor_friction);
        mesh_torque
    }

    /// Computes the torque that brakes the link over the period.
    #[inline(always)]
    fn compute_load(&mut self, disturbance: T, mesh_torque: T) {
        let (table, shafts) = (self.table, self.shafts);
        let (sine, _) = sine_cosine::<T>(shafts.link as u32);
        let braking = table.weight * sine + disturbance;
        let to_link = self.torque_on_link(mesh_torque);
        let load_friction = friction(&table.load_friction, shafts.speeds[1], to_link - braking, T::ZERO);
        self.acting.load = braking + load_friction;
    }

    /// Present torque of the gears on the link at the present mesh torque [N m].
    #[inline(always)]
    fn torque_on_link(&self, mesh_torque: T) -> T {
        let [from_sun, from_wind_up, from_rate] = self.table.to_link;
        from_sun * mesh_torque + from_wind_up * self.outputs.wind_up + from_rate * self.model.state().rate.wind_up
    }

    /// Mean torque in the air gap over this period.
    fn air_gap(&mut self) -> T {
        let table = &self.table.current;
        let delayed_command = self.commands.get(table.delay as usize).copied().unwrap_or(T::ZERO);
        let command_step = delayed_command - self.current;
        self.current += command_step * table.rise;
        (delayed_command - command_step * table.lacking) * table.gain
    }

    /// Torque from the sun to the planets, by mesh stiffness alone [N m].
    pub fn mesh_torque(&self) -> T {
        let table = self.table;
        let meshes = self.outputs.deflections[0].iter().zip(&table.half_backlash);
        let penetration =
            meshes.fold(T::ZERO, |sum, (deflection, half)| sum + *deflection - clamp(*deflection, -*half, *half));
        table.sun_torque * penetration
    }

    fn shafts(&self) -> Shafts<T> {
        let (table, outputs) = (self.table, &self.outputs);
        let state = self.model.state();
        let [turns_of_motor, turns_of_link] = table.ratio;
        // Whole turns and remainder are computed separately to avoid overflow.
        let rest = u64::from(outputs.carrier_fraction).wrapping_mul(turns_of_motor.into());
        let rigid = if turns_of_link == 1 {
            rest
        } else {
            let turns = i64::from(outputs.carrier_turns).wrapping_mul(turns_of_motor.into());
            let left = turns.checked_rem_euclid(turns_of_link.into()).unwrap_or(0) as u64;
            (left << 32).wrapping_add(rest).checked_div(turns_of_link.into()).unwrap_or(0)
        };
        let motor_offset = (table.units_per_radian * outputs.motor_offset).to_i64();
        let link_offset = (table.units_per_radian * outputs.link_offset).to_i64();
        let carrier = (i64::from(outputs.carrier_turns) << 32) | i64::from(outputs.carrier_fraction);
        let planets = state.rate.planets.iter().fold(T::ZERO, |sum, rate| sum + *rate);
        let beyond = |gains: &[T; 3]| gains[0] * planets + gains[1] * state.rate.gap + gains[2] * state.rate.wind_up;
        Shafts {
            motor: (rigid as i64).wrapping_add(motor_offset) as u32,
            link: carrier.wrapping_add(link_offset),
            speeds: [
                table.gear * outputs.carrier_speed + beyond(&table.motor_rate),
                outputs.carrier_speed + beyond(&table.link_rate),
            ],
        }
    }
}

/// Counts of an encoder within a turn.
fn counts<T: Real>(table: &EncoderErrorTable<T>, angle: i64, speed: T) -> u32 {
    table.counts(reading(table, angle, speed) as u32)
}

/// Angle read by an encoder with its errors [2^-32 turns].
fn reading<T: Real>(table: &EncoderErrorTable<T>, angle: i64, speed: T) -> i64 {
    let then = angle.wrapping_sub((table.lag * speed).to_i64());
    let phase = then as u32;
    let (once, _) = sine_cosine::<T>(phase);
    let (twice, _) = sine_cosine::<T>(phase.wrapping_mul(2));
    then.wrapping_add((table.errors[0] * once + table.errors[1] * twice).to_i64())
}

/// Friction torque against a shaft's motion. Dry friction is at most the torque that stops the shaft within the period,
/// so that the shaft sticks.
fn friction<T: Real>(table: &FrictionTable<T>, speed: T, driving: T, extra: T) -> T {
    let part = speed * table.per_speed;
    let dry = table.coulomb + table.rise / (T::ONE + part * part) + extra;
    let viscous = table.viscous * speed;
    viscous + clamp(table.stop * speed + driving - viscous, -dry, dry)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: FrictionTable<f64> =
        FrictionTable { coulomb: 2.0, viscous: 0.5, rise: 1.0, per_speed: 10.0, stop: 1000.0 };

    #[test]
    fn shaft_at_rest_sticks_up_to_its_friction_at_rest() {
        assert_eq!([2.9, -2.9, 3.1].map(|driving| friction(&TABLE, 0.0, driving, 0.0)), [2.9, -2.9, 3.0]);
    }

    #[test]
    fn sliding_shaft_is_braked_against_its_motion() {
        let [forward, back] = [1.0, -1.0].map(|speed| friction(&TABLE, speed, 0.0, 0.0));
        assert!(forward == -back && (forward - (0.5 + 2.0 + 1.0 / 101.0)).abs() < 1e-12);
    }

    #[test]
    fn half_of_the_rise_is_left_at_its_speed() {
        assert!((friction(&TABLE, 0.1, 0.0, 0.0) - (0.05 + 2.0 + 0.5)).abs() < 1e-12);
    }

    #[test]
    fn losses_of_the_gears_add_to_the_dry_friction() {
        assert_eq!(friction(&TABLE, 0.0, 9.0, 4.0), 7.0);
    }

    #[test]
    fn slow_shaft_is_stopped_within_the_period() {
        assert_eq!(friction(&FrictionTable { viscous: 0.0, ..TABLE }, 1e-3, 0.0, 0.0), 1.0);
    }
}
