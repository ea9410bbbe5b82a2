//! Who follows a joint how closely at what cost. [`catalogue`] names the cases, [`method`] the fixed-step methods;
//! [`run`] moves a case by a method, [`course`] is the reference's motion and [`curve`] the error by step, as an
//! envelope over excitation phases.

pub mod case;
pub mod catalogue;
pub mod course;
pub mod curve;
#[cfg(feature = "libraries")]
pub mod libraries;
pub mod method;
pub mod reading;
pub mod run;
pub mod start;
