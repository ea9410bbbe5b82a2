//! Errors by the codes of both firmware lines.

use super::Firmware;
use super::codes::{axis_error, controller_error, encoder_error, error, motor_error};
use crate::drive::{Drive, Fault};

/// Errors of an axis, kept until they are cleared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct AxisErrors {
    /// Errors of the axis; with firmware 0.6 all active errors.
    pub axis: u32,
    pub motor: u64,
    pub encoder: u32,
    pub controller: u32,
    /// Errors that disarmed the axis (firmware 0.6).
    pub disarm_reason: u32,
    /// Fault of the drive that is in the codes already.
    known: Option<Fault>,
}

impl AxisErrors {
    /// Adds the drive's fault, if it is new; `was_armed` tells if the fault took the torque off.
    pub fn record(&mut self, firmware: Firmware, drive: &Drive, was_armed: bool) {
        let Some(fault) = drive.fault().filter(|fault| self.known != Some(*fault)) else {
            return;
        };
        self.known = Some(fault);
        match firmware {
            Firmware::V0_5 => self.add_legacy(fault, drive),
            Firmware::V0_6 => {
                let code = code(fault, drive);
                self.axis |= code;
                if was_armed {
                    self.disarm_reason |= code;
                }
            }
        }
    }

    /// Adds the fault as the second axis of a board with firmware 0.5 has it, which owns the output encoder.
    pub fn record_second(&mut self, fault: Option<Fault>) {
        match fault {
            Some(Fault::OutputEncoder) => {
                self.axis |= axis_error::ENCODER_FAILED;
                self.encoder |= encoder_error::ABS_SPI_COM_FAIL;
            }
            Some(Fault::UnderVoltage | Fault::OverVoltage) => self.add_motor(motor_error::SYSTEM_LEVEL),
            _ => {}
        }
    }

    /// Adds an error of the controller (firmware 0.5).
    pub fn add_controller(&mut self, code: u32) {
        self.axis |= axis_error::CONTROLLER_FAILED;
        self.controller |= code;
    }

    fn add_motor(&mut self, code: u64) {
        self.axis |= axis_error::MOTOR_FAILED;
        self.motor |= code;
    }

    fn add_legacy(&mut self, fault: Fault, drive: &Drive) {
        match fault {
            Fault::Watchdog => self.axis |= axis_error::WATCHDOG_TIMER_EXPIRED,
            Fault::MotorEncoder => {
                self.axis |= axis_error::ENCODER_FAILED;
                self.encoder |= encoder_error::ABS_SPI_COM_FAIL;
            }
            Fault::OutputEncoder => self.add_controller(controller_error::INVALID_ESTIMATE),
            Fault::UnderVoltage | Fault::OverVoltage => self.add_motor(motor_error::SYSTEM_LEVEL),
            Fault::OverTemperature if is_motor_hot(drive) => self.add_motor(motor_error::MOTOR_THERMISTOR_OVER_TEMP),
            Fault::OverTemperature => self.add_motor(motor_error::FET_THERMISTOR_OVER_TEMP),
            Fault::OverCurrent => self.add_motor(motor_error::CURRENT_LIMIT_VIOLATION),
            Fault::Overspeed => self.add_controller(controller_error::OVERSPEED),
            Fault::OutsideTravel if is_below_travel(drive) => self.axis |= axis_error::MIN_ENDSTOP_PRESSED,
            Fault::OutsideTravel => self.axis |= axis_error::MAX_ENDSTOP_PRESSED,
            Fault::NotCalibrated => self.axis |= axis_error::INVALID_STATE,
            Fault::EmergencyStop => self.axis |= axis_error::ESTOP_REQUESTED,
            // The controller has added its own code.
            Fault::InvalidCommand => self.axis |= axis_error::CONTROLLER_FAILED,
        }
    }
}

/// Code of a fault with firmware 0.6.
fn code(fault: Fault, drive: &Drive) -> u32 {
    match fault {
        Fault::Watchdog => error::WATCHDOG_TIMER_EXPIRED,
        Fault::MotorEncoder | Fault::OutputEncoder => error::MISSING_ESTIMATE,
        Fault::UnderVoltage => error::DC_BUS_UNDER_VOLTAGE,
        Fault::OverVoltage => error::DC_BUS_OVER_VOLTAGE,
        Fault::OverTemperature if is_motor_hot(drive) => error::MOTOR_OVER_TEMP,
        Fault::OverTemperature => error::INVERTER_OVER_TEMP,
        Fault::OverCurrent => error::CURRENT_LIMIT_VIOLATION,
        Fault::Overspeed => error::VELOCITY_LIMIT_VIOLATION,
        Fault::OutsideTravel => error::POSITION_LIMIT_VIOLATION,
        Fault::NotCalibrated => error::CALIBRATION_ERROR,
        Fault::EmergencyStop => error::ESTOP_REQUESTED,
        Fault::InvalidCommand => error::BAD_CONFIG,
    }
}

fn is_motor_hot(drive: &Drive) -> bool {
    let sensors = &drive.feedback().sensors;
    sensors.motor_temperature >= sensors.board_temperature
}

fn is_below_travel(drive: &Drive) -> bool {
    drive.settings().travel.0.is_some_and(|low| drive.feedback().position < low)
}
