//! Integrators from libraries for host programs, each with the same compiled right-hand side: `cvode` (Adams), `stiff` (diffsol's BDF and
//! its explicit method), `explicit` (differential-equations). `solve` selects the method of a `library`, `timing` times all of them beside
//! the fixed-step methods. Only for cases with a prescribed phase, constant torques and no compliance.

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
