//! One drive: encoders, supervision and control of one motor with a gear, whatever protocol commands it.
//!
//! Once a control period [`Drive::step`] reads the sensors, runs the protections and returns the torque of the motor.
//! Between periods a protocol reads [`Drive::feedback`] and commands the drive: [`Drive::enable`], [`Drive::disable`],
//! [`Drive::feed`].
//!
//! ```
//! use drives::drive::{Drive, Sensors, SetPoint, Settings, Target};
//! use drives::Turns;
//!
//! let mut drive = Drive::new(Settings::default());
//! let sensors = Sensors { motor_counts: Some(100), output_counts: Some(50), ..Sensors::default() };
//! drive.step(&sensors, None);
//! drive.enable(SetPoint::Position(Target::hold(Turns::new(0.1))));
//! assert!(drive.step(&sensors, None) > 0.0);
//! drive.disable();
//! assert_eq!(drive.step(&sensors, None), 0.0);
//! ```

mod encoder;
mod gains;
mod law;
mod power;
mod profile;
mod protection;
mod settings;
mod target;

use core::f32::consts::TAU;

pub use gains::{Gains, Law};
pub use power::VirtualPower;
pub use profile::Profile;
pub use protection::Fault;
pub use settings::{Expiry, Settings};
pub use target::{ProfileLimits, SetPoint, Target};

use crate::scale;
use crate::turns::Turns;
use encoder::Encoder;
use law::Integrals;
use protection::Watchdog;

/// Readings of one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Counts of the motor encoder within a turn; `None` without a reading.
    pub motor_counts: Option<u32>,
    /// Counts of the output encoder within a turn; `None` without a reading.
    pub output_counts: Option<u32>,
    /// Torque of the motor by its current and torque constant [N m].
    pub motor_torque: f32,
    /// Bus voltage [V].
    pub bus_voltage: f32,
    /// Current from the bus [A].
    pub bus_current: f32,
    /// Temperature of the winding [deg C].
    pub motor_temperature: f32,
    /// Temperature of the power stage [deg C].
    pub board_temperature: f32,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            motor_counts: None,
            output_counts: None,
            motor_torque: 0.0,
            bus_voltage: 48.0,
            bus_current: 0.0,
            motor_temperature: 25.0,
            board_temperature: 25.0,
        }
    }
}

/// Quantities that a drive reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedback {
    /// Angle of the output, by the motor encoder and the ratio, that the position loop controls.
    pub position: Turns,
    /// Speed of the output by the motor encoder [rad/s].
    pub velocity: f32,
    /// Torque at the output by the motor's current, without losses of the gear [N m].
    pub torque: f32,
    /// Angle of the rotor since power-up; its fraction is the reading of the motor encoder.
    pub motor_position: Turns,
    /// Speed of the rotor [rad/s].
    pub motor_velocity: f32,
    /// Angle of the output encoder; its fraction is the encoder's reading. `None` without an output encoder.
    pub output_position: Option<Turns>,
    /// Speed of the output encoder [rad/s].
    pub output_velocity: f32,
    /// Torque-producing current [A].
    pub current: f32,
    /// Last readings of the sensors.
    pub sensors: Sensors,
    /// Target of the position loop in this period, behind profile and ramps.
    pub target: Turns,
    /// Speed of that target [rad/s].
    pub target_velocity: f32,
    /// Torque command before the limits, at the output [N m].
    pub demand: f32,
    /// True if a limit cut the torque.
    pub is_limited: bool,
    /// True once a profile has come to its end.
    pub is_trajectory_done: bool,
}

/// State of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// No torque.
    Disabled,
    /// Calibration of motor and encoders, for the rest of the time [control periods].
    Calibrating(u32),
    /// Control by a set-point.
    Enabled,
    /// Speed damping because no command arrived in time.
    TimedOut,
}

/// A drive.
#[derive(Debug, Clone)]
pub struct Drive {
    settings: Settings,
    motor: Encoder,
    output: Option<Encoder>,
    /// Offset of the output angle to rotor angle over ratio.
    offset: Option<Turns>,
    /// Reported angle less that of an observer: see [`Drive::origin`].
    origin: Turns,
    state: State,
    calibrated: bool,
    fault: Option<Fault>,
    watchdog: Watchdog,
    set_point: SetPoint,
    profile: Profile,
    integrals: Integrals,
    feedback: Feedback,
    periods: u32,
}

/// Torque at the output [N m] for a target, as an alternative to the drive's own law; `None` leaves it to that law.
pub type Controller<'c> = &'c mut dyn FnMut(&SetPoint, &Feedback) -> Option<f32>;

