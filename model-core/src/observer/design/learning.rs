//! Over which times the observer learns and forgets.

/// Length of a learning interval [s]: short against the motions in which contact settles, long against noise.
pub(super) const LEARNING_INTERVAL: f64 = 1e-3;

/// Learning intervals over which the observer takes the speed of the deflection.
pub(super) const WINDOW: f64 = 8.0;

/// Length of settled contact that makes up one deflection to learn from [s]: about as long as cogging and swings of the wind-up
/// take to repeat, so that one block's error says little about the next one's.
pub(super) const BLOCK: f64 = 8e-3;

/// Time in which wear and warmth may change what was learnt by as much as is known of it [s].
pub(super) const MEMORY: f64 = 100.0;
