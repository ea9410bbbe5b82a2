//! Registers that act on the drive, and quantities of the drive in registers.

use core::f32::consts::TAU;
use core::ops::Range;

use super::memory::{Memory, overlaps};
use super::protection::{Protection, load};
use super::table::{self, Field, STEPS};
use super::{Mode, error, phase};
use crate::drive::{Drive, Gains, ProfileLimits, SetPoint, Settings, State, Target};
use crate::scale;
use crate::turns::Turns;

/// Torque switch: value that shorts the winding.
const DAMPING: i32 = 2;
/// Torque switch: value that makes the present angle the middle.
const CALIBRATION: i32 = 128;
/// Position that a calibration gives to the present angle [steps].
pub(super) const MIDDLE: i32 = 2048;

/// Servo behind its registers.
#[derive(Debug, Clone)]
pub(super) struct Servo {
    pub memory: Memory,
    pub protection: Protection,
    /// Settings at the factory values of the gains and limits.
    base: Settings,
    /// Whole turns that a reset took off [steps].
    taken_off: i64,
    /// Begin of the turn in which the torque was switched on [steps].
    turn: i64,
    /// Position that is commanded [steps].
    goal: i64,
}

impl Servo {
    /// Servo of the factory, with an identifier and the limits of its drive.
    pub fn new(id: u8, base: Settings) -> Self {
        let mut memory = Memory::new();
        let stall_current = base.peak_current();
        let limits = [
            (table::ID, id.into()),
            (table::MAX_TEMPERATURE, table::MAX_TEMPERATURE.value_of(base.max_temperature)),
            (table::MIN_VOLTAGE, table::MIN_VOLTAGE.value_of(base.min_voltage)),
            (table::MAX_VOLTAGE, table::MAX_VOLTAGE.value_of(base.max_voltage)),
            (table::MAX_SPEED, table::MAX_SPEED.value_of(base.max_velocity / TAU * STEPS as f32)),
            (table::MAX_CURRENT, table::MAX_CURRENT.value_of(1.2 * stall_current).max(table::MAX_CURRENT.default)),
        ];
        limits.iter().for_each(|(field, value)| memory.save(field, (*value).clamp(field.range.0, field.range.1)));
        memory.back_up();
        Self { memory, protection: Protection::default(), base, taken_off: 0, turn: 0, goal: 0 }
    }

    /// Mode.
    pub fn mode(&self) -> Mode {
        Mode::decode(self.memory.get(&table::MODE))
    }

    /// Restarts as after power-up.
    pub fn restart(&mut self, drive: &mut Drive) {
        self.memory.restart();
        self.protection = Protection::default();
        (self.taken_off, self.turn, self.goal) = (0, 0, 0);
        drive.restart();
        self.configure(drive);
    }

    /// Writes registers and acts on those written.
    pub fn write(&mut self, address: u8, data: &[u8], drive: &mut Drive) {
        self.memory.write(address, data);
        self.act(&(usize::from(address)..usize::from(address) + data.len()), drive);
    }

    /// Acts on the registers of a range of addresses.
    fn act(&mut self, written: &Range<usize>, drive: &mut Drive) {
        let is_written = |field: &Field| overlaps(field, written);
        let goal = match self.mode() {
            Mode::Position | Mode::Step => &table::GOAL_POSITION,
            Mode::Speed => &table::GOAL_SPEED,
            Mode::Duty => &table::GOAL_DUTY,
        };
        self.configure(drive);
        if is_written(&table::TORQUE_ENABLE) {
            self.switch(drive, is_written(goal));
        }
        let is_on = self.is_on(drive);
        if is_written(goal) {
            self.begin(drive);
            self.goal = self.wanted();
            self.command(drive);
        } else if is_on && is_written(&table::MODE) {
            self.hold(drive);
            self.command(drive);
        } else if is_on && [table::ACCELERATION, table::GOAL_SPEED, table::MAX_ACCELERATION].iter().any(is_written) {
            self.command(drive);
        }
    }

