//! The seam between a motor controller and observer with compensation: samples (raw counts with their moments, motor
//! torque) and a set-point in, estimates and the shaped set-point out, once a control tick. Behind it may be the
//! controller itself, a guest in the same chip, or another chip on a line; each has a file of its own.
//!
//! | port | answer | time of a tick's work |
//! |---|---|---|
//! | [`Direct`] | to these samples | the controller's own |
//! | [`SharedMemory`](shared_memory) | to the samples before | two moves through a queue |
//! | [`SpiPort`] | to the samples before | [`spi::FRAME_BYTES`] bytes at the bus's rate: 75 us at 21 MHz; [`spi_slave`] at its other end |
//! | [`SerialPort`] | to the last samples that were answered | bytes into and out of queues; [`serial::exchanges_per_second`] |
//!
//! A port that answers one tick late adds that tick to the loop's delay: `control_delay_periods` of the joint file.

mod direct;
pub mod serial;
pub mod shared_memory;
pub mod spi;
pub mod spi_slave;

use core::fmt;

pub use direct::Direct;
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::{Memory, MemoryError, Samples};
pub use serial::SerialPort;
pub use spi::{SpiGuest, SpiPort};

/// Observer and compensation, wherever they run.
pub trait ControllerPort {
    /// One control tick; bounded, and never waits for the other side.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError>;

    /// One control tick of a width probe, the load being held; always late where the port has no probe.
    fn probe(&mut self, _samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        Err(PortError::Late)
    }

    /// Back to the initial state, as far as this side can do it.
    fn reset(&mut self);

    /// Copies what has been learnt; `false` where the port cannot provide it.
    fn memory(&self, _memory: &mut Memory) -> bool {
        false
    }

    /// Continues from what was learnt before; refused where the port cannot.
    fn recall(&mut self, _memory: &Memory) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
}

/// One control tick of a port: a set-point's, or without one a width probe's.
pub fn asked(
    port: &mut impl ControllerPort,
    samples: &Samples<f32>,
    command: Option<&Command<f32>>,
) -> Result<Answer<f32>, PortError> {
    match command {
        Some(command) => port.exchange(samples, command),
        None => port.probe(samples),
    }
}

/// Why there is no answer in this tick: the motor controller goes on without compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortError {
    /// The other side has not answered yet.
    Late,
    /// The bus could not transfer.
    Bus,
    /// What was received is no valid answer.
    Damaged,
}

impl fmt::Display for PortError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Late => "observer and compensation have not answered in time",
            Self::Bus => "the bus to observer and compensation could not transfer",
            Self::Damaged => "the answer of observer and compensation was damaged on its way",
        })
    }
}
