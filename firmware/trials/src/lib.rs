#![no_std]
//! What the fixed step is put through, the same on every machine: `motion` goes on and on and is compared bit for bit;
//! `states` are single ones, by chance and by malice, and `outcome` says what became of them; `torque` suits torques to
//! the joint, `numbers` is chance that repeats itself.

pub mod motion;
pub mod numbers;
pub mod outcome;
pub mod states;
pub mod torque;
