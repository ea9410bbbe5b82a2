//! Controller: inputs and input modes, which give the set-point of each control period.
//!
//! Equations, with the period T, the inertia J and the filter's bandwidth b:
//!
//! - velocity ramp: v moves toward the input by at most rate T; torque = J dv/dt;
//! - torque ramp: torque moves toward the input by at most rate T;
//! - position filter: a = b^2 (p_input - p) + 2 b (v_input - v); v <- v + T a; p <- p + T v; torque = J a;
//! - trapezoidal trajectory: the profile of the drive core; torque = J dv/dt;
//! - torque control: torque within k_v (+-v_max - v).

use core::f32::consts::TAU;

use super::codes::{control_mode, controller_error, input_mode};
use super::units::Units;
use crate::drive::{Drive, Feedback, Profile, ProfileLimits, SetPoint, Settings, Target};
use crate::turns::Turns;

/// Angle, speed [rad/s] and torque [N m] at the output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct State {
    pub position: Turns,
    pub velocity: f32,
    pub torque: f32,
}

/// Configuration in units of the motor, with the maker's defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Configuration {
    pub control_mode: u32,
    pub input_mode: u32,
    /// Speed over the limit that is an error, over the limit [-].
    pub velocity_tolerance: f32,
    /// Ramp of the speed [turns/s^2].
    pub velocity_ramp: f32,
    /// Ramp of the torque [N m/s].
    pub torque_ramp: f32,
    /// Bandwidth of the position filter [1/s].
    pub filter_bandwidth: f32,
    /// Inertia [N m/(turns/s^2)].
    pub inertia: f32,
    /// Largest speed of a trajectory [turns/s].
    pub trajectory_velocity: f32,
    /// Largest acceleration and deceleration of a trajectory [turns/s^2].
    pub trajectory_acceleration: f32,
    pub trajectory_deceleration: f32,
}

impl Default for Configuration {
    fn default() -> Self {
        Self {
            control_mode: control_mode::POSITION_CONTROL,
            input_mode: input_mode::PASSTHROUGH,
            velocity_tolerance: super::VELOCITY_TOLERANCE,
            velocity_ramp: 1.0,
            torque_ramp: 0.01,
            filter_bandwidth: 2.0,
            inertia: 0.0,
            trajectory_velocity: 2.0,
            trajectory_acceleration: 0.5,
            trajectory_deceleration: 0.5,
        }
    }
}

/// Controller with its state.
#[derive(Debug, Clone, Default)]
pub(super) struct Controller {
    pub configuration: Configuration,
    pub input: State,
    pub set_point: State,
    profile: Profile,
    /// True from a new input position until the trajectory to it begins.
    is_planned: bool,
    is_moving: bool,
}

impl Controller {
    /// Controller at rest.
    pub fn new(configuration: Configuration) -> Self {
        Self { configuration, ..Self::default() }
    }

    /// True unless a trajectory is under way.
    pub fn is_trajectory_done(&self) -> bool {
        !self.is_moving
    }

    /// True if an input takes effect without a filter.
    pub fn is_direct(&self) -> bool {
        matches!(self.configuration.input_mode, input_mode::PASSTHROUGH | input_mode::TUNING)
    }

    /// Begins closed loop control at rest where the drive is.
    pub fn start(&mut self, drive: &Drive) {
        let position = drive.feedback().position;
        self.set_point = State { position, ..State::default() };
        self.change_mode(drive);
        self.is_planned = true;
    }

    /// Takes over the control mode: position control begins where the drive is.
    pub fn change_mode(&mut self, drive: &Drive) {
        if self.is_position_control() {
            let position = drive.feedback().position;
            (self.set_point.position, self.input.position) = (position, position);
        }
    }

    /// Takes a new input position.
    pub fn set_position(&mut self, position: Turns) {
        self.input.position = position;
        self.is_planned = true;
    }

    /// Advances by a control period; returns the set-point, or the error of firmware 0.5 for a mode that is not possible.
    pub fn step(&mut self, drive: &Drive) -> Result<SetPoint, u32> {
        let (settings, feedback) = (drive.settings(), drive.feedback());
        match self.configuration.input_mode {
            input_mode::INACTIVE => {}
            // The amplitudes of tuning are zero.
            input_mode::PASSTHROUGH | input_mode::TUNING => self.set_point = self.input,
            input_mode::VEL_RAMP => self.ramp_velocity(settings),
            input_mode::TORQUE_RAMP => {
                let rate = Units::new(settings.ratio).torque(self.configuration.torque_ramp);
                self.set_point.torque += within(self.input.torque - self.set_point.torque, rate * settings.period);
            }
            input_mode::POS_FILTER => self.filter_position(settings),
            input_mode::TRAP_TRAJ => self.follow_trajectory(settings, feedback),
            input_mode::MIRROR => return Err(controller_error::INVALID_MIRROR_AXIS),
            _ => return Err(controller_error::INVALID_INPUT_MODE),
        }
        let torque_limit = settings.torque_limit * settings.ratio.to_f32();
        self.set_point.velocity = within(self.set_point.velocity, settings.max_velocity);
        self.set_point.torque = within(self.set_point.torque, torque_limit);
        Ok(self.drive_set_point(settings, feedback))
    }

