//! Nothing wild in, nothing wild out: samples, set-points and memories that no joint gives are thrown at the controller.
//!
//! Short in `cargo test`, on seeds that do not change; `WILD_SEEDS=1000 cargo test --release -p host-tests --test wild`
//! is the long form. Each attack prints its seed when it fails.

mod attack;
mod controller;
mod memories;
mod motor_encoder;
