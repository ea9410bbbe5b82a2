//! Interface between a motor controller and observer with compensation. Once per control tick, samples (raw counts with
//! their times, motor torque) and a set-point go in; estimates and the torque command come out. Observer and
//! compensation run in the controller itself, as a guest on the same chip, or on another chip; each port has a file of
//! its own.
//!
//! | port | answer | time of a tick's work |
//! |---|---|---|
//! | [`Direct`] | to these samples | the controller's own |
//! | [`SharedMemory`](shared_memory) | to the samples before | two moves through a queue |
//! | [`SpiPort`] | to the samples before | [`spi::FRAME_BYTES`] bytes at the bus's rate: 75 us at 21 MHz; [`spi_slave`] at its other end |
//! | [`SerialPort`] | to the last samples that were answered | bytes into and out of queues; [`serial::exchanges_per_second`] |
//!
//! A port that answers one tick late adds this tick to the delay of the loop: set `control_delay_periods` in the joint
//! file.

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

/// Observer and compensation, in this program or elsewhere.
pub trait ControllerPort {
    /// Runs one control tick in bounded time; never waits for the other side.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError>;

    /// Runs one control tick of a width probe while the link is held; returns [`PortError::Late`] where the port has no
    /// probe.
    fn probe(&mut self, _samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        Err(PortError::Late)
    }

    /// Resets everything that this side of the port can reset.
    fn reset(&mut self);

    /// Copies the estimated parameters into `memory`; returns `false` if the port cannot provide them.
    fn memory(&self, _memory: &mut Memory) -> bool {
        false
    }

    /// Loads parameters estimated earlier; refused by ports without access to them.
    fn recall(&mut self, _memory: &Memory) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
}

/// Runs one control tick of a port: with a set-point if there is one, else as a width probe.
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

/// Reason for a tick without answer; the motor controller continues without compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortError {
    /// The other side has not answered yet.
    Late,
    /// The bus could not transfer.
    Bus,
    /// The received frame is no valid answer.
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
