//! Command of a drive: its registers, and the set-point that they ask for.

use core::f32::consts::TAU;

use super::register as r;
use super::value::{Content, Value};
use crate::drive::{Drive, Fault, ProfileLimits, SetPoint, Target};
use crate::scale;
use crate::turns::Turns;

/// Largest torque of the damping after a timeout [N m]: `servo.timeout_max_torque_Nm` by default.
pub const TIMEOUT_MAX_TORQUE: f32 = 5.0;
/// Watchdog of a command without its own [s]: `servo.default_timeout_s` by default.
pub const DEFAULT_TIMEOUT: f32 = 0.1;
/// Sensed speed below which a profile begins at rest [turns/s]: `servo.velocity_zero_capture_threshold` by default.
const ZERO_CAPTURE: f32 = 0.05;

/// Configuration of what a command leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defaults {
    /// Watchdog [s]: NaN for none.
    pub timeout: f32,
    /// Largest speed of a profile [turns/s]: NaN for none.
    pub velocity_limit: f32,
    /// Largest acceleration of a profile [turns/s^2]: NaN for none.
    pub accel_limit: f32,
    /// Speed that no profile exceeds [turns/s].
    pub max_velocity: f32,
}

impl Default for Defaults {
    fn default() -> Self {
        Self { timeout: DEFAULT_TIMEOUT, velocity_limit: f32::NAN, accel_limit: 50.0, max_velocity: 500.0 }
    }
}

/// Surroundings of a command.
#[derive(Debug, Clone, Copy)]
pub struct Context {
    /// Values that a command leaves out.
    pub defaults: Defaults,
    /// Position bounds.
    pub bounds: Bounds,
    /// True on the way from another mode, and for a start at the sensed position.
    pub is_new: bool,
}

/// Lower and upper bound of a position.
pub type Bounds = (Option<Turns>, Option<Turns>);

/// Mode of a drive. Modes that set voltages are not part of this implementation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Mode {
    /// No torque; as a command, clears a fault.
    #[default]
    Stopped = 0,
    /// No torque because of a fault.
    Fault = 1,
    /// On the way from stopped to another mode; to be read only.
    Enabling = 2,
    /// Calibration; to be read only.
    Calibrating = 3,
    /// End of a calibration; to be read only.
    CalibrationComplete = 4,
    /// Commanded current.
    Current = 9,
    /// Position and speed.
    Position = 10,
    /// Damping after a command that was not renewed, until stopped.
    Timeout = 11,
    /// Damping.
    ZeroVelocity = 12,
    /// Position within bounds.
    StayWithin = 13,
    /// Phases shorted.
    Brake = 15,
}

impl Mode {
    /// Mode by its number.
    pub fn from_number(number: i32) -> Option<Self> {
        Some(match number {
            0 => Self::Stopped,
            1 => Self::Fault,
            2 => Self::Enabling,
            3 => Self::Calibrating,
            4 => Self::CalibrationComplete,
            9 => Self::Current,
            10 => Self::Position,
            11 => Self::Timeout,
            12 => Self::ZeroVelocity,
            13 => Self::StayWithin,
            15 => Self::Brake,
            _ => return None,
        })
    }

    /// True for a mode that a command can ask for.
    pub fn is_command(self) -> bool {
        !matches!(self, Self::Fault | Self::Enabling | Self::Calibrating | Self::CalibrationComplete)
    }

    /// True for the modes under watchdog and position bounds.
    pub fn is_supervised(self) -> bool {
        matches!(self, Self::Position | Self::StayWithin)
    }
}

/// Registers of a command, with the values that hold where a frame leaves them out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Mode.
    pub mode: Mode,
    /// Torque-producing current [A].
    pub q_current: f32,
    /// Flux-producing current [A]; without an effect.
    pub d_current: f32,
    /// Position [turns]; NaN for the present one.
    pub position: f32,
    /// Speed [turns/s].
    pub velocity: f32,
    /// Feed-forward torque [N m].
    pub torque: f32,
    /// Factor on the stiffness [-].
    pub kp_scale: f32,
    /// Factor on the damping [-].
    pub kd_scale: f32,
    /// Factor on the limit of the integral [-].
    pub ilimit_scale: f32,
    /// Largest torque [N m]; NaN for no limit.
    pub max_torque: f32,
    /// Position at which the motion stops [turns]; NaN for none.
    pub stop_position: f32,
    /// Watchdog [s]: 0 for the default, NaN for none.
    pub timeout: f32,
    /// Largest speed [turns/s]: NaN for the default, negative for none.
    pub velocity_limit: f32,
    /// Largest acceleration [turns/s^2]: NaN for the default, negative for none.
    pub accel_limit: f32,
    /// Fixed voltage [V]; without an effect.
    pub fixed_voltage: f32,
    /// Fixed current [A]; without an effect.
    pub fixed_current: f32,
    /// True to ignore the position bounds.
    pub ignores_bounds: bool,
    /// Lower bound of the mode stay within [turns]; NaN for none.
    pub within_low: f32,
    /// Upper bound of the mode stay within [turns]; NaN for none.
    pub within_high: f32,
}