    fn drive_set_point(&self, settings: &Settings, feedback: &Feedback) -> SetPoint {
        let State { position, velocity, torque } = self.set_point;
        match self.configuration.control_mode {
            control_mode::VELOCITY_CONTROL => {
                SetPoint::Velocity { velocity, torque, max_acceleration: f32::INFINITY, max_torque: f32::INFINITY }
            }
            mode if mode < control_mode::VELOCITY_CONTROL => {
                let (gain, most) = (settings.gains.velocity, settings.max_velocity);
                let torque = match most.is_finite() {
                    true => torque.min(gain * (most - feedback.velocity)).max(gain * (-most - feedback.velocity)),
                    false => torque,
                };
                SetPoint::Torque { torque, max_velocity: f32::INFINITY }
            }
            _ => SetPoint::Position(Target { velocity, torque, ..Target::hold(position) }),
        }
    }

    fn is_position_control(&self) -> bool {
        self.configuration.control_mode >= control_mode::POSITION_CONTROL
    }

    /// Torque at the output for an acceleration of the output [rad/s^2].
    fn inertial_torque(&self, settings: &Settings, acceleration: f32) -> f32 {
        Units::new(settings.ratio).gain(self.configuration.inertia) * acceleration
    }

    fn ramp_velocity(&mut self, settings: &Settings) {
        let rate = Units::new(settings.ratio).velocity(self.configuration.velocity_ramp);
        let step = within(self.input.velocity - self.set_point.velocity, rate * settings.period);
        self.set_point.velocity += step;
        self.set_point.torque = self.inertial_torque(settings, rate_of(step, settings.period));
    }

    fn filter_position(&mut self, settings: &Settings) {
        let period = settings.period;
        // Above a quarter of the rate the filter would not be stable.
        let bandwidth = self.configuration.filter_bandwidth.min(rate_of(0.25, period));
        let distance = self.input.position.minus(self.set_point.position).to_rad();
        let relative = self.input.velocity - self.set_point.velocity;
        let acceleration = bandwidth * bandwidth * distance + 2.0 * bandwidth * relative;
        self.set_point.torque = self.inertial_torque(settings, acceleration);
        self.set_point.velocity += acceleration * period;
        let step = Turns::new(self.set_point.velocity * period / TAU);
        self.set_point.position = self.set_point.position.plus(step);
    }

    fn follow_trajectory(&mut self, settings: &Settings, feedback: &Feedback) {
        if core::mem::take(&mut self.is_planned) {
            self.profile.restart(self.set_point.position, self.set_point.velocity);
            self.is_moving = true;
        }
        if !self.is_moving {
            return;
        }
        let units = Units::new(settings.ratio);
        let configuration = &self.configuration;
        let acceleration = configuration.trajectory_acceleration.min(configuration.trajectory_deceleration);
        let limits = ProfileLimits {
            velocity: units.velocity(configuration.trajectory_velocity),
            acceleration: units.velocity(acceleration),
        };
        let before = self.profile.velocity();
        let mut end = SetPoint::Position(Target { limits, ..Target::hold(self.input.position) });
        self.profile.advance(&mut end, feedback, settings.period);
        self.set_point.position = self.profile.position();
        if self.profile.is_done() {
            (self.set_point.velocity, self.set_point.torque) = (0.0, 0.0);
            self.configuration.control_mode = control_mode::POSITION_CONTROL;
            self.is_moving = false;
        } else {
            let velocity = self.profile.velocity();
            self.set_point.torque = self.inertial_torque(settings, rate_of(velocity - before, settings.period));
            self.set_point.velocity = velocity;
        }
    }
}

/// `value` within +-`most`.
fn within(value: f32, most: f32) -> f32 {
    value.min(most.abs()).max(-most.abs())
}

/// Change over a period [s].
fn rate_of(change: f32, period: f32) -> f32 {
    change / period.max(f32::MIN_POSITIVE)
}
