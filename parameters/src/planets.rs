//! Limits of the number of planets, and lists with a value for each planet.

use heapless::Vec;

/// Largest number of planets.
pub const MAX_PLANETS: usize = 5;

/// Smallest number of planets, except for the one planet of an equivalent gear.
pub const MIN_PLANETS: usize = 3;

/// List with one value for each planet.
pub type PerPlanet = Vec<f64, MAX_PLANETS>;