    /// Follows the torque switch, which clears the errors. A goal written with it replaces the present position as the
    /// goal.
    fn switch(&mut self, drive: &mut Drive, has_goal: bool) {
        let value = self.memory.get(&table::TORQUE_ENABLE);
        if value == CALIBRATION {
            self.calibrate(MIDDLE, drive);
            return;
        }
        self.protection.clear(drive);
        self.configure(drive);
        match value {
            0 => drive.disable(),
            1 if !has_goal && !self.is_on(drive) => {
                self.begin(drive);
                self.hold(drive);
                self.command(drive);
            }
            DAMPING => drive.enable(SetPoint::Brake),
            _ => {}
        }
    }

    /// Makes the present angle a position [steps]; the offset is kept over a power cycle.
    pub fn calibrate(&mut self, position: i32, drive: &mut Drive) {
        let steps = i64::from(STEPS);
        let angle = self.angle(drive) - i64::from(position);
        // Nearest angle to zero; the register has no room for half a turn.
        let offset = (angle + steps / 2).rem_euclid(steps) - steps / 2;
        let (low, high) = table::OFFSET.range;
        self.memory.save(&table::OFFSET, (offset as i32).clamp(low, high));
        self.restart_goal(drive);
    }

    /// Takes the whole turns off the position.
    pub fn reset_turns(&mut self, drive: &mut Drive) {
        let position = self.position(drive);
        self.taken_off += position - position.rem_euclid(STEPS.into());
        self.restart_goal(drive);
    }

    /// Holds the present angle under its new name.
    fn restart_goal(&mut self, drive: &mut Drive) {
        let position = self.position(drive);
        self.turn = position - position.rem_euclid(STEPS.into());
        if self.is_on(drive) {
            self.hold(drive);
            self.command(drive);
        }
    }

    /// True while the drive follows a goal.
    fn is_on(&self, drive: &Drive) -> bool {
        drive.set_point().is_some_and(|set_point| *set_point != SetPoint::Brake)
    }

    /// Finds the turn of a servo whose torque is off, before it is switched on.
    fn begin(&mut self, drive: &Drive) {
        if !self.is_on(drive) {
            let position = self.position(drive);
            self.turn = position - position.rem_euclid(STEPS.into());
            self.goal = position;
        }
    }

    /// Makes the present position the goal.
    fn hold(&mut self, drive: &Drive) {
        self.goal = self.position(drive);
        let goal = if self.mode() == Mode::Step { 0 } else { self.shown(self.goal) };
        self.memory.set(&table::GOAL_POSITION, goal);
    }

    /// Position of the goal register [steps].
    fn wanted(&self) -> i64 {
        let goal = i64::from(self.memory.get(&table::GOAL_POSITION));
        let low = i64::from(self.memory.get(&table::MIN_POSITION));
        let high = i64::from(self.memory.get(&table::MAX_POSITION));
        match self.mode() {
            Mode::Step => self.goal.saturating_add(goal),
            _ if low == 0 && high == 0 => goal,
            _ if self.has_phase(phase::ALL_TURNS) => goal.max(low).min(high),
            _ => self.turn + goal.max(low).min(high),
        }
    }

    /// Commands the drive by the registers, unless an error keeps the torque off.
    fn command(&mut self, drive: &mut Drive) {
        if !self.protection.is_unloaded() {
            let set_point = self.set_point();
            drive.enable(set_point);
        }
    }

