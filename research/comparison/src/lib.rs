//! Comparison of integration methods: error against cost on given joints and motions. [`catalogue`] lists the cases, [`method`] the
//! fixed-step methods; [`run`] moves a case by a method, [`trajectory`] is the reference's motion and [`curve`] the error by step, as an
//! envelope over excitation phases.

pub mod case;
pub mod catalogue;
pub mod curve;
#[cfg(feature = "libraries")]
pub mod libraries;
pub mod method;
pub mod reading;
pub mod run;
pub mod start;
pub mod trajectory;
