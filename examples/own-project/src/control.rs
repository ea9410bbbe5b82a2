//! The control of one joint: no allocation, no standard library, one call a control period.

use model_core::{Command, Controller, Estimates, Motion, Samples};
use table_blob::{Blob, BlobError};

include!(concat!(env!("OUT_DIR"), "/my_joint.rs"));

pub struct Control {
    controller: Controller<'static>,
}

impl Control {
    pub fn new() -> Result<Self, BlobError> {
        let tables = Blob::open(&MY_JOINT)?;
        Ok(Self { controller: Controller::with_tables(tables.observer()?, tables.compensation()?) })
    }

    /// One control period: encoder counts, time and commanded torque in, torque for the motor out [N m].
    pub fn step(&mut self, samples: &Samples, now: Motion) -> f32 {
        self.controller.step(samples, &Command::Position { now, ahead: None }).shaped.torque
    }

    pub fn estimates(&self) -> &Estimates {
        self.controller.estimates()
    }
}
