//! The control of one joint: no allocation, no standard library, one call a control period.

use model_core::compensation::{Command, Compensation, Motion};
use model_core::observer::{Estimates, MAPPED, Observer, Samples};
use table_blob::{Blob, BlobError};

include!(concat!(env!("OUT_DIR"), "/my_joint.rs"));

pub struct Control {
    observer: Observer<'static, f32, MAPPED>,
    compensation: Compensation<'static, f32>,
}

impl Control {
    pub fn new() -> Result<Self, BlobError> {
        let tables = Blob::open(&MY_JOINT)?;
        let (observer, compensation) = (Observer::new(tables.observer()?), Compensation::new(tables.compensation()?));
        Ok(Self { observer, compensation })
    }

    /// One control period: encoder counts, time and commanded torque in, torque for the motor out [N m].
    pub fn step(&mut self, samples: &Samples<f32>, now: Motion<f32>) -> f32 {
        let estimates = self.observer.step(samples);
        self.compensation.step(estimates, &Command::Position { now, ahead: None }).torque
    }

    pub fn estimates(&self) -> &Estimates<f32> {
        self.observer.estimates()
    }
}