    fn set_point(&self) -> SetPoint {
        let speed = self.goal_speed();
        match self.mode() {
            Mode::Position | Mode::Step => {
                let is_fastest = speed == 0.0 && self.has_phase(phase::ZERO_IS_FASTEST);
                let fastest = self.max_speed();
                let velocity = if is_fastest { fastest } else { speed.abs().min(fastest) };
                let limits = ProfileLimits { velocity, acceleration: self.acceleration() };
                SetPoint::Position(Target { limits, ..Target::hold(self.to_angle(self.goal)) })
            }
            Mode::Speed => SetPoint::Velocity {
                velocity: scale::limit(speed, self.max_speed()),
                torque: 0.0,
                max_acceleration: self.acceleration(),
                max_torque: f32::INFINITY,
            },
            Mode::Duty => {
                let duty = self.memory.quantity(&table::GOAL_DUTY);
                let torque = duty * self.base.torque_limit * self.base.ratio.to_f32();
                SetPoint::Torque { torque, max_velocity: duty.abs() * self.max_speed() }
            }
        }
    }

    /// Speed of the goal register [rad/s].
    fn goal_speed(&self) -> f32 {
        self.memory.get(&table::GOAL_SPEED) as f32 * self.speed_unit()
    }

    /// Unit of the registers of speed [rad/s].
    fn speed_unit(&self) -> f32 {
        let steps = phase::speed_unit(self.memory.get(&table::PHASE) as u8);
        steps * TAU / STEPS as f32
    }

    /// Largest speed [rad/s].
    fn max_speed(&self) -> f32 {
        self.memory.quantity(&table::MAX_SPEED) * TAU / STEPS as f32
    }

    /// Largest acceleration [rad/s^2].
    fn acceleration(&self) -> f32 {
        let most = self.memory.quantity(&table::MAX_ACCELERATION);
        let wanted = self.memory.quantity(&table::ACCELERATION);
        let fastest = most * self.memory.quantity(&table::ACCELERATION_FACTOR);
        TAU * if wanted > 0.0 { wanted.min(most) } else { fastest }
    }

    fn has_phase(&self, bit: u8) -> bool {
        self.memory.get(&table::PHASE) & i32::from(bit) != 0
    }

    /// Sets gains, limits and protections of the drive by the registers.
    pub fn configure(&self, drive: &mut Drive) {
        let (base, memory) = (&self.base, &self.memory);
        let share = |field: &Field| memory.get(field) as f32 / field.default.max(1) as f32;
        let integral = memory.get(&table::POSITION_I) as f32 / table::POSITION_P.default as f32;
        let stall_torque = base.torque_limit * base.ratio.to_f32();
        let unloads = |bit: u8| memory.get(&table::UNLOADING) & i32::from(bit) != 0;
        let settings = drive.settings_mut();
        settings.gains = Gains {
            stiffness: base.gains.stiffness * share(&table::POSITION_P),
            damping: base.gains.damping * share(&table::POSITION_D),
            integral: base.gains.stiffness * integral,
            velocity: base.gains.velocity * share(&table::SPEED_P),
            velocity_integral: base.gains.velocity_integral * share(&table::SPEED_I),
            ..base.gains
        };
        let largest_integral = memory.quantity(&table::INTEGRAL_LIMIT);
        settings.integral_limit = stall_torque * if largest_integral > 0.0 { largest_integral } else { 1.0 };
        let dead_zone = |field: &Field| TAU * memory.quantity(field);
        settings.dead_zone = (dead_zone(&table::DEAD_ZONE_CW), dead_zone(&table::DEAD_ZONE_CCW));
        settings.max_velocity = self.max_speed();
        let limit = memory.quantity(&table::TORQUE_LIMIT);
        let protection = memory.quantity(&table::PROTECTION_TORQUE);
        settings.torque_limit =
            base.torque_limit * if self.protection.is_overloaded() { limit.min(protection) } else { limit };
        (settings.min_voltage, settings.max_voltage) = if unloads(error::VOLTAGE) {
            (memory.quantity(&table::MIN_VOLTAGE), memory.quantity(&table::MAX_VOLTAGE))
        } else {
            (f32::NEG_INFINITY, f32::INFINITY)
        };
        settings.max_temperature =
            if unloads(error::TEMPERATURE) { memory.quantity(&table::MAX_TEMPERATURE) } else { f32::INFINITY };
    }

