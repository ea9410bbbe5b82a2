#![no_std]
//! Trials of the fixed step, the same on every machine: `motion` is long and compared bit for bit; `states` are single ones,
//! random and adversarial, and `outcome` classifies what the step does with them; `torque` scales torques to the joint,
//! `random` is a repeatable generator.

pub mod motion;
pub mod outcome;
pub mod random;
pub mod states;
pub mod torque;
