//! How many planets a joint may have, and a value for each of them.

use heapless::Vec;

/// The largest number of planets that the model is made for.
pub const MAX_PLANETS: usize = 5;

/// The smallest number of planets that the model is made for.
pub const MIN_PLANETS: usize = 3;

/// One value for each planet.
pub type PerPlanet = Vec<f64, MAX_PLANETS>;
