//! Samples, set-points and memories that no joint produces are fed to the controller; its torque and estimates stay sound.
//!
//! `cargo test` runs a short form on fixed seeds; `WILD_SEEDS=1000 cargo test --release -p host-tests --test wild` is the long form. Each
//! attack prints its seed when it fails.

mod attack;
mod controller;
mod memories;
mod motor_encoder;
