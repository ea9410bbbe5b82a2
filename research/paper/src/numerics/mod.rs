//! Numerics for studies of periodically driven joints: motion by Taylor series from contact event to contact event, Poincare sections,
//! Lyapunov exponents, attractors.
//!
//! `system` makes the equations dimensionless, `zone` is the branch of the force law of each mesh, `series` expands motion and tangent
//! vectors, `first_root` finds the end of a branch, `integrator` joins the pieces; `lyapunov`, `attractor` and `signal` analyse the motion,
//! and `shooting` finds periodic motions that are approached slowly.

pub mod attractor;
mod first_root;
pub mod integrator;
pub mod lyapunov;
mod series;
mod shooting;
pub mod signal;
pub mod system;
mod zone;
