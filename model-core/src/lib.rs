#![no_std]
//! What runs beside a motor controller of a planetary gear joint with backlash, a folder a subject:
//!
//! - [`numbers`]: arithmetic that gives the same bits everywhere;
//! - [`gears`]: the joint's fixed step ([`gears::Model`]; f32, no_std, no allocation, no panic);
//! - [`observer`]: where the gap is, from encoder counts and motor torque;
//! - [`wiring`]: whether signs, counts, ratio, torque, rate and clock are those of the tables, before anything is controlled;
//! - [`compensation`]: takes the lost motion out, from estimates and a set-point to a torque;
//! - [`virtual_joint`]: gears with motor, frictions and encoders around them, for a controller to be tried on;
//! - [`controller`]: observer and compensation as one.
//!
//! Each imports those above it only. What a joint is stands in the crate `parameters`. In each folder `design` (offline,
//! f64, behind the feature of that name) turns parameters into `tables`, and the files beside them run on the tables;
//! they never import `design`.
//!
//! Source of the model: He, Jia, Chen, Sun, "Modeling and Dynamic Analysis of Planetary Gear Transmission Joints with
//! Backlash" (2015), with its misprints corrected; equation numbers are that paper's.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(feature = "design")]
extern crate std;

pub mod compensation;
pub mod controller;
pub mod gears;
pub mod numbers;
pub mod observer;
pub mod virtual_joint;
pub mod wiring;
