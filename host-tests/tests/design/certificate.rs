//! Does the certificate hold? Its predictions against measured errors, on random joints and motions that nothing was
//! fitted to. Instruction counts are checked in the crate `proof`.

mod coverage;
mod motion;
mod random;
