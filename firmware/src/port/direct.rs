//! Port by function call; the answer belongs to the samples of the call.

use model_core::compensation::Command;
use model_core::controller::{Answer, Controller};
use model_core::observer::{Memory, MemoryError, Samples};

use super::{ControllerPort, PortError};

/// Port to a controller in this program.
#[derive(Debug)]
pub struct Direct<'t>(pub Controller<'t, f32>);

impl ControllerPort for Direct<'_> {
    #[inline]
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError> {
        Ok(self.0.step(samples, command))
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        Ok(self.0.probe(samples))
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn memory(&self, memory: &mut Memory) -> bool {
        *memory = self.0.save();
        true
    }

    fn recall(&mut self, memory: &Memory) -> Result<(), MemoryError> {
        self.0.load(memory)
    }
}
