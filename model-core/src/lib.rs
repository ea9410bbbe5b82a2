#![no_std]
//! A planetary gear joint with backlash: parameters in SI, tables designed offline in f64, a fixed step in f32.

#[cfg(feature = "design")]
extern crate std;

pub mod dead_zone;
pub mod joint;
pub mod mesh;
pub mod real;
