//! States of an axis and the procedures that lead from one to the next.
//!
//! | request | ready | calibrated | otherwise |
//! |---|---|---|---|
//! | IDLE, STARTUP_SEQUENCE | IDLE | | |
//! | FULL_CALIBRATION_SEQUENCE | MOTOR_CALIBRATION, ENCODER_OFFSET_CALIBRATION, IDLE | | IDLE with an error |
//! | MOTOR_CALIBRATION | MOTOR_CALIBRATION, IDLE | | IDLE with an error |
//! | ENCODER_OFFSET_CALIBRATION | | ENCODER_OFFSET_CALIBRATION, IDLE | INVALID_STATE |
//! | CLOSED_LOOP_CONTROL | | CLOSED_LOOP_CONTROL | INVALID_STATE |
//! | HOMING | | | HOMING_WITHOUT_ENDSTOP |
//! | other | | | INVALID_STATE |

use super::codes::{axis_state, procedure_result};
use crate::drive::{Drive, State};

/// Procedure of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Procedure {
    /// State that was requested, IDLE once the procedure has ended.
    running: u8,
    /// Rest of a calibration of the motor alone [control periods].
    rest: u32,
    is_motor_calibrated: bool,
    /// Result of the last procedure.
    pub result: u8,
}

impl Procedure {
    pub fn new() -> Self {
        Self { running: axis_state::IDLE, rest: 0, is_motor_calibrated: false, result: procedure_result::SUCCESS }
    }

    /// Forgets the result of a procedure that has ended.
    pub fn clear_result(&mut self) {
        if self.running == axis_state::IDLE {
            self.result = procedure_result::SUCCESS;
        }
    }

    /// State of the axis.
    pub fn state(&self, drive: &Drive) -> u8 {
        match drive.state() {
            State::Enabled | State::TimedOut => axis_state::CLOSED_LOOP_CONTROL,
            State::Calibrating(rest) if self.is_full() && rest > drive.settings().calibration_periods() / 2 => {
                axis_state::MOTOR_CALIBRATION
            }
            State::Calibrating(_) => axis_state::ENCODER_OFFSET_CALIBRATION,
            State::Disabled if self.rest > 0 => axis_state::MOTOR_CALIBRATION,
            State::Disabled => axis_state::IDLE,
        }
    }

    fn is_full(&self) -> bool {
        self.running == axis_state::FULL_CALIBRATION_SEQUENCE
    }

    /// Ends the present procedure and begins one; returns true if closed loop control is to begin. `has_error` keeps the
    /// axis from arming.
    pub fn request(&mut self, state: u32, has_error: bool, drive: &mut Drive) -> bool {
        let is_motor_ready = drive.is_calibrated() || self.is_motor_calibrated;
        self.cancel(drive);
        let state = u8::try_from(state).unwrap_or(u8::MAX);
        self.result = match state {
            axis_state::IDLE => return false,
            axis_state::STARTUP_SEQUENCE => procedure_result::SUCCESS,
            axis_state::HOMING => procedure_result::HOMING_WITHOUT_ENDSTOP,
            axis_state::ENCODER_OFFSET_CALIBRATION if !is_motor_ready => procedure_result::NOT_CALIBRATED,
            axis_state::CLOSED_LOOP_CONTROL if !drive.is_calibrated() => procedure_result::NOT_CALIBRATED,
            axis_state::FULL_CALIBRATION_SEQUENCE
            | axis_state::MOTOR_CALIBRATION
            | axis_state::ENCODER_OFFSET_CALIBRATION
            | axis_state::CLOSED_LOOP_CONTROL => {
                if has_error {
                    procedure_result::DISARMED
                } else {
                    self.begin(state, drive);
                    procedure_result::BUSY
                }
            }
            _ => procedure_result::INVALID_STATE,
        };
        self.result == procedure_result::BUSY && state == axis_state::CLOSED_LOOP_CONTROL
    }

    fn begin(&mut self, state: u8, drive: &mut Drive) {
        self.running = state;
        match state {
            axis_state::MOTOR_CALIBRATION => self.rest = (drive.settings().calibration_periods() / 2).max(1),
            axis_state::CLOSED_LOOP_CONTROL => {}
            _ => drive.calibrate(),
        }
    }

    fn cancel(&mut self, drive: &mut Drive) {
        if self.running != axis_state::IDLE {
            self.result = procedure_result::CANCELLED;
        }
        (self.running, self.rest) = (axis_state::IDLE, 0);
        drive.disable();
    }

    /// Advances by a control period.
    pub fn step(&mut self, drive: &Drive) {
        if drive.fault().is_some() {
            self.rest = 0;
        } else if let Some(rest) = self.rest.checked_sub(1) {
            self.rest = rest;
            self.is_motor_calibrated |= rest == 0;
        }
        if self.running != axis_state::IDLE && self.state(drive) == axis_state::IDLE {
            let is_ok = drive.fault().is_none() && self.running != axis_state::CLOSED_LOOP_CONTROL;
            self.result = if is_ok { procedure_result::SUCCESS } else { procedure_result::DISARMED };
            self.running = axis_state::IDLE;
        }
    }
}
