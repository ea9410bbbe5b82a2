#![no_std]
//! Trials of the fixed step, identical on every machine: `motion` generates long motions compared bit for bit; `states`
//! single states, random and adversarial; `outcome` classifies the result of a step; `torque` scales torques to the
//! joint; `random` is a repeatable generator.

pub mod motion;
pub mod outcome;
pub mod random;
pub mod states;
pub mod torque;
