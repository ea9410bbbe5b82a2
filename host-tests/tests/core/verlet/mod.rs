//! Verlet sub-steps, which the core uses for joints whose planets oscillate several times within a tick, against the reference: tick by
//! tick, in f64. The choice of the design on a whole motion is tested in `robot_joint`.

mod crossing;
mod linear_contact;
mod order;
mod subject;
