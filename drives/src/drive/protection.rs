//! Protections of a drive: limits whose violation is a fault, derating of the torque, and the watchdog.

use super::Feedback;
use super::settings::Settings;

/// Fault of a drive. The protocols report it by the code of their maker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// No command arrived in time.
    Watchdog,
    /// Readings of the motor encoder are missing.
    MotorEncoder,
    /// Readings of the output encoder are missing.
    OutputEncoder,
    /// Bus voltage too low.
    UnderVoltage,
    /// Bus voltage too high.
    OverVoltage,
    /// Current of the motor too high.
    OverCurrent,
    /// Winding or power stage too hot.
    OverTemperature,
    /// Speed beyond its limit.
    Overspeed,
    /// Output outside of its travel.
    OutsideTravel,
    /// Operation of a drive that is not calibrated.
    NotCalibrated,
    /// Stop by command.
    EmergencyStop,
    /// Set-point or setting that the drive cannot follow.
    InvalidCommand,
}

impl Fault {
    /// True for faults that a disabled drive declares as well.
    pub(super) fn is_sensed_while_disabled(self) -> bool {
        matches!(self, Self::OverVoltage | Self::OverTemperature)
    }
}

/// Fault of the present readings.
pub(super) fn check(settings: &Settings, now: &Feedback, is_enabled: bool) -> Option<Fault> {
    let sensors = &now.sensors;
    let hottest = sensors.motor_temperature.max(sensors.board_temperature);
    let (low, high) = settings.travel;
    let outside = low.is_some_and(|low| now.position < low) || high.is_some_and(|high| now.position > high);
    let faults = [
        (sensors.bus_voltage > settings.max_voltage, Fault::OverVoltage),
        (sensors.bus_voltage < settings.min_voltage, Fault::UnderVoltage),
        (now.current.abs() > settings.max_current, Fault::OverCurrent),
        (hottest > settings.max_temperature, Fault::OverTemperature),
        (now.velocity.abs() > settings.overspeed, Fault::Overspeed),
        (outside && is_enabled, Fault::OutsideTravel),
    ];
    faults.into_iter().find_map(|(is_violated, fault)| is_violated.then_some(fault))
}

/// Largest torque of the motor [N m]: the limit, less toward the largest temperature.
pub(super) fn torque_limit(settings: &Settings, now: &Feedback) -> f32 {
    let span = settings.max_temperature - settings.derating_temperature;
    let rest = settings.max_temperature - now.sensors.motor_temperature;
    let share = if span > 0.0 { (rest / span).clamp(0.0, 1.0) } else { 1.0 };
    let limit = settings.torque_limit * share;
    // A limit that is no number permits nothing; an infinite one, everything.
    limit.max(0.0)
}

/// Watchdog over the commands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watchdog {
    timeout: Option<f32>,
    /// Time since the last command [s].
    silence: f32,
}

impl Watchdog {
    /// Watchdog that was just fed; without a timeout, or with one that is no positive number, it never expires.
    pub fn new(timeout: Option<f32>) -> Self {
        Self { timeout: timeout.filter(|timeout| timeout.is_finite() && *timeout > 0.0), silence: 0.0 }
    }

    /// Starts the time anew.
    pub fn feed(&mut self) {
        self.silence = 0.0;
    }

    /// Advances by a period [s]; returns true once the time is over.
    pub fn step(&mut self, period: f32) -> bool {
        self.silence += period;
        self.timeout.is_some_and(|timeout| self.silence > timeout)
    }
}
