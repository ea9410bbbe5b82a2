//! Port to another chip on SPI. The motor controller is the master; every transfer sends samples and receives the
//! answer to the samples before. Frames have a fixed length: postcard, zero padding, CRC-32. The bus driver does the
//! transfer, with or without DMA; a blocking transfer takes its time from the tick.

use embedded_hal::spi::SpiDevice;
use link::controller::{Answered, Exchange};
use link::framing::{sealed, unsealed, unsealed_within_a_tick};
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::Samples;

use super::{ControllerPort, PortError, asked};

/// Bytes of a frame in either direction: the longer of samples and answer, with checksum.
pub const FRAME_BYTES: usize = 196;

/// Frame of fixed length.
pub type Frame = [u8; FRAME_BYTES];

/// Master's side.
#[derive(Debug)]
pub struct SpiPort<S> {
    spi: S,
    tick: u32,
}

impl<S: SpiDevice> SpiPort<S> {
    /// Port on a bus.
    pub fn new(spi: S) -> Self {
        Self { spi, tick: 0 }
    }
}

impl<S: SpiDevice> ControllerPort for SpiPort<S> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError> {
        self.transfer(&Exchange::new(self.tick, samples, command))
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        self.transfer(&Exchange::probing(self.tick, samples))
    }

    fn reset(&mut self) {
        self.tick = 0;
    }
}

impl<S: SpiDevice> SpiPort<S> {
    fn transfer(&mut self, exchange: &Exchange) -> Result<Answer<f32>, PortError> {
        let mut frame = [0; FRAME_BYTES];
        sealed(exchange, &mut frame).map_err(|_| PortError::Damaged)?;
        self.spi.transfer_in_place(&mut frame).map_err(|_| PortError::Bus)?;
        self.tick = self.tick.wrapping_add(1);
        let answered: Answered = unsealed(&frame).ok_or(PortError::Damaged)?;
        // The slave has not processed a frame yet, or has missed the last one.
        if answered.tick.wrapping_add(1) != self.tick {
            return Err(PortError::Late);
        }
        answered.answer().ok_or(PortError::Late)
    }
}

/// Slave's side without the bus driver: takes a received frame, returns the next frame to send.
#[derive(Debug)]
pub struct SpiGuest<P> {
    controller: P,
    digest: u64,
}

impl<P: ControllerPort> SpiGuest<P> {
    /// Slave that uses this controller.
    pub fn new(controller: P) -> Self {
        Self { controller, digest: model_core::numbers::digest::START }
    }

    /// Processes a frame and returns the frame for the next transfer. A damaged frame changes nothing and has no
    /// answer.
    pub fn answer(&mut self, frame: &Frame) -> Option<Frame> {
        let mut next = [0; FRAME_BYTES];
        let exchange = unsealed_within_a_tick::<Exchange>(frame)?;
        if exchange.tick == 0 {
            self.controller.reset();
            self.digest = model_core::numbers::digest::START;
        }
        let answer = asked(&mut self.controller, &exchange.samples(), exchange.command().as_ref()).ok()?;
        self.digest = answer.digest(self.digest);
        let answered = Answered {
            tick: exchange.tick.wrapping_add(1),
            digest: self.digest,
            shaped: (&answer.shaped).into(),
            estimates: Some((&answer.estimates).into()),
            probed: answer.probed.map(Into::into),
            computation: 0,
        };
        // The longest answer fits (tested).
        sealed(&answered, &mut next).ok()?;
        Some(next)
    }
}
