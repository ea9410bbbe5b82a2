//! Error bits of a servo: measured limits, errors that stay until the torque is switched, timers of load and current.

use super::error;
use super::memory::Memory;
use super::table;
use crate::drive::{Drive, Fault, Settings};

/// Protections.
#[derive(Debug, Clone, Default)]
pub(super) struct Protection {
    /// Bits of errors that last.
    present: u8,
    /// Bits of errors that took the torque off or reduced it.
    latched: u8,
    /// Time of the load above its limit [s].
    overload: f32,
    /// Time of the current above its limit [s].
    overcurrent: f32,
    silent_periods: u32,
}

impl Protection {
    /// Error bits.
    pub fn status(&self) -> u8 {
        self.present | self.latched
    }

    /// True after an overload, until the torque is switched.
    pub fn is_overloaded(&self) -> bool {
        self.latched & error::OVERLOAD != 0
    }

    /// True if an error keeps the torque off.
    pub fn is_unloaded(&self) -> bool {
        self.latched & !error::OVERLOAD != 0
    }

    /// Clears the errors whose cause is gone.
    pub fn clear(&mut self, drive: &mut Drive) {
        *self = Self { silent_periods: self.silent_periods, ..Self::default() };
        drive.clear_fault();
    }

    /// Runs one control period.
    pub fn step(&mut self, memory: &Memory, base: &Settings, drive: &mut Drive) {
        let unloading = memory.get(&table::UNLOADING) as u8;
        self.present = self.measure(memory, base, drive);
        self.latched |= drive.fault().map_or(0, error_of);
        self.latched |= self.present & unloading & (error::CURRENT | error::OVERLOAD);
        if self.latched & error::CURRENT != 0 {
            drive.disable();
        }
    }

    /// Bits of the errors in this period.
    fn measure(&mut self, memory: &Memory, base: &Settings, drive: &Drive) -> u8 {
        let (settings, sensors) = (drive.settings(), drive.feedback().sensors);
        let limit = |field| memory.quantity(field);
        let has_output = settings.output_counts_per_turn.is_none() || sensors.output_counts.is_some();
        let has_readings = has_output && sensors.motor_counts.is_some();
        self.silent_periods = if has_readings { 0 } else { self.silent_periods.saturating_add(1) };
        let voltage = sensors.bus_voltage;
        let is_outside = voltage < limit(&table::MIN_VOLTAGE) || voltage > limit(&table::MAX_VOLTAGE);
        let hottest = sensors.motor_temperature.max(sensors.board_temperature);
        let overload = load(base, drive).abs() > limit(&table::OVERLOAD_TORQUE);
        let overcurrent = drive.feedback().current.abs() > limit(&table::MAX_CURRENT);
        self.overload = if overload { self.overload + settings.period } else { 0.0 };
        self.overcurrent = if overcurrent { self.overcurrent + settings.period } else { 0.0 };
        let errors = [
            (is_outside, error::VOLTAGE),
            (self.silent_periods > settings.max_silent_periods, error::ENCODER),
            (hottest > limit(&table::MAX_TEMPERATURE), error::TEMPERATURE),
            (overcurrent && self.overcurrent > limit(&table::OVERCURRENT_TIME), error::CURRENT),
            (overload && self.overload > limit(&table::OVERLOAD_TIME), error::OVERLOAD),
        ];
        errors.into_iter().filter(|(is_present, _)| *is_present).fold(0, |bits, (_, bit)| bits | bit)
    }
}

/// Load of the motor, as a part of the stall torque [-].
pub(super) fn load(base: &Settings, drive: &Drive) -> f32 {
    drive.feedback().sensors.motor_torque / base.torque_limit.max(f32::MIN_POSITIVE)
}

/// Error bit of a fault; none for faults that the protocol does not have.
fn error_of(fault: Fault) -> u8 {
    match fault {
        Fault::UnderVoltage | Fault::OverVoltage => error::VOLTAGE,
        Fault::MotorEncoder | Fault::OutputEncoder => error::ENCODER,
        Fault::OverTemperature => error::TEMPERATURE,
        _ => 0,
    }
}