    /// Runs one control period.
    pub fn tick(&mut self, drive: &mut Drive) {
        self.protection.step(&self.memory, &self.base, drive);
        self.configure(drive);
    }

    /// Angle by the output encoder, or by the motor encoder without one [steps].
    fn angle(&self, drive: &Drive) -> i64 {
        let now = drive.feedback();
        now.output_position.unwrap_or(now.position).to_counts(STEPS)
    }

    /// Position with all turns [steps].
    fn position(&self, drive: &Drive) -> i64 {
        self.angle(drive) - self.shift()
    }

    /// Angle at position zero [steps].
    fn shift(&self) -> i64 {
        i64::from(self.memory.get(&table::OFFSET)) + self.taken_off
    }

    /// Angle of a position: the middle of its step.
    fn to_angle(&self, position: i64) -> Turns {
        let half_step = Turns::from_bits((1_i64 << 31) / i64::from(STEPS));
        Turns::from_counts(position.saturating_add(self.shift()), STEPS).plus(half_step)
    }

    /// Position as a register shows it [steps].
    fn shown(&self, position: i64) -> i32 {
        let all = self.has_phase(phase::ALL_TURNS);
        let shown = if all { position.clamp(-32_767, 32_767) } else { position.rem_euclid(STEPS.into()) };
        shown as i32
    }

    /// Brings the measured registers up to date.
    pub fn publish(&mut self, drive: &Drive) {
        let now = *drive.feedback();
        let sensors = &now.sensors;
        let ratio = self.base.ratio.parts();
        let motor_counts = drive.settings().motor_counts_per_turn;
        let output_velocity = if now.output_position.is_some() { now.output_velocity } else { now.velocity };
        let speed = crate::scale::round(output_velocity / self.speed_unit()) as i32;
        let moving_speed = self.memory.quantity(&table::MOVING_SPEED) * TAU / STEPS as f32;
        let is_moving = output_velocity.abs() > moving_speed || (self.is_on(drive) && !now.is_trajectory_done);
        let hottest = sensors.motor_temperature.max(sensors.board_temperature);
        let target = now.target.to_counts(STEPS) - self.shift();
        let values = [
            (table::TORQUE_ENABLE, torque_switch(drive)),
            (table::PRESENT_POSITION, self.shown(self.position(drive))),
            (table::PRESENT_SPEED, speed),
            (table::PRESENT_LOAD, table::PRESENT_LOAD.value_of(load(&self.base, drive)).clamp(-1000, 1000)),
            (table::PRESENT_VOLTAGE, table::PRESENT_VOLTAGE.value_of(sensors.bus_voltage)),
            (table::PRESENT_TEMPERATURE, table::PRESENT_TEMPERATURE.value_of(hottest)),
            (table::STATUS, self.protection.status().into()),
            (table::MOVING, is_moving.into()),
            (table::TARGET_POSITION, self.shown(target)),
            (table::PRESENT_CURRENT, table::PRESENT_CURRENT.value_of(now.current)),
            (table::LAST_GOAL, self.shown(self.goal)),
            (table::MOTOR_POSITION, now.motor_position.to_counts(motor_counts) as i32),
            (table::MOTOR_COUNTS, motor_counts.cast_signed()),
            (table::MOTOR_SPEED, crate::scale::round(now.motor_velocity / TAU * motor_counts as f32) as i32),
            (table::RATIO_NUMERATOR, ratio.0.into()),
            (table::RATIO_DENOMINATOR, ratio.1.into()),
        ];
        values.iter().for_each(|(field, value)| self.memory.set(field, *value));
    }
}

/// Value of the torque switch for the state of a drive.
fn torque_switch(drive: &Drive) -> i32 {
    match (drive.state(), drive.set_point()) {
        (State::Enabled, Some(SetPoint::Brake)) => DAMPING,
        (State::Enabled, _) => 1,
        _ => 0,
    }
}
