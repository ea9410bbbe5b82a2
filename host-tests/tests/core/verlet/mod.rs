//! Verlet sub-steps, in which the core takes joints whose planets ring several times within a tick, against the reference: tick by
//! tick, in f64. What the design makes of them on a whole motion is asked in `robot_joint`.

mod crossing;
mod linear_contact;
mod order;
mod subject;
