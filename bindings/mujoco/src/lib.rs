//! A joint as an actuator plug-in of MuJoCo: `export` compiles `bindings/mujoco/c` with the joint's tables over the C library
//! against the headers of a MuJoCo package (`package`), and writes a model that uses it (`mjcf`).

pub mod export;
mod mjcf;
pub mod package;
