#![no_std]
//! Model, observer and compensation of a planetary gear joint with backlash, to run beside a motor controller:
//!
//! - [`numbers`]: arithmetic with equal bits on every host and board;
//! - [`gears`]: the joint's fixed step ([`gears::Model`]; f32, no_std, no allocation, no panic);
//! - [`observer`]: estimates the gap coordinate, contact and torques from encoder counts and motor torque;
//! - [`wiring`]: checks signs, counts, ratio, torque, rate and clock against the tables before control starts;
//! - [`width_probe`]: measures the backlash with a held load, without an output encoder;
//! - [`compensation`]: computes a motor torque that removes the lost motion, from the estimates and a set-point;
//! - [`virtual_joint`]: simulates gears with motor, friction and encoders, to test a controller;
//! - [`controller`]: combines observer and compensation.
//!
//! A module imports only modules above it in this list. The crate `parameters` describes a joint. In each module `design`
//! (offline, f64, behind the feature `design`) computes `tables` from the parameters; the other files run on the tables and
//! never import `design`.
//!
//! Source of the model: He, Jia, Chen, Sun, "Modeling and Dynamic Analysis of Planetary Gear Transmission Joints with
//! Backlash" (2015), misprints corrected. "Eq." and a plain number refer to this paper, (S1) to docs/theory/step.md.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(feature = "design")]
extern crate std;

pub mod compensation;
pub mod controller;
pub mod gears;
pub mod numbers;
pub mod observer;
pub mod virtual_joint;
pub mod width_probe;
pub mod wiring;
