#![no_std]
//! Fixed-step methods in common use for joints with backlash, each written for speed as its own advocate would write it: the methods that
//! the core's step is compared with. They use no part of the core's step, only its scalar, its sine and, to make [`plant::Plant`]s, its
//! parameters.
//!
//! [`peer::Peer`] runs the whole joint by a [`scheme::Scheme`]: [`runge_kutta::RungeKutta4`], [`euler::SemiImplicitEuler`],
//! [`trapezoid::Trapezoid`], [`etd1::Etd1`]. [`two_mass`] holds the two-mass gap model common in control, as spring-damper and with
//! restitution. [`moving`] runs each of them, and the core, through a case.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables of the same mesh")]

#[cfg(feature = "design")]
extern crate std;

pub mod clock;
pub mod etd1;
pub mod euler;
pub mod forces;
#[cfg(feature = "design")]
mod from_parameters;
pub mod instant;
pub mod motion;
pub mod moving;
pub mod peer;
pub mod plant;
pub mod runge_kutta;
pub mod scheme;
pub mod trapezoid;
pub mod two_mass;
