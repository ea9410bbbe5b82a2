#![no_std]
//! A planetary gear joint with backlash, from its data sheet to a fixed step that runs beside a motor controller.
//!
//! Read from the top: [`joint::JointParameters`] (SI) and [`scales::Scales`] say what the joint is; [`design`]
//! (offline, f64) turns them into [`tables::Tables`]; [`realtime::Model`] (f32, no_std, no allocation, no panic)
//! moves the joint by one tick. The two halves meet in `tables` only and never import each other.
//!
//! Source of the model: He, Jia, Chen, Sun, "Modeling and Dynamic Analysis of Planetary Gear Transmission Joints with
//! Backlash" (2015), with its misprints corrected; equation numbers are that paper's.

#[cfg(feature = "design")]
extern crate std;

pub mod certificate;
pub mod dead_zone;
#[cfg(feature = "design")]
pub mod design;
pub mod digest;
pub mod error;
pub mod joint;
pub mod mesh;
pub mod random;
pub mod real;
pub mod realtime;
pub mod scales;
pub mod surroundings;
pub mod tables;
