//! Numerics for studies of periodically driven joints: motion by Taylor series from contact event to contact event,
//! Poincare sections, Lyapunov exponents, attractors.
//!
//! `system` makes the equations dimensionless, `zone` says which branch of the force law each mesh is on, `series`
//! expands motion and tangent vectors, `fall` finds the moment at which a branch ends, `motion` strings the pieces
//! together; `lyapunov`, `attractor` and `signal` look at what comes out, and `shooting` shortens the way to
//! motions that are reached slowly.

pub mod attractor;
mod fall;
pub mod lyapunov;
pub mod motion;
mod series;
mod shooting;
pub mod signal;
pub mod system;
mod zone;