impl Drive {
    /// Drive after power-up: disabled, without a reading.
    pub fn new(settings: Settings) -> Self {
        Self {
            motor: Encoder::new(settings.motor_counts_per_turn),
            output: settings.output_counts_per_turn.map(Encoder::new),
            offset: None,
            origin: Turns::ZERO,
            state: State::Disabled,
            calibrated: settings.is_calibrated,
            fault: None,
            watchdog: Watchdog::new(settings.watchdog),
            set_point: SetPoint::Brake,
            profile: Profile::default(),
            integrals: Integrals::default(),
            feedback: Feedback {
                position: Turns::ZERO,
                velocity: 0.0,
                torque: 0.0,
                motor_position: Turns::ZERO,
                motor_velocity: 0.0,
                output_position: None,
                output_velocity: 0.0,
                current: 0.0,
                sensors: Sensors::default(),
                target: Turns::ZERO,
                target_velocity: 0.0,
                demand: 0.0,
                is_limited: false,
                is_trajectory_done: true,
            },
            periods: 0,
            settings,
        }
    }

    /// Settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Settings, to be changed between periods. Counts per turn act after [`Drive::restart`] only.
    pub fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// Quantities of the last period.
    pub fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    /// State.
    pub fn state(&self) -> State {
        self.state
    }

    /// Fault that disabled the drive, until [`Drive::clear_fault`].
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// True once motor and encoders are calibrated.
    pub fn is_calibrated(&self) -> bool {
        self.calibrated
    }

    /// Control periods since power-up, wrapping.
    pub fn periods(&self) -> u32 {
        self.periods
    }

    /// Set-point of an enabled drive.
    pub fn set_point(&self) -> Option<&SetPoint> {
        (self.state == State::Enabled).then_some(&self.set_point)
    }

    /// Enables the drive or changes its set-point; feeds the watchdog. A drive with a fault stays disabled; a drive that
    /// is not calibrated declares [`Fault::NotCalibrated`].
    pub fn enable(&mut self, set_point: SetPoint) {
        self.watchdog.feed();
        if self.fault.is_some() || matches!(self.state, State::Calibrating(_)) {
            return;
        }
        if !self.calibrated {
            self.declare(Fault::NotCalibrated);
            return;
        }
        if self.state != State::Enabled {
            self.integrals = Integrals::default();
            self.profile.restart(self.feedback.position, self.feedback.velocity);
            self.feedback.target = self.feedback.position;
            self.feedback.target_velocity = self.feedback.velocity;
            self.state = State::Enabled;
        }
        self.set_point = set_point;
    }

    /// Changes the set-point of an enabled drive without feeding the watchdog, for targets that the drive itself computes
    /// from period to period. A drive that is not enabled stays as it is.
    pub fn change_set_point(&mut self, set_point: SetPoint) {
        if self.state == State::Enabled {
            self.set_point = set_point;
        }
    }

    /// Takes the torque off, without a fault.
    pub fn disable(&mut self) {
        self.state = State::Disabled;
        self.integrals = Integrals::default();
    }

    /// Runs the reaction to an expired watchdog. A drive with a fault or under calibration ignores it.
    pub fn expire(&mut self) {
        match (self.settings.expiry, self.state) {
            (_, State::Calibrating(_)) => (),
            _ if self.fault.is_some() => (),
            (Expiry::Disable, _) => self.declare(Fault::Watchdog),
            (Expiry::Damp, _) if self.calibrated => self.state = State::TimedOut,
            (Expiry::Damp, _) => self.declare(Fault::NotCalibrated),
        }
    }

    /// Feeds the watchdog.
    pub fn feed(&mut self) {
        self.watchdog.feed();
    }

    /// Sets the time without a command after which the watchdog expires [s]; `None` turns it off.
    pub fn set_watchdog(&mut self, timeout: Option<f32>) {
        self.settings.watchdog = timeout;
        self.watchdog = Watchdog::new(timeout);
    }

    /// Begins the calibration of motor and encoders, if the drive is disabled and has no fault.
    pub fn calibrate(&mut self) {
        if self.state == State::Disabled && self.fault.is_none() {
            self.state = State::Calibrating(self.settings.calibration_periods());
        }
    }

    /// Disables the drive with a fault.
    pub fn declare(&mut self, fault: Fault) {
        self.fault = self.fault.or(Some(fault));
        self.disable();
    }

    /// Clears a fault; a fault whose cause lasts is declared again in the next period.
    pub fn clear_fault(&mut self) {
        self.fault = None;
        self.watchdog.feed();
    }

    /// Sets the present angle of the output, the origin of all positions.
    pub fn set_position(&mut self, position: Turns) {
        let shift = position.minus(self.feedback.position);
        self.offset = Some(self.offset.unwrap_or_default().plus(shift));
        self.origin = self.origin.plus(shift);
        self.feedback.position = position;
        self.profile.restart(position, self.feedback.velocity);
    }

