//! Settings of a drive.

use super::gains::{Gains, Law};
use crate::turns::{Ratio, Turns};

/// Reaction to a watchdog that expires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expiry {
    /// Takes the torque off, with a fault.
    Disable,
    /// Damps the speed until the next command, without a fault.
    Damp,
}

/// Settings of a drive. A protocol changes those that its maker's registers hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Turns of the motor in a turn of the output.
    pub ratio: Ratio,
    /// Control period [s].
    pub period: f32,
    /// Counts of the motor encoder in a turn.
    pub motor_counts_per_turn: u32,
    /// Counts of the output encoder in a turn; `None` without one.
    pub output_counts_per_turn: Option<u32>,
    /// Bandwidth of the speed from the encoders [rad/s].
    pub encoder_bandwidth: f32,
    /// Control periods without a reading after which an encoder is lost.
    pub max_silent_periods: u32,
    /// Torque constant of the motor [N m/A].
    pub torque_constant: f32,
    /// Resistance of the winding between bus and ground [ohm].
    pub resistance: f32,
    /// Pole pairs of the motor.
    pub pole_pairs: u8,
    /// Largest torque of the motor [N m].
    pub torque_limit: f32,
    /// Largest commanded speed of the output [rad/s].
    pub max_velocity: f32,
    /// Speed of the output that is a fault [rad/s].
    pub overspeed: f32,
    /// Lower and upper end of the output's travel.
    pub travel: (Option<Turns>, Option<Turns>),
    /// Bus voltage below which the drive has a fault [V].
    pub min_voltage: f32,
    /// Bus voltage above which the drive has a fault [V].
    pub max_voltage: f32,
    /// Torque-producing current that is a fault [A].
    pub max_current: f32,
    /// Winding temperature at which the torque begins to be reduced [deg C].
    pub derating_temperature: f32,
    /// Temperature of winding or power stage that is a fault [deg C].
    pub max_temperature: f32,
    /// Form of the position loop.
    pub law: Law,
    /// Gains.
    pub gains: Gains,
    /// Largest torque of the parallel law's integral at the output [N m].
    pub integral_limit: f32,
    /// Largest errors of the position loop that count as zero, for a target below and above the angle [rad].
    pub dead_zone: (f32, f32),
    /// Largest torque of the speed loop's integral at the output, below the torque limit in any case [N m].
    pub velocity_integral_limit: f32,
    /// Time without a command after which the watchdog expires [s]; `None` without one.
    pub watchdog: Option<f32>,
    /// Reaction to the watchdog.
    pub expiry: Expiry,
    /// True for a drive that shorts the winding while it is disabled.
    pub brakes_while_disabled: bool,
    /// Largest torque of the damping after the watchdog, at the output [N m].
    pub expiry_torque: f32,
    /// Time that a calibration takes [s].
    pub calibration_time: f32,
    /// False for a drive whose motor and encoders are not calibrated yet.
    pub is_calibrated: bool,
}

impl Settings {
    /// Current of the winding for a torque of the motor [A].
    pub fn current(&self, torque: f32) -> f32 {
        torque / self.torque_constant.max(f32::MIN_POSITIVE)
    }

    /// Current of the winding at the largest torque of the motor [A].
    pub fn peak_current(&self) -> f32 {
        self.current(self.torque_limit)
    }

    /// Torque of the shorted winding at the output [N m], at a speed of the output [rad/s]: -ratio^2 kt^2 / R speed.
    pub(super) fn short_circuit_torque(&self, velocity: f32) -> f32 {
        let geared = self.ratio.to_f32() * self.torque_constant;
        -(geared * geared / self.resistance.max(f32::MIN_POSITIVE)) * velocity
    }

    /// Time that a calibration takes [control periods].
    pub fn calibration_periods(&self) -> u32 {
        (self.calibration_time / self.period.max(f32::MIN_POSITIVE)) as u32
    }
}

impl Default for Settings {
    /// Drive of a small robot joint with a ratio of 6 at 48 V and 10 kHz.
    fn default() -> Self {
        Self {
            ratio: Ratio::new(6.0),
            period: 1e-4,
            motor_counts_per_turn: 1 << 14,
            output_counts_per_turn: Some(1 << 17),
            encoder_bandwidth: 1000.0,
            max_silent_periods: 100,
            torque_constant: 0.1,
            resistance: 0.2,
            pole_pairs: 14,
            torque_limit: 2.5,
            max_velocity: f32::INFINITY,
            overspeed: f32::INFINITY,
            travel: (None, None),
            min_voltage: 10.0,
            max_voltage: 58.0,
            max_current: f32::INFINITY,
            derating_temperature: 80.0,
            max_temperature: 100.0,
            law: Law::Parallel,
            gains: Gains::for_inertia(0.17, 30.0),
            integral_limit: 1.0,
            dead_zone: (0.0, 0.0),
            velocity_integral_limit: f32::INFINITY,
            watchdog: None,
            expiry: Expiry::Disable,
            brakes_while_disabled: false,
            expiry_torque: f32::INFINITY,
            calibration_time: 2.0,
            is_calibrated: true,
        }
    }
}