impl Default for Command {
    fn default() -> Self {
        Self {
            mode: Mode::Stopped,
            q_current: 0.0,
            d_current: 0.0,
            position: 0.0,
            velocity: 0.0,
            torque: 0.0,
            kp_scale: 1.0,
            kd_scale: 1.0,
            ilimit_scale: 1.0,
            max_torque: f32::NAN,
            stop_position: f32::NAN,
            timeout: 0.0,
            velocity_limit: f32::NAN,
            accel_limit: f32::NAN,
            fixed_voltage: f32::NAN,
            fixed_current: f32::NAN,
            ignores_bounds: false,
            within_low: 0.0,
            within_high: 0.0,
        }
    }
}

impl Command {
    /// Content of a command register; `None` for another register.
    pub fn read(&self, register: u32) -> Option<Content> {
        if matches!(register, r::COMMAND_IGNORE_BOUNDS | r::WITHIN_IGNORE_BOUNDS) {
            return Some(Content::Integer(self.ignores_bounds.into()));
        }
        // A copy, so that reading and writing share one list.
        let mut copy = *self;
        copy.number(register).map(|number| Content::Number(*number))
    }

    /// Writes a command register other than the mode; returns false for another register.
    pub fn write(&mut self, register: u32, value: Value) -> bool {
        if matches!(register, r::COMMAND_IGNORE_BOUNDS | r::WITHIN_IGNORE_BOUNDS) {
            self.ignores_bounds = value.integer() != 0;
            return true;
        }
        let (Some(field), Some(number)) = (r::describe(register), self.number(register)) else {
            return false;
        };
        *number = value.number(field.scale);
        true
    }

    fn number(&mut self, register: u32) -> Option<&mut f32> {
        Some(match register {
            r::COMMAND_Q_CURRENT => &mut self.q_current,
            r::COMMAND_D_CURRENT => &mut self.d_current,
            r::COMMAND_POSITION => &mut self.position,
            r::COMMAND_VELOCITY => &mut self.velocity,
            r::COMMAND_TORQUE | r::WITHIN_TORQUE => &mut self.torque,
            r::COMMAND_KP_SCALE | r::WITHIN_KP_SCALE => &mut self.kp_scale,
            r::COMMAND_KD_SCALE | r::WITHIN_KD_SCALE => &mut self.kd_scale,
            r::COMMAND_ILIMIT_SCALE | r::WITHIN_ILIMIT_SCALE => &mut self.ilimit_scale,
            r::COMMAND_MAX_TORQUE | r::WITHIN_MAX_TORQUE => &mut self.max_torque,
            r::COMMAND_STOP_POSITION => &mut self.stop_position,
            r::COMMAND_TIMEOUT | r::WITHIN_TIMEOUT => &mut self.timeout,
            r::COMMAND_VELOCITY_LIMIT => &mut self.velocity_limit,
            r::COMMAND_ACCEL_LIMIT => &mut self.accel_limit,
            r::COMMAND_FIXED_VOLTAGE => &mut self.fixed_voltage,
            r::COMMAND_FIXED_CURRENT => &mut self.fixed_current,
            r::WITHIN_LOW => &mut self.within_low,
            r::WITHIN_HIGH => &mut self.within_high,
            _ => return None,
        })
    }

    /// Watchdog of the command [s]; `None` without one. A negative time is over at once.
    pub fn watchdog(&self, defaults: &Defaults) -> Option<f32> {
        let timeout = if self.timeout == 0.0 { defaults.timeout } else { self.timeout };
        (self.mode.is_supervised() && !timeout.is_nan()).then_some(timeout.max(f32::MIN_POSITIVE))
    }

    /// Set-point of the command. A stop position together with limits is a fault.
    pub fn set_point(&self, drive: &Drive, context: &Context) -> Result<SetPoint, Fault> {
        let settings = drive.settings();
        let here = Target::hold(drive.feedback().position);
        Ok(match self.mode {
            Mode::Current => SetPoint::Torque {
                torque: self.q_current * settings.torque_constant * settings.ratio.to_f32(),
                max_velocity: f32::INFINITY,
            },
            Mode::Position => SetPoint::Position(self.target(drive, context)?),
            Mode::StayWithin => SetPoint::Within {
                low: turns(self.within_low),
                high: turns(self.within_high),
                target: self.scaled(here),
            },
            Mode::ZeroVelocity => SetPoint::Position(Target {
                stiffness_scale: 0.0,
                damping_scale: self.kd_scale,
                integral_scale: 0.0,
                max_torque: settings.expiry_torque,
                ..here
            }),
            _ => SetPoint::Brake,
        })
    }

