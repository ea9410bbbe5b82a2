//! Does the certificate hold? What it predicts against what is measured, on random joints and motions that nothing was
//! fitted to. Instructions are held against the emulated board elsewhere.

mod coverage;
mod motion;
mod random;
