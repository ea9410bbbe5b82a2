//! Numerics for studies of periodically driven joints: motion by Taylor series from contact event to contact event,
//! Poincare sections, Lyapunov exponents, attractors.
//!
//! `system` makes the equations dimensionless, `zone` is the branch of the force law that each mesh is on, `series`
//! expands motion and tangent vectors, `first_root` finds the time at which a branch ends, `integrator` strings the
//! pieces together; `lyapunov`, `attractor` and `signal` analyse the motion, and `shooting` finds periodic motions that
//! are reached slowly.

pub mod attractor;
mod first_root;
pub mod integrator;
pub mod lyapunov;
mod series;
mod shooting;
pub mod signal;
pub mod system;
mod zone;