    /// Target with the factors, the torque and the torque limit of the command.
    fn scaled(&self, target: Target) -> Target {
        Target {
            torque: self.torque,
            stiffness_scale: self.kp_scale,
            damping_scale: self.kd_scale,
            integral_scale: self.ilimit_scale,
            max_torque: if self.max_torque.is_nan() { f32::INFINITY } else { self.max_torque },
            ..target
        }
    }

    /// Target of the position mode.
    fn target(&self, drive: &Drive, context: &Context) -> Result<Target, Fault> {
        let (velocity_limit, accel_limit) = self.limits(&context.defaults);
        let is_limited = velocity_limit.is_finite() || accel_limit.is_finite();
        let asked = if self.velocity.is_nan() { 0.0 } else { self.velocity };
        let velocity = scale::limit(asked, velocity_limit);
        let stop = turns(self.stop_position);
        if stop.is_some() && is_limited {
            return Err(Fault::InvalidCommand);
        }
        let (here, speed) = control_state(drive, context.is_new);
        let (position, velocity) = match (turns(self.position), stop) {
            (Some(position), _) => (position, velocity),
            (None, Some(stop)) => (here, libm::copysignf(velocity, stop.minus(here).to_f32())),
            (None, None) => (here.plus(Turns::new(ramp(speed, velocity, accel_limit))), velocity),
        };
        let mut target = Target {
            velocity: TAU * velocity,
            moves: velocity != 0.0,
            stop,
            limits: ProfileLimits { velocity: TAU * velocity_limit, acceleration: TAU * accel_limit },
            ..self.scaled(Target::hold(position))
        };
        if let Some(stop) = stop.filter(|stop| stop.minus(position).to_f32() * velocity < 0.0) {
            (target.position, target.velocity, target.moves) = (stop, 0.0, false);
        }
        if !self.ignores_bounds {
            limit(&mut target, context.bounds);
        }
        Ok(target)
    }

    /// Largest speed [turns/s] and acceleration [turns/s^2] of the profile; infinite without one.
    fn limits(&self, defaults: &Defaults) -> (f32, f32) {
        let stated = |limit: f32, default: f32| {
            let limit = if limit.is_nan() { default } else { limit };
            if limit >= 0.0 { limit } else { f32::INFINITY }
        };
        let velocity = stated(self.velocity_limit, defaults.velocity_limit);
        let acceleration = stated(self.accel_limit, defaults.accel_limit);
        let is_limited = velocity.is_finite() || acceleration.is_finite();
        let most = if defaults.max_velocity >= 0.0 { defaults.max_velocity } else { 0.0 };
        (if is_limited { velocity.min(most) } else { velocity }, acceleration)
    }
}

/// Position and speed [turns/s] at which a command for the present position begins: those of the profile, or the sensed
/// ones.
fn control_state(drive: &Drive, is_new: bool) -> (Turns, f32) {
    let feedback = drive.feedback();
    if !is_new && matches!(drive.set_point(), Some(SetPoint::Position(_))) {
        return (feedback.target, feedback.target_velocity / TAU);
    }
    let sensed = feedback.velocity / TAU;
    (feedback.position, if sensed.abs() < ZERO_CAPTURE { 0.0 } else { sensed })
}

/// Start [turns], relative to the present position, of a target that moves with `velocity` and that a ramp from `speed`
/// meets at its end: (v0 - v) |v - v0| / (2 a).
fn ramp(speed: f32, velocity: f32, acceleration: f32) -> f32 {
    let change = speed - velocity;
    let start = change * change.abs() / (2.0 * acceleration.max(f32::MIN_POSITIVE));
    if start.is_finite() { start } else { 0.0 }
}

/// Holds a target and its motion within bounds.
fn limit(target: &mut Target, (low, high): Bounds) {
    let above = low.map_or(target.position, |low| target.position.max(low));
    target.position = high.map_or(above, |high| above.min(high));
    if !target.moves {
        return;
    }
    target.stop = if target.velocity > 0.0 {
        high.map(|high| target.stop.map_or(high, |stop| stop.min(high))).or(target.stop)
    } else {
        low.map(|low| target.stop.map_or(low, |stop| stop.max(low))).or(target.stop)
    };
}

/// Position of a finite number of turns.
fn turns(number: f32) -> Option<Turns> {
    number.is_finite().then(|| Turns::new(number))
}
