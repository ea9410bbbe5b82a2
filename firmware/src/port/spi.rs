//! Another chip on SPI: the motor controller is the master, and every transfer takes samples over while it brings the
//! answer to those before. Frames have one length: postcard, filled up with zeros, then CRC-32. The transfer itself, by
//! DMA or not, is the bus driver's; a blocking one takes its time out of the tick.

use embedded_hal::spi::SpiDevice;
use link::controller::{Answered, Exchange};
use link::framing::{sealed, unsealed, unsealed_within_a_tick};
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::Samples;

use super::{ControllerPort, PortError, asked};

/// Bytes of a frame either way: the longer of samples and answer, with its checksum.
pub const FRAME_BYTES: usize = 196;

/// A frame.
pub type Frame = [u8; FRAME_BYTES];

/// The master's side.
#[derive(Debug)]
pub struct SpiPort<S> {
    spi: S,
    tick: u32,
}

impl<S: SpiDevice> SpiPort<S> {
    /// On a bus.
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
        // The slave has not had a tick yet, or has missed the one before.
        if answered.tick.wrapping_add(1) != self.tick {
            return Err(PortError::Late);
        }
        answered.answer().ok_or(PortError::Late)
    }
}

/// The slave's side, apart from the slave's own bus driver: a frame came in, the next one goes out.
#[derive(Debug)]
pub struct SpiGuest<P> {
    controller: P,
    digest: u64,
}

impl<P: ControllerPort> SpiGuest<P> {
    /// In front of a controller.
    pub fn new(controller: P) -> Self {
        Self { controller, digest: model_core::numbers::digest::START }
    }

    /// Works on a frame; the answer is for the next transfer. A damaged frame changes nothing and has no answer.
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
        // The longest answer fits: tested.
        sealed(&answered, &mut next).ok()?;
        Some(next)
    }
}
