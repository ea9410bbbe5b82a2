//! Integrators that a host program takes from a library, each over the same compiled right-hand side: `cvode` (Adams),
//! `stiff` (diffsol's BDF and its explicit method), `explicit` (differential-equations). `solve` puts
//! it to the method that `library` names, `timing` times them beside the fixed-step methods. Cases with a prescribed phase,
//! torques that do not change and no compliance only.

#[cfg(feature = "cvode")]
mod cvode;
mod equations;
mod explicit;
mod library;
mod solve;
mod stiff;
pub mod timing;

pub use equations::Equations;
pub use library::Library;
