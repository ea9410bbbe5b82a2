#![no_std]
//! Real-time model of a geared robot joint with backlash, an observer that estimates the gap, and a compensation that
//! removes the lost motion. Runs in f32 on a microcontroller, without allocation, panic or standard library.
//!
//! ```
//! use model_core::{Command, Controller, ControllerDesign, VirtualJointDesign};
//!
//! // Offline, in f64: tables of the controller, and of a virtual joint to try it on.
//! let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
//! let design = ControllerDesign::new(&q1, 10_000)?;
//! let plant = VirtualJointDesign::<3>::new(&q1, 10_000)?;
//!
//! // On the board, once per control period: encoder counts and torque in, torque for the motor out.
//! let mut controller = Controller::new(&design);
//! let mut joint = plant.joint();
//! for _ in 0..1000 {
//!     let answer = controller.step(&joint.samples(), &Command::HOLD);
//!     joint.advance(answer.shaped.torque, 0.0);
//! }
//! # Ok::<(), model_core::gears::design::DesignError>(())
//! ```
//!
//! # Modules
//!
//! - [`numbers`]: arithmetic with equal bits on every host and board;
//! - [`gears`]: the joint's fixed step ([`gears::Model`]);
//! - [`observer`]: estimates the gap coordinate, contact and torques from encoder counts and motor torque;
//! - [`wiring`]: checks signs, counts, ratio, torque, rate and clock against the tables before control starts;
//! - [`width_probe`]: measures the backlash with a held load, without an output encoder;
//! - [`compensation`]: computes a motor torque that removes the lost motion, from the estimates and a set-point;
//! - [`virtual_joint`]: simulates gears with motor, friction and encoders, to test a controller;
//! - [`controller`]: combines observer and compensation.
//!
//! A module imports only modules above it in this list. The crate `joint-parameters` describes a joint, `joint-file` reads
//! one from TOML. In each module `design` computes `tables` from the parameters; the other files run on the tables and
//! never import `design`.
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | `design` | the modules `design`: f64, standard library; for a host or a build script |
//! | `sensitivity` | thresholds that the environment variable `JOINT_THRESHOLD` multiplies: std, slower, for research |
//! | `serde` | `Serialize` and `Deserialize` of the virtual joint's faults |
//!
//! # From C and from flash
//!
//! The crate `table-blob` writes the tables as constant words and reads them in place. `joint library` builds a static
//! library with a C header from this crate (`bindings/c`).
//!
//! Source of the model: He, Jia, Chen, Sun, "Modeling and Dynamic Analysis of Planetary Gear Transmission Joints with
//! Backlash" (2015), misprints corrected. "Eq." and a plain number refer to this paper, (S1) to docs/theory/step.md.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(feature = "design")]
extern crate std;

pub mod compensation;
pub mod controller;
mod estimates;
pub mod gears;
pub mod numbers;
pub mod observer;
pub mod virtual_joint;
pub mod width_probe;
pub mod wiring;

/// Thresholds of observer, compensation, width probe and wiring check.
#[cfg(feature = "sensitivity")]
pub fn thresholds() -> std::vec::Vec<numbers::sensitivity::Threshold> {
    [observer::thresholds(), compensation::thresholds::list(), width_probe::thresholds(), wiring::thresholds::list()]
        .concat()
}

pub use compensation::{Command, ControlOutput, ImpedancePoint, Motion, Position, Stage};
pub use controller::{Answer, Controller, ControllerDesign};
pub use gears::Flank;
pub use observer::{Estimate, Estimates, Reading, Samples};
pub use virtual_joint::{VirtualJoint, VirtualJointDesign};
