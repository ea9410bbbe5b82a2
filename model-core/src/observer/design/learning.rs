//! Time constants of the parameter estimation.

/// Length of a learning interval [s]: short against motions in which contact settles, long against noise.
pub(super) const LEARNING_INTERVAL: f64 = 1e-3;

/// Learning intervals over which the rate of the deflection is measured.
pub(super) const WINDOW: f64 = 8.0;

/// Length of settled contact averaged into one deflection for the estimation [s]: about one period of cogging and of
/// wind-up swings, so that errors of successive blocks are nearly independent.
pub(super) const BLOCK: f64 = 8e-3;

/// Time constant of the growth of variances by wear and temperature [s].
pub(super) const MEMORY: f64 = 100.0;