    /// Reported angle of the output less the angle that an observer of the same encoders begins with: the angle by the
    /// output encoder or, without one, the travel since the first reading.
    pub fn origin(&self) -> Turns {
        self.origin
    }

    /// Restarts as after power-up, with the present settings.
    pub fn restart(&mut self) {
        *self = Self::new(self.settings);
    }

    /// Runs one control period; returns the torque of the motor [N m]. `controller` may compute the torque in place of
    /// the drive's own law.
    pub fn step(&mut self, sensors: &Sensors, controller: Option<Controller<'_>>) -> f32 {
        self.periods = self.periods.wrapping_add(1);
        self.sense(sensors);
        let is_enabled = matches!(self.state, State::Enabled | State::TimedOut);
        if let Some(fault) = protection::check(&self.settings, &self.feedback, is_enabled)
            .or(self.encoder_fault())
            .filter(|fault| is_enabled || fault.is_sensed_while_disabled())
        {
            self.declare(fault);
        }
        if self.watchdog.step(self.settings.period) && self.state == State::Enabled {
            self.expire();
        }
        let torque = match self.state {
            State::Disabled if self.settings.brakes_while_disabled => {
                self.settings.short_circuit_torque(self.feedback.velocity)
            }
            State::Disabled => 0.0,
            State::Calibrating(rest) => {
                self.calibrated |= rest == 0;
                self.state = rest.checked_sub(1).map_or(State::Disabled, State::Calibrating);
                0.0
            }
            State::TimedOut => -self.settings.gains.damping * self.feedback.velocity,
            State::Enabled => self.follow(controller),
        };
        let ratio = self.settings.ratio.to_f32();
        let limit = protection::torque_limit(&self.settings, &self.feedback) * ratio;
        let own_limit = match self.state {
            State::Enabled => self.set_point.max_torque().min(limit),
            State::TimedOut => self.settings.expiry_torque.max(0.0).min(limit),
            _ => limit,
        };
        // A torque that is no number is no torque.
        let finite = if torque.is_finite() { torque } else { 0.0 };
        let limited = scale::limit(finite, own_limit);
        self.feedback.demand = finite;
        self.feedback.is_limited = limited != finite;
        limited / ratio
    }

    /// Torque of the enabled drive at the output [N m].
    fn follow(&mut self, controller: Option<Controller<'_>>) -> f32 {
        let period = self.settings.period;
        let advanced = self.profile.advance(&mut self.set_point, &self.feedback, period);
        self.feedback.target = self.profile.position();
        self.feedback.target_velocity = self.profile.velocity();
        self.feedback.is_trajectory_done = self.profile.is_done();
        let own = controller.and_then(|controller| controller(&advanced, &self.feedback));
        own.unwrap_or_else(|| law::torque(&self.settings, &advanced, &self.feedback, &mut self.integrals))
    }

    fn sense(&mut self, sensors: &Sensors) {
        let Self { settings, motor, output, feedback, .. } = self;
        motor.step(sensors.motor_counts, settings.encoder_bandwidth, settings.period);
        feedback.motor_position = motor.position();
        feedback.motor_velocity = TAU * motor.velocity();
        if let Some(output) = output {
            output.step(sensors.output_counts, settings.encoder_bandwidth, settings.period);
            feedback.output_position = output.has_reading().then(|| output.position());
            feedback.output_velocity = TAU * output.velocity();
        }
        let geared = feedback.motor_position.over(settings.ratio);
        if self.offset.is_none() && motor.has_reading() {
            // At power-up the output encoder tells the turn of the output, if there is one.
            let position = feedback.output_position.unwrap_or(geared);
            self.offset = Some(position.minus(geared));
            if output.is_none() {
                self.origin = position;
            }
            self.profile.restart(position, 0.0);
            feedback.target = position;
        }
        let ratio = settings.ratio.to_f32();
        feedback.position = geared.plus(self.offset.unwrap_or_default());
        feedback.velocity = feedback.motor_velocity / ratio;
        feedback.torque = sensors.motor_torque * ratio;
        feedback.current = settings.current(sensors.motor_torque);
        feedback.sensors = *sensors;
    }

    /// Fault of an encoder that is silent for too long.
    fn encoder_fault(&self) -> Option<Fault> {
        let silent = |encoder: &Encoder| encoder.silent_periods() > self.settings.max_silent_periods;
        if silent(&self.motor) {
            return Some(Fault::MotorEncoder);
        }
        self.output.as_ref().filter(|output| silent(output)).map(|_| Fault::OutputEncoder)
    }
}

#[cfg(test)]
mod tests;
