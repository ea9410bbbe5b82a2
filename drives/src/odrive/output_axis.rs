//! Second axis of a board with firmware 0.5: the output encoder, without a motor.

use super::Firmware;
use super::axis::{Readings, angle_of_count};
use super::codes::{axis_error, axis_state};
use super::cyclic::Cyclic;
use super::errors::AxisErrors;
use super::message::{Command, MAX_NODE, Report};
use crate::drive::Drive;
use crate::turns::Turns;

/// Axis with the output encoder.
#[derive(Debug, Clone)]
pub(super) struct OutputAxis {
    pub node_id: u8,
    pub errors: AxisErrors,
    pub cyclic: Cyclic,
    /// Offset of the angle to the reading.
    offset: Turns,
}

impl OutputAxis {
    pub fn new(node_id: u8) -> Self {
        let cyclic = Cyclic::new(Firmware::V0_5);
        Self { node_id, errors: AxisErrors::default(), cyclic, offset: Turns::ZERO }
    }

    /// Forgets errors and offset.
    pub fn reset(&mut self) {
        (self.errors, self.offset) = (AxisErrors::default(), Turns::ZERO);
    }

    /// Report of a command's identifier; `None` without one.
    pub fn report(&self, command: u8, drive: &Drive) -> Option<Report> {
        let readings = Readings { errors: self.errors, ..Readings::of_output(drive, self.offset) };
        readings.report(Firmware::V0_5, command)
    }

    /// Carries out a command that concerns this axis alone.
    pub fn obey(&mut self, command: Command, drive: &Drive) {
        match command {
            Command::SetNodeId(payload) => {
                let node_id = u8::try_from(payload.node_id).ok().filter(|node_id| *node_id <= MAX_NODE);
                self.node_id = node_id.unwrap_or(self.node_id);
            }
            Command::SetState(payload) if payload.state > axis_state::STARTUP_SEQUENCE.into() => {
                self.errors.axis |= axis_error::INVALID_STATE;
            }
            Command::SetState(_) => self.errors.axis &= !axis_error::INVALID_STATE,
            Command::SetLinearCount(payload) => {
                let counts_per_turn = drive.settings().output_counts_per_turn.unwrap_or(0);
                let raw = drive.feedback().output_position.unwrap_or_default();
                self.offset = angle_of_count(payload.position, counts_per_turn).minus(raw);
            }
            Command::Estop(_) => self.errors.axis |= axis_error::ESTOP_REQUESTED,
            _ => {}
        }
    }
}
